"""The home of a specification: a pose, and displacements that close the loops there."""

from __future__ import annotations

import math

import numpy as np

from pne_sym.model.assembly import all_closures
from pne_sym.model.closure import CLOSED
from pne_sym.model.entry import Entry
from pne_sym.model.errors import SpecNote
from pne_sym.model.kinematics import TASK_SPACES, Array
from pne_sym.model.loops import Loops, all_closed, legs_closed
from pne_sym.model.manipulator import Home, Joint, Leg, Space, Vector3
from pne_sym.model.mistaken import mistaken_unit
from pne_sym.model.values import EXACT, number

FIELDS = ("X", "q")
TOLERANCE = 1e-6
"""Loop-closure residual (m; axes: rad) up to which the given home counts as closed."""
DIGITS = 13
"""Decimals to which displacements are found, the same on every machine."""
LARGE = 50.0
"""Positions of this size (m) are asked about where q is found."""
REACH = 0.5
"""A rough guess may be off by this much in any displacement (m or rad)."""


def read_home(entry: Entry, space: Space, legs: tuple[Leg, ...], centre: Vector3 | None) -> Home:
    """The home, with its loops closed to rounding.

    A home that closes to `TOLERANCE` is polished; a rough guess is solved for,
    with a `SpecWarning` that tells how far it was off.  Without q, displacements are found
    that close the loops, and told by a `SpecNote`.

    Raises:
        SpecError: wrong lengths, no rotation, or loops that do not close nearby.
    """
    table = entry.table(FIELDS)
    loops = Loops(space, legs, centre)
    x_entry = table.require("X", "the platform coordinates, then the extra ones")
    X = _read_x(x_entry, loops)
    q_entry = table.get("q")
    if q_entry is None:
        X, q = _found(entry, loops, X)
    else:
        q = _read_q(q_entry, loops)
        _check_extra(x_entry, X[loops.size :], q[loops.extra])
        X, q = _closed(entry, loops, np.array(X), q)
    return Home(tuple(X.tolist()), tuple(q.tolist()))


def _read_x(entry: Entry, loops: Loops) -> Array:
    names = TASK_SPACES[loops.space].pose_names + ("extra coordinate",) * int(loops.extra.sum())
    items = entry.counted(len(names), "numbers", f" ({', '.join(names)})")
    X = np.array([number(item) for item in items])
    start = TASK_SPACES[loops.space].quaternion_at
    if start is not None:
        norm = math.hypot(*X[start : start + 4])
        if norm < TOLERANCE:
            raise entry.fault("a quaternion (qx, qy, qz, qw) other than zero")
        if abs(norm - 1.0) > EXACT:
            X[start : start + 4] /= norm
    return X


def _read_q(entry: Entry, loops: Loops) -> Array:
    """Displacements, flat or one list for each leg."""
    items = entry.items()
    if items and isinstance(items[0].value, list):
        rows = zip(
            entry.counted(len(loops.legs), "lists", ", one for each leg"), loops.legs, strict=True
        )
        each = "numbers", ", one for each joint"
        items = [item for row, leg in rows for item in row.counted(len(leg.joints), *each)]
    else:
        which = ": one for each joint, leg by leg from the base"
        items = entry.counted(len(loops.joints), "numbers", which)
    return np.array([number(item) for item in items])


def _check_extra(entry: Entry, in_x: Array, in_q: Array) -> None:
    for a, b in zip(in_x, in_q, strict=True):
        if abs(a - b) > TOLERANCE:
            raise entry.fault(
                f"the displacement {b:.9g} that home.q gives for the same joint",
                problem=f"extra coordinate {a:.9g}",
            )


def _found(entry: Entry, loops: Loops, X: Array) -> tuple[Array, Array]:
    """X, and q of the usual closure of every leg."""
    found = all_closures(loops, X)
    q = np.concatenate([leg[0] for leg in found])
    if max(loops.residuals(X, q)) > _exact(X, q):
        new_x, q = all_closed(loops, X, q)  # the legs restrict the platform: the pose gives way
        moved = float(np.abs(new_x - X).max())
        if max(loops.residuals(new_x, q)) > TOLERANCE or moved > REACH:
            raise entry.fault(
                "X, base_point and platform_point with which all legs can be closed",
                problem=f"no displacements close the loops at X: {loops.widest(X, q)} at best"
                f"{mistaken_unit(loops, X, None)}",
            )
        if moved > TOLERANCE:
            entry.warn(
                ".X: the legs restrict the platform; closed by a change of at most "
                f"{moved:.3g} (m or rad)"
            )
        X = new_x
    q = principal(loops.joints, np.round(q, DIGITS).tolist())
    entry.warn(_told(loops, X, q, [len(leg) for leg in found]), SpecNote)
    return X, q


def _told(loops: Loops, X: Array, q: Array, counts: list[int]) -> str:
    """The displacements that were found, as the file could state them."""
    rows = ", ".join(f"[{', '.join(f'{x:.6g}' for x in q[s] + 0.0)}]" for s in loops.slices())
    size = max(abs(x) for leg in loops.legs for x in (*leg.base_point, *leg.platform_point))
    size = max(size, float(np.abs(X[: loops.size]).max()))
    doubt = f"; lengths are in m: is {size:g} in mm?" if size >= LARGE else ""
    return (
        f": q found from X: q = [{rows}], of "
        f"{', '.join(map(str, counts))} closures the usual ones (pne-gen home lists all){doubt}"
    )


def _closed(entry: Entry, loops: Loops, X: Array, q: Array) -> tuple[Array, Array]:
    """X and q with the loops closed; revolute displacements within (-pi, pi]."""
    given, q = q, principal(loops.joints, q.tolist())
    q[loops.extra] = X[loops.size :]
    residuals = loops.residuals(X, q)
    exact = _exact(X, q)
    if max(residuals) <= exact:
        return X, q
    new_x, new_q = X, legs_closed(loops, X, q)
    if max(loops.residuals(new_x, new_q)) > exact:
        # The legs restrict the platform: the pose itself has to give way.
        new_x, new_q = all_closed(loops, X, new_q)
    moved = max(float(np.abs(new_x - X).max()), float(np.abs(new_q - q).max()))
    widest = loops.widest(X, q)
    if max(loops.residuals(new_x, new_q)) > TOLERANCE or moved > REACH:
        raise entry.fault(
            f"X and q with loop-closure residuals of at most {TOLERANCE:g} (m or rad), "
            f"or a guess within {REACH:g} (m or rad) of such, or no q: it is found then",
            problem=f"the loops do not close at X: {widest}{mistaken_unit(loops, X, given)}",
        )
    if max(residuals) > TOLERANCE:
        entry.warn(
            f": taken as a rough guess (loop-closure residual {widest.size} at "
            f"legs[{widest.leg}]); closed by a change of at most {moved:.3g} (m or rad)"
        )
    return new_x, principal(loops.joints, new_q.tolist())


def _exact(X: Array, q: Array) -> float:
    """The residual that counts as none."""
    return CLOSED * max(1.0, float(np.abs(X).max()), float(np.abs(q).max()))


def principal(joints: list[Joint], q: list[float]) -> Array:
    """Revolute displacements within (-pi, pi], except those that are coordinates."""
    return np.array(
        [
            _wrapped(value) if joint.kind.is_hinge and not joint.extra else value
            for joint, value in zip(joints, q, strict=True)
        ]
    )


def _wrapped(angle: float) -> float:
    """The angle within (-pi, pi]."""
    if -math.pi < angle <= math.pi:
        return angle
    rest = math.remainder(angle, math.tau)
    return math.pi if rest <= -math.pi else rest
