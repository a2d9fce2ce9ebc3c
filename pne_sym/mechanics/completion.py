"""Directions that complete a leg's degrees of freedom to a basis.

A leg with fewer degrees of freedom than its platform joint leaves to be determined restricts the
platform.  Auxiliary directions, fixed in the last link, complete its degrees of freedom to a basis,
whose reciprocal wrenches `reciprocal_wrenches` writes.  Which directions serve is settled at home,
where the basis must be well conditioned for every leg.

Some of these wrenches may do no work along any motion of the platform: a moment where the
platform cannot turn, a force through the fixed centre.  They constrain nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from enum import StrEnum
from itertools import combinations, product
from typing import Any, NamedTuple, TypeVar

import numpy as np

from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.platform_directions import moment_directions
from pne_sym.model.closure import least_norm, leg_residual
from pne_sym.model.kinematics import (
    TASK_SPACES,
    Array,
    Pose,
    at_home,
    chain_pose,
    displaced,
    pose_at,
)
from pne_sym.model.manipulator import Manipulator, Space

_PURE = 1e-6  # relative size of what counts as zero
_BETTER = 1.01  # a choice replaces an earlier one only if it is better by this factor
_SAMPLES, _REACH, _NEWTON = 4, 0.3, 12  # other poses of a leg: how many, how far, how exact
_Choice = TypeVar("_Choice", bound=tuple[Any, ...])


class Kind(StrEnum):
    """Kinds of auxiliary directions: twists that need not be degrees of freedom of the leg."""

    SLIDE = "slide"
    """Along a coordinate direction of the last link."""
    RIGHT_ANGLE = "right angle"
    """That opens one of the right angles of the platform joint, by number."""
    TURN = "turn"
    """About the fixed centre, about a coordinate direction of the last link."""


class Auxiliary(NamedTuple):
    """A direction that completes the degrees of freedom of a leg type.

    Attributes:
        kind, number: which direction.
        of_force: its reciprocal wrench has a force part at home.
        acts: that wrench does work along some motion of the platform.
    """

    kind: Kind
    number: int
    of_force: bool = True
    acts: bool = True


class _State(NamedTuple):
    """A leg and its platform in numbers.

    Attributes:
        dofs: (3 + k, m) unit columns: velocity of the connection point in the last link's
            axes by the length of the leg's lever arms, angular velocity along the k moment
            directions.
        effect: (nt, 3 + k) of wrenches at the connection point (force times that length, moment)
            on the platform's degrees of freedom.
        turns: (3 + k, 3) turns of the last link about the platform origin, as `dofs`.
    """

    dofs: Array
    effect: Array
    turns: Array

    @property
    def constraints(self) -> Array:
        """Orthonormal wrenches (3 + k, c) that do no work along the degrees of freedom."""
        u, values, _ = np.linalg.svd(self.dofs)
        return np.asarray(u[:, int(np.sum(values > _PURE)) :])


def completion_of(
    manipulator: Manipulator, g: LegGeometry, *, planar: bool
) -> tuple[Auxiliary, ...]:
    """What completes the degrees of freedom of a leg in space that lacks some."""
    dofs = sum(not g.is_extra(j) for j in range(1, g.count + 1))
    if planar or dofs == 3 + len(g.pairs):
        return ()
    return completion_at_home(manipulator, g)


def completion_at_home(manipulator: Manipulator, g: LegGeometry) -> tuple[Auxiliary, ...]:
    """The choice for which the worst conditioned leg of a type is conditioned best.

    Wrenches that act come first.  A wrench that does no work along any motion of the platform,
    such as a moment on a platform that cannot turn, is none of the constraints.
    """
    home = [next(leg_states(manipulator, g, row)) for row in range(g.leg_type.count)]
    missing = home[0].constraints.shape[1]
    transmitted = len(g.pairs)
    slides = [Auxiliary(Kind.SLIDE, k) for k in range(3)]
    angles = [Auxiliary(Kind.RIGHT_ANGLE, k) for k in range(transmitted)]
    idle = _idle(manipulator, g)
    choices: Iterable[tuple[tuple[Auxiliary, ...], tuple[Auxiliary, ...]]]
    if idle and manipulator.space is Space.SPHERICAL:
        turns = [Auxiliary(Kind.TURN, k) for k in range(3)]
        choices = product(
            combinations(turns, missing - idle), combinations([*slides, *angles], idle)
        )
    else:
        pure = max(_rank(s.constraints) - _rank(s.constraints[:3]) for s in home)
        choices = product(combinations(slides, missing - pure), combinations(angles, pure))
    wanted = ((*first, *second) for first, second in choices)
    chosen = best_conditioned(wanted, lambda choice: (_columns(s, choice) for s in home))
    return tuple(
        a._replace(of_force=_has_force(home, chosen, k), acts=k < missing - idle)
        for k, a in enumerate(chosen)
    )


def best_conditioned(
    choices: Iterable[_Choice], matrices: Callable[[_Choice], Iterable[Array]]
) -> _Choice | tuple[()]:
    """The choice whose worst matrix is conditioned best; the first of equally good ones."""
    best, chosen = 0.0, ()
    for choice in choices:
        quality = min(float(np.linalg.svd(m, compute_uv=False)[-1]) for m in matrices(choice))
        if quality > _BETTER * best:
            best, chosen = quality, choice
    return chosen


def _idle(manipulator: Manipulator, g: LegGeometry) -> int:
    """How many wrenches of the legs never do work along a motion of the platform."""
    if manipulator.space is Space.SPATIAL:
        return 0
    counts: list[int] = []
    for row in range(g.leg_type.count):
        for state in leg_states(manipulator, g, row):
            wrenches = state.constraints
            counts.append(wrenches.shape[1] - _rank(state.effect @ wrenches))
    return min(counts)


def _columns(state: _State, chosen: Sequence[Auxiliary]) -> Array:
    """Degrees of freedom and auxiliary directions (3 + k, 3 + k)."""
    units = np.eye(len(state.dofs))
    own = {
        Kind.SLIDE: units,
        Kind.RIGHT_ANGLE: units[:, 3:],
        Kind.TURN: state.turns,
    }
    columns = [own[a.kind][:, a.number] for a in chosen]
    return np.column_stack([*columns, state.dofs])


def _has_force(states: list[_State], chosen: Sequence[Auxiliary], k: int) -> bool:
    """Whether the wrench of an auxiliary direction has a force part for every leg."""
    forces = []
    for state in states:
        dual = np.linalg.inv(_columns(state, chosen))[k]
        forces.append(float(np.linalg.norm(dual[:3]) / np.linalg.norm(dual)))
    return min(forces) > _PURE


def leg_states(manipulator: Manipulator, g: LegGeometry, row: int) -> Iterator[_State]:
    """A leg at home, then at other poses that it reaches, whatever the other legs do."""
    index = g.leg_type.indices[row]
    leg, space = manipulator.legs[index], manipulator.space
    q = at_home(manipulator)[1][index]
    X = np.array(manipulator.home.X[: len(TASK_SPACES[space].pose_names)])
    rng, twist = np.random.default_rng(0), list(TASK_SPACES[space].components)
    for _ in range(_SAMPLES):
        pose = pose_at(space, list(X), manipulator.fixed_centre)
        yield _state(manipulator, g, row, q, pose)
        for newton in range(_NEWTON):
            pose = pose_at(space, list(X), manipulator.fixed_centre)
            residual, by_q, by_twist = leg_residual(leg, q, pose)
            system = np.hstack([by_twist[:, twist], by_q])
            if newton:
                step = -least_norm(system, residual)
            else:
                move = rng.uniform(-_REACH, _REACH, system.shape[1])
                step = move - least_norm(system, system @ move)
            X, q = displaced(space, X, step[: len(twist)]), q + step[len(twist) :]


def _state(manipulator: Manipulator, g: LegGeometry, row: int, q: Array, pose: Pose) -> _State:
    leg = g.leg_type.legs[row]
    free = [j for j, joint in enumerate(leg.joints) if not joint.extra]
    chain = chain_pose(leg, q)
    leg_R_platform = np.array(leg.base_frame).T @ pose.R
    tip = chain.last @ g.canonical[g.group[g.count]][row]
    arm = leg_R_platform @ np.array(leg.platform_point)
    n = moment_directions(g.leg_type, leg, chain.last, leg_R_platform)
    columns = np.vstack([tip.T @ chain.velocities / g.arm, n @ chain.spins])[:, free]
    about_origin = np.vstack([tip.T @ np.cross(tip.T, arm).T / g.arm, n @ tip])
    effect = np.vstack([np.eye(3, len(columns)), about_origin.T])
    free = [c for c in range(6) if c in TASK_SPACES[manipulator.space].components]
    return _State(columns / np.linalg.norm(columns, axis=0), effect[free], about_origin)


def _rank(rows: Array) -> int:
    return int(np.sum(np.linalg.svd(rows)[1] > _PURE)) if rows.size else 0
