"""Coordinate directions, and components that structure fixes to 0, 1 or -1."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import sympy as sp

from pne_sym.mechanics.structure import TOLERANCE
from pne_sym.model.kinematics import Array

AXES = np.eye(3)
"""Coordinate directions, by rows."""


def unit(values: Iterable[float]) -> tuple[sp.Integer, ...]:
    """Components of a coordinate direction."""
    return tuple(sp.Integer(int(v)) for v in values)


def pattern_of(values: Array) -> tuple[Any, ...]:
    """0, 1, -1 where every leg has it to the structural tolerance, else None."""
    flat = values.reshape(len(values), -1)
    pattern: list[Any] = []
    for column in flat.T:
        rounded = round(float(column[0]))
        same = np.all(np.abs(column - rounded) < TOLERANCE) and abs(rounded) <= 1
        pattern.append(sp.Integer(rounded) if same else None)
    return tuple(pattern)


def is_exact(values: Array) -> bool:
    """Whether all values are integers to the structural tolerance."""
    return bool(np.all(np.abs(values - np.rint(values)) < TOLERANCE))
