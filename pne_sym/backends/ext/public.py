"""Public functions over those of C: which of C, with what arguments, what Python adds to it."""

from __future__ import annotations

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_public import CFunction, c_functions
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

    Where C has two functions for one, one of them takes more arguments.
    """

    def __init__(self, bundle: Bundle) -> None:
        self.program = bundle.program
        self.name = bundle.name
        self.bound = c_functions(bundle)
        self.public = [f for f in self.program.public if f.is_exported]

    def _variants(self, f: PublicFunction) -> list[CFunction]:
        """Functions of C for a public one, those with more arguments first."""
        found = (c for c in self.bound if c.of.name == f.name)
        return sorted(found, key=lambda c: -len(c.inputs))

    def _extra(self, c: CFunction) -> tuple[str, ...]:
        """Arguments that a variant takes and the function of the same name does not."""
        *_, base = self._variants(c.of)
        return tuple(n for n in _names(c) if n not in _names(base))

    # ---- text ------------------------------------------------------------------------------

    def row(self, f: PublicFunction) -> str:
        """A row of the table that Python reads: shapes of outputs, functions of C."""
        shapes = tuple(o.value.shape for o in f.outputs)
        variants = self._variants(f)
        found = [(c.name, c.has_model, _names(c), self._extra(c)) for c in variants]
        return f'"{f.name}": ({shapes}, {found}),'

    def text(self, f: PublicFunction) -> str:
        """The function that users call."""
        body = []
        for c in self._variants(f):
            conditions = [f"{n} is not None" for n in self._extra(c)]
            others = (a.name for a in f.optional if a.name not in _names(c))
            conditions += [f"{n} is None" for n in others]
            conditions += ["not nearest"] * takes_rotation(f)
            given = ", ".join([*["p"] * c.has_model, *_names(c)])
            made = f"(found := _C.{c.name}({given})) is not None"
            body += [f"if {' and '.join([*conditions, made])}:", "    return found"]
        p = "p" if f.needs_model else "None"
        call = [f'"{f.name}", {p},', *rows(self.program, f)]
        body += ["found = _call(" if self.is_completed(f) else "return _call("]
        body += [*(f"    {line}" for line in call), ")", *self._completed(f)]
        return definition(f, body)

    # ---- what C leaves out ---------------------------------------------------------------------

    def _missing(self, f: PublicFunction) -> list[str]:
        """Arguments with influence that no function of C takes."""
        variants = self._variants(f)
        known = {n for c in variants for n in _names(c)}
        used = {v.name for s in f.steps if isinstance(s, Apply) for v in s.operands}
        return [a.name for a in f.inputs if variants and a.name in used - known]

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
        for other in self.public:
            given = {a.name for a in other.inputs} <= {a.name for a in f.inputs}
            if given and [o.label for o in other.outputs] == [value.name]:
                required = [a.name for a in other.required] + ["p"] * other.needs_model
                optional = [f"{a.name}={a.name}" for a in other.optional]
                return f"{other.name}({', '.join([*required, *optional])})"
        raise TargetError(f"{self.name}: the target ext has no function that gives {value.name}")


def _names(c: CFunction) -> tuple[str, ...]:
    """Arguments of a function of C."""
    return tuple(i.name for i in c.inputs)


def _maker(f: PublicFunction, value: Value) -> Apply | Run | None:
    """The step that makes an array; None for arguments."""
    for step in f.steps:
        if isinstance(step, Apply | Run) and value in step.targets:
            return step
    return None
