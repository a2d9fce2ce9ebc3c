"""Pictures of manipulators from their own data.

>>> import pne_sym
>>> pne_sym.draw("stewart", "stewart.svg")  # doctest: +SKIP
PosixPath('stewart.svg')
"""

from __future__ import annotations

import dataclasses
import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pne_sym.drawing.paper import check_path, save
from pne_sym.drawing.planar import planar_picture
from pne_sym.drawing.scene import scene_of
from pne_sym.drawing.shapes import Picture
from pne_sym.drawing.spatial import spatial_picture
from pne_sym.drawing.style import DRIVEN, EXTRA, JOINT, OUTLINE
from pne_sym.drawing.view import ELEVATION, best_azimuth, view_from
from pne_sym.generation import InputError, find
from pne_sym.model.loops import Loops, legs_closed

if TYPE_CHECKING:
    from pne_sym.model.manipulator import Manipulator

CLOSED = 1e-6
"""Largest gap of a leg (m or rad) with which it is drawn."""
_STAGES = 8


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
        q: joint displacements that close the loops at X; default: found from home's.
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
    save(picture(manipulator, X, q, azimuth=azimuth, elevation=elevation), Path(path))
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
    _check_angle("azimuth", azimuth)
    _check_angle("elevation", elevation)
    scene = scene_of(manipulator, *_closed(manipulator, X, q))
    if scene.planar:
        found = planar_picture(scene)
    else:
        up = ELEVATION if elevation is None else elevation
        found = spatial_picture(
            scene, view_from(best_azimuth(scene, up) if azimuth is None else azimuth, up)
        )
    return dataclasses.replace(found, legend=_legend(manipulator))


def _closed(
    manipulator: Manipulator, X: Sequence[float] | None, q: Sequence[float] | None
) -> tuple[list[float], list[float]]:
    """The pose and the displacements to be drawn."""
    home = manipulator.home
    if X is None:
        if q is not None:
            raise InputError("q without X: a picture is drawn at home, at X, or at X and q")
        return list(home.X), list(home.q)
    loops = Loops(manipulator.space, manipulator.legs, manipulator.fixed_centre)
    _check_length("X", X, len(home.X))
    start, goal, found = np.array(home.X), np.array(X, dtype=float), np.array(home.q)
    if q is not None:
        _check_length("q", q, len(home.q))
        found = np.array(q, dtype=float)
    else:
        for part in np.linspace(0.0, 1.0, _STAGES + 1)[1:]:
            stage = start + part * (goal - start)
            found[loops.extra] = stage[loops.size :]
            found = legs_closed(loops, stage, found)
    gaps = loops.gaps(goal, found)
    if not max(gaps) <= CLOSED:
        widest = loops.widest(goal, found)
        raise InputError(f"X: legs[{widest.leg}] does not reach it; a gap of {widest.size} is left")
    return goal.tolist(), found.tolist()


def _check_length(name: str, values: Sequence[float], wanted: int) -> None:
    if len(values) != wanted or not np.isfinite(np.array(values, dtype=float)).all():
        raise InputError(f"{name}: {wanted} numbers are needed, not {list(values)}")


def _check_angle(name: str, value: float | None) -> None:
    if value is not None and not math.isfinite(value):
        raise InputError(f"{name}: a finite angle (degrees) is needed, not {value}")


def _legend(manipulator: Manipulator) -> tuple[tuple[str, str, str], ...]:
    """What the colours that occur mean."""
    joints = [joint for leg in manipulator.legs for joint in leg.joints]
    rows = []
    if any(joint.actuated for joint in joints):
        rows.append((DRIVEN, OUTLINE, "driven joint"))
    rows.append((JOINT, OUTLINE, "passive joint"))
    if any(joint.extra for joint in joints):
        rows.append(("#ffffff", EXTRA, "extra coordinate"))
    return tuple(rows)


__all__ = ["draw", "picture"]
