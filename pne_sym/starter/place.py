"""Where the legs stand: evenly around the platform."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from pne_sym.model.kinematics import rotation_about
from pne_sym.model.legs import is_plane
from pne_sym.model.manipulator import Space
from pne_sym.model.rotation import rotation_from_rpy
from pne_sym.starter.chain import Plain, scaled
from pne_sym.starter.choose import Shape, reshaped
from pne_sym.starter.notation import LegGroup, fault, is_guide
from pne_sym.starter.points import Points

HEIGHT = 0.75
RADIUS = {True: 0.18, False: 0.3}
LOW = -0.02
CORNER = 54.735610317
"""Angle (degrees) of the edges of a cube from its diagonal: axes so placed are orthogonal."""
_UPRIGHT = 1e-9
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
    points: Points | None = None,
) -> list[Placed]:
    """The tables of all legs, without their joints, and `q` of each.

    Where points are given, legs are turned towards them; `q` then is a first guess.
    """
    plane = is_plane(space)
    total = sum(group.count for group in groups if not is_guide(group, groups))
    result: list[Placed] = []
    index = 0
    for name, group, shape in zip(leg_names(groups), groups, shapes, strict=True):
        for _ in range(group.count):
            odd = mirror and index % 2 == 1 and not is_guide(group, groups)
            own = reshaped(shape, mirrored=odd, plane=plane, platform=group.platform)
            if points:
                leg = _between(own, points, len(result), space)
            elif is_guide(group, groups):
                leg = _central(own)
            else:
                leg = _placed(own, space, _azimuth(index, total, space), tilt)
                index += 1
            result.append(Placed({"type": name, **leg}, own.home))
    return result


def _azimuth(index: int, total: int, space: Space) -> float:
    """Direction of a leg's platform point from the middle of the platform, degrees."""
    if is_plane(space):
        return {1: 270.0, 2: 225.0 + 90.0 * index}.get(total, 90.0 + 360.0 * index / total)
    if total >= 6 and total % 2 == 0:
        middle = 360.0 * (2 * (index // 2) + 0.5) / total
        return middle + (115.2 if index % 2 else -115.2) / total
    return 360.0 * index / total


def stretch(
    groups: tuple[LegGroup, ...], shapes: tuple[Shape, ...], points: Points
) -> tuple[Shape, ...]:
    """Legs as long as the points are apart, on the average over those that are alike."""
    ways = np.add(points.platform, (0.0, 0.0, points.height)) - np.array(points.base)
    distances = np.linalg.norm(ways, axis=1)
    result, start = [], 0
    for group, shape in zip(groups, shapes, strict=True):
        own = distances[start : start + group.count]
        start += group.count
        length = float(np.linalg.norm(shape.tip))
        if shape.concentric or length < _UPRIGHT or not own.all():
            raise fault(
                f"{group.plain} legs between points that do not let them extend",
                "base and platform points apart at home, and legs that reach from one to the other",
            )
        chain = scaled(shape.chain, float(np.mean(own)) / length)
        result.append(replace(shape, chain=chain, tip=shape.tip * float(np.mean(own)) / length))
    return tuple(result)


def _between(shape: Shape, points: Points, index: int, space: Space) -> Plain:
    """A leg from its base point towards its platform point."""
    plane = is_plane(space)
    base, point = np.array(points.base[index]), np.array(points.platform[index])
    way = np.add(point, (0.0, 0.0, points.height)) - base
    outward = base if np.linalg.norm(base[:2]) > _UPRIGHT else point
    azimuth = math.degrees(math.atan2(outward[1], outward[0]))
    rpy = (0.0, 0.0, azimuth + 180.0) if plane else (-90.0, -90.0, azimuth)
    frame = np.array(rotation_from_rpy(rpy, degrees=True))
    frame = _turned(frame @ shape.tip, way) @ frame
    return _written(space, base, point, _rows(frame)) | _ended(shape, frame)


def _turned(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The least rotation that takes one direction into another."""
    axis = np.cross(a, b)
    size = float(np.linalg.norm(axis))
    if size < _UPRIGHT * float(np.linalg.norm(a) * np.linalg.norm(b)):
        return np.eye(3) if a @ b > 0.0 else np.diag([-1.0, -1.0, 1.0])
    return rotation_about(axis / size, math.atan2(size, float(a @ b)))


def _central(shape: Shape) -> Plain:
    """Base point, base frame and platform joint of a leg that stands in the middle."""
    frame = np.array(rotation_from_rpy((-90.0, -90.0, 0.0), degrees=True))
    rest = np.cross(shape.tip, [1.0, 0.0, 0.0])
    angle = math.atan2(float(np.linalg.norm(rest)), shape.tip[0])
    if np.linalg.norm(rest) > _UPRIGHT:  # turned so that its end stands above its foot
        frame = frame @ rotation_about(rest / np.linalg.norm(rest), angle)
    point = np.zeros(3)
    base = np.round(np.array([0.0, 0.0, HEIGHT]) - frame @ shape.tip, DIGITS) + 0.0
    leg: Plain = {"base_point": base.tolist(), "base_frame": _rows(frame)}
    return leg | {"platform_point": point.tolist(), **_ended(shape, frame)}


def _ended(shape: Shape, frame: np.ndarray) -> Plain:
    """What a leg states of its platform joint."""
    if shape.axis_link:
        axis = np.round(frame @ shape.axis_leg, DIGITS) + 0.0
        return {"platform_joint": {"axis_platform": axis.tolist()}}
    if shape.is_welded:
        return {"platform_joint": {"rotation": _rows((frame @ shape.last).T)}}
    return {}


def _rows(rotation: np.ndarray) -> list[list[float]]:
    return (np.round(rotation, DIGITS) + 0.0).tolist()  # type: ignore[no-any-return]


def _placed(shape: Shape, space: Space, azimuth: float, tilt: float) -> Plain:
    """Base point, base frame and platform point of one leg."""
    plane = is_plane(space)
    radius = 0.0 if space is Space.POINT or shape.concentric else RADIUS[plane]
    low = 0.0 if plane or shape.concentric else LOW
    a = math.radians(azimuth)
    point = np.array([radius * math.cos(a), radius * math.sin(a), low])
    rpy = (0.0, 0.0, azimuth + 180.0 + tilt) if plane else (-90.0, -90.0 + tilt, azimuth)
    if shape.concentric:
        rpy = (0.0, CORNER, azimuth)
    rpy = (rpy[0], rpy[1], round(math.remainder(rpy[2], 360.0), 6))
    frame = np.array(rotation_from_rpy(rpy, degrees=True))
    origin = np.array([0.0, 0.0, 0.0 if plane else HEIGHT])
    point = np.round(point, DIGITS)
    base = np.round(origin + point - frame @ shape.tip, DIGITS)
    leg = _written(space, base + 0.0, point + 0.0, {"rpy_deg": list(rpy)})
    return leg | _ended(shape, frame)


def _written(space: Space, base: np.ndarray, point: np.ndarray, frame: object) -> Plain:
    """Where a leg stands, with the components that the space has."""
    size = 2 if is_plane(space) else 3
    leg: Plain = {"base_point": base.tolist()[:size], "base_frame": frame}
    return leg | ({} if space is Space.POINT else {"platform_point": point.tolist()[:size]})
