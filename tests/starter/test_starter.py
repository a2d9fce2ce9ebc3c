"""A starter loads, closes, is actuated, and can be generated, for many architectures."""

from __future__ import annotations

import math
import tomllib
import types
import warnings
from pathlib import Path

import numpy as np
import pytest

from pne_sym import pipeline
from pne_sym.mechanics.mobility import mobility
from pne_sym.model.errors import SpecError, SpecNote, SpecWarning
from pne_sym.model.manipulator import Space
from pne_sym.model.reader import from_text, read_spec
from pne_sym.starter import PointsFile, Rings, parse_legs, starter_text, write_starter
from tests.sampling import sampled

# architecture, space, degrees of freedom, actuators, constraints, extra coordinates
KNOWN: list[tuple[str, str | None, int, int, int, int]] = [
    ("6-UPS", None, 6, 6, 0, 0),
    ("7-UPS", None, 6, 7, 0, 0),
    ("6-SPS", None, 12, 6, 0, 6),
    ("6-RUS", None, 6, 6, 0, 0),
    ("6-PUS", None, 6, 6, 0, 0),
    ("6-UHS", None, 6, 6, 0, 0),
    ("6-UCU", None, 6, 6, 0, 0),
    ("6-RRRRRR", None, 6, 6, 0, 0),
    ("3-PRPS", None, 6, 6, 0, 0),
    ("3-CRS", None, 6, 6, 0, 0),
    ("3-RRRS", None, 6, 6, 0, 0),
    ("4-RRRS", None, 6, 8, 0, 0),
    ("1-RRRRS+2-RRRS", None, 7, 7, 0, 1),
    ("3-UPS+3-RUS", None, 6, 6, 0, 0),
    ("3-RPS", None, 3, 3, 3, 0),
    ("3-PRS", None, 3, 3, 3, 0),
    ("3-RRS", None, 3, 3, 3, 0),
    ("3-UPU", None, 3, 3, 3, 0),
    ("3-RUU", None, 3, 3, 3, 0),
    ("3-RUS", "translational", 3, 3, 0, 0),
    ("3-UPS", "translational", 3, 3, 0, 0),
    ("3-UPS", "spherical", 3, 3, 0, 0),
    ("3-RPR", None, 3, 3, 0, 0),
    ("3-RRR", None, 3, 3, 0, 0),
    ("3-PRR", None, 3, 3, 0, 0),
    ("2-RPR+1-RRR", None, 3, 3, 0, 0),
    ("4-RPR", None, 3, 4, 0, 0),
    ("2-RRR", None, 3, 4, 0, 0),
    ("3-PRRR", None, 6, 6, 0, 3),
    ("2-RRR", "point", 2, 2, 0, 0),
    ("2-RPR", "point", 2, 2, 0, 0),
    ("2-PRR", "point", 2, 2, 0, 0),
    ("6-U_PS", None, 6, 6, 0, 0),
    ("6-U_PS+1-UPS", None, 6, 6, 0, 0),
    ("2-_R_RR", "point", 2, 4, 0, 0),
    ("3-_RPR", None, 3, 3, 0, 0),
    ("3-UPS+1-UPW", None, 3, 3, 3, 0),
    ("4-UPS+1-UPW", None, 3, 4, 3, 0),
    ("5-UPS+1-PRPU", None, 5, 5, 1, 0),
    ("3-RRR", "spherical", 3, 3, 0, 0),
    ("3-PRRR", "translational", 3, 3, 0, 0),
    ("3-UPU", "translational", 3, 3, 0, 0),
    ("3-RUU", "translational", 3, 3, 0, 0),
]


@pytest.mark.parametrize("row", KNOWN, ids=lambda row: f"{row[0]} {row[1] or ''}")
def test_loads_without_a_warning_and_has_the_known_mobility(
    row: tuple[str, str | None, int, int, int, int],
) -> None:
    legs, space, *expected = row
    with warnings.catch_warnings():
        warnings.simplefilter("error", SpecWarning)
        manipulator = from_text(starter_text("my_robot", legs, space), ".toml", "my_robot.toml")
    found = mobility(manipulator)
    assert [found.dofs, found.actuators, found.constraints, found.extra] == expected
    assert found.singular_legs == ()
    assert found.unheld == found.passive


@pytest.mark.slow
@pytest.mark.parametrize(
    ("legs", "space"),
    sampled(
        [
            ("2-RPR+1-RRR", None),
            ("6-UPS", None),
            ("4-RRRS", None),
            ("3-RPS", None),
            ("3-UPS", "spherical"),
            ("3-RPR", None),
            ("6-SPS", None),
            ("3-PRPS", None),
            ("2-PRR", "point"),
            ("3-RUS", "translational"),
        ],
        4,
    ),
)
def test_generates_and_the_model_is_regular_at_home(legs: str, space: str | None) -> None:
    manipulator = from_text(starter_text("my_robot", legs, space), ".toml", "my_robot.toml")
    module = types.ModuleType("my_robot")
    exec(pipeline.compile_model(manipulator)["my_robot.py"], module.__dict__)
    X = np.array(manipulator.home.X)
    np.testing.assert_allclose(module.inverse_kinematics(X), manipulator.home.q, atol=1e-9)
    A, *_ = module.forward_dynamics(X, np.zeros(module.NV), np.zeros(module.NU)), None
    assert all(np.isfinite(part).all() for part in (A if isinstance(A, tuple) else (A,)))


def test_text_is_commented_and_plain_toml() -> None:
    text = starter_text("my_robot", "6-UPS")
    data = tomllib.loads(text)
    assert data["name"] == "my_robot"
    assert len(data["legs"]) == 6
    assert sum(line.startswith("#") for line in text.splitlines()) > 20
    assert max(map(len, text.splitlines())) <= 100
    assert starter_text("my_robot", "6-UPS") == text


def test_file_is_written_once(tmp_path: Path) -> None:
    path = tmp_path / "my_robot.toml"
    first = write_starter(path, "3-RPR")
    assert read_spec(path) == first
    with pytest.raises(SpecError, match=r"the file exists; expected another name, or --force"):
        write_starter(path, "6-UPS")
    assert read_spec(path) == first
    assert len(write_starter(path, "2-RRR", "point", force=True).legs) == 2
    assert [file.name for file in tmp_path.iterdir()] == ["my_robot.toml"]


@pytest.mark.parametrize(
    ("name", "legs", "message"),
    [
        ("my_robot.json", "3-RPR", "file of kind '.json'; expected a .toml file"),
        ("my_robot", "3-RPR", "file of kind ''; expected a .toml file"),
        ("My-Robot.toml", "3-RPR", "value 'My-Robot'; expected a lower-case letter"),
        ("lambda.toml", "3-RPR", "'lambda' is a Python keyword"),
        ("check.toml", "3-RPR", "'check' is a command of pne-gen"),
        ("no/such/my_robot.toml", "3-RPR", "cannot be written: No such file or directory"),
        ("my_robot.toml", "3-RPQ", "joint 'Q' in '3-RPQ'"),
    ],
)
def test_nothing_is_written_on_refusal(name: str, legs: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(SpecError, match=message.replace("(", r"\(")):
        write_starter(tmp_path / name, legs)
    assert list(tmp_path.iterdir()) == []


def test_a_symbolic_link_is_not_followed(tmp_path: Path) -> None:
    link = tmp_path / "my_robot.toml"
    link.symlink_to(tmp_path / "elsewhere.toml")
    with pytest.raises(SpecError, match="the file exists"):
        write_starter(link, "3-RPR")
    write_starter(link, "3-RPR", force=True)
    assert not link.is_symlink()
    assert not (tmp_path / "elsewhere.toml").exists()


@pytest.mark.parametrize(
    ("legs", "message"),
    [
        ("1-RPR+2-R_PR", "2 actuators for 3 degrees of freedom; expected more joints marked by _"),
        ("2-UPR+1-SPR", "3 actuators for 1 degree of freedom: in general position the legs put 5"),
        ("2-UPW", "overconstrained"),
    ],
)
def test_what_has_not_as_many_actuators_as_freedoms_is_not_written(
    legs: str, message: str, tmp_path: Path
) -> None:
    with pytest.raises(SpecError, match=message):
        write_starter(tmp_path / "one.toml", legs)
    assert list(tmp_path.iterdir()) == []


def test_redundant_actuators_are_told(tmp_path: Path) -> None:
    with pytest.warns(SpecNote, match="4 actuators for 3 degrees of freedom: redundantly"):
        write_starter(tmp_path / "four.toml", "2-RRR")


BASE = [(0.65, 0.05, 0.0), (0.6, 0.3, 0.01), (-0.28, 0.58, 0.02),
        (-0.36, 0.54, 0.0), (-0.37, -0.54, 0.0), (-0.28, -0.59, 0.0)]  # fmt: skip
PLATFORM = [(0.25, 0.3, 0.0), (0.3, 0.25, 0.0), (0.1, 0.38, 0.0),
            (-0.38, 0.12, 0.0), (-0.38, -0.1, 0.0), (0.12, -0.37, 0.0)]  # fmt: skip


def points_file(folder: Path, head: str = "bx,by,bz,px,py,pz\n", mark: str = ",") -> Path:
    path = folder / "points.csv"
    rows = [mark.join(map(repr, (*a, *b))) for a, b in zip(BASE, PLATFORM, strict=True)]
    path.write_text(head + "\n".join(rows) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("legs", ["6-UPS", "6-RUS"])
def test_joint_points_from_a_file(legs: str, tmp_path: Path) -> None:
    text = starter_text("mine", legs, None, PointsFile(points_file(tmp_path), 0.9))
    with warnings.catch_warnings():
        warnings.simplefilter("error", SpecWarning)
        manipulator = from_text(text, ".toml", "mine.toml")
    assert [leg.base_point for leg in manipulator.legs] == BASE
    assert [leg.platform_point for leg in manipulator.legs] == PLATFORM
    assert manipulator.home.X == (0.0, 0.0, 0.9, 0.0, 0.0, 0.0, 1.0)
    if legs == "6-UPS":
        way = np.add(PLATFORM, (0.0, 0.0, 0.9)) - np.array(BASE)
        lengths = np.linalg.norm(way, axis=1)
        np.testing.assert_allclose(np.reshape(manipulator.home.q, (6, 3))[:, 2], lengths, atol=1e-8)


@pytest.mark.parametrize(
    ("legs", "space", "height", "dofs"),
    [
        ("3-RPS", None, 0.8, 3),
        ("3-UPS+1-UPW", None, 1.3, 3),
        ("3-RRR", None, None, 3),
        ("3-RUS", "translational", -0.7, 3),
        ("3-UPS", "spherical", 0.8, 3),
    ],
)
def test_points_on_circles(legs: str, space: str | None, height: float | None, dofs: int) -> None:
    rings = Rings((0.6, 0.2), (0.0, 120.0, 240.0), (10.0, 130.0, 250.0), height)
    manipulator = from_text(starter_text("mine", legs, space, rings), ".toml", "mine.toml")
    assert mobility(manipulator).dofs == mobility(manipulator).actuators == dofs
    radii = [np.hypot(*leg.base_point[:2]) for leg in manipulator.legs[:3]]
    np.testing.assert_allclose(radii, 0.6, atol=1e-12)
    angles = [math.degrees(math.atan2(*leg.platform_point[1::-1])) for leg in manipulator.legs[:3]]
    np.testing.assert_allclose(np.mod(angles, 360.0), (10.0, 130.0, 250.0), atol=1e-9)


def test_semicolons_comments_and_no_head(tmp_path: Path) -> None:
    groups = parse_legs("6-UPS")
    found = PointsFile(points_file(tmp_path, "# mine\n\n", ";"), 1.0).points(groups, Space.SPATIAL)
    assert found.base == tuple(BASE)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("1,2,3\n", "line 1: 3 cells; expected 6 numbers: base x, base y, base z, platform x"),
        ("a,b,c,d,e,f\n1,2,3,4,5,x\n", "line 2: 'x'; expected a number, m"),
        ("1,2,3,4,5,6\n", "1 rows of numbers; expected 6: one for each leg"),
        ("", "0 rows of numbers"),
        ('1,"2,3\n', "line 1: unexpected end of data; expected a CSV file"),
        ("1,2,3,4,5,nan\n", "line 1: 'nan'; expected a number"),
    ],
)
def test_bad_points_are_refused(content: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    path.write_text(content, encoding="utf-8")
    with pytest.raises(SpecError, match=message):
        write_starter(tmp_path / "mine.toml", "6-UPS", None, PointsFile(path, 1.0))
    assert [file.name for file in tmp_path.iterdir()] == ["points.csv"]


def test_points_in_millimetres_are_asked_about(tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    path.write_text("300,0,30,0\n-300,10,-30,0\n0,400,0,50\n", encoding="utf-8")
    with pytest.warns(SpecWarning, match=r"coordinates up to 400 are taken as m; are they in mm\?"):
        PointsFile(path, None).points(parse_legs("3-RPR"), Space.PLANAR)
