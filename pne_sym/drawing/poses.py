"""Poses to be drawn: as people type them, and with the displacements that close the loops there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pne_sym.generation import InputError
from pne_sym.mechanics.mobility import mobility
from pne_sym.model.kinematics import TASK_SPACES, Array
from pne_sym.model.loops import Loops, legs_closed
from pne_sym.model.manipulator import Manipulator, Space
from pne_sym.program.operations import OPERATIONS

CLOSED = 1e-6
"""Largest loop-closure residual of a leg (m or rad) with which it is drawn."""
_FAR, _NEAR = (8, 64), (2, 16, 64)
"""Numbers of stages to try on the way from home, and from the pose before."""
_ANGLES = ("roll", "pitch", "yaw")
_QUATERNION = ("qx", "qy", "qz", "qw")


@dataclass(frozen=True)
class Configuration:
    """A pose, and the displacements that close the loops there.

    Attributes:
        X: platform coordinates, then the extra ones.
        q: displacements of all joints.
    """

    X: Array
    q: Array


def at_home(manipulator: Manipulator) -> Configuration:
    """The configuration that the specification states."""
    return Configuration(np.array(manipulator.home.X), np.array(manipulator.home.q))


def pose_of(manipulator: Manipulator, numbers: Sequence[float]) -> list[float]:
    """X from the numbers of a pose: X itself, or with roll, pitch, yaw for the quaternion.

    Args:
        manipulator: whose pose it is.
        numbers: platform coordinates, then the extra ones; lengths in m, angles in rad.
            Roll, pitch, yaw turn about the fixed axes x, y, z, in this order.

    Raises:
        InputError: not as many numbers as either form has, or one is not finite.
    """
    names = TASK_SPACES[manipulator.space].pose_names
    forms = [names]
    if _QUATERNION[0] in names:
        forms.insert(0, (*names[:-4], *_ANGLES))
    extra = len(manipulator.home.X) - len(names)
    form = next((f for f in forms if len(f) + extra == len(numbers)), None)
    if form is None or not all(map(math.isfinite, numbers)):
        raise InputError(f"{_wanted(forms, extra)} needed, not {_listed(numbers)}")
    if form is names:
        return list(numbers)
    start = len(form) - len(_ANGLES)
    rpy = np.array([numbers[start : len(form)]])
    (quaternion,) = OPERATIONS["quaternion_of_rpy"]((rpy,), ())
    return [*numbers[:start], *quaternion[0].tolist(), *numbers[len(form) :]]


def closed(
    manipulator: Manipulator,
    X: Sequence[float] | None,
    q: Sequence[float] | None,
    start: Configuration | None = None,
) -> Configuration:
    """The configuration at a pose, on the branch of the one that it is reached from.

    Args:
        manipulator: the manipulator.
        X: platform coordinates, then the extra ones; default home.
        q: first guess of the displacements; default: found along the straight way from `start`.
        start: where the way begins; default home.

    Raises:
        InputError: numbers that are no X or q, or the loops do not close there.
    """
    if X is None and q is None:
        return start or at_home(manipulator)
    loops = Loops.of(manipulator)
    goal = _coordinates(manipulator, manipulator.home.X if X is None else X)
    if q is not None:
        _check_length("q", q, len(manipulator.home.q))
        found = np.array(q, dtype=float)
        found[loops.extra] = goal[loops.size :]
        found = legs_closed(loops, goal, found)
    else:
        way = (at_home(manipulator), _FAR) if start is None else (start, _NEAR)
        found = _along_the_way(loops, goal, *way)
    if not max(loops.residuals(goal, found)) <= CLOSED:
        widest = loops.widest(goal, found)
        left = f"a loop-closure residual of {widest.size} is left"
        message = f"X: legs[{widest.leg}] does not reach it; {left}"
        raise InputError(message + _constrained(manipulator))
    return Configuration(goal, found)


def _along_the_way(
    loops: Loops, goal: Array, start: Configuration, tries: tuple[int, ...]
) -> Array:
    """Displacements at a pose, from those at another, in as many stages as they need."""
    for stages in tries:
        found = start.q.copy()
        for part in np.linspace(0.0, 1.0, stages + 1)[1:]:
            stage = _between(loops.space, start.X, goal, float(part))
            found[loops.extra] = stage[loops.size :]
            found = legs_closed(loops, stage, found)
        if max(loops.residuals(goal, found)) <= CLOSED:
            break
    return found


def _between(space: Space, start: Array, goal: Array, part: float) -> Array:
    """A pose on the straight way; rotations by the shorter way."""
    k = TASK_SPACES[space].quaternion_at
    if k is None:
        return start + part * (goal - start)
    end, turn = goal.copy(), slice(k, k + 4)
    if float(start[turn] @ goal[turn]) < 0.0:
        end[turn] = -goal[turn]
    stage: Array = start + part * (end - start)
    stage[turn] /= np.linalg.norm(stage[turn])
    return stage


def _coordinates(manipulator: Manipulator, X: Sequence[float]) -> Array:
    """X as an array, its quaternion of length one."""
    _check_length("X", X, len(manipulator.home.X))
    result = np.array(X, dtype=float)
    k = TASK_SPACES[manipulator.space].quaternion_at
    if k is not None:
        turn = result[k : k + 4]
        largest = float(np.abs(turn).max())
        if largest == 0.0:
            raise InputError(
                f"X: a quaternion that is not zero is needed, not {list(X)[k : k + 4]}"
            )
        turn /= largest
        turn /= np.linalg.norm(turn)
    return result


def _constrained(manipulator: Manipulator) -> str:
    """A hint where the legs hold the platform: few poses are possible."""
    found = mobility(manipulator)
    if not found.constraints:
        return ""
    return (
        f" (the legs put {found.constraints} constraints on the platform; project() of the "
        "generated module gives the nearest pose that they allow)"
    )


def _check_length(name: str, values: Sequence[float], wanted: int) -> None:
    if len(values) != wanted or not np.isfinite(np.array(values, dtype=float)).all():
        raise InputError(f"{name}: {wanted} numbers are needed, not {list(values)}")


def _wanted(forms: Sequence[Sequence[str]], extra: int) -> str:
    tail = [f"{extra} extra coordinate{'s' if extra > 1 else ''}"] if extra else []
    told = [f"{len(form) + extra} numbers ({', '.join([*form, *tail])})" for form in forms]
    return " or ".join(told) + " are"


def _listed(numbers: Sequence[float]) -> str:
    shown = ", ".join(f"{x:g}" for x in numbers[:8]) + (", ..." if len(numbers) > 8 else "")
    return f"{len(numbers)} ({shown})" if numbers else "none"
