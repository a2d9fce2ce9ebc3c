"""`pne-gen draw`, the installed program."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from pne_sym import manipulators
from pne_sym.cli.app import app
from pne_sym.cli.arguments import OPTIONS_WITH_VALUE
from tests.cli.program import pne_gen


def test_a_name_of_the_catalogue(tmp_path: Path) -> None:
    done = pne_gen("draw", "stewart", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("wrote stewart.svg: ")
    assert (tmp_path / "stewart.svg").read_text().startswith("<?xml")


def test_a_specification_of_one_s_own(tmp_path: Path) -> None:
    pne_gen("new", "mine.toml", "--legs", "3-RPS", cwd=tmp_path)
    done = pne_gen("draw", "mine.toml", "--out", "it.png", "--azimuth", "20", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "it.png").read_bytes().startswith(b"\x89PNG")


def test_options_may_stand_first(tmp_path: Path) -> None:
    done = pne_gen("--out", "it.svg", "draw", "sixbar", "--quiet", cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_unknown_name(tmp_path: Path) -> None:
    refused = pne_gen("draw", "stewrt", cwd=tmp_path)
    assert refused.returncode == 2
    assert "did you mean stewart" in refused.stderr
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_written(tmp_path: Path) -> None:
    refused = pne_gen("draw", "stewart", "--out", tmp_path / "none" / "it.svg")
    assert refused.returncode == 2
    assert refused.stderr.count("\n") == 1
    assert "cannot write" in refused.stderr


def test_an_angle_that_is_not_finite(tmp_path: Path) -> None:
    refused = pne_gen("draw", "stewart", "--azimuth", "nan", "-o", tmp_path / "it.png")
    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr == (
        "pne-gen: error: azimuth: a finite angle (degrees) is needed, not nan\n"
    )


def test_matplotlib_missing(tmp_path: Path) -> None:
    (tmp_path / "matplotlib.py").write_text("raise ImportError('no matplotlib')\n")
    refused = pne_gen("draw", "stewart", cwd=tmp_path, real=True, PYTHONPATH=str(tmp_path))
    assert refused.returncode == 2
    assert refused.stderr == (
        "pne-gen: error: drawing needs matplotlib: pip install 'pne-sym[draw]'\n"
    )
    assert not (tmp_path / "stewart.svg").exists()


def test_a_pose(tmp_path: Path) -> None:
    """Roll, pitch and yaw or the quaternion: the same picture, not that at home."""
    half = math.sin(0.1), math.cos(0.1)
    for name, pose in (
        ("rpy", "0.05,0,0.8,0,0,0.2"),
        ("X", f"0.05 0 0.8 0 0 {half[0]!r} {half[1]!r}"),
        ("home", None),
    ):
        extra = () if pose is None else ("--pose", pose)
        done = pne_gen("draw", "stewart", "-o", f"{name}.svg", *extra, cwd=tmp_path)
        assert (done.returncode, done.stderr) == (0, "")
    texts = {path.stem: path.read_bytes() for path in tmp_path.iterdir()}
    assert texts["rpy"] == texts["X"] != texts["home"]


def test_a_pose_that_begins_with_a_minus_and_a_first_guess(tmp_path: Path) -> None:
    q = ",".join(map(str, manipulators.load("planar_3rpr").home.q))
    done = pne_gen(
        *("--pose", "-0.02,0,0.1", "--q", q), "draw", "planar_3rpr", "-o", "it.svg", cwd=tmp_path
    )
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--pose", "0,0"), "--pose: 3 numbers (x, y, phi) are needed, not 2 (0, 0)"),
        (("--pose", "0,a,0"), "--pose: 'a' is not a number; commas stand between"),
        (("--pose", ""), "--pose: '' is not a number; commas stand between"),
        (("--pose", "9,0,0"), "X: legs[1] does not reach it; a loop-closure residual of 8.7"),
        (("--q", "1,2"), "q: 6 numbers are needed, not [1.0, 2.0]"),
        (("--pose", "0,0,0", "--path", "a.csv"), "--pose and --path exclude each other"),
        (("--path", "none.csv"), "none.csv: cannot be read: No such file or directory"),
        (("--path", "a.csv", "-o", "a.png"), "cannot animate a.png: its name ends in .gif, .mp4"),
        (("--path", "a.csv"), "a.csv: line 4: 3 numbers (x, y, phi) are needed, not 2 (0, 0)"),
        (("--path", "b.csv"), "b.csv: line 2: 'x' is not a number; commas stand between"),
        (
            ("--path", "c.csv"),
            "c.csv: pose 2 of 2: X: legs[1] does not reach it; a loop-closure residual of 8.7",
        ),
        (("--path", "d.csv"), "d.csv: poses: 1 to 1000 are needed, not 0"),
    ],
)
def test_poses_at_fault(arguments: tuple[str, ...], message: str, tmp_path: Path) -> None:
    files = {
        "a.csv": "x,y,phi\n\n0,0,0\n0,0\n",
        "b.csv": "0,0,0\nx,y,phi\n",
        "c.csv": "0 0 0\n9 0 0\n",
        "d.csv": "# nothing\nx,y,phi\n",
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    refused = pne_gen("draw", "planar_3rrr", *arguments, cwd=tmp_path)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr.startswith(f"pne-gen: error: {message}")
    assert refused.stderr.count("\n") == 1
    assert {path.name for path in tmp_path.iterdir()} == set(files)


def test_an_animation(tmp_path: Path) -> None:
    (tmp_path / "poses.csv").write_text("x,y,phi\n0,0,0  # home\n0.02,0,0.1\n")
    done = pne_gen("draw", "planar_3rpr", "--path", "poses.csv", "--fps", "10", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("wrote planar_3rpr.gif: ")
    assert (tmp_path / "planar_3rpr.gif").read_bytes().startswith(b"GIF89a")


def test_options_with_values_are_known_as_such() -> None:
    """Else their values, before the command, would be taken for it."""
    taking = {
        name
        for command in app.commands.values()
        for option in command.params
        if option.param_type_name == "option" and not option.is_flag
        for name in option.opts
    }
    assert taking == set(OPTIONS_WITH_VALUE)
