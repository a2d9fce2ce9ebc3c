"""Small linear systems of a leg's screws, solved by their zero pattern.

Rows and columns with a single entry are eliminated first.  What remains dense is
solved by determinants while it is small, beyond that by an orthogonal basis of the
screws: both divide only by what vanishes where the leg is singular, whatever the
pose, so no choice of pivots is needed at run time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import sympy as sp

from pne_sym.lowering.builder import Builder
from pne_sym.lowering.statements import Atom

Rows = list[list[Atom]]
_LARGEST_BY_DETERMINANTS = 4


class SingularPatternError(ValueError):
    """The zero pattern leaves the system without a solution."""


@dataclass
class Screws:
    """Columns of a system.

    Attributes:
        rows: the matrix, by rows; rows that are zero throughout are left out.
        sizes: per column, a parameter by which it is measured once the rows have their weights.
        weights: per row, the parameter that makes it comparable with the others.
        keep: stores what is worth keeping, and forgets it with a rolled-back trial.
    """

    rows: Rows
    sizes: list[Atom]
    weights: list[Atom]
    keep: Callable[[dict[Any, Any], Any, Any], Any]
    used: list[int] = field(init=False)
    columns: list[int] = field(init=False)
    _bases: dict[Any, Any] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        self.columns = list(range(len(self.sizes)))
        self.used = [i for i, row in enumerate(self.rows) if any(e != 0 for e in row)]
        if len(self.used) != len(self.sizes):
            raise SingularPatternError("the joints' degrees of freedom are dependent by structure")

    def orthogonal(self, b: Builder, rows: Sequence[int], columns: Sequence[int]) -> _Orthogonal:
        """Orthonormal basis of a part of the screws."""
        key = (tuple(rows), tuple(columns))
        if key not in self._bases:
            self.keep(self._bases, key, _Orthogonal(b, self, rows, columns))
        found: _Orthogonal = self._bases[key]
        return found


def solve(b: Builder, screws: Screws, right: Sequence[Atom], hints: Sequence[str]) -> list[Atom]:
    """x with sum_j screw_j x_j = right; hints name the unknowns.

    Raises:
        SingularPatternError: by structure there is no unique solution.
    """
    system = _System(b, screws, right, hints, across=False)
    system.run(screws.used, screws.columns)
    return [system.x[j] for j in screws.columns]


def solve_transposed(b: Builder, screws: Screws, right: Sequence[Atom]) -> list[Atom]:
    """y with screw_j . y = right_j for every j; zero for rows that are left out.

    Raises:
        SingularPatternError: by structure there is no unique solution.
    """
    system = _System(b, screws, right, [""] * len(screws.rows), across=True)
    system.run(screws.columns, screws.used)
    return [system.x.get(i, sp.S.Zero) for i in range(len(screws.rows))]


class _System:
    """Equations by number, unknowns by number; across: the equations are the screws."""

    def __init__(
        self,
        b: Builder,
        screws: Screws,
        right: Sequence[Atom],
        hints: Sequence[str],
        *,
        across: bool,
    ) -> None:
        self.b, self.screws, self.r, self.hints, self.across = b, screws, right, hints, across
        self.x: dict[int, Atom] = {}
        self.minors: dict[Any, Atom] = {}

    def entry(self, i: int, j: int) -> Atom:
        """Coefficient of unknown j in equation i."""
        return self.screws.rows[j][i] if self.across else self.screws.rows[i][j]

    def size(self, i: int, j: int) -> Atom:
        """What the entry is measured by: the size of its column, without its row's weight."""
        column, row = (i, j) if self.across else (j, i)
        size, weight = self.screws.sizes[column], self.screws.weights[row]
        return sp.S.One if size == weight else self.b.divide(size, weight)

    def run(self, rows: Sequence[int], columns: Sequence[int]) -> None:
        """Solve the equations `rows` for the unknowns `columns`."""
        if not rows:
            return
        for i in rows:
            entries = [j for j in columns if self.entry(i, j) != 0]
            if len(entries) == 1:
                j = entries[0]
                self._pivot(i, j)
                self.run([k for k in rows if k != i], [k for k in columns if k != j])
                return
        for j in columns:
            entries = [i for i in rows if self.entry(i, j) != 0]
            if len(entries) == 1:
                i = entries[0]
                self.run([k for k in rows if k != i], [k for k in columns if k != j])
                self._pivot(i, j)
                return
        if len(rows) <= _LARGEST_BY_DETERMINANTS:
            self._by_determinants(rows, columns)
        elif self.across:
            self._across_orthogonal(rows, columns)
        else:
            self._along_orthogonal(rows, columns)

    def _rest(self, i: int, unknown: Sequence[int]) -> Atom:
        """Right-hand side of row i less what is known."""
        terms = [self.r[i]]
        for k, value in self.x.items():
            if k not in unknown:
                terms.append(-self.b.mul(self.entry(i, k), value))
        return self.b.add(terms)

    def _pivot(self, i: int, j: int) -> None:
        pivot = self.entry(i, j)
        self.b.guard("singular", pivot, self.size(i, j), 1)
        self.x[j] = self.b.divide(self._rest(i, (j,)), pivot, self.hints[j])

    # ---- determinants ----------------------------------------------------------------

    def _by_determinants(self, rows: Sequence[int], columns: Sequence[int]) -> None:
        """Cramer's rule on the dense rest: the only division is the last, by the determinant."""
        b = self.b
        right = {i: self._rest(i, columns) for i in rows}
        determinant = self._minor(tuple(rows), tuple(columns))
        scale: Any = sp.S.One
        for i, j in zip(rows, columns, strict=True):
            scale = b.mul(scale, self.size(i, j))
        b.guard("singular", determinant, scale, 1)
        for q, j in enumerate(columns):
            terms = []
            for p, i in enumerate(rows):
                minor = self._minor(
                    tuple(k for k in rows if k != i), tuple(k for k in columns if k != j)
                )
                terms.append((-1) ** (p + q) * b.mul(minor, right[i]))
            self.x[j] = b.divide(b.add(terms), determinant, self.hints[j])

    def _minor(self, rows: tuple[int, ...], columns: tuple[int, ...]) -> Atom:
        """Determinant of a part of the matrix, by its row with most zeros."""
        b = self.b
        if not rows:
            return sp.S.One
        if len(rows) == 1:
            return self.entry(rows[0], columns[0])
        key = (rows, columns)
        if key not in self.minors:
            i = min(rows, key=lambda r: sum(self.entry(r, c) != 0 for c in columns))
            rest = tuple(r for r in rows if r != i)
            terms = []
            for place, j in enumerate(columns):
                if self.entry(i, j) == 0:
                    continue
                sign = (-1) ** (rows.index(i) + place)
                inner = self._minor(rest, tuple(c for c in columns if c != j))
                terms.append(sign * b.mul(self.entry(i, j), inner))
            self.minors[key] = b.add(terms)
        return self.minors[key]

    # ---- orthogonal basis -------------------------------------------------------------

    def _along_orthogonal(self, rows: Sequence[int], columns: Sequence[int]) -> None:
        """x of sum_j s_j x_j = r: components along the orthogonal basis, then back."""
        b = self.b
        right = [b.mul(self.screws.weights[i], self._rest(i, columns)) for i in rows]
        basis = self.screws.orthogonal(b, rows, columns)
        parts = [b.dot(q, right) for q in basis.units]
        for p in reversed(range(len(basis.order))):
            j = basis.order[p]
            known = [
                -b.mul(basis.upper[p, k], self.x[basis.order[k]])
                for k in range(p + 1, len(basis.order))
            ]
            self.x[j] = b.mul(b.add([parts[p], *known]), basis.inverse[p], self.hints[j])

    def _across_orthogonal(self, rows: Sequence[int], columns: Sequence[int]) -> None:
        """y with s_j . y = r_j: its components along the orthogonal basis, one after another."""
        b = self.b
        right = {j: self._rest(j, columns) for j in rows}
        basis = self.screws.orthogonal(b, columns, rows)
        parts: list[Atom] = []
        for p, j in enumerate(basis.order):
            known = [-b.mul(basis.upper[k, p], parts[k]) for k in range(p)]
            parts.append(b.mul(b.add([right[j], *known]), basis.inverse[p]))
        for place, i in enumerate(columns):
            total = b.dot((q[place] for q in basis.units), parts)
            self.x[i] = b.mul(self.screws.weights[i], total)


class _Orthogonal:
    """Orthonormal vectors that span the screws, by the modified Gram-Schmidt process.

    The screws come with the sparsest first, so that zeros last.  The size of what is left of a
    screw is its distance from those before: it vanishes only where the screws are dependent.

    Attributes:
        order: numbers of the screws in the order of the process.
        units: q_p, by place.
        upper: (p, k) -> part of screw k along q_p.
        inverse: 1 / size of what is left of screw p.
    """

    def __init__(
        self, b: Builder, screws: Screws, rows: Sequence[int], columns: Sequence[int]
    ) -> None:
        left = {j: [b.mul(screws.weights[i], screws.rows[i][j]) for i in rows] for j in columns}
        self.order = sorted(columns, key=lambda j: (sum(c != 0 for c in left[j]), j))
        self.units: list[list[Atom]] = []
        self.upper: dict[tuple[int, int], Atom] = {}
        self.inverse: list[Atom] = []
        for p, j in enumerate(self.order):
            size = _length(b, left[j])
            b.guard("singular", size, screws.sizes[j], 1)
            self.inverse.append(b.inverse(size))
            unit = [b.divide(c, size) for c in left[j]]
            self.units.append(unit)
            for k in range(p + 1, len(self.order)):
                other = self.order[k]
                part = self.upper[p, k] = b.dot(unit, left[other])
                left[other] = [
                    b.add((c, -b.mul(part, u))) for c, u in zip(left[other], unit, strict=True)
                ]


def _length(b: Builder, v: Sequence[Atom]) -> Atom:
    """Euclidean length; of a vector along a coordinate direction that component."""
    present = [c for c in v if c != 0]
    if len(present) == 1:
        return present[0]
    return b.let(sp.sqrt(b.dot(present, present)))
