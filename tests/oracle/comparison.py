"""How far results are apart."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def relative_error(actual: ArrayLike, expected: ArrayLike) -> float:
    """Largest difference relative to the largest expected entry; NaN counts as infinite.

    Shapes must agree; two empty arrays do.
    """
    actual, expected = np.asarray(actual, dtype=float), np.asarray(expected, dtype=float)
    if actual.shape != expected.shape:
        raise ValueError(f"shapes differ: {actual.shape} and {expected.shape}")
    difference = float(np.abs(actual - expected).max(initial=0.0))
    scale = float(np.abs(expected).max(initial=0.0))
    if not np.isfinite(difference):
        return float("inf")
    return difference / scale if scale > 0.0 else difference
