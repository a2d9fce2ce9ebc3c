"""Public functions over those of C: which of C, with what arguments, what Python adds to it."""

from __future__ import annotations

from collections.abc import Mapping

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.ext.header import Entry
from pne_sym.backends.python_public import definition, rows, takes_rotation
from pne_sym.backends.target import TargetError
from pne_sym.program.public import Apply, PublicFunction, Run, Value

_EXPRESSIONS = {
    "beside": "np.concatenate(({0}, {1}), axis=-1)",
    "choose_length": "{1}",  # where it is given, it is positive
    "divide_rows": "_rows_divided({0}, {1}, {numbers})",
    "singular_values": "_singular_values({0})",
}
"""Operations that depend on an argument which C does not take, on arrays over states."""


class Bindings:
    """Public functions and the functions of C that they call.

    Where C has two functions for one, the name of that with more arguments is the other's and
    what the argument is about: inverse_dynamics_weighted.
    """

    def __init__(self, bundle: Bundle, entries: Mapping[str, Entry]) -> None:
        self.program = bundle.program
        self.name = bundle.name
        self.public = {f.name: f for f in self.program.public if f.is_exported}
        self.of = {name: self._variants(f, entries) for name, f in self.public.items()}

    @property
    def bound(self) -> list[tuple[PublicFunction, Entry]]:
        """All functions of C that are called."""
        return [(self.public[n], entry) for n, found in self.of.items() for entry in found]

    def _variants(self, f: PublicFunction, entries: Mapping[str, Entry]) -> list[Entry]:
        """Functions of C for a public one, those with more arguments first."""
        names = {a.name for a in f.inputs}
        found = [
            entry
            for entry in entries.values()
            if (entry.name == f.name or entry.name.startswith(f"{f.name}_"))
            and (entry.name == f.name or entry.name not in self.public)
            and set(entry.inputs) <= names
            and len(entry.outputs) == len(f.outputs)
        ]
        empty = all(o.value.size == 0 for o in f.outputs)
        required = {a.name for a in f.required}
        if not empty and not any(e.name == f.name and required <= set(e.inputs) for e in found):
            raise TargetError(
                f"{self.name}: the target ext cannot print {f.name}: {self.name}.h has no function "
                "of its arguments; generate without ext"
            )
        return sorted(found, key=lambda entry: -len(entry.inputs))

    def _extra(self, f: PublicFunction, entry: Entry) -> tuple[str, ...]:
        """Arguments that a variant takes and the function of the same name does not."""
        (base,) = (e for e in self.of[f.name] if e.name == f.name)
        return tuple(n for n in entry.inputs if n not in base.inputs)

    # ---- text ------------------------------------------------------------------------------

    def row(self, f: PublicFunction) -> str:
        """A row of the table that Python reads: shapes of outputs, functions of C."""
        shapes = tuple(o.value.shape for o in f.outputs)
        found = [(e.name, e.has_model, e.inputs, self._extra(f, e)) for e in self.of[f.name]]
        return f'"{f.name}": ({shapes}, {found}),'

    def text(self, f: PublicFunction) -> str:
        """The function that users call."""
        body = []
        for entry in self.of[f.name]:
            conditions = [f"{n} is not None" for n in self._extra(f, entry)]
            others = (a.name for a in f.optional if a.name not in entry.inputs)
            conditions += [f"{n} is None" for n in others]
            conditions += ["not nearest"] * takes_rotation(f)
            given = ", ".join([*["p"] * entry.has_model, *entry.inputs])
            made = f"(found := _C.{entry.name}({given})) is not None"
            body += [f"if {' and '.join([*conditions, made])}:", "    return found"]
        p = "p" if f.needs_model else "None"
        call = [f'"{f.name}", {p},', *rows(self.program, f)]
        body += ["found = _call(" if self.is_completed(f) else "return _call("]
        body += [*(f"    {line}" for line in call), ")", *self._completed(f)]
        return definition(f, body)

    # ---- what C leaves out ---------------------------------------------------------------------

    def _missing(self, f: PublicFunction) -> list[str]:
        """Arguments with influence that no function of C takes."""
        known = {n for entry in self.of[f.name] for n in entry.inputs}
        used = {v.name for s in f.steps if isinstance(s, Apply) for v in s.operands}
        empty = not self.of[f.name]
        return [a.name for a in f.inputs if a.name in used - known and not empty]

    def is_completed(self, f: PublicFunction) -> bool:
        """Whether Python computes what C has no argument for."""
        return bool(self._missing(f))

    def _completed(self, f: PublicFunction) -> list[str]:
        """Statements that replace the results that depend on arguments which C does not take."""
        missing = self._missing(f)
        if not missing:
            return []
        (argument,) = missing
        lines = [f"if {argument} is not None:"]
        for k, output in enumerate(f.outputs):
            if self._depends(f, output.value, argument):
                value = self._expression(f, output.value)
                lines.append(f"    found = _replaced(found, {k}, {value})")
        return [*lines, "return found"]

    def _depends(self, f: PublicFunction, value: Value, argument: str) -> bool:
        step = _maker(f, value)
        if not isinstance(step, Apply):
            return value.name == argument
        return any(self._depends(f, operand, argument) for operand in step.operands)

    def _expression(self, f: PublicFunction, value: Value) -> str:
        step = _maker(f, value)
        if step is None:
            return value.name
        if isinstance(step, Run):
            return self._called(f, value)
        if step.operation not in _EXPRESSIONS:
            raise TargetError(
                f"{self.name}: the target ext cannot print {f.name}: it has no operation "
                f"{step.operation!r}; generate without ext"
            )
        text = _EXPRESSIONS[step.operation]
        operands = [
            self._expression(f, operand) if f"{{{k}}}" in text else ""
            for k, operand in enumerate(step.operands)
        ]
        return text.format(*operands, numbers=list(step.numbers))

    def _called(self, f: PublicFunction, value: Value) -> str:
        """An array of the program from the public function that gives it."""
        for other in self.public.values():
            given = {a.name for a in other.inputs} <= {a.name for a in f.inputs}
            if given and [o.label for o in other.outputs] == [value.name]:
                required = [a.name for a in other.required] + ["p"] * other.needs_model
                optional = [f"{a.name}={a.name}" for a in other.optional]
                return f"{other.name}({', '.join([*required, *optional])})"
        raise TargetError(f"{self.name}: the target ext has no function that gives {value.name}")


def _maker(f: PublicFunction, value: Value) -> Apply | Run | None:
    """The step that makes an array; None for arguments."""
    for step in f.steps:
        if isinstance(step, Apply | Run) and value in step.targets:
            return step
    return None
