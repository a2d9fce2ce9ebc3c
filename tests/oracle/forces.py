"""Forces for an acceleration, and accelerations that have forces: by numeric rank, state by state.

K = [H Hk] with NV rows; rows of passive extra coordinates may stay open, all others hold.
"""

from __future__ import annotations

import numpy as np

from tests.oracle.closure import OracleError
from tests.oracle.jets import Array

RANK_TOLERANCE = 1e-9
"""Singular values below this fraction of the largest count as zero."""


def rank(matrix: Array) -> int:
    """Rank, with rows scaled: they may have different units."""
    if not matrix.size:
        return 0
    values = np.linalg.svd(_scaled(matrix)[0], compute_uv=False)
    return int((values > RANK_TOLERANCE * max(values.max(), 1e-300)).sum())


def idle_rows(K: Array) -> Array:
    """(i, NV): combinations of rows on which neither actuators nor constraints act."""
    scaled, size = _scaled(K)
    left, _, _ = np.linalg.svd(scaled)
    return np.asarray((left[:, rank(K) :] / size[:, None]).T)


def _scaled(matrix: Array) -> tuple[Array, Array]:
    size = np.abs(matrix).max(axis=1)
    size = np.where(size > RANK_TOLERANCE * size.max(initial=0.0), size, 1.0)
    return matrix / size[:, None], size


def are_held(K: Array, passive: list[int]) -> bool:
    """Whether the rows other than the passive ones are independent."""
    others = [row for row in range(len(K)) if row not in passive]
    return rank(K[others]) == len(others)


def forces(H: Array, Hk: Array, demand: Array, passive: list[int]) -> tuple[Array, Array]:
    """tau of least norm and lambda: passive rows in least squares, all others exact."""
    idle = idle_rows(np.hstack([H, Hk]))
    demand = demand.copy()
    demand[passive] -= np.linalg.pinv(idle[:, passive]) @ (idle @ demand)
    # Lambda costs nothing: tau is fixed by the directions that constraints leave free.
    left, values, _ = np.linalg.svd(Hk)
    free = left[:, int((values > RANK_TOLERANCE * values.max(initial=1e-300)).sum()) :]
    tau = np.linalg.pinv(free.T @ H, rcond=RANK_TOLERANCE) @ (free.T @ demand)
    lam = np.linalg.pinv(Hk, rcond=RANK_TOLERANCE) @ (demand - H @ tau)
    return tau, lam


def completion(M: Array, demand: Array, K: Array, passive: list[int]) -> Array:
    """The least change (metric of M) of passive entries of A that brings the demand to K's range.

    Raises:
        OracleError: no change does.
    """
    idle = idle_rows(K)
    if not len(idle):
        return np.zeros(len(passive))
    effect = idle @ M[:, passive]
    if not are_held(K, passive) or rank(effect) < len(idle):
        raise OracleError("the actuators leave the passive extra coordinates undetermined")
    factor = np.linalg.cholesky(M[np.ix_(passive, passive)])
    change = -np.linalg.pinv(effect @ np.linalg.inv(factor.T)) @ (idle @ demand)
    return np.asarray(np.linalg.solve(factor.T, change))
