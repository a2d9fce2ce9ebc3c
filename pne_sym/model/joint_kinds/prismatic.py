"""Prismatic joint."""

from pne_sym.model.joint_kinds.interface import JointKind
from pne_sym.model.kind import Look


class Prismatic(JointKind):
    """Moves along the axis by its displacement."""

    letter = "P"
    word = "prismatic"
    order = 2
    in_plane = True
    slides = True
    is_angle = False
    effort = "force along"
    look = Look.SLIDER
    plane_choices = (("x",), ("y",))
    comment = "Prismatic joint."
