"""Running what nobody has read yet: limited, without the environment, isolated where possible.

What holds everywhere: an environment of constants, a working folder that is
removed afterwards, a session of its own that is killed as a group, limits of wall
and processor time, memory, size of files and of the answer. What holds with
bubblewrap besides: no network, no files but the system's programs and Python's
(to read), no process that outlives the call. With unshare: no network, no such
process. `docs/code-review.md` says it to users.
"""

from __future__ import annotations

import contextlib
import enum
import os
import selectors
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

SECONDS = 300
"""Wall time of a process: others may be at work on the machine."""
PROCESSOR_SECONDS = 120
MEMORY = 2 * 1024**3
FILE_BYTES = 64 * 1024**2
ANSWER_BYTES = 64 * 1024**2
_TOLD_BYTES = 4000
_HERE = Path(__file__).parent
_ENVIRONMENT = {
    "LC_ALL": "C.UTF-8",
    "PATH": "/usr/bin:/bin",
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "PYTHONDONTWRITEBYTECODE": "1",
}
"""Constants: nothing of the caller's environment."""


class Isolation(enum.StrEnum):
    """What keeps a process from the rest of the machine."""

    BUBBLEWRAP = "bubblewrap: no network, no files of yours, no process left behind"
    UNSHARE = "unshare: no network, no process left behind; your files are within its reach"
    NONE = "none: your files and the network are within its reach"


class SandboxError(ValueError):
    """The process did not end well; the message is one line for people."""


@dataclass(frozen=True)
class Limits:
    """What a process may use.

    Attributes:
        seconds: of wall time; of processor time no more than `PROCESSOR_SECONDS`.
        memory: bytes of address space.
        answer: bytes on standard output.
        processes: whether it may start others.
    """

    seconds: float = SECONDS
    memory: int = MEMORY
    answer: int = ANSWER_BYTES
    processes: bool = False


@dataclass(frozen=True)
class Workplace:
    """A temporary folder: `given` is only read in the sandbox, `made` is written.

    Attributes:
        root: the folder outside.
        isolation: of the processes that are run in it.
    """

    root: Path
    isolation: Isolation

    def put(self, files: Mapping[str, bytes]) -> None:
        """Write files below `given`.

        Raises:
            SandboxError: a name leads out of it, or cannot be written.
        """
        given = (self.root / "given").resolve()
        for name, content in files.items():
            path = given / name
            if ".." in Path(name).parts or not path.is_relative_to(given) or "\0" in name:
                raise SandboxError(f"a file named {name[:100]!r} cannot be written")
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(content)
            except OSError as error:
                raise SandboxError(f"{name[:100]!r} cannot be written: {error.strerror}") from error

    @property
    def given(self) -> str:
        """`given` as the process sees it."""
        return "/given" if self.isolation is Isolation.BUBBLEWRAP else str(self.root / "given")

    @property
    def made(self) -> str:
        """`made` as the process sees it."""
        return "/made" if self.isolation is Isolation.BUBBLEWRAP else str(self.root / "made")

    def run(self, command: Sequence[str], limits: Limits, *, writes: bool = False) -> bytes:
        """Standard output of a command.

        Args:
            command: absolute path of a program, and its arguments.
            limits: what it may use.
            writes: whether it may write to `made`.

        Raises:
            SandboxError: it failed or met a limit.
        """
        confined = [
            sys.executable, "-I", "-S", f"{self.given}/confined.py", str(limits.memory),
            str(PROCESSOR_SECONDS), str(FILE_BYTES), "-1" if limits.processes else "0",
        ]  # fmt: skip
        prefix = self._prefix(writes)
        return _run([*prefix, *confined, *command], self.root / "made", limits)

    def _prefix(self, writes: bool) -> list[str]:
        if self.isolation is Isolation.NONE:
            return []
        if self.isolation is Isolation.UNSHARE:
            return [_tool("unshare"), *_UNSHARE]
        bind = "--bind" if writes else "--ro-bind"
        return [
            _tool("bwrap"),
            *_bubblewrap(),
            *("--ro-bind", str(self.root / "given"), "/given"),
            *(bind, str(self.root / "made"), "/made"),
            *("--remount-ro", "/dev", "--remount-ro", "/"),
            *("--chdir", "/made" if writes else "/tmp"),  # noqa: S108 - the sandbox's own
            "--",
        ]


@contextlib.contextmanager
def workplace(isolation: Isolation | None = None) -> Iterator[Workplace]:
    """A temporary folder to run processes in, removed afterwards.

    Args:
        isolation: of the processes; default: the best that works here.
    """
    chosen = best_isolation() if isolation is None else isolation
    with tempfile.TemporaryDirectory(prefix="pne-", ignore_cleanup_errors=True) as folder:
        root = Path(folder).resolve()
        (root / "given").mkdir()
        (root / "made").mkdir()
        place = Workplace(root, chosen)
        place.put({"confined.py": (_HERE / "confined.py").read_bytes()})
        yield place


@cache
def best_isolation() -> Isolation:
    """The best isolation that works here: tried with a process that imports NumPy."""
    for isolation in (Isolation.BUBBLEWRAP, Isolation.UNSHARE):
        with contextlib.suppress(SandboxError, OSError), workplace(isolation) as place:
            command = [sys.executable, "-I", "-c", "import numpy; print(numpy.ones(1).sum())"]
            if place.run(command, Limits(seconds=60)).strip() == b"1.0":
                return isolation
    return Isolation.NONE


_UNSHARE = (
    "--user", "--map-root-user", "--net", "--ipc", "--pid", "--fork", "--kill-child", "--",
)  # fmt: skip


def _tool(name: str) -> str:
    """The path of a program.

    Raises:
        SandboxError: it is not installed.
    """
    found = shutil.which(name, path="/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin")
    if found is None:
        raise SandboxError(f"{name} is not installed")
    return found


def _bubblewrap() -> list[str]:
    """Arguments of bubblewrap: the system's programs and Python's, to read; nothing else."""
    arguments = [
        "--unshare-all", "--unshare-user", "--die-with-parent", "--new-session",
        "--cap-drop", "ALL", "--hostname", "sandbox",
    ]  # fmt: skip
    for folder in ("/usr", "/lib", "/lib32", "/lib64", "/bin", "/sbin"):
        if Path(folder).is_symlink():
            arguments += ["--symlink", str(Path(folder).readlink()), folder]
        elif Path(folder).is_dir():
            arguments += ["--ro-bind", folder, folder]
    arguments += ["--ro-bind-try", "/etc/ld.so.cache", "/etc/ld.so.cache"]
    arguments += ["--proc", "/proc", "--dev", "/dev", "--size", str(FILE_BYTES), "--tmpfs", "/tmp"]  # noqa: S108
    for folder in _python_folders():  # which may be in /tmp
        arguments += ["--ro-bind", folder, folder]
    return arguments


def _python_folders() -> list[str]:
    """Where this Python and its libraries are, as far as it is not in /usr."""
    executable = Path(os.path.realpath(sys.executable))
    folders = dict.fromkeys(
        str(Path(p)) for p in (sys.base_prefix, sys.prefix, executable.parent.parent)
    )
    home = Path.home()  # what holds it is not shown: then bubblewrap does not work here
    return [
        f
        for f in folders
        if not home.is_relative_to(f) and not f.startswith("/usr/") and f != "/usr"
    ]


def compiler() -> str | None:
    """The C compiler's path, or None where none is installed."""
    names = ("cc", "gcc", "clang")
    found = next(filter(None, (shutil.which(n, path="/usr/bin:/bin") for n in names)), None)
    return found and os.path.realpath(found)


def _run(command: list[str], folder: Path, limits: Limits) -> bytes:
    """Start a command in a session of its own, collect its answer, kill what is left of it."""
    try:
        process = subprocess.Popen(  # noqa: S603 - absolute paths, no shell
            command,
            cwd=folder,
            env=_ENVIRONMENT,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
        )
    except OSError as error:
        raise SandboxError(f"cannot be started: {error.strerror}") from error
    with process:  # closes its outputs
        try:
            answer, told = _collected(process, limits)
        finally:
            _kill(process)
    if process.returncode:
        raise SandboxError(_reason(process.returncode, told))
    return answer


def _collected(process: subprocess.Popen[bytes], limits: Limits) -> tuple[bytes, bytes]:
    """What the process says on its two outputs, until it ends.

    Raises:
        SandboxError: it says too much, or takes too long.
    """
    assert process.stdout is not None
    assert process.stderr is not None
    said, told = bytearray(), bytearray()
    deadline = time.monotonic() + limits.seconds
    has_ended = False
    with selectors.DefaultSelector() as selector:
        for stream, heard in ((process.stdout, said), (process.stderr, told)):
            os.set_blocking(stream.fileno(), False)
            selector.register(stream, selectors.EVENT_READ, heard)
        while selector.get_map() or not has_ended:
            if time.monotonic() > deadline:
                raise SandboxError(f"took more than {limits.seconds:g} s")
            if not has_ended and _has_ended(process):
                has_ended = True
                _kill(process)  # what it left behind holds its outputs open
            for key, _ in selector.select(0.02):
                part = os.read(key.fd, 65536)
                if not part:
                    selector.unregister(key.fileobj)
                key.data.extend(part)
            if len(said) > limits.answer:
                raise SandboxError(f"answers more than {limits.answer} bytes")
            del told[:-_TOLD_BYTES]
    return bytes(said), bytes(told)


def _has_ended(process: subprocess.Popen[bytes]) -> bool:
    """Whether it has ended; it is not reaped, so that its number stays its own."""
    if not hasattr(os, "waitid"):  # macOS before Python 3.13
        return process.poll() is not None
    flags = os.WEXITED | os.WNOHANG | os.WNOWAIT
    return os.waitid(os.P_PID, process.pid, flags) is not None


def _kill(process: subprocess.Popen[bytes]) -> None:
    """Kill the process with all of its group, if it is not reaped yet."""
    if process.returncode is None:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def _reason(code: int, told: bytes) -> str:
    """Why a process ended, from its last words."""
    lines = told.decode(errors="replace").strip().splitlines() or ["no message"]
    last = "".join(c if c.isprintable() else "?" for c in lines[-1])[:200]
    if code < 0 or code > 128:
        number = -code if code < 0 else code - 128
        with contextlib.suppress(ValueError):
            return f"ended by {signal.Signals(number).name}: {last}"
    return last
