"""C code of the program's functions: parts, and what runs the parts."""

from __future__ import annotations

from dataclasses import dataclass

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_parts import Parts
from pne_sym.backends.c_sizes import array_names, count_of, times
from pne_sym.backends.c_stages import Stages
from pne_sym.backends.c_statements import vector_name
from pne_sym.backends.c_text import Routine, comment, indented, listing
from pne_sym.program.ir import Block, Function

LANES = 8


@dataclass(frozen=True)
class FunctionText:
    """A function of the program in C.

    Attributes:
        text: of its parts and of what runs them.
        one: runs it for one state, the legs side by side.
        lanes: for as many states as there are lanes, side by side; None where none wants it.
    """

    text: str
    one: Routine
    lanes: Routine | None

    def run(self, *, lanes: bool) -> Routine:
        """The routine for one state, or for the lanes."""
        routine = self.lanes if lanes else self.one
        assert routine is not None
        return routine


def function_text(
    bundle: Bundle, function: Function, stages: Stages, *, lanes: bool, summed: bool
) -> FunctionText:
    """A function of the program.

    Args:
        bundle: of the model.
        function: the function, with common sums.
        stages: what it shares with others.
        lanes: for states side by side too.
        summed: with the sum of all that it gives, to tell whether that is finite.
    """
    return _FunctionWriter(bundle, Parts(bundle, function, stages, summed=summed)).text(lanes=lanes)


class _FunctionWriter:
    def __init__(self, bundle: Bundle, parts: Parts) -> None:
        self.bundle, self.parts, self.f = bundle, parts, parts.f
        self.name = self.f.name
        self.before = self.parts.before()
        self.legs = [(b, self.parts.over(b), self.parts.place(b)) for b in self.parts.legs]
        self.adding = [b for b in self.parts.legs if b.sums]
        self.after = self.parts.after() if self.parts.last else None

    def text(self, *, lanes: bool) -> FunctionText:
        """All routines, each after what it calls."""
        lines = comment(f"---- {self.name} ----")
        lines += [*self.before.definition(), ""]
        for _, over, place in self.legs:
            lines += [*over.definition(), "", *place.definition(), ""]
        if self.after:
            lines += [*self.after.definition(), ""]
        one, many = self._run("1"), self._run("LANES") if lanes else None
        lines += one.definition()
        lines += ["", *many.definition()] if many else []
        return FunctionText("\n".join(lines), one, many)

    # ---- what runs the parts -------------------------------------------------------------

    def _run(self, w: str) -> Routine:
        """The parts one after another, for one state or for as many as there are lanes."""
        single = w == "1"
        body = [
            f"clear({a}, {times(*array_names(self.bundle, a), w)});"
            for a in self.f.arrays
            if not self.parts.is_full(a)
        ]
        body.append(self.before.call_with({"w": w}))
        body += self._side_by_side() if single else self._in_turn()
        if self.after:
            body.append(self.after.call_with({"w": w}))
        words = "\n".join(body)
        sizes = {"s": len(self.parts.passed), "sums": len(self.parts.sums)}
        names = [n for n, k in sizes.items() if k and f" {n}" in words]
        # gcc's analyzer does not see that the legs set all of it
        zero = " = {0}" * single
        buffers = [f"{n}[{times(sizes[n], w)}]{zero}" for n in names]
        head = listing("real ", buffers, ";") if buffers else []
        for block in self.parts.legs:
            width = f"LEGS({count_of(block.leg_type)})" if single else w
            rows = len(block.stores) + len(self.parts.flag_rows(block))
            terms = len(self.parts.sums) if single and block.sums else 0
            sizes = {f"terms_{block.leg_type}": terms, f"o_{block.leg_type}": rows}
            buffers = [f"{n}[{times(k, width)}]{zero}" for n, k in sizes.items() if k]
            head += listing("real ", buffers, ";") if buffers else []
        parameters = [
            "const prepared *m",
            *(f"const real *{vector_name(v)}" for v in self.f.inputs),
            *(f"real *{a}" for a in self.f.arrays),
            "verdict *t",
        ]
        return Routine.of(
            f"{self.name}_run{'' if single else '_lanes'}", parameters, [*head, *body]
        )

    def _side_by_side(self) -> list[str]:
        """The legs of one state, side by side; results may stand where inputs stood."""
        lines, ends = [], []
        for block, over, place in self.legs:
            legs = count_of(block.leg_type)
            given = {"w": "1", "count": f"LEGS({legs})", **self._arrays(block, single=True)}
            at = {"leg": "0", "legs": "1", "states": "0", "add": "0"}
            lines.append(over.call_with(given | at))
            if place.body:
                call = place.call_with({**given, "first": "leg"})
                ends += [f"for (size_t leg = 0; leg < {legs}; ++leg) {{", f"    {call}", "}"]
            if block.sums:
                ends += self._added(f"terms_{block.leg_type}", legs, block is self.adding[0])
        return lines + ends

    def _added(self, terms: str, legs: str, first: bool) -> list[str]:
        """What legs add to the sums, one after another over all types, as for states in lanes."""
        place = f"n*LEGS({legs})"
        line = f"sums[n] = total({terms} + {place}, {legs});"
        one_by_one = [
            f"for (size_t leg = 0; leg < {legs}; ++leg) {{",
            f"    sums[n] += {terms}[{place} + leg];",
            "}",
        ]
        return [
            f"for (size_t n = 0; n < {len(self.parts.sums)}; ++n) {{",
            *indented([line] if first else one_by_one),
            "}",
        ]

    def _in_turn(self) -> list[str]:
        """One leg after another, the states side by side."""
        lines = [f"clear(sums, {times(len(self.parts.sums), 'LANES')});"] if self.adding else []
        for block, over, place in self.legs:
            given = {"w": "LANES", "count": "LANES", **self._arrays(block, single=False)}
            at = {"legs": "0", "states": "1", "add": "1"}
            lines += [
                f"for (size_t leg = 0; leg < {count_of(block.leg_type)}; ++leg) {{",
                f"    {over.call_with(given | at)}",
                *([f"    {place.call_with({**given, 'first': '0'})}"] if place.body else []),
                "}",
            ]
        return lines

    def _arrays(self, block: Block, *, single: bool) -> dict[str, str]:
        """Arrays of what the legs give; states side by side are added up in place."""
        leg = block.leg_type
        return {"terms": f"terms_{leg}" if single else "sums", "o": f"o_{leg}"}
