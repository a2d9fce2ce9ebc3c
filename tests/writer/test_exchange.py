"""A folder is never absent, nor ever half there, while it is replaced."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

from pne_sym import exchange as module
from pne_sym import writer
from pne_sym.exchange import exchange
from pne_sym.writer import write_model
from tests.writer.test_writer import CRASHING, NEW, OLD, content, in_model

linux = pytest.mark.skipif(sys.platform != "linux", reason="only Linux has renameat2")

WATCHER = """
import sys
from pathlib import Path

folder, stop = Path(sys.argv[1]), Path(sys.argv[2])
looks = absent = 0
print("watching", flush=True)
while not stop.exists():
    for _ in range(200):
        looks += 1
        absent += not folder.is_dir()
print(looks, absent)
"""


def two_folders(place: Path) -> tuple[Path, Path]:
    for name in ("one", "other"):
        (place / name).mkdir()
        (place / name / "file").write_text(name)
    return place / "one", place / "other"


def told(*folders: Path) -> list[str]:
    return [(folder / "file").read_text() for folder in folders]


@linux
def test_two_folders_change_places(tmp_path: Path) -> None:
    folders = two_folders(tmp_path)
    assert exchange(*folders)
    assert told(*folders) == ["other", "one"]


@linux
def test_names_are_bytes_of_the_file_system(tmp_path: Path) -> None:
    one, other = two_folders(tmp_path)
    odd = one.rename(tmp_path / os.fsdecode(b"a \xc3\xa9 \xff"))
    assert exchange(odd, other)
    assert told(odd, other) == ["other", "one"]


@pytest.mark.parametrize("absent", ["one", "other"])
def test_without_one_of_them_nothing_happens(absent: str, tmp_path: Path) -> None:
    folders = two_folders(tmp_path)
    (tmp_path / absent).rename(tmp_path / "elsewhere")
    assert not exchange(*folders)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        {"one", "other", "elsewhere"} - {absent}
    )


class Library:
    """A C library in which `renameat2` fails, as on a file system that cannot exchange."""

    class renameat2:  # noqa: N801
        argtypes: tuple[Any, ...]

        def __new__(cls, *_: object) -> int:  # type: ignore[misc]
            return -1


def no_library(_: None) -> Any:
    raise OSError("no shared C library")


@pytest.mark.parametrize("library", [lambda _: object(), lambda _: Library, no_library])
def test_where_there_is_no_such_step_two_renames_do(
    library: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_model(tmp_path, "robot", OLD)
    renamed: list[str] = []
    rename = Path.rename

    def noted(path: Path, target: Path) -> Path:
        renamed.append(path.name)
        return rename(path, target)

    monkeypatch.setattr(module.ctypes, "CDLL", library)
    monkeypatch.setattr(Path, "rename", noted)
    write_model(tmp_path, "robot", NEW)
    assert renamed == ["robot", ".robot.pne-tmp"]
    assert content(tmp_path) == in_model(NEW)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["__init__.py", "robot"]


@pytest.mark.parametrize("platform", ["darwin", "win32"])
def test_other_systems_are_not_asked(
    platform: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module.sys, "platform", platform)
    monkeypatch.setattr(module.ctypes, "CDLL", lambda _: pytest.fail("asked"))
    folders = two_folders(tmp_path)
    assert not exchange(*folders)
    assert told(*folders) == ["one", "other"]


@linux
def test_at_every_line_of_the_writer_a_whole_folder_is_in_place(tmp_path: Path) -> None:
    write_model(tmp_path, "robot", OLD)
    found = []

    def look(frame: FrameType, event: str, _: object) -> Any:
        if frame.f_code.co_filename != writer.__file__:
            return None
        sys.settrace(None)
        found.append(content(tmp_path / "robot"))
        sys.settrace(look)
        return look

    before = sys.gettrace()
    sys.settrace(look)
    try:
        write_model(tmp_path, "robot", NEW)
    finally:
        sys.settrace(before)
    assert found[0] == OLD
    assert found[-1] == NEW
    assert all(files in (OLD, NEW) for files in found)
    assert len(found) > 100


@linux
def test_a_process_that_watches_never_misses_the_folder(tmp_path: Path) -> None:
    out, stop = tmp_path / "out", tmp_path / "stop"
    write_model(out, "robot", OLD)
    watcher = subprocess.Popen(
        [sys.executable, "-c", WATCHER, out / "robot", stop], stdout=subprocess.PIPE, text=True
    )
    assert watcher.stdout is not None
    with watcher:
        assert watcher.stdout.readline() == "watching\n"
        for times in range(100):
            write_model(out, "robot", NEW if times % 2 else OLD)
        stop.touch()
        looks, absent = map(int, watcher.stdout.readline().split())
    assert absent == 0
    assert looks >= 200


@linux
@pytest.mark.slow
def test_after_a_crash_at_any_line_the_folder_is_in_place_at_once(tmp_path: Path) -> None:
    """Without a further run that would put it back."""
    for at in range(1, 1000, 3):
        out = tmp_path / str(at)
        write_model(out, "robot", OLD)
        crashed = subprocess.run([sys.executable, "-c", CRASHING, str(at), out], check=False)
        assert content(out / "robot") in (OLD, NEW), f"line {at}"
        if crashed.returncode == 0:
            assert at > 60
            return
        assert crashed.returncode == 9
    pytest.fail("no end of lines")
