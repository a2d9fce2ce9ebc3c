"""Statements that only one other statement uses are written where they are used."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from typing import Any

import sympy as sp

from pne_sym.lowering.algebra import operations, replaced, symbols
from pne_sym.lowering.algebra import symbol as as_symbol
from pne_sym.lowering.statements import End, Statement, read_by

_LONGEST = 14  # operations in one statement: beyond it lines get hard to read


def inline_single_use(statements: list[Statement], ends: Sequence[End]) -> list[Statement]:
    """Put unnamed values that are used once into the statement that uses them."""
    uses: dict[Any, int] = {}
    for statement in statements:
        for symbol, times in _occurrences(statement.expr).items():
            uses[symbol] = uses.get(symbol, 0) + times
    for symbol in read_by(ends):  # outputs, and what guards need, keep their names
        uses[symbol] = uses.get(symbol, 0) + 2
    inlined: dict[Any, Any] = {}
    kept: list[Statement] = []
    users = {symbol: s for s in statements for symbol in symbols(s.expr)}
    for statement in statements:
        expr = _substitute(statement.expr, inlined)
        user = users.get(statement.target)
        if (
            uses.get(statement.target) == 1
            and not statement.total_of
            and not statement.is_named
            and user is not None
            and user.stage == statement.stage
            and not user.total_of
            and operations(expr) <= _LONGEST
            and _fits(user.expr, statement.target, expr)
        ):
            inlined[statement.target] = expr
            continue
        kept.append(statement if expr is statement.expr else statement._replace(expr=expr))
    return still_used(kept, ends)


def still_used(statements: list[Statement], ends: Iterable[End]) -> list[Statement]:
    """The statements that are still used: terms may cancel where a value is put in place."""
    wanted = read_by(ends)
    found: list[Statement] = []
    for statement in reversed(statements):
        if statement.target in wanted:
            found.append(statement)
            wanted |= symbols(statement.expr)
    return found[::-1]


def numbered(
    statements: list[Statement],
    reserved: set[str],
    stem: Callable[[Statement, dict[Any, Any]], str],
) -> dict[Any, Any]:
    """Symbols whose names do not depend on other functions: equal stems numbered from one.

    Args:
        statements: whose targets are to be named.
        reserved: names that are taken.
        stem: of the name of a statement's target, given the names of those before.
    """
    taken = set(reserved)
    names: dict[Any, Any] = {}
    issued: dict[str, int] = {}
    for statement in statements:
        of = stem(statement, names)
        k = issued.get(of, 0) + 1
        while (name := of if k == 1 else f"{of}_{k}") in taken:
            k += 1
        issued[of] = k
        taken.add(name)
        names[statement.target] = as_symbol(name)
    return names


def renamed(names: dict[Any, Any], statements: Iterable[Statement]) -> list[Statement]:
    """Statements with other names."""
    return [
        s._replace(target=names.get(s.target, s.target), expr=replaced(s.expr, names))
        for s in statements
    ]


@lru_cache(1 << 16)
def _occurrences(expr: Any) -> dict[Any, int]:
    """How often each symbol stands in it."""
    if expr.is_Symbol:
        return {expr: 1}
    found: dict[Any, int] = {}
    for arg in expr.args:
        for symbol, times in _occurrences(arg).items():
            found[symbol] = found.get(symbol, 0) + times
    return found


@lru_cache(1 << 16)  # functions share statements
def _fits(user: Any, target: Any, expr: Any) -> bool:
    """Whether SymPy keeps the operation count when the value is put in place."""
    combined = _replaced(user, frozenset({(target, expr)}))
    return operations(combined) <= operations(user) + operations(
        expr
    ) <= 2 * _LONGEST and _is_in_programs(combined)


@lru_cache(1 << 16)
def _is_in_programs(expr: Any) -> bool:
    """Whether it is made of what programs have, and is printed without computing a part twice."""
    if expr.is_Pow:
        whole = expr.exp.is_Integer
        if (whole and expr.exp > 1 and not expr.base.is_Symbol) or (
            not whole and abs(expr.exp) != sp.Rational(1, 2)
        ):
            return False  # a power is printed as a product: its base would be computed again
    elif isinstance(expr, sp.Abs):
        return False  # what SymPy makes of the root of a square
    return all(map(_is_in_programs, expr.args))


def _substitute(expr: Any, inlined: dict[Any, Any]) -> Any:
    found = frozenset((s, inlined[s]) for s in symbols(expr) if s in inlined)
    return _replaced(expr, found) if found else expr


@lru_cache(1 << 16)
def _replaced(expr: Any, pairs: frozenset[tuple[Any, Any]]) -> Any:
    return replaced(expr, dict(pairs))
