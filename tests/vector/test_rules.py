"""Rules I and II as objects: statement, coefficient, recorded application."""

from __future__ import annotations

import numpy as np
import sympy as sp

from pne_sym.vector import (
    RULE_I,
    RULE_II,
    Cross,
    Dot,
    Outer,
    RuleI,
    RuleII,
    Skew,
    VectorSymbol,
)
from pne_sym.vector.evaluate import evaluate
from pne_sym.vector.rules import apply_rule_i, apply_rule_ii
from tests.vector.expressions import random_values

A, B, X = (VectorSymbol(name) for name in "abx")
VALUES = random_values(np.random.default_rng(5))


def test_rule_i() -> None:
    assert RuleI() == RULE_I
    assert RULE_I.name == "Rule I"
    assert RULE_I.coefficient(A, B) == Outer(B, A)
    coefficient, step = apply_rule_i(A, X, B)
    a, b, x = (VALUES[name] for name in "abx")
    assert np.allclose(evaluate(coefficient, VALUES) @ x, (a @ x) * b, rtol=1e-14)
    assert step.rule is RULE_I
    assert step.before == Dot(A, X) * B
    assert np.allclose(evaluate(step.before, VALUES), evaluate(step.after, VALUES), rtol=1e-14)


def test_rule_ii() -> None:
    assert RuleII() == RULE_II
    assert RULE_II.coefficient(A) == Skew(A)
    coefficient, step = apply_rule_ii(A, X, sp.Integer(-2))
    a, x = VALUES["a"], VALUES["x"]
    assert np.allclose(evaluate(coefficient, VALUES) @ x, -2 * np.cross(a, x), rtol=1e-14)
    assert step.before == -2 * Cross(A, X)
    assert np.allclose(evaluate(step.before, VALUES), evaluate(step.after, VALUES), rtol=1e-14)


def test_statements_are_mathematics() -> None:
    for rule in (RULE_I, RULE_II):
        assert "=" in rule.statement
        assert rule.statement.count("{") == rule.statement.count("}")
