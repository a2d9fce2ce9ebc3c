"""Linear equations as the generated code solves them: scaled rows, pivots, a threshold."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PIVOT = 1.8e-12
"""A pivot below this fraction of its row counts as zero: epsilon^(3/4)."""


def least_pivot(a: Array) -> Array:
    """Smallest pivot of matrices (..., n, n) with rows scaled to one; NaN where there is none.

    The system is singular unless it is above `PIVOT`.
    """
    return _eliminated(a, np.zeros(a.shape[:-1]))[1]


def solve(a: Array, b: Array) -> Array:
    """Solve a x = b, a (..., n, n), b (..., n); NaN where a pivot counts as zero."""
    return _eliminated(a, b)[0]


def _eliminated(a: Array, b: Array) -> tuple[Array, Array]:
    """Solutions, and smallest pivots."""
    lead, n = np.broadcast_shapes(a.shape[:-2], b.shape[:-1]), b.shape[-1]
    a = np.broadcast_to(a, (*lead, n, n)).reshape(-1, n, n)
    b = np.broadcast_to(b, (*lead, n)).reshape(-1, n)
    which = np.arange(len(b))
    with np.errstate(all="ignore"):
        rows = np.concatenate((a, b[:, :, None]), axis=2)
        rows = rows / np.max(np.abs(a), axis=2, keepdims=True, initial=0.0)
        least = np.full(len(b), np.inf)
        for k in range(n):
            best = k + np.argmax(np.abs(rows[:, k:, k]), axis=1)
            rows[which, k], rows[which, best] = rows[which, best], rows[which, k].copy()
            least = np.minimum(least, np.abs(rows[:, k, k]))
            factor = rows[:, k + 1 :, k] / rows[:, k, k, None]
            rows[:, k + 1 :] -= factor[:, :, None] * rows[:, k, None]
        x = np.zeros((len(b), n))
        for k in reversed(range(n)):
            known = np.sum(rows[:, k, k + 1 : n] * x[:, k + 1 :], axis=1)
            x[:, k] = (rows[:, k, n] - known) / rows[:, k, k]
        x[~(least > PIVOT) | ~np.isfinite(x).all(axis=1)] = np.nan
    return x.reshape(*lead, n), least.reshape(lead)
