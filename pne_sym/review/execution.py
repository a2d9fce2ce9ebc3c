"""Calling a generated NumPy module in a separate process with a time limit.

The text of the module may come from a folder that the user named: it is run as
any module of theirs would be on import, but in a process that is isolated from
the environment (`python -I`, empty working folder) and ended after two minutes.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

TIME_LIMIT = 120.0
"""Seconds that one module may take."""


class ExecutionError(ValueError):
    """The module cannot be run; the message is one line for people."""


def execute(label: str, source: str, sets: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Defaults of a module's parameters, and its functions' values.

    Args:
        label: what to call the module in messages.
        source: its text.
        sets: parameters and states, as `runner.py` reads them.

    Returns:
        `defaults` by name, and per set the state used and the values by function.

    Raises:
        ExecutionError: it fails, or takes too long.
    """
    runner = Path(__file__).with_name("runner.py")
    request = json.dumps({"source": source, "sets": list(sets)})
    try:
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run(  # noqa: S603 - our own interpreter and script
                [sys.executable, "-I", str(runner)],
                input=request,
                capture_output=True,
                text=True,
                cwd=folder,
                timeout=TIME_LIMIT,
                check=False,
            )
    except subprocess.TimeoutExpired:
        raise ExecutionError(f"{label}: its NumPy module took more than {TIME_LIMIT:g} s") from None
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise ExecutionError(f"{label}: its NumPy module cannot be run: {last[:200]}")
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer
