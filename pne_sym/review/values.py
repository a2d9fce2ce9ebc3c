"""Two versions run at common parameters and states: all functions, of NumPy and of C."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pne_sym.program.interpret import REST
from pne_sym.review.alignment import Alignment
from pne_sym.review.c_driver import Array, CAnswer, c_calls
from pne_sym.review.correspondence import Correspondence, same_platform
from pne_sym.review.equations import Sample
from pne_sym.review.execution import (
    Answer,
    Asked,
    ExecutionError,
    execute,
    execute_c,
    packed,
)
from pne_sym.review.model import Model, by_name, by_path, paths_of
from pne_sym.review.samples import (
    SHARED,
    actuated,
    carried,
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
        self.answers = _both(
            _asked(m, [_request(s) for s in sets])
            for m, sets in zip(self.models, self.sets, strict=True)
        )
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
        if self._axis_moved(path):
            return self.defaults[1][path]
        zeros = self._zeros.get(path, ())
        if not zeros:
            return drawn
        value = np.array(drawn, dtype=float)
        value.reshape(-1)[list(zeros)] = self.defaults[1][path].reshape(-1)[list(zeros)]
        return value

    def _axis_moved(self, path: str) -> bool:
        """Whether a live axis stands otherwise: what it may be, its relations to others say."""
        key = path.rpartition(".")[2]
        old, new = (d.get(path) for d in self.defaults)
        if "axis" not in key or old is None or new is None:
            return False
        return not np.array_equal(old, new)

    @property
    def _zeros(self) -> dict[str, tuple[int, ...]]:
        """Entries that are zero by structure before, by path."""
        return {
            path: tuple(p.get("zero_by_structure", ()))
            for p in self.models[0].parameters
            for path in paths_of(p)
        }

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
            _request(Set(p, v), consistent=True)
            for p, v in zip(parameters[leader], drafts, strict=True)
        ]
        states = _asked(model, asked).states
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
            Set(p, {n: _fitted(own, n, v, other.manifest) for n, v in s.values.items()})
            for p, s in zip(parameters, led, strict=True)
        ]
        if own.joints("joints") == list(range(one.manifest["sizes"]["NJ"])):
            return found
        asked = [_request(s, consistent="q") for s in found]
        for s, made in zip(found, _asked(other, asked).states, strict=True):
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
        found = []
        both_move = all(takes_base(m.manifest) for m in self.models)
        for k in range(PARAMETER_SETS if self.comparable else 0):
            old, new = self.sets[0][k], self.sets[1][k]
            allowed = [_allowed(answer, k) for answer in self.answers]
            both = [s for s in self.kept[k] if all(version[s] for version in allowed)]
            for s in both[:_PER_SET]:
                vectors = [
                    {n: side.values[n][s] for n in ("X", "V", "A", "q", "base")}
                    | ({} if both_move else {"base": REST})
                    for side in (old, new)
                ]
                found.append(
                    Sample(old.parameters or {}, new.parameters or {}, (vectors[0], vectors[1]))
                )
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


def takes_base(manifest: Mapping[str, Any]) -> bool:
    """Whether the base of a version moves; if that of one alone does, it is compared at rest."""
    return any("base" in f.get("inputs", ()) for f in manifest.get("functions", {}).values())


def _allowed(answer: Answer, k: int) -> Array:
    """At which states of set k a version has an M; what foreign code answers may be anything."""
    for M in answer.calls[k].get(("M", (), "batch"), ())[:1]:
        if M.shape[:1] == (STATES,):
            return np.asarray(np.isfinite(M.reshape(STATES, -1)).all(axis=1))
    return np.zeros(STATES, dtype=bool)


def _both(answers: Iterable[Answer]) -> tuple[Answer, Answer]:
    before, after = answers
    return before, after


def _constants_of(model: Model) -> Answer:
    """Defaults and constants: of our own text they are known, else it is asked."""
    if model.bundle is None:
        return _asked(model, [])
    fields = model.bundle.derivation.parameters.fields
    return Answer({f.name: np.asarray(f.default, dtype=float) for f in fields})


def _asked(model: Model, sets: Sequence[dict[str, Any]]) -> Answer:
    request = {"defaults": [p["name"] for p in model.parameters], "sets": list(sets)}
    return execute(model.label, model.name, model.python, request, _isolation(model))


def _isolation(model: Model) -> Isolation | None:
    """Our own text needs no more than a process of its own."""
    return None if model.bundle is None else Isolation.NONE


def _request(s: Set, *, consistent: bool | str = False) -> dict[str, Any]:
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


def _fitted(own: Correspondence, name: str, value: Array, manifest: Mapping[str, Any]) -> Array:
    """Values of an argument as a version orders its entries."""
    places = own.of(name)
    if places is None:
        return value
    home = np.array(manifest["home"]["X" if name in ("X", "X0") else "q"], dtype=float)
    fill = home if name in ("X", "X0", "q", "q0") else np.ones(len(places))
    return carried(value, places, fill)


def _for_c(values: dict[str, Array]) -> dict[str, Array]:
    """What is the same for all states is given to each."""
    return {n: np.tile(v, (STATES, 1)) if n in SHARED else v for n, v in values.items()}
