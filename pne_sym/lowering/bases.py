"""Reciprocal bases: what resolves a twist or a wrench along a leg's degrees of freedom."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import sympy as sp

from pne_sym.derivation import ReciprocalBasis
from pne_sym.lowering.solve import Screws, solve, solve_transposed
from pne_sym.lowering.statements import Atom
from pne_sym.lowering.triples import Triple
from pne_sym.vector import nodes as n

if TYPE_CHECKING:
    from pne_sym.lowering.components import Lowering


class Bases:
    """The reciprocal bases of a derivation, lowered where they are needed.

    Attributes:
        duals: name of a reciprocal vector -> (basis, its number).
        coefficients: name of a moment part -> (basis, number of the wrench, moment direction).
    """

    def __init__(self, of: Lowering) -> None:
        self.lowering, self.b, self.trials = of, of.b, of.trials
        self.all = of.d.bases
        complete = [b for b in self.all if len(b.duals) == len(b.vectors)]
        self.duals = {w.name: (basis, k) for basis in complete for k, w in enumerate(basis.duals)}
        self.coefficients = {
            coefficient.name: (basis, k, i)
            for basis in complete
            for k, coefficients in enumerate(basis.moment_duals)
            for i, coefficient in enumerate(coefficients)
        }
        self._named_parts = {
            (e.rhs.args[0].name, e.rhs.args[1]): e.name
            for e in of.definition.values()
            if isinstance(e.rhs, n.Dot) and self.of(e.rhs.args[0]) is not None
        }
        self._frame: dict[int, str] = {}
        self._screws: dict[int, Screws] = {}

    def of(self, vector: Any) -> tuple[ReciprocalBasis, int] | None:
        """Basis and number of a vector, if it is a reciprocal one."""
        return self.duals.get(getattr(vector, "name", ""))

    def frame(self, basis: ReciprocalBasis) -> str:
        """The frame in which the basis vectors have most zeros."""
        if id(basis) not in self._frame:
            for vector in basis.vectors:
                self.lowering.ensure(getattr(vector, "name", ""))
            costs = []
            for frame in basis.frames:
                trial = self.trials.attempt(partial(self._columns, basis, frame))
                nonzero = sum(c not in (0, 1, -1) for column in trial.value for c in column)
                costs.append((nonzero, trial.cost))
            self._frame[id(basis)] = basis.frames[costs.index(min(costs))]
        return self._frame[id(basis)]

    def resolve(
        self, basis: ReciprocalBasis, x: Any, coefficients: Sequence[Any] = ()
    ) -> list[Atom]:
        """w_j . x + sum_i m_ji amount_i for all j: sum v_j y_j = x, moment rows on the right."""
        moments = [self.lowering.scalar(a) for a in coefficients] or [sp.S.Zero] * len(basis.rows)
        right = [*self.lowering.vector(x, self.frame(basis)), *moments]
        hints = [self._named_parts.get((getattr(w, "name", ""), x), "") for w in basis.duals]
        return solve(self.b, self._system(basis), right, hints)

    def wrench(self, basis: ReciprocalBasis, weights: Sequence[Any]) -> list[Atom]:
        """sum g_j (w_j; m_j): the solution of v_j . F + sum_i E_ij mu_i = g_j.

        Three components of the force, in the basis's frame, then the moment coefficients.
        """
        return solve_transposed(
            self.b, self._system(basis), [self.lowering.scalar(g) for g in weights]
        )

    def single(self, basis: ReciprocalBasis, k: int) -> list[Atom]:
        """Wrench k alone, as `wrench` does."""
        return self.wrench(basis, [sp.Integer(int(j == k)) for j in range(len(basis.vectors))])

    def of_screws(self, vectors: Any, rows: Any) -> ReciprocalBasis:
        """The basis of given screws."""
        return next(
            b
            for b in self.all
            if sp.Tuple(*b.vectors) == vectors and sp.Tuple(*(sp.Tuple(*r) for r in b.rows)) == rows
        )

    def _columns(self, basis: ReciprocalBasis, frame: str) -> list[Triple]:
        return [self.lowering.vector(v, frame) for v in basis.vectors]

    def _system(self, basis: ReciprocalBasis) -> Screws:
        """The screws of a basis, their sizes, and the weights of their moment rows."""
        if id(basis) not in self._screws:
            columns = self._columns(basis, self.frame(basis))
            moments = [[self.lowering.scalar(sp.sympify(e)) for e in row] for row in basis.rows]
            screws = Screws(
                [*([column[i] for column in columns] for i in range(3)), *moments],
                [self.lowering.scalar(s) for s in basis.scales],
                [sp.S.One] * 3 + [self.lowering.scalar(basis.length)] * len(basis.rows),
                self.trials.store,
            )
            self.trials.store(self._screws, id(basis), screws)
        return self._screws[id(basis)]
