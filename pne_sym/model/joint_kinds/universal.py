"""Universal joint."""

from collections.abc import Sequence

from pne_sym.model.joint_kinds.interface import WrittenJoint


class Universal(WrittenJoint):
    """Two revolute joints on a massless cross."""

    letter = "U"
    word = "universal"
    order = 4
    sequence = "RR"
    crossed = True
    axis_choices = (("z", "y"), ("y", "z"), ("x", "z"))
    comment = "Universal joint: two revolute axes, the cross is massless."

    def actuated_parts(self, actuated: bool) -> Sequence[bool]:
        """The second axis."""
        return [False, actuated]
