"""Public functions in C: their steps as they stand, for one state or for several side by side.

An array has its states side by side: entry e of state k of w is x[e*w + k].  Operations are an
expression of entries, a part of an operand, or a function of templates/c.  A state of its own gives
its results where the user wants them; states side by side give theirs in the end.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_operations import (
    ENTRIES,
    FILL,
    LANES,
    PARTS,
    SINGLE,
    WITHOUT,
    c_order,
    results_of,
)
from pne_sym.backends.c_repeated import repeated
from pne_sym.backends.c_sizes import Sizes, times
from pne_sym.backends.c_solve import Eliminations
from pne_sym.backends.c_text import (
    WIDTH,
    Routine,
    indented,
    listing,
    parameter_name,
    statement,
    words_of,
)
from pne_sym.backends.orders import order_at_home
from pne_sym.backends.scalar import wrap
from pne_sym.backends.steps import Citations
from pne_sym.backends.templating import render
from pne_sym.program import interpret
from pne_sym.program.public import (
    Apply,
    Argument,
    Default,
    PublicFunction,
    Run,
    Search,
    Step,
    Value,
)

_CHECKS = {1: "check_one", 2: "check_two", 3: "check_three"}


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
        self.eliminations = eliminations
        self.lanes = lanes
        self.w = "LANES" if self.lanes else "1"
        self.sizes = Sizes(bundle, function)
        self.read = interpret.inputs_read(bundle.program, function)
        applied = [step for step in function.steps if isinstance(step, Apply)]
        self.used = {o.name for step in applied for o in step.operands}
        self.given = {o.name for o in function.outputs}
        self.used |= self.given
        self.at = {a.name: a.name for a in function.inputs}
        self.buffers: list[str] = []
        self.tables: list[str] = []
        self.summed = set[str]()
        self.work = (0, "")
        self.before: list[str] = []
        self.steps = function.steps

    def routine(self) -> Routine:
        """Outputs, state by state, and codes of w states from inputs, state by state."""
        lines = [f"start({self.w}, &why);", *self._inputs(), *self._begun()]
        cited = Citations(self.bundle.program, "/* {} */")
        for step in self.steps:
            lines += cited.lines(step, self._step(step))
        lines += [*cited.end(), *self._outputs()]
        if self.work[0]:
            self.buffers.append(self._buffer("work", self.work[1]))
        aligned = "ALIGNED " * self.lanes
        real = f"{aligned}real "
        head = [*self.tables, *(listing(real, self.buffers, ";") if self.buffers else [])]
        body = [*head, f"{aligned}status_flags why;", *lines]
        if self.lanes:
            parameters = [*self._parameters(self.f.inputs), "int *code"]
            return Routine.of(f"{self.f.name}_lanes", parameters, body)
        if "weights" not in self.read and self.f.is_exported:
            return self._called_by_users(body)
        one = Routine.of(f"{self.f.name}_one", self._parameters(self.f.inputs), body, "static")
        return replace(one, result="int")

    def _begun(self) -> list[str]:
        """A call of another function, with whose steps this one begins."""
        for other in self.bundle.program.public if not self.lanes else ():
            values = repeated(self.bundle.program, self.f, other)
            if values and other.name in self.parts:
                self.steps = self.steps[len(other.steps) :]
                results = {f"{label}_out": self._made(value) for label, value in values}
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
        return Routine(name, tuple(parameters), (*lines, *body), "", "int")

    def _outputs(self) -> list[str]:
        """The status, and results where the user wants them."""
        outputs = [o for o in self.f.outputs if o.value.size]
        wanted = {o.name: f"{o.label}_out" for o in outputs}
        judged = [] if self.f.unbounded else outputs
        unused = [] if self.f.unbounded else self._unused()
        apart = [o for o in judged if o.name not in self.summed]
        moved = [o for o in outputs if self.at[o.name] != wanted[o.name]]
        move = "copy_side_by_side" if self.lanes else "copy"
        moves = [
            f"{move}({self._size(o.value)}, {self.at[o.name]}, {wanted[o.name]});" for o in moved
        ]
        if self.lanes:
            sums = [
                f"add_up({self._size(value)}, {self.at[value.name]}, why.total);"
                for value in (*(o.value for o in apart), *unused)
            ]
            return [*sums, "status_side_by_side(&why, code);", *moves]
        only = (
            outputs[0] if len(outputs) == 1 and apart == moved == outputs and not unused else None
        )
        if only:
            ends = f"{self._size(only.value)}, {self.at[only.name]}, {wanted[only.name]}"
            return statement(f"return finished({ends}, &why)")
        checks = {
            o.name: f"check({self._size(o.value)}, 1, {self.at[o.name]}, why.overflow);"
            for o in judged
        }
        summed = [checks.pop(name) for name in [*checks] if name in self.summed]
        more = [f"check({self._size(v)}, 1, {self.at[v.name]}, why.overflow);" for v in unused]
        lines = [*checks.values(), *more, *moves]
        if summed:
            lines[:0] = ["if (!is_finite(why.total[0])) {", *indented(summed), "}"]
        refused = [f"{self._size(o.value)}, {wanted[o.name]}" for o in outputs]
        *rest, last = [f"final_status(&why, {text});" for text in refused] or ["status_of(&why);"]
        return [*lines, *rest, f"return {last}"]

    def _unused(self) -> list[Value]:
        """Arrays that runs give and nothing uses: where they overflow the state is none either."""
        runs = (step for step in self.steps if isinstance(step, Run))
        return [t for run in runs for t in run.targets if t.size and t.name not in self.used]

    # ---- arrays ------------------------------------------------------------------------------

    def _size(self, value: Value) -> str:
        """Number of entries of one state."""
        return self.sizes.size(value)

    def _by(self, size: str) -> str:
        """So many entries of every state."""
        return times(size, "LANES") if self.lanes else size

    def _buffer(self, name: str, size: str) -> str:
        return f"{name}[{self._by(size)}]"

    def _given(self, step: Step, value: Value) -> str:
        """Where the user wants a value that can be written there at once; "" for none.

        What the user gives may be overwritten only when nothing reads it any more.
        """
        names = {a.name for a in self.f.inputs}
        wanted = [o.label for o in self.f.outputs if o.name == value.name]
        later = self.f.steps[self.f.steps.index(step) :]
        readers = [s for s in later if _reads(s, names)]
        if isinstance(step, Run) and not self.bundle.program.functions[step.function].leg_inputs:
            readers.remove(step)
        written = isinstance(step, Run) or (isinstance(step, Apply) and step.operation == "solve")
        return f"{wanted[0]}_out" if wanted and written and not (self.lanes or readers) else ""

    def _made(self, value: Value, step: Step | None = None, *, zero: bool = False) -> str:
        """An array for a value; zero where analysers do not see that all of it is written."""
        self.at[value.name] = value.name if value.size else "NULL"
        given = self._given(step, value) if step else ""
        if given:
            self.at[value.name] = given
        elif value.size:
            plain = zero or not (self.lanes or step)
            start = " = {0}" if plain else " CLEARED" * (not self.lanes)
            self.buffers.append(self._buffer(value.name, self._size(value)) + start)
        return self.at[value.name]

    def _inputs(self) -> list[str]:
        """Inputs that are read, their states side by side; q0 is taken where loops are closed."""
        lines, checks = [], list[str]()
        for a in self.f.inputs:
            if a.name not in self.read or a.default is Default.HOME_Q or not a.value.size:
                continue
            size, own = self._size(a.value), f"{a.name}_in"
            given = f"{size}, {a.name}"
            if a.positive:
                lines.append(f"require_positive({size}, {self.w}, {a.name}, why.invalid);")
            if self.lanes:
                self.buffers.append(self._buffer(own, size))
            ends = f"{own}, why.total" if self.lanes else "why.invalid"
            if a.default is Default.REST:
                call = "motion_of_base_side_by_side" if self.lanes else "motion_of_base"
                lines.append(f"{a.name} = {call}({a.name}, {ends});")
            elif a.default:
                call = "optional_side_by_side" if self.lanes else "optional"
                fill = FILL[a.default] if self.lanes else self._filled(a, size)
                lines.append(f"{a.name} = {call}({given}, {fill}, {ends});")
            elif self.lanes:
                lines.append(f"{a.name} = side_by_side({given}, {ends});")
            else:
                checks.append(given)
        calls = []
        for k in range(0, len(checks), 3):
            few = checks[k : k + 3]
            call = f"{_CHECKS[len(few)]}({', '.join(few)}, why.invalid);"
            calls += wrap(call, WIDTH - 4, "    ")
        return [*calls, *lines]

    def _filled(self, a: Argument, size: str) -> str:
        """A table of what stands for an input that is left out."""
        entries = "0" if a.default is Default.ZEROS else ", ".join("1" * a.value.size)
        self.tables += listing(f"static const real no_{a.name}[{size}] = {{", [entries], "};")
        return f"no_{a.name}"

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
        if "q" in function.inputs and "joints" not in self.at:
            joints = Value("joints", (self.bundle.coordinates.sizes["NJ"],))
            self.sizes.of["joints"] = ("NJ",)
            lines.append(f"close_loops(m, {self.w}, X, q0, {self._made(joints)}, &why);")
        targets = zip(function.arrays, step.targets, strict=True)
        arrays = {a: self._made(t, step) for a, t in targets}
        if set(results_of(self.f)) & {t.name for t in step.targets}:
            self.summed |= {t.name for t in step.targets}
        call = self.runs[step.function].call_with({"t": "&why", **arrays})
        return [*lines, *wrap(call, WIDTH - 4, "    ")]

    def _part(self, step: Apply) -> list[str] | None:
        """Results as parts of the operand; None where they are none."""
        if step.operation not in PARTS:
            return None
        (value,), numbers, first = step.operands, step.numbers, (*step.numbers, 0)[0]
        whole = step.targets[0].shape == value.shape
        row = times(*self.sizes.names(value)[1:])
        if step.operation == "split":
            places = [0, first]
        elif step.operation in ("same", "entry") or (step.operation == "extend" and whole):
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
                self.at[target.name] = self.at[value.name]
                continue
            self.at[target.name] = target.name
            at = self.sizes.name(place, (*step.targets, value))
            offset = f" + {self._by(times(at, row))}" if place else ""
            lines.append(f"const real *const {target.name} = {self.at[value.name]}{offset};")
        return lines

    def _applied(self, step: Apply) -> list[str]:
        """An operation at its operands."""
        name, in_place = step.operation, self._is_solved(step)
        if in_place:
            self.at[step.targets[0].name] = "work"
        zero = name not in ENTRIES and name != "solve"
        targets = ["work"] if in_place else [self._made(t, step, zero=zero) for t in step.targets]
        if not any(t.size for t in step.targets):
            return []
        fields = self._fields(step, targets)
        lines = []
        if name == "solve":
            return self._solve(step, fields)
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
        self.tables += listing(f"static const size_t {name}[] = {{", [rows], "};")
        return name

    def _solve(self, step: Apply, fields: dict[str, object]) -> list[str]:
        """Linear equations: straight through in the order of home, or with a choice of pivots.

        States side by side that are in doubt are left to be solved one by one.
        """
        filled = fields["a"] == "work"
        careful = [] if filled else ["set_matrix({m}, {w}, {a}, work);".format(**fields)]
        order = order_at_home(self.bundle, self.f, step)
        if self.lanes:
            careful.append(LANES["solve"].format(**fields))
        else:
            call = (
                SINGLE["solve"]
                if order is None
                else "solve_apart({m}, {b}, work, {x}, why.singular);"
            )
            careful.append(call.format(**fields))
        if order is None:
            self._needs_work(step)
            return careful
        straight, solved = self.eliminations.routine(len(order.rows)), step.targets[0].name
        known = self.eliminations.order(order, solved, self.f.name)
        names = {v: str(fields[v]) for v in "abx"}
        names |= {"order": f"order_{known}", "sizes": f"sizes_{known}"}
        stride = f"stride_of({fields['m']}, {self.w})" if filled else str(fields["m"])
        names |= {"w": self.w, "stride": stride, "unsure": "why.singular", "total": "why.total"}
        self.summed.add(step.targets[0].name)
        if self.lanes:
            if filled:
                self._needs_work(step)
            return [straight.call_with(names)]
        self._needs_work(step)
        unsure = f"unsure_{solved}"
        self.buffers.append(f"{unsure}[1] = {{0}}")
        careful.append("check({m}, 1, {x}, why.overflow);".format(**fields))
        return [
            straight.call_with(names | {"unsure": unsure}),
            f"if ({unsure}[0] > 0) {{",
            *indented(careful),
            "}",
        ]

    def _needs_work(self, step: Apply) -> None:
        """Room for a system."""
        n, name = step.operands[0].shape[0], self.sizes.names(step.operands[0])[0]
        self.work = max(self.work, (n, times(name, f"PADDED({name})")))

    def _is_solved(self, step: Apply) -> bool:
        """Whether the result is a matrix that stands where the next solution finds it."""
        later = self.f.steps[self.f.steps.index(step) + 1 :]
        solves = (s for s in later if isinstance(s, Apply) and s.operation == "solve")
        solved = next(solves, None)
        return (
            step.operation == "saddle"
            and solved is not None
            and (solved.operands[0] == step.targets[0])
        )

    def _fields(self, step: Apply, targets: Sequence[str]) -> dict[str, object]:
        """What calls are made of."""
        names = [self.sizes.names(o) for o in step.operands]
        m, n = (*names[0], "1", "1")[:2]
        p = (*names[1], "1", "1")[1] if len(names) > 1 else "1"
        target = step.targets[0]
        both = f"{m} + {p}" if not (m + p).isdigit() else str(int(m) + int(p))
        first = (*step.numbers, 0)[0]
        return {
            **dict(zip("abcd", (self.at[o.name] for o in step.operands), strict=False)),
            **dict(zip("xy", targets, strict=False)),
            **{
                f"all_{c}": self._by(self._size(o))
                for c, o in zip("abc", step.operands, strict=False)
            },
            "m": m, "n": n, "p": p, "w": self.w, "size": self._size(target),
            "stride": f"stride_of({both}, {self.w})" if "work" in targets else both,
            "all": self._by(self._size(target)),
            "row": self._by(n), "row_b": self._by(p),
            "count": self.sizes.name(len(step.numbers), (target, *step.operands)),
            "first": self.sizes.name(first, (*step.targets, *step.operands)) if first else 0,
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
            trials=interpret.HALVINGS if step.halving else 1,
            close="CLOSED" if step.halving else "MET",
            residual=residual.call_with(found | {"residual_out": "residual"}),
            slope=slope.call_with(found | {"slope_out": "slope"}),
            trial=residual.call_with({"X": "trial", "residual_out": "next"}),
        )  # fmt: skip
        self.before.append(text)
        arguments = ", ".join(("m", *others, step.start.name, self._made(step.target)))
        return [f"flag_status(search_{step.residual}({arguments}), &why);"]

    def _extent(self, name: str) -> str:
        """Number of entries of what a function gives."""
        function = next(f for f in self.bundle.program.public if f.name == name)
        return Sizes(self.bundle, function).size(function.outputs[0].value)


def _reads(step: Step, names: set[str]) -> bool:
    """Whether a step reads any of these arrays; a function, or a search, reads the inputs."""
    return not isinstance(step, Apply) or any(o.name in names for o in step.operands)
