"""Revolute joint."""

from pne_sym.model.joint_kinds.interface import JointKind
from pne_sym.model.kind import Look


class Revolute(JointKind):
    """Turns about the axis by its displacement."""

    letter = "R"
    word = "revolute"
    order = 1
    in_plane = True
    turns = True
    implied = True
    effort = "moment about"
    look = Look.PIN
    axis_choices = (("z",), ("x",), ("y",))
    plane_choices = (("z",),)
    comment = "Revolute joint."
