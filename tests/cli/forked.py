"""Runs `pne-gen` in processes forked from one that has imported all of it, and waits.

To import SymPy and the package takes longer than most of what tests ask of the program.  A run is a
process of its own, as the installed program's is: streams, folder, environment and exit code are
those of the caller.  What it derives is kept and shared, as by `tests.models`.
"""

from __future__ import annotations

import atexit
import importlib
import json
import os
import pkgutil
import selectors
import signal
import socket
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
STUB = Path(__file__).parent / "stub"
CLIENT = """#!{python} -SE
# Asks for a run of pne-gen with this process's arguments, streams, folder and environment.
import json, os, socket, sys
asked = socket.socket(socket.AF_UNIX)
asked.connect({path!r})
text = json.dumps([sys.argv[1:], os.getcwd(), dict(os.environ)]).encode()
socket.send_fds(asked, [len(text).to_bytes(8, "big")], [0, 1, 2])
asked.sendall(text)
sys.exit(int(asked.makefile().read()))
"""


@cache
def address() -> str:
    """Where runs are asked for; what grants them ends with this process."""
    folder = tempfile.mkdtemp(prefix="pne-")
    path = f"{folder}/socket"
    command = [sys.executable, "-m", "tests.cli.forked", path]
    server = subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert server.stdout is not None
    assert server.stdout.readline() == b"ready\n"
    atexit.register(server.communicate)  # closes what it reads: that ends it
    program = Path(folder) / "pne-gen"
    program.write_text(CLIENT.format(python=sys.executable, path=path), encoding="utf-8")
    program.chmod(0o755)
    return path


def program() -> Path:
    """The program as a file, for shells."""
    return Path(address()).with_name("pne-gen")


def run(
    arguments: Sequence[str | Path], env: Mapping[str, str], cwd: Path | None
) -> subprocess.CompletedProcess[str]:
    """Run the program; nothing is to be read from its standard input."""
    with (
        tempfile.TemporaryFile() as out,
        tempfile.TemporaryFile() as err,
        Path(os.devnull).open() as none,
        socket.socket(socket.AF_UNIX) as asked,
    ):
        asked.connect(address())
        order = [[str(a) for a in arguments], str((cwd or Path()).absolute()), dict(env)]
        text = json.dumps(order).encode()
        streams = [stream.fileno() for stream in (none, out, err)]
        socket.send_fds(asked, [len(text).to_bytes(8, "big")], streams)
        asked.sendall(text)
        code = int(asked.makefile().read())
        told = []
        for stream in (out, err):
            stream.seek(0)
            told.append(stream.read().decode())
    return subprocess.CompletedProcess(arguments, code, *told)


def serve(path: str) -> None:
    """Grant runs until standard input ends."""
    _import_all()
    listening = socket.socket(socket.AF_UNIX)
    listening.bind(path)
    listening.listen()
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    with selectors.DefaultSelector() as selector:
        selector.register(sys.stdin, selectors.EVENT_READ)
        selector.register(listening, selectors.EVENT_READ)
        while listening in {key.fileobj for key, _ in selector.select()}:
            asked, _ = listening.accept()
            if os.fork() == 0:
                _grant(asked)
            asked.close()
    while True:
        try:
            os.wait()
        except ChildProcessError:
            return


def _import_all() -> None:
    """All that runs import, so that they need not; what they derive is shared."""
    from pne_sym import pipeline  # noqa: PLC0415
    from tests import models  # noqa: PLC0415

    pipeline.compile_bundle = models.bundle
    for package in ("cli", "review", "backends", "drawing", "starter", "writer", "home_check"):
        module = importlib.import_module(f"pne_sym.{package}")
        for found in pkgutil.walk_packages(getattr(module, "__path__", ()), f"{module.__name__}."):
            importlib.import_module(found.name)


def _grant(asked: socket.socket) -> None:
    """Run in a child; answer with its exit code, whatever became of it."""
    head, streams, _, _ = socket.recv_fds(asked, 8, 3)
    text = asked.makefile("rb").read(int.from_bytes(head, "big"))
    child = os.fork()
    if child == 0:
        _run(*json.loads(text), streams)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    asked.sendall(str(status if status >= 0 else 128 - status).encode())
    os._exit(0)


def _run(arguments: list[str], folder: str, variables: dict[str, str], streams: list[int]) -> None:
    """Be the installed program, from its first line to its end."""
    code = 1
    try:
        for place, stream in enumerate(streams):
            os.dup2(stream, place)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
        sys.stderr = open(  # noqa: SIM115
            2, "w", 1, encoding="utf-8", errors="backslashreplace", closefd=False
        )
        os.environ.clear()
        os.environ.update(variables)
        os.chdir(folder)
        warnings.resetwarnings()
        sys.argv = ["pne-gen", *arguments]
        if variables.get("PYTHONPATH") == str(STUB):
            site: dict[str, Any] = {"__name__": "sitecustomize"}
            exec((STUB / "sitecustomize.py").read_text(encoding="utf-8"), site)
        from pne_sym.cli import main  # noqa: PLC0415

        main()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:  # noqa: BLE001 - told as the interpreter tells it
        sys.excepthook(*sys.exc_info())
    finally:
        try:
            sys.stdout.flush()
        except OSError:
            code = 120
        os._exit(code)


if __name__ == "__main__":
    serve(sys.argv[1])
