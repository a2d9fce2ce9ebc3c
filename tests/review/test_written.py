"""Edits of a specification are told once, at the paths of the author's own file."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest

from pne_sym import manipulators
from pne_sym.review.compare import compare
from pne_sym.review.difference import Change
from pne_sym.review.versions import find_version
from pne_sym.review.written import changes

FILE = manipulators.path("planar_3rpr").read_text(encoding="utf-8")


def compared(tmp_path: Path, *edits: tuple[str, str]):
    """The catalogue's file and an edited copy."""
    text = FILE
    for old, new in edits:
        assert old in text
        text = text.replace(old, new, 1)
    (tmp_path / "mine.toml").write_text(text)
    return compare(find_version("planar_3rpr"), find_version(str(tmp_path / "mine.toml")))


def one_line(tmp_path: Path, line: str) -> tuple[str, str]:
    """A line with one of its numbers made larger."""
    key, _, value = line.partition(" = ")
    return line, f"{key} = {float(value.split()[0]) + 0.125!r}"


def test_a_line_of_a_leg_type_is_one_change(tmp_path: Path) -> None:
    masses = [line for line in FILE.splitlines() if line.startswith("link.mass")]
    found = compared(tmp_path, one_line(tmp_path, masses[0]))
    assert [c.what for c in found.interface] == ["default of leg_types.rpr.joints.0.link.mass"]
    old = float(masses[0].partition(" = ")[2].split()[0])
    assert (found.interface[0].before, found.interface[0].after) == (str(old), str(old + 0.125))
    assert not found.equal


def test_another_notation_of_the_same_is_no_change(tmp_path: Path) -> None:
    gravity = next(line for line in FILE.splitlines() if line.startswith("gravity"))
    found = compared(tmp_path, (gravity, "gravity = [0, -9.81, 0]"))
    assert found.equal
    assert found.interface == ()


def test_a_folder_has_paths_of_the_full_form(tmp_path: Path) -> None:
    """What its author wrote is not known of a generated folder."""
    import pne_sym  # noqa: PLC0415

    folder = pne_sym.generate("planar_3rpr", tmp_path)
    masses = [line for line in FILE.splitlines() if line.startswith("link.mass")]
    old, new = one_line(tmp_path, masses[0])
    (tmp_path / "mine.toml").write_text(FILE.replace(old, new, 1))
    found = compare(find_version(str(folder)), find_version(str(tmp_path / "mine.toml")))
    assert [c.what for c in found.interface] == [
        f"default of legs[{leg}].joints[0].link.mass" for leg in range(3)
    ]


CASES: list[tuple[dict[str, Any], dict[str, Any], list[Change]]] = [
    ({"a": {"b": 1}}, {"a": {"b": 1}}, []),
    ({"name": "a", "title": "b"}, {"name": "c"}, []),
    ({"a": [1, 2]}, {"a": [1, 3]}, [Change("changed", "default of a", "[1, 2]", "[1, 3]")]),
    ({"q": [[1], [3]]}, {"q": [[1], [4]]}, [Change("changed", "default of q.1", "[3]", "[4]")]),
    ({"a": {}}, {"a": {"b": 0}}, [Change("added", "default of a.b", "", "0")]),
    ({"a": {"b": 0}}, {"a": {}}, [Change("removed", "default of a.b", "0", "")]),
    (
        {"legs": [{"x": 1}]},
        {"legs": [{"x": 2}, {"x": 3}]},
        [
            Change("changed", "default of legs.0.x", "1", "2"),
            Change("added", "default of legs.1", "", "{'x': 3}"),
        ],
    ),
]  # fmt: skip


@pytest.mark.parametrize(("before", "after", "expected"), CASES)
def test_changes(before: dict[str, Any], after: dict[str, Any], expected: list[Change]) -> None:
    assert list(changes(before, after)) == expected


@pytest.mark.parametrize("name", manipulators.names())
def test_a_file_does_not_differ_from_itself(name: str) -> None:
    data = tomllib.loads(manipulators.path(name).read_text(encoding="utf-8"))
    assert list(changes(data, data)) == []
