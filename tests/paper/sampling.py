"""Random asymmetric legs, platforms and states of the four worked examples.

The structure is the catalogue's; every number that is a live parameter is drawn: points,
lengths, frames, masses, centres of mass off the axes, full inertia tensors, gravity in any
direction.  Legs are drawn first and the base points follow, so that every loop closes.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np

from pne_sym import manipulators
from pne_sym.model.manipulator import Body, Home, Leg, Manipulator, Space
from tests.oracle.coordinates import rotation_from_quaternion
from tests.oracle.randomisation import matrix3, random_inertia, vector3
from tests.paper.printed import (
    Array,
    PlatformBody,
    PrismaticLeg,
    RevoluteLeg,
    SpatialLeg,
    planar_turn,
)

SEED = 1999
COUNT = 100
NAMES = ("fivebar_prismatic", "fivebar_revolute", "hybrid_3prps", "tripod_3rps")
_E = np.eye(3)


class Sample(NamedTuple):
    """A random manipulator at a random state.

    Attributes:
        manipulator: catalogue structure, random numbers.
        X, V: closed pose; velocity, admissible where there are constraints.
    """

    manipulator: Manipulator
    X: Array
    V: Array


@cache
def samples(name: str) -> tuple[Sample, ...]:
    """The samples of an example, the same at every call and on every machine."""
    rng = np.random.default_rng((SEED, NAMES.index(name)))
    nominal = manipulators.load(name)
    return tuple(_sample(nominal, rng) for _ in range(COUNT))


def _sample(nominal: Manipulator, rng: np.random.Generator) -> Sample:
    planar = nominal.space is Space.POINT
    t, quaternion = _drawn(rng, 0.5, planar), _quaternion(rng)
    R = np.eye(3) if planar else rotation_from_quaternion(quaternion)
    legs, q = [], []
    for index, leg in enumerate(nominal.legs):
        frame = _turn_z(rng.uniform(-np.pi, np.pi)) if planar else _rotation(rng)
        point = np.zeros(3) if planar else _drawn(rng, 0.4, planar)
        drawn, reach, turns = _leg(nominal, index, leg, rng)
        base = t + R @ point - frame @ reach
        legs.append(
            replace(
                drawn,
                base_point=vector3(base),
                base_frame=matrix3(frame),
                platform_point=vector3(point),
            )
        )
        q.extend(turns)
    body = Body(float(rng.uniform(1.0, 10.0)))
    if not planar:
        body = Body(body.mass, vector3(_drawn(rng, 0.2, planar)), random_inertia(rng, 0.5))
    X = t[:2] if planar else np.concatenate((t, quaternion))
    manipulator = replace(
        nominal,
        gravity=vector3(_drawn(rng, 10.0, planar)),
        platform=body,
        legs=tuple(legs),
        home=Home(tuple(map(float, X)), tuple(map(float, q))),
    )
    V = rng.uniform(-1.5, 1.5, 2 if planar else 6)
    if nominal.name == "tripod_3rps":
        k = [np.array(leg.base_frame)[:, 2] for leg in legs]
        arms = [R @ np.array(leg.platform_point) for leg in legs]
        rows = np.array([[*a, *np.cross(b, a)] for a, b in zip(k, arms, strict=True)])
        V = V - np.linalg.pinv(rows) @ (rows @ V)
    return Sample(manipulator, X, V)


def _leg(
    nominal: Manipulator, index: int, leg: Leg, rng: np.random.Generator
) -> tuple[Leg, Array, list[float]]:
    """Random links; from the base point to the connection point in leg axes; displacements."""
    planar = nominal.space is Space.POINT
    joints = tuple(replace(joint, link=_link(rng, planar)) for joint in leg.joints)
    angle = float(rng.uniform(-np.pi, np.pi))
    if nominal.name == "fivebar_revolute":
        lower, upper = (float(v) for v in rng.uniform(0.3, 0.9, 2))
        home = nominal.home.q[2 * index + 1]
        elbow = float(np.copysign(rng.uniform(0.5, 2.6), home))
        joints = (joints[0], replace(joints[1], offset=(lower, 0.0, 0.0)))
        end = replace(leg.platform_joint, offset=(upper, 0.0, 0.0))
        reach = _turn_z(angle) @ (lower * _E[0] + upper * _turn_z(elbow) @ _E[0])
        return replace(leg, joints=joints, platform_joint=end), reach, [angle, elbow]
    length = float(rng.uniform(0.4, 1.2))
    reach = length * _turn_z(angle) @ _E[0]
    if nominal.name != "hybrid_3prps":
        return replace(leg, joints=joints), reach, [angle, length]
    slide = float(rng.uniform(-0.5, 0.5))
    return replace(leg, joints=joints), reach + slide * _E[2], [slide, angle, length]


def _link(rng: np.random.Generator, planar: bool) -> Body:
    mass = float(rng.uniform(0.5, 3.0))
    return Body(mass, vector3(_drawn(rng, 0.3, planar)), random_inertia(rng, 0.1 * mass))


def _drawn(rng: np.random.Generator, size: float, planar: bool) -> Array:
    vector = rng.uniform(-size, size, 3)
    if planar:
        vector[2] = 0.0
    return np.asarray(vector)


def _rotation(rng: np.random.Generator) -> Array:
    return rotation_from_quaternion(_quaternion(rng))


def _quaternion(rng: np.random.Generator) -> Array:
    quaternion = rng.normal(size=4)
    return np.asarray(quaternion / np.linalg.norm(quaternion))


def _turn_z(angle: float) -> Array:
    turn = np.eye(3)
    turn[:2, :2] = planar_turn(angle)
    return turn


# ---- the same in the paper's symbols ---------------------------------------------------------


def point_legs(sample: Sample) -> list[PrismaticLeg | RevoluteLeg]:
    """The legs of a five-bar as the paper sees them."""
    made = _revolute if sample.manipulator.name == "fivebar_revolute" else _prismatic
    return [made(sample, leg) for leg in sample.manipulator.legs]


def _prismatic(sample: Sample, leg: Leg) -> PrismaticLeg:
    lower, upper = (joint.link for joint in leg.joints)
    S = sample.X - np.array(leg.base_point)[:2]
    turn = planar_turn(float(np.arctan2(S[1], S[0])))
    return PrismaticLeg(
        S=S,
        S_dot=sample.V,
        r_d=turn @ np.array(lower.centre_of_mass)[:2],
        rho_u=turn @ np.array(upper.centre_of_mass)[:2],
        m_d=lower.mass,
        I_d=lower.inertia[2][2],
        m_u=upper.mass,
        I_u=upper.inertia[2][2],
        g=gravity(sample)[:2],
    )


def _revolute(sample: Sample, leg: Leg) -> RevoluteLeg:
    lower, upper = (joint.link for joint in leg.joints)
    number = sample.manipulator.legs.index(leg)
    return RevoluteLeg(
        S=sample.X - np.array(leg.base_point)[:2],
        S_dot=sample.V,
        branch=float(np.sign(sample.manipulator.home.q[2 * number + 1])),
        low=leg.joints[1].offset[0],
        u=leg.platform_joint.offset[0],
        com_d=np.array(lower.centre_of_mass)[:2],
        com_u=np.array(upper.centre_of_mass)[:2],
        m_d=lower.mass,
        I_d=lower.inertia[2][2],
        m_u=upper.mass,
        I_u=upper.inertia[2][2],
        g=gravity(sample)[:2],
    )


def spatial_legs(sample: Sample) -> list[SpatialLeg]:
    """The legs of a 3-PRPS or 3-RPS as the paper sees them."""
    R = rotation_from_quaternion(sample.X[3:])
    omega = sample.V[3:]
    found = []
    for leg in sample.manipulator.legs:
        *slide, low, up = (joint.link for joint in leg.joints)
        arm = R @ np.array(leg.platform_point)
        found.append(
            SpatialLeg(
                slides=bool(slide),
                x=sample.X[:3] + arm - np.array(leg.base_point),
                S_dot=sample.V[:3] + np.cross(omega, arm),
                q=arm,
                omega=omega,
                k=np.array(leg.base_frame)[:, 2],
                com_low=np.array(low.centre_of_mass),
                com_u=np.array(up.centre_of_mass),
                m_slide=sum(body.mass for body in slide),
                m_low=low.mass,
                I_low=np.array(low.inertia),
                m_u=up.mass,
                I_u=np.array(up.inertia),
                g=gravity(sample),
            )
        )
    return found


def platform(sample: Sample) -> PlatformBody:
    """The platform of a spatial example in global axes."""
    R, body = rotation_from_quaternion(sample.X[3:]), sample.manipulator.platform
    return PlatformBody(
        body.mass,
        R @ np.array(body.centre_of_mass),
        R @ np.array(body.inertia) @ R.T,
        sample.V[3:],
        gravity(sample),
    )


def gravity(sample: Sample) -> Array:
    """Acceleration of gravity."""
    return np.array(sample.manipulator.gravity)
