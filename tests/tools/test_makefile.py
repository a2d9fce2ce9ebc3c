"""The Makefile's own promises."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
MAKEFILE = (REPOSITORY / "Makefile").read_text()
TARGETS = re.findall(r"^\.PHONY: (\S+)$", MAKEFILE, re.MULTILINE)


def test_help_tells_every_target() -> None:
    done = subprocess.run(
        ["make", "help"], cwd=REPOSITORY, capture_output=True, text=True, check=True
    )
    told = re.findall(r"^  make (\S+) +\S", done.stdout, re.MULTILINE)
    assert told == TARGETS
    assert len(TARGETS) > 15


def test_check_runs_every_check() -> None:
    (rest,) = re.findall(r"^check-rest: (.*?) ##", MAKEFILE, re.MULTILINE)
    checks = {target for target in TARGETS if target.startswith("check-")} - {"check-rest"}
    assert set(rest.split()) == checks | {"wheel-test"}
    assert "check: test check-rest" in MAKEFILE


def test_ci_runs_the_same_targets() -> None:
    script = (REPOSITORY / ".ci/run").read_text()
    assert re.search(r"^make test$", script, re.MULTILINE)
    assert re.search(r"^make --keep-going (--\S+ )*check-rest$", script, re.MULTILINE)


@pytest.mark.parametrize(("ci", "code"), [("true", 1), ("", 0)])
def test_what_did_not_run_is_seen_and_fails_in_ci(ci: str, code: int) -> None:
    done = subprocess.run(
        ["sh", REPOSITORY / "tests/tools/not-run.sh", "check-math: no node"],
        env={"CI": ci, "PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (code, "")
    assert "*** NOT RUN: check-math: no node ***" in done.stderr
