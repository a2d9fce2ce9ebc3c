"""Vectors, rotations and inertia tensors as specifications write them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

NAMED = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def is_number(value: Any) -> bool:
    """Whether a value is a number; truth values are none."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def angle(a: Sequence[float], b: Sequence[float]) -> float:
    """Between two vectors, rad; exact for small ones too."""
    (x, y, z), (u, v, w) = a, b
    return math.atan2(
        math.hypot(y * w - z * v, z * u - x * w, x * v - y * u), x * u + y * v + z * w
    )


def negative(of: Sequence[float]) -> tuple[float, ...]:
    """The opposite vector."""
    return tuple(0.0 - x for x in of)


def vector(value: Any) -> tuple[float, ...] | None:
    """Three components: of a list of two or three, or of the name of an axis."""
    if isinstance(value, str):
        unit = NAMED.get(value.lstrip("-"))
        return (negative(unit) if value.startswith("-") else unit) if unit else None
    if not isinstance(value, Sequence) or not all(map(is_number, value)):
        return None
    found = tuple(float(x) for x in value)
    return (*found, 0.0) if len(found) == 2 else found if len(found) == 3 else None


def matrix(value: Any) -> list[tuple[float, ...]] | None:
    """Three rows; a rotation in the plane is one about z."""
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) not in (2, 3):
        return None
    rows = [vector(row) for row in value]
    found = [row for row in rows if row is not None]
    if len(found) != len(value):
        return None
    return found if len(found) == 3 else [*found, (0.0, 0.0, 1.0)]


def tensor(value: Any) -> list[tuple[float, ...]] | None:
    """An inertia tensor in one of the forms of the specification."""
    if value is None:
        return [(0.0, 0.0, 0.0)] * 3
    if is_number(value):
        return [(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, float(value))]
    if isinstance(value, Mapping):
        entry = {k: float(v) for k, v in value.items() if is_number(v)}
        names = (("ixx", "ixy", "ixz"), ("ixy", "iyy", "iyz"), ("ixz", "iyz", "izz"))
        return [tuple(entry.get(n, 0.0) for n in row) for row in names]
    diagonal = vector(value)
    if diagonal is not None:
        return [tuple(x if i == j else 0.0 for j in range(3)) for i, x in enumerate(diagonal)]
    return matrix(value)
