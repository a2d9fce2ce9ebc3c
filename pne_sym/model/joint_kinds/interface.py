"""What the program asks of a kind of joint.

A joint with one degree of freedom is a screw: by its displacement q its link turns about the axis
by `turn` q and moves along it by `advance` q.  All formulas are in these two factors and in the
facts below, with numbers and with symbols alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

from pne_sym.model.kind import Kind, Look

Axes = tuple[str, ...]


class WrittenJoint(Kind):
    """A joint as specifications write it: with one degree of freedom, or several at one point.

    Attributes:
        sequence: letters of the degrees of freedom that it stands for.
        slides: its link moves along an axis.
        crossed: it has a list of axes, each perpendicular to the next; else one axis.
        pitched: it has a pitch.
        implied: in the plane its axis need not be given: it is the normal.
        axis_choices: axes that `pne-gen new` tries in the leg frame, the usual first.
        plane_choices: the same in the plane.
        comment: what `pne-gen new` says of it.
    """

    known: ClassVar[dict[str, Any]] = {}
    sequence: ClassVar[str]
    slides: ClassVar[bool] = False
    crossed: ClassVar[bool] = False
    pitched: ClassVar[bool] = False
    implied: ClassVar[bool] = False
    axis_choices: ClassVar[tuple[Axes, ...]] = (("x",), ("z",), ("y",))
    plane_choices: ClassVar[tuple[Axes, ...]] = ()
    comment: ClassVar[str]

    @property
    def parts(self) -> tuple[JointKind, ...]:
        """The degrees of freedom that it stands for."""
        return tuple(JointKind(letter) for letter in self.sequence)

    def actuated_parts(self, actuated: bool) -> Sequence[bool]:
        """Which degrees of freedom the notation means that marks the joint as actuated."""
        return [actuated] * len(self.parts)


class JointKind(WrittenJoint):
    """A kind of joint with one degree of freedom.

    Attributes:
        turns: its link turns against the link before it.
        is_angle: the displacement is an angle, rad; else a length, m.
        effort: what its component of the equilibrium is, in words.
        look: how it is drawn.
    """

    REVOLUTE: ClassVar[JointKind]
    PRISMATIC: ClassVar[JointKind]
    HELICAL: ClassVar[JointKind]

    turns: ClassVar[bool] = False
    is_angle: ClassVar[bool] = True
    effort: ClassVar[str]
    look: ClassVar[Look]

    @property
    def parts(self) -> tuple[JointKind, ...]:
        """Itself."""
        return (self,)

    @property
    def is_hinge(self) -> bool:
        """Whether it only turns, so that a full turn changes nothing."""
        return self.turns and not self.slides

    def turn(self, pitch: Any) -> Any:
        """Angle by which the link turns, per unit of displacement."""
        return 1 if self.turns else 0

    def advance(self, pitch: Any) -> Any:
        """Way of the link along the axis, per unit of displacement."""
        return 1 if self.slides else 0

    @property
    def unit(self) -> str:
        """Of the displacement; rate and acceleration have it over s and s^2."""
        return "rad" if self.is_angle else "m"

    @property
    def effort_unit(self) -> str:
        """Of what does work along it."""
        return "N m" if self.is_angle else "N"
