"""Runs one generated NumPy module in a process of its own; talks JSON on its two ends.

The parent (`execution.py`) starts it isolated and with a time limit. It imports
nothing of this package: what it is given is the text of a module and the
numbers to call it with.
"""

from __future__ import annotations

import contextlib
import io
import json
import sys
from types import ModuleType
from typing import Any

import numpy as np

CALLS = {
    "M": ("X",),
    "Z": ("X", "V"),
    "H": ("X",),
    "Hk": ("X",),
    "constraints": ("X",),
    "constraint_bias": ("X", "V"),
    "inverse_kinematics": ("X",),
    "joint_rates": ("X", "V"),
    "joint_accelerations": ("X", "V", "A"),
    "inverse_dynamics": ("X", "V", "A"),
    "forward_dynamics": ("X", "V", "tau"),
    "leg_reactions": ("X", "V", "A"),
    "energy": ("X", "V"),
    "condition": ("X",),
    "condition_constrained": ("X",),
}


def main() -> None:
    """Read a request, answer it."""
    request = json.load(sys.stdin)
    with contextlib.redirect_stdout(io.StringIO()), np.errstate(all="ignore"):
        module: Any = ModuleType("model")
        # The user named this folder; the process has no other task and a time limit.
        exec(compile(request["source"], "<model>", "exec"), module.__dict__)  # noqa: S102
        answer = {
            "defaults": {
                n: np.asarray(getattr(module.Parameters(), n)).tolist() for n in module._DEFAULTS
            },
            "sets": [_run(module, each) for each in request["sets"]],
        }
    json.dump(answer, sys.stdout)


def _run(module: Any, each: dict[str, Any]) -> dict[str, Any]:
    """States made consistent where asked, and what every function returns there."""
    p = module.Parameters(**each["parameters"])
    state = {name: np.array(each[name], dtype=float) for name in ("X", "V", "A", "tau")}
    if each["consistent"] and hasattr(module, "Hk"):
        _onto_the_manifold(module, state, p)
    values = {}
    for name, arguments in CALLS.items():
        if hasattr(module, name):
            values[name] = _lists(getattr(module, name)(*(state[a] for a in arguments), p))
    return {"values": values, **{name: value.tolist() for name, value in state.items()}}


def _onto_the_manifold(module: Any, state: dict[str, Any], p: Any) -> None:
    """Pose, velocity and acceleration that the constraints allow."""
    state["X"] = X = module.project(state["X"], p)
    rows = np.swapaxes(module.Hk(X, p), -1, -2)
    for name in ("V", "A"):
        gap = (rows @ state[name][..., None])[..., 0]
        if name == "A":
            gap = gap + module.constraint_bias(X, state["V"], p)
        good = np.isfinite(rows).all(axis=(-1, -2)) & np.isfinite(gap).all(axis=-1)
        step = np.linalg.pinv(np.where(good[..., None, None], rows, 0.0)) @ gap[..., None]
        state[name] = np.where(good[..., None], state[name] - step[..., 0], np.nan)


def _lists(value: Any) -> list[Any]:
    """One array or several, as nested lists."""
    return [np.asarray(v).tolist() for v in (value if isinstance(value, tuple) else (value,))]


if __name__ == "__main__":
    main()
