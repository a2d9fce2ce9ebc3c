"""Everything written about a leg type, and sums over legs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from pne_sym.mechanics.leg_dynamics import LegDynamics
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.leg_motion import LegMotion
from pne_sym.vector import ZeroTensor, ZeroVector, sum_over_legs


class Leg(NamedTuple):
    """Everything written about one leg type."""

    g: LegGeometry
    motion: LegMotion
    dynamics: LegDynamics

    @property
    def name(self) -> str:
        """Name of the leg type."""
        return self.g.leg_type.name


def plus_sums(start: Any, legs: Sequence[Leg], pick: Callable[[Leg], Any]) -> Any:
    """A quantity plus that of the legs, summed over the legs of all types."""
    for leg in legs:
        value = pick(leg)
        if value != 0 and value not in (ZeroVector, ZeroTensor):
            start = start + sum_over_legs(value, leg.name)
    return start
