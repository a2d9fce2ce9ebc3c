"""Colours and proportions of all pictures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pne_sym.drawing.scene import SAME, Scene

OUTLINE = "#25313d"
LINK = "#aebccb"
TUBE = "#8398ad"
JOINT = "#f1f4f7"
ACTUATED = "#f08a24"
EXTRA = "#1d9a50"
BASE = "#d6d0c4"
PLATFORM = "#5b9bd5"
GROUND = "#6b6459"
LABEL = "#45525f"
AXES = ("#c8342b", "#2b8a3e", "#2b5fc8")
LETTERS = ("x", "y", "z")

LINE = 0.6
MARKED = 1.9
"""Width of the edge of a joint whose displacement is an extra coordinate."""


@dataclass(frozen=True)
class Paint:
    """How something is painted: fill, edge, width of the edge, opacity."""

    fill: str
    edge: str = OUTLINE
    width: float = LINE
    alpha: float = 1.0


@dataclass(frozen=True)
class Proportions:
    """Lengths in m.

    Attributes:
        joint: radius of a joint.
        link: half the thickness of a link.
        axis: length of a frame's arrows.
        apart: the smallest distance of two base points.
    """

    joint: float
    link: float
    axis: float
    apart: float


def proportions(scene: Scene) -> Proportions:
    """Joints as large as legibility wants, and smaller where they stand close together."""
    size = scene.size
    large, small = (0.021, 0.0145) if scene.planar else (0.0175, 0.0115)
    bases = np.array([leg.base for leg in scene.legs])
    gaps = np.linalg.norm(bases[:, None] - bases[None, :], axis=2)
    apart = gaps[gaps > SAME * size]
    closest = float(apart.min()) if apart.size else size
    joint = float(np.clip(0.3 * closest, small * size, large * size))
    return Proportions(joint=joint, link=0.55 * joint, axis=0.13 * size, apart=closest)


def mixed(colour: str, other: str, part: float) -> str:
    """A colour with a part of another."""
    pairs = zip(bytes.fromhex(colour[1:]), bytes.fromhex(other[1:]), strict=True)
    return "#" + "".join(f"{round((1 - part) * a + part * b):02x}" for a, b in pairs)


def joint_paint(*, actuated: bool, extra: bool) -> Paint:
    """How a joint is painted."""
    fill = ACTUATED if actuated else JOINT
    return Paint(fill, EXTRA, MARKED) if extra else Paint(fill)
