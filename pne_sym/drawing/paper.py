"""Pictures on paper: the one module that uses matplotlib."""

from __future__ import annotations

import io
import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pne_sym.drawing.labels import BALLOON, label_places
from pne_sym.drawing.shapes import Label, Picture, Shape, disc
from pne_sym.drawing.style import LABEL, LINE, OUTLINE
from pne_sym.generation import InputError
from pne_sym.writer import OutputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

FORMATS = (".svg", ".png", ".pdf")
WIDTH, HEIGHT = 432.0, 324.0
"""Of the page, in typographic points (1/72 inch)."""
_MARGIN, _LEGEND = 22.0, 16.0
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


def save(picture: Picture, path: Path) -> None:
    """Write a picture; the same bytes each time for one version of matplotlib.

    Raises:
        InputError: matplotlib is not installed, or the file's ending is not known.
        OutputError: the file cannot be written.
    """
    check_path(path)
    content = rendered(picture, path.suffix)
    try:
        path.write_bytes(content)
    except OSError as error:
        raise OutputError(f"cannot write {path}: {error.strerror or error}") from error


def rendered(picture: Picture, suffix: str) -> bytes:
    """The bytes of a picture file.

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


def figure(picture: Picture) -> Figure:
    """A picture as a matplotlib figure.

    Raises:
        InputError: matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise InputError("drawing needs matplotlib: pip install 'pne-sym[draw]'") from error
    scale, shift, width = _placement(picture)
    page = Figure(figsize=(width / 72.0, HEIGHT / 72.0), facecolor="white")
    axes = page.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(0.0, width)
    axes.set_ylim(0.0, HEIGHT)
    for shape in picture.shapes:
        _add_shape(axes, shape, shape.points * scale + shift)
    for label, place in zip(picture.labels, label_places(picture, scale, shift), strict=True):
        _add_label(axes, label, place)
    _add_legend(axes, picture)
    return page


def _placement(picture: Picture) -> tuple[float, Array, float]:
    """Scale and shift from the picture's plane to the page, and the page's width."""
    points = np.vstack([shape.points for shape in picture.shapes])
    low, high = points.min(axis=0), points.max(axis=0)
    bottom = _MARGIN + _LEGEND
    room = np.array([WIDTH - 2 * _MARGIN, HEIGHT - _MARGIN - bottom])
    extent = np.maximum(high - low, 1e-9)
    scale = float((room / extent).min())
    legend = sum(_legend_width(text) for _, _, text in picture.legend)
    width = min(WIDTH, 2 * _MARGIN + max(legend, math.ceil(scale * float(extent[0]))))
    middle = np.array([width / 2, (bottom + HEIGHT - _MARGIN) / 2])
    return scale, middle - scale * 0.5 * (low + high), width


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


def _add_label(axes: Any, label: Label, point: Array) -> None:
    if label.balloon:
        circle = disc(point, BALLOON)
        _add_shape(axes, Shape(circle, "#ffffff", label.colour, 0.7), circle)
    axes.text(
        point[0],
        point[1] - (0.3 if label.balloon else 0.0),
        label.text,
        color=label.colour,
        fontsize=label.size,
        family="DejaVu Sans",
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
            x + 9, _LEGEND - 0.5, text, color=LABEL, fontsize=8, family="DejaVu Sans", va="center"
        )
        x += _legend_width(text)


def _legend_width(text: str) -> float:
    return 24.0 + 4.8 * len(text)
