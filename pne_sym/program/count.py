"""Operation counts, from the program itself."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Any

import sympy as sp

from pne_sym.program.ir import Block, Counts, Function


@lru_cache(1 << 16)  # functions share statements, and several texts state the counts of each
def count_expression(expr: Any) -> Counts:
    """Operations of a scalar expression as it is printed (powers as products)."""
    if expr.is_Symbol or expr.is_Number:
        return Counts()
    total = _added(map(count_expression, expr.args))
    if expr.is_Add:
        return total + Counts(add=len(expr.args) - 1)
    if expr.is_Mul:
        return total + _product(expr)
    if expr.is_Pow:
        return total + _power(expr.exp)
    if isinstance(expr, sp.Abs):
        return total  # a sign
    if isinstance(expr, sp.Min):
        return total + Counts(add=len(expr.args) - 1)
    return total + Counts(trig=1)


def _added(counts: Iterable[Counts]) -> Counts:
    """The sum of many: whoever counts asks for it thousands of times."""
    rows = [(c.mul, c.add, c.div, c.sqrt, c.trig) for c in counts]
    return Counts(*map(sum, zip(*rows, strict=True)))


def _product(expr: Any) -> Counts:
    """A product; a factor 1/x is counted as the division that prints it."""
    factors = [a for a in expr.args if a not in (1, -1)]
    inverse = [a for a in factors if a.is_Pow and a.exp == -1]
    # n factors need n - 1 multiplications; those that only join a 1/x are that division already
    joined = len(inverse) if len(inverse) < len(factors) else len(inverse) - 1
    return Counts(mul=max(len(factors) - 1 - joined, 0))


def _power(exponent: Any) -> Counts:
    if exponent == sp.Rational(1, 2):
        return Counts(sqrt=1)
    if exponent == sp.Rational(-1, 2):
        return Counts(sqrt=1, div=1)
    if exponent.is_Integer:
        return Counts(mul=abs(int(exponent)) - 1, div=1 if exponent < 0 else 0)
    raise ValueError(f"a program has no power {exponent}")


def count_block(block: Block) -> Counts:
    """Operations of one pass of a block, its sums included."""
    return _added(count_expression(a.expr) for a in block.assignments) + Counts(add=len(block.sums))


def count_function(function: Function, legs: Mapping[str, int]) -> Counts:
    """Operations of a function; a leg loop counts once per leg."""
    blocks = (count_block(b).times(legs.get(b.leg_type, 1)) for b in function.blocks)
    return sum(blocks, Counts())
