"""Numeric kinematics of a specification: task spaces, poses, and a leg's chain of joints.

The generated code has its own inverse kinematics; what stands here serves to check a
specification, to settle at home what is settled there, and to draw.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from pne_sym.model.manipulator import Joint, Leg, Manipulator, Space, Vector3

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class TaskSpace:
    """What a task space consists of.

    Attributes:
        components: indices into the six components (linear, then angular) of
            twist and wrench that are coordinates.
        pose_names: names of the platform coordinates in X.
        planar: everything happens in the plane z = 0.
    """

    components: tuple[int, ...]
    pose_names: tuple[str, ...]
    planar: bool

    @property
    def rate_names(self) -> tuple[str, ...]:
        """Names of the entries of V."""
        return tuple(("vx", "vy", "vz", "wx", "wy", "wz")[c] for c in self.components)

    @property
    def wrench_names(self) -> tuple[str, ...]:
        """Names of the entries of a wrench."""
        return tuple(("fx", "fy", "fz", "mx", "my", "mz")[c] for c in self.components)

    @property
    def rotates(self) -> bool:
        """Whether the platform's orientation is a coordinate."""
        return any(c >= 3 for c in self.components)

    @property
    def translates(self) -> bool:
        """Whether the platform's position is a coordinate."""
        return any(c < 3 for c in self.components)

    @property
    def quaternion_at(self) -> int | None:
        """Where the quaternion of the orientation begins in X, if there is one."""
        return self.pose_names.index("qx") if "qx" in self.pose_names else None


_QUATERNION = ("qx", "qy", "qz", "qw")
TASK_SPACES: dict[Space, TaskSpace] = {
    Space.POINT: TaskSpace((0, 1), ("x", "y"), True),
    Space.PLANAR: TaskSpace((0, 1, 5), ("x", "y", "phi"), True),
    Space.SPATIAL: TaskSpace((0, 1, 2, 3, 4, 5), ("x", "y", "z", *_QUATERNION), False),
    Space.TRANSLATIONAL: TaskSpace((0, 1, 2), ("x", "y", "z"), False),
    Space.SPHERICAL: TaskSpace((3, 4, 5), _QUATERNION, False),
}


@dataclass(frozen=True)
class Pose:
    """Position (m) and rotation matrix of a body, in the base frame or in leg axes."""

    t: Array
    R: Array


ORIGIN = Pose(np.zeros(3), np.eye(3))
"""Where a leg's chain begins, in its own axes."""


def pose_at(space: Space, X: Sequence[float], centre: Vector3 | None) -> Pose:
    """The pose that the platform coordinates state."""
    of = TASK_SPACES[space]
    R = rotation_about((0.0, 0.0, 1.0), X[2]) if of.planar and of.rotates else np.eye(3)
    if of.quaternion_at is not None:
        R = rotation_of_quaternion(X[of.quaternion_at : of.quaternion_at + 4])
    position = (*X[:2], 0.0) if of.planar else X[:3]
    return Pose(np.array(position if of.translates else centre), R)


def displaced(space: Space, X: Array, step: Array) -> Array:
    """Platform coordinates moved by a small twist (components as in `TaskSpace`)."""
    start = TASK_SPACES[space].quaternion_at
    if start is None:
        return X + step
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


def rotation_about(axis: Sequence[float] | Array, angle: float | Array) -> Array:
    """The rotation about a unit axis (Rodrigues' formula); rotations by an array of angles."""
    k = skew(np.asarray(axis, dtype=float))
    if np.ndim(angle):
        sine, cosine = (of(angle)[..., None, None] for of in (np.sin, np.cos))
    else:  # by libm, whose digits NumPy does not promise
        sine, cosine = np.array((math.sin(angle), math.cos(angle)))
    result: Array = np.eye(3) + sine * k
    return result + (1.0 - cosine) * (k @ k)


def skew(a: Array) -> Array:
    """The matrix that multiplies b to a x b (Rule II)."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


_LEVI_CIVITA = np.cross(np.eye(3)[:, None], np.eye(3)[None]).transpose(2, 0, 1)


def cross(a: Array, b: Array) -> Array:
    """a x b of vectors (..., 3); `np.cross` takes five times as long for a few."""
    result: Array = np.einsum("ijk,...j,...k->...i", _LEVI_CIVITA, a, b)
    return result


@dataclass(frozen=True)
class ChainPose:
    """A leg's chain of joints at given displacements, from where it begins.

    Of many states at once vectors are (..., 3) and rotations (..., 3, 3).

    Attributes:
        joints: of the leg, n of them.
        origins: of the joints, on the links before them (n vectors, m).
        points: origins of the links that the joints move (n vectors, m).
        axes: of the joints (n unit vectors).
        rotations: of the base and of the links, n + 1.
        tip: the platform joint on the last link (m).
    """

    joints: tuple[Joint, ...]
    origins: tuple[Array, ...]
    points: tuple[Array, ...]
    axes: tuple[Array, ...]
    rotations: tuple[Array, ...]
    tip: Array

    @property
    def last(self) -> Array:
        """The last link's rotation."""
        return self.rotations[-1]

    @property
    def spins(self) -> Array:
        """Angular velocity of the last link per joint rate, (..., 3, n)."""
        pairs = zip(self.joints, self.axes, strict=True)
        return np.moveaxis(np.array([axis * joint.turn for joint, axis in pairs]), 0, -1)

    @property
    def velocities(self) -> Array:
        """Velocity of the tip per joint rate, (..., 3, n) (method: the v_j)."""
        columns = []
        for joint, axis, origin in zip(self.joints, self.axes, self.origins, strict=True):
            column = joint.advance * axis
            if joint.turns:
                column = column + joint.turn * cross(axis, self.tip - origin)
            columns.append(column)
        return np.moveaxis(np.array(columns), 0, -1)


def chain_pose(leg: Leg, q: Sequence[float] | Array, start: Pose = ORIGIN) -> ChainPose:
    """The chain of a leg at displacements q (..., n); in leg axes, or from where its base is."""
    q = np.asarray(q, dtype=float)
    states = q.shape[:-1]
    point, rotation = (
        np.broadcast_to(start.t, (*states, 3)),
        np.broadcast_to(start.R, (*states, 3, 3)),
    )
    origins, points, axes, rotations = [], [], [], [rotation]
    for joint, x in zip(leg.joints, np.moveaxis(q, -1, 0), strict=True):
        origin = point + rotation @ np.array(joint.offset)
        axis = rotation @ np.array(joint.axis)
        point = origin + (joint.advance * x)[..., None] * axis
        if joint.turns:
            rotation = rotation @ rotation_about(joint.axis, joint.turn * x)
        origins.append(origin)
        points.append(point)
        axes.append(axis)
        rotations.append(rotation)
    tip = point + rotation @ np.array(leg.platform_joint.offset)
    return ChainPose(leg.joints, tuple(origins), tuple(points), tuple(axes), tuple(rotations), tip)


def at_home(manipulator: Manipulator) -> tuple[Pose, list[Array]]:
    """The platform's pose, and the displacements of every leg."""
    m, q = manipulator, np.array(manipulator.home.q)
    return pose_at(m.space, m.home.X, m.fixed_centre), [q[s] for s in slices_of(m.legs)]


def slices_of(legs: Sequence[Leg]) -> list[slice]:
    """Where each leg's displacements stand in q."""
    ends = np.cumsum([0, *(len(leg.joints) for leg in legs)]).tolist()
    return [slice(a, b) for a, b in pairwise(ends)]


def base_of(leg: Leg) -> Pose:
    """Where the chain of a leg begins, in the base frame."""
    return Pose(np.array(leg.base_point), np.array(leg.base_frame))
