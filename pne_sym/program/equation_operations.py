"""Operations: linear equations, and what lies within bounds."""

from __future__ import annotations

import numpy as np

from pne_sym.program import distribution, linear
from pne_sym.program.evaluate import Array, Status
from pne_sym.program.operation import Operations, blanked, finite

OPERATIONS = Operations()


@OPERATIONS(Status.SINGULAR)
def solve(a: Array, b: Array) -> Array:
    """x with a x = b: rows scaled, the largest pivot; SINGULAR where a pivot is below PIVOT."""
    return linear.solve(a, b)


@OPERATIONS()
def saddle(a: Array, b: Array) -> Array:
    """The matrix [[a, -b], [b^T, 0]]."""
    states, n, m = b.shape
    result = np.zeros((states, n + m, n + m))
    result[:, :n, :n], result[:, :n, n:] = a, -b
    result[:, n:, :n] = np.swapaxes(b, -1, -2)
    return result


@OPERATIONS(Status.SINGULAR)
def least_norm(a: Array, b: Array) -> Array:
    """The least x with a x = b, rows of a independent.

    SINGULAR where the least singular value of a, rows scaled to one, is below PIVOT of the largest.
    """
    bad = ~(finite(a) & finite(b))
    a = blanked(a, bad)
    size = np.max(np.abs(a), axis=-1, keepdims=True, initial=0.0)
    size = np.where(size > 0.0, size, 1.0)
    u, s, vt = np.linalg.svd(a / size, full_matrices=False)
    y = (np.swapaxes(u, -1, -2) @ (b / size[..., 0])[..., None]) / s[..., None]
    x: Array = (np.swapaxes(vt, -1, -2) @ y)[..., 0]
    x[bad | ~(s[:, -1] > linear.PIVOT * s[:, 0])] = np.nan
    return x


@OPERATIONS(Status.SINGULAR)
def resolve(a: Array, b: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """Combinations of rows of a: n that resolve it, and the others, which vanish on it.

    The rows of b, of which a is a part, are scaled to one, and those of a with them: a row of
    equations keeps its weight where few of its entries are in a.  SINGULAR where the rank of a is
    then less than n.  A row of nothing but rounding, beside the largest, counts as zero: scaled to
    one it would be a direction.
    """
    rank = numbers[0]
    bad = ~(finite(a) & finite(b))
    a, b = blanked(a, bad), blanked(b, bad)
    size = np.max(np.abs(b), axis=-1, keepdims=True, initial=0.0)
    most = np.max(size, axis=-2, keepdims=True)
    size = np.where(size > linear.PIVOT * most, size, np.where(most > 0.0, most, 1.0))
    u, s, _ = np.linalg.svd(a / size)
    rows = np.swapaxes(u / size, -1, -2)
    rows[bad | ~(s[:, rank - 1] > linear.PIVOT * s[:, 0])] = np.nan
    return rows[:, :rank], rows[:, rank:]


@OPERATIONS()
def singular_values(a: Array) -> Array:
    """The singular values of a, in descending order."""
    bad = ~finite(a)
    values = np.linalg.svd(blanked(a, bad), compute_uv=False)
    return np.where(bad[:, None], np.float64(np.nan), values)


@OPERATIONS()
def null_basis(a: Array, *, numbers: tuple[int, ...]) -> Array:
    """Orthonormal columns x with a x = 0, for a of rank n."""
    bad = ~finite(a)
    _, _, vt = np.linalg.svd(blanked(a, bad))
    basis = np.array(np.swapaxes(vt[:, numbers[0] :], -1, -2))
    basis[bad] = np.nan
    return basis


# ---- bounds ----


@OPERATIONS(Status.UNREACHABLE)
def nearest_within(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Of the a + b y, y any, with entries from c to d the one nearest to a; UNREACHABLE if none.

    What is nearest is told by b, the products of the normals of the bounds.
    """
    found = np.full_like(a, np.nan)
    for k in np.flatnonzero(finite(a) & finite(b) & finite(c) & finite(d)):
        start = np.column_stack((a[k], np.zeros(a.shape[1])))
        nearest = distribution.nearest(start, b[k], c[k], d[k])
        found[k] = np.nan if nearest is None else nearest[:, 0]
    return found


@OPERATIONS(Status.UNREACHABLE, unbounded=True)
def factors_within(a: Array, b: Array, c: Array) -> tuple[Array, ...]:
    """The least and the largest s >= 0 with |a + s b| <= c entry by entry; UNREACHABLE if none."""
    ends = np.stack(((-c - a) / b, (c - a) / b))
    never = np.where(np.abs(a) <= c, -np.inf, np.inf)
    least = np.max(np.where(b == 0.0, never, np.min(ends, axis=0)), axis=1, initial=0.0)
    largest = np.min(np.where(b == 0.0, np.inf, np.max(ends, axis=0)), axis=1)
    some = finite(a) & finite(b) & finite(c) & (least <= largest) & (least < np.inf)
    return np.where(some, least, np.nan), np.where(some, largest, np.nan)


@OPERATIONS(Status.UNREACHABLE, unbounded=True)
def factors_of_some(a: Array, b: Array, c: Array, d: Array) -> tuple[Array, ...]:
    """The least and the largest s >= 0 with |a + s b + c y| <= d, y any; UNREACHABLE if none."""
    found = np.full((len(a), 2), np.nan)
    for k in np.flatnonzero(finite(a) & finite(b) & finite(c) & finite(d)):
        between = distribution.factors(a[k], b[k], c[k], d[k])
        found[k] = np.nan if between is None else between
    return found[:, 0], found[:, 1]
