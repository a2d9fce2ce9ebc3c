"""Every public function of a generated model, with its vector arguments by name."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np

from tests.bounds import bounded
from tests.oracle.coordinates import actuated_indices, displaced
from tests.whole.cases import Array, Case, guess_of

Vectors = dict[str, Array]
Outputs = tuple[Array, ...]
NOT_VECTORS = ("p", "weights", "nearest", "length")


def functions(model: Any) -> dict[str, tuple[str, ...]]:
    """Name of every function -> names of its vector arguments."""
    found = {}
    for name in model.__all__:
        member = getattr(model, name)
        if inspect.isfunction(member):
            parameters = inspect.signature(member).parameters
            found[name] = tuple(n for n in parameters if n not in NOT_VECTORS)
    return found


def states(c: Case, lead: tuple[int, ...], seed: int = 0) -> Vectors:
    """Values for every vector argument with leading axes, drawn near the state of a case."""
    m, count, rng = c.model, int(np.prod(lead)), np.random.default_rng(seed)
    steps = rng.uniform(-0.02, 0.02, (count, m.NV))
    X = np.array([displaced(c.spec, c.state.X, step) for step in steps]).reshape(count, m.NQ)
    q = m.inverse_kinematics(X, c.p, **c.guess)
    found = {
        "X": X,
        "V": rng.uniform(-1.0, 1.0, (count, m.NV)),
        "A": rng.uniform(-5.0, 5.0, (count, m.NV)),
        "tau": rng.uniform(-20.0, 20.0, (count, m.NU)),
        "wrench": rng.uniform(-20.0, 20.0, (count, m.NW)),
        "q_actuated": q[:, actuated_indices(c.spec)],
        "X0": X + rng.uniform(-1e-3, 1e-3, X.shape),
        "X1": X + rng.uniform(-0.1, 0.1, X.shape),
        "step": rng.uniform(-0.5, 0.5, (count, m.NV)),
        "s": rng.uniform(0.0, 1.0, count),
        "q0": np.array(guess_of(m, q).get("q0", q)),
        "rpy": rng.uniform(-1.0, 1.0, (count, 3)),
        **bounded(m, count),
    }
    if hasattr(m, "rotation"):
        found["R"] = m.rotation(X)
        found["t"] = X[:, : {6: 3, 3: 0 if m.NQ - m.NV else 2}[m.NW]]
    return {name: value.reshape(lead + value.shape[1:]) for name, value in found.items()}


def call(c: Case, name: str, vectors: Vectors) -> Outputs:
    """The outputs of a function with those of the given vectors that it takes.

    Status codes are left out: they are no numbers that could be NaN.
    """
    function = getattr(c.model, name)
    arguments: dict[str, Any] = {n: vectors[n] for n in functions(c.model)[name] if n in vectors}
    if "p" in inspect.signature(function).parameters:
        arguments["p"] = c.p
    result = function(**arguments)
    outputs = result if isinstance(result, tuple) else (result,)
    return outputs[:2] if name.startswith("condition") else outputs
