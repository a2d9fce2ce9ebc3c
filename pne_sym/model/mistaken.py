"""Units that are not SI, recognised by the loops that close with them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from pne_sym.model.assembly import closures, middle_of
from pne_sym.model.closure import leg_residual
from pne_sym.model.kinematics import TASK_SPACES, Array, pose_at
from pne_sym.model.loops import Loops
from pne_sym.model.manipulator import Leg, Space, Vector3

_MILLI = 1e-3
_NEAR = 1e-2
"""Residual, over the largest length, with which loops count as closed but for rounding."""


@dataclass(frozen=True)
class _Mistake:
    """What may be in millimetres or degrees."""

    base_point: bool
    platform_point: bool
    links: bool
    position: bool
    slides: bool
    hinges: bool
    phi: bool

    def told(self) -> str:
        """In words."""
        lengths = [
            name
            for name, wrong in (
                ("base_point", self.base_point),
                ("platform_point", self.platform_point),
                ("offset", self.links),
                ("the position in home.X", self.position),
                ("ways in home.q", self.slides),
            )
            if wrong
        ]
        angles = [
            name
            for name, wrong in (("angles in home.q", self.hinges), ("phi in home.X", self.phi))
            if wrong
        ]
        parts = [f"{', '.join(lengths)} in mm"] * bool(lengths)
        parts += [f"{' and '.join(angles)} in degrees"] * bool(angles)
        return " and ".join(parts)


def mistaken_unit(loops: Loops, X: Array, q: Array | None) -> str:
    """What else would close the loops, as the end of a message; empty where nothing does.

    Args:
        loops: that do not close.
        X: pose and extra coordinates.
        q: displacements; None: any.
    """
    planar = loops.space is Space.PLANAR
    choices = [(False, True)] * 4 + [(False, bool(q is not None))] * 2 + [(False, planar)]
    cases = [_Mistake(*case) for case in dict.fromkeys(product(*choices))]
    cases.sort(key=lambda case: sum(vars(case).values()))
    for case in cases[1:]:
        if _closes(loops, X, q, case):
            return f"; with {case.told()} they would close, but units are m and rad"
    return ""


def _closes(loops: Loops, X: Array, q: Array | None, case: _Mistake) -> bool:
    legs = [_corrected(leg, case) for leg in loops.legs]
    X = X.copy()
    if TASK_SPACES[loops.space].translates:
        X[: 2 if TASK_SPACES[loops.space].planar else 3] *= _MILLI if case.position else 1.0
    if case.phi:
        X[2] = np.radians(X[2])
    if q is not None:
        slides = np.array([not joint.kind.is_angle for joint in loops.joints])
        hinges = ~slides
        q = q * np.where(slides & case.slides, _MILLI, 1.0)
        q = q * np.where(hinges & case.hinges, np.pi / 180.0, 1.0)
    pose = pose_at(loops.space, X.tolist(), loops.centre)
    for leg, s in zip(legs, loops.slices(), strict=True):
        given = np.zeros(len(leg.joints)) if q is None else q[s]
        found = closures(leg, pose, given, middle_of(legs, pose))[0] if q is None else given
        if np.abs(leg_residual(leg, found, pose)[0]).max() > _NEAR * _size(leg, pose.t):
            return False
    return True


def _corrected(leg: Leg, case: _Mistake) -> Leg:
    """The leg with its lengths in metres."""
    links = _MILLI if case.links else 1.0
    end = leg.platform_joint
    return replace(
        leg,
        base_point=_scaled(leg.base_point, _MILLI if case.base_point else 1.0),
        platform_point=_scaled(leg.platform_point, _MILLI if case.platform_point else 1.0),
        joints=tuple(replace(joint, offset=_scaled(joint.offset, links)) for joint in leg.joints),
        platform_joint=replace(end, offset=_scaled(end.offset, links)),
    )


def _size(leg: Leg, position: Array) -> float:
    points = (leg.base_point, leg.platform_point, position)
    return max(float(np.linalg.norm(point)) for point in points)


def _scaled(vector: Vector3, factor: float) -> Vector3:
    x, y, z = vector
    return (factor * x, factor * y, factor * z)
