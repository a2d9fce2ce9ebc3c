"""Helical joint."""

from typing import Any

from pne_sym.model.joint_kinds.interface import JointKind
from pne_sym.model.kind import Look


class Helical(JointKind):
    """Turns about the axis by its displacement and advances by pitch times that."""

    letter = "H"
    word = "helical"
    order = 3
    turns = True
    slides = True
    pitched = True
    effort = "moment and pitch times force along"
    look = Look.SCREW
    comment = "Helical joint (screw): the displacement is its angle."

    def advance(self, pitch: Any) -> Any:
        """The pitch."""
        return pitch
