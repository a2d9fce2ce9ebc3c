"""Public functions in C: their steps as they stand, for one state or for several side by side.

An array has its states side by side: entry e of state k of w is x[e*w + k].  Operations are an
expression of entries, a part of an operand, or a function of templates/c.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_arrays import Arrays
from pne_sym.backends.c_operations import (
    ENTRIES,
    LANES,
    PARTS,
    SINGLE,
    WITHOUT,
    c_order,
    results_of,
)
from pne_sym.backends.c_repeated import repeated
from pne_sym.backends.c_results import Results
from pne_sym.backends.c_sizes import Sizes, one_state, times
from pne_sym.backends.c_solve import Eliminations
from pne_sym.backends.c_solves import Solves
from pne_sym.backends.c_text import (
    WIDTH,
    Routine,
    indented,
    listing,
    parameter_name,
    statement,
    words_of,
)
from pne_sym.backends.scalar import wrap
from pne_sym.backends.steps import Citations
from pne_sym.backends.templating import render
from pne_sym.program.interpret import HALVINGS
from pne_sym.program.public import Apply, Argument, PublicFunction, Run, Search, Step, Value


class Steps:
    """Prints what a public function does.

    Args:
        bundle: of the model.
        function: what is printed.
        runs: routines that run the functions of the program, by name.
        parts: routines of the functions that it searches with, by name.
        eliminations: routines and tables that solve small systems; new ones are added.
        lanes: for states side by side.
    """

    def __init__(
        self,
        bundle: Bundle,
        function: PublicFunction,
        runs: Mapping[str, Routine],
        parts: Mapping[str, Routine],
        eliminations: Eliminations,
        *,
        lanes: bool,
    ) -> None:
        self.bundle, self.f, self.runs, self.parts = bundle, function, runs, parts
        self.lanes = lanes
        self.arrays = Arrays(bundle, function, lanes=lanes)
        self.solves = Solves(self.arrays, eliminations)
        applied = [step for step in function.steps if isinstance(step, Apply)]
        self.given = {o.name for o in function.outputs}
        self.used = {o.name for step in applied for o in step.operands} | self.given
        self.before: list[str] = []
        self.steps = function.steps

    def routine(self) -> Routine:
        """Outputs, state by state, and codes of w states from inputs, state by state."""
        lines = [f"start({self.arrays.w}, &why);", *self.arrays.inputs(), *self._begun()]
        cited = Citations(self.bundle.program, "/* {} */")
        for step in self.steps:
            lines += cited.lines(step, self._step(step))
        lines += [*cited.end(), *Results(self.arrays, self.used, self.steps).lines()]
        buffers = [*self.arrays.buffers, *self.solves.buffer()]
        aligned = "ALIGNED " * self.lanes
        head = self.arrays.tables + (listing(f"{aligned}real ", buffers, ";") if buffers else [])
        body = [*head, f"{aligned}status_flags why;", *lines]
        if self.lanes:
            parameters = [*self._parameters(self.f.inputs), "int *code"]
            return Routine.of(f"{self.f.name}_lanes", parameters, body)
        if "weights" not in self.arrays.read and self.f.is_exported:
            return self._called_by_users(body)
        kind = one_state(self.bundle, "static")
        one = Routine.of(f"{self.f.name}_one", self._parameters(self.f.inputs), body, kind)
        return one._replace(result="int")

    def _begun(self) -> list[str]:
        """A call of another function, with whose steps this one begins."""
        for other in self.bundle.program.public if not self.lanes else ():
            values = repeated(self.bundle.program, self.f, other)
            if values and other.name in self.parts:
                self.steps = self.steps[len(other.steps) :]
                results = {f"{label}_out": self.arrays.made(value) for label, value in values}
                call = self.parts[other.name].call_with(results).rstrip(";")
                return wrap(f"flag_status({call}, &why);", WIDTH - 4, "    ")
        return []

    def _parameters(self, inputs: Iterable[Argument]) -> list[str]:
        return [
            "const prepared *m",
            *(f"const real *{name}" for name in c_order([a.name for a in inputs])),
            *(f"real *{o.label}_out" for o in self.f.outputs),
        ]

    def _called_by_users(self, body: list[str]) -> Routine:
        """The routine with all parameters that users know; NULL stands for what C does not take."""
        parameters = self._parameters(a for a in self.f.inputs if a.name not in WITHOUT)
        parameters = parameters if self.f.needs_model else parameters[1:]
        words, names = words_of(body), [parameter_name(p) for p in parameters]
        lines = [f"(void){name};" for name in names if name not in words]
        for a in self.f.inputs:
            if a.name in WITHOUT and a.name in words:
                lines.append(f"const real *{a.name} = NULL;")
        name = f"{self.bundle.name}_{self.f.name}"
        return Routine(name, tuple(parameters), (*lines, *body), one_state(self.bundle), "int")

    # ---- steps -------------------------------------------------------------------------------

    def _step(self, step: Step) -> list[str]:
        if isinstance(step, Run):
            return self._run(step)
        if isinstance(step, Search):
            return self._search(step)
        lines = self._part(step)
        return self._applied(step) if lines is None else lines

    def _run(self, step: Run) -> list[str]:
        function, lines = self.bundle.program.functions[step.function], []
        if "q" in function.inputs and "joints" not in self.arrays.at:
            joints = Value("joints", (self.bundle.coordinates.sizes["NJ"],))
            self.arrays.sizes.of["joints"] = ("NJ",)
            lines.append(
                f"close_loops(m, {self.arrays.w}, X, q0, {self.arrays.made(joints)}, &why);"
            )
        targets = zip(function.arrays, step.targets, strict=True)
        arrays = {a: self.arrays.made(t, step) for a, t in targets}
        if set(results_of(self.f)) & {t.name for t in step.targets}:
            self.arrays.summed |= {t.name for t in step.targets}
        call = self.runs[step.function].call_with({"t": "&why", **arrays})
        return [*lines, *wrap(call, WIDTH - 4, "    ")]

    def _part(self, step: Apply) -> list[str] | None:
        """Results as parts of the operand; None where they are none."""
        if step.operation not in PARTS:
            return None
        (value,), numbers, first = step.operands, step.numbers, (*step.numbers, 0)[0]
        row = times(*self.arrays.sizes.names(value)[1:])
        if step.operation == "split":
            places = [0, first]
        elif step.operation in ("same", "entry"):
            places = [first if step.operation == "entry" else 0]
        elif step.operation == "take" and numbers == (*range(first, first + len(numbers)),) != ():
            places = [first]
        else:
            return None
        lines = []
        for target, place in zip(step.targets, places, strict=True):
            if target.name not in self.used:
                continue
            if not place and target.name not in self.given:
                self.arrays.at[target.name] = self.arrays.at[value.name]
                continue
            self.arrays.at[target.name] = target.name
            at = self.arrays.sizes.name(place, (*step.targets, value))
            offset = f" + {self.arrays.by(times(at, row))}" if place else ""
            lines.append(f"const real *const {target.name} = {self.arrays.at[value.name]}{offset};")
        return lines

    def _applied(self, step: Apply) -> list[str]:
        """An operation at its operands."""
        name, in_place = step.operation, self.solves.is_solved(step)
        if in_place:
            self.arrays.at[step.targets[0].name] = "work"
        zero = name not in ENTRIES and name != "solve"
        targets = (
            ["work"] if in_place else [self.arrays.made(t, step, zero=zero) for t in step.targets]
        )
        if not any(t.size for t in step.targets):
            return []
        fields = self._fields(step, targets)
        lines = []
        if name == "solve":
            return self.solves.solve(step, fields)
        if name in ENTRIES:
            entry = ENTRIES[name].format(**fields) if step.operands[0].size else "0"
            body = indented(statement(f"{targets[0]}[i] = {entry}"))
            lines += ["SHORT_IN_VECTORS"] * self.lanes
            lines += [f"for (size_t i = 0; i < {fields['all']}; ++i) {{", *body, "}"]
        call = (LANES if self.lanes else LANES | SINGLE).get(name, "")
        if "{places}" in call:
            if not step.numbers:
                return lines
            fields["places"] = self._places(step)
        return [*lines, *(wrap(call.format(**fields), WIDTH - 4, "    ") if call else [])]

    def _places(self, step: Apply) -> str:
        """A table of places; users know that of the actuated joints."""
        c = self.bundle.coordinates
        if step.numbers == tuple(c.joints.index(joint) for joint in c.actuators):
            return f"{self.bundle.name}_ACTUATED"
        name = f"places_{step.targets[0].name}"
        rows = ", ".join(map(str, step.numbers))
        self.arrays.tables += listing(f"static const size_t {name}[] = {{", [rows], "};")
        return name

    def _fields(self, step: Apply, targets: Sequence[str]) -> dict[str, object]:
        """What calls are made of."""
        names = [self.arrays.sizes.names(o) for o in step.operands]
        m, n = (*names[0], "1", "1")[:2]
        p = (*names[1], "1", "1")[1] if len(names) > 1 else "1"
        target = step.targets[0]
        both = f"{m} + {p}" if not (m + p).isdigit() else str(int(m) + int(p))
        first = (*step.numbers, 0)[0]
        return {
            **dict(zip("abcd", (self.arrays.at[o.name] for o in step.operands), strict=False)),
            **dict(zip("xy", targets, strict=False)),
            **{
                f"all_{c}": self.arrays.by(self.arrays.size(o))
                for c, o in zip("abc", step.operands, strict=False)
            },
            "m": m, "n": n, "p": p, "w": self.arrays.w, "size": self.arrays.size(target),
            "stride": f"stride_of({both}, {self.arrays.w})" if "work" in targets else both,
            "all": self.arrays.by(self.arrays.size(target)),
            "row": self.arrays.by(n), "row_b": self.arrays.by(p),
            "count": self.arrays.sizes.name(len(step.numbers), (target, *step.operands)),
            "first": self.arrays.sizes.name(first, (*step.targets, *step.operands)) if first else 0,
            # a state in doubt is settled on its own, where an overflow comes after other causes
            "doubt": "why.invalid" if self.lanes else "why.overflow",
        }  # fmt: skip

    # ---- searches ----------------------------------------------------------------------------

    def _search(self, step: Search) -> list[str]:
        """A call of the search, whose text stands before the function."""
        residual, slope = self.parts[step.residual], self.parts[step.slope]
        names = {p.rsplit("*", 1)[-1] for r in (residual, slope) for p in r.parameters}
        inputs = [a.name for a in self.f.inputs if a.name in names and a.name != "X"]
        others = c_order(inputs)
        found = {"X": "found"}
        text = render(
            "c/search.c.jinja",
            name=step.residual,
            parameters=", ".join(("const prepared *m", *(f"const real *{o}" for o in others))),
            residuals=self._extent(step.residual),
            trials=HALVINGS if step.halving else 1,
            close="CLOSED" if step.halving else "MET",
            residual=residual.call_with(found | {"residual_out": "residual"}),
            slope=slope.call_with(found | {"slope_out": "slope"}),
            trial=residual.call_with({"X": "trial", "residual_out": "next"}),
        )  # fmt: skip
        self.before.append(text)
        (start,), (target,) = step.operands, step.targets
        arguments = ", ".join(("m", *others, start.name, self.arrays.made(target)))
        return [f"flag_status(search_{step.residual}({arguments}), &why);"]

    def _extent(self, name: str) -> str:
        """Number of entries of what a function gives."""
        function = next(f for f in self.bundle.program.public if f.name == name)
        return Sizes(self.bundle, function).size(function.outputs[0].value)
