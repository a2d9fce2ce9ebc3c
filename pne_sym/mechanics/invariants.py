"""What the joints beyond one cannot change: the equations from which displacements are found.

* linear: a direction u fixed in link j, along all later revolute axes and
  across all later slides; u . x keeps its value;
* sphere: all later joints are revolutes through one centre; its distance to
  the connection point is fixed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.vector import Cross, Dot, Vector, ZeroVector, vector_sum


class Invariants:
    """Invariants of the distal sub-chains of a leg.

    Args:
        g: geometry of the leg type.
        q: displacements by joint: those of extra joints, and of joints that are found.
    """

    def __init__(self, g: LegGeometry, q: Mapping[int, Any]) -> None:
        self.g, self.q = g, q

    def later(self, j: int) -> list[int]:
        """Joints beyond joint j that are to be found and move the connection point."""
        return [
            k
            for k in range(j + 1, self.g.count + 1)
            if not self.g.is_extra(k) and not self.g.is_unseen(k)
        ]

    def of_joint(self, j: int) -> tuple[str, Vector, Any] | None:
        """(method, vector u fixed in link j, value of u . x) for joint j."""
        g, later = self.g, self.later(j)
        turning = [k for k in later if not g.acts_as_slide(k)]
        sliding = [k for k in later if g.acts_as_slide(k)]
        if any(g.slides(k) for k in turning):
            return None
        if (
            turning
            and all(g.parallel(turning[0], k) for k in turning)
            and all(g.perpendicular(turning[0], k) for k in sliding)
            and self._useful(j, turning[0])
        ):
            return "linear", g.e[turning[0]], self._constant(j, turning[0])
        if not turning and sliding and len(sliding) == 1:
            found = self._across_slide(j, sliding[0])
            if found is not None:
                return found
        if turning and not sliding:
            return self._sphere(j, turning)
        return None

    def of_slide(self, j: int) -> tuple[str, Vector, Any] | None:
        """The same of a joint that slides; its own axis where nothing follows."""
        g, e = self.g, self.g.e[j]
        if self.later(j):
            return self.of_joint(j)
        offsets = (Dot(e, g.offset[i]) for i in range(j + 1, g.count + 2))
        return "direct", e, sp.Add(*offsets, *(y * Dot(e, a) for y, a in self.extra_slides(j)))

    def _useful(self, j: int, k: int) -> bool:
        """Whether u = e_k tells joint j: not along its axis (R), not across it (P)."""
        if not self.g.acts_as_slide(j):
            return self.g.parallel(j, k) == 0
        return not self.g.perpendicular(j, k)

    def _constant(self, j: int, k: int) -> Any:
        """u . (sum of later offsets) for u = e_k, each term in its own link."""
        g = self.g
        terms = []
        for i in range(j + 1, g.count + 2):
            if g.offset[i] == ZeroVector or self._lies_along(i, j):
                continue
            near = (*range(i - 1, j, -1), *([i] if i <= g.count else []))
            own = next((m for m in near if g.turns(m) and g.parallel(m, k)), k)
            terms.append(g.parallel(own, k) * Dot(g.e[own], g.offset[i]))
        return sp.Add(*terms, *(y * Dot(g.e[k], axis) for y, axis in self.extra_slides(j)))

    def _lies_along(self, i: int, j: int) -> bool:
        """Whether offset i lies along the axis of a helical joint, across joint j's direction."""
        opening = self.g.group[i - 1]
        return opening > j and self.g.acts_as_slide(opening)

    def extra_slides(self, j: int) -> list[tuple[Any, Vector]]:
        """Displacement and axis of the extra joints beyond joint j that slide."""
        g = self.g
        return [
            (self.q[i] * g.advance(i), g.e[i])
            for i in range(j + 1, g.count + 1)
            if g.is_extra(i) and g.slides(i)
        ]

    def beyond(self, j: int) -> Vector:
        """From joint j to the connection point, if all joints beyond are extra or unseen."""
        g = self.g
        offsets = [g.offset[i] for i in range(j + 1, g.count + 2)]
        return vector_sum([*offsets, *(y * axis for y, axis in self.extra_slides(j))])

    def _across_slide(self, j: int, p: int) -> tuple[str, Vector, Any] | None:
        g = self.g
        if g.parallel(j, p):
            return None
        u: Vector = g.e[j]
        if not g.acts_as_slide(j):
            u = Cross(u, g.e[p])
        elif not g.perpendicular(j, p):
            u = u - Dot(u, g.e[p]) * g.e[p]
        constant = sp.Add(
            *(Dot(u, g.offset[i]) for i in range(j + 1, g.count + 2) if not self._lies_along(i, j)),
            *(y * Dot(u, axis) for y, axis in self.extra_slides(j)),
        )
        return "linear", u, constant

    def _sphere(self, j: int, turning: list[int]) -> tuple[str, Vector, Any] | None:
        g = self.g
        first = turning[0]
        between = [g.offset[i] for i in range(first + 1, g.count + 1)]
        if any(a != ZeroVector for a in between) or turning != list(range(first, g.count + 1)):
            return None
        centre = vector_sum(
            [
                *(g.offset[i] for i in range(j + 1, first + 1)),
                *(self.q[i] * g.slide(i) for i in range(j + 1, first) if g.slides(i)),
            ]
        )
        return "sphere", centre, g.offset[g.count + 1]

    def goes_on(self, j: int) -> bool:
        """Whether the joint after j is found from the components in link j's axes alone."""
        g, k = self.g, j + 1
        if k > g.count or g.offset[k] != ZeroVector or g.is_extra(k) or g.is_unseen(k):
            return False
        if g.turns(k):
            found = None if g.slides(k) else self.of_joint(k)
            return found is not None and found[0] == "linear" and k in g.turn_axes
        return k in self.q

    def reaches(self, j: int) -> bool:
        """Whether the next joint, the last, extends the leg from joint j to its end."""
        g, k = self.g, j + 1
        if k != g.count or g.turns(k) or g.is_extra(k):
            return False
        along = g.axis_pattern(j, k)
        return g.offset[k] == g.offset[k + 1] == ZeroVector and along == (1, 0, 0)

    def pattern(self, j: int, method: str, u: Vector) -> tuple[Any, Any, Any]:
        """Components of u in link j's canonical axes where the structure fixes them, else None."""
        g = self.g
        if method == "orientation":
            return g.end_pattern
        for k in range(1, g.count + 1):
            if u == g.e[k]:
                return g.axis_pattern(j, k)
            if u == Cross(g.e[j], g.e[k]):
                along_x, along_y, _ = g.axis_pattern(j, k)
                turned = None if along_y is None else -along_y
                return (turned, along_x, sp.S.Zero)
            if method == "sphere" and u == g.offset[k] and g.group[k - 1] == j:
                zero = g.offset_is_zero(j, k)
                return tuple(sp.S.Zero if z else None for z in zero)  # type: ignore[return-value]
        return (None, None, None)
