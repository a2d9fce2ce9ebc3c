"""How motors are coupled to the actuated joints: a matrix that has an inverse."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pne_sym.model.entry import Entry
from pne_sym.model.manipulator import Leg
from pne_sym.model.values import numbers

Rows = tuple[tuple[float, ...], ...]

LEAST = 1e-6
"""A matrix with columns of largest entry one has no inverse if a pivot is smaller."""


def read_coupling(entry: Entry | None, legs: Sequence[Leg]) -> Rows | None:
    """The matrix by rows, or None where it is left out.

    Raises:
        SpecError: not a row of numbers per actuated joint and a number per actuated joint in it, or
            a matrix without inverse.
    """
    if entry is None or entry.value is False:
        return None
    count = sum(joint.actuated for leg in legs for joint in leg.joints)
    if not count:
        raise entry.fault("no such field: no joint is actuated")
    which = f" of {count} numbers, one for each actuated joint, in the order of tau"
    rows = entry.counted(count, "rows", which)
    found = tuple(numbers(row, count, f"{count} rows{which}") for row in rows)
    if not is_invertible(found):
        raise entry.fault(
            "a matrix with an inverse: of independent motors", "the matrix is singular"
        )
    return found


def is_invertible(rows: Rows) -> bool:
    """Whether the matrix has an inverse, whatever the units of the displacements.

    >>> is_invertible(((1.0, 0.0), (1.0, 1e9))), is_invertible(((1.0, 2.0), (2.0, 4.0)))
    (True, False)
    """
    matrix = np.array(rows, dtype=float)
    sizes = np.max(np.abs(matrix), axis=0)
    left = matrix / np.where(sizes > 0.0, sizes, 1.0)
    while left.size:
        at = int(np.argmax(np.abs(left[:, 0])))
        if not abs(left[at, 0]) >= LEAST:
            return False
        pivot, others = left[at], np.delete(left, at, axis=0)
        left = (others - np.outer(others[:, 0] / pivot[0], pivot))[:, 1:]
    return True
