"""Expressions as plain text."""

from __future__ import annotations

import pytest
import sympy as sp

from pne_sym.review.plain import plain
from pne_sym.vector import (
    Cross,
    Dot,
    Identity,
    Outer,
    Skew,
    TensorSymbol,
    Transpose,
    VectorSymbol,
    ZeroVector,
    norm,
    sum_over_legs,
)
from tests.models import bundle, catalogue

a, b, c = (VectorSymbol(name) for name in "abc")
T = TensorSymbol("T")
x, y = sp.symbols("x y", real=True)


@pytest.mark.parametrize(
    ("expr", "text"),
    [
        (a + b - c, "a + b - c"),
        (-a - x * b, "-a - x * b"),
        (-(a + b) * x, "x * (-a - b)"),
        (Cross(a, Cross(b, c)), "a x (b x c)"),
        (Cross(Cross(a, b), c), "(a x b) x c"),
        (Cross(a, b + c), "a x (b + c)"),
        (-Cross(a, b), "-a x b"),
        (Dot(a, b) * c, "(a . b) * c"),
        (a / Dot(a, b), "1 / (a . b) * a"),
        (norm(a), "|a|"),
        (sp.sqrt(x + 1), "sqrt(1 + x)"),
        (x / y, "x / y"),
        (-x / (y + 1) ** 2, "-x / (1 + y)^2"),
        (x / 2, "x / 2"),
        (x * (y + 1), "x * (1 + y)"),
        (sp.atan2(-x, y), "atan2(-x, y)"),
        (T @ a, "T * a"),
        (Transpose(T) @ (T @ a), "T^T * (T * a)"),
        (Skew(a) @ Skew(b), "[a]x * [b]x"),
        (Outer(a, b + c), "a (b + c)^T"),
        (x * Identity - Outer(a, b), "x * E - a b^T"),
        (ZeroVector, "0"),
        (sum_over_legs(a - b, "ups"), "sum over ups of (a - b)"),
    ],
)
def test_formulas(expr: object, text: str) -> None:
    assert plain(expr) == text


@pytest.mark.parametrize("name", ["stewart", "planar_mixed", "tripod_3upu", "hybrid_3rrrs"])
def test_every_equation_prints_without_class_names(name: str) -> None:
    for equation in bundle(catalogue(name)).derivation.equations():
        for expr in (equation.rhs, *equation.forms):
            text = plain(expr)
            assert text.count("(") == text.count(")")
            assert not any(word in text for word in ("Vector", "Tensor", "Dot(", "Cross(", "Scale"))
