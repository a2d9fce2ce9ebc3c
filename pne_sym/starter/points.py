"""Joint points of one's own for a starter: from a CSV file, or on two circles."""

from __future__ import annotations

import csv
import io
import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pne_sym.model.errors import SpecError, SpecWarning, show
from pne_sym.model.files import bounded_text
from pne_sym.model.legs import is_plane
from pne_sym.model.manipulator import Space, Vector3
from pne_sym.model.rotation import vector3
from pne_sym.starter.notation import LegGroup, is_guide

_LARGEST = 1024 * 1024
LARGE = 50.0
"""Coordinates of this size (m) are asked about."""


@dataclass(frozen=True)
class Points:
    """Where the legs stand.

    Attributes:
        base: of each leg, base frame, m.
        platform: of each leg, platform frame, m.
        height: of the platform's origin above the base's at home, m.
    """

    base: tuple[Vector3, ...]
    platform: tuple[Vector3, ...]
    height: float


@dataclass(frozen=True)
class PointsFile:
    """A CSV file with a row for each leg: base point, then platform point (m)."""

    path: Path
    height: float | None

    def points(self, groups: tuple[LegGroup, ...], space: Space) -> Points:
        """The points.

        Raises:
            SpecError: not readable, other than two points in a row, other than a row for each leg.
        """
        size = 2 if is_plane(space) else 3
        rows = [self._row(line, row, size) for line, row in self._rows()]
        count = sum(group.count for group in groups)
        if len(rows) != count:
            raise self._fault(f"{len(rows)} rows of numbers", f"{count}: one for each leg")
        zero = [0.0] * (3 - size)
        largest = max((abs(x) for row in rows for x in row), default=0.0)
        if largest >= LARGE:
            warnings.warn(
                f"{self.path}: coordinates up to {largest:g} are taken as m; are they in mm?",
                SpecWarning,
                stacklevel=2,
            )
        base, platform = ([[*row[a : a + size], *zero] for row in rows] for a in (0, size))
        height = _height(self.height, space)
        return Points(tuple(map(vector3, base)), tuple(map(vector3, platform)), height)

    def _rows(self) -> list[tuple[int, list[str]]]:
        """Rows with their lines; blank ones and comments are left out, and a first row of names."""
        text = bounded_text(self.path, "a CSV file", _LARGEST)
        mark = ";" if ";" in text else ","
        reader = csv.reader(io.StringIO(text, newline=""), delimiter=mark, strict=True)
        rows = []
        try:
            for row in reader:
                cells = [cell.strip() for cell in row]
                if any(cells) and not cells[0].startswith("#"):
                    rows.append((reader.line_num, cells))
        except csv.Error as error:
            raise self._fault(f"line {reader.line_num}: {error}", "a CSV file") from None
        named = rows and not any(_is_number(cell) for cell in rows[0][1])
        return rows[1:] if named else rows

    def _row(self, line: int, cells: list[str], size: int) -> list[float]:
        axes = "xyz"[:size]
        names = ", ".join([f"base {a}" for a in axes] + [f"platform {a}" for a in axes])
        if len(cells) != 2 * size:
            raise self._fault(f"line {line}: {len(cells)} cells", f"{2 * size} numbers: {names}")
        wrong = next((cell for cell in cells if not _is_number(cell)), None)
        if wrong is not None:
            raise self._fault(f"line {line}: {show(wrong)}", f"a number, m: {names}")
        return [float(cell) for cell in cells]

    def _fault(self, problem: str, expected: str = "") -> SpecError:
        return SpecError(str(self.path), "", problem, expected)


@dataclass(frozen=True)
class Rings:
    """Points on two circles about the z axes; angles are those of the points, from x, degrees.

    Attributes:
        radii: of base and platform, m.
        base, platform: an angle for each leg that is no guide in the middle.
        height: of the platform's origin above the base's, m.
    """

    radii: Sequence[float]
    base: Sequence[float]
    platform: Sequence[float]
    height: float | None

    def points(self, groups: tuple[LegGroup, ...], space: Space) -> Points:
        """The points.

        Raises:
            SpecError: other than two radii, other than an angle for each leg, or not finite.
        """
        guides = [is_guide(group, groups) for group in groups for _ in range(group.count)]
        legs = guides.count(False)
        if len(self.radii) != 2 or not all(math.isfinite(r) and r >= 0.0 for r in self.radii):
            given = show(list(self.radii))
            raise SpecError("--radii", "", f"value {given}", "two, of base and platform (m)")
        rings = []
        for name, radius, angles in zip(
            ("--base-angles", "--platform-angles"),
            self.radii,
            (self.base, self.platform),
            strict=True,
        ):
            if len(angles) != legs or not all(map(math.isfinite, angles)):
                raise SpecError(
                    name, "", f"value {show(list(angles))}", f"{legs} angles, degrees, one a leg"
                )
            ring = iter(angles)
            rings.append(
                tuple(_on_ring(0.0, 0.0) if g else _on_ring(radius, next(ring)) for g in guides)
            )
        return Points(rings[0], rings[1], _height(self.height, space))


Geometry = PointsFile | Rings


def _height(height: float | None, space: Space) -> float:
    if is_plane(space):
        if height is not None:
            raise SpecError("--height", "", f"value {height:g}", "none in the plane")
        return 0.0
    if height is None or not math.isfinite(height):
        raise SpecError("--height", "", "missing", "that of the platform's origin at home, m")
    return height


def _on_ring(radius: float, degrees: float) -> Vector3:
    angle = math.radians(degrees)
    return vector3([round(radius * f(angle), 12) + 0.0 for f in (math.cos, math.sin)] + [0.0])


def _is_number(cell: str) -> bool:
    try:
        return math.isfinite(float(cell)) and abs(float(cell)) <= 1e12
    except ValueError:
        return False
