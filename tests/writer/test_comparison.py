"""What stands there, compared with what would be generated."""

from __future__ import annotations

from pathlib import Path

import pytest

from pne_sym.comparison import Difference, DifferenceKind, check_model
from pne_sym.writer import OutputError, write_model

FILES = {"robot.py": "a\nb\nc\n", "robot.json": '{"generator": "pne_sym"}\n'}


def test_nothing_differs_after_writing(tmp_path: Path) -> None:
    write_model(tmp_path, "robot", FILES)
    assert check_model(tmp_path, "robot", FILES) == []


def test_every_kind_of_difference_sorted_by_path(tmp_path: Path) -> None:
    write_model(tmp_path, "robot", FILES)
    expected = {"robot.py": "a\nx\nc\n", "robot.c": "int x;\n"}
    changed, missing, stale = (
        next(d for d in check_model(tmp_path, "robot", expected) if d.kind is kind)
        for kind in (DifferenceKind.CHANGED, DifferenceKind.MISSING, DifferenceKind.STALE)
    )
    path = tmp_path / "robot/robot.py"
    diff = (
        f"--- {path} (as it stands)\n+++ {path} (as generated)\n@@ -1,3 +1,3 @@\n a\n-b\n+x\n c\n"
    )
    assert changed == Difference(Path("robot/robot.py"), DifferenceKind.CHANGED, diff)
    assert missing == Difference(Path("robot/robot.c"), DifferenceKind.MISSING)
    assert stale == Difference(Path("robot/robot.json"), DifferenceKind.STALE)
    paths = [difference.path.name for difference in check_model(tmp_path, "robot", expected)]
    assert paths == ["robot.c", "robot.json", "robot.py"]


def test_all_is_missing_where_there_is_no_folder(tmp_path: Path) -> None:
    differences = check_model(tmp_path / "none", "robot", FILES)
    assert [difference.kind for difference in differences] == [DifferenceKind.MISSING] * 2


@pytest.mark.parametrize(
    ("found", "line"),
    [
        (b"a\nb\nc", "\\ No newline at end of file"),
        (b"a\r\nb\nc\n", "-a\r"),
        (b"a\n\xff\nc\n", "-\\xff"),
        (b"", "@@ -0,0 +1,3 @@"),
        (b"a\n\x0cb\nc\n", "-\x0cb"),
    ],
)
def test_differences_that_are_easily_overlooked(found: bytes, line: str, tmp_path: Path) -> None:
    write_model(tmp_path, "robot", FILES)
    (tmp_path / "robot/robot.py").write_bytes(found)
    (difference,) = check_model(tmp_path, "robot", FILES)
    assert line in difference.diff.split("\n")


def test_a_folder_in_the_place_of_a_file_cannot_be_read(tmp_path: Path) -> None:
    (tmp_path / "robot/robot.py").mkdir(parents=True)
    with pytest.raises(OutputError, match="cannot read"):
        check_model(tmp_path, "robot", FILES)


def test_a_name_cannot_lead_out(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="not a model name"):
        check_model(tmp_path, "..", FILES)
