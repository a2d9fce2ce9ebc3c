"""A starter loads, closes, is driven, and can be generated, for many architectures."""

from __future__ import annotations

import tomllib
import types
import warnings
from pathlib import Path

import numpy as np
import pytest

from pne_sym import pipeline
from pne_sym.mechanics.mobility import mobility
from pne_sym.model.errors import SpecError, SpecWarning
from pne_sym.model.reader import from_text, read_spec
from pne_sym.starter import starter_text, write_starter
from tests.sampling import sampled

# architecture, space, freedoms, drives, constraints, extra coordinates
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
    assert [found.freedoms, found.drives, found.constraints, found.extra] == expected
    assert found.singular_legs == ()
    assert found.undriven == found.passive


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


def test_drives_that_cannot_hold_are_told(tmp_path: Path) -> None:
    with pytest.warns(SpecWarning, match="fewer drives than freedoms: 2 for 6"):
        write_starter(tmp_path / "one.toml", "1-UPS+2-U_PS")
