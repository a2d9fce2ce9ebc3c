"""What the method covers, checked before anything is derived."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pne_sym.mechanics.structure import LegType, is_coordinate
from pne_sym.mechanics.task_space import TaskSpace
from pne_sym.model.closure import pose_at
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
    _check_independent(manipulator, leg_type, freedoms, planar=space.planar)


def _check_independent(
    manipulator: Manipulator, leg_type: LegType, freedoms: list[int], *, planar: bool
) -> None:
    """Refuse a leg whose freedoms are dependent at home."""
    screws = screws_at_home(manipulator, leg_type)
    screws = (np.delete(screws, 2, axis=1) if planar else screws)[:, :, freedoms]
    for index, columns in zip(leg_type.indices, screws, strict=True):
        if not len(freedoms):
            raise SpecError(
                manipulator.name,
                f"legs[{index}].joints",
                "no joint left to solve for",
                "at least one joint that is not extra",
            )
        sizes = np.linalg.norm(columns, axis=0)
        values = np.linalg.svd(columns / np.where(sizes > 0, sizes, 1.0), compute_uv=False)
        if np.min(sizes) == 0.0 or values[-1] < _DEPENDENT:
            raise SpecError(
                manipulator.name,
                f"legs[{index}]",
                "the leg is singular at home: its freedoms move the platform joint along "
                "dependent directions",
                "a home position off the singularity, or the superfluous joint marked extra = true",
            )


def screws_at_home(manipulator: Manipulator, leg_type: LegType) -> Array:
    """What each joint rate of a leg does at the platform joint, (legs, 3 + moments, joints).

    Rows: velocity of the connection point over the leg's reach, in the last link's axes, then
    the parts of the joint's axis along the directions of the transmitted moments.
    """
    starts = np.cumsum([0, *(len(leg.joints) for leg in manipulator.legs)])
    found = []
    for index in leg_type.indices:
        leg = manipulator.legs[index]
        q = np.array(manipulator.home.q[starts[index] : starts[index + 1]])
        found.append(_screws(leg, q, _platform_in_leg(manipulator, leg), across(leg_type)))
    return np.stack(found)


def across(leg_type: LegType) -> int:
    """The coordinate direction of the last link that is most across a revolute platform joint."""
    axes = leg_type.over_legs(lambda leg: leg.platform_joint.axis_link or (0.0, 0.0, 0.0))
    return int(np.argmin(np.abs(axes).max(axis=0)))


def _platform_in_leg(manipulator: Manipulator, leg: Leg) -> Array:
    """Rotation from platform axes to leg axes at home."""
    pose = pose_at(manipulator.space, manipulator.home.X, manipulator.fixed_centre)
    return np.array(leg.base_frame).T @ pose.R


def _screws(leg: Leg, q: Array, leg_R_platform: Array, second: int) -> Array:
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
    reach = max((float(np.linalg.norm(tip - o)) for o in origins), default=0.0) or 1.0
    moments = _moment_directions(leg, rotation, leg_R_platform, second)
    columns = []
    for joint, e, o in zip(leg.joints, axes, origins, strict=True):
        slides = joint.kind is JointKind.PRISMATIC
        column = e if slides else np.cross(e, tip - o) / reach
        if joint.kind is JointKind.HELICAL:
            column = column + joint.pitch * e / reach
        along = [0.0 if slides else float(e @ n) for n in moments]
        columns.append(np.array([*(rotation.T @ column), *along]))
    return np.stack(columns, axis=1)


def _moment_directions(
    leg: Leg, rotation: Array, leg_R_platform: Array, second: int
) -> list[Array]:
    """Directions of the moments that a platform joint in space transmits, in leg axes."""
    end = leg.platform_joint
    if end.kind is PlatformJointKind.RIGID:
        return [rotation[:, (k + 2) % 3] for k in range(3)]
    if end.kind is PlatformJointKind.SPHERICAL or end.axis_link is None:
        return []
    axis = np.array(end.axis_link)
    if end.kind is PlatformJointKind.UNIVERSAL:
        return [np.cross(rotation @ axis, leg_R_platform @ np.array(end.axis_platform))]
    if is_coordinate(end.axis_link):
        main = int(np.argmax(np.abs(axis)))
        links = [np.eye(3)[(main + 1 + k) % 3] for k in (0, 1)]
    else:
        first = np.cross(axis, np.eye(3)[second])
        first = first / np.linalg.norm(first)
        links = [first, np.cross(axis, first)]
    return [rotation @ np.cross(link, axis) for link in links]


def turn(axis: Array, angle: float) -> Array:
    """Rotation matrix about a unit axis (Rodrigues)."""
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k)
