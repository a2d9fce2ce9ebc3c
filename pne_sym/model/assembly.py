"""All closures of a leg at a pose of the platform: from these a home without q is made.

A damped Newton's method runs from many first guesses at once, spread evenly over all angles and
over ways of the leg's size.  The guesses are always the same ones.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from pne_sym.model.closure import leg_closed, leg_residual
from pne_sym.model.kinematics import Array, Pose, base_of, chain_pose, pose_at
from pne_sym.model.limits import margin
from pne_sym.model.loops import Loops
from pne_sym.model.manipulator import Leg

GUESSES = 48
"""First guesses for each degree of freedom of a leg, up to `_MOST`."""
_MOST = 256
_MOST_SOLUTIONS = 32
_ROUNDS = 40
_NEAR = 1e-6
_LONGEST_STEP = 0.7
_SAME = 1e-4


def closures(leg: Leg, pose: Pose, given: Array, middle: Array) -> list[Array]:
    """Displacements that close a leg at a pose: every solution, the usual one first.

    That is within limits, has its slides out, its elbows outwards, and turns its joints least.
    Of a leg that cannot be closed, displacements that leave the least residual.

    Args:
        leg: the leg.
        pose: of the platform, in the base frame.
        given: displacements (n,), of which those of extra degrees of freedom hold.
        middle: from where outwards counts, base frame, m.
    """
    free = np.array([not joint.extra for joint in leg.joints])
    size = _size(leg, pose)
    near: list[Array] = []
    for q in _iterated(leg, pose, _guesses(leg, given, free, size), free, size):
        if len(near) < _MOST_SOLUTIONS and all(distance(leg, q, other) > _SAME for other in near):
            near.append(q)
    found = [leg_closed(leg, q, pose, free) for q in near]
    return sorted(found, key=lambda q: _unusual(leg, middle, q, size))


def all_closures(loops: Loops, X: Array) -> list[list[Array]]:
    """The closures of every leg at a pose, the usual ones first."""
    pose = pose_at(loops.space, X.tolist(), loops.centre)
    given = np.zeros(len(loops.joints))
    given[loops.extra] = X[loops.size :]
    pairs = zip(loops.legs, loops.slices(), strict=True)
    middle = middle_of(loops.legs, pose)
    return [closures(leg, pose, given[s], middle) for leg, s in pairs]


def middle_of(legs: Sequence[Leg], pose: Pose) -> Array:
    """Midway between the platform and the mean of the base points, m."""
    base: Array = np.mean([leg.base_point for leg in legs], axis=0)
    return 0.5 * (base + pose.t)


def distance(leg: Leg, q: Array, other: Array) -> float:
    """How far apart two solutions are: full turns of hinges do not count."""
    turns = [joint.kind.is_hinge and not joint.extra for joint in leg.joints]
    off = q - other
    return float(np.abs(np.where(turns, np.remainder(off + np.pi, math.tau) - np.pi, off)).max())


def _unusual(leg: Leg, middle: Array, q: Array, size: float) -> tuple[float, ...]:
    """What sorts solutions, in this order; then displacements themselves."""
    beyond = sum(margin(joint, x) < 0.0 for joint, x in zip(leg.joints, q, strict=True))
    back = sum(
        joint.kind.slides and x < -_SAME * size for joint, x in zip(leg.joints, q, strict=True)
    )
    hinges = np.array([joint.kind.is_hinge for joint in leg.joints])
    turned = float(np.sum(np.where(hinges, np.remainder(q + np.pi, math.tau) - np.pi, 0.0) ** 2))
    chain = chain_pose(leg, q, base_of(leg))
    outward = sum(float(np.linalg.norm(origin - middle)) for origin in chain.origins) / size
    return (beyond, back, -round(outward, 6), round(turned, 6), *(round(-x, 6) for x in q.tolist()))


def _size(leg: Leg, pose: Pose) -> float:
    """A length of the leg: its links' or the way from end to end, m."""
    reach = pose.t + pose.R @ np.array(leg.platform_point) - np.array(leg.base_point)
    size = max(float(np.linalg.norm(reach)), *(float(np.linalg.norm(link)) for link in leg.offsets))
    return size if size > 0.0 else 1.0


def _units(leg: Leg, size: float) -> Array:
    """What displacements are measured by: angles by 1 rad, ways by the leg's size."""
    ways = [size / abs(joint.advance) if joint.advance else 1.0 for joint in leg.joints]
    return np.array(ways)


def _guesses(leg: Leg, given: Array, free: Array, size: float) -> Array:
    """First guesses (k, n): an additive sequence, which fills a cube evenly."""
    n = int(free.sum())
    ratio = 2.0
    for _ in range(40):
        ratio = (1.0 + ratio) ** (1.0 / (n + 1))
    steps = ratio ** -np.arange(1.0, n + 1.0)
    cube = np.remainder(0.5 + np.outer(np.arange(min(GUESSES * n, _MOST) or 1), steps), 1.0)
    reach = np.array([math.pi if joint.kind.is_hinge else 1.5 for joint in leg.joints])
    result = np.tile(given, (len(cube), 1))
    result[:, free] = ((2.0 * cube - 1.0) * reach[free]) * _units(leg, size)[free]
    return result


def _iterated(leg: Leg, pose: Pose, q: Array, free: Array, size: float) -> Array:
    """Guesses (k, n) after damped steps, those with the smallest residuals first."""
    units = _units(leg, size)[free]
    for _ in range(_ROUNDS):
        residual, by_q = _residuals(leg, pose, q, size)
        by_q = by_q[:, :, free] * units
        normal = np.swapaxes(by_q, 1, 2) @ by_q
        largest = 1.0 + np.trace(normal, axis1=1, axis2=2)
        damping = (1e-3 * np.minimum(np.sum(residual**2, axis=1), 1.0) + 1e-13) * largest
        normal += damping[:, None, None] * np.eye(len(units))
        step = -np.linalg.solve(normal, np.swapaxes(by_q, 1, 2) @ residual[:, :, None])[:, :, 0]
        longest = np.abs(step).max(axis=1, initial=_LONGEST_STEP)[:, None]
        q[:, free] += step * (_LONGEST_STEP / longest) * units
    residual, _ = _residuals(leg, pose, q, size)
    sizes = np.abs(residual).max(axis=1)
    order = np.argsort(sizes, kind="stable")
    near = order[sizes[order] <= _NEAR] if sizes[order[0]] <= _NEAR else order[:1]
    return np.asarray(q[near])


def _residuals(leg: Leg, pose: Pose, q: Array, size: float) -> tuple[Array, Array]:
    """Residuals (k, m) at displacements (k, n), lengths over the size, and Jacobians (k, m, n)."""
    residual, by_q, _ = leg_residual(leg, q, pose)
    residual[:, :3] /= size
    by_q[:, :3] /= size
    return residual, by_q
