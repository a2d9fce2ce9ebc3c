"""Where labels stand on the page: clear of shapes and of each other, as near as that allows."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pne_sym.drawing.shapes import Label, Picture

Array = NDArray[np.float64]

BALLOON = 6.0
"""Radius of the circle about a label, in typographic points."""
_CLEARANCE = BALLOON + 0.8
_APART = 13.5
_RINGS = (5.0, 10.0, 15.0, 20.0, 26.0)
_DIRECTIONS = 12
_OTHER_LABEL = 3.0


def label_places(picture: Picture, scale: float, shift: Array) -> list[Array]:
    """Places on the page: a balloon moves to where it covers least, a little at most."""
    shapes = [shape for shape in picture.shapes if not shape.ground]
    outlines = [shape.points * scale + shift for shape in shapes]
    wanted = [label.point * scale + shift + np.array(label.shift) for label in picture.labels]
    fixed = zip(picture.labels, wanted, strict=True)
    taken = [place for label, place in fixed if not label.balloon]
    places = []
    for label, place in zip(picture.labels, wanted, strict=True):
        found = _clear(label, place, outlines, taken)
        if label.balloon:
            taken.append(found)
        places.append(found)
    return places


def _clear(label: Label, place: Array, outlines: list[Array], taken: list[Array]) -> Array:
    """The nearest place that covers nothing, or else least."""
    if not label.balloon:
        return place
    lows = np.array([outline.min(axis=0) for outline in outlines]) - _CLEARANCE
    highs = np.array([outline.max(axis=0) for outline in outlines]) + _CLEARANCE
    best, least = place, math.inf
    for candidate in _candidates(place, np.array(label.shift)):
        near = np.flatnonzero(((lows < candidate) & (candidate < highs)).all(axis=1))
        cost = float(sum(_covers(candidate, outlines[k]) for k in near))
        cost += _OTHER_LABEL * sum(
            float(np.linalg.norm(candidate - other)) < _APART for other in taken
        )
        if cost < least:
            best, least = candidate, cost
        if cost == 0.0:
            break
    return best


def _candidates(place: Array, shift: Array) -> list[Array]:
    """The place itself, then rings about it, each from the side the label was shifted to."""
    start = math.atan2(shift[1], shift[0])
    found = [place]
    for radius in _RINGS:
        for k in range(_DIRECTIONS):
            turn = (k + 1) // 2 * (1 if k % 2 else -1)
            angle = start + turn * math.tau / _DIRECTIONS
            found.append(place + radius * np.array([math.cos(angle), math.sin(angle)]))
    return found


def _covers(centre: Array, outline: Array) -> bool:
    """Whether a balloon touches a shape's edge or lies within it."""
    steps = np.roll(outline, -1, axis=0) - outline
    lengths = np.maximum((steps * steps).sum(axis=1), 1e-12)
    along = np.clip(((centre - outline) * steps).sum(axis=1) / lengths, 0.0, 1.0)
    gaps = outline + along[:, None] * steps - centre
    if float((gaps * gaps).sum(axis=1).min()) < _CLEARANCE**2:
        return True
    after = outline + steps - centre
    before = outline - centre
    crosses = (before[:, 1] > 0.0) != (after[:, 1] > 0.0)
    turns = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return bool(np.sum(crosses & ((turns > 0.0) == (after[:, 1] > before[:, 1]))) % 2)
