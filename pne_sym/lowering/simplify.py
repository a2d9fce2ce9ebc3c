"""Statements that only one other statement uses are written where they are used."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import Any

import sympy as sp

from pne_sym.lowering.algebra import operations, symbols
from pne_sym.lowering.builder import Statement
from pne_sym.program.ir import Stage, Store

_LONGEST = 14  # operations in one statement: beyond it lines get hard to read


def inline_single_use(
    statements: list[Statement],
    stores: list[tuple[Stage, Store]],
    guards: list[Any],
) -> list[Statement]:
    """Put unnamed values that are used once into the statement that uses them."""
    uses: dict[Any, int] = {}
    for statement in statements:
        for symbol in symbols(statement.expr):
            uses[symbol] = uses.get(symbol, 0) + _occurrences(statement.expr, symbol)
    for _, store in stores:
        for symbol in sp.sympify(store.value).free_symbols:
            uses[symbol] = uses.get(symbol, 0) + 2  # outputs keep their names
    for guard in guards:
        for symbol in (*guard.value.free_symbols, *guard.scale.free_symbols):
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
        kept.append(
            Statement(
                statement.target,
                expr,
                statement.stage,
                statement.equation,
                statement.total_of,
                statement.is_named,
                statement.hint,
            )
        )
    return _needed(kept, stores, guards)


def _needed(
    statements: list[Statement], stores: list[tuple[Stage, Store]], guards: list[Any]
) -> list[Statement]:
    """The statements that are still used: terms may cancel where a value is put in place."""
    wanted = {s for _, store in stores for s in sp.sympify(store.value).free_symbols}
    wanted |= {s for g in guards for s in (*g.value.free_symbols, *g.scale.free_symbols)}
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
        names[statement.target] = sp.Symbol(name, real=True)
    return names


def renamed(
    names: dict[Any, Any],
    statements: list[Statement],
    stores: list[tuple[Stage, Store]],
    guards: list[Any],
) -> tuple[list[Statement], list[tuple[Stage, Store]], list[Any]]:
    """Statements, stores and guards with other names."""

    def again(expr: Any) -> Any:
        return sp.sympify(expr).xreplace(names)

    return (
        [replace(s, target=names.get(s.target, s.target), expr=again(s.expr)) for s in statements],
        [(stage, replace(store, value=again(store.value))) for stage, store in stores],
        [replace(g, value=again(g.value), scale=again(g.scale)) for g in guards],
    )


@lru_cache(1 << 16)
def _occurrences(expr: Any, symbol: Any) -> int:
    if expr == symbol:
        return 1
    return sum(_occurrences(arg, symbol) for arg in expr.args)


@lru_cache(1 << 16)  # functions share statements
def _fits(user: Any, target: Any, expr: Any) -> bool:
    """Whether SymPy keeps the operation count when the value is put in place."""
    combined = _replaced(user, frozenset({(target, expr)}))
    if combined.has(sp.Abs):  # what SymPy makes of the root of a square; programs have no such node
        return False
    if any(abs(p.exp) != sp.Rational(1, 2) for p in combined.atoms(sp.Pow) if not p.exp.is_Integer):
        return False
    if any(p.exp.is_Integer and p.exp > 1 and not p.base.is_Symbol for p in combined.atoms(sp.Pow)):
        return False  # a power is printed as a product: its base would be computed again
    return operations(combined) <= operations(user) + operations(expr) <= 2 * _LONGEST


def _substitute(expr: Any, inlined: dict[Any, Any]) -> Any:
    found = frozenset((s, inlined[s]) for s in symbols(expr) if s in inlined)
    return _replaced(expr, found) if found else expr


@lru_cache(1 << 16)
def _replaced(expr: Any, pairs: frozenset[tuple[Any, Any]]) -> Any:
    return expr.xreplace(dict(pairs))
