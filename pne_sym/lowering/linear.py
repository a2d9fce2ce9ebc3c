"""Sums of terms with rational factors, put together as SymPy does it: same terms, same order."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import sympy as sp
from sympy.core.basic import ordering_of_classes

_ONE, _ZERO = sp.S.One, sp.S.Zero
_RANKS = {name: k for k, name in enumerate(ordering_of_classes)}


class Linear(NamedTuple):
    """number + sum of factor times term; no factor is zero, no term is a sum or has a factor."""

    factors: dict[Any, Any]
    number: Any = _ZERO


@lru_cache(1 << 16)
def linear(expr: Any) -> Linear | None:
    """The form of an expression; None if SymPy has more to do than to collect terms."""
    if expr.is_Symbol:
        return Linear({expr: _ONE})
    if expr.is_Number:
        return Linear({}, expr) if expr.is_Rational else None
    if expr.is_Mul:
        return _product(expr)
    if not expr.is_Add:
        is_more = not expr.args or (expr.is_Pow and expr.base.is_Number)
        return None if is_more else Linear({expr: _ONE})
    forms = [linear(term) for term in expr.args]
    return None if any(form is None for form in forms) else _merged([f for f in forms if f])


def _product(expr: Any) -> Linear | None:
    factor, *others = expr.args
    if not factor.is_Number:
        return Linear({expr: _ONE})
    if not factor.is_Rational or (len(others) == 1 and others[0].is_Add):
        return None
    return Linear({sp.Mul._from_args(others, is_commutative=True): factor})


def _merged(forms: list[Linear]) -> Linear:
    factors: dict[Any, Any] = {}
    number = _ZERO
    for form in forms:
        number = number if form.number is _ZERO else number + form.number
        joint = factors | form.factors
        if len(joint) < len(factors) + len(form.factors):
            for symbol in factors.keys() & form.factors.keys():
                joint[symbol] = factors[symbol] + form.factors[symbol]
        factors = joint
    if any(factor is _ZERO for factor in factors.values()):
        factors = {s: f for s, f in factors.items() if f is not _ZERO}
    return Linear(factors, number)


def scaled(form: Linear, by: int) -> Linear:
    """The form times a number other than zero."""
    return Linear({s: by * f for s, f in form.factors.items()}, by * form.number)


def sum_of(*forms: Linear) -> Any:
    """The expression of a sum of forms."""
    form = forms[0] if len(forms) == 1 else _merged(list(forms))
    terms = sorted((multiple(f, s) for s, f in form.factors.items()), key=place)
    if form.number is not _ZERO:
        terms.insert(0, form.number)
    return sp.Add._from_args(terms, is_commutative=True)


def multiple(factor: Any, term: Any) -> Any:
    """A term with a rational factor."""
    if factor is _ONE or factor is _ZERO:
        return term if factor is _ONE else _ZERO
    others = term.args if term.is_Mul else (term,)
    return sp.Mul._from_args((factor, *others), is_commutative=True)


@lru_cache(1 << 16)
def place(expr: Any) -> tuple[Any, ...]:
    """What SymPy orders terms and factors by: see its `Basic.compare`."""
    name = type(expr).__name__
    rank = _RANKS.get(name, len(_RANKS))
    content = tuple(map(place, expr.args)) if expr.args else expr._hashable_content()
    return rank, "" if rank < len(_RANKS) else name, len(content), content


def is_negative(form: Linear) -> bool | None:
    """Whether SymPy takes a minus sign out: by most terms, else by the symbol whose name is first.

    None if it goes by more than names.
    """
    signs = [f.p for f in form.factors.values()] + [form.number.p] * (form.number is not _ZERO)
    left = sum(1 if p > 0 else -1 for p in signs)
    if left or not form.factors:
        return left < 0
    if not all(term.is_Symbol for term in form.factors):
        return None
    first = min(form.factors, key=lambda symbol: symbol.name)
    return bool(form.factors[first].p < 0)
