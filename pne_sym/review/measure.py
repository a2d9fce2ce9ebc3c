"""The largest relative difference of two arrays, and where."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pne_sym.review.difference import Gap

NOISE = 1e-12
"""Rounding of what was cancelled: this fraction of the terms' size counts as zero."""


def gap_between(
    before: Any, after: Any, *, floor: float = 0.0, legs: Sequence[int | None] = ()
) -> Gap | None:
    """The largest relative difference; None where there is none at all.

    Args:
        before: array; the first index runs over states (and legs, if given).
        after: likewise.
        floor: size of the terms that the values are made of.
        legs: leg of every entry of the first index.
    """
    a, b = np.asarray(before, dtype=float), np.asarray(after, dtype=float)
    if a.shape != b.shape:
        return Gap(float("inf"), f"shapes {list(a.shape[1:])} and {list(b.shape[1:])}", 0.0, 0.0)
    both = np.isfinite(a) & np.isfinite(b)
    lost = ~both & (a != b) & ~(np.isnan(a) & np.isnan(b))
    a_known, b_known = np.where(both, a, 0.0), np.where(both, b, 0.0)
    size = np.max(np.maximum(np.abs(a_known), np.abs(b_known)), initial=0.0)
    step = np.abs(a_known - b_known)
    step[step <= NOISE * floor] = 0.0
    relative = np.where(lost, np.inf, step / (size or 1.0))
    if not relative.size or not relative.max() > 0.0:
        return None
    at = np.unravel_index(int(np.argmax(relative)), relative.shape)
    where = f"[{', '.join(str(int(k)) for k in at[1:])}]" if len(at) > 1 else "the value"
    if legs and (leg := legs[int(at[0])]) is not None:
        where += f" of leg {leg + 1}"
    return Gap(float(relative[at]), where, float(a[at]), float(b[at]))
