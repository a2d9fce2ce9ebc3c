"""Values used once are put where they are used; what nobody uses goes."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest
import sympy as sp

from pne_sym.lowering.simplify import inline_single_use, numbered, renamed
from pne_sym.lowering.statements import Statement, read_by, rewritten
from pne_sym.program.ir import Check, Store
from tests.lowering.numbers import STATE, run

x, y, z, a, c, d, e = sp.symbols("x y z a c d e", real=True)
GIVEN = {x: 1.5, y: -0.7, z: 2.3}


def _statement(target: Any, expr: Any, **more: Any) -> Statement:
    return Statement(target, expr, STATE, "eq1", **more)


def _stores(*values: Any) -> list[Store]:
    return [Store("out", value, k) for k, value in enumerate(values)]


def _values(statements: list[Statement], *wanted: Any) -> list[float]:
    known = run(statements, GIVEN)
    return [known[s] for s in wanted]


def test_a_value_used_once_is_put_in_its_place() -> None:
    before = [_statement(a, x * y), _statement(c, a + z)]
    after = inline_single_use(before, _stores(c))
    assert [s.target for s in after] == [c]
    assert _values(after, c) == pytest.approx(_values(before, c))


@pytest.mark.parametrize(
    "statements",
    [
        [_statement(a, x * y, is_named=True), _statement(c, a + z)],
        [_statement(a, x * y), _statement(c, a + z), _statement(d, a - z), _statement(e, c * d)],
        [_statement(a, x * y, total_of="rr"), _statement(c, a + z)],
        [_statement(a, x + y), _statement(c, a * z + a * x)],
        [_statement(a, x + y), _statement(c, z * a**2)],
        [_statement(a, x * y + z), _statement(c, a**3)],
    ],
    ids=["named", "used twice", "a sum over legs", "twice in one statement", "squared", "cubed"],
)
def test_other_values_keep_their_statement(statements: list[Statement]) -> None:
    after = inline_single_use(statements, _stores(statements[-1].target))
    assert a in {s.target for s in after}


def test_outputs_and_guards_keep_their_names() -> None:
    guard = Check("singular", d, sp.S.One, 1, "eq1")
    before = [_statement(a, x * y), _statement(d, x + y), _statement(c, a + d)]
    after = inline_single_use(before, [*_stores(a, c), guard])
    assert [s.target for s in after] == [a, d, c]


def test_what_cancels_away_leaves_no_statement_behind() -> None:
    """c = (a + x) - x is a: what only x needed, here nothing, and what nobody reads are gone."""
    before = [
        _statement(a, y * z, is_named=True),
        _statement(d, x * x, is_named=True),
        _statement(e, a + d),
        _statement(c, e - d),
    ]
    after = inline_single_use(before, _stores(c))
    assert d not in {s.target for s in after}
    assert _values(after, c) == pytest.approx(_values(before, c))


def test_statements_stay_short() -> None:
    names = sp.symbols("v0:40", real=True)
    before = [_statement(names[0], x + y)]
    before += [_statement(n, m * z + k) for k, (m, n) in enumerate(pairwise(names), 2)]
    after = inline_single_use(before, _stores(names[-1]))
    assert 2 < len(after) < 20
    assert _values(after, names[-1]) == pytest.approx(_values(before, names[-1]))


def test_no_absolute_value_comes_of_the_root_of_a_square() -> None:
    before = [_statement(a, x**2), _statement(c, sp.sqrt(a))]
    after = inline_single_use(before, _stores(c))
    assert not any(s.expr.has(sp.Abs) for s in after)
    assert _values(after, c) == pytest.approx([1.5])


def test_names_depend_on_the_statements_alone() -> None:
    first = Statement(sp.Symbol("r_17", real=True), x * y, STATE, "eq1", hint="r")
    second = Statement(sp.Symbol("r_99", real=True), first.target + z, STATE, "eq1", hint="r")
    names = numbered([first, second], {"r"}, lambda statement, _: statement.hint)
    assert [str(names[s.target]) for s in (first, second)] == ["r_2", "r_3"]
    guard = Check("singular", second.target, z, 1, "eq1")
    ends = [rewritten(end, names) for end in (*_stores(second.target), guard)]
    after = {str(s) for s in read_by([*renamed(names, [first, second]), *ends])}
    assert not after & {"r_17", "r_99"}
