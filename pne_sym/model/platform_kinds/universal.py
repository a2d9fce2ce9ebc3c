"""Universal platform joint."""

import math

from pne_sym.model.kind import Look
from pne_sym.model.platform_kinds.interface import AXIS_LINK, AXIS_PLATFORM, PlatformJointKind


class Universal(PlatformJointKind):
    """An axis fixed in the last link and one fixed in the platform are perpendicular."""

    letter = "U"
    word = "universal"
    order = 3
    fields = ("axis_link", "axis_platform")
    right_angles = ((AXIS_LINK, AXIS_PLATFORM),)
    open = "the axes of its platform joint are not perpendicular"
    look = Look.CROSS
    shown = ("axis_link", "axis_platform")

    def angle(self, size: float) -> float:
        """The misfit is the scalar product."""
        return math.asin(min(1.0, size))
