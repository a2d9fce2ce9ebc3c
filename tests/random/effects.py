"""Friction, springs, motors, limits of drawn mechanisms: which by leg type, values by leg."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pne_sym.model.coupling import is_invertible
from pne_sym.model.effects import Actuator, Friction, Limits, Spring
from pne_sym.model.manipulator import Body, Joint, Leg, Manipulator, PlatformJoint, Space
from tests.oracle.coordinates import is_planar
from tests.oracle.randomisation import random_inertia, vector3

SHARE = 0.5
"""Of so many mechanisms some joints have some of these."""
PAYLOAD = 0.4
"""Of so many of these the platform carries something."""
LIKELY = 0.4
"""Of so many joints of such a mechanism each of these."""


def with_effects(
    manipulator: Manipulator, rng: np.random.Generator, share: float = SHARE, likely: float = LIKELY
) -> Manipulator:
    """The mechanism, now and then with friction, springs and motors in some joints."""
    if rng.random() > share:
        return manipulator
    if rng.random() < PAYLOAD and manipulator.space is not Space.POINT:
        flat = (1.0, 1.0, 0.0 if is_planar(manipulator.space) else 1.0)
        centre = vector3(rng.uniform(-0.2, 0.2, 3) * flat)
        payload = Body(float(rng.uniform(0.5, 3.0)), centre, random_inertia(rng, 0.05))
        manipulator = replace(manipulator, payload=payload)
    plans: dict[object, list[str]] = {}
    legs = []
    for leg in manipulator.legs:
        plan = plans.setdefault(_structure(leg), [_kinds(rng, likely) for _ in leg.joints])
        joints = [_dressed(j, kinds, rng) for j, kinds in zip(leg.joints, plan, strict=True)]
        legs.append(
            replace(
                leg,
                joints=tuple(joints),
                platform_joint=_rubbing(leg, joints[0], manipulator.space),
            )
        )
    return replace(manipulator, legs=tuple(legs))


def with_coupling(manipulator: Manipulator, rng: np.random.Generator) -> Manipulator:
    """The mechanism with motors that turn with several joints each, whatever their gears."""
    count = sum(joint.actuated for leg in manipulator.legs for joint in leg.joints)
    matrix = np.diag(rng.choice([-1.0, 1.0], count)) + rng.uniform(-0.3, 0.3, (count, count))
    rows = tuple(tuple(float(v) for v in row) for row in matrix[rng.permutation(count)])
    return replace(manipulator, coupling=rows if is_invertible(rows) else None)


def with_efforts(manipulator: Manipulator, every: int = 1, effort: float = 60.0) -> Manipulator:
    """The mechanism with limits of effort at one of so many actuators, beside its other limits."""
    seen, legs = 0, []
    for leg in manipulator.legs:
        joints = []
        for joint in leg.joints:
            seen, limits = seen + joint.actuated, joint.limits
            if joint.actuated and seen % every == 0:
                limits = replace(limits or Limits(), effort=effort + seen)
            joints.append(replace(joint, limits=limits))
        legs.append(replace(leg, joints=tuple(joints)))
    return replace(manipulator, legs=tuple(legs))


def _rubbing(leg: Leg, first: Joint, space: Space) -> PlatformJoint:
    """The platform joint with the friction of the first joint, if it turns."""
    turns = space is not Space.POINT and len(leg.platform_joint.kind.right_angles) < 3
    return replace(leg.platform_joint, friction=first.friction if turns else None)


def _structure(leg: Leg) -> object:
    return tuple((j.kind, j.actuated, j.extra, j.link.is_massless, j.axis) for j in leg.joints)


def _kinds(rng: np.random.Generator, likely: float) -> str:
    """Letters: v viscous, c Coulomb, s spring, m motor."""
    return "".join(letter for letter in "vcsm" if rng.random() < likely)


def _dressed(joint: Joint, kinds: str, rng: np.random.Generator) -> Joint:
    viscous, coulomb, scale, stiffness, inertia = rng.uniform(0.5, 2.0, 5)
    rest, ratio = rng.uniform(-1.0, 1.0), rng.uniform(20.0, 60.0) * rng.choice([-1.0, 1.0])
    friction = Friction(
        float(viscous) if "v" in kinds else None,
        float(4.0 * coulomb) if "c" in kinds else None,
        float(0.1 * scale) if "c" in kinds else None,
    )
    return replace(
        joint,
        friction=friction if {"v", "c"} & set(kinds) else None,
        spring=Spring(float(10.0 * stiffness), float(rest)) if "s" in kinds else None,
        actuator=Actuator(float(1e-4 * inertia), float(ratio))
        if "m" in kinds and joint.actuated
        else None,
        limits=Limits((-20.0 * float(viscous), 20.0 * float(scale))) if "s" in kinds else None,
    )
