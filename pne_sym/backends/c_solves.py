"""Linear equations of public functions in C: what solves a system, and where it stands."""

from __future__ import annotations

from collections.abc import Mapping

from pne_sym.backends.c_arrays import Arrays
from pne_sym.backends.c_operations import LANES, SINGLE
from pne_sym.backends.c_sizes import times
from pne_sym.backends.c_solve import Eliminations
from pne_sym.backends.c_text import indented
from pne_sym.backends.orders import Order, order_at_home
from pne_sym.program.public import Apply


class Solves:
    """Prints solutions of linear equations.

    Args:
        arrays: of the function.
        eliminations: routines and tables that solve small systems; new ones are added.
    """

    def __init__(self, arrays: Arrays, eliminations: Eliminations) -> None:
        self.arrays, self.eliminations = arrays, eliminations
        self.work = (0, "")

    def buffer(self) -> list[str]:
        """Room for the largest system."""
        return [self.arrays.buffer("work", self.work[1])] if self.work[0] else []

    def solve(self, step: Apply, fields: Mapping[str, object]) -> list[str]:
        """Straight through in the order of home, or with a choice of pivots.

        States side by side that are in doubt are left to be solved one by one.
        """
        order = order_at_home(self.arrays.bundle, self.arrays.f, step)
        filled, lanes = fields["a"] == "work", self.arrays.lanes
        if order is None or filled or not lanes:
            n, name = step.operands[0].shape[0], self.arrays.sizes.names(step.operands[0])[0]
            self.work = max(self.work, (n, times(name, f"PADDED({name})")))
        if order and lanes:
            return [self._straight(step, order, fields, "why.singular")]
        careful = [] if filled else ["set_matrix({m}, {w}, {a}, work);"]
        if order is None:
            careful.append((LANES if lanes else SINGLE)["solve"])
            return [line.format(**fields) for line in careful]
        careful.append("solve_apart({m}, {b}, work, {x}, why.singular);")
        careful.append("check({m}, 1, {x}, why.overflow);")
        unsure = f"unsure_{step.targets[0].name}"
        self.arrays.buffers.append(f"{unsure}[1] = {{0}}")
        return [
            self._straight(step, order, fields, unsure),
            f"if ({unsure}[0] > 0) {{",
            *indented(line.format(**fields) for line in careful),
            "}",
        ]

    def _straight(
        self, step: Apply, order: Order, fields: Mapping[str, object], unsure: str
    ) -> str:
        """A call of the elimination, which adds the solution to the total."""
        solved, m, w = step.targets[0].name, fields["m"], self.arrays.w
        routine = self.eliminations.routine(len(order.rows))
        known = self.eliminations.order(order, solved, self.arrays.f.name)
        self.arrays.summed.add(solved)
        names = {v: str(fields[v]) for v in "abx"}
        names |= {"order": f"order_{known}", "sizes": f"sizes_{known}", "w": w}
        names["stride"] = f"stride_of({m}, {w})" if fields["a"] == "work" else str(m)
        return routine.call_with(names | {"unsure": unsure, "total": "why.total"})

    def is_solved(self, step: Apply) -> bool:
        """Whether the result is a matrix that stands where the next solution finds it."""
        later = self.arrays.f.steps[self.arrays.f.steps.index(step) + 1 :]
        solves = (s for s in later if isinstance(s, Apply) and s.operation == "solve")
        solved = next(solves, None)
        return (
            step.operation == "saddle"
            and solved is not None
            and solved.operands[0] == step.targets[0]
        )
