"""Where labels stand on the page: clear of shapes and of each other, as near as that allows."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pne_sym.drawing.shapes import Label, Picture
from pne_sym.model.kinematics import Array

BALLOON = 6.0
"""Least radius of the circle about a label, in typographic points."""
_WITHIN = 0.9
"""Between a text's corners and the circle about it."""
_OFF = 0.8
_APART = 1.5
_RINGS = (5.0, 10.0, 15.0, 20.0, 26.0)
_DIRECTIONS = 12
_OTHER_LABEL = 3.0


@dataclass(frozen=True)
class Page:
    """Where labels may stand, in typographic points.

    Attributes:
        low, high: corners; every label lies between them as a whole.
        taken: polygons to keep clear of, such as the legend.
    """

    low: Array
    high: Array
    taken: tuple[Array, ...] = ()


def extent(label: Label, text: tuple[float, float]) -> Array:
    """Half the width and half the height of a label; `text`: width and height of its text."""
    if not label.balloon:
        return 0.5 * np.array(text)
    return np.full(2, max(BALLOON, 0.5 * math.hypot(*text) + _WITHIN))


def label_places(
    picture: Picture, scale: float, shift: Array, extents: list[Array], page: Page
) -> list[Array]:
    """Places on the page: a balloon moves to where it covers least, a little at most.

    Args:
        picture: the shapes and the labels.
        scale: typographic points of a metre in the picture's plane.
        shift: the page's point at which the plane's origin lies.
        extents: half the width and half the height of each label.
        page: which no label leaves.
    """
    shapes = [shape for shape in picture.shapes if not shape.ground]
    outlines = [shape.points * scale + shift for shape in shapes] + list(page.taken)

    def inside(place: Array, e: Array) -> Array:
        return np.clip(place, page.low + e, page.high - e)

    labels = list(zip(picture.labels, extents, strict=True))
    places = [inside(each.point * scale + shift + each.shift, e) for each, e in labels]
    fixed = [k for k, (label, _) in enumerate(labels) if not label.balloon]
    taken = [(places[k], max(BALLOON, float(extents[k].max()))) for k in fixed]
    for k, (label, e) in enumerate(labels):
        if label.balloon:
            candidates = [inside(each, e) for each in _candidates(places[k], label.shift)]
            places[k] = _clear(candidates, float(e[0]), outlines, taken)
            taken.append((places[k], float(e[0])))
    return places


def _clear(
    candidates: list[Array], radius: float, outlines: list[Array], taken: list[tuple[Array, float]]
) -> Array:
    """The first place at which a balloon covers nothing, or else least."""
    clearance = radius + _OFF
    lows = np.array([outline.min(axis=0) for outline in outlines]) - clearance
    highs = np.array([outline.max(axis=0) for outline in outlines]) + clearance
    best, least = candidates[0], math.inf
    for candidate in candidates:
        near = np.flatnonzero(((lows < candidate) & (candidate < highs)).all(axis=1))
        cost = float(sum(_covers(candidate, clearance, outlines[k]) for k in near))
        cost += _OTHER_LABEL * sum(
            float(np.linalg.norm(candidate - other)) < radius + reach + _APART
            for other, reach in taken
        )
        if cost < least:
            best, least = candidate, cost
        if cost == 0.0:
            break
    return best


def _candidates(place: Array, shift: tuple[float, float]) -> list[Array]:
    """The place itself, then rings about it, each from the side the label was shifted to."""
    start = math.atan2(shift[1], shift[0])
    found = [place]
    for radius in _RINGS:
        for k in range(_DIRECTIONS):
            turn = (k + 1) // 2 * (1 if k % 2 else -1)
            angle = start + turn * math.tau / _DIRECTIONS
            found.append(place + radius * np.array([math.cos(angle), math.sin(angle)]))
    return found


def _covers(centre: Array, clearance: float, outline: Array) -> bool:
    """Whether a balloon touches a shape's edge or lies within it."""
    steps = np.roll(outline, -1, axis=0) - outline
    lengths = np.maximum((steps * steps).sum(axis=1), 1e-12)
    along = np.clip(((centre - outline) * steps).sum(axis=1) / lengths, 0.0, 1.0)
    gaps = outline + along[:, None] * steps - centre
    if float((gaps * gaps).sum(axis=1).min()) < clearance**2:
        return True
    after = outline + steps - centre
    before = outline - centre
    crosses = (before[:, 1] > 0.0) != (after[:, 1] > 0.0)
    turns = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return bool(np.sum(crosses & ((turns > 0.0) == (after[:, 1] > before[:, 1]))) % 2)
