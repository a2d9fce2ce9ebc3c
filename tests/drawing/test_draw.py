"""Pictures of manipulators: the whole catalogue, users' own, other poses, and what is refused."""

from __future__ import annotations

import dataclasses
import os
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

import pne_sym
from pne_sym import drawing, manipulators
from pne_sym.drawing.paper import HEIGHT, WIDTH, rendered
from pne_sym.drawing.scene import scene_of
from pne_sym.drawing.shapes import Picture
from pne_sym.drawing.spatial import spatial_picture
from pne_sym.drawing.style import ACTUATED, EXTRA
from pne_sym.drawing.view import view_from
from pne_sym.generation import InputError
from pne_sym.model.manipulator import IDENTITY3, Manipulator
from pne_sym.model.reader import from_mapping
from pne_sym.writer import OutputError
from tests.model import examples
from tests.sampling import entries

LARGEST = 95_000
"""Bytes; some more than the pictures in docs have, as versions of matplotlib differ."""


def fills(picture: Picture) -> set[str]:
    return {shape.fill for shape in picture.shapes}


@pytest.mark.parametrize("name", entries())
def test_every_manipulator_of_the_catalogue(name: str, tmp_path: Path) -> None:
    model = manipulators.load(name)
    path = pne_sym.draw(name, tmp_path / f"{name}.svg")
    root = ET.fromstring(path.read_text())
    assert root.tag.endswith("svg")
    assert path.stat().st_size < LARGEST
    picture = drawing.picture(model)
    numbers = [label.text for label in picture.labels if label.balloon]
    assert numbers == [str(k + 1) for k in range(len(model.legs))]
    assert ACTUATED in fills(picture)
    extra = any(joint.extra for leg in model.legs for joint in leg.joints)
    assert extra == any(shape.edge == EXTRA for shape in picture.shapes)
    assert all(np.isfinite(shape.points).all() for shape in picture.shapes)


@pytest.mark.parametrize(("suffix", "start"), [(".png", b"\x89PNG"), (".pdf", b"%PDF")])
def test_other_formats(suffix: str, start: bytes, tmp_path: Path) -> None:
    path = pne_sym.draw("planar_3rpr", tmp_path / f"picture{suffix}")
    assert path.read_bytes().startswith(start)


def test_the_page_is_no_larger_than_it_says() -> None:
    root = ET.fromstring(rendered(drawing.picture(manipulators.load("stewart")), ".svg"))
    width, height = (float(root.attrib[key].removesuffix("pt")) for key in ("width", "height"))
    assert width <= WIDTH
    assert height == HEIGHT


@pytest.mark.parametrize("name", ["stewart", "planar_mixed"])
def test_the_same_bytes_each_time(name: str, tmp_path: Path) -> None:
    code = f"import pne_sym; pne_sym.draw({name!r}, 'it.svg')"
    for seed in "12":
        folder = tmp_path / seed
        folder.mkdir()
        env = os.environ | {"PYTHONHASHSEED": seed}
        subprocess.run([sys.executable, "-c", code], cwd=folder, env=env, check=True)
    assert (tmp_path / "1/it.svg").read_bytes() == (tmp_path / "2/it.svg").read_bytes()


def test_no_date_and_no_path_is_written(tmp_path: Path) -> None:
    text = pne_sym.draw("sixbar", tmp_path / "it.svg").read_text()
    assert "metadata" not in text
    assert str(tmp_path) not in text


def test_another_pose_is_reached_from_home() -> None:
    model = manipulators.load("stewart")
    X = [0.1, -0.05, 0.85, 0.0, 0.0, 0.1, 0.99**0.5]
    at_home, moved = drawing.picture(model), drawing.picture(model, X)
    assert len(moved.shapes) > 0
    assert any(
        a.points.shape != b.points.shape or not np.allclose(a.points, b.points)
        for a, b in zip(at_home.shapes, moved.shapes, strict=False)
    )


def test_a_pose_with_its_displacements() -> None:
    model = manipulators.load("tripod_3rps")
    given = drawing.picture(model, model.home.X, model.home.q)
    home = drawing.picture(model)
    assert len(given.shapes) == len(home.shapes)


def test_an_extra_coordinate_moves_what_it_states() -> None:
    model = manipulators.load("planar_redundant")
    X = [*model.home.X[:3], model.home.X[3] + 0.05]
    pictures = drawing.picture(model), drawing.picture(model, X)
    before, after = (
        next(shape for shape in picture.shapes if shape.edge == EXTRA).points.mean(axis=0)
        for picture in pictures
    )
    assert np.linalg.norm(after - before) == pytest.approx(0.05)


@pytest.mark.parametrize(
    ("X", "q", "message"),
    [
        ([9.0, 0.0, 0.75, 0.0, 0.0, 0.0], None, "X: 7 numbers are needed"),
        ([float("nan")] * 7, None, "X: 7 numbers are needed"),
        (None, [0.0] * 17, "q: 18 numbers are needed"),
        ([0.0, 0.0, 0.75, 0.0, 0.0, 0.0, 0.0], None, "X: a quaternion that is not zero"),
        ([0.0, 0.0, 0.75, 0.0, 0.0, 0.0, 1.0], [0.0], "q: 18 numbers are needed"),
    ],
)
def test_impossible_poses(X: list[float] | None, q: list[float] | None, message: str) -> None:
    with pytest.raises(InputError, match=message):
        drawing.picture(manipulators.load("stewart"), X, q)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf")])
@pytest.mark.parametrize("angle", ["azimuth", "elevation"])
@pytest.mark.parametrize("name", ["stewart", "planar_3rrr"])
def test_angles_that_are_not_finite(name: str, angle: str, value: float, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=f"{angle}: a finite angle"):
        pne_sym.draw(name, tmp_path / "it.png", **{angle: value})
    assert list(tmp_path.iterdir()) == []


def test_a_pose_that_a_leg_cannot_reach() -> None:
    with pytest.raises(InputError, match=r"X: legs\[\d\] does not reach it"):
        drawing.picture(manipulators.load("planar_3rrr"), [2.0, 0.0, 0.0])


@pytest.mark.parametrize("spec", [examples.planar(), examples.spatial()])
def test_a_user_s_specification(spec: examples.Spec, tmp_path: Path) -> None:
    pne_sym.draw(from_mapping(spec, "a test"), tmp_path / "it.svg")


@pytest.mark.parametrize("scale", [1e-3, 1e3])
@pytest.mark.parametrize("name", ["stewart", "hybrid_3prps", "planar_3prr", "spherical_3ups"])
def test_any_size(name: str, scale: float) -> None:
    """A picture knows no units: a mechanism a thousand times larger looks the same."""
    model = manipulators.load(name)
    np.testing.assert_allclose(
        bounds(drawing.picture(scaled(model, scale)), scale),
        bounds(drawing.picture(model), 1.0),
        atol=1e-6,
    )


def bounds(picture: Picture, scale: float) -> list[tuple[float, ...]]:
    """Boxes around all shapes; what does not overlap may be painted in any order."""
    boxes = [(*shape.points.min(axis=0), *shape.points.max(axis=0)) for shape in picture.shapes]
    return sorted(tuple(np.round(np.array(each) / scale, 7).tolist()) for each in boxes)


def test_legs_at_all_heights_have_no_common_plate() -> None:
    model = manipulators.load("stewart")
    legs = tuple(
        dataclasses.replace(
            leg,
            base_point=(leg.base_point[0], leg.base_point[1], 0.9 * (k % 2)),
            base_frame=IDENTITY3,
        )
        for k, leg in enumerate(model.legs)
    )
    scene = scene_of(dataclasses.replace(model, legs=legs), model.home.X, model.home.q)
    picture = spatial_picture(scene, view_from(-60.0, 20.0))
    assert not any(shape.ground for shape in picture.shapes)
    assert any(shape.ground for shape in drawing.picture(model).shapes)


def test_many_legs() -> None:
    model = manipulators.load("stewart")
    q = model.home.q
    many = dataclasses.replace(
        model,
        legs=model.legs * 4,
        home=dataclasses.replace(model.home, q=q * 4),
    )
    labels = drawing.picture(many).labels
    assert sum(label.balloon for label in labels) == 24


def test_an_unknown_ending_is_refused_before_any_work(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"a picture's name ends in \.svg, \.png, \.pdf"):
        pne_sym.draw("no_such_model", tmp_path / "it.gif")


def test_a_folder_that_does_not_exist(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="No such file or directory"):
        pne_sym.draw("sixbar", tmp_path / "none" / "it.svg")


def test_matplotlib_missing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(InputError, match=r"drawing needs matplotlib: pip install"):
        pne_sym.draw("sixbar", tmp_path / "it.svg")
    assert list(tmp_path.iterdir()) == []


def scaled(model: Manipulator, scale: float) -> Manipulator:
    """The same mechanism, all lengths multiplied."""

    def stretch(vector: tuple[float, float, float]) -> tuple[float, float, float]:
        return tuple(scale * np.array(vector))  # type: ignore[return-value]

    legs = tuple(
        dataclasses.replace(
            leg,
            base_point=stretch(leg.base_point),
            platform_point=stretch(leg.platform_point),
            joints=tuple(dataclasses.replace(j, offset=stretch(j.offset)) for j in leg.joints),
            platform_joint=dataclasses.replace(
                leg.platform_joint, offset=stretch(leg.platform_joint.offset)
            ),
        )
        for leg in model.legs
    )
    kinds = [joint.kind.value for leg in model.legs for joint in leg.joints]
    q = tuple(x * scale if k == "P" else x for k, x in zip(kinds, model.home.q, strict=True))
    lengths = {"planar": 2, "point": 2, "spatial": 3, "translational": 3, "spherical": 0}
    n = lengths[model.space.value]
    X = (*(scale * x for x in model.home.X[:n]), *model.home.X[n:])
    centre = None if model.fixed_centre is None else stretch(model.fixed_centre)
    home = dataclasses.replace(model.home, X=X, q=q)
    return dataclasses.replace(model, legs=legs, home=home, fixed_centre=centre)
