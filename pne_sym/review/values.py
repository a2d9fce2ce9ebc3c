"""Two versions run at common parameters and states: all functions, of NumPy and of C."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pne_sym.review.c_driver import Array, CAnswer, c_calls
from pne_sym.review.equations import Sample
from pne_sym.review.execution import (
    Answer,
    Asked,
    ExecutionError,
    execute,
    execute_c,
    packed,
)
from pne_sym.review.model import Model, by_name, by_path
from pne_sym.review.samples import (
    SHARED,
    actuated,
    length_of,
    random_parameters,
    random_values,
    resized,
)
from pne_sym.review.sandbox import Isolation

Rows = NDArray[np.intp]
PARAMETER_SETS = 4
"""Random ones; one of the defaults is added, where they are the same in both versions."""
STATES = 8
_PER_SET = 2
"""States of each parameter set at which every equation is evaluated."""
_SIZED = {
    "tau": "NU", "wrench": "NW", "weights": "NU", "q0": "NJ", "q_actuated": "NU",
}  # fmt: skip


@dataclass(frozen=True)
class Set:
    """Parameters of a version (None: its own defaults) and values of arguments."""

    parameters: dict[str, Any] | None
    values: dict[str, Array]


class Runs:
    """Both versions run at common parameters and states.

    Attributes:
        answers: of the NumPy modules, before and after.
        defaults: of the parameters by path, before and after.
        kept: per set, the states that at least one version allows.
        states: how many these are.
        comparable: whether X and V mean the same in both.
    """

    def __init__(self, before: Model, after: Model, seed: int) -> None:
        self.models = (before, after)
        sizes = [m.manifest["sizes"] for m in self.models]
        self.comparable = all(sizes[0][k] == sizes[1][k] for k in ("NQ", "NV"))
        self.answers = _both(_asked(m, []) for m in self.models)
        self.defaults = [_by_path(m, a) for m, a in zip(self.models, self.answers, strict=True)]
        self.sets: tuple[list[Set], list[Set]] = ([], [])
        self.kept: list[Rows] = []
        if self.comparable:
            try:
                self._draw(np.random.default_rng(seed))
            except (ValueError, IndexError) as error:  # also of a stranger's manifest
                if isinstance(error, ExecutionError):
                    raise
                labels = f"{before.label}, {after.label}"
                raise ExecutionError(f"{labels}: parameters of shapes that do not fit") from error
            self.answers = _both(
                _asked(m, [_request(s) for s in sets])
                for m, sets in zip(self.models, self.sets, strict=True)
            )
            self.kept = [self._possible(k) for k in range(len(self.sets[0]))]

    @property
    def states(self) -> int:
        """How many states are compared."""
        return sum(len(kept) for kept in self.kept)

    def _draw(self, rng: np.random.Generator) -> None:
        """Parameters and states of all sets, made to meet the constraints by one version."""
        old, new = self.defaults
        leader = int(self.models[0].bundle is None and self.models[1].bundle is not None)
        model, size = self.models[leader], length_of({**new, **old})
        parameters: list[list[Any]] = [[], []]
        for _ in range(PARAMETER_SETS):
            drawn = random_parameters({**new, **old}, rng)
            freed = {**drawn, **self._structural(drawn)}
            for side, version, values in zip(parameters, self.models, (drawn, freed), strict=True):
                side.append(by_name(version, values))
        if _same(old, new):
            for side in parameters:
                side.append(None)
        drafts = [
            random_values(model.manifest, STATES, size, rng) for _ in range(len(parameters[0]))
        ]
        asked = [
            _request(Set(p, v), consistent=True)
            for p, v in zip(parameters[leader], drafts, strict=True)
        ]
        states = _asked(model, asked).states
        for k, (draft, state) in enumerate(zip(drafts, states, strict=True)):
            values = self._complete(model, draft, state, size, rng)
            for sets, own, version in zip(self.sets, parameters, self.models, strict=True):
                sets.append(Set(own[k], _fitted(version, values)))

    def _complete(
        self,
        model: Model,
        draft: dict[str, Array],
        state: dict[str, Array],
        size: float,
        rng: np.random.Generator,
    ) -> dict[str, Array]:
        """The values that functions get: those drafted, at the states that were made."""
        if state.keys() < {"X", "V", "A", "q"}:
            raise ExecutionError(f"{model.label}: its NumPy module gives no states")
        shapes = {n: draft[n].shape for n in ("X", "V", "A", "q0")}
        if any(state["q" if n == "q0" else n].shape != s for n, s in shapes.items()):
            raise ExecutionError(f"{model.label}: its NumPy module gives states of another shape")
        X = state["X"]
        return draft | {
            **{n: state[n] for n in ("X", "V", "A", "q")},
            "X0": X + 1e-3 * min(size, 1.0) * rng.normal(size=X.shape),
            "q_actuated": actuated(model.manifest, state["q"]),
        }

    def _structural(self, drawn: dict[str, Any]) -> dict[str, Any]:
        """Entries that are zero before by structure, but free after, at their values after."""
        free = {}
        for path, value in self.defaults[1].items():
            old = self.defaults[0].get(path)
            if old is not None and np.shape(value) and np.any((old == 0.0) & (value != 0.0)):
                free[path] = np.where((old == 0.0) & (value != 0.0), value, drawn[path])
        return free

    def _possible(self, k: int) -> Rows:
        """The states of a set that at least one of the two versions allows."""
        allowed = np.zeros(STATES, dtype=bool)
        for answer in self.answers:
            for M in answer.calls[k].get(("M", (), "batch"), ())[:1]:
                if M.shape[:1] == (STATES,):
                    allowed |= np.isfinite(M.reshape(STATES, -1)).all(axis=1)
        possible = np.isfinite(self.sets[0][k].values["X"]).all(axis=1)
        return np.flatnonzero(allowed & possible)

    def samples(self) -> list[Sample]:
        """States for comparing equations: possible in both versions."""
        found = []
        for k in range(PARAMETER_SETS if self.comparable else 0):
            old, new = self.sets[0][k], self.sets[1][k]
            both = [
                s
                for s in self.kept[k]
                if all(np.isfinite(a.calls[k]["M", (), "batch"][0][s]).all() for a in self.answers)
            ]
            found += [
                Sample(
                    old.parameters or {},
                    new.parameters or {},
                    {n: old.values[n][s] for n in ("X", "V", "A", "q")},
                )
                for s in both[:_PER_SET]
            ]
        return found

    def c_answers(self) -> tuple[tuple[CAnswer, CAnswer] | None, list[str]]:
        """What the C of both versions answers, and why where one does not."""
        functions = [m.functions for m in self.models]
        found, faults = [], []
        for k, model in enumerate(self.models):
            calls = c_calls(functions[k] or functions[1 - k])
            manifest = model.manifest
            sets = [(s.parameters, _for_c(s.values)) for s in self.sets[k]]
            try:
                if not calls:
                    raise ExecutionError("manifests of format 1 do not list the C functions")
                asked = Asked(calls, sets, STATES)
                found.append(execute_c(model.label, model.c, manifest, asked, _isolation(model)))
            except KeyError as error:
                faults.append(f"{model.label}: no value is known for the argument {error} of C")
            except ExecutionError as error:
                faults.append(str(error))
        return (None if faults else (found[0], found[1])), faults


def _both(answers: Iterable[Answer]) -> tuple[Answer, Answer]:
    before, after = answers
    return before, after


def _asked(model: Model, sets: Sequence[dict[str, Any]]) -> Answer:
    request = {"defaults": [p["name"] for p in model.parameters], "sets": list(sets)}
    return execute(model.label, model.name, model.python, request, _isolation(model))


def _isolation(model: Model) -> Isolation | None:
    """Our own text needs no more than a process of its own."""
    return None if model.bundle is None else Isolation.NONE


def _request(s: Set, *, consistent: bool = False) -> dict[str, Any]:
    return {
        "parameters": s.parameters,
        "values": {n: packed(v) for n, v in s.values.items()},
        "shared": list(SHARED),
        "consistent": consistent,
    }


def _by_path(model: Model, answer: Answer) -> dict[str, Array]:
    for p in model.parameters:
        if list(answer.defaults[p["name"]].shape) != p["shape"]:
            raise ExecutionError(f"{model.label}: its default of {p['name']} has another shape")
    return by_path(model, answer.defaults)


def _same(old: dict[str, Array], new: dict[str, Array]) -> bool:
    return old.keys() == new.keys() and all(np.array_equal(old[p], new[p]) for p in old)


def _fitted(model: Model, values: dict[str, Array]) -> dict[str, Array]:
    """Values of as many entries as a version has."""
    sizes = model.manifest["sizes"]
    return {n: resized(v, sizes[_SIZED[n]]) if n in _SIZED else v for n, v in values.items()}


def _for_c(values: dict[str, Array]) -> dict[str, Array]:
    """What is the same for all states is given to each."""
    return {n: np.tile(v, (STATES, 1)) if n in SHARED else v for n, v in values.items()}
