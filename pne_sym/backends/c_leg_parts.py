"""The parts over the legs of a type in C: what a leg computes, gives, and where that belongs.

What a leg gives is in pieces, of which some are the same in other functions: what M gathers is what
dynamics gathers.  Places count from a piece's own first one, so that its text is the same anywhere.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from typing import NamedTuple

from pne_sym.backends.c_once import Once
from pne_sym.backends.c_parts import STATUSES, Parts
from pne_sym.backends.c_stage_texts import stage_routine
from pne_sym.backends.c_stages import Shared
from pne_sym.backends.c_statements import (
    entries,
    factor,
    headed,
    leg_input,
    loaded,
    statements,
    vector_name,
)
from pne_sym.backends.c_text import Routine, statement
from pne_sym.program.ir import Assignment, Block, Check, Store
from pne_sym.program.slices import read_by, symbols

_LEAST = 3  # lines that are worth a routine

Rows = list[tuple[str, list[str]]]
"""Lines with the equations that they are for."""


class Piece(NamedTuple):
    """Lines of a part, and the routine that they would be.

    Attributes:
        rows: where they stand in the part.
        routine: None where the lines read what only the part has.
        given: arguments of a call, where they are not of the same names.
    """

    rows: Rows
    routine: Routine | None = None
    given: tuple[tuple[str, str], ...] = ()

    def printed(self, once: Once) -> Rows:
        """The lines, or a call where others have the routine too."""
        if self.routine is None or not once.is_shared(self.routine):
            return self.rows
        return [("", [once.of(self.routine).call_with(dict(self.given))])]


class LegParts:
    """What a function does over the legs of a type."""

    def __init__(self, parts: Parts, block: Block) -> None:
        self.p, self.block, self.leg = parts, block, block.leg_type
        self.stages, self.f, self.bundle = parts.stages, parts.f, parts.bundle
        self.members = self.stages.members(parts.name, self.leg)
        self.prepared = parts.prepared(self.f.per_leg.get(self.leg, ()), "[i]")
        self.prepared |= parts.prepared(self.f.shared)
        self.here, self.apart = self._shared("v."), self._shared("v->")

    def _shared(self, prefix: str) -> Shared:
        """Prints expressions, where stages leave their values in a structure."""
        return Shared(self.members, prefix, self.prepared, self.p.known)

    def over(self, once: Once) -> Routine:
        """Computes leg i in state j: item k, of the legs of one state or of several states."""
        leg, tables = self.leg, list[str]()
        own = self.stages.own(self.p.name, self.block.assignments)
        reads = symbols(replace(self.block, assignments=tuple(own)))
        loads = self.p.passed_at("j") | entries(self.bundle, self.f, "j")
        inputs = [i for i in self.f.leg_inputs.get(leg, ()) if i.symbol.name in reads]
        loads |= {i.symbol.name: leg_input(self.bundle, i, leg, tables) for i in inputs}
        lines = self._stages()
        lines += statements(own, self.here, loads)
        rows = [row for piece in self.pieces(loads) for row in piece.printed(once)]
        lines += headed(rows)
        parameters = [
            "const prepared *m",
            *(f"size_t {n}" for n in ("w", "i", "j", "k", "count")),
            "int add",
            "const real *s",
            *(f"const real *{vector_name(v)}" for v in self.f.inputs),
            "real *terms",
            "real *o",
        ]
        return Routine.of(f"{self.p.name}_legs_{leg}", parameters, [*tables, *lines])

    def _stages(self) -> list[str]:
        """Calls of stages, which leave what they compute in v."""
        used = self.stages.used(self.p.name, self.leg)
        calls = [stage_routine(self.bundle, self.stages, s).call(v="&v") for s in used]
        return [f"values_{self.leg} v;", *calls] if calls else []

    def place(self) -> Routine:
        """Puts the entries of leg i in state k, which is item `at`, where they belong."""
        lines, tables = list[str](), list[str]()
        for n, store in enumerate(self.block.stores):
            legs = self.bundle.leg_counts[self.leg]
            place = factor(self.p.place_of(store, "i", f"place_{n}", tables, legs))
            lines.append(f"{store.array}[{place}*w + k] = o[{n}*count + at];")
        for flag, n in self.p.flag_rows(self.block).items():
            lines.append(f"t->{flag}[k] += o[{n}*count + at];")
        parameters = [
            *(f"size_t {n}" for n in ("w", "i", "k", "at", "count")),
            "const real *o",
            *(f"real *{a}" for a in self.f.arrays),
            "status_flags *t",
        ]
        return Routine.of(f"{self.p.name}_place_{self.leg}", parameters, [*tables, *lines])

    # ---- what a leg gives ----------------------------------------------------------------

    def pieces(self, loads: dict[str, str] | None = None) -> Iterator[Piece]:
        """What it adds to sums, its entries, their sum, and its flags; loads: of what they read."""
        loads = {} if loads is None else loads
        for first, last in self._runs(self.block.sums):
            sums = self.block.sums[first:last]
            at = [self.p.sums.index(str(s.target)) for s in sums]
            here = _added(sums, at, self.here, loads)
            apart = _added(sums, [n - min(at) for n in at], self.apart, {})
            yield self._piece("sums", here, apart, sums, ("terms", min(at)))
        for first, last in self._runs(self.block.stores):
            stores = self.block.stores[first:last]
            here = _stored(stores, first, self.here, loads)
            apart = _stored(stores, 0, self.apart, {})
            yield self._piece("entries", here, apart, stores, ("o", first))
        for flag, n in self.p.flag_rows(self.block).items():
            yield self._flag(flag, n, loads)

    def _runs(self, given: Sequence[object]) -> Iterator[tuple[int, int]]:
        """First and last place (the latter not included) of what the same functions give."""
        first = 0
        for _, group in groupby(given, key=lambda g: self.stages.givers(self.leg, g)):
            last = first + len(list(group))
            yield first, last
            first = last

    def _flag(self, flag: str, n: int, loads: dict[str, str]) -> Piece:
        """A flag, or the sum of the entries, at place n."""
        target = f"o[{n}*count + k] ="
        if flag not in STATUSES:
            return Piece([("", statement(f"{target} {self.p.summed_up(self.block, self.here)}"))])
        checks = [c for c in self.block.checks if c.status == flag]
        here = [("", self.p.flags(checks, target, loads, self.here))]
        apart = [("", self.p.flags(checks, "o[k] =", {}, self.apart))]
        return self._piece(flag, here, apart, checks, ("o", n))

    def _piece(
        self,
        name: str,
        here: Rows,
        apart: Rows,
        items: Iterable[Assignment | Check | Store],
        at: tuple[str, int],
    ) -> Piece:
        """Lines, and the routine of the same where they read what stages leave alone."""
        read = read_by(items)
        body = headed(apart)
        if not read <= self.members | self.prepared.keys() or len(body) < _LEAST:
            return Piece(here)
        parameters = [
            "const prepared *m",
            *(f"size_t {n}" for n in ("i", "k", "count")),
            "int add",
            f"const values_{self.leg} *v",
            "real *terms",
            "real *o",
        ]
        array, first = at
        moved = f"{array} + {first}*count" if first else array
        routine = Routine.of(f"{self.p.name}_{name}_{self.leg}", parameters, body)
        return Piece(here, routine, (("v", "&v"), (array, moved)))


def _added(
    sums: Iterable[Assignment], at: Iterable[int], shared: Shared, loads: dict[str, str]
) -> Rows:
    """What a leg adds to sums at these places."""
    rows = []
    for n, s in zip(at, sums, strict=True):
        text = f"gather(&terms[{n}*count + k], add, {shared.text(s.expr)});  /* {s.target} */"
        rows.append((s.equation, [*loaded(loads, s.expr), text]))
    return rows


def _stored(stores: Iterable[Store], first: int, shared: Shared, loads: dict[str, str]) -> Rows:
    """Entries that a leg gives, from a place on."""
    rows = []
    for n, s in enumerate(stores, first):
        text = statement(f"o[{n}*count + k] = {shared.text(s.value)}")
        rows.append((s.equation, [*loaded(loads, s.value), *text]))
    return rows
