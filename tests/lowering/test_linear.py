"""Sums and products of symbols are what SymPy makes of them, to the order of their terms."""

from __future__ import annotations

import random
from typing import Any

import pytest
import sympy as sp

from pne_sym.lowering import algebra

SYMBOLS = [sp.Symbol(name, real=True) for name in ("a", "b", "B", "a_2", "a_10", "ups_x_1", "z")]
FACTORS = [sp.sympify(f) for f in (1, -1, 1, -1, 1, -1, 2, -2, "1/2", "-1/2", "3/7", 3)]


def _same(found: Any, expected: Any) -> bool:
    """Whether they are equal and stand in the same order."""
    return bool(sp.srepr(found, order="none") == sp.srepr(expected, order="none")) and hash(
        found
    ) == hash(expected)


@pytest.mark.parametrize("seed", range(2))
def test_they_are_those_of_sympy(seed: int) -> None:
    draw = random.Random(seed)
    for _ in range(60):
        terms = [draw.choice(FACTORS) * draw.choice(SYMBOLS) for _ in range(draw.randint(1, 5))]
        terms += [draw.choice(FACTORS), sp.sqrt(SYMBOLS[0]), sp.Add(*SYMBOLS[:3])][: seed and 2]
        draw.shuffle(terms)
        whole = sp.Add(*terms)
        assert _same(algebra.total(*terms), whole)
        assert _same(algebra.negative(whole), -whole)
        minus = whole.could_extract_minus_sign()
        sign, rest = algebra.signed(whole)
        assert sign == (-1 if minus else 1)
        assert _same(rest, -whole if minus else whole)
        assert algebra.symbols(whole) == whole.free_symbols
        other = draw.choice([*SYMBOLS, *FACTORS, sp.S.Zero])
        assert _same(algebra.product(terms[0], other), terms[0] * other)
        assert _same(algebra.product(other, terms[0]), other * terms[0])


@pytest.mark.parametrize("seed", range(2))
def test_replaced_is_what_sympy_replaces(seed: int) -> None:
    draw = random.Random(seed)
    made: list[Any] = [*SYMBOLS, *(f * s for f in FACTORS[-6:] for s in SYMBOLS[:3])]
    made += [1 / SYMBOLS[0], SYMBOLS[1] ** 2, sp.sqrt(SYMBOLS[2]), sp.sin(SYMBOLS[3]), sp.S.Zero]
    for _ in range(80):
        made.append(draw.choice((sp.Add, sp.Mul))(*draw.choices(made, k=draw.randint(2, 4))))
        if sp.count_ops(made[-1]) > 25:
            made.pop()
        changes = {s: draw.choice(made) for s in draw.sample(SYMBOLS, 2)}
        expr = draw.choice(made)
        if all(sp.count_ops(value) < 8 for value in changes.values()):
            assert _same(algebra.replaced(expr, changes), expr.xreplace(changes))
