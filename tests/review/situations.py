"""Random parameters and a state at which a model's program and derivation can be evaluated."""

from __future__ import annotations

from typing import Any

import numpy as np

from pne_sym.backends.bundle import Bundle
from pne_sym.program.evaluate import Status, evaluate, prepare
from pne_sym.program.interpret import REST, Interpreter
from pne_sym.program.iteration import close_loops
from pne_sym.review.evaluation import Situation
from pne_sym.review.samples import length_of, random_parameters

_ATTEMPTS = 40
"""A random pose may be out of reach."""


def situation(bundle: Bundle, seed: int, *, wide: bool = True) -> Situation | None:
    """A state near home that meets the constraints; None where none was found.

    Args:
        bundle: the compiled manipulator.
        seed: of the random numbers.
        wide: with random parameters; else with the defaults.
    """
    rng = np.random.default_rng(seed)
    for _ in range(_ATTEMPTS):
        found = _Drawn(bundle, rng, wide=wide).situation()
        if found is not None:
            return found
    return None


def _parameters(bundle: Bundle, rng: np.random.Generator) -> dict[str, Any]:
    """Parameters near their defaults, of every leg on its own."""
    fields = bundle.derivation.parameters.fields
    rows = {f.name: np.array(f.default, dtype=float).reshape(-1, *f.shape) for f in fields}
    keys = {f"{name}.{k}.{name}": (name, k) for name, r in rows.items() for k in range(len(r))}
    drawn = random_parameters({key: rows[n][k] for key, (n, k) in keys.items()}, rng)
    for key, (name, k) in keys.items():
        rows[name][k] = drawn[key]
    return {f.name: rows[f.name].reshape(np.shape(f.default)) for f in fields}


class _Drawn:
    """One draw of parameters and a state."""

    def __init__(self, bundle: Bundle, rng: np.random.Generator, *, wide: bool) -> None:
        self.bundle, self.rng = bundle, rng
        table, c = bundle.derivation.parameters, bundle.coordinates
        defaults = {f.name: np.asarray(f.default, dtype=float) for f in table.fields}
        self.parameters = _parameters(bundle, rng) if wide else defaults
        self.size = length_of({f"{n}.{n}": v for n, v in defaults.items()})
        self.prepared = prepare(bundle.program, table.values(self.parameters))
        self.home_q = np.array(c.home[1])
        self.model = Interpreter(bundle.program, self.prepared, self.home_q)

    def situation(self) -> Situation | None:
        """The draw, where the model can be evaluated there."""
        c, program = self.bundle.coordinates, self.bundle.program
        X = np.array(c.home[0])
        X = X + self.rng.normal(size=X.shape) * np.where(
            np.arange(len(X)) < c.position, 0.05 * min(self.size, 1.0), 0.05
        )
        if c.sizes["NC"]:
            X = self.model.call("project", X=X[None]).outputs[0][0]
        V, A = self.rng.normal(size=(2, c.sizes["NV"]))
        q, converged = close_loops(program, self.prepared, X[None], self.home_q)
        if not converged[0]:
            return None
        vectors = {"X": X, "V": V, "A": A, "base": np.asarray(REST, dtype=float), "q": q[0]}
        given = {name: v[None] for name, v in vectors.items()}
        found = evaluate(program, "dynamics", self.prepared, given)
        if found.status[0] != Status.OK:
            return None
        if c.sizes["NC"]:
            rows = found.outputs["Hk"][0].T
            vectors["V"] = V = V - np.linalg.pinv(rows) @ (rows @ V)
            found = evaluate(program, "dynamics", self.prepared, given | {"V": V[None]})
            bias = found.outputs["constraint_bias"][0]
            vectors["A"] = A - np.linalg.pinv(rows) @ (rows @ A + bias)
        return Situation(self.parameters, vectors)
