"""What code under review can and cannot do when it is run."""

from __future__ import annotations

import os
import socket
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from pne_sym.review.sandbox import (
    Isolation,
    Limits,
    SandboxError,
    Workplace,
    best_isolation,
    workplace,
)
from tests.review.folders import diff, edit, pair

KINDS = tuple(dict.fromkeys((Isolation.NONE, best_isolation())))
"""The least there is everywhere, and the best that works here."""
LIMITS = Limits(seconds=60.0, answer=100_000, memory=1 << 29)
SHORT = replace(LIMITS, seconds=3.0)


def run(place: Workplace, code: str, limits: Limits = LIMITS) -> str:
    place.put({"payload.py": code.encode()})
    return place.run([sys.executable, "-I", f"{place.given}/payload.py"], limits).decode()


@pytest.mark.parametrize("isolation", KINDS)
def test_nothing_of_the_callers_environment(
    isolation: Isolation, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TOKEN", "a secret")
    with workplace(isolation) as place:
        said = run(place, "import os, sys\nprint(dict(os.environ), sys.stdin.read())")
    assert "secret" not in said
    assert "HOME" not in said


@pytest.mark.parametrize("isolation", KINDS)
@pytest.mark.parametrize(
    ("code", "reason"),
    [
        ("while True: pass", "took more than 3 s"),
        ("import time; time.sleep(1000)", "took more than 3 s"),
        ("while True: print('x' * 10000)", "answers more than 100000 bytes"),
        ("x = bytearray(1 << 32)", "MemoryError"),
        ("import sys; sys.stderr.write('y' * 10**7 + '\\nlast'); sys.exit(3)", "last"),
        ("import ctypes; ctypes.string_at(0)", "ended by SIGSEGV"),
        ("raise SystemExit('\\x1b[2J')", "?[2J"),
        (
            (
                "import os\nwith open('/tmp/large-of-pne', 'wb') as f:\n"
                "    os.unlink(f.name)\n    while True: f.write(bytes(1 << 20))"
            ),
            "Error",
        ),
    ],
)
def test_limits(isolation: Isolation, code: str, reason: str) -> None:
    limits = SHORT if reason.startswith("took") else LIMITS
    with workplace(isolation) as place, pytest.raises(SandboxError) as caught:
        run(place, code, limits)
    assert reason in str(caught.value)
    assert len(str(caught.value)) < 300


def beats(file: Path) -> bool:
    """Whether something still writes to the file."""
    before = file.stat().st_size if file.exists() else 0
    time.sleep(0.5)
    return (file.stat().st_size if file.exists() else 0) > before


BEATING = """
import os, sys, time
if os.fork() == 0:
    {session}
    while True:
        with open({file!r}, "a") as f:
            f.write("x")
        time.sleep(0.05)
while not os.path.exists({file!r}):
    time.sleep(0.01)
"""


@pytest.mark.parametrize("isolation", KINDS)
@pytest.mark.parametrize("session", ["pass", "os.setsid()"])
def test_no_process_is_left_behind(isolation: Isolation, session: str) -> None:
    if isolation is Isolation.NONE and session != "pass":
        return  # as documented: nothing but its group can be told apart there
    with workplace(isolation) as place:
        file = f"{place.made}/beat"
        code = BEATING.format(session=session, file=file)
        place.put({"payload.py": code.encode()})
        command = [sys.executable, "-I", f"{place.given}/payload.py"]
        place.run(command, replace(LIMITS, processes=True), writes=True)
        assert (place.root / "made/beat").exists()
        assert not beats(place.root / "made/beat")


@pytest.mark.parametrize("isolation", [k for k in KINDS if k is Isolation.BUBBLEWRAP])
@pytest.mark.parametrize(
    "code",
    [
        "print(open({secret!r}).read())",
        "open({outside!r}, 'w').write('x')",
        "import socket; socket.create_connection(('127.0.0.1', {port}), 2)",
        "import os; os.kill({pid}, 9)",
        "open('/dev/shm/x', 'wb').write(bytes(1 << 20))",
        "open('/given/payload.py', 'w')",
        "open('/usr/bin/of-pne', 'w')",
        "open('/made/x', 'w')",
        "import ctypes, os; os.stat('/proc/{pid}/environ')",
    ],
)
def test_with_bubblewrap_nothing_of_the_machine_is_in_reach(
    isolation: Isolation, code: str, tmp_path: Path
) -> None:
    secret, outside = tmp_path / "secret", tmp_path / "outside"
    secret.write_text("a secret")
    with socket.create_server(("127.0.0.1", 0)) as server, workplace(isolation) as place:
        filled = code.format(
            secret=str(secret), outside=str(outside), port=server.getsockname()[1], pid=os.getpid()
        )
        with pytest.raises(SandboxError):
            run(place, filled)
    assert not outside.exists()


def test_names_of_files_do_not_lead_out(tmp_path: Path) -> None:
    with workplace(Isolation.NONE) as place:
        for name in ("../x", "/etc/x-of-pne", "a/../../x", "a\0b"):
            with pytest.raises(SandboxError):
                place.put({name: b""})


PAYLOAD = """

import os as _os
import subprocess as _s
import sys as _sys
import time as _t


def _bad():
    token = _os.environ.get("TOKEN", "")
    for place in ({outside!r}, _os.path.expanduser("~/of-pne")):
        try:
            with open(place, "a") as f:
                f.write("reached " + token)
        except OSError:
            pass
    try:
        if _os.fork() == 0:
            _os.setsid()
            _t.sleep(2)
            with open({outside!r}, "a") as f:
                f.write("later")
            _os._exit(0)
    except OSError:
        pass


_bad()
"""


def test_a_payload_in_a_folder_under_review(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By default it does not run; with --run it reads no token, and its answer changes nothing."""
    monkeypatch.setenv("TOKEN", "a secret")
    before, after = pair(tmp_path, "planar_3rpr")
    outside = tmp_path / "outside"
    edit(after / "planar_3rpr.py", lambda text: text + PAYLOAD.format(outside=str(outside)))
    assert diff(before, after).exit_code == 1
    assert not outside.exists()
    assert diff(before, after, "--run").exit_code == 1
    time.sleep(2.5)
    if best_isolation() is Isolation.BUBBLEWRAP:
        assert not outside.exists()
    elif outside.exists():
        assert "secret" not in outside.read_text()


FORGERIES = {
    "not JSON": "_os.write(1, b'{'); _os._exit(0)",
    "another shape": "_os.write(1, b'[]'); _os._exit(0)",
    "too deep": "_os.write(1, b'[' * 10**6); _os._exit(0)",
    "a flood": "\nwhile True: _os.write(1, b' ' * 65536)",
    "an end": "_os._exit(0)",
    "a fault": "raise RuntimeError('a fault of its own')",
    "strings for numbers": (
        '_os.write(1, b\'{"defaults": {"gravity": "9"}, "constants": {}, "sets": []}\');'
        " _os._exit(0)"
    ),
}


TAKEN = """
for _k in range(3, 20):  # where the runner keeps its way to the parent
    try:
        _os.dup2(_k, 1)
        break
    except OSError:
        pass
"""


@pytest.mark.parametrize("case", FORGERIES)
def test_a_forged_answer_is_none(case: str, tmp_path: Path) -> None:
    before, after = pair(tmp_path, "planar_3rpr")
    code = "\n\nimport os as _os\nimport sys as _sys\n" + TAKEN
    edit(after / "planar_3rpr.py", lambda text: f"{text}{code}{FORGERIES[case]}\n")
    done = diff(before, after, "--run")
    assert done.exit_code == 1, done.output
    assert "values not compared" in done.output
    assert len(done.output) < 20_000
