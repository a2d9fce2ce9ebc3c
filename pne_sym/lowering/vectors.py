"""Components of vector expressions, by what they are."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import sympy as sp

from pne_sym.derivation import ReciprocalBasis
from pne_sym.lowering.scalars import divisor_of
from pne_sym.lowering.statements import Atom
from pne_sym.lowering.triples import Matrix, Triple, cross, entry, triple
from pne_sym.vector import nodes as n

if TYPE_CHECKING:
    from pne_sym.lowering.components import Lowering


def _cross(of: Lowering, expr: Any, frame: str, hint: str) -> Triple:
    return cross(of.b, of.vector(expr.args[0], frame), of.vector(expr.args[1], frame), hint)


def _add(of: Lowering, expr: Any, frame: str, hint: str) -> Triple:
    plain, duals = _split_duals(of, expr.args)
    parts = [of.vector(term, frame) for term in plain]
    for basis, weights in duals:
        parts.append(_force(of, basis, of.bases.wrench(basis, weights), frame))
    return summed(of, parts, hint)


def summed(of: Lowering, parts: Sequence[Triple], hint: str) -> Triple:
    """Components of a sum."""
    named = bool(hint)
    return triple(lambda i: of.b.add([p[i] for p in parts], entry(hint, i), named=named))


def _split_duals(of: Lowering, terms: Iterable[Any]) -> tuple[list[Any], list[Any]]:
    """Terms, and combinations of reciprocal vectors by basis."""
    plain: list[Any] = []
    weights: dict[int, tuple[ReciprocalBasis, list[Any]]] = {}
    for term in terms:
        factor, vector = n.split_scale(term)
        found = of.bases.of(vector)
        if found is None:
            plain.append(term)
            continue
        basis, k = found
        entry = weights.setdefault(id(basis), (basis, [sp.S.Zero] * len(basis.duals)))
        entry[1][k] = entry[1][k] + factor
    return plain, list(weights.values())


def _scale(of: Lowering, expr: Any, frame: str, hint: str) -> Triple:
    factor, vector = expr.args
    if of.bases.of(vector) is not None:
        return _add(of, n.VectorAdd(expr), frame, hint)
    divisor = divisor_of(factor)
    v = of.vector(vector, frame)
    if divisor is not None:
        bottom = of.scalar(divisor)
        top = of.scalar(factor * divisor)
        return triple(lambda i: of.b.divide(of.b.mul(top, v[i]), bottom, entry(hint, i)))
    if all(c == 0 for c in v):
        return v
    s = of.scalar(factor)
    return triple(lambda i: of.b.mul(s, v[i], entry(hint, i)))


def _apply(of: Lowering, expr: Any, frame: str, hint: str) -> Triple:
    v = of.vector(expr.args[1], frame)
    t = of.tensor(expr.args[0], frame)
    return triple(lambda i: of.b.dot(t[i], v, entry(hint, i)))


def _axial(of: Lowering, expr: Any, frame: str, hint: str) -> Triple:
    """Of B S with symmetric S alone: nothing else has an axial vector in a derivation."""
    inner = expr.args[0]
    if not (isinstance(inner, n.Compose) and getattr(inner.args[1], "is_symmetric", False)):
        raise TypeError("no components for the axial vector of a general tensor")
    B, S = (of.tensor(factor, frame) for factor in inner.args)
    return _moment_of(of, B, S, hint)


def _moment_of(of: Lowering, B: Matrix, S: Matrix, hint: str) -> Triple:
    """Axial(B S) for symmetric S, products of inertia taken out once."""
    b = of.b

    def moment(i: int) -> Atom:
        j, k = (i + 1) % 3, (i + 2) % 3
        return b.add(
            (
                b.mul(B[k][i], S[i][j]),
                b.mul(B[k][j], S[j][j]),
                b.mul(S[j][k], b.difference(B[k][k], B[j][j])),
                -b.mul(B[j][i], S[i][k]),
                -b.mul(B[j][k], S[k][k]),
            ),
            entry(hint, i),
        )

    return triple(moment)


def _total(of: Lowering, expr: Any, frame: str, hint: str) -> Triple:
    value, leg_type = expr.args
    v = of.vector(value, frame, f"{hint}_leg" if hint else "")
    stem = f"{hint or 'total'}_{leg_type.name}"
    found = triple(lambda i: of.b.total(v[i], leg_type.name, entry(stem, i)))
    of.note_total(expr, frame, found)
    return found


def single(of: Lowering, basis: ReciprocalBasis, k: int, frame: str) -> Triple:
    """Force part of reciprocal wrench k."""
    return _force(of, basis, of.bases.single(basis, k), frame)


def _force(of: Lowering, basis: ReciprocalBasis, wrench: Sequence[Atom], frame: str) -> Triple:
    """Force part of a wrench of the basis."""
    x, y, z, *_ = wrench
    return of.rotation.vector((x, y, z), of.bases.frame(basis), frame)


def _dual(of: Lowering, expr: Any, frame: str, _hint: str) -> Triple:
    k, *screws = expr.args
    return single(of, of.bases.of_screws(*screws), int(k), frame)


OPERATIONS: dict[type, Any] = {
    n.VectorAdd: _add,
    n.VectorScale: _scale,
    n.Cross: _cross,
    n.Apply: _apply,
    n.Axial: _axial,
    n.DualVector: _dual,
    n.VectorLegSum: _total,
}
