"""Statements: each value once, what cancels gone, what is tried forgotten."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import sympy as sp

from pne_sym.lowering.algebra import operations
from pne_sym.lowering.builder import Builder
from pne_sym.program.ir import Kind, Stage
from tests.lowering.numbers import inputs, run, value


def _grow(b: Builder, given: dict[Any, float], rng: np.random.Generator, steps: int) -> Any:
    """A random program: (atom, value computed beside it) of everything made."""
    made: list[tuple[Any, float]] = [*given.items(), (sp.S.Zero, 0.0), (sp.S.One, 1.0)]
    for _ in range(steps):
        (a, x), (c, y) = (made[k] for k in rng.integers(len(made), size=2))
        operation = rng.choice(["add", "mul", "divide", "inverse", "difference", "minus", "root"])
        if operation == "add":
            sign = 1 if rng.random() < 0.8 else -1
            made.append((b.add((a, c, sign * a)), x + y + sign * x))
        elif operation == "mul":
            made.append((b.mul(a, c), x * y))
        elif operation == "difference":
            made.append((b.difference(a, c), x - y))
        elif operation == "minus":
            made.append((-a, -x))
        elif operation == "root" and x > 0:
            root = sp.sqrt(a) if a.is_Number else b.let(sp.sqrt(a))
            made.append((root, math.sqrt(x)))
        elif operation == "inverse" and 0.05 < abs(x) < 50:
            made.append((b.inverse(a), 1 / x))
        elif operation == "divide" and 0.05 < abs(y) < 50:
            made.append((b.divide(a, c), x / y))
        if abs(made[-1][1]) > 50:
            made.pop()
    return made


@pytest.mark.parametrize("seed", range(40))
def test_every_value_is_what_was_asked_for(seed: int) -> None:
    rng = np.random.default_rng(seed)
    b = Builder()
    given = inputs(b, {f"x{i}": float(x) for i, x in enumerate(rng.uniform(0.4, 2.0, 4))})
    made = _grow(b, given, rng, 60)
    known = run(b.statements, given)
    for atom, expected in made:
        assert value(atom, known) == pytest.approx(expected, rel=1e-8, abs=1e-8)
    expressions = [s.expr for s in b.statements]
    assert len(set(expressions)) == len(expressions)


def _state(b: Builder) -> Any:
    return (
        list(b.statements),
        list(b.guards),
        [(s, b.maker(s.target), b.stage_of(s.target)) for s in b.statements],
        set(b.given_names()),
        {asked: v.atom for asked, v in b._values.items() if v.atom is not None},
        {hint: last for hint, last in b._issued.items() if last},
    )


@pytest.mark.parametrize("seed", range(10))
def test_a_rollback_leaves_no_trace_and_can_be_undone(seed: int) -> None:
    rng = np.random.default_rng(seed)
    b = Builder()
    given = inputs(b, {f"x{i}": float(x) for i, x in enumerate(rng.uniform(0.4, 2.0, 4))})
    made = _grow(b, given, rng, 20)
    before, mark = _state(b), b.mark()
    _grow(b, dict(made[:8]), rng, 40)
    b.guard("singular", b.add((*given,), "width"), sp.S.One, 1)
    b.add((*given, *given), "width")
    after = _state(b)
    assert after != before
    forgotten = b.rollback(mark)
    assert _state(b) == before
    b.redo(forgotten)
    assert _state(b) == after
    b.rollback(mark)
    assert _state(b) == before


def test_names_that_were_tried_are_free_again() -> None:
    b = Builder()
    x, y = inputs(b, {"x": 1.0, "y": 2.0})
    mark = b.mark()
    first = b.mul(x, y, "area")
    second = b.add((x, y), "area")
    b.rollback(mark)
    assert [str(b.add((x, y), "area")), str(b.mul(x, y, "area"))] == ["area", "area_2"]
    assert [str(first), str(second)] == ["area", "area_2"]


def test_what_cancels_is_not_computed() -> None:
    b = Builder()
    x, y, z = inputs(b, {"x": 1.0, "y": 2.0, "z": 3.0})
    quotient = b.divide(x, y)
    assert b.mul(quotient, y) == x
    assert b.inverse(b.inverse(z)) == z
    assert b.inverse(-z) == -b.inverse(z)
    root = b.let(sp.sqrt(b.add((x, y))))
    assert b.mul(root, root) == b.add((x, y))
    assert b.divide(b.add((b.mul(x, y), b.mul(y, z))), y) == b.add((x, z))
    assert b.difference(b.add((x, y)), b.add((z, y))) == b.difference(x, z)
    assert b.add((x, -x)) == 0
    assert b.mul(x, sp.S.Zero) == 0


def test_cost_counts_what_the_state_needs_beyond_what_is_kept() -> None:
    b = Builder()
    b.leg_counts["rr"] = 3
    x, y = inputs(b, {"x": 1.0, "y": 2.0})
    p = b.declare(sp.Symbol("p", real=True), Stage(Kind.PARAMETER))
    leg = b.declare(sp.Symbol("l", real=True), Stage(Kind.STATE_LEG, "rr"))
    assert b.cost([b.mul(p, p)]) == 0
    product = b.mul(x, y)
    assert b.cost([product]) == 1
    assert b.cost([b.add((product, x))]) == 2
    b.keep([product])
    assert b.cost([b.add((product, x))]) == 1
    assert b.cost([b.mul(leg, x)]) == 3
    assert b.cost([b.total(b.mul(leg, x), "rr", "sum")]) == 3 + 3
    assert b.total(x, "rr", "sum") == b.mul(sp.Integer(3), x)


def test_values_of_two_leg_types_never_meet() -> None:
    b = Builder()
    one = b.declare(sp.Symbol("l", real=True), Stage(Kind.STATE_LEG, "a"))
    other = b.declare(sp.Symbol("r", real=True), Stage(Kind.STATE_LEG, "c"))
    with pytest.raises(ValueError, match="never stand together"):
        b.add((one, other))


def test_parameters_and_numbers_need_no_guard() -> None:
    b = Builder()
    p = b.declare(sp.Symbol("p", real=True), Stage(Kind.PARAMETER))
    (x,) = inputs(b, {"x": 1.0})
    for atom in (p, sp.S.One, x, x):
        b.guard("singular", atom, p, 1)
    assert [guard.value for guard in b.guards] == [x]


def test_a_guard_stands_where_its_value_and_its_scale_are_known() -> None:
    b = Builder()
    leg = b.declare(sp.Symbol("l", real=True), Stage(Kind.PARAMETER_LEG, "rr"))
    (x,) = inputs(b, {"x": 1.0})
    b.guard("singular", x, leg, 1)
    b.guard("singular", b.mul(x, leg), sp.S.One, 2)
    assert [guard.stage for guard in b.guards] == [Stage(Kind.STATE_LEG, "rr")] * 2


def test_of_a_root_with_a_sign_the_square_is_what_stands_under_it() -> None:
    b = Builder()
    x, y, sign = inputs(b, {"x": 1.0, "y": 2.0, "sign": -1.0})
    b.signs.add(sign)
    root = b.let(sp.sqrt(b.add((x, y))))
    signed, scaled = b.mul(sign, root), b.mul(x, root)
    assert b.mul(signed, signed) == b.mul(-signed, -signed) == b.add((x, y))
    assert b.mul(-signed, signed) == -b.add((x, y))
    assert value(b.mul(scaled, scaled), run(b.statements, {x: 3.0, y: 2.0, sign: -1.0})) == (
        pytest.approx(45.0)
    )


@pytest.mark.parametrize(
    ("text", "count"),
    [("x + y + z", 2), ("x*y*z", 2), ("-x", 0), ("-x*y", 1), ("x**3", 2), ("1/x", 1),
     ("1/sqrt(x)", 2), ("sqrt(x)", 1), ("sin(x*y)", 2), ("atan2(x, y + z)", 2)],
)  # fmt: skip
def test_operations(text: str, count: int) -> None:
    x, y, z = sp.symbols("x y z", real=True)
    names = {"x": x, "y": y, "z": z, "sqrt": sp.sqrt, "sin": sp.sin, "atan2": sp.atan2}
    assert operations(sp.sympify(eval(text, names))) == count
