"""Sums of symbols with rational factors, put together as SymPy does it: same terms, same order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import sympy as sp
from sympy.core.basic import ordering_of_classes

_ONE, _ZERO = sp.S.One, sp.S.Zero
_RANKS = {name: k for k, name in enumerate(ordering_of_classes)}


@dataclass(frozen=True, eq=False, slots=True)
class Linear:
    """number + sum of factor times symbol; the factors are no zeros."""

    factors: Mapping[Any, Any]
    number: Any = _ZERO


@lru_cache(1 << 16)
def linear(expr: Any) -> Linear | None:
    """The form of an expression; None if it has not this form."""
    if expr.is_Symbol:
        return Linear({expr: _ONE})
    if expr.is_Number:
        return Linear({}, expr) if expr.is_Rational else None
    if expr.is_Mul:
        factor, *of = expr.args
        is_one = len(of) == 1 and of[0].is_Symbol and factor.is_Rational
        return Linear({of[0]: factor}) if is_one else None
    if not expr.is_Add:
        return None
    forms = [linear(term) for term in expr.args]
    return None if any(form is None for form in forms) else _merged([f for f in forms if f])


def _merged(forms: list[Linear]) -> Linear:
    factors: dict[Any, Any] = {}
    number = _ZERO
    for form in forms:
        number = number if form.number is _ZERO else number + form.number
        for symbol, factor in form.factors.items():
            factors[symbol] = factors[symbol] + factor if symbol in factors else factor
    return Linear({s: f for s, f in factors.items() if f is not _ZERO}, number)


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


def multiple(factor: Any, symbol: Any) -> Any:
    """A symbol with a rational factor."""
    if factor is _ONE or factor is _ZERO:
        return symbol if factor is _ONE else _ZERO
    return sp.Mul._from_args((factor, symbol), is_commutative=True)


@lru_cache(1 << 16)
def place(expr: Any) -> tuple[Any, ...]:
    """What SymPy orders terms and factors by: see its `Basic.compare`."""
    name = type(expr).__name__
    rank = _RANKS.get(name, len(_RANKS))
    content = tuple(map(place, expr.args)) if expr.args else expr._hashable_content()
    return rank, "" if rank < len(_RANKS) else name, len(content), content


def is_negative(form: Linear) -> bool:
    """Whether SymPy takes a minus sign out: by most terms, else by the term whose name is first."""
    signs = [f.p for f in form.factors.values()] + [form.number.p] * (form.number is not _ZERO)
    left = sum(1 if p > 0 else -1 for p in signs)
    if left or not form.factors:
        return left < 0
    first = min(form.factors, key=lambda symbol: symbol.name)
    return bool(form.factors[first].p < 0)
