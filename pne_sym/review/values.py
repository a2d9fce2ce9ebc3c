"""Two versions run at common parameters and states: all functions, of NumPy and of C."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pne_sym.model.kinematics import Array
from pne_sym.program.interpret import REST
from pne_sym.review.alignment import Alignment
from pne_sym.review.c_driver import Asked, c_calls
from pne_sym.review.correspondence import Correspondence, same_platform
from pne_sym.review.equations import Sample
from pne_sym.review.evaluation import Situation
from pne_sym.review.execution import Answer, ExecutionError, execute, execute_c
from pne_sym.review.model import Model, by_name, by_path, paths_of
from pne_sym.review.runner import packed
from pne_sym.review.samples import (
    SHARED,
    actuated,
    length_of,
    random_parameters,
    random_values,
)
from pne_sym.review.sandbox import Isolation

Rows = NDArray[np.intp]
PARAMETER_SETS = 4
"""Random ones; one of the defaults is added, where they are the same in both versions."""
STATES = 8
_PER_SET = 1
"""States of each parameter set at which equations are evaluated."""


@dataclass(frozen=True)
class Set:
    """Parameters of a version (None: its own defaults) and values of arguments."""

    parameters: dict[str, Any] | None
    values: dict[str, Array]


class Runs:
    """Both versions run at common parameters and states.

    Attributes:
        answers: of the NumPy modules, before and after.
        defaults: of the parameters by path of the version before, before and after.
        kept: per set, the states that at least one version allows.
        states: how many these are.
        comparable: whether the platform's coordinates mean the same in both.
        common: whether parameters were the same in both; else each is near its own defaults.
    """

    def __init__(self, before: Model, after: Model, seed: int, alignment: Alignment) -> None:
        self.models = (before, after)
        self.alignment = alignment
        self.comparable = same_platform(before.manifest, after.manifest)
        self.answers = (_constants_of(before), _constants_of(after))
        own = [_by_path(m, a) for m, a in zip(self.models, self.answers, strict=True)]
        self.defaults = [own[0], {alignment.canonical(p): v for p, v in own[1].items()}]
        self.sets: tuple[list[Set], list[Set]] = ([], [])
        self.kept: list[Rows] = []
        self.common = True
        if not self.comparable:
            return
        try:
            self._run(np.random.default_rng(seed))
            if not self.states and not _same(*self.defaults):
                self.common, self.sets = False, ([], [])
                self._run(np.random.default_rng(seed))
        except (ValueError, IndexError) as error:  # also of a stranger's manifest
            if isinstance(error, ExecutionError):
                raise
            labels = f"{before.label}, {after.label}"
            raise ExecutionError(f"{labels}: parameters of shapes that do not fit") from error

    @property
    def states(self) -> int:
        """How many states are compared."""
        return sum(len(kept) for kept in self.kept)

    def _run(self, rng: np.random.Generator) -> None:
        self._draw(rng)
        requests = [[request_for(s) for s in sets] for sets in self.sets]
        before, after = map(asked_of, self.models, requests)
        self.answers = (before, after)
        self.kept = [self._possible(k) for k in range(len(self.sets[0]))]

    # ---- parameters ---------------------------------------------------------------------

    def _parameters(self, rng: np.random.Generator) -> tuple[list[Any], list[Any]]:
        """Random ones, the same for what is the same; then the defaults, where they are equal."""
        old, new = self.defaults
        found: tuple[list[Any], list[Any]] = ([], [])
        for _ in range(PARAMETER_SETS):
            drawn = random_parameters({**new, **old}, rng)
            found[0].append(by_name(self.models[0], drawn))
            found[1].append(self._after(drawn if self.common else {}, rng))
        if _same(old, new):
            for side in found:
                side.append(None)
        return found

    def _after(self, drawn: dict[str, Any], rng: np.random.Generator) -> dict[str, Any]:
        """Parameters of the version after by their names."""
        own = random_parameters(self.defaults[1], rng)
        values = {}
        for p in self.models[1].parameters:
            for path in paths_of(p):
                key = self.alignment.canonical(path)
                fits = key in drawn and np.shape(drawn[key]) == np.shape(own[key])
                values[path] = self._freed(key, drawn[key]) if fits else own[key]
        return by_name(self.models[1], values)

    def _freed(self, path: str, drawn: Array) -> Array:
        """Entries that are zero by structure before have the default after, where they are free."""
        old, default = self.defaults[0].get(path), self.defaults[1][path]
        is_axis = old is not None and "axis" in path.rpartition(".")[2]
        if is_axis and not np.array_equal(old, default):  # type: ignore[arg-type]
            return default  # what a live axis may be, its relations to others say
        zeros = [
            k
            for p in self.models[0].parameters
            if path in paths_of(p)
            for k in p.get("zero_by_structure", ())
        ]
        value = np.array(drawn, dtype=float)
        value.reshape(-1)[zeros] = default.reshape(-1)[zeros]
        return value

    # ---- states -------------------------------------------------------------------------

    def _draw(self, rng: np.random.Generator) -> None:
        """Parameters and states of all sets, made to meet the constraints by one version."""
        leader = int(self.models[0].bundle is None and self.models[1].bundle is not None)
        model, size = self.models[leader], length_of({**self.defaults[1], **self.defaults[0]})
        parameters = self._parameters(rng)
        drafts = [
            random_values(model.manifest, STATES, size, rng) for _ in range(len(parameters[0]))
        ]
        asked = [
            request_for(Set(p, v), consistent=True)
            for p, v in zip(parameters[leader], drafts, strict=True)
        ]
        states = asked_of(model, asked).states
        led = [
            Set(p, self._complete(model, draft, state, size, rng))
            for p, draft, state in zip(parameters[leader], drafts, states, strict=True)
        ]
        self.sets[leader].extend(led)
        self.sets[1 - leader].extend(self._followed(leader, led, parameters[1 - leader]))

    def _followed(self, leader: int, led: list[Set], parameters: list[Any]) -> list[Set]:
        """The states of the other version: its coordinates, joints and actuators in its order."""
        one, other = self.models[leader], self.models[1 - leader]
        own = Correspondence(one.manifest, other.manifest, self.alignment, backwards=leader == 1)
        found = [
            Set(p, {n: own.carried(n, v, 1.0) for n, v in s.values.items()})
            for p, s in zip(parameters, led, strict=True)
        ]
        if own.joints("joints") == list(range(one.manifest["sizes"]["NJ"])):
            return found
        asked = [request_for(s, consistent="q") for s in found]
        for s, made in zip(found, asked_of(other, asked).states, strict=True):
            s.values["q"] = made["q"]
            s.values["q_actuated"] = actuated(other.manifest, made["q"])
        return found

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
            "X1": X + 0.1 * min(size, 1.0) * rng.normal(size=X.shape),
            "q_actuated": actuated(model.manifest, state["q"]),
        }

    def _possible(self, k: int) -> Rows:
        """The states of a set that at least one of the two versions allows."""
        allowed = np.zeros(STATES, dtype=bool)
        for answer in self.answers:
            allowed |= _allowed(answer, k)
        possible = np.isfinite(self.sets[0][k].values["X"]).all(axis=1)
        return np.flatnonzero(allowed & possible)

    def samples(self) -> list[Sample]:
        """States for comparing equations: possible in both versions."""
        both_move = all(takes_base(m.manifest) for m in self.models)

        def at(side: Set, s: int) -> Situation:
            vectors = {n: side.values[n][s] for n in ("X", "V", "A", "q", "base")}
            rest = {} if both_move else {"base": REST}
            return Situation(side.parameters or {}, vectors | rest)

        found = []
        for k in range(PARAMETER_SETS if self.comparable else 0):
            old, new = self.sets[0][k], self.sets[1][k]
            allowed = [_allowed(answer, k) for answer in self.answers]
            both = [s for s in self.kept[k] if all(version[s] for version in allowed)]
            for s in both[:_PER_SET]:
                found.append((at(old, s), at(new, s)))
        return found

    def c_answers(self) -> tuple[tuple[Answer, Answer] | None, list[str]]:
        """What the C of both versions answers, and why where one does not."""
        found, faults = [], []
        for model, other, own in zip(self.models, self.models[::-1], self.sets, strict=True):
            calls = c_calls(model.functions or other.functions)
            asked = Asked(calls, [(s.parameters, _for_c(s.values)) for s in own], STATES)
            try:
                if not calls:
                    raise ExecutionError("manifests of format 1 do not list the C functions")
                isolation = _isolation(model)
                found.append(execute_c(model.label, model.c, model.manifest, asked, isolation))
            except KeyError as error:
                faults.append(f"{model.label}: no value is known for the argument {error} of C")
            except ExecutionError as error:
                faults.append(str(error))
        return (None if faults else (found[0], found[1])), faults


def takes_base(manifest: Mapping[str, Any]) -> bool:
    """Whether the base of a version moves; if that of one alone does, it is compared at rest."""
    return any("base" in f.get("inputs", ()) for f in manifest.get("functions", {}).values())


def _allowed(answer: Answer, k: int) -> Array:
    """At which states of set k a version has an M; what foreign code answers may be anything."""
    for M in answer.calls[k].get(("M", (), "batch"), ())[:1]:
        if M.shape[:1] == (STATES,):
            return np.asarray(np.isfinite(M.reshape(STATES, -1)).all(axis=1))
    return np.zeros(STATES, dtype=bool)


def _constants_of(model: Model) -> Answer:
    """Defaults and constants: of our own text they are known, else it is asked."""
    if model.bundle is None:
        return asked_of(model, [])
    fields = model.bundle.derivation.parameters.fields
    return Answer({f.name: np.asarray(f.default, dtype=float) for f in fields})


def asked_of(model: Model, sets: Sequence[dict[str, Any]]) -> Answer:
    """What the NumPy module of a version answers.

    Raises:
        ExecutionError: it cannot be run.
    """
    request = {"defaults": [p["name"] for p in model.parameters], "sets": list(sets)}
    return execute(model.label, model.name, model.python, request, _isolation(model))


def _isolation(model: Model) -> Isolation | None:
    """Our own text needs no more than a process of its own."""
    return None if model.bundle is None else Isolation.NONE


def request_for(s: Set, *, consistent: bool | str = False) -> dict[str, Any]:
    """A set as `runner.py` reads it."""
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


def _for_c(values: dict[str, Array]) -> dict[str, Array]:
    """What is the same for all states is given to each."""
    return {n: np.tile(v, (STATES, 1)) if n in SHARED else v for n, v in values.items()}
