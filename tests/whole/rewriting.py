"""The same mechanism with other origins: of base, platform, links, legs' ends and slides.

Nothing that moves is changed, only from where it is told.  `Rewriting` maps a state and every
answer from the one way of writing to the other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pne_sym.model.manipulator import (
    Body,
    Home,
    JointKind,
    Leg,
    Manipulator,
    PlatformJointKind,
    Space,
)
from tests.oracle.coordinates import is_planar, joint_slices, platform_rotation, task_size
from tests.oracle.jets import Array
from tests.oracle.randomisation import vector3
from tests.oracle.specs import State

MOVING_ORIGIN = (Space.SPATIAL, Space.PLANAR, Space.TRANSLATIONAL)
"""Spaces in which any point of the platform can be its origin."""


@dataclass(frozen=True)
class Shifts:
    """How far the origins move, in metres.

    Attributes:
        base: (3,) the base origin by minus this, base axes.
        platform: (3,) the platform origin, platform axes.
        first_axis: (legs,) base points along the first axis.
        first_offset: (legs, 3) base points against the first offset, leg axes.
        slides: (joints,) zeros of the displacements of slides.
        seats: (legs, 3) the points where legs meet the platform against the offsets of platform
            joints, last link's axes: of rigid ones, and along the axes of revolute ones.
    """

    base: Array
    platform: Array
    first_axis: Array
    first_offset: Array
    slides: Array
    seats: Array


def no_shifts(manipulator: Manipulator) -> Shifts:
    """Everything stays where it is."""
    legs, joints = len(manipulator.legs), len(manipulator.home.q)
    nothing = np.zeros((legs, 3))
    return Shifts(nothing[0], nothing[0], np.zeros(legs), nothing, np.zeros(joints), nothing)


def drawn_shifts(
    manipulator: Manipulator, rng: np.random.Generator, size: float, *, seats: bool
) -> Shifts:
    """Random shifts of up to `size` of everything that a mechanism can be told from.

    Args:
        manipulator: the mechanism.
        rng: source of randomness.
        size: in metres.
        seats: move the reference points of rigid and revolute platform joints too.
    """
    legs, joints = len(manipulator.legs), len(manipulator.home.q)
    flat = np.array([1.0, 1.0, 0.0 if is_planar(manipulator.space) else 1.0])

    def shift(*shape: int) -> Array:
        return rng.uniform(-size, size, shape)

    return Shifts(
        base=shift(3) * flat,
        platform=shift(3) * flat * (manipulator.space in MOVING_ORIGIN),
        first_axis=shift(legs),
        first_offset=shift(legs, 3) * flat,
        slides=shift(joints),
        seats=shift(legs, 3) * flat * seats,
    )


class Rewriting:
    """A mechanism told from other origins.

    Attributes:
        before, after: the two ways of writing.
        shifts: what was moved.
    """

    def __init__(self, before: Manipulator, shifts: Shifts) -> None:
        self.before, self.shifts = before, shifts
        self.moved_q = np.zeros(len(before.home.q))
        legs = []
        for number, where in enumerate(joint_slices(before)):
            leg, self.moved_q[where] = self._leg(number, shifts.slides[where])
            legs.append(leg)
        body = before.platform
        self.after = replace(
            before,
            legs=tuple(legs),
            platform=_seen_from(body, shifts.platform),
            fixed_centre=None
            if before.fixed_centre is None
            else vector3(np.array(before.fixed_centre) + shifts.base),
        )
        X, q = np.array(before.home.X), np.array(before.home.q)
        home = Home(tuple(map(float, self.coordinates(X))), tuple(map(float, q + self.moved_q)))
        self.after = replace(self.after, home=home)

    def _flat(self) -> bool:
        return is_planar(self.before.space)

    def _leg(self, number: int, slides: Array) -> tuple[Leg, Array]:
        """A leg told from elsewhere, and how its displacements change."""
        shifts, flat = self.shifts, self._flat()
        seated = _seated(self.before.legs[number], shifts.seats[number], planar=flat)
        slid, moved = _slid(seated, slides)
        along = _along_first_axis(slid, shifts.first_axis[number], flat)
        leg = _against_offset(along, shifts.first_offset[number])
        base = vector3(np.array(leg.base_point) + shifts.base)
        end = vector3(np.array(leg.platform_point) - shifts.platform)
        return replace(leg, base_point=base, platform_point=end), moved

    # ---- states --------------------------------------------------------------------------

    def coordinates(self, X: Array) -> Array:
        """X of the same pose and extra displacements."""
        X = np.array(X)
        space = self.before.space
        if space is not Space.SPHERICAL:
            moved = self.shifts.base + self.arm(X)
            count = 2 if self._flat() else 3
            X[:count] += moved[:count]
        joints = [joint for leg in self.before.legs for joint in leg.joints]
        extras = [k for k, joint in enumerate(joints) if joint.extra]
        if extras:
            X[-len(extras) :] += self.moved_q[extras]
        return X

    def arm(self, X: Array) -> Array:
        """From the old platform origin to the new one, base axes."""
        return np.asarray(platform_rotation(self.before, X) @ self.shifts.platform)

    def twist(self, X: Array) -> Array:
        """(nv, nv): V by V of the other writing."""
        task = task_size(self.before.space)
        extra = sum(joint.extra for leg in self.before.legs for joint in leg.joints)
        change, arm = np.eye(task + extra), self.arm(X)
        if self.before.space is Space.SPATIAL:
            change[:3, 3:6] = -_skew(arm)
        elif self.before.space is Space.PLANAR:
            change[:2, 2] = -arm[1], arm[0]
        return change

    def drift(self, X: Array, V: Array) -> Array:
        """A = twist A + drift."""
        found, arm = np.zeros(len(V)), self.arm(X)
        if self.before.space is Space.SPATIAL:
            found[:3] = np.cross(V[3:6], np.cross(V[3:6], arm))
        elif self.before.space is Space.PLANAR:
            found[:2] = -(V[2] ** 2) * arm[:2]
        return found

    def state(self, s: State) -> State:
        """The same state and load."""
        change = self.twist(s.X)
        task = task_size(self.before.space)
        return State(
            self.coordinates(s.X),
            s.q + self.moved_q,
            change @ s.V,
            change @ s.A + self.drift(s.X, s.V),
            np.linalg.inv(change).T[:task, :task] @ s.wrench,
        )

    # ---- answers -------------------------------------------------------------------------

    def answers(self, s: State, found: dict[str, Any]) -> dict[str, Any]:
        """What the other writing has to answer, from the answers at a state of this one."""
        back = np.linalg.inv(self.twist(s.X))
        M = back.T @ found["M"] @ back
        wanted = dict(found)
        wanted |= {
            "M": M,
            "Z": back.T @ found["Z"] - M @ self.drift(s.X, s.V),
            "H": back.T @ found["H"],
            "q": found["q"] + self.moved_q,
            "A": self.twist(s.X) @ found["A"] + self.drift(s.X, s.V),
        }
        if "Hk" in found:
            wanted["Hk"] = back.T @ found["Hk"]
            change = wanted["Hk"].T @ self.drift(s.X, s.V)
            wanted["bias"] = found["bias"] - np.append(change, 0.0)
        return wanted


def _skew(a: Array) -> Array:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def _seen_from(body: Body, origin: Array) -> Body:
    return replace(body, centre_of_mass=vector3(np.array(body.centre_of_mass) - origin))


def _moved_link(leg: Leg, number: int, along: Array) -> Leg:
    """The frame of a link moved within it: what is fixed in the link is told from there."""
    joints = list(leg.joints)
    joints[number] = replace(joints[number], link=_seen_from(joints[number].link, along))
    end = leg.platform_joint
    if number + 1 < len(joints):
        following = joints[number + 1]
        joints[number + 1] = replace(following, offset=vector3(np.array(following.offset) - along))
    else:
        end = replace(end, offset=vector3(np.array(end.offset) - along))
    return replace(leg, joints=tuple(joints), platform_joint=end)


def _along_first_axis(leg: Leg, by: float, flat: bool) -> Leg:
    """The base point moved along the first axis, and with it the first link's frame."""
    axis = np.array(leg.joints[0].axis)
    if flat and leg.joints[0].kind is JointKind.REVOLUTE:
        return leg
    moved = np.array(leg.base_point) + np.array(leg.base_frame) @ axis * by
    return _moved_link(replace(leg, base_point=vector3(moved)), 0, axis * by)


def _against_offset(leg: Leg, by: Array) -> Leg:
    """The base point moved against the first offset."""
    first = leg.joints[0]
    joints = (replace(first, offset=vector3(np.array(first.offset) - by)), *leg.joints[1:])
    moved = np.array(leg.base_point) + np.array(leg.base_frame) @ by
    return replace(leg, base_point=vector3(moved), joints=joints)


def _slid(leg: Leg, by: Array) -> tuple[Leg, Array]:
    """Slides with other zeros: the offset before them gives way; also the change of q."""
    joints, moved = list(leg.joints), np.zeros(len(leg.joints))
    for number, joint in enumerate(joints):
        if joint.kind is JointKind.PRISMATIC:
            offset = np.array(joint.offset) - by[number] * np.array(joint.axis)
            joints[number] = replace(joint, offset=vector3(offset))
            moved[number] = by[number]
    return replace(leg, joints=tuple(joints)), moved


def _seated(leg: Leg, by: Array, *, planar: bool) -> Leg:
    """Another point at which the platform joint is told to be, in link and platform."""
    end = leg.platform_joint
    if planar or end.kind not in (PlatformJointKind.RIGID, PlatformJointKind.REVOLUTE):
        return leg
    if end.kind is PlatformJointKind.RIGID:
        on_platform = np.array(end.rotation).T @ by
    else:
        by = float(by[0]) * np.array(end.axis_link)
        on_platform = float(by @ np.array(end.axis_link)) * np.array(end.axis_platform)
    return replace(
        leg,
        platform_joint=replace(end, offset=vector3(np.array(end.offset) + by)),
        platform_point=vector3(np.array(leg.platform_point) + on_platform),
    )
