"""Loop closure: what a platform joint demands of its two sides, and its solution.

Every residual is the leg's side minus the platform's, so that the derivative of the
position rows with respect to the platform origin is minus the identity.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pne_sym.model.manipulator import Leg, Manipulator, PlatformJointKind, Space
from tests.oracle.chain import carried_point, carried_vector, chain_poses
from tests.oracle.coordinates import (
    Pose,
    displaced,
    extra_indices,
    is_planar,
    joint_slices,
    platform_motion,
    pose_size,
    step_between,
    twist_basis,
)
from tests.oracle.jets import Array, Jet, compose, cross, cross_vector, dot, taylor

CLOSURE_TOLERANCE = 1e-13
"""Largest closure residual of a solved loop (m, or sines of angles)."""


class OracleError(Exception):
    """The state cannot be evaluated: unreachable, singular or contradictory."""


@dataclass(frozen=True)
class LegClosure:
    """One leg's closure residual (nc rows) and its derivatives.

    Attributes:
        residual: (nc,) m, then sines of angles.
        joints: (nc, m) derivatives by the leg's displacements.
        platform: (nc, 6) derivatives by the twist of the platform origin, as if the
            platform were free in space.
    """

    residual: Array
    joints: Array
    platform: Array


def perpendicular_pair(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors perpendicular to `axis` and to each other."""
    helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
    first = cross(axis, helper)
    first /= np.linalg.norm(first)
    return first, cross(axis / np.linalg.norm(axis), first)


def closure_residual(space: Space, leg: Leg, last_link: Pose, platform: Pose) -> Jet:
    """Violation (..., nc) of a leg's platform joint: metres, then sines of angles."""
    joint = leg.platform_joint
    residual = carried_point(last_link, joint.offset) - carried_point(platform, leg.platform_point)
    if is_planar(space):
        rows = [residual.component(0), residual.component(1)]
        if joint.kind is PlatformJointKind.RIGID:
            rows.append(_misalignment(leg, last_link, platform).component(2))
        return _stack(rows)
    rows = [residual.component(row) for row in range(3)]
    if joint.kind is PlatformJointKind.RIGID:
        misalignment = _misalignment(leg, last_link, platform)
        rows += [misalignment.component(row) for row in range(3)]
    elif joint.kind is not PlatformJointKind.SPHERICAL:
        rows += _axis_rows(leg, last_link, platform)
    return _stack(rows)


def _axis_rows(leg: Leg, last_link: Pose, platform: Pose) -> list[Jet]:
    joint = leg.platform_joint
    if joint.axis_link is None or joint.axis_platform is None:
        raise OracleError(f"platform joint {joint.kind} needs axis_link and axis_platform")
    platform_axis = carried_vector(platform, joint.axis_platform)
    if joint.kind is PlatformJointKind.UNIVERSAL:
        return [dot(carried_vector(last_link, joint.axis_link), platform_axis)]
    across = perpendicular_pair(np.array(joint.axis_link, dtype=float))
    return [dot(carried_vector(last_link, vector), platform_axis) for vector in across]


def _misalignment(leg: Leg, last_link: Pose, platform: Pose) -> Jet:
    """Axial vector of base_R_link rotation platform_R_base: zero where the two agree."""
    held = leg.platform_joint.rotation
    if held is None:
        raise OracleError("a rigid platform joint needs its rotation")
    held_by_link = Jet(last_link.rotation.terms @ np.array(held, dtype=float))
    transposed = platform.rotation.linear(lambda array: np.swapaxes(array, -1, -2))
    return compose(held_by_link, transposed).linear(cross_vector)


def _stack(rows: list[Jet]) -> Jet:
    return Jet(np.stack([row.terms for row in rows], axis=-1))


def leg_closure(manipulator: Manipulator, leg: Leg, X: Array, q: Array) -> LegClosure:
    """A leg's closure at pose X with displacements q (m,)."""
    m = len(leg.joints)
    moves = taylor(q, np.eye(m + 6, m), np.zeros((m + 6, m)))
    twist = np.eye(m + 6, 6, k=-m)
    platform = platform_motion(manipulator, X, twist, np.zeros_like(twist))
    last_link = chain_poses(leg, moves)[-1]
    closure = closure_residual(manipulator.space, leg, last_link, platform)
    return LegClosure(closure.value[0], closure.first[:m].T, closure.first[m:].T)


def close_legs(manipulator: Manipulator, X: Array, q: Array) -> Array:
    """Displacements (nj,) that close every leg at pose X, by Newton's method from q.

    The displacements of extra joints are taken from X.  A leg with fewer degrees of freedom than
    the space comes out with its nearest closure when X is not admissible.
    """
    result = np.array(q, dtype=float)
    extra = extra_indices(manipulator)
    result[extra] = X[pose_size(manipulator.space) :]
    for leg, where in zip(manipulator.legs, joint_slices(manipulator), strict=True):
        free = [index for index, joint in enumerate(leg.joints) if not joint.extra]
        result[where] = _close_leg(manipulator, leg, X, result[where], free)
    return result


def _close_leg(manipulator: Manipulator, leg: Leg, X: Array, q: Array, free: list[int]) -> Array:
    q, previous = q.copy(), np.inf
    for _ in range(200):
        closure = leg_closure(manipulator, leg, X, q)
        step = -np.linalg.lstsq(closure.joints[:, free], closure.residual, rcond=None)[0]
        size = float(np.abs(step).max(initial=0.0))
        # A long step would leave the branch; the continuation keeps them short.
        q[free] += step * min(1.0, 0.5 / max(size, 1e-300))
        # Near a singular leg rounding stops the steps from shrinking before the tolerance.
        if size < CLOSURE_TOLERANCE or 100 * CLOSURE_TOLERANCE > size > 0.5 * previous:
            return q
        previous = size
    raise OracleError("a leg does not close")


def closure_error(manipulator: Manipulator, X: Array, q: Array) -> float:
    """Largest closure residual over all legs (m, or sines of angles)."""
    return max(
        float(np.abs(leg_closure(manipulator, leg, X, q[where]).residual).max())
        for leg, where in zip(manipulator.legs, joint_slices(manipulator), strict=True)
    )


def follow(
    manipulator: Manipulator, X_from: Array, q_from: Array, X_to: Array, steps: int = 5
) -> Array:
    """Displacements at `X_to` on the branch of (`X_from`, `q_from`), by continuation."""
    step = step_between(manipulator, X_from, X_to)
    q = q_from
    for fraction in np.linspace(0.0, 1.0, steps + 1)[1:]:
        q = close_legs(manipulator, displaced(manipulator, X_from, fraction * step), q)
    return close_legs(manipulator, X_to, q)


def assemble(manipulator: Manipulator, X: Array, q: Array) -> tuple[Array, Array]:
    """The nearest pose and displacements that close every loop (least change of both).

    Unlike `close_legs` this moves the platform too, as platforms with fewer degrees of freedom than
    their space need.
    """
    X, q = np.array(X, dtype=float), np.array(q, dtype=float)
    extra = extra_indices(manipulator)
    q[extra] = X[pose_size(manipulator.space) :]
    basis = twist_basis(manipulator.space)
    for _ in range(50):
        residual, jacobian = _assembly_system(manipulator, X, q, basis)
        step = -np.linalg.lstsq(jacobian, residual, rcond=None)[0]
        step *= min(1.0, 0.3 / max(float(np.abs(step).max()), 1e-300))
        task = basis.shape[1]
        X = displaced(manipulator, X, np.concatenate([step[:task], step[task:][extra]]))
        q = q + step[task:]
        if np.abs(step).max() < CLOSURE_TOLERANCE:
            break
    if closure_error(manipulator, X, q) > 10 * CLOSURE_TOLERANCE:
        raise OracleError("the loops do not close")
    return X, q


def _assembly_system(
    manipulator: Manipulator, X: Array, q: Array, basis: Array
) -> tuple[Array, Array]:
    """Residuals of all legs and their derivatives by [V, q]."""
    residuals, rows = [], []
    for leg, where in zip(manipulator.legs, joint_slices(manipulator), strict=True):
        closure = leg_closure(manipulator, leg, X, q[where])
        block = np.zeros((closure.residual.size, basis.shape[1] + q.size))
        block[:, : basis.shape[1]] = closure.platform @ basis
        block[:, basis.shape[1] :][:, where] = closure.joints
        residuals.append(closure.residual)
        rows.append(block)
    return np.concatenate(residuals), np.vstack(rows)
