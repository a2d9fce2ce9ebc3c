"""Loop closure at a pose, for the home of a specification only.

The generated code has its own inverse kinematics; this numerical one serves
to check and to polish the home that an author wrote.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from pne_sym.model.kinematics import Array, Pose, base_of, chain_pose, skew
from pne_sym.model.manipulator import Leg

Residual = Callable[[Array], Array]
Step = Callable[[Array], Array]
Move = Callable[[Array, Array], Array]
Flags = npt.NDArray[np.bool_]

CLOSED = 1e-12
"""Residual to which a home is polished, relative to the size where that exceeds 1 m."""
MAX_ITERATIONS = 30
_HALVINGS = 8
_LARGEST_STEP = 0.3
_SINGULAR = 1e-9


def leg_residual(leg: Leg, q: Array, pose: Pose) -> tuple[Array, Array, Array]:
    """How far a leg is from closing, its loop-closure residual, and how it changes.

    Args:
        leg: the leg.
        q: displacements (..., n) of its joints.
        pose: of the platform.

    Returns:
        the residual (..., m) (points in m, then axes), its Jacobian by q (..., m, n), and by the
        platform's twist (..., m, 6).
    """
    chain = chain_pose(leg, q, base_of(leg))
    arm = pose.R @ np.array(leg.platform_point)
    residuals = [chain.tip - pose.t - arm]
    by_q = [chain.velocities]
    by_twist = [np.hstack([-np.eye(3), skew(arm)])]
    for condition in leg.platform_joint.closures:
        a, b = chain.last @ np.array(condition.link), pose.R @ np.array(condition.platform)
        a_by_q = np.cross(chain.spins, a[..., None], axis=-2)
        b_by_twist = np.hstack([np.zeros((3, 3)), -skew(b)])
        if condition.perpendicular:
            residuals.append((a @ b)[..., None])
            by_q.append((b @ a_by_q)[..., None, :])
            by_twist.append((a @ b_by_twist)[..., None, :])
        else:
            residuals.append(a - b)
            by_q.append(a_by_q)
            by_twist.append(-b_by_twist)
    states = chain.tip.shape[:-1]
    rows = [np.broadcast_to(r, (*states, *r.shape[-2:])) for r in by_twist]
    return (
        np.concatenate(residuals, axis=-1),
        np.concatenate(by_q, axis=-2),
        np.concatenate(rows, axis=-2),
    )


def leg_closed(leg: Leg, q: Array, pose: Pose, free: Flags) -> Array:
    """Displacements that close a leg at a pose, as far as its free joints can."""

    def step(x: Array) -> Array:
        residual, by_q, _ = leg_residual(leg, x, pose)
        return least_norm(by_q * free, -residual)

    return solve(lambda x: leg_residual(leg, x, pose)[0], step, np.add, q)


def solve(residual: Residual, step: Step, move: Move, x: Array) -> Array:
    """Newton's method with bounded and halved steps; returns the best point.

    Args:
        residual: at a point.
        step: that would cancel the residual, to first order.
        move: the point reached from a point by a step.
        x: first guess.
    """
    size = _largest(residual(x))
    for _ in range(MAX_ITERATIONS):
        direction = step(x)
        direction *= min(1.0, _LARGEST_STEP / max(_largest(direction), _LARGEST_STEP))
        for _ in range(_HALVINGS):
            trial = move(x, direction)
            trial_size = _largest(residual(trial))
            if trial_size < size:
                break
            direction *= 0.5
        else:
            return x
        x, size = trial, trial_size
    return x


def least_norm(matrix: Array, vector: Array) -> Array:
    """The least-norm least-squares solution of a small linear system."""
    solution: Array = np.linalg.lstsq(matrix, vector, rcond=_SINGULAR)[0].astype(np.float64)
    return solution


def unreachable(matrix: Array) -> Array:
    """An orthonormal basis (rows) of what the columns of a matrix cannot reach."""
    u, s, _ = np.linalg.svd(matrix)
    rank = int(np.sum(s > _SINGULAR * max(1.0, _largest(s))))
    basis: Array = u[:, rank:].T
    return basis


def _largest(values: Array) -> float:
    return float(np.abs(values).max(initial=0.0))
