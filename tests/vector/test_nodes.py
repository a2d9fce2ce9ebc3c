"""Nodes are built simplified, and mean the same before and after."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
import sympy as sp

from pne_sym.vector import (
    Apply,
    Axial,
    Compose,
    Cross,
    Dot,
    Identity,
    LegSum,
    Outer,
    Skew,
    TensorAdd,
    TensorScale,
    TensorSymbol,
    Trace,
    Transpose,
    VectorAdd,
    VectorLegSum,
    VectorScale,
    VectorSymbol,
    ZeroTensor,
    ZeroVector,
    norm,
    sum_over_legs,
    tensor_sum,
    vector_sum,
)
from pne_sym.vector.evaluate import evaluate, skew
from tests.vector.expressions import Maker, random_values, real

A, B, C = (VectorSymbol(name) for name in "abc")
T, V = TensorSymbol("T"), TensorSymbol("V")
J = TensorSymbol("J", True)
K, M = real("k"), real("m")

SIMPLIFIED: list[tuple[Any, Any]] = [
    (A + ZeroVector, A),
    (ZeroVector + ZeroVector, ZeroVector),
    (A + B - ZeroVector, VectorAdd(A, B)),
    ((A + B) + C, VectorAdd(A, B, C)),
    (A - (B + C), VectorAdd(A, -B, -C)),
    (-(A + B), VectorAdd(-A, -B)),
    (-1 * -A, A),
    (0 * A, ZeroVector),
    (1 * A, A),
    (K * (M * A), VectorScale(K * M, A)),
    (K * A / K, A),
    (A / 2, VectorScale(sp.Rational(1, 2), A)),
    (Cross(A, A), ZeroVector),
    (Cross(K * A, A), ZeroVector),
    (Cross(A, ZeroVector), ZeroVector),
    (Cross(K * A, M * B), K * M * Cross(A, B)),
    (Cross(-A, -B), Cross(A, B)),
    (Dot(A, ZeroVector), sp.S.Zero),
    (Dot(K * A, M * B), K * M * Dot(A, B)),
    (Skew(ZeroVector), ZeroTensor),
    (Skew(K * A), K * Skew(A)),
    (Outer(K * A, M * B), K * M * Outer(A, B)),
    (Outer(A, ZeroVector), ZeroTensor),
    (Transpose(Transpose(T)), T),
    (Transpose(K * Transpose(T)), K * T),
    (Transpose(J), J),
    (Transpose(Identity), Identity),
    (Transpose(Skew(A)), -Skew(A)),
    (Transpose(Outer(A, B)), Outer(B, A)),
    (Transpose(ZeroTensor), ZeroTensor),
    (Identity @ A, A),
    ((K * Identity) @ A, K * A),
    (ZeroTensor @ A, ZeroVector),
    (T @ ZeroVector, ZeroVector),
    ((K * T) @ (M * A), K * M * Apply(T, A)),
    (Identity @ T, T),
    (T @ Identity, T),
    ((K * Identity) @ (M * T), K * M * T),
    ((K * T) @ (M * Identity), K * M * T),
    (T @ ZeroTensor, ZeroTensor),
    ((K * T) @ V, K * Compose(T, V)),
    (T + ZeroTensor, T),
    (-(T + V), TensorAdd(-T, -V)),
    (-1 * -T, T),
    (T / 2, TensorScale(sp.Rational(1, 2), T)),
    (vector_sum([]), ZeroVector),
    (tensor_sum([ZeroTensor]), ZeroTensor),
    (sum_over_legs(ZeroVector, "ups"), ZeroVector),
    (sum_over_legs(ZeroTensor, "ups"), ZeroTensor),
    (sum_over_legs(0, "ups"), sp.S.Zero),
    (norm(K * A) ** 2, K**2 * Dot(A, A)),
]


@pytest.mark.parametrize(("built", "expected"), SIMPLIFIED, ids=str)
def test_built_simplified(built: Any, expected: Any) -> None:
    assert built == expected
    assert hash(built) == hash(expected)


def test_equal_names_of_other_kinds_are_other_symbols() -> None:
    assert VectorSymbol("a") == A
    assert len({VectorSymbol("a"), TensorSymbol("a"), real("a")}) == 3
    assert TensorSymbol("J") != J


def test_the_order_of_factors_is_kept() -> None:
    assert Cross(A, B) != Cross(B, A)
    assert Outer(A, B) != Outer(B, A)
    assert Compose(T, V) != Compose(V, T)


def test_a_square_of_a_skew_tensor_stays_a_product_of_tensors() -> None:
    square = Skew(A) @ Skew(A)
    assert isinstance(square, Compose)
    values = random_values(np.random.default_rng(1))
    assert np.allclose(evaluate(square, values), skew(values["a"]) @ skew(values["a"]))


def test_scalars_of_vectors_have_no_derivative() -> None:
    with pytest.raises(TypeError, match="no derivative"):
        Dot(A, K * B + C).diff(K)


def test_plain_text_and_pickle() -> None:
    expr = K * Cross(A, B) + T @ C
    assert str(expr) == "VectorAdd(VectorScale(k, Cross(a, b)), Apply(T, c))"
    assert pickle.loads(pickle.dumps(expr)) == expr
    assert pickle.loads(pickle.dumps(J)).is_symmetric


def test_sums_over_legs() -> None:
    assert isinstance(sum_over_legs(A, "ups"), VectorLegSum)
    assert isinstance(sum_over_legs(K, "ups"), LegSum)
    assert sum_over_legs(K, "ups") != sum_over_legs(K, "rpr")
    with pytest.raises(TypeError, match="no numeric meaning"):
        evaluate(sum_over_legs(K, "ups"), {"k": 1.0})


class Numbers:
    """The algebra by numpy alone: what the nodes must mean."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.values = random_values(rng)

    def __getitem__(self, name: str) -> Any:
        return self.values[name]


def test_every_node_has_its_meaning() -> None:
    v = Numbers(np.random.default_rng(2))
    a, b, c, t, j = v["a"], v["b"], v["c"], v["T"], v["J"]
    k = v["k"]
    cases: list[tuple[Any, Any]] = [
        (A + B - C, a + b - c),
        (K * A, k * a),
        (
            Cross(A, B),
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]],
        ),
        (Skew(A) @ B, np.cross(a, b)),
        (Dot(A, B), sum(a * b)),
        (Outer(A, B) @ C, a * (b @ c)),
        (T @ A, [row @ a for row in t]),
        (Transpose(T) @ A, [column @ a for column in t.T]),
        (J @ T, j @ t),
        (K * T - J, k * t - j),
        (norm(A), np.sqrt(a @ a)),
        (sp.atan2(K, M), np.arctan2(k, v["m"])),
        (sp.acos(K / 4), np.arccos(k / 4)),
    ]
    for expr, expected in cases:
        assert np.allclose(evaluate(expr, v.values), expected, rtol=1e-14, atol=1e-15), expr


def test_axial_is_the_moment_of_a_mass_distribution() -> None:
    """For T = sum of m (B r) r^T it is the sum of m r x (B r)."""
    rng = np.random.default_rng(3)
    b = rng.normal(size=(3, 3))
    masses, places = rng.uniform(size=5), rng.normal(size=(5, 3))
    second = sum(m * np.outer(r, r) for m, r in zip(masses, places, strict=True))
    moment = sum(m * np.cross(r, b @ r) for m, r in zip(masses, places, strict=True))
    found = evaluate(Axial(T @ J), {"T": b, "J": second})
    assert np.allclose(found, moment, rtol=1e-13)


def test_simplification_keeps_the_value() -> None:
    """Random trees against the same trees built without any simplification."""
    rng = np.random.default_rng(4)
    maker = Maker(rng)
    for _ in range(150):
        values = random_values(rng)
        u, v, t, s = maker.vector(2), maker.vector(2), maker.tensor(2), maker.scalar(2)
        nu, nv, nt, ns = (evaluate(e, values) for e in (u, v, t, s))
        pairs = [
            (u + v, nu + nv),
            (u - v, nu - nv),
            (-u, -nu),
            (s * u, ns * nu),
            (u / values["k"], nu / values["k"]),
            (t @ u, nt @ nu),
            (t @ t, nt @ nt),
            (Transpose(t), nt.T),
            (Outer(u, v), np.outer(nu, nv)),
            (Dot(u, v), nu @ nv),
            (Trace(t), np.trace(nt)),
            (s * t - t, ns * nt - nt),
        ]
        pairs += [
            (Cross(u, v), np.cross(nu, nv)),
            (Skew(u), skew(nu)),
            (Axial(t), [nt[2, 1] - nt[1, 2], nt[0, 2] - nt[2, 0], nt[1, 0] - nt[0, 1]]),
        ]
        for expr, expected in pairs:
            scale = max(1.0, float(np.max(np.abs(expected))))
            assert np.allclose(evaluate(expr, values), expected, rtol=0, atol=1e-11 * scale), expr
