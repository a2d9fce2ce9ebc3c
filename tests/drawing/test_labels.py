"""Labels stay on the page as a whole, clear of the legend; measured on what matplotlib paints."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from numpy.typing import NDArray

from pne_sym import drawing, manipulators
from pne_sym.drawing.paper import figure, layout
from pne_sym.drawing.shapes import Picture
from tests.drawing.cables import cable_robot
from tests.sampling import entries

FRAMES = [(4.0, 3.0, 2.6), (6.0, 6.0, 2.0), (2.0, 2.0, 4.0), (8.0, 2.0, 2.0)]

Array = NDArray[np.float64]


def text_boxes(picture: Picture) -> tuple[list[tuple[str, Array]], Array]:
    """Every text with its box (low and high corners), and the page's size; pixels."""
    page = figure(picture)
    canvas = FigureCanvasAgg(page)
    canvas.draw()
    renderer = canvas.get_renderer()
    (axes,) = page.axes
    found = [
        (text.get_text(), text.get_window_extent(renderer).get_points()) for text in axes.texts
    ]
    return found, np.array(page.bbox.size)


def assert_legible(picture: Picture) -> None:
    boxes, size = text_boxes(picture)
    for text, (low, high) in boxes:
        assert (low >= 0.0).all(), text
        assert (high <= size).all(), text
    legend = boxes[len(picture.labels) :]
    for (text, one), (other, two) in itertools.product(boxes[: len(picture.labels)], legend):
        apart = (one[0] > two[1]) | (two[0] > one[1])
        assert apart.any(), f"{text} on {other}"


def assert_balloons_on_the_page(picture: Picture) -> None:
    plan = layout([picture])
    for label, place, radius in zip(picture.labels, plan.places, plan.radii, strict=True):
        if label.balloon:
            assert (place - radius >= 0.0).all(), label.text
            assert (place + radius <= [plan.width, drawing.paper.HEIGHT]).all(), label.text


@pytest.mark.parametrize("azimuth", [None, -60.0, 0.0, 45.0])
@pytest.mark.parametrize("frame", FRAMES)
def test_eight_cables(frame: tuple[float, float, float], azimuth: float | None) -> None:
    picture = drawing.picture(cable_robot(*frame), azimuth=azimuth)
    assert_legible(picture)
    assert_balloons_on_the_page(picture)


@pytest.mark.parametrize("name", entries())
def test_the_catalogue(name: str) -> None:
    picture = drawing.picture(manipulators.load(name))
    assert_legible(picture)
    assert_balloons_on_the_page(picture)


def test_numbers_of_three_digits_have_room_in_their_circles() -> None:
    picture = drawing.picture(manipulators.load("sixbar"))
    labels = tuple(dataclasses.replace(each, text="128") for each in picture.labels)
    plan = layout([dataclasses.replace(picture, labels=labels)])
    boxes, _ = text_boxes(dataclasses.replace(picture, labels=labels))
    widths = [(high - low)[0] * 72.0 / 100.0 for text, (low, high) in boxes if text == "128"]
    for label, radius, width in zip(labels, plan.radii, widths, strict=True):
        if label.balloon:
            assert 2.0 * radius > width > 12.0


def test_feet_in_a_long_box_have_no_common_plate() -> None:
    def plates(picture: Picture) -> int:
        return sum(shape.ground for shape in picture.shapes)

    assert plates(drawing.picture(cable_robot(8.0, 2.0, 2.0))) == 0
    assert plates(drawing.picture(cable_robot(6.0, 6.0, 0.5))) > 0
