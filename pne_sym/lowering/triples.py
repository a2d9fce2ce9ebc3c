"""Components of vectors and tensors: three atoms, and three rows of three."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import sympy as sp

from pne_sym.lowering.algebra import negative
from pne_sym.lowering.builder import Builder
from pne_sym.lowering.statements import Atom

Triple = tuple[Atom, Atom, Atom]
Matrix = tuple[Triple, Triple, Triple]
XYZ = "xyz"
_T = TypeVar("_T")


def triple(make: Callable[[int], _T]) -> tuple[_T, _T, _T]:
    """What is made for each axis."""
    return make(0), make(1), make(2)


def matrix(make: Callable[[int, int], Atom]) -> Matrix:
    """What is made for each entry, row by row."""
    return triple(lambda i: triple(lambda j: make(i, j)))


IDENTITY = matrix(lambda i, j: sp.Integer(int(i == j)))


def transposed(m: Matrix) -> Matrix:
    """Columns as rows."""
    return matrix(lambda i, j: m[j][i])


def on_both_sides(turn: Callable[[Triple], Triple], m: Matrix) -> Matrix:
    """A m A^T where `turn` takes v to A v: the columns are turned, then the rows."""
    columns = transposed(m)
    rows = transposed(triple(lambda j: turn(columns[j])))
    return triple(lambda i: turn(rows[i]))


def entry(hint: str, *index: int) -> str:
    """Name of a component of what has a name."""
    return f"{hint}_{''.join(XYZ[i] for i in index)}" if hint else ""


def symmetrised(b: Builder, t: Matrix) -> Matrix:
    """Of each pair of equal entries the cheaper one."""
    rows: Any = [list(row) for row in t]
    for i, j in ((0, 1), (0, 2), (1, 2)):
        upper, lower = t[i][j], t[j][i]
        rows[i][j] = rows[j][i] = lower if b.cost([lower]) < b.cost([upper]) else upper
    return triple(lambda i: tuple(rows[i]))


def cross(b: Builder, v: Triple, w: Triple, hint: str = "") -> Triple:
    """Components of v x w."""

    def component(i: int) -> Atom:
        j, k = (i + 1) % 3, (i + 2) % 3
        return b.add((b.mul(v[j], w[k]), negative(b.mul(v[k], w[j]))), entry(hint, i))

    return triple(component)
