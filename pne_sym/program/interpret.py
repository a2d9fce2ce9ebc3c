"""Public functions of a program, evaluated step by step: what every back end must agree with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pne_sym.program.evaluate import Array, Flags, Status, evaluate
from pne_sym.program.ir import Program
from pne_sym.program.iteration import close_loops
from pne_sym.program.operation import finite
from pne_sym.program.operations import OPERATIONS
from pne_sym.program.public import Apply, Argument, Default, PublicFunction, Run, Search

SEARCH_STEPS, HALVINGS = 50, 12
"""Steps of a search for a pose, and how often each may be halved."""
FOUND, CLOSE = 1e-9, 1e-14
"""A residual [m, rad] that counts as found, and one at which the search ends."""
REST = np.concatenate((np.eye(3).ravel(), np.zeros(9)))
"""A base that does not move."""


@dataclass(frozen=True)
class Answer:
    """What a public function gives.

    Attributes:
        outputs: arrays (states, *shape), in order; NaN where the status is not OK.
        status: `Status` of every state.
    """

    outputs: tuple[Array, ...]
    status: NDArray[np.int_]


def inputs_read(program: Program, function: PublicFunction) -> set[str]:
    """Names of the inputs on which its results depend: others may be anything.

    Helpers for poses look at all: there is no rate at a pose that is none.
    """
    if not function.needs_model:
        return {a.name for a in function.inputs}
    read = set[str]()
    for step in function.steps:
        read |= {operand.name for operand in step.operands}
        if isinstance(step, Run):
            vectors = program.functions[step.function].inputs
            read |= {"X", "q0", *vectors} if "q" in vectors else set(vectors)
        elif isinstance(step, Search):
            parts = (f for f in program.public if f.name in (step.residual, step.slope))
            read |= set[str]().union(*(inputs_read(program, f) - {"X"} for f in parts))
    return read & {a.name for a in function.inputs}


def judged(a: Array, *, unbounded: bool) -> Array:
    """What tells whether a result is possible: infinite entries may be."""
    return np.where(np.isposinf(a), 0.0, a) if unbounded else a


class Interpreter:
    """The public functions of a model, and others, at prepared parameters."""

    def __init__(
        self,
        program: Program,
        prepared: Mapping[str, Array],
        home_q: Sequence[float] | Array,
        *others: PublicFunction,
    ) -> None:
        self.program, self.prepared = program, prepared
        self.functions = {f.name: f for f in (*program.public, *others)}
        self.home_q = np.asarray(home_q, dtype=float)

    def call(self, name: str, **arguments: Array) -> Answer:
        """A public function at arguments (states, n); optional ones may be left out.

        Raises:
            KeyError: no such function, or a required argument is missing.
        """
        function = self.functions[name]
        states = next(len(arguments[a.name]) for a in function.required)
        values = {a.name: self._argument(a, arguments, states) for a in function.inputs}
        state = _State(self, values, states)
        for read in sorted(inputs_read(self.program, function)):
            state.flag(~finite(values[read]), Status.INVALID)
        for step in function.steps:
            state.do(step)
        outputs = [np.array(state.values[o.name]) for o in function.outputs]
        for array in outputs:  # what is not finite is at least INVALID
            state.flag(~finite(judged(array, unbounded=function.unbounded)), Status.INVALID)
        status = state.status
        for array in outputs:
            array[status != Status.OK] = np.nan
        return Answer(tuple(outputs), status)

    def _argument(self, argument: Argument, given: Mapping[str, Array], states: int) -> Array:
        name, shape, default = argument.name, argument.value.shape, argument.default
        if name in given:
            return np.broadcast_to(np.asarray(given[name], dtype=float), (states, *shape))
        if default is None:
            raise KeyError(name)
        fill = {Default.ZEROS: np.zeros(shape), Default.ONES: np.ones(shape), Default.REST: REST}
        value = self.home_q if default is Default.HOME_Q else fill[default]
        return np.broadcast_to(value, (states, *shape))


class _State:
    """Arrays known so far, and what went wrong where."""

    def __init__(self, model: Interpreter, values: dict[str, Array], states: int) -> None:
        self.model, self.values, self.states = model, values, states
        self.status = np.full(states, int(Status.OK))
        self._q: Array | None = None

    def flag(self, failed: Flags, status: Status) -> None:
        """The first cause that is met stays."""
        self.status[failed & (self.status == Status.OK)] = status

    def do(self, step: Run | Apply | Search) -> None:
        """One step."""
        if isinstance(step, Run):
            self._run(step)
        elif isinstance(step, Apply):
            self._apply(step)
        else:
            self.values[step.targets[0].name] = self._search(step)

    def _run(self, step: Run) -> None:
        function = self.model.program.functions[step.function]
        vectors = {v: self.values[v] for v in function.inputs if v != "q"}
        if "q" in function.inputs:
            vectors["q"] = self._closed()
        found = evaluate(self.model.program, step.function, self.model.prepared, vectors)
        for target, array in zip(step.targets, function.arrays, strict=True):
            made = found.outputs[array]  # once, where it depends on the parameters alone
            self.values[target.name] = np.broadcast_to(made, (self.states, *made.shape[1:]))
        for status in Status:
            if status is not Status.OK:
                self.flag(found.status == status, status)

    def _closed(self) -> Array:
        """Displacements by iteration from q0, once."""
        if self._q is None:
            q, converged = close_loops(
                self.model.program, self.model.prepared, self.values["X"], self.values["q0"]
            )
            self.flag(~converged, Status.NOT_CONVERGED)
            self._q = q
        return self._q

    def _apply(self, step: Apply) -> None:
        operation = OPERATIONS[step.operation]
        operands = [self.values[o.name] for o in step.operands]
        known = np.ones(self.states, dtype=bool)
        for operand in operands:
            known &= finite(operand)
        results = operation(operands, step.numbers)
        for target, result in zip(step.targets, results, strict=True):
            self.values[target.name] = result
            lost = ~finite(judged(result, unbounded=operation.unbounded))
            self.flag(known & lost, operation.status)

    # ---- searches ----------------------------------------------------------------------------

    def _search(self, step: Search) -> Array:
        """Gauss-Newton, state by state."""
        start = step.operands[0].name
        found = np.array(self.values[start])
        for k in range(self.states):
            row = {n: v[k : k + 1] for n, v in self.values.items() if n != start}
            found[k], status = self._search_one(step, found[k : k + 1], row)
            if status is not Status.OK:
                self.flag(np.arange(self.states) == k, status)
        return found

    def _search_one(
        self, step: Search, X: Array, given: Mapping[str, Array]
    ) -> tuple[Array, Status]:
        call = self.model.call
        names = [a.name for a in self.model.functions[step.residual].inputs]
        others = {n: v for n, v in given.items() if n in names and n != "X"}
        slope_of = {n: v for n, v in others.items() if n == "q0"}
        answer = call(step.residual, X=X, **others)
        (residual,) = answer.outputs
        for _ in range(SEARCH_STEPS):
            size = float(np.max(np.abs(residual), initial=0.0))
            if not np.isfinite(size):
                return X[0] * np.nan, Status(int(answer.status[0]))
            if size < CLOSE:
                break
            (slope,) = call(step.slope, X=X, **slope_of).outputs
            if not np.isfinite(slope).all():
                return X[0] * np.nan, Status.SINGULAR
            change = np.linalg.lstsq(slope[0].T, residual[0], rcond=1e-10)[0]
            for halving in range(HALVINGS if step.halving else 1):
                (trial,) = call("retract", X=X, step=change[None] * 0.5**halving).outputs
                answer = call(step.residual, X=trial, **others)
                (trial_residual,) = answer.outputs
                if not step.halving or np.max(np.abs(trial_residual), initial=0.0) < size:
                    break
            else:
                break
            X, residual = trial, trial_residual
            if not step.halving and float(np.max(np.abs(change))) < 0.1 * CLOSE:
                break
        lost = not float(np.max(np.abs(residual), initial=0.0)) < FOUND
        return (X[0] * np.nan, Status.NOT_CONVERGED) if lost else (X[0], Status.OK)
