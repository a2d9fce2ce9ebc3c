"""Spherical platform joint."""

from pne_sym.model.kind import Look
from pne_sym.model.platform_kinds.interface import PlatformJointKind


class Spherical(PlatformJointKind):
    """Joins the points alone."""

    letter = "S"
    word = "spherical"
    order = 1
    in_plane = True
    look = Look.BALL
