"""Values of a derivation at their places in the arrays that the code returns."""

from __future__ import annotations

from typing import Any

import numpy as np

from pne_sym.derivation import Derivation, Output
from pne_sym.review.evaluation import State


def by_array(derivation: Derivation) -> dict[str, list[Output]]:
    """The outputs that make up each array."""
    found: dict[str, list[Output]] = {}
    for output in derivation.outputs:
        found.setdefault(output.array, []).append(output)
    return found


def assembled(state: State, outputs: list[Output]) -> dict[tuple[int, int], float]:
    """Entries of an array by row and column."""
    entries: dict[tuple[int, int], float] = {}
    for o in outputs:
        along_row = o.rows == ((0, 0),) and o.columns not in ((), ((0, 0),))
        legs = state.structure.legs[o.leg_type] if o.leg_type else (None,)
        for k, leg in enumerate(legs):
            value = np.asarray(state.of(o.value, leg), dtype=float)
            if o.frame != "base" and value.ndim:
                turned = state.rotation(o.frame, leg)
                value = turned.T @ value if value.ndim == 1 else turned.T @ value @ turned
            r0 = o.leg_rows[k] if o.leg_rows else 0
            c0 = o.leg_columns[k] if o.leg_columns else 0
            for i, row in o.rows:
                for j, column in o.columns or ((0, 0),):
                    place = (row + r0, column + c0)
                    entries[place] = _entry(value, i, j, along_row=along_row)
                    if o.mirrored:
                        entries[place[::-1]] = entries[place]
    return entries


def _entry(value: Any, i: int, j: int, *, along_row: bool) -> float:
    if value.ndim == 0:
        return float(value)
    return float(value[i, j] if value.ndim == 2 else value[j if along_row else i])
