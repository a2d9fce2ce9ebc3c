"""Array-API modules in memory, and arguments for every function of a model."""

from __future__ import annotations

import inspect
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np

from pne_sym.backends.xp import XpBackend
from pne_sym.model.manipulator import Manipulator
from tests import models
from tests.bounds import bounded

STATES = 3
SWAYING = np.array([0.8, -0.6, 0.0, 0.6, 0.8, 0.0, 0.0, 0.0, 1.0, *np.linspace(-1.0, 2.0, 9)])
"""A motion of the base, turned about z."""
_SOLVED = {
    "inverse_dynamics": "H",
    "leg_reactions": "H",
    "force_distribution": "H",
    "reachable_wrench": "H",
    "reachable_acceleration": "H",
    "forward_dynamics": "M",
    "complete_acceleration": "M",
    "forward_kinematics": "H",
    "project": "Hk",
}


@cache
def xp_module(manipulator: Manipulator) -> Any:
    """NAME_xp.py, in memory."""
    (text,) = XpBackend().emit(models.bundle(manipulator)).values()
    made = ModuleType(f"{manipulator.name}_xp")
    exec(compile(text, f"<{manipulator.name}_xp.py>", "exec"), made.__dict__)
    return made


def functions(x: Any) -> list[str]:
    """Names of the public functions."""
    members = {name: getattr(x, name) for name in x.__all__ if name != "parameters"}
    return [name for name, member in members.items() if inspect.isfunction(member)]


def vectors(m: Any, states: int = STATES) -> dict[str, Any]:
    """States around home of the NumPy module m, and all other arguments."""
    rng = np.random.default_rng(5)
    X = m.HOME_X + 2e-3 * rng.uniform(-1.0, 1.0, (states, m.NQ))
    q = m.inverse_kinematics(X)
    found = {
        "X": X,
        "X0": X + 1e-4 * rng.uniform(-1.0, 1.0, X.shape),
        "V": rng.uniform(-1.0, 1.0, (states, m.NV)),
        "A": rng.uniform(-5.0, 5.0, (states, m.NV)),
        "tau": rng.uniform(-5.0, 5.0, (states, m.NU)),
        "wrench": rng.uniform(-5.0, 5.0, (states, m.NW)),
        "weights": rng.uniform(0.5, 2.0, m.NU),
        "q_actuated": q[:, list(m.ACTUATED)],
        "q0": np.tile(m.HOME_Q, (states, 1)),
        "X1": X + 0.1 * rng.uniform(-1.0, 1.0, X.shape),
        "step": rng.uniform(-0.5, 0.5, (states, m.NV)),
        "s": rng.uniform(0.0, 1.0, states),
        "rpy": rng.uniform(-1.0, 1.0, (states, 3)),
        "base": np.tile(SWAYING, (states, 1)),
        **bounded(m, states),
    }
    if hasattr(m, "rotation"):
        found["R"] = m.rotation(X)
        found["t"] = X[:, : {6: 3, 3: 0 if m.NQ - m.NV else 2}[m.NW]]
    return found


def call(module: Any, name: str, given: dict[str, Any], asarray: Any = np.asarray) -> Any:
    """The outputs of a function at those of the given arguments that it takes."""
    taken = inspect.signature(getattr(module, name)).parameters
    found = getattr(module, name)(**{n: asarray(a) for n, a in given.items() if n in taken})
    found = found if isinstance(found, tuple) else (found,)
    return found[:2] if name.startswith("condition") else found  # statuses apart


def condition(m: Any, function: str, given: dict[str, Any]) -> float:
    """Condition number of what a function solves; with constraints, of all that is solved."""
    if function not in _SOLVED:
        return 1.0
    X = given["X"]
    systems = [m.M(X), m.H(X)] if _SOLVED[function] in "MH" else []
    if hasattr(m, "Hk"):
        systems += [m.Hk(X), np.concatenate((m.H(X), m.Hk(X)), axis=-1)]
    values = [np.linalg.svd(a, compute_uv=False) for a in systems]
    return float(max(np.max(s[:, 0] / s[:, s[0] > 1e-9 * s[0, 0]][:, -1]) for s in values))
