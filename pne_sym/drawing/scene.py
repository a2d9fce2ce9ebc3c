"""What there is to see of a manipulator at a pose: joints, links and frames, by their places.

Nothing here knows of colours, views or paper: places and directions in the base frame, from the
specification's own numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pne_sym.model.kind import Look
from pne_sym.model.kinematics import TASK_SPACES, Array, base_of, chain_pose, pose_at
from pne_sym.model.loops import Loops
from pne_sym.model.manipulator import Leg, Manipulator, Space

SAME = 1e-6
"""Points nearer than this part of the mechanism's size are one point."""
_TUBE_PART = 0.55
"""How much of a slide its tube covers."""


@dataclass(frozen=True)
class Turn:
    """A joint that only turns, at one point: revolute, universal, spherical or rigid.

    Attributes:
        point: where it is.
        axes: unit vectors; one for a revolute joint, two for a universal one, else none.
        actuated: for each axis.
        extra: any of its displacements is a coordinate of its own.
        look: a pin, a cross, a ball or a block.
        massless: the link that its last axis moves has no inertia.
    """

    point: Array
    axes: tuple[Array, ...]
    actuated: tuple[bool, ...]
    extra: bool
    look: Look
    massless: bool = False


@dataclass(frozen=True)
class Slide:
    """A joint that extends: prismatic or helical.

    Attributes:
        start: its origin, on the preceding link.
        end: the origin of the link that it moves.
        axis: unit vector.
        actuated: it has an actuator.
        extra: its displacement is a coordinate of its own.
        helical: it is a screw.
        grounded: the preceding link is the base.
    """

    start: Array
    end: Array
    axis: Array
    actuated: bool
    extra: bool
    helical: bool
    grounded: bool

    @property
    def outwards(self) -> Array:
        """The axis, in the sense in which it is extended."""
        return self.axis if float((self.end - self.start) @ self.axis) >= 0.0 else -self.axis

    @property
    def mouth(self) -> Array:
        """Where the rod leaves the tube."""
        return self.start + _TUBE_PART * (self.end - self.start)


@dataclass(frozen=True)
class Bar:
    """A rigid link, or part of one, between two points."""

    start: Array
    end: Array


Part = Turn | Slide | Bar


@dataclass(frozen=True)
class LegScene:
    """A leg: its parts from the base to the platform joint, which is the last."""

    base: Array
    parts: tuple[Part, ...]

    @property
    def rail(self) -> Slide | None:
        """The joint on the base that the leg begins with, where that one extends."""
        first = self.parts[0]
        return first if isinstance(first, Slide) and first.grounded else None

    @property
    def points(self) -> Array:
        """The points that the leg passes, from the base to the platform."""
        points = [self.base]
        for part in self.parts:
            points += [part.point] if isinstance(part, Turn) else [part.start, part.end]
        return np.array(points)


@dataclass(frozen=True)
class Scene:
    """A manipulator at a pose.

    Attributes:
        planar: it moves in the plane z = 0.
        legs: in their order.
        origin: of the platform frame, in the base frame.
        frame: rotation of the platform frame.
        anchors: the platform joints' places on the platform, in the base frame.
        centre: the fixed centre of rotation, where there is one.
        size: length of the diagonal of the box around the mechanism, m.
    """

    planar: bool
    legs: tuple[LegScene, ...]
    origin: Array
    frame: Array
    anchors: Array
    centre: Array | None = None
    size: float = field(default=1.0)


def scene_of(manipulator: Manipulator, X: Sequence[float], q: Sequence[float]) -> Scene:
    """The scene at a pose that closes the loops."""
    m = manipulator
    pose = pose_at(m.space, X[: len(TASK_SPACES[m.space].pose_names)], m.fixed_centre)
    slices = Loops.of(m).slices()
    planar = m.space in (Space.POINT, Space.PLANAR)
    anchors = np.array([pose.t + pose.R @ np.array(leg.platform_point) for leg in m.legs])
    raw = [_walk(leg, q[s], pose.R, planar=planar) for leg, s in zip(m.legs, slices, strict=True)]
    points = np.vstack([leg.points for leg in raw] + [anchors])
    size = float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0
    return Scene(
        planar=planar,
        legs=tuple(LegScene(leg.base, _joined(leg.parts, SAME * size)) for leg in raw),
        origin=pose.t,
        frame=pose.R,
        anchors=anchors,
        centre=None if m.fixed_centre is None else np.array(m.fixed_centre),
        size=size,
    )


def ground_of(scenes: Sequence[Scene]) -> Scene:
    """The first of several scenes, with rails as long and a box as large as all of them need."""
    first = scenes[0]
    if len(scenes) == 1:
        return first
    points = np.vstack([leg.points for scene in scenes for leg in scene.legs])
    legs = list(first.legs)
    for index, leg in enumerate(first.legs):
        if (rail := leg.rail) is not None:
            ends = np.array([scene.legs[index].points[2] for scene in scenes])
            along = np.append((ends - rail.start) @ rail.axis, 0.0)
            low, high = (rail.start + x * rail.axis for x in (along.min(), along.max()))
            laid_out = replace(rail, start=low, end=high)
            legs[index] = replace(leg, parts=(laid_out, *leg.parts[1:]))
    size = float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0
    return replace(first, legs=tuple(legs), size=size)


def _walk(leg: Leg, q: Sequence[float], platform: Array, *, planar: bool) -> LegScene:
    """Every joint of a leg by itself, and the bars between them."""
    start = base_of(leg)
    chain = chain_pose(leg, q, start)
    parts: list[Part] = []
    for index, joint in enumerate(leg.joints):
        before = chain.points[index - 1] if index else start.t
        origin, axis = chain.origins[index], chain.axes[index]
        if any(joint.offset):
            parts.append(Bar(before, origin))
        if joint.kind.is_hinge:
            turn = (axis,), (joint.actuated,), joint.extra, joint.kind.look, joint.link.is_massless
            parts.append(Turn(origin, *turn))
        else:
            screw = joint.kind.look is Look.SCREW
            marks = joint.actuated, joint.extra, screw, index == 0
            parts.append(Slide(origin, chain.points[index], axis, *marks))
    if any(leg.platform_joint.offset):
        parts.append(Bar(chain.points[-1] if chain.points else start.t, chain.tip))
    parts.append(_platform_joint(leg, chain.tip, chain.last, platform, planar=planar))
    return LegScene(start.t, tuple(parts))


def _platform_joint(leg: Leg, tip: Array, frame: Array, platform: Array, *, planar: bool) -> Turn:
    joint = leg.platform_joint
    if planar:
        return Turn(tip, (np.array([0.0, 0.0, 1.0]),), (False,), False, Look.PIN)
    bodies = {"axis_link": frame, "axis_platform": platform}
    axes = tuple(bodies[name] @ np.array(getattr(joint, name)) for name in joint.kind.shown)
    return Turn(tip, axes, (False,) * len(axes), False, joint.kind.look)


def _joined(parts: tuple[Part, ...], near: float) -> tuple[Part, ...]:
    """Revolute joints at one point as the universal or spherical joint that they make."""
    result: list[Part] = []
    for part in parts:
        joint = _pair(result[-1], part, near) if result else None
        if joint is None:
            result.append(part)
        else:
            result[-1] = joint
    return tuple(result)


def _pair(first: Part, second: Part, near: float) -> Turn | None:
    """Two joints with a massless link between as one, or None."""
    if not (isinstance(first, Turn) and isinstance(second, Turn)):
        return None
    apart = float(np.linalg.norm(first.point - second.point)) > near
    if apart or not first.massless or second.look != Look.PIN:
        return None
    if first.look not in {Look.PIN, Look.CROSS}:
        return None
    if abs(float(first.axes[-1] @ second.axes[0])) > SAME:
        return None
    actuated, extra = first.actuated + second.actuated, first.extra or second.extra
    axes = first.axes + second.axes
    if first.look is Look.PIN:
        return Turn(first.point, axes, actuated, extra, Look.CROSS, second.massless)
    if any(actuated):
        return None
    return Turn(first.point, (), (False,), extra, Look.BALL, second.massless)
