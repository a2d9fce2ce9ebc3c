"""Units that are not SI, recognised by the loops that close with them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from itertools import compress, product

import numpy as np

from pne_sym.model.assembly import closures, middle_of
from pne_sym.model.closure import leg_residual
from pne_sym.model.kinematics import TASK_SPACES, Array, pose_at
from pne_sym.model.loops import Loops
from pne_sym.model.manipulator import Leg, Space, Vector3

_MILLI = 1e-3
_NEAR = 1e-2
"""Residual, over the largest length, with which loops count as closed but for rounding."""


_LENGTHS = _BASE, _PLATFORM, _LINKS, _POSITION, _SLIDES = (
    "base_point",
    "platform_point",
    "offset",
    "the position in home.X",
    "ways in home.q",
)
"""What may be in millimetres."""
_ANGLES = _HINGES, _PHI = "angles in home.q", "phi in home.X"
"""What may be in degrees."""


def mistaken_unit(loops: Loops, X: Array, q: Array | None) -> str:
    """What else would close the loops, as the end of a message; empty where nothing does.

    Args:
        loops: that do not close.
        X: pose and extra coordinates.
        q: displacements; None: any.
    """
    absent = {_SLIDES, _HINGES} if q is None else set()
    absent |= set() if loops.space is Space.PLANAR else {_PHI}
    names = [name for name in (*_LENGTHS, *_ANGLES) if name not in absent]
    cases = [tuple(compress(names, wrong)) for wrong in product((False, True), repeat=len(names))]
    for case in sorted(cases, key=len)[1:]:
        if _closes(loops, X, q, case):
            return f"; with {_told(case)} they would close, but units are m and rad"
    return ""


def _told(case: Collection[str]) -> str:
    """What is in other units, in words."""
    lengths, angles = ([name for name in of if name in case] for of in (_LENGTHS, _ANGLES))
    parts = [f"{', '.join(lengths)} in mm"] * bool(lengths)
    parts += [f"{' and '.join(angles)} in degrees"] * bool(angles)
    return " and ".join(parts)


def _closes(loops: Loops, X: Array, q: Array | None, case: Collection[str]) -> bool:
    legs = [_corrected(leg, case) for leg in loops.legs]
    X = X.copy()
    if TASK_SPACES[loops.space].translates:
        X[: 2 if TASK_SPACES[loops.space].planar else 3] *= _MILLI if _POSITION in case else 1.0
    if _PHI in case:
        X[2] = np.radians(X[2])
    if q is not None:
        slides = np.array([not joint.kind.is_angle for joint in loops.joints])
        q = q * np.where(slides & (_SLIDES in case), _MILLI, 1.0)
        q = q * np.where(~slides & (_HINGES in case), np.pi / 180.0, 1.0)
    pose = pose_at(loops.space, X.tolist(), loops.centre)
    for leg, s in zip(legs, loops.slices(), strict=True):
        given = np.zeros(len(leg.joints)) if q is None else q[s]
        found = closures(leg, pose, given, middle_of(legs, pose))[0] if q is None else given
        if np.abs(leg_residual(leg, found, pose)[0]).max() > _NEAR * _size(leg, pose.t):
            return False
    return True


def _corrected(leg: Leg, case: Collection[str]) -> Leg:
    """The leg with its lengths in metres."""
    links = _MILLI if _LINKS in case else 1.0
    end = leg.platform_joint
    return replace(
        leg,
        base_point=_scaled(leg.base_point, _MILLI if _BASE in case else 1.0),
        platform_point=_scaled(leg.platform_point, _MILLI if _PLATFORM in case else 1.0),
        joints=tuple(replace(joint, offset=_scaled(joint.offset, links)) for joint in leg.joints),
        platform_joint=replace(end, offset=_scaled(end.offset, links)),
    )


def _size(leg: Leg, position: Array) -> float:
    points = (leg.base_point, leg.platform_point, position)
    return max(float(np.linalg.norm(point)) for point in points)


def _scaled(vector: Vector3, factor: float) -> Vector3:
    x, y, z = vector
    return (factor * x, factor * y, factor * z)
