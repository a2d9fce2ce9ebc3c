"""Flat coordinates of a manipulator and the platform's motion as poses.

Order of everything: legs as in the description, then joints from the base.  A platform
twist has six components here, whatever the space: velocity of the platform origin, then
angular velocity, both in base axes; `twist_basis` embeds the space's own V in it.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from pne_sym.model.manipulator import Manipulator, Space
from tests.oracle.jets import Array, Jet, cross, cross_matrix, cross_vector, taylor

_TWIST_COMPONENTS: dict[Space, tuple[int, ...]] = {
    Space.POINT: (0, 1),
    Space.PLANAR: (0, 1, 5),
    Space.SPATIAL: (0, 1, 2, 3, 4, 5),
    Space.TRANSLATIONAL: (0, 1, 2),
    Space.SPHERICAL: (3, 4, 5),
}
_POSE_SIZE: dict[Space, int] = {
    Space.POINT: 2,
    Space.PLANAR: 3,
    Space.SPATIAL: 7,
    Space.TRANSLATIONAL: 3,
    Space.SPHERICAL: 4,
}


@dataclass(frozen=True)
class Pose:
    """Position and orientation of one or more frames as functions of time.

    Attributes:
        origin: (..., 3), base frame, m.
        rotation: (..., 3, 3), from the frame's axes to base axes.
    """

    origin: Jet
    rotation: Jet


def is_planar(space: Space) -> bool:
    """Whether the mechanism moves in the plane z = 0."""
    return space in (Space.POINT, Space.PLANAR)


def pose_size(space: Space) -> int:
    """Number of pose entries in X, extra coordinates not counted."""
    return _POSE_SIZE[space]


def task_size(space: Space) -> int:
    """Number of the platform's degrees of freedom in V, extra coordinates not counted."""
    return len(_TWIST_COMPONENTS[space])


def twist_basis(space: Space) -> Array:
    """Matrix (6, nt) from the space's V to a twist of the platform origin."""
    return np.eye(6)[:, list(_TWIST_COMPONENTS[space])]


def joint_slices(manipulator: Manipulator) -> tuple[slice, ...]:
    """Where each leg's displacements are in the flat q."""
    bounds = np.cumsum([0, *(len(leg.joints) for leg in manipulator.legs)])
    return tuple(slice(int(first), int(stop)) for first, stop in pairwise(bounds))


def extra_indices(manipulator: Manipulator) -> list[int]:
    """Indices in the flat q of the joints whose displacements are extra coordinates."""
    joints = [joint for leg in manipulator.legs for joint in leg.joints]
    return [index for index, joint in enumerate(joints) if joint.extra]


def actuated_indices(manipulator: Manipulator) -> list[int]:
    """Indices in the flat q of the actuated joints: the order of tau."""
    joints = [joint for leg in manipulator.legs for joint in leg.joints]
    return [index for index, joint in enumerate(joints) if joint.actuated]


def passive_extra_rows(manipulator: Manipulator) -> list[int]:
    """Entries of V that belong to extra coordinates whose joints are not actuated."""
    joints = [joint for leg in manipulator.legs for joint in leg.joints if joint.extra]
    first = task_size(manipulator.space)
    return [first + row for row, joint in enumerate(joints) if not joint.actuated]


def rotation_from_quaternion(quaternion: Array) -> Array:
    """Rotation matrix of a quaternion x, y, z, w; normalised first."""
    unit = quaternion / np.linalg.norm(quaternion)
    tilde = cross_matrix(unit[:3])
    rotation: Array = np.eye(3) + 2.0 * unit[3] * tilde + 2.0 * tilde @ tilde
    return rotation


def quaternion_product(left: Array, right: Array) -> Array:
    """Quaternion of the rotation `right` followed by `left`; x, y, z, w."""
    vector = left[3] * right[:3] + right[3] * left[:3] + cross(left[:3], right[:3])
    return np.array([*vector, left[3] * right[3] - left[:3] @ right[:3]])


def quaternion_of_vector(vector: Array) -> Array:
    """Quaternion x, y, z, w of a rotation vector (axis times angle, rad)."""
    half = 0.5 * float(np.linalg.norm(vector))
    # numpy.sinc(x) is sin(pi x) / (pi x): smooth through zero.
    return np.array([*(0.5 * np.sinc(half / np.pi) * vector), np.cos(half)])


def rotation_vector(rotation: Array) -> Array:
    """Axis times angle of a rotation matrix, for angles below pi."""
    sine_axis = cross_vector(rotation)
    sine = float(np.linalg.norm(sine_axis))
    angle = float(np.arctan2(sine, 0.5 * (np.trace(rotation) - 1.0)))
    return sine_axis * (angle / sine if sine > 1e-12 else 1.0)


def platform_position(manipulator: Manipulator, X: Array) -> Array:
    """Platform origin (3,) in the base frame, m."""
    space = manipulator.space
    if space is Space.SPHERICAL:
        return np.array(manipulator.fixed_centre)
    if is_planar(space):
        return np.array([X[0], X[1], 0.0])
    return np.array(X[:3])


def platform_rotation(manipulator: Manipulator, X: Array) -> Array:
    """base_R_platform (3, 3)."""
    space = manipulator.space
    if space is Space.PLANAR:
        cos, sin = np.cos(X[2]), np.sin(X[2])
        return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    if space is Space.SPATIAL:
        return rotation_from_quaternion(X[3:7])
    if space is Space.SPHERICAL:
        return rotation_from_quaternion(X[:4])
    return np.eye(3)


def platform_motion(manipulator: Manipulator, X: Array, twist: Array, twist_rate: Array) -> Pose:
    """The platform's pose as a function of time.

    Args:
        manipulator: mechanism.
        X: coordinates at t = 0.
        twist: (..., 6) velocity of the origin and angular velocity, base axes.
        twist_rate: (..., 6) their time derivatives.

    Returns:
        Pose of the platform frame, with the leading axes of `twist`.
    """
    rotation = platform_rotation(manipulator, X)
    spin = cross_matrix(twist[..., 3:])
    # exp([omega t + alpha t^2 / 2]) R to second order in t.
    return Pose(
        taylor(platform_position(manipulator, X), twist[..., :3], twist_rate[..., :3]),
        taylor(
            rotation,
            spin @ rotation,
            (cross_matrix(twist_rate[..., 3:]) + spin @ spin) @ rotation,
        ),
    )


def displaced(manipulator: Manipulator, X: Array, step: Array) -> Array:
    """Coordinates after a finite step along V.

    Args:
        manipulator: mechanism.
        X: (nq,) coordinates.
        step: (nv,) displacement of the origin, rotation vector in base axes (applied after
            the present rotation), increments of the extra coordinates.

    Returns:
        (nq,) coordinates; quaternions normalised.
    """
    space, result = manipulator.space, np.array(X, dtype=float)
    pose, task = pose_size(space), task_size(space)
    result[pose:] += step[task:]
    if space in (Space.SPATIAL, Space.SPHERICAL):
        first = pose - 4
        result[:first] += step[:first]
        turned = quaternion_product(quaternion_of_vector(step[first:task]), result[first:pose])
        result[first:pose] = turned / np.linalg.norm(turned)
    else:
        result[:pose] += step[:task]
    return result


def step_between(manipulator: Manipulator, X_from: Array, X_to: Array) -> Array:
    """The step (nv,) for which `displaced(X_from, step)` is the pose `X_to`."""
    space = manipulator.space
    pose, task = pose_size(space), task_size(space)
    extra = X_to[pose:] - X_from[pose:]
    if space not in (Space.SPATIAL, Space.SPHERICAL):
        return np.concatenate([X_to[:task] - X_from[:task], extra])
    turn = rotation_vector(
        platform_rotation(manipulator, X_to) @ platform_rotation(manipulator, X_from).T
    )
    return np.concatenate([X_to[: pose - 4] - X_from[: pose - 4], turn, extra])
