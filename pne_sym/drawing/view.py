"""Where a mechanism in space is looked at from: parallel projection, z upwards."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pne_sym.drawing.scene import LegScene, Scene
from pne_sym.model.kinematics import Array

ELEVATION = 20.0
_USUAL = -60.0
_SAMPLES = 12
_STEP = 5
_EDGE_ON = 15.0
"""Nearer (degrees) to the x or y axis, that axis is hardly seen."""


@dataclass(frozen=True)
class View:
    """A parallel projection.

    Attributes:
        right: unit vector to the right of the picture, base frame.
        up: unit vector upwards in the picture.
        toward: unit vector towards the eye.
    """

    right: Array
    up: Array
    toward: Array

    def flat(self, points: Array) -> Array:
        """Points of the picture's plane; the last dimension holds the components."""
        return np.asarray(points) @ np.column_stack([self.right, self.up])


def view_from(azimuth: float, elevation: float) -> View:
    """The view from a direction, in degrees: azimuth from x towards y, elevation from there up."""
    a, e = math.radians(azimuth), math.radians(elevation)
    toward = np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
    right = np.array([-math.sin(a), math.cos(a), 0.0])
    return View(right, np.cross(toward, right), toward)


def best_azimuth(scene: Scene, elevation: float) -> float:
    """The azimuth (degrees) from which the legs hide each other least."""
    upright = np.array([0.0, 0.0, 0.15 * scene.size]) if scene.centre is None else scene.centre
    post = np.outer(np.linspace(0.0, 1.0, _SAMPLES), upright)
    legs = [*(_sampled(leg) for leg in scene.legs), post]
    return max(range(-180, 180, _STEP), key=lambda a: _merit(legs, scene, float(a), elevation))


def _merit(legs: list[Array], scene: Scene, azimuth: float, elevation: float) -> float:
    """How far apart the legs appear; a slight preference for the usual view."""
    view = view_from(azimuth, elevation)
    flat = [view.flat(leg) for leg in legs]
    enough = 0.12 * scene.size
    total, pairs = 0.0, 0
    for i, one in enumerate(flat):
        for other in flat[:i]:
            gaps = np.linalg.norm(one[:, None] - other[None, :], axis=2)
            total += float(np.minimum(gaps.min(axis=1), enough).mean())
            pairs += 1
    off = abs((azimuth - _USUAL + 180.0) % 360.0 - 180.0) / 180.0
    edge_on = 0.1 if abs((azimuth + 45.0) % 90.0 - 45.0) < _EDGE_ON else 0.0
    return round(total / max(pairs, 1) / enough - 0.08 * off - edge_on, 9)


def _sampled(leg: LegScene) -> Array:
    """Points spread evenly along a leg."""
    points = leg.points
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    where = np.linspace(0.0, along[-1], _SAMPLES)
    return np.column_stack([np.interp(where, along, points[:, k]) for k in range(3)])
