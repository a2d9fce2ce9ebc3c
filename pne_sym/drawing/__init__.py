"""Pictures of manipulators from their own data.

>>> import pne_sym
>>> pne_sym.draw("stewart", "stewart.svg")  # doctest: +SKIP
PosixPath('stewart.svg')
>>> pne_sym.animate("stewart", "stewart.gif", poses)  # doctest: +SKIP
PosixPath('stewart.gif')
"""

from __future__ import annotations

import dataclasses
import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pne_sym.drawing.film import check_film, save_film
from pne_sym.drawing.paper import check_path, rendered, write
from pne_sym.drawing.planar import planar_picture
from pne_sym.drawing.poses import Configuration, closed, pose_of
from pne_sym.drawing.scene import Scene, ground_of, scene_of
from pne_sym.drawing.shapes import Picture
from pne_sym.drawing.spatial import spatial_picture
from pne_sym.drawing.style import ACTUATED, EXTRA, JOINT, OUTLINE
from pne_sym.drawing.view import ELEVATION, best_azimuth, view_from
from pne_sym.generation import InputError, find

if TYPE_CHECKING:
    from pne_sym.model.manipulator import Manipulator

LONGEST = 1000
"""Frames of an animation."""


def draw(
    source: str | os.PathLike[str] | Manipulator,
    path: str | os.PathLike[str],
    X: Sequence[float] | None = None,
    q: Sequence[float] | None = None,
    *,
    azimuth: float | None = None,
    elevation: float | None = None,
) -> Path:
    """Draw a manipulator and write the picture.

    Args:
        source: a name in the catalogue, a spec file, or a manipulator.
        path: of the picture; `.svg`, `.png` or `.pdf`.
        X: platform coordinates, then the extra ones; default home.
        q: first guess of the joint displacements at X; default: found along the
            straight way from home.
        azimuth: where it is looked at from, degrees from x towards y; default: where
            the legs hide each other least.  Not used in the plane.
        elevation: how far above the horizon, degrees; default 20.

    Returns:
        The picture's path.

    Raises:
        SpecError: the source is at fault.
        InputError: matplotlib is not installed, the file's ending is no picture's,
            the loops do not close at X, or an angle is not finite.
        OutputError: the picture cannot be written.
    """
    check_path(Path(path))
    manipulator = find(source)
    found = picture(manipulator, X, q, azimuth=azimuth, elevation=elevation)
    write(Path(path), rendered(found, Path(path).suffix))
    return Path(path)


def animate(
    source: str | os.PathLike[str] | Manipulator,
    path: str | os.PathLike[str],
    poses: Sequence[Sequence[float]],
    q: Sequence[float] | None = None,
    *,
    fps: int = 25,
    azimuth: float | None = None,
    elevation: float | None = None,
) -> Path:
    """Draw a manipulator along a path and write the animation, a frame for each pose.

    Args:
        source: a name in the catalogue, a spec file, or a manipulator.
        path: of the animation; `.gif`, or `.mp4` where ffmpeg is installed.
        poses: X of each frame: platform coordinates, then the extra ones.
        q: first guess of the joint displacements at the first pose; default: found
            along the straight way from home.  Each pose is reached from the one before.
        fps: frames per second, 1 to 100.
        azimuth: as for `draw`; chosen for the first pose.
        elevation: as for `draw`.

    Returns:
        The animation's path.

    Raises:
        SpecError: the source is at fault.
        InputError: as for `draw`, the pose named; ffmpeg is not installed; no pose or
            more than 1000; fps out of range.
        OutputError: the file cannot be written.
    """
    check_film(Path(path), fps)
    manipulator = find(source)
    frames = pictures(manipulator, poses, q, azimuth=azimuth, elevation=elevation)
    save_film(frames, Path(path), fps)
    return Path(path)


def picture(
    manipulator: Manipulator,
    X: Sequence[float] | None = None,
    q: Sequence[float] | None = None,
    *,
    azimuth: float | None = None,
    elevation: float | None = None,
) -> Picture:
    """The picture of a manipulator, as shapes; arguments as for `draw`."""
    reached = [closed(manipulator, X, q)]
    return _pictures(manipulator, reached, azimuth, elevation)[0]


def pictures(
    manipulator: Manipulator,
    poses: Sequence[Sequence[float]],
    q: Sequence[float] | None = None,
    *,
    azimuth: float | None = None,
    elevation: float | None = None,
) -> list[Picture]:
    """The pictures of a manipulator along a path, as shapes; arguments as for `animate`."""
    if not 1 <= len(poses) <= LONGEST:
        raise InputError(f"poses: 1 to {LONGEST} are needed, not {len(poses)}")
    reached: list[Configuration] = []
    for number, X in enumerate(poses, start=1):
        try:
            first = not reached
            reached.append(
                closed(manipulator, X, q if first else None, None if first else reached[-1])
            )
        except InputError as error:
            raise InputError(f"pose {number} of {len(poses)}: {error}") from error
    return _pictures(manipulator, reached, azimuth, elevation)


def _pictures(
    manipulator: Manipulator,
    reached: Sequence[Configuration],
    azimuth: float | None,
    elevation: float | None,
) -> list[Picture]:
    """Pictures that differ in what moves only: the base, the view and all sizes are common."""
    _check_angle("azimuth", azimuth)
    _check_angle("elevation", elevation)
    scenes = [scene_of(manipulator, each.X.tolist(), each.q.tolist()) for each in reached]
    ground = ground_of(scenes)
    up = ELEVATION if elevation is None else elevation

    def painted(scene: Scene) -> Picture:
        same = dataclasses.replace(scene, size=ground.size)
        return planar_picture(same, ground) if view is None else spatial_picture(same, view, ground)

    view = None
    if not ground.planar:
        view = view_from(best_azimuth(ground, up) if azimuth is None else azimuth, up)
    legend = _legend(manipulator)
    return [dataclasses.replace(painted(scene), legend=legend) for scene in scenes]


def _check_angle(name: str, value: float | None) -> None:
    if value is not None and not math.isfinite(value):
        raise InputError(f"{name}: a finite angle (degrees) is needed, not {value}")


def _legend(manipulator: Manipulator) -> tuple[tuple[str, str, str], ...]:
    """What the colours that occur mean."""
    joints, rows = manipulator.joints, []
    if any(joint.actuated for joint in joints):
        rows.append((ACTUATED, OUTLINE, "actuated joint"))
    rows.append((JOINT, OUTLINE, "passive joint"))
    if any(joint.extra for joint in joints):
        rows.append(("#ffffff", EXTRA, "extra coordinate"))
    return tuple(rows)


__all__ = ["animate", "check_film", "draw", "picture", "pictures", "pose_of", "save_film"]
