"""What a builder's statements say, in numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import sympy as sp

from pne_sym.lowering.builder import Builder
from pne_sym.lowering.statements import Statement
from pne_sym.program.ir import Kind, Stage

STATE = Stage(Kind.STATE)


def inputs(b: Builder, values: Mapping[str, float]) -> dict[sp.Symbol, float]:
    """Declare values that come with the state."""
    return {b.declare(sp.Symbol(n, real=True), STATE): value for n, value in values.items()}


def run(statements: Iterable[Statement], given: Mapping[Any, float]) -> dict[Any, float]:
    """Values of all targets, computed one after another as a program would."""
    known = dict(given)
    for s in statements:
        known[s.target] = value(s.expr, known)
    return known


def value(expr: Any, known: Mapping[Any, float]) -> float:
    """Value of an atom or of a statement's expression."""
    expr = sp.sympify(expr)
    found = expr.xreplace({s: sp.Float(known[s]) for s in expr.free_symbols})
    return float(found) if found.is_finite else float("nan")
