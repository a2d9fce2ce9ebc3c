"""Cylindrical joint."""

from pne_sym.model.joint_kinds.interface import WrittenJoint


class Cylindrical(WrittenJoint):
    """A revolute and a prismatic joint along one axis."""

    letter = "C"
    word = "cylindrical"
    order = 5
    sequence = "RP"
    slides = True
    comment = "Cylindrical joint: turns about and slides along one axis."
