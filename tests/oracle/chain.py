"""Poses of a leg's links as functions of its joint displacements."""

from __future__ import annotations

import numpy as np

from pne_sym.model.manipulator import JointKind, Leg
from tests.oracle.coordinates import Pose
from tests.oracle.jets import Array, Jet, apply, compose, constant, rotation_about


def chain_poses(leg: Leg, q: Jet) -> list[Pose]:
    """Link frames along a leg.

    T_i = T_{i-1} Trans(offset) {Rot(axis, x) | Trans(axis x) | both for a screw}.

    Args:
        leg: chain of m joints.
        q: (..., m) displacements, rad or m.

    Returns:
        m poses, base frame, with the leading axes of `q`.
    """
    shape = q.value.shape[:-1]
    origin = constant(np.broadcast_to(np.array(leg.base_point, dtype=float), (*shape, 3)))
    rotation = constant(np.broadcast_to(np.array(leg.base_frame, dtype=float), (*shape, 3, 3)))
    poses = []
    for index, joint in enumerate(leg.joints):
        axis = np.array(joint.axis, dtype=float)
        displacement = q.component(index)
        shift = constant(np.broadcast_to(np.array(joint.offset, dtype=float), (*shape, 3)))
        advance = 1.0 if joint.kind is JointKind.PRISMATIC else joint.pitch
        if joint.kind is not JointKind.REVOLUTE:
            shift = shift + along(axis * advance, displacement)
        origin = origin + apply(rotation, shift)
        if joint.kind is not JointKind.PRISMATIC:
            rotation = compose(rotation, rotation_about(axis, displacement))
        poses.append(Pose(origin, rotation))
    return poses


def along(direction: Array, amount: Jet) -> Jet:
    """The vector (..., 3) `direction` (3,) times `amount` (...)."""
    return amount.linear(lambda array: array[..., None] * direction)


def carried_point(pose: Pose, point: tuple[float, float, float]) -> Jet:
    """Position (..., 3), base frame, of a point fixed in a moving frame."""
    return pose.origin + apply(pose.rotation, fixed(pose, point))


def carried_vector(pose: Pose, vector: Array | tuple[float, float, float]) -> Jet:
    """Components (..., 3) in base axes of a vector fixed in a moving frame."""
    return apply(pose.rotation, fixed(pose, vector))


def fixed(pose: Pose, vector: Array | tuple[float, float, float]) -> Jet:
    """A constant vector with the leading axes of `pose`."""
    return constant(np.broadcast_to(np.array(vector, dtype=float), pose.origin.value.shape))
