"""Poses of a leg's links as functions of its joint displacements."""

from __future__ import annotations

import numpy as np

from pne_sym.model.manipulator import JointKind, Leg, Vector3
from tests.oracle.coordinates import Pose
from tests.oracle.jets import Array, Jet, compose, constant, rotation_about, scaled


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
    origin = constant(np.array(leg.base_point, dtype=float), shape)
    rotation = constant(np.array(leg.base_frame, dtype=float), shape)
    poses = []
    for index, joint in enumerate(leg.joints):
        displacement = q.component(index)
        origin = origin + carried(rotation, joint.offset)
        advance = 1.0 if joint.kind is JointKind.PRISMATIC else joint.pitch
        if joint.kind is not JointKind.REVOLUTE:
            slide = carried(rotation, advance * np.array(joint.axis, dtype=float))
            origin = origin + scaled(slide, displacement)
        if joint.kind is not JointKind.PRISMATIC:
            rotation = compose(rotation, rotation_about(joint.axis, displacement))
        poses.append(Pose(origin, rotation))
    return poses


def carried(rotation: Jet, vector: Array | Vector3) -> Jet:
    """Components (..., 3) in base axes of a vector fixed in axes that turn (..., 3, 3)."""
    return Jet(rotation.terms @ np.asarray(vector, dtype=float))


def carried_point(pose: Pose, point: Vector3) -> Jet:
    """Position (..., 3), base frame, of a point fixed in a moving frame."""
    return pose.origin + carried(pose.rotation, point)


def carried_vector(pose: Pose, vector: Array | Vector3) -> Jet:
    """Components (..., 3) in base axes of a vector fixed in a moving frame."""
    return carried(pose.rotation, vector)
