"""Revolute platform joint."""

from pne_sym.model.kind import Look
from pne_sym.model.platform_kinds.interface import AXIS_PLATFORM, Direction, PlatformJointKind


class Revolute(PlatformJointKind):
    """Axes fixed in the last link and in the platform are the same."""

    letter = "R"
    word = "revolute"
    order = 2
    in_plane = True
    fields = ("axis_link", "axis_platform")
    right_angles = (
        (Direction("axis_link", across=1), AXIS_PLATFORM),
        (Direction("axis_link", across=2), AXIS_PLATFORM),
    )
    open = "the axes of its platform joint do not coincide"
    look = Look.PIN
    shown = ("axis_link",)
