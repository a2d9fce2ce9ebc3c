"""Generic ranks of the force transformation, from the motions that the loops allow.

A motion that the loops allow has Hk^T V = 0, and H^T V are then the rates of its actuated joints:
what [H Hk]^T takes to zero are the motions with all actuated joints at rest.  So the rank of
[H Hk] is NV less the number of these; rows are independent where no motion that leaves all other
coordinates at rest is among them.  Nothing of this needs the equations of motion.

A rank is generic if it is the largest: it is taken over home, poses around it, and other lengths,
points and frames.  A geometry that the loops do not allow (a wrist whose axes do not meet) has more
constraints, or does not close, and is left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pne_sym.derivation import Actuation
from pne_sym.mechanics.mobility import Mobility, mobility, motions_at_home, rank_of
from pne_sym.model.closure import unreachable
from pne_sym.model.kinematics import TASK_SPACES, Array, displaced, rotation_about
from pne_sym.model.loops import Loops, all_closed
from pne_sym.model.manipulator import Home, Joint, Leg, Manipulator, Space, Vector3
from pne_sym.model.rotation import matrix3, vector3

_POSES = 2
"""Poses beside home, and with each other geometry."""
_LEAST = 0.05
"""A part of `_SHIFT` or `_TURN` that counts as a motion."""
_TURN, _SHIFT = 0.4, 0.15
"""How far a pose is from home: rad, and lengths as a fraction of the mechanism's size."""
_CHANGE = 0.12
"""By which fraction lengths are changed in other geometries."""
_CLOSED = 1e-9
"""Largest residual of closed loops, as a fraction of the mechanism's size."""
_ATTEMPTS = 4
"""Steps are halved so often until the loops close."""


class _Ranks(NamedTuple):
    """Of one geometry at one pose; see `Actuation`."""

    rank: int
    force_rank: int
    is_determined: bool
    is_coupled: bool


def actuation(manipulator: Manipulator) -> Actuation:
    """What the actuators of a manipulator determine, for almost all parameters and poses.

    The random numbers are always the same ones.  Legs must be regular at home.

    >>> from pne_sym import manipulators
    >>> found = actuation(manipulators.load("stewart_sps"))
    >>> found.rank, found.passive, found.is_coupled
    (6, (6, 7, 8, 9, 10, 11), False)
    """
    twist = len(TASK_SPACES[manipulator.space].components)
    extra = [joint for joint in manipulator.joints if joint.extra]
    passive = tuple(k for k, joint in enumerate(extra, twist) if not joint.actuated)
    size, seen = twist + len(extra), list[_Ranks]()
    actuated = sum(joint.actuated for joint in manipulator.joints)
    for sample in _samples(manipulator):
        seen.append(_ranks(sample, size))
        if seen[-1].rank == size and seen[-1].force_rank == min(size, actuated):
            break  # they cannot be larger
    return Actuation(
        rank=max(s.rank for s in seen),
        force_rank=max(s.force_rank for s in seen),
        passive=passive,
        others=tuple(k for k in range(size) if k not in passive),
        is_determined=any(s.is_determined for s in seen),
        is_coupled=any(s.is_coupled for s in seen),
    )


def _ranks(m: Manipulator, size: int) -> _Ranks:
    actuated = np.array([joint.actuated for joint in m.joints], dtype=bool)
    passive = np.array([joint.extra and not joint.actuated for joint in m.joints], dtype=bool)
    motions, twist = motions_at_home(m), len(TASK_SPACES[m.space].components)
    platform, rates = motions[:twist], motions[twist:]
    dofs, held = motions.shape[1], rank_of(rates[actuated])
    return _Ranks(
        rank=size - dofs + held,
        force_rank=held if dofs == size else _force_rank(m),
        is_determined=rank_of(rates[actuated | passive]) == dofs,
        # They move alone, the platform and what is actuated at rest.
        is_coupled=dofs - rank_of(np.vstack([platform, rates[actuated]])) < passive.sum(),
    )


def _force_rank(m: Manipulator) -> int:
    """Largest rank of H where legs restrict the platform.

    Rates of the joints of such a leg at a velocity that its constraints do not allow are a matter
    of choice: any left inverse of the leg's Jacobian will do, so one is drawn.
    """
    loops, rng = Loops.of(m), np.random.default_rng(0)
    twist, extras = len(TASK_SPACES[m.space].components), np.cumsum([0, *loops.extra])
    found = loops.closures(np.array(m.home.X), np.array(m.home.q))
    columns = []
    for leg, s, (_, by_q, by_twist) in zip(m.legs, loops.slices(), found, strict=True):
        own = ~loops.extra[s]
        rates = np.zeros((len(leg.joints), twist + int(extras[-1])))
        for j in np.flatnonzero(~own):
            rates[j, twist + extras[s.start + j]] = 1.0
        demand = by_q @ rates
        demand[:, :twist] += by_twist
        idle = unreachable(by_q[:, own])
        choice = np.linalg.pinv(by_q[:, own]) + rng.uniform(-1, 1, (own.sum(), len(idle))) @ idle
        rates[own] = -choice @ demand
        columns.append(rates[[joint.actuated for joint in leg.joints]])
    return rank_of(np.vstack(columns))


# ---- samples ---------------------------------------------------------------------------------


def _samples(m: Manipulator) -> Iterator[Manipulator]:
    """Geometries and poses of the same structure, each as a manipulator whose home it is."""
    yield m
    rng, home = np.random.default_rng(0), mobility(m)
    for points, frames in ((False, False), (True, False), (False, True), (True, True)):
        geometry = _changed(m, rng, points=points, frames=frames) if points or frames else m
        start = _closed(geometry, np.array(m.home.X), np.array(m.home.q))
        if start is None or not _is_alike(start, home):
            continue
        for _ in range(_POSES):
            found = elsewhere(start, rng)
            if found is not None and _is_alike(found, home):
                yield found


def _is_alike(sample: Manipulator, home: Mobility) -> bool:
    """Whether legs are regular, and constraints as many and as independent as at home."""
    found = mobility(sample)
    dependent = found.overconstrained == home.overconstrained
    return dependent and (found.constraints, found.singular_legs) == (home.constraints, ())


def _size(m: Manipulator) -> float:
    """A length of the mechanism."""
    points = [p for leg in m.legs for p in (leg.base_point, leg.platform_point)]
    offsets = [offset for leg in m.legs for offset in leg.offsets]
    lengths = np.linalg.norm([*points, *offsets], axis=1)
    return float(lengths.max()) or 1.0


def _closed(m: Manipulator, X: Array, q: Array) -> Manipulator | None:
    """The manipulator with its home at the closure next to these coordinates; None if none."""
    loops = Loops.of(m)
    X, q = all_closed(loops, X, q)
    if not max(loops.residuals(X, q)) < _CLOSED * max(1.0, _size(m)):
        return None
    X = np.concatenate([X[: loops.size], q[loops.extra]])
    return replace(m, home=Home(tuple(X.tolist()), tuple(q.tolist())))


def elsewhere(m: Manipulator, rng: np.random.Generator) -> Manipulator | None:
    """The same mechanism moved a random way along its degrees of freedom."""
    motions, twist = motions_at_home(m), len(TASK_SPACES[m.space].components)
    step = motions @ rng.uniform(-1.0, 1.0, motions.shape[1])
    loops, space = Loops.of(m), TASK_SPACES[m.space]
    shifts = [k < 3 for k in space.components] + [not joint.kind.is_angle for joint in loops.joints]
    sizes = np.where(shifts, _SHIFT * _size(m), _TURN)
    step /= float(np.max(np.abs(step) / sizes))
    X, q = np.array(m.home.X), np.array(m.home.q)
    for _ in range(_ATTEMPTS):
        pose = displaced(m.space, X[: loops.size], step[:twist])
        found = _closed(m, pose, q + step[twist:])
        if found is not None:
            return found
        step /= 2.0
    return None


def check_dependence(m: Manipulator) -> None:
    """Refuse mechanisms with dependent constraints that move at home only.

    Raises:
        SpecError: random motions along the degrees of freedom at home end where loops do not
            close, or where there are fewer degrees of freedom.
    """
    home = mobility(m)
    if not home.overconstrained:
        return
    rng = np.random.default_rng(1)
    for _ in range(_POSES):
        found = elsewhere(m, rng)
        moved = found is not None and _way(m, found) > _LEAST
        if not moved or found is None or mobility(found).dofs != home.dofs:
            raise m.fault(
                "legs",
                f"overconstrained: of the {home.constraints} constraints that the legs put on the "
                f"platform, {home.overconstrained} follow from the others at home, but not beyond "
                "it: what moves there moves at home only",
                "legs whose constraints are independent, or dependent wherever the platform is",
            )


def _way(m: Manipulator, moved: Manipulator) -> float:
    """How far joints have moved, as parts of `_SHIFT` and `_TURN`."""
    sizes = np.array([_TURN if joint.kind.is_angle else _SHIFT * _size(m) for joint in m.joints])
    return float(np.max(np.abs(np.subtract(moved.home.q, m.home.q)) / sizes))


def _changed(
    m: Manipulator, rng: np.random.Generator, *, points: bool, frames: bool
) -> Manipulator:
    """Another geometry: of lengths; of the legs' points; of their base frames.

    Directions within a leg stay.  An offset along the axis of a joint, by which a leg can spin
    idly, is a matter of design, whether or not the axes of a frame are drawn along it.
    """
    size, planar = _size(m), TASK_SPACES[m.space].planar

    def moved(point: Vector3) -> Vector3:
        shift = _CHANGE * size * rng.uniform(-1.0, 1.0, 3) * (1.0, 1.0, 0.0 if planar else 1.0)
        return vector3(np.array(point) + shift)

    def factor() -> float:
        return 1.0 + _CHANGE * float(rng.uniform(-1.0, 1.0))

    def scaled(vector: Vector3) -> Vector3:
        return vector3(np.array(vector) * factor())

    def joint(old: Joint) -> Joint:
        return replace(old, offset=scaled(old.offset), pitch=old.pitch * factor())

    def changed(leg: Leg) -> Leg:
        frame, end = np.array(leg.base_frame), leg.platform_joint
        seated = m.space is Space.POINT or not points
        return replace(
            leg,
            joints=tuple(joint(each) for each in leg.joints),
            base_point=moved(leg.base_point) if points else leg.base_point,
            base_frame=matrix3(_turn(rng, planar=planar) @ frame) if frames else leg.base_frame,
            platform_joint=replace(end, offset=scaled(end.offset)),
            platform_point=leg.platform_point if seated else moved(leg.platform_point),
        )

    return replace(m, legs=tuple(changed(leg) for leg in m.legs))


def _turn(rng: np.random.Generator, *, planar: bool) -> Array:
    axis = np.array([0.0, 0.0, 1.0]) if planar else rng.normal(size=3)
    return rotation_about(axis / np.linalg.norm(axis), _CHANGE * float(rng.uniform(-1.0, 1.0)))
