"""Scalar expressions as text: what is printed has the value of what was given."""

from __future__ import annotations

import random
from math import atan2, cos, isfinite, sin, sqrt
from typing import Any

import pytest
import sympy as sp

from pne_sym.backends.scalar import PYTHON, ScalarPrinter

SYMBOLS = sp.symbols("a b c d", real=True)
VALUES = dict(zip(SYMBOLS, (1.7, 2.3, 0.6, 3.1), strict=True))
A, B, C, D = SYMBOLS
HARD = (
    A / B**2,
    A / (B**2 * C),
    A / (B + C),
    1 / B**2,
    1 / (B + C) ** 2,
    A / (B + C) ** 2,
    A * B / (C * D**2),
    A / sp.sqrt(B),
    1 / sp.sqrt(B + C),
    (A + B) ** 2 * C,
    C / (A + B) ** 3,
    A - (B + C) ** 2,
    A - B**2 / (C - D) ** 2,
    -A / B - C,
    -(A**2) + B,
    -A * (B - C),
    -sp.Integer(2) * A / (3 * B),
    sp.Mul(-1, A + B, evaluate=False),
    sp.Mul(-1, sp.Add(A, -B, evaluate=False), C, evaluate=False),
    sp.Mul(-1, A - B, evaluate=False) + C,
    sp.Rational(2, 3) * (A + B),
    sp.Min(A, B, C),
    sp.Min(D, A * B, C),
    sp.Abs(A - B) * C,
    sp.atan2(A - B, C) / 2,
    sp.sin(A + B) ** 2 / sp.cos(A),
)


def value(expr: Any) -> float:
    """What the expression stands for."""
    return float(expr.subs(VALUES).evalf())


def printed(expr: Any) -> float:
    """What the text of it gives, in Python."""
    scope = {s.name: v for s, v in VALUES.items()}
    functions = {"sqrt": sqrt, "sin": sin, "cos": cos, "atan2": atan2, "abs": abs, "least": least}
    return float(eval(ScalarPrinter(PYTHON).doprint(expr), {**functions, **scope}))


def least(x: float, y: float) -> float:
    return min(y, x)


@pytest.mark.parametrize("expr", HARD, ids=str)
def test_what_needs_parentheses(expr: Any) -> None:
    assert printed(expr) == pytest.approx(value(expr), rel=1e-14)


def drawn(rng: random.Random, depth: int) -> Any:
    """A random expression of what programs are made of."""
    if not depth or rng.random() < 0.2:
        return rng.choice(SYMBOLS)
    first, second = drawn(rng, depth - 1), drawn(rng, depth - 1)
    return rng.choice(
        (
            lambda: first + second,
            lambda: first - second,
            lambda: first * second,
            lambda: first / second,
            lambda: first**2,
            lambda: 1 / first**2,
            lambda: -first,
            lambda: sp.Rational(rng.randint(-5, 5), 3) * first,
            lambda: sp.sqrt(second**2 + 1),
            lambda: second / sp.sqrt(first**2 + 1),
        )
    )()


@pytest.mark.parametrize("seed", range(40))
def test_random_expressions(seed: int) -> None:
    expr = drawn(random.Random(seed), 5)
    wanted = value(expr)
    if not isfinite(wanted):
        return
    assert printed(expr) == pytest.approx(wanted, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("expr", [sp.tan(A), A**B, A ** sp.Rational(1, 3)], ids=str)
def test_what_is_outside_the_closed_set_is_refused(expr: Any) -> None:
    with pytest.raises(TypeError, match="in generated code"):
        ScalarPrinter(PYTHON).doprint(expr)
