"""Spherical joint within a leg."""

from pne_sym.model.joint_kinds.interface import WrittenJoint


class Spherical(WrittenJoint):
    """Three revolute joints at one point, with massless links between."""

    letter = "S"
    word = "spherical"
    order = 6
    sequence = "RRR"
    crossed = True
    axis_choices = (("z", "y", "x"),)
    comment = "Spherical joint: three revolute axes at one point."
