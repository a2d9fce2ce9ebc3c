"""The order of printed terms and factors is SymPy's."""

from __future__ import annotations

import random

import sympy as sp

from pne_sym.backends.scalar import sort_key

SYMBOLS = [sp.Symbol(name, real=True) for name in ("a", "b", "B", "a_2", "a_10", "z")]


def test_it_is_that_of_sympy() -> None:
    draw = random.Random(1)
    factors = [sp.sympify(f) for f in (1, -1, 2, "1/2", "-3/2")]
    made = [f * s for f in factors for s in SYMBOLS] + [sp.S.Zero, *factors]
    made += [s**k for s in SYMBOLS for k in (-1, 2, sp.Rational(1, 2))]
    made += [sp.Abs(SYMBOLS[0]), sp.sin(SYMBOLS[1]), sp.atan2(*SYMBOLS[:2])]
    for _ in range(300):
        made.append(sp.Mul(*draw.sample(made, draw.randint(2, 3))))
        made.append(sp.Add(*draw.sample(made, draw.randint(2, 3))))
    small = [e for e in made if sp.count_ops(e) < 12]
    assert len(small) > 150
    for expr in small:
        assert sort_key(expr) == sp.default_sort_key(expr), expr
