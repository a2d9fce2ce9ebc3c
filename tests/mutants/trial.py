"""Trials: a copy of the sources, a fault in it, the tests that are to find it."""

from __future__ import annotations

import enum
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from tests.mutants.faults import ROOT, Fault, FaultError

COPIED = ("pne_sym", "templates", "tests", "docs", "README.md", "pyproject.toml", "LICENSE")
_LEFT_OUT = shutil.ignore_patterns("gallery", "node_modules")
_MEMORY = 8 * 2**30
_FAILED = re.compile(r"^(?:FAILED|ERROR) (\S+(?:\[.*?\])?)(?: - (.*))?$", re.MULTILINE)
_BROKEN = ("NameError", "ImportError", "SyntaxError", "UnboundLocalError", "ModuleNotFoundError")
"""A mutant that dies of these is no fault that anybody makes: its row is wrong."""


class Verdict(enum.StrEnum):
    """What became of a fault."""

    KILLED = "killed"
    KILLED_LATE = "killed late"
    """By the wider set alone."""
    TIMEOUT = "timeout"
    """No verdict in time: the tests are slow, or the mutant runs on and on."""
    SURVIVED = "SURVIVED"
    WRONG = "WRONG ROW"
    NOT_RUN = "NOT RUN"

    @property
    def is_good(self) -> bool:
        """Whether a test has seen the fault."""
        return self in (Verdict.KILLED, Verdict.KILLED_LATE)


@dataclass(frozen=True)
class Outcome:
    """A fault's verdict, and by what.

    Attributes:
        fault: the row.
        verdict: what became of it.
        by: the test that found it, or what is wrong with the row.
    """

    fault: Fault
    verdict: Verdict
    by: str = ""


@dataclass(frozen=True)
class Run:
    """A run of tests: exit code of pytest (None: killed after its time), what failed first."""

    seconds: float
    code: int | None
    failed: str
    why: str
    output: str


def copy_sources(folder: Path) -> Path:
    """A copy of what tests need, without what is generated; returns its top.

    Times of files are kept, so that what Python has compiled of them is still theirs.
    """
    top = folder / "copy"
    top.mkdir()
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, top / name, ignore=_LEFT_OUT)
        else:
            shutil.copy2(source, top / name)
    return top


def run_tests(top: Path, tests: Sequence[str], seconds: float) -> Run:
    """Tests in a copy, up to the first failure, within a time."""
    command = [
        *(sys.executable, "-m", "pytest", "-x", "-q", "--tb=short", "-n", "0"),
        *("-p", "no:cacheprovider", f"--basetemp={top.parent / 'tmp'}", *tests),
    ]
    with subprocess.Popen(
        command,
        cwd=top,
        env=_environment(top),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
        preexec_fn=_limit_memory,  # noqa: PLW1509
    ) as process:
        try:
            output, _ = process.communicate(timeout=seconds)
            code: int | None = process.returncode
        except subprocess.TimeoutExpired:
            code, output = None, ""
        finally:
            _kill_group(process.pid)
    failed = _FAILED.search(output)
    return Run(
        seconds, code, failed[1] if failed else "", (failed[2] or "") if failed else "", output
    )


def _environment(top: Path) -> dict[str, str]:
    """The copy goes before the installed package; nothing depends on chance or on the load."""
    return {
        **os.environ,
        "PYTHONPATH": str(top),
        "PYTHONHASHSEED": "0",
        "PYTHONDONTWRITEBYTECODE": "1",
        "OPENBLAS_NUM_THREADS": "1",
        "COLUMNS": "1000",
        "TMPDIR": str(top.parent),
    }


def _limit_memory() -> None:
    """Softly: what runs under AddressSanitizer, which reserves terabytes, lifts it."""
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (_MEMORY, most))


def _kill_group(pid: int) -> None:
    """End what the run has started and left."""
    try:
        os.killpg(pid, signal.SIGKILL)
    except ProcessLookupError:
        return


def try_fault(fault: Fault, seconds: float, *, wider: bool = True) -> Outcome:
    """Plant a fault in a copy of its own and run its tests."""
    if fault.needs and find_spec(fault.needs) is None:
        return Outcome(fault, Verdict.NOT_RUN, f"needs {fault.needs}")
    with tempfile.TemporaryDirectory(prefix="mutant-", ignore_cleanup_errors=True) as folder:
        top = copy_sources(Path(folder))
        path = top / fault.file
        try:
            text = fault.mutated(path.read_text(encoding="utf-8"))
        except (FaultError, OSError) as error:
            return Outcome(fault, Verdict.WRONG, str(error))
        path.write_text(text, encoding="utf-8")
        found = _judged(fault, run_tests(top, fault.tests, seconds), Verdict.KILLED)
        if found.verdict is Verdict.SURVIVED and wider and fault.wider:
            found = _judged(fault, run_tests(top, fault.wider, seconds), Verdict.KILLED_LATE)
    return found


def _judged(fault: Fault, run: Run, killed: Verdict) -> Outcome:
    if run.code is None:
        return Outcome(fault, Verdict.TIMEOUT, f"no verdict in {run.seconds:.0f} s")
    if run.code == 0:
        return Outcome(fault, Verdict.SURVIVED)
    if run.code < 0:
        return Outcome(fault, killed, f"signal {-run.code}")
    if run.code != 1 or not run.failed:
        return Outcome(fault, Verdict.WRONG, f"pytest: exit code {run.code} {run.failed}".rstrip())
    if run.why.startswith(_BROKEN):
        return Outcome(fault, Verdict.WRONG, f"{run.failed}: {run.why}")
    return Outcome(fault, killed, run.failed)


def baseline(faults: Sequence[Fault], seconds: float) -> str:
    """What fails without any fault: then a kill means nothing.  Empty if all is well."""
    usable = [f for f in faults if not f.needs or find_spec(f.needs)]
    tests = sorted({test for f in usable for test in f.tests})
    with tempfile.TemporaryDirectory(prefix="mutant-", ignore_cleanup_errors=True) as folder:
        run = run_tests(copy_sources(Path(folder)), tests, seconds)
    return "" if run.code == 0 else f"{run.failed or run.output[-2000:] or 'no result in time'}"
