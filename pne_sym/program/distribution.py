"""Forces of redundant actuators within bounds: the nearest ones, and how far they may go.

What forces t may be is a start and all that a Gram matrix spans, t = start + gram y (y any); the
matrix holds the products of the normals of the bounds least <= t <= most.  The nearest such t is
found by the dual active-set method of Goldfarb and Idnani (Math. Programming 27, 1983), whose
iterates are the nearest points to the start under some of the bounds: they move away from it until
all hold, or until one cannot hold beside the others, so that there are no such forces.

A start at infinity, start[:, 0] + k start[:, 1] with k beyond all numbers, makes a linear program
of it: of the points farthest that way the one nearest to start[:, 0].  Numbers are pairs then, and
in comparisons the second ones count first.
"""

from __future__ import annotations

import numpy as np

from pne_sym.program.linear import PIVOT, Array

TURNS = 20
"""Steps of the search, for every bounded force: each is one bound more or one less."""


def nearest(start: Array, gram: Array, least: Array, most: Array) -> Array | None:
    """The point (n, 2) within the bounds that is nearest to the start; None if there is none.

    Args:
        start: (n, 2), finite part, and the direction in which it goes to infinity.
        gram: (n, n), of the normals.
        least: bounds (n,), infinite where there is none.
        most: likewise.
    """
    coefficients, side = np.zeros_like(start), np.zeros(len(start))
    new: tuple[int, float] | None = None
    for _ in range(TURNS * len(start)):
        t = start + gram @ coefficients
        new = new or _violated(start, t, (least, most), side)
        if new is None:
            return _settled(start, gram, (least, most), side)
        p, sign = new
        kept = np.flatnonzero(side)
        without = np.zeros(len(side))
        without[kept] = np.linalg.solve(gram[np.ix_(kept, kept)], sign * gram[kept, p])
        free = float(gram[p, p] - sign * gram[p] @ without)
        clear = PIVOT * (1.0 + float(without @ without))  # above what rounding makes of zero
        excess = sign * (np.array([least[p] if sign > 0.0 else most[p], 0.0]) - t[p])
        blocking = [int(k) for k in kept if side[k] * without[k] > clear]
        steps = [(*(coefficients[k, ::-1] / without[k]).tolist(), k) for k in blocking]
        if free > clear:
            steps.append((*(excess[::-1] / free).tolist(), -1))
        if not steps:
            return None
        second, first, leaving = min(steps)
        coefficients -= np.outer(without, (first, second))
        coefficients[p] += sign * np.array((first, second))
        if leaving < 0:
            side[p], new = sign, None
        else:
            side[leaving] = coefficients[leaving] = 0.0
    return None


def _violated(
    start: Array, t: Array, bounds: tuple[Array, Array], side: Array
) -> tuple[int, float] | None:
    """The bound that is violated by most, and 1 for a lower, -1 for an upper one."""
    size, endless = np.max(np.abs(start), axis=0)
    found = []
    for sign, bound in zip((1.0, -1.0), bounds, strict=True):
        for k in np.flatnonzero(np.isfinite(bound) & (side == 0.0)):
            first, second = sign * (bound[k] - t[k, 0]), -sign * t[k, 1]
            second = second if abs(second) > PIVOT * endless else 0.0
            if second > 0.0 or (second == 0.0 and first > PIVOT * (size + abs(bound[k]))):
                found.append(((second, first), -k, int(k), sign))
    return max(found)[2:] if found else None


def _settled(start: Array, gram: Array, bounds: tuple[Array, Array], side: Array) -> Array:
    """The point nearest to the start at the bounds on these sides."""
    kept = np.flatnonzero(side)
    bound = np.where(side > 0.0, *bounds)[kept]
    right = np.column_stack((bound, np.zeros(len(kept)))) - start[kept]
    t = start + gram[:, kept] @ np.linalg.solve(gram[np.ix_(kept, kept)], right)
    t[kept, 0] = bound
    t[:, 0] = np.clip(t[:, 0], *bounds)
    return t


def factors(start: Array, way: Array, gram: Array, limit: Array) -> tuple[float, float] | None:
    """The least and the largest s >= 0 with |start + s way + gram y| <= limit for some y.

    The largest may be infinite; None where there is no s.
    """
    size = float(np.max(np.abs(way))) or 1.0
    normals = np.append(way / size, 1.0)
    spanned = np.outer(normals, normals)
    spanned[:-1, :-1] += gram
    least, most = np.append(-limit, 0.0), np.append(limit, np.inf)
    begin = np.append(start, 0.0)
    found = []
    for towards in (-1.0, 1.0):
        t = nearest(np.column_stack((begin, towards * normals)), spanned, least, most)
        if t is None:
            return None
        found.append(np.inf if t[-1, 1] > PIVOT else t[-1, 0] / size)
    return found[0], found[1]
