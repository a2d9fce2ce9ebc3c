"""Where the links of a leg are, along its chain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.vector import Vector, ZeroVector, vector_sum


@dataclass(frozen=True)
class LegChain:
    """Positions along a leg.

    Attributes:
        g: its geometry.
        q: displacements by joint.
    """

    g: LegGeometry
    q: Mapping[int, Any]

    @property
    def joints(self) -> range:
        """Numbers of the joints."""
        return range(1, self.g.count + 1)

    @cached_property
    def turning(self) -> list[int]:
        """Joints that turn their links, and so open groups."""
        return [j for j in self.joints if self.g.turns(j)]

    @cached_property
    def extras(self) -> list[int]:
        """Joints whose displacements are coordinates of their own."""
        return [j for j in self.joints if self.g.is_extra(j)]

    @property
    def last(self) -> int:
        """Group of the last link."""
        return self.g.group[self.g.count]

    @property
    def tip_frame(self) -> str:
        """Canonical frame of the last link."""
        return self.g.frame("axes", self.last)

    def slides(self, group: int, last: int | None = None) -> list[int]:
        """Sliding joints of a group, up to the last one that counts."""
        numbers = self.joints if last is None else range(1, last + 1)
        return [j for j in numbers if self.g.group[j] == group and self.g.slides(j)]

    def reach(self, j: int) -> Vector:
        """From the origin of the group of link j to the origin of link j."""
        first = self.g.group[j]
        terms = [self._along(first)] if first else []
        for i in range(first + 1, j + 1):
            terms.extend((self.g.offset[i], self._along(i)))
        return vector_sum(terms)

    def _along(self, j: int) -> Vector:
        """Displacement along axis j."""
        return self.q[j] * self.g.slide(j) if self.g.slides(j) else ZeroVector

    @cached_property
    def spans(self) -> dict[int, Vector]:
        """From the origin of a group to the next group's joint, or to the connection point."""
        last = {group: j for j, group in sorted(self.g.group.items())}
        return {
            group: vector_sum((self.reach(last[group]), self.g.offset[last[group] + 1]))
            for group in [0, *self.turning]
        }
