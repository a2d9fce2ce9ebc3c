"""What acts along the joints of a leg beside inertia and weight: friction, springs, rotors.

They enter the equilibrium along the freedom of joint j, of passive and extra joints too:
v_j . (F + f_u) = tau_j - Gamma_j, where Gamma_j holds tau^f_j + tau^s_j + J^r_j qdd_j besides.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp

from pne_sym.derivation import Book, Law, ParameterField, Quantity, Rule
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.linear_writer import LegMotion


@dataclass
class JointForces:
    """By joint number; zeros are left out.

    Attributes:
        friction: force against the rate.
        spring: force against the displacement.
        stored: energy of the spring.
        rotor: inertia of the motor along the joint.
        motor: rate of the motor, and the displacement of the joint per angle of it.
        qd, qdd: rates and accelerations, of all joints.
    """

    qd: dict[int, Any]
    qdd: dict[int, Any]
    friction: dict[int, Any] = field(default_factory=dict)
    spring: dict[int, Any] = field(default_factory=dict)
    stored: dict[int, Any] = field(default_factory=dict)
    rotor: dict[int, Any] = field(default_factory=dict)
    motor: dict[int, tuple[Any, Any]] = field(default_factory=dict)

    def along(self, j: int) -> Any:
        """What Gamma_j holds beside inertia and weight of the links."""
        return sp.Add(self.friction.get(j, 0), self.spring.get(j, 0), self.accelerating(j))

    def accelerating(self, j: int) -> Any:
        """The part of it that depends on the acceleration."""
        return self.rotor.get(j, 0) * self.qdd[j]

    @property
    def dissipation(self) -> Any:
        """Power that friction takes."""
        return sp.Add(*(force * self.qd[j] for j, force in self.friction.items()))

    @property
    def potential(self) -> Any:
        """Energy of the springs."""
        return sp.Add(*self.stored.values())


def write_joint_forces(
    book: Book, g: LegGeometry, motion: LegMotion, q: dict[int, Any], prefix: str
) -> JointForces:
    """The chapter on friction, springs and rotors of a leg, where there are any."""
    forces = JointForces(motion.qd, motion.qdd)
    joints = g.leg_type.model.joints
    if not any(j.friction or j.spring or j.actuator for j in joints):
        return forces
    writer = _Writer(book, g)
    found = [(joint.friction, joint.spring, joint.actuator) for joint in joints]
    sentences = (_FRICTION, _SPRINGS, _ROTORS)
    said = [text for k, text in enumerate(sentences) if any(of[k] for of in found)]
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
    return forces


class _Writer:
    def __init__(self, book: Book, g: LegGeometry) -> None:
        self.book, self.g = book, g

    def _parameter(self, j: int, table: str, name: str) -> Any:
        """A live parameter of joint j."""
        legs = self.g.leg_type
        latex, unit, meaning, rule = _PARAMETERS[name]
        kind, meaning = self.g.kind(j), meaning.format(j=j)
        unit = unit.format(effort=kind.effort_unit, q=kind.unit)
        (symbol,) = self.book.parameters.add(
            ParameterField(
                f"{legs.name}_{legs.part('joint', j)}_{name}",
                legs.name,
                (),
                unit,
                meaning,
                tuple(f"legs[{i}].joints[{j - 1}].{table}.{name}" for i in legs.indices),
                np.asarray(legs.over_legs(lambda leg: _value(leg.joints[j - 1], table, name))),
                rule=rule,
            )
        )
        self.book.note_quantity(Quantity(symbol.name, latex.format(j=j), meaning, parameter=True))
        return symbol

    def friction(self, j: int, rate: Any) -> Any:
        """Force against the rate of joint j."""
        of = self.g.leg_type.model.joints[j - 1].friction
        assert of is not None
        factor: Any = sp.S.Zero
        if of.viscous is not None:
            factor = self._parameter(j, "friction", "viscous")
        if of.coulomb is not None:
            coulomb = self._parameter(j, "friction", "coulomb")
            scale = self._parameter(j, "friction", "velocity_scale")
            square = self.book.define(
                self.g.name(f"vs2_{j}"),
                scale**2,
                rf"\varpi_{{{j}}}",
                f"square of the velocity scale of joint {j}",
                Law.LUMPING,
                parameter=True,
            )
            factor = factor + coulomb / sp.sqrt(rate**2 + square)
        return self.book.define(
            self.g.name(f"friction_{j}"),
            factor * rate,
            rf"\tau^f_{{{j}}}",
            f"friction in joint {j}, against its rate",
            Law.FRICTION,
            reference="beyond the paper",
        )

    def spring(self, j: int, displacement: Any) -> tuple[Any, Any]:
        """Force of the spring against the displacement of joint j, and its energy."""
        stiffness = self._parameter(j, "spring", "stiffness")
        rest = self._parameter(j, "spring", "rest")
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
        inertia = self._parameter(j, "actuator", "rotor_inertia")
        ratio = self._parameter(j, "actuator", "gear_ratio")
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
    "viscous": ("b_{{{j}}}", "{effort} s/{q}", "viscous friction of joint {j}", Rule.MASS),
    "coulomb": ("f_{{{j}}}", "{effort}", "Coulomb friction of joint {j}", Rule.MASS),
    "velocity_scale": (
        r"\epsilon_{{{j}}}",
        "{q}/s",
        "rate of joint {j} below which Coulomb friction grows linearly",
        Rule.POSITIVE,
    ),
    "stiffness": (
        r"\kappa_{{{j}}}",
        "{effort}/{q}",
        "stiffness of the spring at joint {j}",
        Rule.MASS,
    ),
    "rest": (
        "q^0_{{{j}}}",
        "{q}",
        "displacement of joint {j} at which its spring is slack",
        Rule.FREE,
    ),
    "rotor_inertia": (
        "I^r_{{{j}}}",
        "kg m^2",
        "inertia of the rotor of joint {j}, about its axis",
        Rule.MASS,
    ),
    "gear_ratio": (
        "n_{{{j}}}",
        "rad/{q}",
        "motor angle per displacement of joint {j}",
        Rule.NONZERO,
    ),
}
"""Parameter -> symbol, unit, meaning, rule."""

_ALL = (
    r"What acts along joint j beside the actuator, whether or not the joint is driven: it stands "
    r"with $`\Gamma_j`$ on the side of inertia and weight. "
)
_FRICTION = (
    r"Friction is viscous and of Coulomb's kind, the latter smooth: "
    r"$`v/\sqrt{v^2+\epsilon^2}`$ stands for the sign of the rate, so that a joint at rest has no "
    r"friction and creeps under a load. It does not depend on the joint's reactions. "
)
_SPRINGS = (
    r"A spring is linear in the displacement as inverse kinematics gives it: of a revolute joint "
    r"that is not an extra coordinate, an angle in $`(-\pi,\pi]`$, at whose ends its force jumps. "
)
_ROTORS = (
    r"A rotor turns $`n_j`$ times the displacement of its joint; $`n_j^2`$ of its inertia is felt "
    r"there. Its gyroscopic effect, from the turning of the link that carries it, is left out. "
)
