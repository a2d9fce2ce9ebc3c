"""Components of tensor expressions, by what they are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy as sp

from pne_sym.lowering.statements import Atom
from pne_sym.lowering.triples import Matrix, Triple, entry, matrix, transposed
from pne_sym.vector import nodes as n

if TYPE_CHECKING:
    from pne_sym.lowering.components import Lowering


def _add(of: Lowering, expr: Any, frame: str, hint: str) -> Matrix:
    parts = [of.tensor(term, frame) for term in expr.args]
    return matrix(lambda i, j: of.b.add([p[i][j] for p in parts], entry(hint, i, j)))


def _scale(of: Lowering, expr: Any, frame: str, hint: str) -> Matrix:
    s, t = of.scalar(expr.args[0]), of.tensor(expr.args[1], frame)
    return matrix(lambda i, j: of.b.mul(s, t[i][j], entry(hint, i, j)))


def _skew(of: Lowering, expr: Any, frame: str, _hint: str) -> Matrix:
    x, y, z = of.vector(expr.args[0], frame)
    zero = sp.S.Zero
    return ((zero, -z, y), (z, zero, -x), (-y, x, zero))


def _outer(of: Lowering, expr: Any, frame: str, hint: str) -> Matrix:
    a, c = of.vector(expr.args[0], frame), of.vector(expr.args[1], frame)
    return matrix(lambda i, j: of.b.mul(a[i], c[j], entry(hint, i, j)))


def _compose(of: Lowering, expr: Any, frame: str, hint: str) -> Matrix:
    first, second = expr.args
    if isinstance(first, n.Skew) and first == second:
        return _skew_squared(of, of.vector(first.args[0], frame), hint)
    a, columns = of.tensor(first, frame), transposed(of.tensor(second, frame))
    return matrix(lambda i, j: of.b.dot(a[i], columns[j], entry(hint, i, j)))


def _skew_squared(of: Lowering, w: Triple, hint: str) -> Matrix:
    """w~ w~ = w w^T - (w . w) E: squares once."""
    b = of.b
    squares = [b.mul(c, c) for c in w]

    def product(i: int, j: int) -> Atom:
        if i != j:
            return b.mul(w[min(i, j)], w[max(i, j)], entry(hint, min(i, j), max(i, j)))
        return -b.add((squares[(i + 1) % 3], squares[(i + 2) % 3]), entry(hint, i, i))

    return matrix(product)


def _transpose(of: Lowering, expr: Any, frame: str, _hint: str) -> Matrix:
    return transposed(of.tensor(expr.args[0], frame))


def _total(of: Lowering, expr: Any, frame: str, hint: str) -> Matrix:
    value, leg_type = expr.args
    t = of.tensor(value, frame)
    stem = f"{hint or 'total'}_{leg_type.name}"
    traceless = _has_no_trace(value)

    def total(i: int, j: int) -> Atom:
        if i == j == 0 and traceless:
            return -of.b.add([total(1, 1), total(2, 2)], entry(stem, 0, 0))
        return of.b.total(t[i][j], leg_type.name, entry(stem, i, j))

    found = matrix(total)
    of.note_total(expr, frame, found)
    return found


def _has_no_trace(expr: Any) -> bool:
    """Whether the diagonal sums up to zero by structure: of a symmetric tensor times a skew one."""
    if isinstance(expr, n.TensorScale):
        return _has_no_trace(expr.args[1])
    if not isinstance(expr, n.Compose):
        return False
    first, second = expr.args
    pairs = ((first, second), (second, first))
    return any(
        isinstance(skew, n.Skew) and getattr(other, "is_symmetric", False) for skew, other in pairs
    )


OPERATIONS: dict[type, Any] = {
    n.TensorAdd: _add,
    n.TensorScale: _scale,
    n.Skew: _skew,
    n.Outer: _outer,
    n.Compose: _compose,
    n.Transpose: _transpose,
    n.TensorLegSum: _total,
}
