"""How long `pne-gen diff` takes: processor seconds against those of a generation."""

from __future__ import annotations

import resource
from pathlib import Path

import pytest

from tests.cli.program import pne_gen
from tests.cli.test_diff import heavier
from tests.cli.test_generate import own_spec


def seconds(*arguments: str | Path, code: int) -> float:
    """Of the program and what it starts, on all processors."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert pne_gen(*arguments, real=True, fresh=True).returncode == code
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (after.ru_utime + after.ru_stime) - (before.ru_utime + before.ru_stime)


@pytest.mark.only_in_all
def test_two_specifications_and_two_folders(tmp_path: Path) -> None:
    """At most a generation a side and a second; next to nothing for folders that are equal."""
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    one, two = own_spec(tmp_path / "a"), own_spec(tmp_path / "b")
    heavier(two)
    generation = seconds(one, "--out", tmp_path / "a/generated", code=0)
    assert pne_gen(one, "--out", tmp_path / "b/generated", real=True).returncode == 0
    assert seconds("diff", one, two, "-q", code=1) <= 2 * generation + 1.0
    folders = [tmp_path / side / "generated/my_robot" for side in "ab"]
    assert seconds("diff", *folders, code=0) <= max(0.5, 0.4 * generation)
