"""How far each leg is from what the guards refuse: the guards' values as numbers to be returned."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from pne_sym.derivation import Derivation
from pne_sym.lowering.builder import Builder
from pne_sym.lowering.statements import Atom
from pne_sym.program.ir import Check, Kind, Stage, Store

_NOTHING_TESTED = sp.S.One
OWN_NAMES = frozenset({"pivot_size", "pivot", "pivot_root", "least_pivots", "least_reach"})
"""Of values that belong to no quantity."""


class Margins:
    """The guards of the legs as entries of two arrays, an entry per leg.

    `pivots`: the least tested pivot over its scale, one where nothing is tested.  `reach`: the
    least of what must not be negative.

    Attributes:
        guards: those that are looked at, each in the loop over its legs.
        stores: the entries.
    """

    def __init__(self, derivation: Derivation, b: Builder, guards: Sequence[Check]) -> None:
        self.b = b
        leg_type = {e.id: c.leg_type for c in derivation.chapters for e in c.equations}
        self.guards: list[Check] = []
        self.stores: list[Store] = []
        for info in derivation.leg_types:
            stage = Stage(Kind.STATE_LEG, info.name)
            own = [replace(g, stage=stage) for g in guards if leg_type[g.equation] == info.name]
            singular = [g for g in own if g.status == "singular"]
            reached = [g for g in own if g.status == "unreachable"]
            self.guards += own
            self._put("pivots", stage, [self._pivot(g) for g in singular], info.indices)
            if reached:
                self._put("reach", stage, [g.value for g in reached], info.indices)

    def _pivot(self, guard: Check) -> Atom:
        """The tested value over its scale: a ratio of lengths, not of their squares."""
        self.b.equation = guard.equation
        size = self.b.let(sp.Abs(guard.value), "pivot_size")
        ratio = self.b.mul(size, self.b.inverse(guard.scale), "pivot")
        return ratio if guard.power == 1 else self.b.let(sp.sqrt(ratio), "pivot_root")

    def _put(self, array: str, stage: Stage, values: list[Any], legs: tuple[int, ...]) -> None:
        least = (
            self.b.let(sp.Min(*values, evaluate=False), f"least_{array}")
            if values
            else _NOTHING_TESTED
        )
        self.stores.append(Store(array, least, legs, equation=self.b.equation, stage=stage))
