"""Friction, springs, rotors and limits of all joints, from a specification's numbers."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from pne_sym.model.effects import Friction
from pne_sym.model.manipulator import Joint, JointKind, Manipulator
from tests.oracle.jets import Array


def friction(joints: Iterable[Joint], qd: Array) -> Array:
    """(m,) forces against the rates."""
    forces = np.zeros(len(qd))
    for k, (joint, rate) in enumerate(zip(joints, qd, strict=True)):
        of = joint.friction
        if of is None:
            continue
        forces[k] = (of.viscous or 0.0) * rate
        if of.coulomb is not None and of.velocity_scale is not None:
            forces[k] += of.coulomb * rate / np.hypot(rate, of.velocity_scale)
    return forces


def turning_friction(of: Friction | None, relative: Array) -> Array:
    """(3,) moment that drags the last link along with a platform turning relative to it."""
    if of is None:
        return np.zeros(3)
    size = (of.viscous or 0.0) * relative
    if of.coulomb is not None and of.velocity_scale is not None:
        size = size + of.coulomb * relative / np.hypot(np.linalg.norm(relative), of.velocity_scale)
    return np.asarray(size)


def springs(joints: Iterable[Joint], q: Array) -> Array:
    """(m,) forces against the displacements."""
    stiffness, strain = _springs(joints, q)
    return stiffness * strain


def stored(joints: Iterable[Joint], q: Array) -> float:
    """Energy of the springs, J: the integral of their forces from rest."""
    stiffness, strain = _springs(joints, q)
    return float(0.5 * stiffness @ strain**2)


def _springs(joints: Iterable[Joint], q: Array) -> tuple[Array, Array]:
    """Stiffness, and displacement from rest; angles that are no coordinates within (-pi, pi]."""
    stiffness, strain = np.zeros(len(q)), np.zeros(len(q))
    for k, (joint, given) in enumerate(zip(joints, q, strict=True)):
        if joint.spring is None:
            continue
        wraps = joint.kind is JointKind.REVOLUTE and not joint.extra
        value = np.pi - np.remainder(np.pi - given, 2.0 * np.pi) if wraps else given
        stiffness[k], strain[k] = joint.spring.stiffness, value - joint.spring.rest
    return stiffness, strain


def rotors(joints: Iterable[Joint]) -> Array:
    """(m,) inertia along each joint: a rotor turns at gear_ratio times the rate."""
    found = [j.actuator.rotor_inertia * j.actuator.gear_ratio**2 if j.actuator else 0.0
             for j in joints]  # fmt: skip
    return np.array(found)


def rotor_matrix(manipulator: Manipulator) -> Array:
    """(NJ, NJ) inertia of the rotors by rates of all joints: motor m turns at n_m C_m . qd."""
    joints = [joint for leg in manipulator.legs for joint in leg.joints]
    if manipulator.coupling is None:
        return np.diag(rotors(joints))
    actuated = [k for k, joint in enumerate(joints) if joint.actuated]
    turns = np.zeros((len(actuated), len(joints)))
    turns[:, actuated] = manipulator.coupling
    return np.asarray(turns.T @ np.diag(rotors(joints[k] for k in actuated)) @ turns)


def margins(joints: Iterable[Joint], q: Array) -> Array:
    """(m,) distances from the nearer limit, at the best of the angles that are the same."""
    found = np.full(len(q), np.inf)
    for k, (joint, value) in enumerate(zip(joints, q, strict=True)):
        if joint.limits is None or joint.limits.displacement is None:
            continue
        least, largest = joint.limits.displacement
        turns = range(-9, 10) if joint.kind is JointKind.REVOLUTE and not joint.extra else (0,)
        same = [value + 2.0 * np.pi * turn for turn in turns]
        found[k] = max(min(angle - least, largest - angle) for angle in same)
    return found
