"""Loop closure at a pose, for the home of a specification only.

The generated code has its own inverse kinematics; this numerical one serves
to check and to polish the home that an author wrote.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pne_sym.model.manipulator import (
    IDENTITY3,
    JointKind,
    Leg,
    PlatformJointKind,
    Space,
    Vector3,
)

Array = npt.NDArray[np.float64]
Residual = Callable[[Array], Array]
Step = Callable[[Array], Array]
Move = Callable[[Array, Array], Array]

TWIST: dict[Space, tuple[int, ...]] = {
    Space.POINT: (0, 1),
    Space.PLANAR: (0, 1, 5),
    Space.SPATIAL: (0, 1, 2, 3, 4, 5),
    Space.TRANSLATIONAL: (0, 1, 2),
    Space.SPHERICAL: (3, 4, 5),
}
"""Components of the platform's twist (velocity, angular velocity) that are free."""

MAX_ITERATIONS = 30
_HALVINGS = 8
_LARGEST_STEP = 0.3
_SINGULAR = 1e-9


@dataclass(frozen=True)
class Pose:
    """Position (m) and rotation matrix of the platform in the base frame."""

    t: Array
    R: Array


def pose_at(space: Space, X: Sequence[float], centre: Vector3 | None) -> Pose:
    """The pose that the platform coordinates state."""
    eye = np.eye(3)
    if space is Space.POINT:
        return Pose(np.array([X[0], X[1], 0.0]), eye)
    if space is Space.PLANAR:
        return Pose(np.array([X[0], X[1], 0.0]), turned((0.0, 0.0, 1.0), X[2]))
    if space is Space.TRANSLATIONAL:
        return Pose(np.array(X[:3]), eye)
    if space is Space.SPHERICAL:
        return Pose(np.array(centre), rotation_of_quaternion(X[:4]))
    return Pose(np.array(X[:3]), rotation_of_quaternion(X[3:7]))


def displaced(space: Space, X: Array, step: Array) -> Array:
    """Platform coordinates moved by a small twist (components as in `TWIST`)."""
    if space not in (Space.SPATIAL, Space.SPHERICAL):
        return X + step
    start = 3 if space is Space.SPATIAL else 0
    spin = step[start : start + 3]
    moved = X.copy()
    moved[:start] += step[:start]
    x, y, z, w = X[start : start + 4]
    rate = np.array([[w, z, -y], [-z, w, x], [y, -x, w], [-x, -y, -z]])
    quaternion = X[start : start + 4] + 0.5 * rate @ spin
    moved[start : start + 4] = quaternion / np.linalg.norm(quaternion)
    return moved


def rotation_of_quaternion(quaternion: Sequence[float]) -> Array:
    """The rotation matrix of a unit quaternion (x, y, z, w)."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def turned(axis: Vector3, angle: float) -> Array:
    """The rotation about a unit axis (Rodrigues' formula)."""
    skew = _skew(np.array(axis))
    result: Array = np.eye(3) + math.sin(angle) * skew
    return result + (1.0 - math.cos(angle)) * (skew @ skew)


def leg_gap(leg: Leg, q: Array, pose: Pose) -> tuple[Array, Array, Array]:
    """How far a leg is from closing, and how the gap changes.

    Args:
        leg: the leg.
        q: displacements of its joints.
        pose: of the platform.

    Returns:
        the gap (points in m, then axes), its Jacobian by q, and by the
        platform's twist (6 columns).
    """
    origin, frame, axes = _chain(leg, q)
    tip = origin[-1]
    arm = pose.R @ np.array(leg.platform_point)
    gaps = [tip - pose.t - arm]
    by_q = [_point_columns(leg, axes, origin, tip)]
    by_twist = [np.hstack([-np.eye(3), _skew(arm)])]
    spins = np.array(
        [
            a if joint.kind is not JointKind.PRISMATIC else np.zeros(3)
            for joint, a in zip(leg.joints, axes, strict=True)
        ]
    )
    for link_axis, platform_axis, is_dot in _axis_conditions(leg):
        a, b = frame @ np.array(link_axis), pose.R @ np.array(platform_axis)
        a_by_q = np.cross(spins, a).T
        b_by_twist = np.hstack([np.zeros((3, 3)), -_skew(b)])
        if is_dot:
            gaps.append(np.array([a @ b]))
            by_q.append((b @ a_by_q)[None, :])
            by_twist.append((a @ b_by_twist)[None, :])
        else:
            gaps.append(a - b)
            by_q.append(a_by_q)
            by_twist.append(-b_by_twist)
    return np.concatenate(gaps), np.vstack(by_q), np.vstack(by_twist)


def solve(residual: Residual, step: Step, move: Move, x: Array) -> Array:
    """Newton's method with bounded and halved steps; returns the best point.

    Args:
        residual: at a point.
        step: that would cancel the residual, to first order.
        move: the point reached from a point by a step.
        x: first guess.
    """
    size = _largest(residual(x))
    for _ in range(MAX_ITERATIONS):
        direction = step(x)
        direction *= min(1.0, _LARGEST_STEP / max(_largest(direction), _LARGEST_STEP))
        for _ in range(_HALVINGS):
            trial = move(x, direction)
            trial_size = _largest(residual(trial))
            if trial_size < size:
                break
            direction *= 0.5
        else:
            return x
        x, size = trial, trial_size
    return x


def least_norm(matrix: Array, vector: Array) -> Array:
    """The least-norm least-squares solution of a small linear system."""
    solution: Array = np.linalg.lstsq(matrix, vector, rcond=_SINGULAR)[0].astype(np.float64)
    return solution


def unreachable(matrix: Array) -> Array:
    """An orthonormal basis (rows) of what the columns of a matrix cannot reach."""
    u, s, _ = np.linalg.svd(matrix)
    rank = int(np.sum(s > _SINGULAR * max(1.0, _largest(s))))
    basis: Array = u[:, rank:].T
    return basis


def _chain(leg: Leg, q: Array) -> tuple[list[Array], Array, list[Array]]:
    """Joint origins (the platform joint last), the last link's frame, axes; base axes."""
    point = np.array(leg.base_point)
    frame = np.array(leg.base_frame)
    origins: list[Array] = []
    axes: list[Array] = []
    for joint, displacement in zip(leg.joints, q, strict=True):
        point = point + frame @ np.array(joint.offset)
        direction = frame @ np.array(joint.axis)
        origins.append(point)
        axes.append(direction)
        if joint.kind is JointKind.PRISMATIC:
            point = point + displacement * direction
        else:
            point = point + joint.pitch * displacement * direction
            frame = frame @ turned(joint.axis, float(displacement))
    origins.append(point + frame @ np.array(leg.platform_joint.offset))
    return origins, frame, axes


def _point_columns(leg: Leg, axes: list[Array], origins: list[Array], tip: Array) -> Array:
    """Velocity of the tip for a unit rate of each joint."""
    columns = []
    for joint, axis, origin in zip(leg.joints, axes, origins, strict=False):
        if joint.kind is JointKind.PRISMATIC:
            columns.append(axis)
        else:
            columns.append(np.cross(axis, tip - origin) + joint.pitch * axis)
    return np.array(columns).T


def _axis_conditions(leg: Leg) -> list[tuple[Vector3, Vector3, bool]]:
    """Pairs of axes (link, platform) to coincide, or to be perpendicular (True)."""
    joint = leg.platform_joint
    if joint.kind is PlatformJointKind.RIGID and joint.rotation is not None:
        columns = tuple(zip(*joint.rotation, strict=True))
        return [(c, e, False) for c, e in zip(columns, IDENTITY3, strict=True)]
    if joint.axis_link is None or joint.axis_platform is None:
        return []
    return [(joint.axis_link, joint.axis_platform, joint.kind is PlatformJointKind.UNIVERSAL)]


def _largest(values: Array) -> float:
    return float(np.abs(values).max(initial=0.0))


def _skew(a: Array) -> Array:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
