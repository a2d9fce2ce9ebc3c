"""Animations: what moves and what stands, their files, and what is refused."""

from __future__ import annotations

import itertools
import subprocess
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

import pne_sym
from pne_sym import drawing, manipulators
from pne_sym.drawing.paper import layout
from pne_sym.drawing.shapes import Picture
from pne_sym.drawing.style import ACTUATED, BASE, GROUND
from pne_sym.generation import InputError
from pne_sym.writer import OutputError

PATH = [[0.05 * np.sin(s), 0.05 * np.cos(s), 0.1 * s] for s in np.linspace(0.0, 3.0, 5)]


def lift(name: str) -> list[Picture]:
    model = manipulators.load(name)
    X = np.array(model.home.X)
    return drawing.pictures(model, [(X + dz * np.eye(len(X))[2]).tolist() for dz in (0, 0.1, -0.1)])


def shapes(picture: Picture, fill: str, edge: str = "") -> list[np.ndarray]:
    return [s.points for s in picture.shapes if s.fill == fill and (not edge or s.edge == edge)]


def test_the_base_stands_and_the_rest_moves() -> None:
    frames = drawing.pictures(manipulators.load("planar_3rrr"), PATH)
    assert len(frames) == len(PATH)
    for frame in frames[1:]:
        for mine, first in zip(shapes(frame, BASE), shapes(frames[0], BASE), strict=True):
            np.testing.assert_array_equal(mine, first)
        assert [s.points.shape for s in frame.shapes] == [s.points.shape for s in frames[0].shapes]
        assert any(
            not np.array_equal(mine.points, first.points)
            for mine, first in zip(frame.shapes, frames[0].shapes, strict=True)
        )


@pytest.mark.parametrize("name", ["hexaglide", "planar_3prr"])
def test_rails_have_one_length_and_carriages_move_on_them(name: str) -> None:
    spatial = name == "hexaglide"
    model = manipulators.load(name)
    frames = lift(name) if spatial else drawing.pictures(model, PATH)

    def rails(picture: Picture) -> list[list[float]]:
        found = [s for s in picture.shapes if (s.fill == BASE if spatial else s.edge == GROUND)]
        return sorted(np.ptp(shape.points, axis=0).tolist() for shape in found)

    for frame in frames:
        np.testing.assert_allclose(rails(frame), rails(frames[0]), atol=1e-9)
    places = [shapes(frame, ACTUATED)[0].mean(axis=0) for frame in frames]
    assert float(np.ptp(places, axis=0).max()) > 0.01


def test_all_frames_have_room_on_the_page() -> None:
    frames = lift("stewart")
    plan = layout(frames)
    for frame in frames:
        for shape in frame.shapes:
            on_page = shape.points * plan.scale + plan.shift
            assert (on_page >= 0.0).all()
            assert (on_page <= [plan.width, drawing.paper.HEIGHT]).all()


def test_a_gif_has_a_frame_for_each_pose(tmp_path: Path) -> None:
    path = pne_sym.animate("planar_3rpr", tmp_path / "it.gif", PATH, fps=20)
    with Image.open(path) as film:
        assert film.n_frames == len(PATH)
        seen = []
        for k in range(film.n_frames):
            film.seek(k)
            assert film.info["duration"] == 50
            seen.append(np.asarray(film.convert("RGB"), dtype=int))
    for one, two in itertools.pairwise(seen):
        assert np.abs(one - two).max() > 100  # it moves
        assert np.mean(np.abs(one - two).max(axis=2) > 30) < 0.3  # and most of the page stands
    assert list(tmp_path.iterdir()) == [path]


def test_the_same_bytes_each_time(tmp_path: Path) -> None:
    one, two = (pne_sym.animate("sixbar", tmp_path / f"{k}.gif", [[*HOME]] * 2) for k in (1, 2))
    assert one.read_bytes() == two.read_bytes()


HOME = manipulators.load("sixbar").home.X


def test_an_mp4(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = imageio_ffmpeg.get_ffmpeg_exe()
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/ffmpeg").symlink_to(program)
    monkeypatch.setenv("PATH", str(tmp_path / "bin"), prepend=":")
    path = pne_sym.animate("planar_3rpr", tmp_path / "it.mp4", PATH)
    frames = subprocess.run(
        [program, "-i", str(path), "-f", "framemd5", "-"],
        capture_output=True,
        check=True,
        text=True,
    ).stdout
    assert sum(not line.startswith("#") for line in frames.splitlines()) == len(PATH)


def test_an_mp4_without_ffmpeg(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match=r"an MP4 needs ffmpeg, which was not found; a GIF"):
        pne_sym.animate("no_such_model", tmp_path / "it.mp4", PATH)


@pytest.mark.parametrize(
    ("poses", "fps", "name", "message"),
    [
        ([], 25, "it.gif", "poses: 1 to 1000 are needed, not 0"),
        ([[0.0, 0.0, 0.0]] * 1001, 25, "it.gif", "poses: 1 to 1000 are needed, not 1001"),
        ([[0.0, 0.0, 0.0], [9.0, 0.0, 0.0]], 25, "it.gif", r"pose 2 of 2: X: legs\[\d\] does not"),
        ([[0.0, 0.0]], 25, "it.gif", "pose 1 of 1: X: 3 numbers are needed"),
        (PATH, 0, "it.gif", "fps: 1 to 100 frames per second are needed, not 0"),
        (PATH, 101, "it.gif", "fps: 1 to 100 frames per second are needed, not 101"),
        (PATH, 25, "it.svg", r"cannot animate .*it.svg: its name ends in .gif, .mp4"),
    ],
)
def test_what_cannot_be_animated(
    poses: list[list[float]], fps: int, name: str, message: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=message):
        pne_sym.animate("planar_3rrr", tmp_path / name, poses, fps=fps)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_does_not_exist(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="No such file or directory"):
        pne_sym.animate("sixbar", tmp_path / "none" / "it.gif", [[*HOME]])
