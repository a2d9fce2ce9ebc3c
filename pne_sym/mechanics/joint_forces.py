"""What acts along the joints of a leg beside inertia and weight: friction, springs, rotors.

They enter the equilibrium along the degree of freedom of joint j, of passive and extra joints too:
v_j . (F + f_u) = tau_j - Gamma_j, where Gamma_j holds tau^f_j + tau^s_j + J^r_j qdd_j besides.
Friction in the platform joint is a moment on the last link, and the opposite on the platform.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import sympy as sp

from pne_sym.derivation import Book
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.leg_motion import LegMotion
from pne_sym.mechanics.live import END, Place, of_legs, value_at
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.model.effects import Friction
from pne_sym.model.manipulator import Joint
from pne_sym.vector import Dot, Vector, ZeroVector

_TERMS = glossary(r"""
vs2_%        | \varpi_{#}               | LUMPING constant
    square of the velocity scale of &
friction_#   | \tau^f_{#}               | FRICTION | beyond the paper
    friction in joint #, against its rate
omega_end    | \boldsymbol\omega^r      | RATE @tip | beyond the paper
    angular velocity of the platform relative to the last link
friction_end | \mathbf m^f              | FRICTION @tip | beyond the paper
    moment of the platform joint's friction on the last link
spring_#     | \tau^s_{#}               | SPRING   | beyond the paper
    force of the spring at joint #, against its displacement
stored_#     | V^s_{#}                  | ENERGY   | beyond the paper
    energy of the spring at joint #
rotor_#      | J^r_{#}                  | ROTOR constant | beyond the paper
    inertia of the rotor of joint #, along the joint
motor_#      | \dot\vartheta_{#}        | ROTOR    | beyond the paper
    rate of the motor of joint #
per_turn_#   | n^{-1}_{#}               | LUMPING constant
    displacement of joint # per angle of its motor
""")


class Motor(NamedTuple):
    """The motor of a joint.

    Attributes:
        felt: inertia of the rotor along the joint.
        ratio: angle of the motor per displacement.
        per_turn: its inverse.
        rate: of the motor; None where it is coupled to other joints too.
    """

    felt: Any = sp.S.Zero
    ratio: Any = sp.S.One
    per_turn: Any = sp.S.One
    rate: Any = None


class InJoint(NamedTuple):
    """What acts in one joint; zeros where it has no such thing.

    Attributes:
        friction: force against the rate.
        spring: force against the displacement.
        stored: energy of the spring.
        rotor: inertia of the motor along the joint; zero where motors are coupled.
        motor: the motor.
    """

    friction: Any = sp.S.Zero
    spring: Any = sp.S.Zero
    stored: Any = sp.S.Zero
    rotor: Any = sp.S.Zero
    motor: Motor | None = None


@dataclass(frozen=True)
class JointForces:
    """What acts in the joints of a leg.

    Attributes:
        qd, qdd: rates and accelerations of the joints, by number.
        own: what acts in each.
        end: moment of the platform joint's friction on the last link.
        turning: angular velocity of the platform relative to that link.
        spins: angular velocities of links per rate of their joints, where that moment works.
    """

    qd: Mapping[int, Any]
    qdd: Mapping[int, Any]
    own: Mapping[int, InJoint] = field(default_factory=dict)
    end: Vector = ZeroVector
    turning: Vector = ZeroVector
    spins: Mapping[int, Vector] = field(default_factory=dict)

    def along(self, j: int) -> Any:
        """What Gamma_j holds beside inertia and weight of the links."""
        own = self.own.get(j, InJoint())
        against = -Dot(self.spins[j], self.end) if j in self.spins else sp.S.Zero
        return sp.Add(own.friction, own.spring, self.accelerating(j), against)

    def accelerating(self, j: int) -> Any:
        """The part of it that depends on the acceleration."""
        return self.own.get(j, InJoint()).rotor * self.qdd[j]

    @property
    def motors(self) -> dict[int, Motor]:
        """Motors by joint."""
        return {j: own.motor for j, own in self.own.items() if own.motor}

    @property
    def dissipation(self) -> Any:
        """Power that friction takes."""
        own = (x.friction * self.qd[j] for j, x in self.own.items())
        return sp.Add(*own, Dot(self.end, self.turning))

    @property
    def potential(self) -> Any:
        """Energy of the springs."""
        return sp.Add(*(own.stored for own in self.own.values()))


def write_joint_forces(
    book: Book, g: LegGeometry, motion: LegMotion, *, coupled: bool = False
) -> JointForces:
    """The chapter on friction, springs and rotors of a leg, where there are any.

    Args:
        book: of the derivation.
        g: of the leg.
        motion: of the leg.
        coupled: motors turn with several joints; their rotors are no matter of one leg.
    """
    q, turning = motion.chain.q, motion.end_turning
    joints, end = g.leg_type.model.joints, g.leg_type.model.platform_joint.friction
    if not (end or any(j.friction or j.spring or j.actuator for j in joints)):
        return JointForces(motion.qd, motion.qdd)
    writer = _Writer(book, g, coupled=coupled)
    text = _text(joints, end, coupled=coupled)
    writer.eq.chapter("J", "Forces in the joints of &", text)
    own = {j: writer.joint(j, joint, motion.qd[j], q) for j, joint in enumerate(joints, 1)}
    if not end or turning == ZeroVector:
        return JointForces(motion.qd, motion.qdd, own)
    relative, moment = writer.end_friction(turning)
    spins = {j: g.spin(j) for j in range(1, g.count + 1) if g.turns(j)}
    return JointForces(motion.qd, motion.qdd, own, moment, relative, spins)


def _text(joints: Sequence[Joint], end: Friction | None, *, coupled: bool) -> str:
    """What the chapter begins with: of what there is."""
    found = [(joint.friction, joint.spring, joint.actuator) for joint in joints]
    sentences = (_FRICTION, _SPRINGS, _COUPLED if coupled else _ROTORS)
    said = [text for k, text in enumerate(sentences) if any(of[k] for of in found)]
    said += [_FRICTION] * bool(end and _FRICTION not in said) + [_END] * bool(end)
    return "".join((_ALL, *said)).rstrip()


class _Writer:
    def __init__(self, book: Book, g: LegGeometry, *, coupled: bool) -> None:
        self.g, self.coupled = g, coupled
        self.eq = Writer(book, g, _TERMS)

    def joint(self, j: int, joint: Joint, rate: Any, q: Mapping[int, Any]) -> InJoint:
        """What acts in joint j."""
        at, found = Place.joint(self.g.leg_type, j), InJoint()
        if joint.friction:
            force = self.eq("friction_#", self._law(at, rate**2) * rate, j)
            found = found._replace(friction=force)
        if joint.spring:
            force, stored = self._spring(at, j, q[j])
            found = found._replace(spring=force, stored=stored)
        if joint.actuator:
            motor = self._motor(at, j, rate)
            found = found._replace(rotor=sp.S.Zero if self.coupled else motor.felt, motor=motor)
        return found

    def given(self, at: Place, name: str) -> Any:
        """A live parameter of a joint."""
        (symbol,) = of_legs(self.eq.book, self.g.leg_type, at, name)
        return symbol

    def _law(self, at: Place, square: Any, prefix: str = "") -> Any:
        """Friction over rate, by the square of the rate."""
        of = value_at(self.g.leg_type.model, f"{at.path}.friction")
        factor: Any = sp.S.Zero
        if of.viscous is not None:
            factor = self.given(at, "viscous")
        if of.coulomb is not None:
            coulomb = self.given(at, "coulomb")
            scale = self.given(at, "velocity_scale")
            least = self.eq("vs2_%", scale**2, at.mark, f"{prefix}{at.mark}", at.word)
            factor = factor + coulomb / sp.sqrt(square + least)
        return factor

    def end_friction(self, turning: Vector) -> tuple[Vector, Vector]:
        """Turning of the platform against the last link, and the moment on that link."""
        relative = self.eq("omega_end", turning)
        law = self._law(END, Dot(relative, relative), "end_")
        return relative, self.eq("friction_end", law * relative)

    def _spring(self, at: Place, j: int, displacement: Any) -> tuple[Any, Any]:
        """Force of the spring against the displacement of joint j, and its energy."""
        stiffness = self.given(at, "stiffness")
        rest = self.given(at, "rest")
        force = self.eq("spring_#", stiffness * (displacement - rest), j)
        return force, self.eq("stored_#", force * (displacement - rest) / 2, j)

    def _motor(self, at: Place, j: int, rate: Any) -> Motor:
        """The motor of joint j; its rate where it turns with that joint alone."""
        inertia = self.given(at, "rotor_inertia")
        ratio = self.given(at, "gear_ratio")
        felt = self.eq("rotor_#", ratio**2 * inertia, j)
        turning = None if self.coupled else self.eq("motor_#", ratio * rate, j)
        return Motor(felt, ratio, self.eq("per_turn_#", 1 / ratio, j), turning)


_ALL = (
    r"What acts along joint j beside the actuator, whether or not the joint is actuated: it stands "
    r"with $`\Gamma_j`$ on the side of inertia and weight. "
)
_FRICTION = (
    r"Friction is viscous and of Coulomb's kind, the latter smooth: "
    r"$`v/\sqrt{v^2+\epsilon^2}`$ stands for the sign of the rate, so that a joint at rest has no "
    r"friction and creeps under a load. It does not depend on the joint's reactions. "
)
_END = (
    r"That of the platform joint is a moment against the turning of the platform relative to the "
    r"last link, on the platform; the opposite acts on the link. "
)
_SPRINGS = (
    r"A spring is linear in the displacement as inverse kinematics gives it: of a revolute joint "
    r"that is not an extra coordinate, an angle in $`(-\pi,\pi]`$, at whose ends its force jumps. "
)
_ROTORS = (
    r"A rotor turns $`n_j`$ times the displacement of its joint; $`n_j^2`$ of its inertia is felt "
    r"there. Its gyroscopic effect, from the turning of the link that carries it, is left out. "
)
_COUPLED = (
    r"A motor turns with several joints: $`n_j^2`$ of its rotor's inertia is felt by what it turns "
    r"with, in the chapter on M. The gyroscopic effect, from the turning of the link that carries "
    r"the rotor, is left out. "
)
