"""Runs `pne-gen`, the installed program, in a process of its own."""

from __future__ import annotations

import os
import pty
import signal
import subprocess
import sys
from pathlib import Path

from tests.cli import forked
from tests.cli.forked import STUB

PROGRAM = Path(sys.executable).with_name("pne-gen")
HANG = 3600  # s; ends what hangs, and nothing that is only slow on a busy machine


def environment(*, fault: str = "", real: bool = False, **variables: str) -> dict[str, str]:
    """The process's environment: with the stub compiler, unless the real one is wanted."""
    result = {key: value for key, value in os.environ.items() if not key.startswith("PNE_TEST")}
    result |= {"PNE_TEST_FAULT": fault, "COLUMNS": "100", **variables}
    if not real:
        result["PYTHONPATH"] = str(STUB)
    return result


def pne_gen(
    *arguments: str | Path,
    fault: str = "",
    real: bool = False,
    fresh: bool = False,
    cwd: Path | None = None,
    **variables: str,
) -> subprocess.CompletedProcess[str]:
    """Run the program; return its exit code, output and errors.

    Args:
        fault: what goes wrong with the stub compiler.
        real: with the compiler instead of its stub.
        fresh: in an interpreter of its own, as the installed program is; so it is wherever
            variables of the environment are given.
        cwd: the working folder.
    """
    if not (fresh or variables):
        return forked.run(arguments, environment(fault=fault, real=real), cwd)
    return subprocess.run(
        [PROGRAM, *arguments],
        env=environment(fault=fault, real=real, **variables),
        cwd=cwd,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=HANG,
        check=False,
    )


def heed_interrupts() -> None:
    """In a child before it runs: undo what a background job of a shell inherits."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def start(*arguments: str | Path, fault: str) -> subprocess.Popen[str]:
    """Start the program and leave it running."""
    return subprocess.Popen(
        [PROGRAM, *arguments],
        env=environment(fault=fault),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=heed_interrupts,  # noqa: PLW1509 (no threads)
    )


def on_a_terminal(*arguments: str | Path, **variables: str) -> tuple[int, str]:
    """Run the program on a terminal; return its exit code and all that it showed."""
    master, slave = pty.openpty()
    process = subprocess.Popen(
        [PROGRAM, *arguments],
        env=environment(TERM="xterm-256color", **variables),
        stdin=subprocess.DEVNULL,
        stdout=slave,
        stderr=slave,
    )
    os.close(slave)
    shown = b""
    while True:
        try:
            part = os.read(master, 65536)
        except OSError:  # the last holder of the other side has gone
            break
        if not part:
            break
        shown += part
    os.close(master)
    return process.wait(timeout=HANG), shown.decode()


def tree(folder: Path) -> dict[str, bytes]:
    """Every file below a folder, hidden ones too."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }
