"""Newton's iteration on the loop closure of legs without a closed form."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pne_sym.program.evaluate import Array, Flags, evaluate
from pne_sym.program.ir import Closure, Program
from pne_sym.program.linear import solve

STEPS = 60
"""So many steps at most."""
LONGEST = 0.5
"""Largest entry of a step [m, rad]: longer ones are shortened, for all legs of the type alike."""
STEADY = 1e-11
"""A step [m, rad] below which the displacements have converged."""


def close_loops(
    program: Program, prepared: Mapping[str, Array], X: Array, q0: Array
) -> tuple[Array, Flags]:
    """Displacements that close the loops at X (states, NQ), from the guess q0 (states, NJ).

    Returns:
        q (states, NJ), revolute ones in (-pi, pi], and where the iteration has converged on the
        assembly branch of home.
        Displacements with a closed form are those of the guess.
    """
    q = np.array(np.broadcast_to(q0, (len(X), q0.shape[-1])), dtype=float)
    for joint, place in program.given:
        q[:, joint] = X[:, place]
    converged = np.isfinite(X).all(axis=1) & np.isfinite(q).all(axis=1)
    for closure in program.closures:
        converged &= _close_legs(program, closure, prepared, X, q)
        turning = list(closure.turning)
        with np.errstate(all="ignore"):
            q[:, turning] = np.pi - np.remainder(np.pi - q[:, turning], 2.0 * np.pi)
    return q, converged


def _close_legs(
    program: Program, closure: Closure, prepared: Mapping[str, Array], X: Array, q: Array
) -> Flags:
    """Close the legs of a type; q is changed.  Which states have converged."""
    joints = np.array(closure.joints)
    converged = np.zeros(len(X), dtype=bool)
    open_ = np.flatnonzero(np.isfinite(X).all(axis=1) & np.isfinite(q).all(axis=1))
    for _ in range(STEPS):
        residual, jacobian = residual_and_jacobian(program, closure, prepared, X[open_], q[open_])
        step = newton_step(jacobian, residual)
        largest: Array = np.max(np.abs(step), axis=(1, 2), initial=0.0)
        with np.errstate(all="ignore"):
            shortened: Array = np.minimum(1.0, LONGEST / largest)
        step *= shortened[:, None, None]
        q[open_[:, None, None], joints] += step
        steady = largest <= STEADY
        converged[open_[steady]] = on_home_s_branch(closure, jacobian[steady])
        open_ = open_[largest > STEADY]
        if not open_.size:
            break
    return converged


def residual_and_jacobian(
    program: Program, closure: Closure, prepared: Mapping[str, Array], X: Array, q: Array
) -> tuple[Array, Array]:
    """Gaps (states, legs, conditions) and Jacobians (states, legs, conditions, unknowns)."""
    name = closure.leg_type
    found = evaluate(program, closure.function, prepared, {"X": X, "q": q}).outputs
    jacobian = found[f"jacobian_{name}"].reshape(*found[f"residual_{name}"].shape, closure.unknowns)
    return found[f"residual_{name}"], jacobian


def on_home_s_branch(closure: Closure, jacobian: Array) -> Flags:
    """Whether all legs are on the side of their singular states on which they are at home.

    Always so where no sign tells.
    """
    if not closure.rows:
        return np.ones(len(jacobian), dtype=bool)
    signs, _ = np.linalg.slogdet(jacobian[:, :, list(closure.rows)])
    return np.asarray((signs * np.array(closure.signs) > 0.0).all(axis=1))


def newton_step(jacobian: Array, residual: Array) -> Array:
    """Solution of jacobian step = residual per leg, least squares if there are fewer unknowns."""
    if jacobian.shape[-1] == jacobian.shape[-2]:
        return solve(jacobian, residual)
    known: Flags = np.asarray(np.isfinite(jacobian).all(axis=(-1, -2)))
    inverse = np.linalg.pinv(np.where(known[..., None, None], jacobian, 0.0))
    step = np.where(known[..., None, None], inverse, np.nan) @ residual[..., None]
    return np.asarray(step[..., 0])
