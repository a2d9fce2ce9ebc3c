"""What acts along the joints of a leg beside inertia and weight: friction, springs, rotors.

They enter the equilibrium along the degree of freedom of joint j, of passive and extra joints too:
v_j . (F + f_u) = tau_j - Gamma_j, where Gamma_j holds tau^f_j + tau^s_j + J^r_j qdd_j besides.
Friction in the platform joint is a moment on the last link, and the opposite on the platform.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp

from pne_sym.derivation import Book, Law, ParameterField, Quantity, Rule
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.linear_writer import LegMotion
from pne_sym.model.manipulator import Leg
from pne_sym.vector import Dot, Vector, ZeroVector


@dataclass
class JointForces:
    """By joint number; zeros are left out.

    Attributes:
        friction: force against the rate.
        spring: force against the displacement.
        stored: energy of the spring.
        rotor: inertia of the motor along the joint.
        motor: rate of the motor, and the displacement of the joint per angle of it.
        end: moment of the platform joint's friction on the last link.
        turning: angular velocity of the platform relative to that link.
        component: of that moment along joints, by which it works against their actuators.
        qd, qdd: rates and accelerations, of all joints.
    """

    qd: dict[int, Any]
    qdd: dict[int, Any]
    friction: dict[int, Any] = field(default_factory=dict)
    spring: dict[int, Any] = field(default_factory=dict)
    stored: dict[int, Any] = field(default_factory=dict)
    rotor: dict[int, Any] = field(default_factory=dict)
    motor: dict[int, tuple[Any, Any]] = field(default_factory=dict)
    end: Vector = ZeroVector
    turning: Vector = ZeroVector
    component: dict[int, Any] = field(default_factory=dict)

    def along(self, j: int) -> Any:
        """What Gamma_j holds beside inertia and weight of the links."""
        own = self.friction.get(j, 0), self.spring.get(j, 0), self.accelerating(j)
        return sp.Add(*own, self.component.get(j, 0))

    def accelerating(self, j: int) -> Any:
        """The part of it that depends on the acceleration."""
        return self.rotor.get(j, 0) * self.qdd[j]

    @property
    def dissipation(self) -> Any:
        """Power that friction takes."""
        own = (force * self.qd[j] for j, force in self.friction.items())
        return sp.Add(*own, Dot(self.end, self.turning))

    @property
    def potential(self) -> Any:
        """Energy of the springs."""
        return sp.Add(*self.stored.values())


def write_joint_forces(
    book: Book, g: LegGeometry, motion: LegMotion, q: dict[int, Any], turning: Vector
) -> JointForces:
    """The chapter on friction, springs and rotors of a leg, where there are any.

    Args:
        book: of the derivation.
        g: of the leg.
        motion: of the leg.
        q: displacements by joint.
        turning: angular velocity of the platform relative to the last link.
    """
    prefix = g.leg_type.name
    forces = JointForces(motion.qd, motion.qdd)
    joints, end = g.leg_type.model.joints, g.leg_type.model.platform_joint.friction
    if not (end or any(j.friction or j.spring or j.actuator for j in joints)):
        return forces
    writer = _Writer(book, g)
    found = [(joint.friction, joint.spring, joint.actuator) for joint in joints]
    sentences = (_FRICTION, _SPRINGS, _ROTORS)
    said = [text for k, text in enumerate(sentences) if any(of[k] for of in found)]
    said += [_FRICTION] * bool(end and _FRICTION not in said) + [_END] * bool(end)
    title = f"Forces in the joints of a {g.leg_type.architecture} leg"
    book.chapter(f"{prefix}-J", title, "".join((_ALL, *said)).rstrip(), g.leg_type.name)
    for j, (friction, spring, actuator) in enumerate(found, 1):
        if friction:
            forces.friction[j] = writer.friction(j, motion.qd[j])
        if spring:
            forces.spring[j], forces.stored[j] = writer.spring(j, q[j])
        if actuator:
            forces.rotor[j], *motor = writer.rotor(j, motion.qd[j])
            forces.motor[j] = motor[0], motor[1]
    if end and turning != ZeroVector:
        forces.turning, forces.end = writer.end_friction(turning)
        spins = {j: g.spin(j) for j in range(1, g.count + 1) if g.turns(j)}
        forces.component = {j: -Dot(spin, forces.end) for j, spin in spins.items()}
    return forces


@dataclass(frozen=True)
class _Place:
    """A joint, and how its parameters are called.

    Attributes:
        stem: in names of parameters.
        path: in a leg of the full form.
        mark: index in formulas.
        word: in sentences.
        effort, unit: units of its force and of its displacement.
        pick: the joint of a leg.
    """

    stem: str
    path: str
    mark: str
    word: str
    effort: str
    unit: str
    pick: Callable[[Leg], Any]

    @staticmethod
    def of(g: LegGeometry, j: int) -> _Place:
        kind, stem = g.kind(j), g.leg_type.part("joint", j)
        path, pick = f"joints[{j - 1}]", lambda leg: leg.joints[j - 1]
        return _Place(stem, path, str(j), f"joint {j}", kind.effort_unit, kind.unit, pick)


_END_PLACE = _Place(
    "platform_joint",
    "platform_joint",
    "p",
    "the platform joint",
    "N m",
    "rad",
    lambda leg: leg.platform_joint,
)


class _Writer:
    def __init__(self, book: Book, g: LegGeometry) -> None:
        self.book, self.g = book, g

    def _parameter(self, at: _Place, table: str, name: str) -> Any:
        """A live parameter of a joint."""
        legs = self.g.leg_type
        latex, unit, meaning, rule = _PARAMETERS[name]
        meaning = meaning.format(joint=at.word)
        unit = unit.format(effort=at.effort, q=at.unit)
        (symbol,) = self.book.parameters.add(
            ParameterField(
                f"{legs.name}_{at.stem}_{name}",
                legs.name,
                (),
                unit,
                meaning,
                tuple(f"legs[{i}].{at.path}.{table}.{name}" for i in legs.indices),
                np.asarray(legs.over_legs(lambda leg: _value(at.pick(leg), table, name))),
                rule=rule,
            )
        )
        self.book.note_quantity(
            Quantity(symbol.name, latex.format(j=at.mark), meaning, parameter=True)
        )
        return symbol

    def _law(self, at: _Place, square: Any, prefix: str = "") -> Any:
        """Friction over rate, by the square of the rate."""
        of = at.pick(self.g.leg_type.model).friction
        factor: Any = sp.S.Zero
        if of.viscous is not None:
            factor = self._parameter(at, "friction", "viscous")
        if of.coulomb is not None:
            coulomb = self._parameter(at, "friction", "coulomb")
            scale = self._parameter(at, "friction", "velocity_scale")
            least = self.book.define(
                self.g.name(f"vs2_{prefix}{at.mark}"),
                scale**2,
                rf"\varpi_{{{at.mark}}}",
                f"square of the velocity scale of {at.word}",
                Law.LUMPING,
                parameter=True,
            )
            factor = factor + coulomb / sp.sqrt(square + least)
        return factor

    def friction(self, j: int, rate: Any) -> Any:
        """Force against the rate of joint j."""
        return self.book.define(
            self.g.name(f"friction_{j}"),
            self._law(_Place.of(self.g, j), rate**2) * rate,
            rf"\tau^f_{{{j}}}",
            f"friction in joint {j}, against its rate",
            Law.FRICTION,
            reference="beyond the paper",
        )

    def end_friction(self, turning: Vector) -> tuple[Vector, Vector]:
        """Turning of the platform against the last link, and the moment on that link."""
        frame = self.g.frame("axes", self.g.group[self.g.count])
        relative = self.book.define(
            self.g.name("omega_end"),
            turning,
            r"\boldsymbol\omega^r",
            "angular velocity of the platform relative to the last link",
            Law.RATE,
            body=frame,
            reference="beyond the paper",
        )
        moment = self.book.define(
            self.g.name("friction_end"),
            self._law(_END_PLACE, Dot(relative, relative), "end_") * relative,
            r"\mathbf m^f",
            "moment of the platform joint's friction on the last link",
            Law.FRICTION,
            body=frame,
            reference="beyond the paper",
        )
        return relative, moment

    def spring(self, j: int, displacement: Any) -> tuple[Any, Any]:
        """Force of the spring against the displacement of joint j, and its energy."""
        at = _Place.of(self.g, j)
        stiffness = self._parameter(at, "spring", "stiffness")
        rest = self._parameter(at, "spring", "rest")
        force = self.book.define(
            self.g.name(f"spring_{j}"),
            stiffness * (displacement - rest),
            rf"\tau^s_{{{j}}}",
            f"force of the spring at joint {j}, against its displacement",
            Law.SPRING,
            reference="beyond the paper",
        )
        stored = self.book.define(
            self.g.name(f"stored_{j}"),
            force * (displacement - rest) / 2,
            f"V^s_{{{j}}}",
            f"energy of the spring at joint {j}",
            Law.ENERGY,
            reference="beyond the paper",
        )
        return force, stored

    def rotor(self, j: int, rate: Any) -> tuple[Any, Any, Any]:
        """Inertia of the motor of joint j along it, its rate, and the inverse of its ratio."""
        at = _Place.of(self.g, j)
        inertia = self._parameter(at, "actuator", "rotor_inertia")
        ratio = self._parameter(at, "actuator", "gear_ratio")
        felt = self.book.define(
            self.g.name(f"rotor_{j}"),
            ratio**2 * inertia,
            rf"J^r_{{{j}}}",
            f"inertia of the rotor of joint {j}, along the joint",
            Law.ROTOR,
            parameter=True,
            reference="beyond the paper",
        )
        turning = self.book.define(
            self.g.name(f"motor_{j}"),
            ratio * rate,
            rf"\dot\theta_{{{j}}}",
            f"rate of the motor of joint {j}",
            Law.ROTOR,
            reference="beyond the paper",
        )
        inverse = self.book.define(
            self.g.name(f"per_turn_{j}"),
            1 / ratio,
            f"n^{{-1}}_{{{j}}}",
            f"displacement of joint {j} per angle of its motor",
            Law.LUMPING,
            parameter=True,
        )
        return felt, turning, inverse


def _value(joint: Any, table: str, name: str) -> float:
    return float(getattr(getattr(joint, table), name))


_PARAMETERS: dict[str, tuple[str, str, str, Rule]] = {
    "viscous": ("b_{{{j}}}", "{effort} s/{q}", "viscous friction of {joint}", Rule.MASS),
    "coulomb": ("f_{{{j}}}", "{effort}", "Coulomb friction of {joint}", Rule.MASS),
    "velocity_scale": (
        r"\epsilon_{{{j}}}",
        "{q}/s",
        "rate of {joint} below which Coulomb friction grows linearly",
        Rule.POSITIVE,
    ),
    "stiffness": (
        r"\kappa_{{{j}}}",
        "{effort}/{q}",
        "stiffness of the spring at {joint}",
        Rule.MASS,
    ),
    "rest": (
        "q^0_{{{j}}}",
        "{q}",
        "displacement of {joint} at which its spring is slack",
        Rule.FREE,
    ),
    "rotor_inertia": (
        "I^r_{{{j}}}",
        "kg m^2",
        "inertia of the rotor of {joint}, about its axis",
        Rule.MASS,
    ),
    "gear_ratio": (
        "n_{{{j}}}",
        "rad/{q}",
        "motor angle per displacement of {joint}",
        Rule.NONZERO,
    ),
}
"""Parameter -> symbol, unit, meaning, rule."""

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
