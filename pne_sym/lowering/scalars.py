"""Atoms of scalar expressions, by what they are."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import sympy as sp

from pne_sym.derivation import ReciprocalBasis
from pne_sym.lowering.statements import Atom
from pne_sym.vector import nodes as n

if TYPE_CHECKING:
    from pne_sym.lowering.components import Lowering


def atom_of(of: Lowering, expr: Any, hint: str) -> Atom:
    """The atom of a scalar expression that is no number and no symbol."""
    if isinstance(expr, n.Dot):
        return _dot(of, expr, hint)
    if isinstance(expr, n.Trace):
        T = of.tensor(expr.args[0], of.frames_of(expr)[0])
        return of.b.add([T[i][i] for i in range(3)], hint)
    if isinstance(expr, n.DualScalar):
        return _moment_part(of, expr)
    if isinstance(expr, n.LegSum):
        value, leg_type = expr.args
        stem = f"{hint or 'total'}_{leg_type.name}"
        found = of.b.total(of.scalar(value), leg_type.name, stem)
        of.note_total(expr, "", found)
        return found
    if expr.is_Add:
        return _add(of, expr, hint)
    if expr.is_Mul:
        return _product(of, expr, hint)
    if expr.is_Pow:
        return _power(of, expr.base, expr.exp, hint)
    return of.b.let(expr.func(*(of.scalar(a) for a in expr.args)), hint, named=bool(hint))


def _moment_part(of: Lowering, expr: Any) -> Atom:
    """Moment part i of reciprocal wrench k."""
    k, i, *screws = expr.args
    return of.bases.single(of.bases.of_screws(*screws), int(k))[3 + int(i)]


def _add(of: Lowering, expr: Any, hint: str) -> Atom:
    """A sum; what resolves a twist or a wrench along one basis is solved for at once."""
    plain: list[Any] = []
    twists: dict[tuple[int, int], tuple[ReciprocalBasis, list[Any]]] = {}
    products: list[tuple[Any, tuple[ReciprocalBasis, int, int]]] = []
    for term in expr.args:
        dual = of.bases.of(term.args[0]) if term.args else None
        coefficient = next(
            (f for f in sp.Mul.make_args(term) if getattr(f, "name", "") in of.bases.coefficients),
            None,
        )
        if isinstance(term, n.Dot) and dual is not None and dual[0].rows:
            basis, k = dual
            twists[id(basis), k] = (basis, [term.args[1], *[sp.S.Zero] * len(basis.rows)])
        elif coefficient is not None:
            products.append((term / coefficient, of.bases.coefficients[coefficient.name]))
        else:
            plain.append(term)
    wrenches: dict[tuple[int, int], tuple[ReciprocalBasis, list[Any]]] = {}
    for factor, (basis, k, i) in products:
        if (id(basis), k) in twists:
            twists[id(basis), k][1][1 + i] += factor
        else:
            zeros = [sp.S.Zero] * len(basis.duals)
            wrenches.setdefault((id(basis), i), (basis, zeros))[1][k] += factor
    parts = [of.scalar(term) for term in plain]
    for (_, k), (basis, (x, *coefficients)) in twists.items():
        parts.append(of.bases.resolve(basis, x, coefficients)[k])
    for (_, i), (basis, weights) in wrenches.items():
        parts.append(of.bases.wrench(basis, weights)[3 + i])
    return of.b.add(parts, hint, named=bool(hint))


def _product(of: Lowering, expr: Any, hint: str) -> Atom:
    divisor = divisor_of(expr)
    if divisor is not None:
        top = of.scalar(expr * divisor)
        return of.b.divide(top, of.scalar(divisor), hint)
    result: Atom = sp.S.One
    for k, factor in enumerate(expr.args):
        last = k == len(expr.args) - 1
        result = of.b.mul(result, of.scalar(factor), hint if last else "")
    return result


def _power(of: Lowering, base: Any, exponent: Any, hint: str) -> Atom:
    value = of.scalar(base)
    if exponent == -1:
        return of.b.inverse(value)
    if exponent == sp.Rational(1, 2):
        return sp.sqrt(value) if value.is_Number else of.b.let(sp.sqrt(value), hint)
    if exponent == sp.Rational(-1, 2):
        return of.b.inverse(of.b.let(sp.sqrt(value)))
    if not exponent.is_Integer:
        raise TypeError(f"no power {exponent} in a program")
    result: Atom = value
    for _ in range(abs(int(exponent)) - 1):
        result = of.b.mul(result, value)
    return of.b.inverse(result) if exponent < 0 else result


def _dot(of: Lowering, expr: Any, hint: str) -> Atom:
    a, c = expr.args
    for dual, other in ((a, c), (c, a)):
        found = of.bases.of(dual)
        if found is not None:
            basis, k = found
            return of.bases.resolve(basis, other)[k]
    frames = sorted(of.frames_of(expr), key=lambda f: f not in _coordinates(of, expr))
    return of.trials.cheapest([partial(_dot_in, of, a, c, f, hint) for f in frames])


def _coordinates(of: Lowering, expr: Any) -> set[str]:
    """Frames along whose axes a factor of a scalar product lies: it is a component there."""
    given = (of.given[factor] for factor in expr.args if factor in of.given)
    return {g.frame for g in given if all(c.is_Integer for c in g.components)}


def _dot_in(of: Lowering, a: Any, c: Any, frame: str, hint: str) -> Atom:
    u, v = of.vector(a, frame), of.vector(c, frame)
    return of.b.dot(u, v, hint, named=True)


def divisor_of(expr: Any) -> Any | None:
    """The symbol or scalar by which an expression divides, if it is a single one."""
    factors = expr.args if expr.is_Mul else (expr,)
    divisors = [f.base for f in factors if f.is_Pow and f.exp == -1]
    return divisors[0] if len(divisors) == 1 else None
