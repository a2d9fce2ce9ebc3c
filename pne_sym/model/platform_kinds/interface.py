"""What the program asks of a kind of platform joint.

A platform joint keeps the points of link and platform together.  What it keeps besides are right
angles between directions fixed in the last link and in the platform: one for every moment that
it transmits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

from pne_sym.model.kind import Kind, Look

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Direction:
    """A direction of a platform joint, fixed in one of the bodies that it joins.

    Attributes:
        field: that states it; none: a coordinate direction of the body.
        row: of the field, or the number of the coordinate direction.
        across: the first or the second of two orthogonal directions across the stated one.
    """

    field: str = ""
    row: int | None = None
    across: int = 0


class Stated(Protocol):
    """What a specification states of a platform joint: see `manipulator.PlatformJoint`."""

    @property
    def axis_link(self) -> Vector | None:
        """Fixed in the last link."""

    @property
    def axis_platform(self) -> Vector | None:
        """Fixed in the platform."""

    @property
    def rotation(self) -> tuple[Vector, Vector, Vector] | None:
        """Platform axes in the last link's frame."""


@dataclass(frozen=True)
class Closure:
    """A condition on directions (of the last link, of the platform) in numbers.

    Attributes:
        link, platform: in the frames of their bodies.
        perpendicular: they keep a right angle; else they are the same.
    """

    link: Vector
    platform: Vector
    perpendicular: bool = False


AXIS_LINK, AXIS_PLATFORM = Direction("axis_link"), Direction("axis_platform")


class PlatformJointKind(Kind):
    """A kind of platform joint.

    Attributes:
        fields: what a specification states of it besides its place.
        right_angles: pairs of directions, of the last link and of the platform, that it keeps
            perpendicular.
        open: how it looks that its conditions on directions fail, in words.
        look: how it is drawn.
        shown: the axes that are drawn.
    """

    SPHERICAL: ClassVar[PlatformJointKind]
    REVOLUTE: ClassVar[PlatformJointKind]
    UNIVERSAL: ClassVar[PlatformJointKind]
    RIGID: ClassVar[PlatformJointKind]

    known: ClassVar[dict[str, Any]] = {}
    fields: ClassVar[tuple[str, ...]] = ()
    right_angles: ClassVar[tuple[tuple[Direction, Direction], ...]] = ()
    open: ClassVar[str] = ""
    look: ClassVar[Look]
    shown: ClassVar[tuple[str, ...]] = ()

    @property
    def moments(self) -> int:
        """How many moments it transmits in space."""
        return len(self.right_angles)

    @property
    def keeps_right_angle(self) -> bool:
        """Whether its axes are perpendicular; else they are the same."""
        return (AXIS_LINK, AXIS_PLATFORM) in self.right_angles

    def closures(self, joint: Stated) -> list[Closure]:
        """What closes the loop besides the points."""
        if joint.axis_link is None or joint.axis_platform is None:
            return []
        return [Closure(joint.axis_link, joint.axis_platform, self.keeps_right_angle)]

    def angle(self, size: float) -> float:
        """The angle (rad) by which the conditions fail whose misfits have this norm."""
        return 2.0 * math.asin(min(1.0, size / 2.0))
