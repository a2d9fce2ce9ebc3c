"""`pne-gen draw`, the installed program."""

from __future__ import annotations

from pathlib import Path

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
