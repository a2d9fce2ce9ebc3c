"""`pne-gen new` through the program itself."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.program import pne_gen, tree
from tests.cli.test_faults import assert_refused


def test_writes_a_specification_that_can_be_generated(tmp_path: Path) -> None:
    done = pne_gen("new", "my_robot.toml", "--legs", "3-RPR", cwd=tmp_path, real=True)
    assert (done.returncode, done.stderr) == (0, "")
    told, following = done.stdout.splitlines()
    assert told.startswith("wrote my_robot.toml: 3 degrees of freedom at home, 3 actuators")
    assert following == "next: edit it, then pne-gen my_robot.toml --out generated/"
    done = pne_gen("my_robot.toml", "--out", "generated", cwd=tmp_path, real=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert "  3 degrees of freedom at home, 3 actuators, 0 constraints" in done.stdout
    assert (tmp_path / "generated/my_robot/my_robot.py").is_file()


def test_quiet_and_order_of_options(tmp_path: Path) -> None:
    done = pne_gen(
        "--legs", "2-RRR", "-q", "new", "--space", "point", "a.toml", cwd=tmp_path, real=True
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert set(tree(tmp_path)) == {"a.toml"}


def test_does_not_replace_unless_forced(tmp_path: Path) -> None:
    path = tmp_path / "my_robot.toml"
    path.write_text("mine")
    assert_refused(pne_gen("new", path, "--legs", "6-UPS", real=True), "the file exists")
    assert path.read_text() == "mine"
    assert pne_gen("new", path, "--legs", "3-RPR", "--force", real=True).returncode == 0
    assert "3-RPR" in path.read_text()


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (("--legs", "6-UPX"), "--legs: joint 'X' in '6-UPX'; expected R revolute"),
        (("--legs", "six"), "--legs: joint 'I' in 'six'"),
        (("--legs", "$(reboot)"), "--legs: value '$(reboot)'; expected COUNT-LETTERS"),
        (("--legs", "6-UPS", "--space", "plane"), "--space: value 'plane'; expected one of"),
        (("--legs", "3-UPS", "--space", "planar"), "joint 'U' of UPS leaves the plane"),
        (("--legs", "6-UPS", "--height", "1"), "angles and --height belong to --radii or --points"),
        (("--legs", "6-UPS", "--radii", "1,2"), "--radii needs --base-angles"),
        (("--legs", "3-RPR", "--radii", "a", "--base-angles", "0"), "'a' is not a number"),
        (("--legs", "6-UPS", "--points", "p.csv"), "p.csv: cannot be read: No such file"),
        (("--legs", "6-UPS", "--points", "p", "--radii", "1,2"), "exclude each other"),
    ],
)
def test_refusals(arguments: tuple[str, ...], part: str, tmp_path: Path) -> None:
    assert_refused(pne_gen("new", "a.toml", *arguments, cwd=tmp_path, real=True), part)
    assert tree(tmp_path) == {}


def test_legs_are_required(tmp_path: Path) -> None:
    done = pne_gen("new", "a.toml", cwd=tmp_path)
    assert done.returncode == 2
    assert "--legs" in done.stderr
