"""What the method covers, checked before anything is derived."""

from __future__ import annotations

import numpy as np

from pne_sym.mechanics.platform_directions import across
from pne_sym.mechanics.scales import home_lengths
from pne_sym.mechanics.structure import LegType, is_coordinate
from pne_sym.model.errors import SpecError
from pne_sym.model.kinematics import Array, ChainPose, TaskSpace, at_home, chain_pose
from pne_sym.model.manipulator import Leg, Manipulator, PlatformJoint
from pne_sym.model.platform_kinds.interface import Direction

_DEPENDENT = 1e-9  # smallest relative singular value of independent degrees of freedom


def check_scope(manipulator: Manipulator, leg_type: LegType, space: TaskSpace) -> None:
    """Refuse a leg type that the method does not cover, with the mechanical reason.

    Raises:
        SpecError: more degrees of freedom than the platform joint leaves to be determined and no
            joint marked extra; degrees of freedom that are dependent at home.
    """
    index, leg = leg_type.indices[0], leg_type.model
    dofs = [j for j, joint in enumerate(leg.joints) if not joint.extra]
    moments = 0 if space.planar else leg.platform_joint.kind.moments
    most = (2 if space.planar else 3) + moments
    if len(dofs) > most:
        raise SpecError(
            manipulator.name,
            f"legs[{index}].joints",
            f"{len(dofs)} degrees of freedom where the platform joint leaves {most} to be "
            "determined",
            f"at most {most} joints, or the surplus ones marked extra = true",
        )
    _check_independent(manipulator, leg_type, dofs, planar=space.planar)


def _check_independent(
    manipulator: Manipulator, leg_type: LegType, dofs: list[int], *, planar: bool
) -> None:
    """Refuse a leg whose degrees of freedom are dependent at home."""
    pose, displacements = at_home(manipulator)
    length = home_lengths(manipulator, leg_type).arm
    for index in leg_type.indices:
        leg = manipulator.legs[index]
        chain = chain_pose(leg, displacements[index])
        columns = chain.velocities[:, dofs] / length
        if planar:
            columns = columns[:2]
        else:
            turning = _turning(leg_type, leg, chain, pose.R)
            columns = np.vstack([columns, turning[:, dofs]])
        sizes = np.linalg.norm(columns, axis=0)
        if not len(dofs):
            raise SpecError(
                manipulator.name,
                f"legs[{index}].joints",
                "no joint left to solve for",
                "at least one joint that is not extra",
            )
        values = np.linalg.svd(columns / np.where(sizes > 0, sizes, 1.0), compute_uv=False)
        if np.min(sizes) < _DEPENDENT * np.max(sizes) or values[-1] < _DEPENDENT:
            raise SpecError(
                manipulator.name,
                f"legs[{index}]",
                "the leg is singular at home: its degrees of freedom move the platform joint along "
                "dependent directions",
                "a home position off the singularity, or the superfluous joint marked extra = true",
            )


def _turning(leg_type: LegType, leg: Leg, chain: ChainPose, base_R_platform: Array) -> Array:
    """Angular velocity along the moment directions per joint rate, (moments, joints)."""
    leg_R_platform = np.array(leg.base_frame).T @ base_R_platform
    directions = moment_directions(leg_type, leg, chain.last, leg_R_platform)
    return np.asarray(directions @ chain.spins)


def moment_directions(leg_type: LegType, leg: Leg, last: Array, leg_R_platform: Array) -> Array:
    """Directions (k, 3) of the moments that a leg's platform joint transmits, in leg axes.

    Args:
        leg_type: of the leg.
        leg: one of its legs.
        last: rotation from the last link's to leg axes.
        leg_R_platform: rotation from platform to leg axes.
    """
    found = [
        np.cross(last @ in_link, leg_R_platform @ in_platform)
        for in_link, in_platform in right_angles(leg_type, leg)
    ]
    return np.array(found).reshape(-1, 3)


def right_angles(leg_type: LegType, leg: Leg) -> list[tuple[Array, Array]]:
    """Directions of the last link and of the platform that a platform joint keeps perpendicular."""
    end = leg.platform_joint
    return [
        (_direction(leg_type, end, in_link), _direction(leg_type, end, in_platform))
        for in_link, in_platform in end.right_angles
    ]


def _direction(leg_type: LegType, joint: PlatformJoint, direction: Direction) -> Array:
    """A direction of a platform joint in numbers, in the frame of its body."""
    if not direction.field:
        return np.asarray(np.eye(3)[direction.row])
    stated = np.array(getattr(joint, direction.field))
    if direction.row is not None:
        stated = stated[direction.row]
    if not direction.across:
        return stated
    if is_coordinate(stated.tolist()):
        main = int(np.argmax(np.abs(stated)))
        return np.asarray(np.eye(3)[(main + direction.across) % 3])
    first = np.cross(stated, np.eye(3)[across(leg_type)])
    first /= np.linalg.norm(first)
    return first if direction.across == 1 else np.cross(stated, first)
