"""Axes of a spherical joint in a leg, where a specification leaves them to the program.

Which three axes stand for a ball is a matter of coordinates.  The inverse kinematics is closed if
the last axis is that along which nothing turns what follows, or that of the hinge that follows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pne_sym.model.kinematics import Array
from pne_sym.model.manipulator import Joint, PlatformJoint, Vector3
from pne_sym.model.rotation import vector3
from pne_sym.model.values import DIRECTIONS, SNAP

USUAL: tuple[Vector3, Vector3, Vector3] = (DIRECTIONS["z"], DIRECTIONS["y"], DIRECTIONS["x"])


def with_axes(
    joint: Sequence[Joint], following: Joint | None, end: PlatformJoint
) -> tuple[Joint, ...]:
    """The three joints that stand for a ball, with axes chosen by what follows in the leg.

    Args:
        joint: the three.
        following: the first joint beyond them, if there is one.
        end: the platform joint.
    """
    extra = [part.extra for part in joint]
    direction = _direction(following, end)
    last = extra[2] or not any(extra)
    if following is not None and following.kind.is_hinge:
        axes = USUAL if last else _ending_in(following.axis)
    elif direction is None:
        axes = USUAL
    else:
        first, second, third = _ending_in(direction)
        # An axis along what it carries turns nothing: only as an extra coordinate it may be last.
        axes = (first, second, third) if last else (first, third, second)
    return tuple(replace(part, axis=axis) for part, axis in zip(joint, axes, strict=True))


def _direction(following: Joint | None, end: PlatformJoint) -> Vector3 | None:
    """Of the slide that follows, or of the rod from the ball to the next joint; None: neither."""
    if following is not None:
        return following.axis
    length = float(np.linalg.norm(end.offset))
    if length < SNAP:
        return None
    return vector3(np.array(end.offset) / length)


def _ending_in(direction: Vector3) -> tuple[Vector3, Vector3, Vector3]:
    """Three perpendicular axes; the last is given, and the others are coordinate ones if it is."""
    for names in ("zyx", "xyz", "zxy"):
        first, second, third = (DIRECTIONS[name] for name in names)
        if abs(abs(np.dot(third, direction)) - 1.0) < SNAP:
            return (first, second, direction)
    across = np.cross(direction, np.eye(3)[int(np.argmin(np.abs(direction)))])
    across /= np.linalg.norm(across)
    return (_vector(np.cross(across, direction)), _vector(across), direction)


def _vector(x: Array) -> Vector3:
    return vector3(np.where(np.abs(x) < SNAP, 0.0, x))
