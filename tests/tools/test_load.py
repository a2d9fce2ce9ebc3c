"""No test depends on how busy the machine is."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
# Time on the wall; the processor's time (time.process_time, resource.getrusage) is a process's own.
WALL = re.compile(r"\b(?:perf_counter|monotonic|time\.time|signal\.alarm|ITIMER_REAL)\b")
SHORT = re.compile(r"\btimeout\s*=\s*\d+")
DEADLINE = re.compile(r"\bsettings\((?![^)]*deadline=None)", re.DOTALL)
# These tell how long they took, and judge nothing by it.
TOLD = {"fuzz/fuzz.py", "hostile/campaign.py", "mutants/run.py", "random/tally.py",
        "tools/analyse_c.py", "tools/prove.py"}  # fmt: skip


@pytest.mark.parametrize("path", sorted(TESTS.rglob("*.py")), ids=lambda path: path.stem)
def test_nothing_is_judged_by_time_on_the_wall(path: Path) -> None:
    text, name = path.read_text(encoding="utf-8"), path.relative_to(TESTS).as_posix()
    if path == Path(__file__):
        return
    assert not SHORT.findall(text), "a process gets HANG seconds (tests/cli/program.py)"
    assert not re.search(r"assert .*(?:perf_counter|monotonic)", text)
    assert name in TOLD or not WALL.findall(text)
    assert not DEADLINE.findall(text), "Hypothesis has a deadline of 200 ms unless told otherwise"
