"""What the method covers, checked before anything is derived."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pne_sym.mechanics.structure import LegType
from pne_sym.mechanics.task_space import TaskSpace
from pne_sym.model.errors import SpecError
from pne_sym.model.manipulator import JointKind, Leg, Manipulator, PlatformJointKind

Array = NDArray[np.float64]
_MOMENTS = {  # moments that a platform joint transmits, in space
    PlatformJointKind.SPHERICAL: 0,
    PlatformJointKind.UNIVERSAL: 1,
    PlatformJointKind.REVOLUTE: 2,
    PlatformJointKind.RIGID: 3,
}
_DEPENDENT = 1e-9  # smallest relative singular value of independent freedoms


def check_scope(manipulator: Manipulator, leg_type: LegType, space: TaskSpace) -> None:
    """Refuse a leg type that the method does not cover, with the mechanical reason.

    Raises:
        SpecError: more freedoms than the platform joint leaves to be determined and no
            joint marked extra; freedoms that are dependent at home.
    """
    index, leg = leg_type.indices[0], leg_type.model
    freedoms = [j for j, joint in enumerate(leg.joints) if not joint.extra]
    kind = leg.platform_joint.kind
    moments = 0 if space.planar else _MOMENTS[kind]
    most = (2 if space.planar else 3) + moments
    if len(freedoms) > most:
        raise SpecError(
            manipulator.name,
            f"legs[{index}].joints",
            f"{len(freedoms)} freedoms where the platform joint leaves {most} to be determined",
            f"at most {most} joints, or the surplus ones marked extra = true",
        )
    if not moments:
        _check_independent(manipulator, leg_type, freedoms, planar=space.planar)


def _check_independent(
    manipulator: Manipulator, leg_type: LegType, freedoms: list[int], *, planar: bool
) -> None:
    """Refuse a leg whose freedoms are dependent at home."""
    starts = np.cumsum([0, *(len(leg.joints) for leg in manipulator.legs)])
    for index in leg_type.indices:
        leg = manipulator.legs[index]
        q = np.array(manipulator.home.q[starts[index] : starts[index + 1]])
        columns = velocity_vectors(leg, q)[:, freedoms]
        columns = columns[:2] if planar else columns
        sizes = np.linalg.norm(columns, axis=0)
        if not len(freedoms):
            raise SpecError(
                manipulator.name,
                f"legs[{index}].joints",
                "no joint left to solve for",
                "at least one joint that is not extra",
            )
        values = np.linalg.svd(columns / np.where(sizes > 0, sizes, 1.0), compute_uv=False)
        if np.min(sizes) == 0.0 or values[-1] < _DEPENDENT:
            raise SpecError(
                manipulator.name,
                f"legs[{index}]",
                "the leg is singular at home: its freedoms move the connection point along "
                "dependent directions",
                "a home position off the singularity, or the superfluous joint marked extra = true",
            )


def velocity_vectors(leg: Leg, q: Array) -> Array:
    """Velocity of the connection point per joint rate, (3, joints), in leg axes."""
    origin, rotation = np.zeros(3), np.eye(3)
    axes, origins = [], []
    for joint, x in zip(leg.joints, q, strict=True):
        origin = origin + rotation @ np.array(joint.offset)
        axis = np.array(joint.axis)
        axes.append(rotation @ axis)
        if joint.kind is not JointKind.REVOLUTE:
            pitch = joint.pitch if joint.kind is JointKind.HELICAL else 1.0
            origin = origin + rotation @ axis * pitch * x
        origins.append(origin)
        if joint.kind is not JointKind.PRISMATIC:
            rotation = rotation @ turn(axis, x)
    tip = origin + rotation @ np.array(leg.platform_joint.offset)
    columns = []
    for joint, e, o in zip(leg.joints, axes, origins, strict=True):
        column = e if joint.kind is JointKind.PRISMATIC else np.cross(e, tip - o)
        if joint.kind is JointKind.HELICAL:
            column = column + joint.pitch * e
        columns.append(column)
    return np.stack(columns, axis=1)


def axes_at(leg: Leg, q: Array) -> tuple[list[Array], Array]:
    """Joint axes and the last link's rotation at displacements q, in leg axes."""
    rotation, axes = np.eye(3), []
    for joint, x in zip(leg.joints, q, strict=True):
        axis = np.array(joint.axis)
        axes.append(rotation @ axis)
        if joint.kind is not JointKind.PRISMATIC:
            rotation = rotation @ turn(axis, x)
    return axes, rotation


def turn(axis: Array, angle: float) -> Array:
    """Rotation matrix about a unit axis (Rodrigues)."""
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k)
