"""Solids of a mechanism in space, as the flat shapes that they are seen as.

Every solid is convex: its outline is the hull of its points' images.  Shades are strips along
a cylinder and faces of a prism, which print well and stay small.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pne_sym.drawing.shapes import Shape, disc, hull
from pne_sym.drawing.style import Paint, mixed
from pne_sym.drawing.view import View
from pne_sym.model.kinematics import Array

LIGHT, DARK = "#ffffff", "#101820"
_SIDES = 14


@dataclass(frozen=True)
class Solid:
    """A solid as seen: shapes, and how near to the eye it is at a point of the picture.

    Attributes:
        outline: of all its shapes, convex.
        shapes: in the order of painting.
        core: one point (a ball), two (a rod) or three (a plate, by its plane).
        bias: how much nearer to the eye than its core it counts.
    """

    outline: Array
    shapes: tuple[Shape, ...]
    core: Array
    bias: float = 0.0

    def depth(self, view: View, place: Array) -> float:
        """How near to the eye the solid is where it covers a point of the picture."""
        depths = self.core @ view.toward
        if len(depths) == 1:
            return float(depths[0]) + self.bias
        flat = view.flat(self.core)
        if len(depths) == 2:
            along = flat[1] - flat[0]
            length = float(along @ along)
            t = 0.5 if length == 0.0 else float((place - flat[0]) @ along) / length
            t = min(max(t, 0.0), 1.0)
            return float(depths[0] + t * (depths[1] - depths[0])) + self.bias
        edges = (flat[1:] - flat[0]).T
        if abs(float(np.linalg.det(edges))) < 1e-12:
            return float(depths.mean()) + self.bias
        weights = np.linalg.solve(edges, place - flat[0])
        return float(depths[0] + weights @ (depths[1:] - depths[0])) + self.bias


def perpendiculars(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors perpendicular to a unit vector and to each other."""
    helper = np.eye(3)[int(np.argmin(np.abs(axis).round(6)))]  # not by rounding errors
    first = np.cross(axis, helper)
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


def cylinder(
    view: View, start: Array, end: Array, radius: float, paint: Paint, bias: float = 0.0
) -> Solid:
    """A cylinder between two points."""
    axis = end - start
    length = float(np.linalg.norm(axis))
    axis = axis / length if length > 0.0 else view.toward
    across, over = perpendiculars(axis)
    angles = np.arange(_SIDES) * (math.tau / _SIDES)
    ring = radius * (np.cos(angles)[:, None] * across + np.sin(angles)[:, None] * over)
    facing = float(axis @ view.toward)
    near = end if facing >= 0.0 else start
    outline = hull(view.flat(np.vstack([start + ring, end + ring])))
    shapes = [Shape(outline, paint.fill, paint.edge, paint.width, paint.alpha)]
    side = np.cross(axis, view.toward)
    if float(np.linalg.norm(side)) > 0.1:
        side /= np.linalg.norm(side)
        if float(view.flat(side) @ np.array([-0.5, 0.8])) < 0.0:
            side = -side
        front = np.cross(side, axis)
        front = front if front @ view.toward > 0.0 else -front
        for a, b, shade in ((0.25, 0.65, _light(paint.fill)), (-0.9, -0.45, _dark(paint.fill))):
            rows = [radius * (c * side + math.sqrt(1 - c * c) * front) for c in (a, b)]
            corners = [start + rows[0], end + rows[0], end + rows[1], start + rows[1]]
            shapes.append(Shape(view.flat(np.array(corners)), shade, "", alpha=paint.alpha))
    if abs(facing) > 0.05:
        cap = view.flat(near + ring)
        shapes.append(Shape(cap, mixed(paint.fill, LIGHT, 0.35), paint.edge, 0.6 * paint.width))
    return Solid(outline, tuple(shapes), np.array([start, end]), bias)


def ball(view: View, centre: Array, radius: float, paint: Paint, bias: float = 0.0) -> Solid:
    """A ball."""
    middle = view.flat(centre)
    outline = disc(middle, radius, 20)
    glint = disc(middle + radius * np.array([-0.28, 0.32]), 0.42 * radius, 10)
    shapes = (
        Shape(outline, paint.fill, paint.edge, paint.width),
        Shape(glint, _light(paint.fill), ""),
    )
    return Solid(outline, shapes, centre[None, :], radius + bias)


def prism(
    view: View,
    face: Array,
    thickness: Array,
    paint: Paint,
    bias: float = 0.0,
    *,
    ground: bool = False,
) -> Solid:
    """A plate: a convex polygon in space, thickened by a vector on its far side."""
    normal = thickness / np.linalg.norm(thickness)
    shown = face if normal @ view.toward >= 0.0 else face - thickness
    outline = hull(view.flat(np.vstack([face, face - thickness])))
    shapes = (
        Shape(outline, _dark(paint.fill), paint.edge, paint.width, paint.alpha, ground=ground),
        Shape(
            view.flat(shown), paint.fill, paint.edge, 0.6 * paint.width, paint.alpha, ground=ground
        ),
    )
    middle = face.mean(axis=0) - 0.5 * thickness
    across, over = perpendiculars(normal)
    return Solid(outline, shapes, np.array([middle, middle + across, middle + over]), bias)


def box(view: View, centre: Array, halves: tuple[Array, Array, Array], paint: Paint) -> Solid:
    """A box by its half edges."""
    signs = np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)], dtype=float)
    corners = centre + signs @ np.array(halves)
    outline = hull(view.flat(corners))
    shapes = []
    for k, half in enumerate(halves):
        out = half if half @ view.toward >= 0.0 else -half
        a, b = halves[(k + 1) % 3], halves[(k + 2) % 3]
        face = centre + out + np.array([a + b, a - b, -a - b, b - a])
        up = float(out @ view.up) / float(np.linalg.norm(out))
        shade = _light(paint.fill) if up > 0.6 else _dark(paint.fill) if k == 0 else paint.fill
        shapes.append(Shape(view.flat(face), shade, paint.edge, 0.6 * paint.width))
    shapes.append(Shape(outline, "", paint.edge, paint.width))
    reach = max(float(np.linalg.norm(half)) for half in halves)
    return Solid(outline, tuple(shapes), centre[None, :], bias=0.5 * reach)


def _light(colour: str) -> str:
    return mixed(colour, LIGHT, 0.5)


def _dark(colour: str) -> str:
    return mixed(colour, DARK, 0.22)
