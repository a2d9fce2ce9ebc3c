"""Small helpers on tuples, of rotations mostly; no dependence on the specification format."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from pne_sym.model.manipulator import Matrix3, Vector3


def rotation_from_rpy(rpy: Vector3, *, degrees: bool = False) -> Matrix3:
    """Roll, pitch, yaw about the fixed axes x, y, z: Rz(yaw) Ry(pitch) Rx(roll).

    Args:
        rpy: angles, rad (or degrees).
        degrees: the angles are degrees; quarter turns are then exact.
    """
    (cr, sr), (cp, sp), (cy, sy) = (_cos_sin(angle, degrees) for angle in rpy)
    return (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )


def is_rotation(matrix: Matrix3, tolerance: float) -> bool:
    """Whether rows are orthonormal to the tolerance and the determinant is positive."""
    a = np.array(matrix)
    return bool(np.abs(a @ a.T - np.eye(3)).max() <= tolerance and np.linalg.det(a) > 0.0)


def orthonormalised(matrix: Matrix3) -> Matrix3:
    """The rotation nearest to a matrix that is one up to rounding (polar factor)."""
    u, _, vt = np.linalg.svd(np.array(matrix))
    return matrix3(u @ vt)


def vector3(values: Iterable[float]) -> Vector3:
    """Three numbers as a vector."""
    x, y, z = map(float, values)
    return x, y, z


def matrix3(rows: Iterable[Iterable[float]]) -> Matrix3:
    """Three rows of three numbers as a matrix."""
    x, y, z = map(vector3, rows)
    return x, y, z


def _cos_sin(angle: float, degrees: bool) -> tuple[float, float]:
    if not degrees:
        return math.cos(angle), math.sin(angle)
    quarters, rest = divmod(angle, 90.0)
    if rest == 0.0:
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarters) % 4]
    return math.cos(math.radians(angle)), math.sin(math.radians(angle))
