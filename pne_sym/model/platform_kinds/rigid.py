"""Rigid platform joint."""

import math

from pne_sym.model.kind import Look
from pne_sym.model.platform_kinds.interface import Closure, Direction, PlatformJointKind, Stated


class Rigid(PlatformJointKind):
    """The platform is part of the last link: axis k of the link, axis k + 1 as the platform has it.

    The rows of `rotation` are the link's axes in the platform frame, its columns the platform's
    in the link's.
    """

    letter = "rigid"
    word = "rigid"
    order = 4
    fields = ("rotation",)
    right_angles = tuple(
        (Direction(row=k), Direction("rotation", row=(k + 1) % 3)) for k in range(3)
    )
    open = "its last link and the platform are not turned as they are joined"
    look = Look.BLOCK

    @property
    def in_architecture(self) -> str:
        """Welded."""
        return "W"

    def closures(self, joint: Stated) -> list[Closure]:
        """The platform's axes."""
        if joint.rotation is None:
            return []
        axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
        return [Closure(c, e) for c, e in zip(zip(*joint.rotation, strict=True), axes, strict=True)]

    def angle(self, size: float) -> float:
        """All three axes are turned by it."""
        return super().angle(size / math.sqrt(2.0))
