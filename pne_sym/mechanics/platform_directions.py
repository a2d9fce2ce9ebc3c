"""Directions of the last link and of the platform that a platform joint keeps perpendicular."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pne_sym.derivation import Book
from pne_sym.mechanics.directions import AXES, pattern_of, unit
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.leg_parameters import LegParameters
from pne_sym.mechanics.live import END
from pne_sym.mechanics.structure import LegType, is_coordinate
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.model.kinematics import Array
from pne_sym.model.manipulator import Leg, PlatformJoint
from pne_sym.model.platform_kinds.interface import Direction
from pne_sym.vector import Cross, norm

_TERMS = glossary(r"""
end_axis      | \hat{\mathbf l} | given @last
    axis of the platform joint in the last link
end_across    | \hat{\mathbf i}_{#} | given @last
    direction # of the last link, well across that axis
end_l#        | \hat{\mathbf l}_{#} | given @last
    direction of the platform joint, fixed in the last link
end_l#:across | \hat{\mathbf l}_{#} | LUMPING constant @last
    direction # across the platform joint's axis, fixed in the last link
end_p#        | \hat{\mathbf p}_{#} | given @platform
    direction of the platform joint, fixed in the platform
""")


class PlatformDirections:
    """Writes the pairs of directions.

    Attributes:
        pattern: canonical components of the platform joint's axis in the last link: 0, 1, -1 by
            structure, else None.
    """

    def __init__(self, book: Book, geometry: LegGeometry, given: LegParameters) -> None:
        self.g, self.given, self.type = geometry, given, geometry.leg_type
        self.pattern: tuple[Any, ...] = ()
        self.eq = Writer(book, geometry, _TERMS)

    def write(self) -> None:
        """Pairs of directions that the platform joint keeps perpendicular (7.4)."""
        end = self.type.model.platform_joint
        if self.given.planar or not end.right_angles:
            return
        stated = {name: self._stated(name) for name in end.kind.fields}
        live_axis = end.axis_link is not None and not is_coordinate(end.axis_link)
        if live_axis and any(link.across for link, _ in end.right_angles):
            self._two_across(stated["axis_link"], stated["axis_platform"])
            return
        for k, (link, platform) in enumerate(end.right_angles):
            self._pair(k, _components(link, stated), _components(platform, stated))

    def _two_across(self, axis: Any, platform: Any) -> None:
        """Two orthogonal directions across an axis that is not along a coordinate direction."""
        a = self.eq.give("end_axis", axis)
        k = across(self.type)
        d = self.eq.give("end_across", unit(AXES[k]), "xyz"[k])
        w = self.eq.give("end_p#", platform, 1)
        side = Cross(a, d)
        first = self.eq("end_l#:across", side / norm(side), 1)
        self.g.pairs.append((first, w))
        self.g.pairs.append((self.eq("end_l#:across", Cross(a, first), 2), w))

    def _stated(self, name: str) -> Any:
        """Components of what the specification states of the platform joint: live or fixed."""
        value = getattr(self.type.model.platform_joint, name)
        if name != "rotation" and is_coordinate(value):
            return unit(value)
        return self.given.field(name, END)

    def _pair(self, k: int, link: Any, platform: Any) -> None:
        u = self.eq.give("end_l#", link, k + 1)
        self.g.pairs.append((u, self.eq.give("end_p#", platform, k + 1)))
        values = self.type.over_legs(lambda leg: leg.platform_joint.axis_link or AXES[k])
        self.pattern = pattern_of(
            np.einsum("lji,lj->li", self.g.canonical[self.g.group[self.g.count]], values)
        )


def _components(direction: Direction, stated: Mapping[str, Any]) -> tuple[Any, ...]:
    """Components of a direction of the platform joint in the frame of its body."""
    if not direction.field:
        return unit(AXES[direction.row])
    values = stated[direction.field]
    if direction.row is not None:
        return tuple(values[3 * direction.row : 3 * direction.row + 3])
    if direction.across:
        main = next(i for i, v in enumerate(values) if v != 0)
        return unit(AXES[(main + direction.across) % 3])
    return tuple(values)


def across(leg_type: LegType) -> int:
    """The coordinate direction of the last link that is most across the platform joint's axis."""
    axes = leg_type.over_legs(lambda leg: leg.platform_joint.axis_link)
    return int(np.argmin(np.abs(axes).max(axis=0)))


def moment_directions(leg_type: LegType, leg: Leg, last: Array, leg_R_platform: Array) -> Array:
    """Directions (k, 3) of the moments that a leg's platform joint transmits, in leg axes.

    Args:
        leg_type: of the leg.
        leg: one of its legs.
        last: rotation from the last link's to leg axes.
        leg_R_platform: rotation from platform to leg axes.
    """
    found = [
        np.cross(last @ in_link, leg_R_platform @ in_platform)
        for in_link, in_platform in right_angles(leg_type, leg)
    ]
    return np.array(found).reshape(-1, 3)


def right_angles(leg_type: LegType, leg: Leg) -> list[tuple[Array, Array]]:
    """Directions of the last link and of the platform that a platform joint keeps perpendicular."""
    end = leg.platform_joint
    return [
        (_direction(leg_type, end, in_link), _direction(leg_type, end, in_platform))
        for in_link, in_platform in end.right_angles
    ]


def _direction(leg_type: LegType, joint: PlatformJoint, direction: Direction) -> Array:
    """A direction of a platform joint in numbers, in the frame of its body."""
    stated = np.ravel(getattr(joint, direction.field)).tolist() if direction.field else []
    if not direction.across or is_coordinate(stated):
        return np.array(_components(direction, {direction.field: stated}), dtype=float)
    first = np.cross(stated, AXES[across(leg_type)])
    first /= np.linalg.norm(first)
    return first if direction.across == 1 else np.cross(stated, first)
