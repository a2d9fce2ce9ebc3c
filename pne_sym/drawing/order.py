"""The order of painting: what is nearer to the eye covers what is farther.

Two solids are compared only where their outlines overlap, at the middle of the overlap.  Depths are
whole numbers of grains, so that rounding, which differs between processors, orders nothing.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pne_sym.drawing.solids import Solid
from pne_sym.drawing.view import View
from pne_sym.model.kinematics import Array

_GRAIN = 1e-9  # of the largest coordinate in a picture


def painted(solids: Sequence[Solid], view: View) -> list[Solid]:
    """The solids, farthest first; where that is a circle, by the depth of their middles."""
    sizes = (float(abs(solid.outline).max()) for solid in solids)
    grain = _GRAIN * max(sizes, default=1.0)

    def depth(solid: Solid, place: Array) -> int:
        return round(float(solid.depth(view, place)) / grain)

    behind: list[set[int]] = [set() for _ in solids]
    for i, one in enumerate(solids):
        for j in range(i):
            place = overlap(one.outline, solids[j].outline)
            if place is None:
                continue
            if depth(one, place) >= depth(solids[j], place):
                behind[i].add(j)
            else:
                behind[j].add(i)
    middle = [depth(solid, solid.outline.mean(axis=0)) for solid in solids]
    left = sorted(range(len(solids)), key=lambda k: (middle[k], k))
    order: list[Solid] = []
    done: set[int] = set()
    while left:
        chosen = next((k for k in left if behind[k] <= done), left[0])
        left.remove(chosen)
        done.add(chosen)
        order.append(solids[chosen])
    return order


def overlap(one: Array, other: Array) -> Array | None:
    """The middle of what two convex outlines (counter-clockwise) share; None if nothing."""
    if (one.max(axis=0) <= other.min(axis=0)).any() or (other.max(axis=0) <= one.min(axis=0)).any():
        return None
    piece = one
    for a, b in zip(other, np.roll(other, -1, axis=0), strict=True):
        piece = _clipped(piece, a, b)
        if len(piece) < 3:
            return None
    middle: Array = piece.mean(axis=0)
    return middle


def _clipped(piece: Array, a: Array, b: Array) -> Array:
    """The part of a polygon to the left of a line (Sutherland and Hodgman)."""
    edge = b - a
    sides = edge[0] * (piece[:, 1] - a[1]) - edge[1] * (piece[:, 0] - a[0])
    if (sides >= 0.0).all():
        return piece
    kept: list[Array] = []
    for k in range(len(piece)):
        s, t = sides[k - 1], sides[k]
        if (s > 0.0) != (t > 0.0):
            kept.append(piece[k - 1] + (s / (s - t)) * (piece[k] - piece[k - 1]))
        if t > 0.0:
            kept.append(piece[k])
    return np.array(kept)
