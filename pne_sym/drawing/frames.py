"""What carries the legs and what they carry, in space: base plate, platform, and their frames."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pne_sym.drawing.scene import SAME, Scene
from pne_sym.drawing.shapes import Label, Shape, hull, rounded
from pne_sym.drawing.solids import Solid, ball, cylinder, perpendiculars, prism
from pne_sym.drawing.style import AXES, BASE, JOINT, LETTERS, LINK, PLATFORM, Paint, Proportions
from pne_sym.drawing.view import View
from pne_sym.model.kinematics import Array

_FLAT = 0.1
"""Feet nearer to a plane than this part of their lesser spread in it stand on one plate."""
_BAR = 0.02
"""Anchors nearer to a line than this part of their spread lie on it."""


@dataclass(frozen=True)
class Plate:
    """The base: its solids, the direction from it to the platform, and where its top is."""

    solids: tuple[Solid, ...]
    normal: Array
    top: float


def base_plate(scene: Scene, view: View, sizes: Proportions) -> Plate:
    """The plate under the base points, a post on it for each leg; posts alone if it is not flat."""
    r = sizes.joint
    bases = np.array([leg.base for leg in scene.legs])
    toward = scene.anchors.mean(axis=0) - bases.mean(axis=0)
    normal, off = _plane(bases, toward, scene.size)
    feet = np.vstack([bases, *_rail_ends(scene, normal)])
    top = float((feet @ normal).min()) - 3.0 * r
    paint, solids = Paint(BASE), []
    if off > _FLAT * _lesser_spread(bases) + 3.0 * r:
        top = -np.inf
        pads = [(base, base - 2.5 * r * normal) for base in bases]
    else:
        face = _outline(feet, normal, 4.0 * r, top)
        solids.append(prism(view, face, 1.6 * r * normal, paint, bias=-6.0 * r, ground=True))
        pads = [(base, base - (float(base @ normal) - top) * normal) for base in bases]
    for (base, pad), leg in zip(pads, scene.legs, strict=True):
        if leg.rail is None:
            solids.append(cylinder(view, pad, base, 1.15 * r, paint, -0.5 * r))
    if scene.centre is not None and np.isfinite(top):
        solids += _pivot(scene.centre, normal, top, view, r)
    return Plate(tuple(solids), normal, top)


def _pivot(centre: Array, normal: Array, top: float, view: View, r: float) -> list[Solid]:
    """The post that holds a fixed centre of rotation."""
    pad = centre - (float(centre @ normal) - top) * normal
    post = cylinder(view, pad, centre, 1.3 * r, Paint(BASE), -0.5 * r)
    return [post, ball(view, centre, 1.5 * r, Paint(JOINT))]


def _rail_ends(scene: Scene, normal: Array) -> list[Array]:
    """Points under the ends of rails that lie flat."""
    rails = (leg.rail for leg in scene.legs if leg.rail is not None)
    flat = (rail for rail in rails if abs(float(rail.axis @ normal)) < 0.2)
    return [np.array([rail.start, rail.end]) for rail in flat]


def platform_plate(scene: Scene, view: View, sizes: Proportions, normal: Array) -> list[Solid]:
    """The platform through the points where the legs hold it: a plate, a bar or a point."""
    r, anchors = sizes.joint, scene.anchors
    spread = np.ptp(anchors, axis=0)
    paint = Paint(PLATFORM, alpha=0.88)
    if float(np.linalg.norm(spread)) < SAME * scene.size:
        return [ball(view, anchors[0], 1.8 * r, Paint(PLATFORM), 3.0 * r)]
    _, values, vt = np.linalg.svd(anchors - anchors.mean(axis=0))
    if len(anchors) < 3 or values[1] < _BAR * values[0]:
        along = (anchors - anchors[0]) @ vt[0]
        ends = anchors[int(along.argmin())], anchors[int(along.argmax())]
        return [cylinder(view, ends[0], ends[1], 1.2 * r, paint)]
    up, _ = _plane(anchors, normal, scene.size)
    level = float((anchors @ up).mean())
    top = level + 0.6 * r
    solids = [prism(view, _outline(anchors, up, 1.2 * r, top), 1.2 * r * up, paint)]
    for anchor in anchors:
        off = float(anchor @ up) - top + 0.6 * r
        if abs(off) > 2.0 * r:
            solids.append(cylinder(view, anchor, anchor - off * up, 0.6 * r, Paint(LINK)))
    if (centre := scene.centre) is not None:  # the legs hold it beside the plane of the centre
        foot = centre - (float(centre @ up) - level) * up
        solids.append(cylinder(view, foot, centre, r, paint))
    return solids


def frame_solids(scene: Scene, view: View, sizes: Proportions) -> tuple[list[Solid], list[Label]]:
    """The arrows of the base frame and of the platform frame, and the base frame's letters."""
    solids: list[Solid] = []
    labels: list[Label] = []
    bases = np.array([leg.base for leg in scene.legs])
    reach = np.abs(bases).max() if np.isfinite(bases).all() else 0.0
    if reach < 2.0 * scene.size:
        for k in range(3):
            tip = sizes.axis * np.eye(3)[k]
            solids.append(arrow(view, np.zeros(3), tip, AXES[k]))
            labels.append(_letter(view, tip, np.zeros(3), LETTERS[k], AXES[k]))
    for k in range(3):
        tip = scene.origin + 0.8 * sizes.axis * scene.frame[:, k]
        solids.append(arrow(view, scene.origin, tip, AXES[k], bias=2.5 * sizes.joint))
    return solids, labels


def arrow(view: View, start: Array, end: Array, colour: str, bias: float = 0.0) -> Solid:
    """A thin arrow."""
    a, b = view.flat(start), view.flat(end)
    length = float(np.linalg.norm(end - start))
    along = b - a
    flat = float(np.linalg.norm(along))
    along = along / flat if flat > 0.05 * length else np.zeros(2)
    across = np.array([-along[1], along[0]])
    head = min(0.24 * length, flat)
    barb = np.array(
        [b, b - head * along + 0.4 * head * across, b - head * along - 0.4 * head * across]
    )
    shapes = (
        Shape(np.array([a, b - 0.8 * head * along]), "", colour, 1.5, closed=False),
        Shape(barb, colour, colour, 0.4),
    )
    outline = hull(np.vstack([a + 0.02 * length * across, a - 0.02 * length * across, barb]))
    return Solid(outline, shapes, np.array([start, end]), bias)


def _letter(view: View, tip: Array, origin: Array, letter: str, colour: str) -> Label:
    along = view.flat(tip) - view.flat(origin)
    length = float(np.linalg.norm(along)) or 1.0
    x, y = along / length
    return Label(view.flat(tip), letter, (6.0 * x, 6.0 * y), colour, 8.0)


def _plane(points: Array, toward: Array, size: float) -> tuple[Array, float]:
    """The unit normal of the plane nearest to points, on a given side, and the largest distance.

    Where the points lie on a line, the plane is that nearest to perpendicular to `toward`.
    """
    middle = points.mean(axis=0)
    _, values, vt = np.linalg.svd(points - middle)
    if len(points) < 3 or values[1] < 1e-3 * size:
        line = vt[0] if values[0] > SAME * size else np.zeros(3)
        normal = toward - (toward @ line) * line
        length = float(np.linalg.norm(normal))
        normal = normal / length if length > SAME * size else np.array([0.0, 0.0, 1.0])
    else:
        normal = vt[2] if float(vt[2] @ toward) >= 0.0 else -vt[2]
    return normal, float(np.abs((points - middle) @ normal).max())


def _lesser_spread(points: Array) -> float:
    """How far points spread across the direction in which they spread most, in their plane."""
    _, _, vt = np.linalg.svd(points - points.mean(axis=0))
    return float(np.ptp(points @ vt[1]))


def _outline(points: Array, normal: Array, margin: float, level: float) -> Array:
    """The corners, in a plane, of the rounded hull of points' shadows on it."""
    across, over = perpendiculars(normal)
    corners = rounded(points @ np.column_stack([across, over]), margin)
    outline: Array = level * normal + corners @ np.array([across, over])
    return outline
