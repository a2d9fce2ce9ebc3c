"""A mechanism in the plane as a picture, with the symbols of kinematic diagrams."""

from __future__ import annotations

import numpy as np

from pne_sym.drawing import style
from pne_sym.drawing.scene import SAME, Bar, LegScene, Part, Scene, Slide, Turn
from pne_sym.drawing.shapes import Label, Picture, Shape, across_of, disc, hull, rounded, strip
from pne_sym.model.kinematics import Array

_HATCHES = 6
_ARROWS = (1.3, 1.0, 1.6, 0.7)
"""Lengths of the base frame's arrows to choose from: the first that ends beside no joint."""


def planar_picture(scene: Scene, ground: Scene) -> Picture:
    """The picture of a mechanism in the plane.

    Args:
        scene: the mechanism.
        ground: the scene that the base is laid out for.
    """
    sizes = style.proportions(ground)
    base, labels = _bearings(ground, sizes), []
    for number, leg in enumerate(ground.legs, start=1):
        if leg.rail is not None:
            base += _rail(leg.rail, _beside(leg.rail, leg), sizes)
        labels.append(_number(number, leg, sizes))
    parts = [part for leg in scene.legs for part in leg.parts]
    bars = [shape for part in parts for shape in _bar(part, sizes)]
    joints = [shape for part in parts for shape in _joint(part, sizes)]
    platform, (frames, letters) = _platform(scene, sizes), _base_frame(ground, sizes)
    ordered = [*frames, *base, *platform, *bars, *joints, *_platform_frame(scene, sizes)]
    return Picture(tuple(ordered), (*letters, *labels), ())


def _down(leg: LegScene) -> Array:
    """The direction, of four, in which the base lies as seen from the leg."""
    points = leg.points[:, :2]
    away = points[0] - points.mean(axis=0)
    k = int(np.argmax(np.abs(away) * np.array([0.8, 1.0])))
    result = np.zeros(2)
    result[k] = 1.0 if away[k] > 0.0 else -1.0
    return result


def _bearings(scene: Scene, sizes: style.Proportions) -> list[Shape]:
    """Bearings fixed to the ground; those that stand close together share one block."""
    groups: list[tuple[Array, list[Array]]] = []
    for leg in scene.legs:
        if leg.rail is not None:
            continue
        point, down = leg.base[:2], _down(leg)
        for _, points in groups:
            close = min(float(np.linalg.norm(point - known)) for known in points)
            if close < 6.0 * sizes.joint:
                points.append(point)
                break
        else:
            groups.append((down, [point]))
    return [shape for down, points in groups for shape in _bearing(points, down, sizes)]


def _bearing(points: list[Array], down: Array, sizes: style.Proportions) -> list[Shape]:
    """A bearing fixed to the ground, for one joint or several."""
    r, side = sizes.joint, across_of(down)
    level = max(float(point @ down) for point in points) + 3.0 * r
    along = [float(point @ side) for point in points]
    left, right = min(along) * side + level * down, max(along) * side + level * down
    feet = np.array([left - 2.2 * r * side, right + 2.2 * r * side])
    block = hull(np.vstack([*(disc(point, 1.5 * r) for point in points), feet]))
    return [
        *_hatching(feet[0] - r * side, feet[1] + r * side, down, r),
        Shape(block, style.BASE, style.OUTLINE, style.LINE),
    ]


def _hatching(start: Array, end: Array, down: Array, r: float) -> list[Shape]:
    """A line of the ground with hatches below."""
    along = end - start
    length = float(np.linalg.norm(along))
    count = max(_HATCHES, round(length / (1.1 * r)))
    unit = along / length
    shapes = []
    for k in range(count):
        top = start + (k + 0.7) / count * along
        line = np.array([top, top + 1.1 * r * (down - 0.8 * unit)])
        shapes.append(Shape(line, "", style.GROUND, 0.8, closed=False))
    return [*shapes, Shape(np.array([start, end]), "", style.OUTLINE, 1.4, closed=False)]


def _beside(slide: Slide, leg: LegScene) -> Array:
    """Unit vector across a rail, away from the leg."""
    across = across_of(slide.axis[:2])
    rest = leg.points[:, :2].mean(axis=0) - slide.end[:2]
    return -across if float(rest @ across) > 0.0 else across


def _rail(slide: Slide, down: Array, sizes: style.Proportions) -> list[Shape]:
    """A rail on the ground."""
    r = sizes.joint
    start, end, sense = slide.start[:2], slide.end[:2], slide.outwards[:2]
    a, b = start - 2.5 * r * sense + 1.9 * r * down, end + 6.0 * r * sense + 1.9 * r * down
    return _hatching(a, b, down, r)


def _bar(part: Part, sizes: style.Proportions) -> list[Shape]:
    """Links, tubes and rods."""
    r = sizes.joint
    if isinstance(part, Turn) or (isinstance(part, Slide) and part.grounded):
        return []
    start, end = part.start[:2], part.end[:2]
    if isinstance(part, Bar):
        return [
            Shape(rounded(np.array([start, end]), 0.75 * r), style.LINK, style.OUTLINE, style.LINE)
        ]
    mouth = part.mouth[:2]
    return [
        Shape(rounded(np.array([mouth, end]), 0.5 * r, 16), style.LINK, style.OUTLINE, style.LINE),
        Shape(strip(start, mouth, 1.05 * r), style.TUBE, style.OUTLINE, style.LINE),
    ]


def _joint(part: Part, sizes: style.Proportions) -> list[Shape]:
    """The symbol of a joint."""
    r = sizes.joint
    if isinstance(part, Bar):
        return []
    if isinstance(part, Turn):
        paint = style.joint_paint(actuated=any(part.actuated), extra=part.extra)
        point = part.point[:2]
        pin = Shape(disc(point, 0.28 * r, 12), style.OUTLINE, "")
        return [Shape(disc(point, 1.05 * r), paint.fill, paint.edge, max(paint.width, 0.9)), pin]
    paint = style.joint_paint(actuated=part.actuated, extra=part.extra)
    axis, end = part.axis[:2], part.end[:2]
    if part.grounded:
        body = strip(end - 2.6 * r * axis, end + 2.6 * r * axis, 1.9 * r)
    else:
        mouth, sense = part.mouth[:2], part.outwards[:2]
        body = strip(mouth - 2.8 * r * sense, mouth + 0.4 * r * sense, 1.5 * r)
    return [Shape(body, paint.fill, paint.edge, paint.width)]


def _platform(scene: Scene, sizes: style.Proportions) -> list[Shape]:
    """The platform through the points where the legs hold it, and its own origin."""
    r, origin = sizes.joint, scene.origin[:2]
    points = np.vstack([scene.anchors[:, :2], origin])
    if float(np.linalg.norm(np.ptp(points, axis=0))) < SAME * scene.size:
        return [Shape(disc(origin, 1.9 * r), style.PLATFORM, style.OUTLINE, style.LINE)]
    return [
        Shape(
            rounded(points, 1.6 * r),
            style.mixed(style.PLATFORM, "#ffffff", 0.3),
            style.OUTLINE,
            style.LINE,
        )
    ]


def _base_frame(scene: Scene, sizes: style.Proportions) -> tuple[list[Shape], list[Label]]:
    """The arrows of the base frame with their letters, unless it lies far away."""
    shapes: list[Shape] = []
    labels: list[Label] = []
    if float(np.abs(np.array([leg.base for leg in scene.legs])).max()) > 2.0 * scene.size:
        return shapes, labels
    points = np.vstack([leg.points[:, :2] for leg in scene.legs])
    for k in range(2):
        beside = -7.0 * np.eye(2)[1 - k]
        for length in _ARROWS:
            tip = length * sizes.axis * np.eye(2)[k]
            if float(np.linalg.norm(points - tip, axis=1).min()) > 4.0 * sizes.joint:
                break
        shapes += _arrow(np.zeros(2), tip, style.AXES[k])
        labels.append(
            Label(tip, style.LETTERS[k], (float(beside[0]), float(beside[1])), style.AXES[k])
        )
    return shapes, labels


def _platform_frame(scene: Scene, sizes: style.Proportions) -> list[Shape]:
    """The arrows of the platform frame, where the platform is more than a point."""
    if float(np.linalg.norm(np.ptp(scene.anchors, axis=0))) < SAME * scene.size:
        return []
    origin = scene.origin[:2]
    arrows = [
        shape
        for k in range(2)
        for shape in _arrow(origin, origin + 0.55 * sizes.axis * scene.frame[:2, k], style.AXES[k])
    ]
    return [*arrows, Shape(disc(origin, 0.3 * sizes.joint, 12), style.OUTLINE, "")]


def _arrow(start: Array, end: Array, colour: str) -> list[Shape]:
    along = end - start
    across = across_of(along) * float(np.linalg.norm(along))
    head = np.array([end, end - 0.22 * along + 0.09 * across, end - 0.22 * along - 0.09 * across])
    line = np.array([start, end - 0.2 * along])
    return [Shape(line, "", colour, 1.5, closed=False), Shape(head, colour, colour, 0.4)]


def _number(number: int, leg: LegScene, sizes: style.Proportions) -> Label:
    """The leg's number beside its base, where the leg itself is not."""
    rail, r = leg.rail, sizes.joint
    if rail is not None:
        sense = rail.outwards[:2]
        point, side = rail.start[:2] - 2.5 * r * sense + 2.4 * r * _beside(rail, leg), -sense
    else:
        down = _down(leg)
        side = across_of(down)
        away = leg.points[:, :2].mean(axis=0) - leg.base[:2]
        side = -side if float(away @ side) > 0.0 else side
        point = leg.base[:2] + 1.8 * r * side + 0.6 * r * down
    x, y = 10.0 * side
    return Label(point, str(number), (float(x), float(y)), style.LABEL, 7.0, balloon=True)
