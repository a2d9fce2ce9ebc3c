"""What inverse dynamics and completed accelerations must satisfy, judged without their rule.

Forces are judged by what they do: what they leave of M A + Z - W, row by row; the acceleration
that they cause in the independent projection; whether any others do better.  Accelerations that a
mechanism can have are made by random forces, in the projection.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from pne_sym.model.manipulator import Manipulator
from tests.oracle.coordinates import passive_extra_rows
from tests.oracle.forces import are_held, rank
from tests.oracle.jets import Array
from tests.oracle.projection import Result, accelerated, admissible, project
from tests.oracle.specs import State

Note = Callable[[str, float], None]


class Invariants:
    """One state of one mechanism.

    Attributes:
        K: (NV, NU + NC) the model's [H Hk].
        passive, others: its rows of passive extra coordinates, and the rest.
    """

    def __init__(
        self,
        manipulator: Manipulator,
        module: Any,
        state: State,
        rng: np.random.Generator,
        guess: Mapping[str, Array],
    ) -> None:
        self.manipulator, self.module, self.state = manipulator, module, state
        self.rng, self.guess = rng, guess
        self.M, self.Z, H = module.dynamics(state.X, state.V, **guess)
        Hk = module.Hk(state.X, **guess) if module.NC else np.zeros((module.NV, 0))
        self.K = np.hstack([H, Hk])
        self.load = np.zeros(module.NV)
        self.load[: module.NW] = state.wrench
        self.passive = passive_extra_rows(manipulator)
        self.others = [row for row in range(module.NV) if row not in self.passive]

    def check(self, note: Note) -> None:
        """Tell every error, relative to the size of what is compared."""
        m, s = self.module, self.state
        ours: Result = project(self.manipulator, s.X, s.q, s.V, s.A, s.wrench)
        A = accelerated(self.manipulator, ours, self.rng.uniform(-20.0, 20.0, m.NU))
        self._null_space(note)
        if not are_held(np.hstack([ours.H, ours.Hk]), self.passive):
            note("too few actuators", 0.0 if np.isnan(self._forces(A)).all() else np.inf)
            found = self._completed(A)
            empty = np.isnan(found).all() if self.passive else np.array_equal(found, A)
            note("completed for too few actuators", 0.0 if empty else np.inf)
            return
        note("completed A of actuators", _off(self._completed(A), A))
        self._round_trip(note, ours, A)
        N, c = admissible(ours)
        any_A = c + N @ self.rng.uniform(-5.0, 5.0, N.shape[1])
        if rank(self.K) == m.NV:
            # Every A has forces that the mechanism can have at all.
            note("completed A", 0.0 if np.array_equal(self._completed(any_A), any_A) else np.inf)
            self._round_trip(note, ours, any_A)
            return
        self._nearest(note, any_A)
        if self._can_complete():
            self._least_change(note, any_A)

    # ---- parts -----------------------------------------------------------------------

    def _completed(self, A: Array) -> Array:
        s = self.state
        found = self.module.complete_acceleration(s.X, s.V, A, wrench=s.wrench, **self.guess)
        return np.asarray(found)

    def _forces(self, A: Array, weights: Array | None = None) -> Array:
        """tau, then lambda."""
        s = self.state
        found = self.module.inverse_dynamics(
            s.X, s.V, A, wrench=s.wrench, weights=weights, **self.guess
        )
        return np.concatenate(found) if self.module.NC else np.asarray(found)

    def _left(self, A: Array, x: Array) -> Array:
        """What forces leave of M A + Z - W, relative to the largest of the terms."""
        terms = [self.M * A, self.Z, self.load, self.K * x]
        return np.asarray((self.M @ A + self.Z - self.load - self.K @ x) / _most(terms))

    def _round_trip(self, note: Note, ours: Result, A: Array) -> None:
        """Forces for A cause A: in the model, and in the projection; with any weights."""
        s, m = self.state, self.module
        weights = self.rng.uniform(0.1, 10.0, m.NU)
        for x in (self._forces(A), self._forces(A, weights)):
            note("left of the force", _most([self._left(A, x)]))
            back = m.forward_dynamics(s.X, s.V, x[: m.NU], wrench=s.wrench, **self.guess)
            note("forward of inverse", _off(back[0] if m.NC else back, A))
            expected = accelerated(self.manipulator, ours, x[: m.NU])
            note("projection of inverse", _off(expected, A))
        # Nothing that adds no force makes the weighted norm less.
        idle = _null_space(self.K)[: m.NU]
        slope = (x[: m.NU] * weights) @ idle
        note("weighted norm", _most([slope]) / _most([x[: m.NU] * weights]))

    def _nearest(self, note: Note, A: Array) -> None:
        """For an A without forces: other rows hold, no forces leave less of the passive ones."""
        left = self._left(A, self._forces(A))
        note("left of other rows", _most([left[self.others]]))
        changes = self.K[self.passive] @ _null_space(self.K[self.others])
        slope = left[self.passive] @ changes
        note("left of passive rows", _most([slope]) / max(_most([changes]), 1e-3))

    def _can_complete(self) -> bool:
        """Whether passive accelerations reach what the forces leave open."""
        system = np.hstack([self.M[:, self.passive], self.K])
        values = np.linalg.svd(system / np.abs(system).max(axis=1)[:, None], compute_uv=False)
        return len(values) == len(self.K) and bool(values[-1] > 1e-4 * values[0])

    def _least_change(self, note: Note, A: Array) -> None:
        """Completed: only passive entries change, forces exist, and no smaller change would do."""
        found = self._completed(A)
        kept = np.array_equal(found[self.others], A[self.others])
        note("completed entries", 0.0 if kept else np.inf)
        x = self._forces(found)
        note("left of completed", _most([self._left(found, x)]))
        own = self.M[:, self.passive]
        free = _null_space(np.hstack([own, -self.K]))[: len(self.passive)]
        change = (found - A)[self.passive]
        pull = own[self.passive] @ change
        note("least change", _most([pull @ free]) / max(_most([pull]), 1e-3))

    def _null_space(self, note: Note) -> None:
        """An orthonormal basis of the tau without force."""
        H, m = self.K[:, : self.module.NU], self.module
        basis = m.null_space(self.state.X, **self.guess)
        gap = basis.T @ basis - np.eye(basis.shape[1])
        note("null space", max(_most([H @ basis]) / _most([H]), _most([gap])))
        if not m.NC and basis.shape[1] != m.NU - rank(H):
            note("null space", np.inf)


def _null_space(matrix: Array) -> Array:
    _, _, right = np.linalg.svd(matrix)
    return np.asarray(right[rank(matrix) :].T)


def _most(arrays: list[Array]) -> float:
    return max(float(np.abs(array).max(initial=0.0)) for array in arrays)


def _off(found: Array, wanted: Array) -> float:
    return _most([found - wanted]) / _most([wanted])
