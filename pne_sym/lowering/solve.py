"""Small linear systems solved by their zero pattern.

Rows and columns with a single entry are eliminated first; what remains dense is
solved by determinants.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import sympy as sp

from pne_sym.lowering.builder import Atom, Builder

Rows = list[list[Atom]]


class SingularPatternError(ValueError):
    """The zero pattern leaves the system without a solution."""


Scale = Callable[[int, int], Atom]


def solve(
    b: Builder, matrix: Rows, right: Sequence[Atom], scale: Scale, hints: Sequence[str]
) -> list[Atom]:
    """Solve matrix x = right; rows that are zero throughout are left out.

    Args:
        b: where statements go; pivots are guarded there.
        matrix: rows of atoms, as many non-zero rows as columns.
        right: one atom per row.
        scale: size, a parameter, by which the pivot at (row, column) is measured.
        hints: names for the unknowns.

    Raises:
        SingularPatternError: by structure there is no unique solution.
    """
    rows = [i for i, row in enumerate(matrix) if any(e != 0 for e in row)]
    columns = list(range(len(hints)))
    if len(rows) != len(columns):
        raise SingularPatternError("the joints' freedoms are dependent by structure")
    system = _System(b, matrix, list(right), scale, hints)
    system.run(rows, columns)
    return [system.x[j] for j in range(len(hints))]


class _System:
    def __init__(
        self, b: Builder, matrix: Rows, right: list[Atom], scale: Scale, hints: Sequence[str]
    ) -> None:
        self.b, self.m, self.r, self.scale, self.hints = b, matrix, right, scale, hints
        self.x: dict[int, Atom] = {}
        self.minors: dict[Any, Atom] = {}

    def run(self, rows: list[int], columns: list[int]) -> None:
        if not rows:
            return
        for i in rows:
            entries = [j for j in columns if self.m[i][j] != 0]
            if len(entries) == 1:
                j = entries[0]
                self._pivot(i, j)
                self.run([k for k in rows if k != i], [k for k in columns if k != j])
                return
        for j in columns:
            entries = [i for i in rows if self.m[i][j] != 0]
            if len(entries) == 1:
                i = entries[0]
                self.run([k for k in rows if k != i], [k for k in columns if k != j])
                self._pivot(i, j)
                return
        self._dense(rows, columns)

    def _rest(self, i: int, unknown: Sequence[int]) -> Atom:
        """Right-hand side of row i less what is known."""
        terms = [self.r[i]]
        for k, value in self.x.items():
            if k not in unknown:
                terms.append(-self.b.mul(self.m[i][k], value))
        return self.b.add(terms)

    def _pivot(self, i: int, j: int) -> None:
        pivot = self.m[i][j]
        self.b.guard("singular", pivot, self.scale(i, j), 1)
        self.x[j] = self.b.divide(self._rest(i, (j,)), pivot, self.hints[j])

    def _dense(self, rows: list[int], columns: list[int]) -> None:
        """Cramer's rule on the dense rest: the only division is the last, by the determinant."""
        b = self.b
        right = {i: self._rest(i, columns) for i in rows}
        determinant = self._minor(tuple(rows), tuple(columns))
        scale: Any = sp.S.One
        for i, j in zip(rows, columns, strict=True):
            scale = b.mul(scale, self.scale(i, j))
        b.guard("singular", determinant, scale, 1)
        for j in columns:
            terms = []
            for i in rows:
                minor = self._minor(
                    tuple(k for k in rows if k != i), tuple(k for k in columns if k != j)
                )
                sign = (-1) ** (rows.index(i) + columns.index(j))
                terms.append(sign * b.mul(minor, right[i]))
            self.x[j] = b.divide(b.add(terms), determinant, self.hints[j])

    def _minor(self, rows: tuple[int, ...], columns: tuple[int, ...]) -> Atom:
        """Determinant of a part of the matrix, by its row with most zeros."""
        b = self.b
        if not rows:
            return sp.S.One
        if len(rows) == 1:
            return self.m[rows[0]][columns[0]]
        key = (rows, columns)
        if key not in self.minors:
            i = min(rows, key=lambda r: sum(self.m[r][c] != 0 for c in columns))
            rest = tuple(r for r in rows if r != i)
            terms = []
            for place, j in enumerate(columns):
                if self.m[i][j] == 0:
                    continue
                sign = (-1) ** (rows.index(i) + place)
                inner = self._minor(rest, tuple(c for c in columns if c != j))
                terms.append(sign * b.mul(self.m[i][j], inner))
            self.minors[key] = b.add(terms)
        return self.minors[key]
