"""Operations: rotations of the platform, as matrices, quaternions and angles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pne_sym.program.evaluate import Array
from pne_sym.program.operation import Operations, blanked, finite

ORTHONORMAL = 1e-6
"""By how much the products of a rotation matrix's rows may differ from those of unit vectors."""
OPERATIONS = Operations()


@OPERATIONS()
def rotation_of_quaternion(a: Array) -> Array:
    """The rotation matrix of the quaternion a (x, y, z, w) of any length; INVALID if it is zero."""
    x, y, z, w = _scaled(a).T
    n = x * x + y * y + z * z + w * w
    rows = (
        (x * x + w * w - (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), y * y + w * w - (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), z * z + w * w - (x * x + y * y)),
    )
    return np.moveaxis(np.array(rows) / n, -1, 0)


def _scaled(q: Array) -> Array:
    """Quaternions with largest entry 1, so that squares of tiny ones keep their digits.

    NaN where the squared length overflows: such a state is INVALID everywhere.
    """
    size = np.max(np.abs(q), axis=1, keepdims=True)
    squared = np.sum(q * q, axis=1, keepdims=True)
    return q / np.where(np.isfinite(squared), size, np.float64(np.nan))


def _unit(q: Array) -> Array:
    q = _scaled(q)
    unit: Array = q / np.linalg.norm(q, axis=1, keepdims=True)
    return unit


@OPERATIONS()
def quaternion_of_rotation(a: Array) -> Array:
    """The quaternion of the rotation matrix a; INVALID if that is none, to `ORTHONORMAL`."""
    x, y, z = a[:, 0, 0], a[:, 1, 1], a[:, 2, 2]
    s = a[:, 2, 1] + a[:, 1, 2], a[:, 0, 2] + a[:, 2, 0], a[:, 1, 0] + a[:, 0, 1]
    d = a[:, 2, 1] - a[:, 1, 2], a[:, 0, 2] - a[:, 2, 0], a[:, 1, 0] - a[:, 0, 1]
    candidates = np.array(  # each is four times the quaternion times one of its entries
        [
            (1 + x - y - z, s[2], s[1], d[0]),
            (s[2], 1 - x + y - z, s[0], d[1]),
            (s[1], s[0], 1 - x - y + z, d[2]),
            (d[0], d[1], d[2], 1 + x + y + z),
        ]
    )
    best = np.argmax(np.linalg.norm(candidates, axis=1), axis=0)
    q = candidates[best, :, np.arange(len(a))]
    return np.where(_are_rotations(a)[:, None], _unit(q), np.float64(np.nan))


@OPERATIONS()
def angle_of_rotation(a: Array) -> Array:
    """The angle of the rotation a of the plane; INVALID if that is none, to `ORTHONORMAL`."""
    angle = np.arctan2(a[:, 1, 0], a[:, 0, 0])
    return np.where(_are_rotations(a), angle, np.float64(np.nan))[:, None]


def _are_rotations(a: Array) -> NDArray[np.bool_]:
    blank = blanked(a, ~finite(a))
    error = np.abs(blank @ np.swapaxes(blank, -1, -2) - np.eye(a.shape[-1])).max(axis=(1, 2))
    return np.asarray((error <= ORTHONORMAL) & (np.linalg.det(blank) > 0.0), dtype=np.bool_)


@OPERATIONS()
def rotation_of_angle(a: Array) -> Array:
    """The rotation matrix of the angle a in the plane."""
    c, s = np.cos(a[:, 0]), np.sin(a[:, 0])
    return np.moveaxis(np.array(((c, -s), (s, c))), -1, 0)


@OPERATIONS()
def quaternion_of_rpy(a: Array) -> Array:
    """The quaternion of roll, pitch, yaw about the fixed axes x, y, z."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(0.5 * a).T, np.sin(0.5 * a).T
    rows = (
        sx * cy * cz - cx * sy * sz,
        cx * sy * cz + sx * cy * sz,
        cx * cy * sz - sx * sy * cz,
        cx * cy * cz + sx * sy * sz,
    )
    return np.array(rows).T


@OPERATIONS()
def quaternion_rate(a: Array, b: Array) -> Array:
    """The rate of the quaternion a at the angular velocity b."""
    vector = 0.5 * (a[:, 3:] * b + np.cross(b, a[:, :3]))
    scalar = -0.5 * np.sum(a[:, :3] * b, axis=1, keepdims=True)
    return np.concatenate((vector, scalar), axis=1)


@OPERATIONS()
def turn_quaternion(a: Array, b: Array) -> Array:
    """Exp([b]) turned onto the quaternion a: by the rotation vector b."""
    angle = np.linalg.norm(b, axis=1, keepdims=True)
    v, c = b * (0.5 * np.sinc(angle / (2.0 * np.pi))), np.cos(0.5 * angle)
    q = _unit(a)
    vector = c * q[:, :3] + q[:, 3:] * v + np.cross(v, q[:, :3])
    scalar = c * q[:, 3:] - np.sum(v * q[:, :3], axis=1, keepdims=True)
    return np.concatenate((vector, scalar), axis=1)


@OPERATIONS()
def turn_between(a: Array, b: Array) -> Array:
    """The shortest rotation vector that turns the quaternion a to b; of half turns one of two."""
    p, q = _unit(a), _unit(b)
    vector = p[:, 3:] * q[:, :3] - q[:, 3:] * p[:, :3] - np.cross(q[:, :3], p[:, :3])
    scalar = np.sum(p * q, axis=1, keepdims=True)
    size = np.linalg.norm(vector, axis=1, keepdims=True)
    half = np.arctan2(size, np.abs(scalar))
    # Half an angle over its sine: 1 where that is 0.
    factor = 2.0 * np.where(size > 0.0, half / np.where(size > 0.0, size, 1.0), 1.0)
    return vector * np.where(scalar < 0.0, -factor, factor)
