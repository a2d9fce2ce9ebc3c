"""Whatever interrupts `pne-gen`, a whole folder stands there: the old or the new one."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
from pathlib import Path

import pytest

from tests.cli.program import HANG, PROGRAM, environment, heed_interrupts, pne_gen, start, tree


@pytest.fixture
def old(tmp_path: Path) -> dict[str, bytes]:
    """A model that was generated before; `tmp_path` is the output folder."""
    pne_gen("stewart", "--out", tmp_path)
    return tree(tmp_path)


def interrupt(out: Path, fault: str, marker: str) -> tuple[int, str]:
    process = start("stewart", "--out", out, fault=fault)
    assert process.stderr is not None
    assert process.stderr.readline() == f"{marker}\n"
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=HANG)
    return process.returncode, errors


@pytest.mark.parametrize(
    ("fault", "marker"), [("slow compile", "compiling"), ("slow write", "writing")]
)
def test_control_c_leaves_the_old_folder_and_no_litter(
    fault: str, marker: str, old: dict[str, bytes], tmp_path: Path
) -> None:
    code, errors = interrupt(tmp_path, fault, marker)
    assert (code, errors) == (130, "pne-gen: error: interrupted\n")
    assert tree(tmp_path) == old


def test_control_c_ends_the_worker_processes_too(tmp_path: Path) -> None:
    """The terminal's Ctrl-C goes to every process of the group."""
    process = subprocess.Popen(
        [PROGRAM, "all", "--out", tmp_path / "out", "--jobs", "2"],
        env=environment(fault="slow compile"),
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=heed_interrupts,  # noqa: PLW1509 (no threads)
    )
    assert process.stderr is not None
    assert process.stderr.readline() == "compiling\n"
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=HANG)
    assert process.returncode == 130
    assert errors.replace("compiling\n", "") == "pne-gen: error: interrupted\n"
    assert list(tmp_path.iterdir()) == []


def test_control_c_in_the_first_generation_leaves_nothing(tmp_path: Path) -> None:
    code, _ = interrupt(tmp_path / "a/b", "slow write", "writing")
    assert code == 130
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_leaves_the_old_folder_and_no_litter(
    old: dict[str, bytes], tmp_path: Path
) -> None:
    done = pne_gen("stewart", "--out", tmp_path, fault="full disk", PNE_TEST_VERSION="2")
    assert done.returncode == 2
    assert (
        done.stderr == f"pne-gen: error: cannot write {tmp_path}/stewart: No space left on device\n"
    )
    assert tree(tmp_path) == old


def test_a_refused_write_leaves_the_old_folder_and_no_litter(
    old: dict[str, bytes], tmp_path: Path
) -> None:
    """The system itself refuses: no file may exceed 2 kB, and the C file does."""
    done = subprocess.run(
        [PROGRAM, "stewart", "--out", tmp_path],
        env=environment(PNE_TEST_VERSION="2"),
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000)),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert "File too large" in done.stderr
    assert done.stderr.count("\n") == 1
    assert tree(tmp_path) == old


def test_after_a_crash_between_the_renames_the_next_run_has_the_old_folder(
    old: dict[str, bytes], tmp_path: Path
) -> None:
    crashed = pne_gen(
        "stewart", "--out", tmp_path, fault="crash between renames", PNE_TEST_VERSION="2"
    )
    assert crashed.returncode == 9
    assert not (tmp_path / "stewart").exists()

    pne_gen("stewart", "--out", tmp_path, fault="full disk", PNE_TEST_VERSION="3")
    assert tree(tmp_path) == old

    done = pne_gen("stewart", "--out", tmp_path, PNE_TEST_VERSION="3")
    assert done.returncode == 0
    assert b"version = 3" in (tmp_path / "stewart/stewart.py").read_bytes()
    assert set(tree(tmp_path)) == set(old)
