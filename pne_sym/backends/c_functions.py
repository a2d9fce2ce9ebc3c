"""C code of the program's functions: parts, and what runs the parts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_after import After
from pne_sym.backends.c_leg_parts import LegParts
from pne_sym.backends.c_once import Once
from pne_sym.backends.c_parts import Parts
from pne_sym.backends.c_sizes import array_names, count_of, one_state, times
from pne_sym.backends.c_stages import Stages
from pne_sym.backends.c_statements import vector_name
from pne_sym.backends.c_text import (
    WIDTH,
    Routine,
    comment,
    indented,
    listing,
    side_by_side,
)
from pne_sym.backends.scalar import wrap
from pne_sym.program.ir import Block, Function

LANES = 8


class FunctionText(NamedTuple):
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


class FunctionWriter:
    """Prints a function of the program.

    Args:
        bundle: of the model.
        function: the function, with common sums.
        stages: what it shares with others.
        summed: with the sum of all that it gives, to tell whether that is finite.
    """

    def __init__(self, bundle: Bundle, function: Function, stages: Stages, *, summed: bool) -> None:
        self.bundle, self.f, self.name = bundle, function, function.name
        self.parts = Parts(bundle, function, stages, summed=summed)
        self.before, self.between = self.parts.before(), self.parts.between()
        self.over = [LegParts(self.parts, b) for b in self.parts.legs]
        self.places = [legs.place() for legs in self.over]
        self.legs: list[tuple[Block, Routine, Routine]] = []
        self.adding = [b for b in self.parts.legs if b.sums]
        self.behind, self.after = After(self.parts), Routine("", (), ())
        self.passed, self.sums = f"PASSED_IN_{self.name}", f"SUMS_OF_{self.name}"

    def routines(self) -> list[tuple[str, Routine]]:
        """The parts, each with a name that says nothing of the function."""
        found = [self.before, self.between, *self.places]
        pieces = (p for legs in self.over for p in legs.pieces())
        found += [p.routine for p in pieces if p.routine]
        found += [piece.routine for piece in self.behind.pieces]
        return [(f"any{r.name.removeprefix(self.name)}", r) for r in found]

    def text(self, once: Once, single: int, many: int) -> FunctionText:
        """All routines, each after what it calls; several users call the same, compiled once.

        Args:
            once: routines that functions have in common, which stand elsewhere.
            single: how many public functions run it for one state.
            many: and for states side by side.
        """
        lines = comment(f"---- {self.name} ----")
        self.legs = [
            (legs.block, legs.over(once), place)
            for legs, place in zip(self.over, self.places, strict=True)
        ]
        self.after = self.behind.routine(once)
        over = [r for _, *both in self.legs for r in both]
        for routine in (self.before, self.between, *over, self.after):
            lines += once.own(routine)
        self.before, self.between = once.of(self.before), once.of(self.between)
        self.legs = [(b, over, once.of(place)) for b, over, place in self.legs]
        one = self._run("1", one_state(self.bundle, self._kind(single)))
        lanes = self._run("LANES", "APART" if self.adding else self._kind(many)) if many else None
        lines += [*self._sizes(one), *one.definition()]
        lines += ["", *lanes.definition()] if lanes else []
        return FunctionText("\n".join(lines), one, lanes)

    def _kind(self, users: int) -> str:
        """How the compiler is to treat what so many call.

        Two that do more with it have it each, so that its buffers and theirs share the stack.
        """
        return "APART" if users > (1 if self.parts.summed else 2) else "INLINE"

    def _sizes(self, run: Routine) -> list[str]:
        """Sizes of what parts pass on, by name: where more is passed on, one line changes."""
        sizes = {self.passed: len(self.parts.passed), self.sums: len(self.parts.sums)}
        used = {n: k for n, k in sizes.items() if n in "\n".join(run.body)}
        lines = [f"#define {name} ((size_t){size})" for name, size in used.items()]
        return [*lines, ""] if lines else []

    # ---- what runs the parts -------------------------------------------------------------

    def _run(self, w: str, kind: str) -> Routine:
        """The parts one after another, for one state or for as many as there are lanes."""
        single = w == "1"
        # results of one state may stand where inputs stood; those of lanes have buffers
        pointer = "*" if single else "*restrict "
        body = [
            f"clear({a}, {times(*array_names(self.bundle, a), w)});"
            for a in self.f.arrays
            if not self.parts.is_full(a)
        ]
        body += self._one_state() if single else self._states()
        body += _each(self.after, w, {"w": w})
        words = "\n".join(body)
        counts = {"s": len(self.parts.passed), "sums": len(self.parts.sums)}
        sizes = {"s": self.passed, "sums": self.sums}
        names = [n for n, k in counts.items() if k and f" {n}" in words]
        start = " CLEARED" * single
        real = "real " if single else "ALIGNED real "
        buffers = [f"{n}[{times(sizes[n], w)}]{start}" for n in names]
        head = listing(real, buffers, ";") if buffers else []
        for block in self.parts.legs:
            buffers = self._given(block, start) if single else self._given_in_lanes(block)
            head += listing(real, buffers, ";") if buffers else []
        parameters = [
            "const prepared *m",
            *(f"const real *{vector_name(v)}" for v in self.f.inputs),
            *(f"real {pointer}{a}" for a in self.f.arrays),
            f"status_flags {pointer}t",
        ]
        name = f"{self.name}_run{'' if single else '_lanes'}"
        return Routine.of(name, parameters, [*head, *body], kind)

    def _given(self, block: Block, start: str) -> list[str]:
        """Buffers for what the legs of one state give; zero in sums to which they add nothing."""
        leg, sums = block.leg_type, self.parts.sums
        width = f"LEGS({count_of(leg)})"
        rows = len(block.stores) + len(self.parts.flag_rows(block))
        buffers = [f"o_{leg}[{times(rows, width)}]{start}"] if rows else []
        if block.sums:
            every = {str(s.target) for s in block.sums}.issuperset(sums)
            terms = f"terms_{leg}[{times(self.sums, width)}]"
            buffers.insert(0, terms + (start if every else " = {0}"))
        return buffers

    def _given_in_lanes(self, block: Block) -> list[str]:
        """A buffer for what one leg gives in all lanes; terms are added up where sums stand."""
        rows = len(block.stores) + len(self.parts.flag_rows(block))
        return [f"o_{block.leg_type}[{times(rows, 'LANES')}]"] if rows else []

    def _one_state(self) -> list[str]:
        """One state up to its sums: what only these meet comes after the legs."""
        given = {"w": "1", "k": "0", "v": "&v"}
        parts = (self.before, self.between)
        first, last = ([p.call_with(given)] if p.body else [] for p in parts)
        return [*_values([*first, *last]), *first, *self._side_by_side(), *last]

    def _states(self) -> list[str]:
        """States side by side, up to their sums."""
        parts = [p for p in (self.before, self.between) if p.body]
        calls = [p.call_with({"w": "LANES", "v": "&v"}) for p in parts]
        loop = side_by_side("LANES", [*_values(calls), *calls])
        return [*(loop if calls else []), *self._in_turn()]

    def _side_by_side(self) -> list[str]:
        """The legs of one state, side by side; results may stand where inputs stood."""
        lines, ends = [], []
        for block, over, place in self.legs:
            legs = count_of(block.leg_type)
            given = {"w": "1", "count": f"LEGS({legs})", **self._arrays(block, single=True)}
            lines += self._over_legs(over, legs, {**given, "j": "0", "add": "0"})
            if place.body:
                call = place.call_with({**given, "k": "0", "at": "i"})
                ends += [f"for (size_t i = 0; i < {legs}; ++i) {{", f"    {call}", "}"]
            if block.sums:
                ends += self._added(f"terms_{block.leg_type}", legs, block is self.adding[0])
        return lines + ends

    def _over_legs(self, over: Routine, legs: str, given: Mapping[str, str]) -> list[str]:
        """All legs in one loop; one vector after another where solving follows at once."""
        if self.parts.summed:
            return _each(over, f"LEGS({legs})", {**given, "i": "k"})
        one = over.call_with({**given, "i": "i + k", "k": "i + k"})
        return [
            f"for (size_t i = 0; i < LEGS({legs}); i += BESIDE({legs})) {{",
            *indented(side_by_side(f"BESIDE({legs})", wrap(one, WIDTH - 12, "    "))),
            "}",
        ]

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
            f"for (size_t n = 0; n < {self.sums}; ++n) {{",
            *indented([line] if first else one_by_one),
            "}",
        ]

    def _in_turn(self) -> list[str]:
        """One leg after another, the states side by side."""
        lines = [f"clear(sums, {times(self.sums, 'LANES')});"] if self.adding else []
        for block, over, place in self.legs:
            given = {"w": "LANES", "count": "LANES", **self._arrays(block, single=False)}
            lines += [
                f"for (size_t i = 0; i < {count_of(block.leg_type)}; ++i) {{",
                *indented(_each(over, "LANES", {**given, "j": "k", "add": "1"})),
                *indented(_each(place, "LANES", {**given, "at": "k"}) if place.body else []),
                "}",
            ]
        return lines

    def _arrays(self, block: Block, *, single: bool) -> dict[str, str]:
        """Arrays of what the legs give; states side by side are added up in place."""
        leg = block.leg_type
        return {"terms": f"terms_{leg}" if single else "sums", "o": f"o_{leg}"}


def _values(calls: list[str]) -> list[str]:
    """Where the stages of a state leave what they compute, where calls want it."""
    return ["values v;"] if any("&v" in call for call in calls) else []


def _each(part: Routine, count: str, given: Mapping[str, str]) -> list[str]:
    """Calls of a part for every k."""
    if not part.body:
        return []
    if count == "1":
        return [part.call_with({**given, "k": "0"})]
    return side_by_side(count, [part.call_with(given)])
