"""Vectors, rotations and inertia tensors as specifications write them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from pne_sym.model.kinematics import Array

NAMED = dict(zip("xyz", np.eye(3), strict=True))


def is_number(value: Any) -> bool:
    """Whether a value is a number; truth values are none."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def angle(a: Array, b: Array) -> float:
    """Between two vectors, rad; exact for small ones too."""
    return math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))


def vector(value: Any) -> Array | None:
    """Three components: of a list of two or three, or of the name of an axis."""
    if isinstance(value, str):
        unit = NAMED.get(value.lstrip("-"))
        return -unit if unit is not None and value.startswith("-") else unit
    if not isinstance(value, Sequence) or not all(map(is_number, value)):
        return None
    return np.array([*value, 0.0][:3], dtype=float) if len(value) in (2, 3) else None


def matrix(value: Any) -> Array | None:
    """Three rows; a rotation in the plane is one about z."""
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) not in (2, 3):
        return None
    rows = [found for row in value if (found := vector(row)) is not None]
    return np.array([*rows, NAMED["z"]][:3]) if len(rows) == len(value) else None


def tensor(value: Any) -> Array | None:
    """An inertia tensor in one of the forms of the specification."""
    if value is None or is_number(value):
        return np.diag([0.0, 0.0, float(value or 0.0)])
    if isinstance(value, Mapping):
        entry = {k: float(v) for k, v in value.items() if is_number(v)}
        names = (("ixx", "ixy", "ixz"), ("ixy", "iyy", "iyz"), ("ixz", "iyz", "izz"))
        return np.array([[entry.get(n, 0.0) for n in row] for row in names])
    diagonal = vector(value)
    return matrix(value) if diagonal is None else np.diag(diagonal)
