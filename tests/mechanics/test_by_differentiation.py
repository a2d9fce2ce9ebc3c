"""Rates and accelerations of a leg, written as laws, against derivatives of its geometry.

Joints and platform move as polynomials in time, at the values that the derivation finds; SymPy
differentiates positions and rotation matrices.  No law of kinematics is used here.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import sympy as sp

from pne_sym.derivation import Law
from pne_sym.mechanics.derive import derive
from tests.mechanics.evaluation import Names, Situation
from tests.models import random_spec, state_at
from tests.sampling import sampled

s = sp.Symbol("s")


def column(values: Any) -> sp.Matrix:
    return sp.Matrix([sp.Float(float(v)) for v in values])


def turned(h: Any) -> sp.Matrix:
    """The rotation by Cayley's formula: about h, by twice the arc tangent of its length."""
    across = tilde(h)
    return sp.eye(3) + 2 / (1 + h.dot(h)) * (across + across * across)


def tilde(a: Any) -> sp.Matrix:
    return sp.Matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def about(axis: Any, angle: Any) -> sp.Matrix:
    across = tilde(axis)
    return sp.eye(3) + sp.sin(angle) * across + (1 - sp.cos(angle)) * across * across


def now(expr: Any, order: int = 0) -> Any:
    """A derivative by time at s = 0, in numbers."""
    for _ in range(order):
        expr = expr.diff(s)
    return np.array(expr.subs(s, 0).evalf().tolist(), dtype=float).squeeze()


def axial(rotation: sp.Matrix) -> sp.Matrix:
    """The angular velocity of a rotating frame."""
    spin = rotation.diff(s) * rotation.T
    return sp.Matrix([spin[2, 1], spin[0, 2], spin[1, 0]])


class Chain:
    """A leg whose joints move; links count from 1, as joints do.

    Attributes:
        rotation: of every link, and of the base.
        axis, origin, reference: axis of every joint, its point before and after it slides.
        tip: the connection point.
    """

    def __init__(self, leg: Any, q: list[Any]) -> None:
        point, frame = column(leg.base_point), sp.Matrix(np.array(leg.base_frame))
        self.rotation = {0: frame}
        self.axis, self.origin, self.reference = {}, {}, {}
        for j, joint in enumerate(leg.joints, 1):
            self.origin[j] = point = point + frame * column(joint.offset)
            self.axis[j] = frame * column(joint.axis)
            self.reference[j] = point = point + self.axis[j] * joint.advance * q[j - 1]
            frame = frame * about(column(joint.axis), joint.turn * q[j - 1])
            self.rotation[j] = frame
        self.tip = point + frame * column(leg.platform_joint.offset)


class Motion:
    """A leg and the platform, moving as the derivation says at a random state."""

    def __init__(self, name: str) -> None:
        manipulator, state = random_spec(name, 1), state_at(random_spec(name, 1), 1)
        self.derivation = derive(manipulator)
        situation = Situation(manipulator, self.derivation, state, state.A)
        self.names: Names = situation.legs[0]
        self.leg, n = self.names.leg, self.names
        self.count = len(self.leg.joints)
        own = state.q[: self.count]
        self.rates = [n[n.named(f"qd_{j}")] for j in range(1, self.count + 1)]
        self.accelerations = [n[n.named(f"qdd_{j}")] for j in range(1, self.count + 1)]
        parts = list(zip(own, self.rates, self.accelerations, strict=True))
        self.chain = Chain(self.leg, [q + v * s + a * s**2 / 2 for q, v, a in parts])
        self.coasting = Chain(self.leg, [q + v * s for q, v, _ in parts])
        half = (column(n["omega"]) * s + column(n["alpha"]) * s**2 / 2) / 2
        self.turning = turned(half) * column(n[n.named("q")])
        self.swinging = turned(column(n["omega"]) * s / 2) * column(n[n.named("q")])
        path = column(n["t"]) + column(n["t_dot"]) * s + column(n["t_ddot"]) * s**2 / 2
        self.point = path + self.turning

    def acceleration(self, point: sp.Matrix) -> Any:
        return now(point, 2) - self.names["g"]

    def expected(self, stem: str, j: int) -> Any:
        """A quantity of the leg by its stem and joint."""
        chain, free = self.chain, self.coasting
        at_tip = not any("_phi_c" in e.name for e in self.derivation.equations())
        values: dict[str, Callable[[], Any]] = {
            "S_dot": lambda: now(self.point, 1),
            "S_ddot": lambda: now(self.point, 2),
            "u": lambda: now(self.swinging, 2),
            "a_p": lambda: now(self.point, 2) - now(self.swinging, 2),
            "bias": lambda: now(free.tip, 2),
            "rel": lambda: now(self.point, 2) - now(free.tip, 2),
            "v": lambda: (now(chain.tip, 2) - now(self.without(j), 2)) / self.accelerations[j - 1],
            "omega": lambda: now(axial(chain.rotation[j])),
            "alpha": lambda: now(axial(chain.rotation[j]), 1),
            "beta": lambda: now(axial(free.rotation[j]), 1),
            "zeta": lambda: now(free.axis[j], 1) * self.rates[j - 1] * self.leg.joints[j - 1].turn,
            "a_o": lambda: now(chain.origin[j], 2),
            "acc": lambda: self.acceleration(
                chain.tip if at_tip and j == self.count else chain.reference[j]
            ),
        }
        return values[stem]()

    def without(self, j: int) -> sp.Matrix:
        """The tip where joint j coasts and the others are accelerated."""
        n = self.names
        q = [n.situation.state.q[k] for k in range(self.count)]
        a = [0.0 if k + 1 == j else x for k, x in enumerate(self.accelerations)]
        moving = zip(q, self.rates, a, strict=True)
        return Chain(self.leg, [x + v * s + w * s**2 / 2 for x, v, w in moving]).tip


NAMES = ["stewart", "planar_3rrr", "hybrid_3crs", "tripod_3rps"]


@pytest.mark.parametrize("name", sampled(NAMES, 4))
def test_rates_and_accelerations_are_derivatives(name: str) -> None:
    motion = Motion(name)
    n, compared = motion.names, set()
    # The derivation's rates and accelerations of the joints carry the leg where the platform goes.
    for order in range(3):
        assert np.allclose(now(motion.chain.tip, order), now(motion.point, order), atol=1e-9)
    chapters = [c for c in motion.derivation.chapters if c.leg_type == n.leg_type]
    for equation in (e for c in chapters for e in c.equations if e.law is Law.RATE):
        stem, _, number = n.stem(equation.name).rpartition("_")
        if not number.isdigit():
            stem, number = n.stem(equation.name), "0"
        expected = motion.expected(stem, int(number))
        assert np.allclose(n[equation.name], expected, rtol=1e-9, atol=1e-9), equation.name
        compared.add(stem)
    assert {"S_dot", "S_ddot", "v", "omega", "alpha", "acc"} <= compared
