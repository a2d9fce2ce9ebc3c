"""Arrays of public functions in C: where values stand, and how inputs are taken.

A state of its own gives its results where the user wants them; states side by side give theirs in
the end.
"""

from __future__ import annotations

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_operations import FILL
from pne_sym.backends.c_sizes import Sizes, times
from pne_sym.backends.c_text import WIDTH, listing
from pne_sym.backends.scalar import wrap
from pne_sym.program.interpret import inputs_read
from pne_sym.program.public import Apply, Argument, Default, PublicFunction, Run, Step, Value

_CHECKS = {1: "check_one", 2: "check_two", 3: "check_three"}


class Arrays:
    """Where the values of a public function stand.

    Args:
        bundle: of the model.
        function: what is printed.
        lanes: for states side by side.

    Attributes:
        at: name of a value -> the array that has it.
        buffers, tables: declarations.
        summed: values of which it is known from a sum whether they are finite.
    """

    def __init__(self, bundle: Bundle, function: PublicFunction, *, lanes: bool) -> None:
        self.bundle, self.f, self.lanes = bundle, function, lanes
        self.w = "LANES" if lanes else "1"
        self.sizes = Sizes(bundle, function)
        self.read = inputs_read(bundle.program, function)
        self.at = {a.name: a.name for a in function.inputs}
        self.buffers: list[str] = []
        self.tables: list[str] = []
        self.summed = set[str]()

    def size(self, value: Value) -> str:
        """Number of entries of one state."""
        return self.sizes.size(value)

    def by(self, size: str) -> str:
        """So many entries of every state."""
        return times(size, "LANES") if self.lanes else size

    def buffer(self, name: str, size: str) -> str:
        """The declaration of an array with so many entries of every state."""
        return f"{name}[{self.by(size)}]"

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

    def made(self, value: Value, step: Step | None = None, *, zero: bool = False) -> str:
        """An array for a value; zero where analysers do not see that all of it is written."""
        self.at[value.name] = value.name if value.size else "NULL"
        given = self._given(step, value) if step else ""
        if given:
            self.at[value.name] = given
        elif value.size:
            plain = zero or not (self.lanes or step)
            start = " = {0}" if plain else " CLEARED" * (not self.lanes)
            self.buffers.append(self.buffer(value.name, self.size(value)) + start)
        return self.at[value.name]

    def inputs(self) -> list[str]:
        """Inputs that are read, their states side by side; q0 is taken where loops are closed."""
        lines, checks = [], list[str]()
        for a in self.f.inputs:
            if a.name not in self.read or a.default is Default.HOME_Q or not a.value.size:
                continue
            size, own = self.size(a.value), f"{a.name}_in"
            given = f"{size}, {a.name}"
            if a.positive:
                lines.append(f"require_positive({size}, {self.w}, {a.name}, why.invalid);")
            if self.lanes:
                self.buffers.append(self.buffer(own, size))
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


def _reads(step: Step, names: set[str]) -> bool:
    """Whether a step reads any of these arrays; a function, or a search, reads the inputs."""
    return not isinstance(step, Apply) or any(o.name in names for o in step.operands)
