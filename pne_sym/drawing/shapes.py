"""Flat shapes in the order of painting: what a picture is made of before it is on paper."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from pne_sym.model.kinematics import Array


@dataclass(frozen=True)
class Shape:
    """A polygon or a line.

    Attributes:
        points: n x 2, m in the picture's plane.
        fill: colour; empty: none.
        edge: colour; empty: none.
        width: of the edge, in typographic points.
        alpha: opacity of the fill.
        closed: a polygon, else an open line.
        ground: labels may stand on it.
    """

    points: Array
    fill: str = ""
    edge: str = ""
    width: float = 0.7
    alpha: float = 1.0
    closed: bool = True
    ground: bool = False


@dataclass(frozen=True)
class Label:
    """A short text.

    Attributes:
        point: where, m in the picture's plane.
        text: the text.
        shift: from the point to the text's middle, in typographic points.
        colour: of the text.
        size: of the text, in typographic points.
        balloon: it stands in a circle, and gives way to shapes and other labels.
    """

    point: Array
    text: str
    shift: tuple[float, float] = (0.0, 0.0)
    colour: str = "#333333"
    size: float = 8.0
    balloon: bool = False


@dataclass(frozen=True)
class Picture:
    """Shapes in the order of painting, labels above them, and what the legend explains.

    Attributes:
        shapes: later ones cover earlier ones.
        labels: above all shapes.
        legend: pairs of (fill, edge) and what they mean.
    """

    shapes: tuple[Shape, ...]
    labels: tuple[Label, ...]
    legend: tuple[tuple[str, str, str], ...]


def hull(points: Array) -> Array:
    """The convex hull of points in the plane, counter-clockwise (Andrew's monotone chain)."""
    ordered = sorted({(float(x), float(y)) for x, y in points})
    if len(ordered) < 3:
        return np.array(ordered)

    def half(sequence: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
        chain: list[tuple[float, float]] = []
        for point in sequence:
            while len(chain) >= 2 and _turn(chain[-2], chain[-1], point) <= 0:
                chain.pop()
            chain.append(point)
        return chain[:-1]

    return np.array(half(ordered) + half(reversed(ordered)))


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def disc(centre: Array, radius: float, sides: int = 24) -> Array:
    """The corners of a regular polygon that stands for a circle."""
    angles = np.arange(sides) * (math.tau / sides)
    return centre + radius * np.column_stack([np.cos(angles), np.sin(angles)])


def rounded(points: Array, radius: float, sides: int = 24) -> Array:
    """The convex hull of circles about points: a polygon with round corners."""
    return hull(np.vstack([disc(point, radius, sides) for point in points]))


def strip(start: Array, end: Array, half: float) -> Array:
    """A rectangle along a line."""
    across = half * across_of(end - start)
    return np.array([start + across, end + across, end - across, start - across])


def across_of(direction: Array) -> Array:
    """The unit vector a quarter turn from a direction; of no direction: upwards."""
    length = float(np.linalg.norm(direction))
    if length == 0.0:
        return np.array([0.0, 1.0])
    return np.array([-direction[1], direction[0]]) / length
