"""What public functions in C end with: statuses, and results where the user wants them."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from pne_sym.backends.c_arrays import Arrays
from pne_sym.backends.c_text import indented, statement
from pne_sym.program.public import Run, Step, Value


class Results:
    """Prints the end of a function.

    Args:
        arrays: of the function.
        used: names of values that steps read, or that users get.
        steps: those that stand in the function itself, not in one that it calls.
    """

    def __init__(self, arrays: Arrays, used: Collection[str], steps: Iterable[Step]) -> None:
        self.arrays = arrays
        f, at = arrays.f, arrays.at
        self.outputs = [o for o in f.outputs if o.value.size]
        self.wanted = {o.name: f"{o.label}_out" for o in self.outputs}
        self.judged = [] if f.unbounded else [o.value for o in self.outputs]
        self.moved = [o.value for o in self.outputs if at[o.name] != self.wanted[o.name]]
        # where arrays that runs give and nothing uses overflow, the state is none either
        runs = [step for step in steps if isinstance(step, Run)] * (not f.unbounded)
        self.unused = [t for r in runs for t in r.targets if t.size and t.name not in used]

    def lines(self) -> list[str]:
        """The status, and results where the user wants them."""
        return self._of_lanes() if self.arrays.lanes else self._of_one()

    def _of_lanes(self) -> list[str]:
        apart = [v for v in self.judged if v.name not in self.arrays.summed]
        sums = [f"add_up({self._at(v)}, why.total);" for v in (*apart, *self.unused)]
        return [*sums, "status_side_by_side(&why, code);", *self._moves("copy_side_by_side")]

    def _of_one(self) -> list[str]:
        summed = [v for v in self.judged if v.name in self.arrays.summed]
        apart = [v for v in self.judged if v not in summed]
        values = [o.value for o in self.outputs]
        if len(values) == 1 and apart == self.moved == values and not self.unused:
            ends = f"{self._at(values[0])}, {self.wanted[values[0].name]}"
            return statement(f"return finished({ends}, &why)")
        lines = [*map(self._check, (*apart, *self.unused)), *self._moves("copy")]
        if summed:
            checks = indented(map(self._check, summed))
            lines[:0] = ["if (!is_finite(why.total[0])) {", *checks, "}"]
        refused = [f"{self.arrays.size(v)}, {self.wanted[v.name]}" for v in values]
        *rest, last = [f"final_status(&why, {text});" for text in refused] or ["status_of(&why);"]
        return [*lines, *rest, f"return {last}"]

    def _at(self, value: Value) -> str:
        return f"{self.arrays.size(value)}, {self.arrays.at[value.name]}"

    def _check(self, value: Value) -> str:
        """Tells where a value is not finite."""
        return f"check({self.arrays.size(value)}, 1, {self.arrays.at[value.name]}, why.overflow);"

    def _moves(self, move: str) -> list[str]:
        return [f"{move}({self._at(v)}, {self.wanted[v.name]});" for v in self.moved]
