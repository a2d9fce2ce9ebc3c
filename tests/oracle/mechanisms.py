"""Mechanisms of any structure, written in a few letters, with random geometry.

A leg is written as its joints from the base, a bar, and its platform joint:
"Rz0 Ry Px* | S".  A joint is its kind (R, P, H), its axis (x, y, z: a coordinate direction
of the preceding link's frame; t: tilted), then any of 0 (the link has no mass), * (actuated),
+ (extra coordinate).  A platform joint is S, R, U or rigid.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pne_sym.model.manipulator import (
    Body,
    Home,
    Joint,
    JointKind,
    Leg,
    Manipulator,
    PlatformJoint,
    PlatformJointKind,
    Space,
    Vector3,
)
from tests.oracle.chain import carried_point, chain_poses
from tests.oracle.closure import OracleError, leg_closure, perpendicular_pair
from tests.oracle.coordinates import (
    Pose,
    extra_indices,
    is_planar,
    platform_motion,
    quaternion_of_vector,
    rotation_from_quaternion,
    task_size,
)
from tests.oracle.jets import Array, constant
from tests.oracle.projection import project
from tests.oracle.randomisation import matrix3, random_inertia, vector3

_DIRECTIONS = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_LEAST_LEG_QUALITY = 0.05
_LEAST_DRIVE_QUALITY = 0.03
_ATTEMPTS = 300


def mechanism(
    space: Space | str, legs: Sequence[str], rng: np.random.Generator, *, plain: bool = False
) -> Manipulator:
    """A manipulator with the given legs, closed at a random home.

    Args:
        space: task space.
        legs: one string per leg, see the module.
        rng: source of randomness.
        plain: True: joints lie on the axis of the one before, as in textbook legs (offsets
            only along x after a revolute joint with a massive link); not every structure
            is regular so.  False: about half of all components of offsets vanish.

    Returns:
        A manipulator that is regular at home: legs and actuators are not near a singularity.

    Raises:
        OracleError: no regular geometry was found.
    """
    for _ in range(_ATTEMPTS):
        candidate = _draw(Space(space), legs, rng, plain=plain)
        nv = task_size(candidate.space) + len(extra_indices(candidate))
        state = project(
            candidate, np.array(candidate.home.X), np.array(candidate.home.q), np.zeros(nv)
        )
        actuators = np.hstack([state.H, state.Hk])
        reached = np.abs(actuators).max(axis=1) > 1e-12
        values = np.linalg.svd(actuators[reached], compute_uv=False)
        if values.min() > _LEAST_DRIVE_QUALITY * values.max():
            return candidate
    raise OracleError(f"no regular geometry for {space}: {', '.join(legs)}")


def _draw(
    space: Space, legs: Sequence[str], rng: np.random.Generator, *, plain: bool
) -> Manipulator:
    planar = is_planar(space)
    inertia = random_inertia(rng, 0.05)
    platform = Body(3.0, _vector(rng, 0.1, planar=planar), inertia)
    empty = Manipulator(
        name="random",
        title=f"{space}: {', '.join(legs)}",
        space=space,
        gravity=_vector(rng, 9.0, planar=planar),
        platform=Body(mass=3.0) if space is Space.POINT else platform,
        legs=(),
        home=Home(X=(), q=()),
        fixed_centre=_vector(rng, 0.2, planar=False) if space is Space.SPHERICAL else None,
    )
    pose = _home_pose(space, rng)
    drawn = [_draw_regular_leg(empty, code, pose, rng, plain=plain) for code in legs]
    q = np.concatenate([displacements for _, displacements in drawn])
    manipulator = replace(empty, legs=tuple(leg for leg, _ in drawn))
    X = np.concatenate([pose, q[extra_indices(manipulator)]])
    home = Home(X=tuple(map(float, X)), q=tuple(map(float, q)))
    return replace(manipulator, home=home)


def _home_pose(space: Space, rng: np.random.Generator) -> Array:
    place = rng.uniform(-0.3, 0.3, 3)
    turn = quaternion_of_vector(rng.uniform(-0.4, 0.4, 3))
    poses: dict[Space, Array] = {
        Space.POINT: place[:2],
        Space.PLANAR: place,
        Space.SPATIAL: np.concatenate([place, turn]),
        Space.TRANSLATIONAL: place,
        Space.SPHERICAL: turn,
    }
    return poses[space]


def _draw_regular_leg(
    manipulator: Manipulator, code: str, pose: Array, rng: np.random.Generator, *, plain: bool
) -> tuple[Leg, Array]:
    """A leg, not near a singularity, and its displacements at the platform's pose."""
    platform = platform_motion(manipulator, pose, np.zeros(6), np.zeros(6))
    for _ in range(_ATTEMPTS):
        leg, q = _draw_leg(manipulator.space, code, platform, rng, plain=plain)
        free = [index for index, joint in enumerate(leg.joints) if not joint.extra]
        jacobian = leg_closure(manipulator, leg, pose, q).joints[:, free]
        values = np.linalg.svd(jacobian, compute_uv=False)
        if values.min() > _LEAST_LEG_QUALITY * values.max():
            return leg, q
    raise OracleError(f"no regular geometry for the leg {code}")


def _draw_leg(
    space: Space, code: str, platform: Pose, rng: np.random.Generator, *, plain: bool
) -> tuple[Leg, Array]:
    """A leg and the displacements that close it at the platform's pose."""
    joint_codes, kind = (part.strip() for part in code.split("|"))
    planar = is_planar(space)
    tilt = rng.uniform(-3.0, 3.0, 3) * ((0.0, 0.0, 1.0) if planar else (1.0, 1.0, 1.0))
    joints: list[Joint] = []
    for joint_code in joint_codes.split():
        joints.append(_draw_joint(joint_code, joints, rng, planar=planar, plain=plain))
    q = np.array([_draw_displacement(joint, rng) for joint in joints])
    leg = Leg(
        base_point=(0.0, 0.0, 0.0),
        base_frame=matrix3(rotation_from_quaternion(quaternion_of_vector(tilt))),
        joints=tuple(joints),
        platform_joint=PlatformJoint(
            PlatformJointKind(kind), offset=_offset(rng, joints, planar=planar, plain=plain)
        ),
        platform_point=(0.0,) * 3 if space is Space.POINT else _vector(rng, 0.3, planar=planar),
    )
    return _closed(leg, q, platform, rng, planar=planar), q


def _closed(leg: Leg, q: Array, platform: Pose, rng: np.random.Generator, *, planar: bool) -> Leg:
    """Place the base point, and the axes on the platform, so that the leg closes at q."""
    last_link = chain_poses(leg, constant(q))[-1]
    end = carried_point(last_link, leg.platform_joint.offset).value
    seat = carried_point(platform, leg.platform_point).value
    to_platform = platform.rotation.value.T @ last_link.rotation.value
    joint = leg.platform_joint
    if joint.kind is PlatformJointKind.RIGID:
        joint = replace(joint, rotation=matrix3(to_platform.T))
    elif joint.kind is not PlatformJointKind.SPHERICAL and not planar:
        # Not parallel to the last joint's axis: the two would turn the same way.
        others = [axis for axis in _DIRECTIONS.values() if axis != leg.joints[-1].axis]
        axis = np.array(others[rng.integers(len(others))])
        on_platform = axis
        if joint.kind is PlatformJointKind.UNIVERSAL:
            angle = rng.uniform(0.0, 2.0 * np.pi)
            first, second = perpendicular_pair(axis)
            on_platform = np.cos(angle) * first + np.sin(angle) * second
        joint = replace(
            joint, axis_link=vector3(axis), axis_platform=vector3(to_platform @ on_platform)
        )
    return replace(leg, base_point=vector3(seat - end), platform_joint=joint)


def _draw_joint(
    code: str, before: list[Joint], rng: np.random.Generator, *, planar: bool, plain: bool
) -> Joint:
    kind, axis_code, marks = JointKind(code[0]), code[1], code[2:]
    axis = _DIRECTIONS.get(axis_code)
    if axis is None:
        drawn = np.array(_vector(rng, 1.0, planar=planar))
        axis = vector3(drawn / np.linalg.norm(drawn))
    link = Body(
        mass=float(rng.uniform(0.5, 2.0)),
        centre_of_mass=_vector(rng, 0.2, planar=planar),
        inertia=random_inertia(rng, 0.03),
    )
    offset = _offset(rng, before, planar=planar, plain=plain)
    if before and kind is before[-1].kind is JointKind.REVOLUTE and axis == before[-1].axis:
        # Two revolute joints on one axis would be one joint.
        offset = _vector(rng, 0.4, planar=planar)
    return Joint(
        kind=kind,
        axis=axis,
        offset=offset,
        pitch=float(rng.uniform(0.02, 0.1)) if kind is JointKind.HELICAL else 0.0,
        actuated="*" in marks,
        extra="+" in marks,
        link=Body() if "0" in marks else link,
    )


def _offset(rng: np.random.Generator, before: list[Joint], *, planar: bool, plain: bool) -> Vector3:
    if plain:
        point_joint = not before or before[-1].link.is_massless
        hinge = not point_joint and before[-1].kind is JointKind.REVOLUTE
        return (float(rng.uniform(0.25, 0.5)), 0.0, 0.0) if hinge else (0.0, 0.0, 0.0)
    present = rng.integers(0, 2, 3)
    return vector3(np.where(present, _vector(rng, 0.4, planar=planar), 0.0))


def _draw_displacement(joint: Joint, rng: np.random.Generator) -> float:
    if joint.kind is JointKind.PRISMATIC:
        return float(rng.uniform(0.3, 0.8))
    return float(rng.uniform(-1.2, 1.2))


def _vector(rng: np.random.Generator, spread: float, *, planar: bool) -> Vector3:
    vector = rng.uniform(-spread, spread, 3)
    if planar:
        vector[2] = 0.0
    return vector3(vector)
