"""Where the legs stand: evenly around the platform."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pne_sym.model.legs import is_plane
from pne_sym.model.manipulator import Space
from pne_sym.model.rotation import rotation_from_rpy
from pne_sym.starter.choose import Shape, reshaped
from pne_sym.starter.notation import LegGroup

Plain = dict[str, object]

HEIGHT = 0.75
RADIUS = {True: 0.18, False: 0.3}
LOW = -0.02
DIGITS = 9


@dataclass(frozen=True)
class Placed:
    """A leg's table, without its joints, and its displacements at home."""

    table: Plain
    q: tuple[float, ...]


def leg_names(groups: tuple[LegGroup, ...]) -> list[str]:
    """A name for the leg type of each group."""
    names: list[str] = []
    for group in groups:
        stem, number = group.plain.lower(), 1
        while (name := stem if number == 1 else f"{stem}_{number}") in names:
            number += 1
        names.append(name)
    return names


def place_legs(
    groups: tuple[LegGroup, ...],
    shapes: tuple[Shape, ...],
    space: Space,
    *,
    tilt: float,
    mirror: bool,
) -> list[Placed]:
    """The tables of all legs, without their joints, and `q` of each."""
    plane = is_plane(space)
    total = sum(group.count for group in groups)
    result: list[Placed] = []
    index = 0
    for name, group, shape in zip(leg_names(groups), groups, shapes, strict=True):
        for _ in range(group.count):
            odd = mirror and index % 2 == 1
            own = reshaped(shape, mirrored=odd, plane=plane, platform=group.platform)
            azimuth = _azimuth(index, total, space)
            leg: Plain = {"type": name, **_placed(own, space, azimuth, tilt)}
            result.append(Placed(leg, own.home))
            index += 1
    return result


def _azimuth(index: int, total: int, space: Space) -> float:
    """Direction of a leg's platform point from the middle of the platform, degrees."""
    if is_plane(space):
        return {1: 270.0, 2: 225.0 + 90.0 * index}.get(total, 90.0 + 360.0 * index / total)
    if total >= 6 and total % 2 == 0:
        middle = 360.0 * (2 * (index // 2) + 0.5) / total
        return middle + (115.2 if index % 2 else -115.2) / total
    return 360.0 * index / total


def _placed(shape: Shape, space: Space, azimuth: float, tilt: float) -> Plain:
    """Base point, base frame and platform point of one leg."""
    plane = is_plane(space)
    radius = 0.0 if space is Space.POINT else RADIUS[plane]
    a = math.radians(azimuth)
    point = np.array([radius * math.cos(a), radius * math.sin(a), 0.0 if plane else LOW])
    rpy = (0.0, 0.0, azimuth + 180.0 + tilt) if plane else (-90.0, -90.0, azimuth)
    rpy = (rpy[0], rpy[1], round(math.remainder(rpy[2], 360.0), 6))
    frame = np.array(rotation_from_rpy(rpy, degrees=True))
    origin = np.array([0.0, 0.0, 0.0 if plane else HEIGHT])
    point = np.round(point, DIGITS)
    base = np.round(origin + point - frame @ shape.tip, DIGITS)
    size = 2 if plane else 3
    leg: Plain = {
        "base_point": (base + 0.0).tolist()[:size],
        "base_frame": {"rpy_deg": list(rpy)},
    }
    if space is not Space.POINT:
        leg["platform_point"] = (point + 0.0).tolist()[:size]
    if shape.axis_link:
        axis = np.round(frame @ shape.axis_leg, DIGITS) + 0.0
        leg["platform_joint"] = {"axis_platform": axis.tolist()}
    return leg
