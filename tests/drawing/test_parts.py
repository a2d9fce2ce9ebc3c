"""What pictures are made of: joints by kind, hulls, the order of painting, labels."""

from __future__ import annotations

import numpy as np
import pytest

from pne_sym import manipulators
from pne_sym.drawing.labels import BALLOON, Page, extent, label_places
from pne_sym.drawing.order import overlap, painted
from pne_sym.drawing.scene import Scene, Slide, Turn, scene_of
from pne_sym.drawing.shapes import Label, Picture, Shape, disc, hull, rounded
from pne_sym.drawing.solids import ball, box, cylinder, prism
from pne_sym.drawing.style import Paint
from pne_sym.drawing.view import view_from
from pne_sym.model.kinematics import pose_at
from tests.sampling import entries

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def scene(name: str) -> Scene:
    model = manipulators.load(name)
    return scene_of(model, model.home.X, model.home.q)


def letters(name: str, leg: int = 0) -> str:
    """Kinds of a leg's joints as they are drawn."""
    text = ""
    for part in scene(name).legs[leg].parts:
        if isinstance(part, Turn):
            text += part.look
        elif isinstance(part, Slide):
            text += "H" if part.helical else "P"
    return text


@pytest.mark.parametrize(
    ("name", "drawn"),
    [
        ("stewart", "UPS"),
        ("stewart_sps", "SPS"),
        ("hexapod_6ucu", "UPRU"),
        ("hexapod_6uhs", "UHS"),
        ("hexapod_6x6r", "RRRRRR"),
        ("hexaglide", "PUS"),
        ("hybrid_3crs", "RPRS"),
        ("tripod_3upu", "UPU"),
        ("delta", "RUS"),
        ("planar_3rpr", "RPR"),
    ],
)
def test_joints_are_drawn_by_kind(name: str, drawn: str) -> None:
    assert letters(name) == drawn


@pytest.mark.parametrize("name", entries())
def test_the_last_joint_sits_on_the_platform(name: str) -> None:
    found, model = scene(name), manipulators.load(name)
    pose = pose_at(model.space, model.home.X, model.fixed_centre)
    for leg, drawn in zip(model.legs, found.legs, strict=True):
        last = drawn.parts[-1]
        assert isinstance(last, Turn)
        place = pose.t + pose.R @ np.array(leg.platform_point)
        np.testing.assert_allclose(last.point, place, atol=1e-9)


def test_actuated_and_extra_joints_are_known() -> None:
    parts = scene("planar_redundant").legs[0].parts
    slide = parts[0]
    assert isinstance(slide, Slide)
    assert slide.actuated
    assert slide.extra
    assert slide.grounded


def test_hull_of_random_points_contains_them() -> None:
    points = np.random.default_rng(1).normal(size=(50, 2))
    corners = hull(points)
    steps = np.roll(corners, -1, axis=0) - corners
    for point in points:
        arms = point - corners
        assert (steps[:, 0] * arms[:, 1] - steps[:, 1] * arms[:, 0] >= -1e-12).all()


def test_hull_of_few_points() -> None:
    assert len(hull(np.array([[0.0, 0.0], [0.0, 0.0]]))) == 1
    assert len(rounded(np.zeros((1, 2)), 1.0)) == 24


def test_overlap() -> None:
    middle = overlap(SQUARE, SQUARE + 0.5)
    assert middle is not None
    np.testing.assert_allclose(middle, [0.75, 0.75])
    assert overlap(SQUARE, SQUARE + 2.0) is None
    assert overlap(SQUARE, disc(np.array([1.9, 1.9]), 1.0)) is None


def test_what_is_nearer_covers_what_is_farther() -> None:
    view = view_from(0.0, 0.0)  # from x
    far = ball(view, np.zeros(3), 0.3, Paint("#111111"))
    rod = cylinder(
        view, np.array([1.0, -1.0, 0.0]), np.array([1.0, 1.0, 0.0]), 0.1, Paint("#222222")
    )
    face = np.array([[2.0, -1, -1], [2.0, 1, -1], [2.0, 1, 1], [2.0, -1, 1]])
    plate = prism(view, face, np.array([0.1, 0.0, 0.0]), Paint("#333333"))
    cube = box(view, np.array([3.0, 0, 0]), tuple(0.1 * np.eye(3)), Paint("#444444"))
    for given in ([far, rod, plate, cube], [cube, plate, rod, far], [plate, far, cube, rod]):
        assert painted(given, view) == [far, rod, plate, cube]


def test_a_rod_that_leans_away_is_compared_where_it_is_covered() -> None:
    """Its middle is nearer than the ball's, but not where the two meet."""
    view = view_from(0.0, 0.0)
    paint = Paint("#222222")
    rod = cylinder(view, np.array([-1.0, 0, 0]), np.array([5.0, 0, 4.0]), 0.1, paint)
    near = ball(view, np.array([0.2, 0, 0]), 0.3, paint)
    assert painted([near, rod], view) == [rod, near]


def test_rounding_orders_nothing() -> None:
    """Two rods that cross in a point, each time moved by what another processor makes of it."""
    view, random, found = view_from(0.3, 0.4), np.random.default_rng(0), set()
    for _ in range(20):
        rods = []
        for end in (np.array([0.2, 1.0, 0.5]), np.array([-0.3, 0.4, 1.0])):
            ends = (end * (1.0 + 1e-15 * random.normal(size=3)) for end in (-end, end))
            rods.append(cylinder(view, *ends, 0.1, Paint("#222222")))
        found.add(painted(rods, view)[0] is rods[0])
    assert found == {True}


def test_a_circle_of_covering_is_painted_all_the_same() -> None:
    view = view_from(0.0, 0.0)
    corners = [np.array([0.0, np.cos(a), np.sin(a)]) for a in (0.5, 2.6, 4.7)]
    up, down = np.array([0.3, 0, 0]), np.array([-0.3, 0, 0])
    rods = [
        cylinder(
            view,
            corners[k] + down + 0.3 * (corners[k] - corners[k - 1]),
            corners[k - 1] + up + 0.3 * (corners[k - 1] - corners[k]),
            0.05,
            Paint("#222222"),
        )
        for k in range(3)
    ]
    assert sorted(map(id, painted(rods, view))) == sorted(map(id, rods))


def test_balloons_stand_clear_of_shapes_and_of_each_other() -> None:
    shape = Shape(20.0 * SQUARE)
    labels = tuple(Label(np.array([19.0, 10.0]), str(k), (4.0, 0.0), balloon=True) for k in (1, 2))
    extents = [extent(label, (4.0, 5.0)) for label in labels]
    page = Page(np.full(2, -100.0), np.full(2, 100.0))
    places = label_places(Picture((shape,), labels, ()), 1.0, np.zeros(2), extents, page)
    assert np.linalg.norm(places[0] - places[1]) > 2 * BALLOON
    for place in places:
        outside = np.maximum(np.maximum(place - 20.0, -place), 0.0)
        assert np.linalg.norm(outside) > BALLOON
