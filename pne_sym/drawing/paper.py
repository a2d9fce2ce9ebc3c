"""Pictures on paper, by matplotlib."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pne_sym.drawing.labels import Page, extent, label_places
from pne_sym.drawing.shapes import Label, Picture, Shape, disc
from pne_sym.drawing.style import LABEL, OUTLINE
from pne_sym.generation import InputError
from pne_sym.model.kinematics import Array
from pne_sym.writer import OutputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = (".svg", ".png", ".pdf")
WIDTH, HEIGHT = 432.0, 324.0
"""Of the page, in typographic points (1/72 inch)."""
_MARGIN, _LEGEND, _EDGE = 22.0, 16.0, 2.0
_FONT, _SMALL = "DejaVu Sans", 8.0
MISSING = "drawing needs matplotlib: pip install 'pne-sym[draw]'"
_DPI = 200
_DRAWN = re.compile(r' d="[^"]*"|translate\([^)]*\)')
_LONG = re.compile(r"-?\d+\.\d+")
_METADATA: dict[str, dict[str, Any]] = {
    ".svg": {"Date": None, "Creator": None, "Format": None, "Type": None},
    ".png": {"Software": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


def check_path(path: Path) -> None:
    """Refuse a file that cannot be a picture.

    Raises:
        InputError: its name does not end in a format that is known.
    """
    if path.suffix not in FORMATS:
        raise InputError(f"cannot draw {path}: a picture's name ends in {', '.join(FORMATS)}")


def write(path: Path, content: bytes) -> None:
    """Write the bytes of a picture file.

    Raises:
        OutputError: the file cannot be written.
    """
    try:
        path.write_bytes(content)
    except OSError as error:
        raise OutputError(f"cannot write {path}: {error.strerror or error}") from error


def rendered(picture: Picture, suffix: str) -> bytes:
    """The bytes of a picture file; the same each time for one version of matplotlib.

    Raises:
        InputError: matplotlib is not installed.
    """
    page = figure(picture)
    import matplotlib as mpl

    buffer = io.BytesIO()
    with mpl.rc_context({"svg.hashsalt": "pne_sym", "svg.fonttype": "path"}):
        page.savefig(buffer, format=suffix[1:], dpi=_DPI, metadata=_METADATA[suffix])
    content = buffer.getvalue()
    return _rounded(content.decode()).encode() if suffix == ".svg" else content


def _shorter(number: re.Match[str]) -> str:
    """A number of 1/10 point: a quarter of a hair's breadth."""
    text = f"{float(number[0]):.1f}".removesuffix(".0")
    return "0" if text == "-0" else text


def _rounded(svg: str) -> str:
    """The same picture without digits that differ between machines; commands stay as they are."""
    return _DRAWN.sub(lambda drawn: _LONG.sub(_shorter, drawn[0]), svg)


@dataclass(frozen=True)
class Layout:
    """Where a picture, or one of several that follow each other, stands on the page.

    Attributes:
        scale, shift: from the picture's plane to the page.
        width: of the page, in typographic points.
        places: of the labels.
        radii: of the circles about labels in balloons.
    """

    scale: float
    shift: Array
    width: float
    places: tuple[Array, ...]
    radii: tuple[float, ...]


def layout(pictures: Sequence[Picture], samples: Sequence[Picture] = ()) -> Layout:
    """A place for pictures that follow each other, with the labels of the first.

    Args:
        pictures: all of them; they have room on the page.
        samples: those that labels keep clear of; default all.

    Raises:
        InputError: matplotlib is not installed.
    """
    first = pictures[0]
    points = np.vstack([shape.points for picture in pictures for shape in picture.shapes])
    low, high = points.min(axis=0), points.max(axis=0)
    bottom = _MARGIN + _LEGEND
    room = np.array([WIDTH - 2 * _MARGIN, HEIGHT - _MARGIN - bottom])
    extent_of_all = np.maximum(high - low, 1e-9)
    scale = float((room / extent_of_all).min())
    legend = sum(_legend_width(text) for _, _, text in first.legend)
    wanted = 2 * _MARGIN + max(legend, math.ceil(scale * float(extent_of_all[0])))
    width = min(WIDTH, wanted)
    middle = np.array([width / 2, (bottom + HEIGHT - _MARGIN) / 2])
    shift = middle - scale * 0.5 * (low + high)
    extents = [extent(label, text_size(label.text, label.size)) for label in first.labels]
    page = Page(
        np.full(2, _EDGE), np.array([width, HEIGHT]) - _EDGE, tuple(_legend_boxes(first.legend))
    )
    shapes = tuple(shape for picture in samples or pictures for shape in picture.shapes)
    places = label_places(replace(first, shapes=shapes), scale, shift, extents, page)
    return Layout(scale, shift, width, tuple(places), tuple(float(e[0]) for e in extents))


def text_size(text: str, size: float) -> tuple[float, float]:
    """Width and height of a text, in typographic points; `size`: of its letters.

    Raises:
        InputError: matplotlib is not installed.
    """
    try:
        from matplotlib.font_manager import FontProperties
        from matplotlib.textpath import text_to_path
    except ImportError as error:
        raise InputError(MISSING) from error
    font = FontProperties(family=_FONT, size=size)
    width, height, _ = text_to_path.get_text_width_height_descent(text, font, ismath=False)
    return float(width), float(height)


def figure(picture: Picture) -> Figure:
    """A picture as a matplotlib figure.

    Raises:
        InputError: matplotlib is not installed.
    """
    plan = layout([picture])
    page = blank(plan)
    paint(page, picture, plan)
    return page


def blank(plan: Layout) -> Figure:
    """An empty page.

    Raises:
        InputError: matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise InputError(MISSING) from error
    return Figure(figsize=(plan.width / 72.0, HEIGHT / 72.0), facecolor="white")


def paint(page: Figure, picture: Picture, plan: Layout) -> None:
    """Paint a picture on an empty page."""
    axes = page.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(0.0, plan.width)
    axes.set_ylim(0.0, HEIGHT)
    for shape in picture.shapes:
        _add_shape(axes, shape, shape.points * plan.scale + plan.shift)
    for label, place, radius in zip(picture.labels, plan.places, plan.radii, strict=True):
        _add_label(axes, label, place, radius)
    _add_legend(axes, picture)


def _add_shape(axes: Any, shape: Shape, points: Array) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    codes = [Outline.MOVETO] + [Outline.LINETO] * (len(points) - 1)
    if shape.closed:
        points = np.vstack([points, points[:1]])
        codes.append(Outline.CLOSEPOLY)
    patch = PathPatch(
        Outline(points, codes),
        facecolor=shape.fill or "none",
        edgecolor=shape.edge or "none",
        linewidth=shape.width if shape.edge else 0.0,
        alpha=None if shape.alpha == 1.0 else shape.alpha,
        joinstyle="round",
        capstyle="round",
    )
    patch.set_clip_on(False)
    axes.add_artist(patch)
    patch.set_clip_path(None)


def _add_label(axes: Any, label: Label, point: Array, radius: float) -> None:
    if label.balloon:
        circle = disc(point, radius)
        _add_shape(axes, Shape(circle, "#ffffff", label.colour, 0.7), circle)
    axes.text(
        point[0],
        point[1] - (0.3 if label.balloon else 0.0),
        label.text,
        color=label.colour,
        fontsize=label.size,
        family=_FONT,
        ha="center",
        va="center_baseline" if label.balloon else "center",
        clip_on=False,
    )


def _add_legend(axes: Any, picture: Picture) -> None:
    """One line at the foot of the page."""
    x = _MARGIN
    for fill, edge, text in picture.legend:
        width = 0.7 if edge == OUTLINE else 1.7
        centre = np.array([x, _LEGEND])
        _add_shape(axes, Shape(disc(centre, 4.2), fill, edge, width), disc(centre, 4.2))
        axes.text(
            x + 9, _LEGEND - 0.5, text, color=LABEL, fontsize=_SMALL, family=_FONT, va="center"
        )
        x += _legend_width(text)


def _legend_boxes(legend: Sequence[tuple[str, str, str]]) -> Iterator[Array]:
    """What the legend covers, entry by entry: corners on the page."""
    x = _MARGIN
    for _, _, text in legend:
        right = x + 9.0 + text_size(text, _SMALL)[0]
        low, high = _LEGEND - 5.5, _LEGEND + 5.5
        yield np.array([[x - 5.5, low], [right, low], [right, high], [x - 5.5, high]])
        x += _legend_width(text)


def _legend_width(text: str) -> float:
    return 24.0 + 4.8 * len(text)
