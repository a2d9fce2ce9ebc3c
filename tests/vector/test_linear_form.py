"""linear_form: the expression is coefficient times unknown plus remainder, by recorded rules."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy as sp

from pne_sym.vector import (
    RULE_I,
    RULE_II,
    Apply,
    Cross,
    Dot,
    Identity,
    Outer,
    Skew,
    VectorSymbol,
    ZeroVector,
    linear_form,
    norm,
    sum_over_legs,
)
from pne_sym.vector.evaluate import evaluate
from pne_sym.vector.linear import NotLinearError
from tests.vector.expressions import KNOWN, UNKNOWNS, Maker, random_values, real, value_of_form

A, B, X, Y = (VectorSymbol(name) for name in "abxy")
S, R, K = real("s"), real("r"), real("k")


def size_of(expr: Any, values: dict[str, Any]) -> float:
    """A bound on the rounding of an expression: the same with all terms positive."""
    magnitudes = {name: np.abs(value) for name, value in values.items()}
    if not getattr(expr, "args", ()) or hasattr(expr, "name"):
        return float(np.max(np.abs(evaluate(expr, magnitudes))))
    parts = [size_of(arg, values) for arg in expr.args if hasattr(arg, "args")]
    if isinstance(expr, sp.Add) or type(expr).__name__.endswith("Add"):
        return sum(parts)
    return 6.0 * max(1.0, float(np.prod(parts))) if len(parts) > 1 else 2.0 + 2.0 * sum(parts)


@pytest.mark.parametrize("kind", ["linear_vector", "linear_scalar"])
@pytest.mark.parametrize("depth", [1, 2, 3, 4])
def test_postcondition(kind: str, depth: int) -> None:
    rng = np.random.default_rng([depth, len(kind)])
    maker = Maker(rng)
    rules = set()
    for _ in range(60):
        expr = getattr(maker, kind)(depth)
        form = linear_form(expr, UNKNOWNS, KNOWN)
        values = random_values(rng)
        expected = evaluate(expr, values)
        scale = max(1.0, float(np.max(np.abs(expected))), 1e-3 * size_of(expr, values))
        assert np.allclose(value_of_form(form, values), expected, rtol=0, atol=1e-12 * scale), expr
        for part in (*form.coefficients.values(), form.remainder):
            assert not _names(part) & {u.name for u in (*UNKNOWNS, *KNOWN)}
        for step in form.steps:
            rules.add(step.rule)
            before, after = evaluate(step.before, values), evaluate(step.after, values)
            scale = max(1.0, float(np.max(np.abs(before))), 1e-3 * size_of(step.before, values))
            assert np.allclose(before, after, rtol=0, atol=1e-12 * scale), step
    if depth > 1:
        assert RULE_II in rules
        assert RULE_I in rules or kind == "linear_scalar"


def _names(expr: Any) -> set[str]:
    if hasattr(expr, "name"):
        return {expr.name}
    return {name for arg in getattr(expr, "args", ()) for name in _names(arg)}


def test_the_paper_s_cases() -> None:
    """Rule I and Rule II as section 2.3 prints them."""
    one = linear_form(Dot(A, X) * B, [X])
    assert one.coefficients == {X: Outer(B, A)}
    assert one.remainder == ZeroVector
    assert [(s.rule, s.before, s.after) for s in one.steps] == [
        (RULE_I, Dot(A, X) * B, Apply(Outer(B, A), X))
    ]
    two = linear_form(Cross(A, X), [X])
    assert two.coefficients == {X: Skew(A)}
    assert [(s.rule, s.before, s.after) for s in two.steps] == [
        (RULE_II, Cross(A, X), Apply(Skew(A), X))
    ]
    turned = linear_form(Cross(X, A), [X])
    assert turned.coefficients == {X: -Skew(A)}


def test_without_unknowns_all_is_remainder() -> None:
    form = linear_form(Cross(A, B) + K * A, [X])
    assert (form.coefficients, form.remainder, form.steps) == ({}, Cross(A, B) + K * A, ())
    assert linear_form(X, [X]).coefficients == {X: Identity}
    assert linear_form(S, [S]).coefficients == {S: 1}
    assert linear_form(sp.Integer(3), [X]).remainder == 3


def test_scalar_unknowns() -> None:
    form = linear_form(S * A + K * S * B + Cross(B, S * A), [S])
    values = random_values(np.random.default_rng(0))
    expected = values["a"] + values["k"] * values["b"] + np.cross(values["b"], values["a"])
    assert np.allclose(evaluate(form.coefficients[S], values), expected, atol=1e-14)
    assert form.remainder == ZeroVector


@pytest.mark.parametrize(
    "expr",
    [
        Dot(X, X),
        Dot(X, Y),
        Cross(X, Y),
        S * X,
        S * R,
        S**2,
        1 / S,
        sp.sqrt(S),
        sp.sin(S),
        norm(X),
        X / norm(X),
        Dot(A, X) ** 2,
        K + 1 / Dot(A, X),
        Dot(A, X) * Dot(B, Y) * A,
        Apply(Outer(X, A), B),
        Skew(X) @ A,
        sum_over_legs(Dot(A, X), "ups"),
    ],
    ids=str,
)
def test_refused(expr: Any) -> None:
    """What is not linear, or not seen to be so, is refused, never answered wrongly."""
    with pytest.raises(NotLinearError):
        linear_form(expr, [X, Y, S, R])


def test_sums_over_legs() -> None:
    """An unknown that all legs share is collected leg by leg, and so are the rules used."""
    form = linear_form(A + sum_over_legs(S * B - Cross(A, X), "ups"), [X, S])
    assert form.coefficients == {
        X: sum_over_legs(-Skew(A), "ups"),
        S: sum_over_legs(B, "ups"),
    }
    assert form.remainder == A
    (step,) = form.steps
    assert step.rule is RULE_II
    assert step.before == sum_over_legs(Cross(A, X), "ups")
    assert step.after == sum_over_legs(Skew(A) @ X, "ups")


def test_known_names_are_not_unknowns_themselves() -> None:
    form = linear_form(VectorSymbol("z") + real("w") * A, UNKNOWNS, KNOWN)
    assert set(form.coefficients) == {X, Y, S, R}
