"""Small linear systems solved by their zero pattern.

Rows and columns with a single entry are eliminated first; what remains dense is
solved by determinants up to three unknowns.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import sympy as sp

from pne_sym.lowering.builder import Atom, Builder

Rows = list[list[Atom]]


class SingularPattern(ValueError):
    """The zero pattern leaves the system without a solution."""


Scale = Callable[[int, int], Atom]


def solve(b: Builder, matrix: Rows, right: Sequence[Atom], scale: Scale,
          hints: Sequence[str]) -> list[Atom]:
    """Solve matrix x = right; rows that are zero throughout are left out.

    Args:
        b: where statements go; pivots are guarded there.
        matrix: rows of atoms, as many non-zero rows as columns.
        right: one atom per row.
        scale: size, a parameter, by which the pivot at (row, column) is measured.
        hints: names for the unknowns.

    Raises:
        SingularPattern: by structure there is no unique solution.
    """
    rows = [i for i, row in enumerate(matrix) if any(e != 0 for e in row)]
    columns = list(range(len(hints)))
    if len(rows) != len(columns):
        raise SingularPattern("the joints' freedoms are dependent by structure")
    system = _System(b, matrix, list(right), scale, hints)
    system.run(rows, columns)
    return [system.x[j] for j in range(len(hints))]


class _System:
    def __init__(self, b: Builder, matrix: Rows, right: list[Atom], scale: Scale,
                 hints: Sequence[str]) -> None:
        self.b, self.m, self.r, self.scale, self.hints = b, matrix, right, scale, hints
        self.x: dict[int, Atom] = {}

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
        b = self.b
        right = {i: self._rest(i, columns) for i in rows}
        if len(rows) == 2:
            minors, determinant = self._two(rows, columns)
        elif len(rows) == 3:
            minors, determinant = self._three(rows, columns)
        else:
            raise SingularPattern("no pattern for a dense system of more than three unknowns")
        scale: Any = sp.S.One
        for i, j in zip(rows, columns, strict=True):
            scale = scale * self.scale(i, j)
        b.guard("singular", determinant, b.let(scale), 1)
        for j in columns:
            total = b.add([b.mul(minors[i, j], right[i]) for i in rows])
            self.x[j] = b.divide(total, determinant, self.hints[j])

    def _two(self, rows: list[int], columns: list[int]) -> tuple[dict[Any, Atom], Atom]:
        (i, k), (j, n) = rows, columns
        a, e, c, d = self.m[i][j], self.m[i][n], self.m[k][j], self.m[k][n]
        determinant = self._minor(a, d, e, c)
        return {(i, j): d, (k, j): -e, (i, n): -c, (k, n): a}, determinant

    def _three(self, rows: list[int], columns: list[int]) -> tuple[dict[Any, Atom], Atom]:
        minors: dict[Any, Atom] = {}
        for p in range(3):
            for q in range(3):
                i, k = rows[(p + 1) % 3], rows[(p + 2) % 3]
                j, n = columns[(q + 1) % 3], columns[(q + 2) % 3]
                minors[rows[p], columns[q]] = self._minor(
                    self.m[i][j], self.m[k][n], self.m[i][n], self.m[k][j])
        first = rows[0]
        determinant = self.b.add(
            [self.b.mul(self.m[first][j], minors[first, j]) for j in columns])
        return minors, determinant

    def _minor(self, a: Atom, d: Atom, e: Atom, c: Atom) -> Atom:
        return self.b.add((self.b.mul(a, d), -self.b.mul(e, c)))
