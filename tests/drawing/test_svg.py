"""SVG files as other programs read them: every path, and the whole beside matplotlib's PNG."""

from __future__ import annotations

import io
import re
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from fontTools.pens.recordingPen import RecordingPen
from fontTools.svgLib.path import parse_path

from pne_sym import drawing, manipulators
from pne_sym.drawing.paper import figure, rendered
from pne_sym.drawing.shapes import Picture
from tests.drawing.render import drawn, largest_difference, pixels
from tests.sampling import entries

NEAREST = 0.05 + 1e-9
"""Typographic points: numbers are rounded to a tenth."""
NOTICED = 0.2
"""Of the largest difference that squares can have: letters that are broken differ by 0.31."""

Commands = list[tuple[str, tuple[tuple[float, float], ...]]]


@cache
def picture(name: str) -> Picture:
    return drawing.picture(manipulators.load(name))


def paths(svg: bytes) -> list[Commands]:
    """Every path of a picture, as a parser of its own reads it."""
    found = []
    for element in ET.fromstring(svg).iter("{http://www.w3.org/2000/svg}path"):
        text = element.attrib.get("d", "M 0 0")  # the letter " " has none
        parse_path(text, RecordingPen())
        pen = RecordingPen()  # once more, unclosed: closing adds a line unless its length is zero
        parse_path(text.replace("z", ""), pen)
        found.append(pen.value)
    return found


def as_matplotlib_writes_it(name: str) -> bytes:
    buffer = io.BytesIO()
    figure(picture(name)).savefig(buffer, format="svg")
    return buffer.getvalue()


@pytest.mark.parametrize("name", entries())
def test_every_path_has_the_commands_that_matplotlib_wrote(name: str) -> None:
    written, wanted = (
        paths(svg) for svg in (rendered(picture(name), ".svg"), as_matplotlib_writes_it(name))
    )
    assert len(written) == len(wanted) > 50
    for mine, theirs in zip(written, wanted, strict=True):
        assert [command for command, _ in mine] == [command for command, _ in theirs]
        for (_, points), (_, others) in zip(mine, theirs, strict=True):
            np.testing.assert_allclose(points, others, rtol=0, atol=NEAREST)


@pytest.mark.parametrize("name", entries())
def test_it_looks_like_the_png(name: str, tmp_path: Path) -> None:
    svg = tmp_path / f"{name}.svg"
    svg.write_bytes(rendered(picture(name), ".svg"))
    png = rendered(picture(name), ".png")
    assert largest_difference(drawn(svg), pixels(png)) < NOTICED


def test_a_broken_letter_is_noticed(tmp_path: Path) -> None:
    """The comparison sees that lines after curves are left out, of one letter."""
    text = rendered(picture("sixbar"), ".svg").decode()
    start = text.index('id="DejaVuSans-56"')  # the s of joints
    end = text.index("/>", start)
    letter = re.sub(r"(?<=\d) \nL ", " ", text[start:end])
    svg = tmp_path / "broken.svg"
    svg.write_text(text[:start] + letter + text[end:])
    assert letter != text[start:end]
    assert largest_difference(drawn(svg), pixels(rendered(picture("sixbar"), ".png"))) > NOTICED
