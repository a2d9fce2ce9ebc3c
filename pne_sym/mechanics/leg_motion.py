"""Accelerations of a leg's links, and their linear forms in the platform's acceleration.

Reference: sections 2.2, 2.3 and 2.5.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

from pne_sym.derivation import Book
from pne_sym.mechanics.joint_accelerations import JointAccelerations, write_joint_accelerations
from pne_sym.mechanics.leg_displacements import InverseKinematics
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.leg_rates import RateWriter
from pne_sym.mechanics.linear_writer import LinearWriter
from pne_sym.mechanics.moving_base import carried_leg
from pne_sym.mechanics.platform_motion import PlatformMotion
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.model.kinematics import TaskSpace
from pne_sym.vector import Cross, Skew, Vector, VectorSymbol, ZeroTensor, ZeroVector, vector_sum

_TERMS = glossary(r"""
alpha_#    | \boldsymbol\alpha_{#} ; \boldsymbol\Omega_{#} | RATE @link
    angular acceleration of link #
B_#        | \mathbf B_{#}            | DEFINITION @link
    acceleration tensor of link #
B_#_o      | \mathbf B^{\circ}_{#}    | DEFINITION @link
    remainder of the acceleration tensor of link #
a_o_#      | \mathbf a_{o#} ; \boldsymbol\Theta_{o#} | RATE @before
    acceleration of the origin of joint #
""")
_TEXT = (
    r"The bias $`\mathfrak b`$ is the acceleration that the connection point would have with all "
    r"joint accelerations zero; what is left, $`\ddot{\mathbf S}-\mathfrak b"
    r"=\sum_j\mathbf v_j\,\ddot q_j`$, is resolved like the velocity. "
)
_COLLECTED = (
    r"Whatever depends on the acceleration of the platform is then written as coefficient times "
    r"$`\mathbf a_p`$ plus remainder, by Rules I and II; a circle marks the remainder, the same "
    r"formula at $`\mathbf a_p=\mathbf 0`$. "
)
_REMAINDERS = (
    r"The accelerations of the joints are written as coefficient times $`\mathbf a_p`$ plus "
    r"remainder, by Rules I and II; what follows from them is written as it is and as remainder, "
    r"marked by a circle: the same formula at $`\mathbf a_p=\mathbf 0`$. "
)
_TENSOR = (
    r"The acceleration tensor saves work: "
    r"$`\mathbf B_j\,\mathbf r=\boldsymbol\alpha_j\times\mathbf r+\mathbf C_j\,\mathbf r`$."
)


class GroupMotion(NamedTuple):
    """How the links that turn together accelerate.

    Attributes:
        omega, alpha: angular velocity and acceleration.
        tensor: alpha~ + omega~ omega~, and its remainder.
    """

    omega: Vector
    alpha: Vector
    tensor: tuple[Any, Any]


@dataclass(frozen=True)
class LegMotion(JointAccelerations):
    """Motion of a leg.

    Attributes:
        groups: of links, by the joint that opens them; 0: what is fixed to the base.
        origins: accelerations of the groups' origins, by group.
    """

    groups: Mapping[int, GroupMotion]
    origins: Mapping[int, Vector]

    def of_point(self, group: int, reach: Vector, slides: Sequence[int]) -> tuple[Any, Any, Any]:
        """Acceleration of a point of a group: (value, its form by the tensor, its remainder)."""
        return _of_point(self, self.groups[group], self.origins[group], reach, slides)


def write_motion(
    book: Book,
    g: LegGeometry,
    platform: PlatformMotion,
    space: TaskSpace,
    inverse: InverseKinematics,
) -> LegMotion:
    """The chapters on rates and accelerations of a leg."""
    rates = RateWriter(book, g, platform, space, inverse).write()
    text = _TEXT + (_REMAINDERS if g.composite else _COLLECTED)
    also = _other_accelerations(rates.chain.extras, moments=bool(g.pairs and space.rotates))
    Writer(book, g, _TERMS).chapter("A", "Accelerations of &", text + also + _TENSOR)
    joints = write_joint_accelerations(book, platform, rates, rotates=space.rotates)
    base, origin = GroupMotion(ZeroVector, ZeroVector, (ZeroTensor, ZeroTensor)), ZeroVector
    if platform.base:
        joints, origin = carried_leg(book, platform, platform.base, joints)
        moved = platform.base
        base = GroupMotion(moved.omega, moved.alpha, (moved.tensor, moved.tensor))
    return _Writer(book, joints).write(base, origin)


def _other_accelerations(extras: Sequence[int], *, moments: bool) -> str:
    """Which accelerations are collected besides that of the connection point."""
    others = [r"the platform's $`\boldsymbol\alpha`$"] * moments
    others += [r"those of the extra joints, $`\ddot y_j`$"] * bool(extras)
    return f"What depends on {' and '.join(others)} is collected likewise. " if others else ""


class _Writer:
    def __init__(self, book: Book, joints: JointAccelerations) -> None:
        self.joints, self.chain, self.g = joints, joints.chain, joints.chain.g
        self.eq = LinearWriter(book, self.g, _TERMS, joints.collection)

    def write(self, base: GroupMotion, origin: Vector) -> LegMotion:
        """Accelerations of the groups, outwards from what is fixed to the base."""
        groups = {0: base}
        for j in self.chain.turning:
            groups[j] = self._group(j, groups[self.g.group[j - 1]].alpha)
        return LegMotion(**vars(self.joints), groups=groups, origins=self._origins(groups, origin))

    def _group(self, j: int, previous: Vector) -> GroupMotion:
        """Of the links that joint j turns."""
        g, joints = self.g, self.joints
        is_last = j == self.chain.last
        # What of the last link's angular acceleration the inertia at the tip needs.
        joints_alone = vector_sum(joints.qdd[k] * g.spin(k) for k in self.chain.turning)
        alpha = self.eq.collected(
            "alpha_#",
            previous + joints.qdd[j] * g.spin(j) + joints.coriolis[j],
            j,
            collected=not g.composite or is_last,
            accelerated=joints_alone if g.composite and is_last else None,
        )
        rest, spin = joints.known[alpha].remainder, joints.spin[j]
        tensor = self.eq("B_#", Skew(alpha) + spin, j)
        at_rest = self.eq("B_#_o", Skew(rest) + spin, j)
        return GroupMotion(joints.omega[j], alpha, (tensor, at_rest))

    def _origins(self, groups: Mapping[int, GroupMotion], base: Vector) -> dict[int, Vector]:
        """Accelerations of the groups' origins, outwards (the last link is seen from the tip)."""
        found = {0: base}
        for previous, j in pairwise(self.chain.spans):
            span, slides = self.chain.spans[previous], self.chain.slides(previous)
            value, form, rest = _of_point(
                self.joints, groups[previous], found[previous], span, slides
            )
            found[j] = value
            if value != ZeroVector and not isinstance(value, VectorSymbol):
                found[j] = self.eq.collected(
                    "a_o_#",
                    value,
                    j,
                    forms=(form,),
                    rest_forms=(rest,),
                    collected=not self.g.composite,
                )
        return found


def _of_point(
    joints: JointAccelerations,
    group: GroupMotion,
    origin: Vector,
    reach: Vector,
    slides: Sequence[int],
) -> tuple[Any, Any, Any]:
    """Acceleration of a point that slides along in a group."""
    g, omega, (tensor, at_rest) = joints.chain.g, group.omega, group.tensor
    velocity = vector_sum(joints.qd[i] * g.slide(i) for i in slides)
    coriolis = Cross(omega, velocity) * 2
    sliding = vector_sum(joints.qdd[i] * g.slide(i) for i in slides)
    resolved = (i for i in slides if joints.qdd[i] in joints.known)
    sliding_rest = vector_sum(joints.known[joints.qdd[i]].remainder * g.slide(i) for i in resolved)
    centripetal = Cross(group.alpha, reach) + Cross(omega, Cross(omega, reach))
    rest = joints.collection.rest(origin)
    return (
        vector_sum((origin, centripetal, coriolis, sliding)),
        vector_sum((origin, tensor @ reach, coriolis, sliding)),
        vector_sum((rest, at_rest @ reach, coriolis, sliding_rest)),
    )
