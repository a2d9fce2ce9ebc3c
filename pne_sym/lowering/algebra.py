"""What SymPy makes of expressions, kept: trials build the same ones again and again.

Nearly all are products of two symbols and sums of symbols with factors. These are put together
here, as SymPy would and in its order of terms, which takes a tenth of the time (`linear`).
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import sympy as sp

from pne_sym.lowering.linear import is_negative, linear, multiple, place, scaled, sum_of
from pne_sym.program.ir import Stage

_KEPT = 1 << 16  # more than the statements of any model


@lru_cache(_KEPT)
def symbol(name: str) -> Any:
    """A real symbol."""
    return sp.Symbol(name, real=True)


@lru_cache(_KEPT)
def joined(stages: frozenset[Stage]) -> Stage:
    """The stage of what is made of values of these stages."""
    return Stage.join(stages)


@lru_cache(_KEPT)
def product(a: Any, b: Any) -> Any:
    """a b."""
    if a.is_Symbol and b.is_Symbol and a.name != b.name:
        return sp.Mul._from_args((a, b) if a.name < b.name else (b, a), is_commutative=True)
    for number, other in ((a, b), (b, a)):
        form = linear(other)
        if number.is_Rational and form is not None and len(form.factors) == 1 and not form.number:
            ((of, factor),) = form.factors.items()
            return multiple(factor * number, of)
    return a * b


@lru_cache(_KEPT)
def quotient(a: Any, b: Any) -> Any:
    """a / b."""
    return a / b


@lru_cache(_KEPT)
def inverse(a: Any) -> Any:
    """1 / a."""
    return sp.Pow(a, sp.S.NegativeOne, evaluate=False) if a.is_Symbol else 1 / a


@lru_cache(_KEPT)
def negative(a: Any) -> Any:
    """-a."""
    form = linear(a)
    return -a if form is None else sum_of(scaled(form, -1))


@lru_cache(_KEPT)
def total(*terms: Any) -> Any:
    """The sum."""
    forms = [linear(term) for term in terms]
    if any(form is None for form in forms):
        return sp.Add(*terms)
    return sum_of(*(form for form in forms if form is not None))


def replaced(expr: Any, changes: Mapping[Any, Any]) -> Any:
    """The expression with others in place of symbols."""
    if expr.is_Symbol:
        return changes.get(expr, expr)
    if changes.keys().isdisjoint(symbols(expr)):  # goes through the shorter
        return expr
    args = [replaced(arg, changes) for arg in expr.args]
    if expr.is_Add:
        return total(*args)
    if expr.is_Mul:
        return _product_of(tuple(args))
    if isinstance(expr, sp.Min):  # SymPy would try which is the least
        return sp.Min(*args, evaluate=False)
    return expr.func(*args)


@lru_cache(_KEPT)
def _product_of(factors: tuple[Any, ...]) -> Any:
    """The product; of different symbols and sums, with a number, put together here."""
    parts = [part for f in factors for part in (f.args if f.is_Mul else (f,))]
    number = sp.Mul(*(part for part in parts if part.is_Number))
    rest = [part for part in parts if not part.is_Number]
    plain = all(part.is_Symbol or part.is_Add for part in rest) and len(set(rest)) == len(rest)
    if not plain or not number.is_Rational or len(rest) < 2 or number.is_zero:
        return sp.Mul(*factors)
    rest.sort(key=place)
    return sp.Mul._from_args(rest if number is sp.S.One else [number, *rest], is_commutative=True)


@lru_cache(_KEPT)
def signed(expr: Any) -> tuple[int, Any]:
    """A sign, and the expression without it: both of x - y and y - x give the same one."""
    form = linear(expr)
    minus = None if form is None else is_negative(form)
    if minus is None:
        minus = expr.could_extract_minus_sign()
    return (-1, negative(expr)) if minus else (1, expr)


@lru_cache(_KEPT)
def symbols(expr: Any) -> frozenset[Any]:
    """The symbols in it."""
    return frozenset((expr,)) if expr.is_Symbol else frozenset().union(*map(symbols, expr.args))


@lru_cache(_KEPT)
def opened(whole: Any, inner: tuple[Any, ...]) -> Any:
    """A sum with sums in place of some of its terms, where terms then cancel.

    Args:
        whole: the sum.
        inner: for each of its terms in order a sum that is equal to it, or None.
    """
    found = whole
    for term, expr in zip(whole.args, inner, strict=True):
        if expr is not None:
            found = total(found, negative(term), expr)
    best: Any = whole
    for term, expr in zip(whole.args, inner, strict=True):
        if expr is not None:
            one = total(whole, negative(term), expr)
            if terms_of(one) < terms_of(best):
                best = one
    return found if terms_of(found) < terms_of(best) else best


@lru_cache(_KEPT)
def terms_of(expr: Any) -> int:
    """Number of terms of a sum, each numeric factor other than a sign counted too."""
    terms = sp.Add.make_args(expr)
    return len(terms) + sum(abs(t.as_coeff_Mul()[0]) != 1 for t in terms) if expr != 0 else 0


@lru_cache(_KEPT)
def operations(expr: Any) -> int:
    """Additions, multiplications, divisions, roots and trigonometric calls of an expression."""
    if expr.is_Symbol or expr.is_Number:
        return 0
    inner = sum(map(operations, expr.args))
    if expr.is_Add:
        return inner + len(expr.args) - 1
    if expr.is_Mul:
        first = expr.args[0]
        is_sign = first is sp.S.One or first is sp.S.NegativeOne
        return inner + len(expr.args) - 1 - is_sign
    if expr.is_Pow:
        exponent = expr.exp
        if exponent.is_Integer and exponent > 0:
            return inner + int(exponent) - 1
        if exponent == sp.Rational(-1, 2):
            return inner + 2
        return inner + 1
    return inner + 1
