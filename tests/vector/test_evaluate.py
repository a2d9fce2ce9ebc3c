"""Expressions in numbers where they have none."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from pne_sym.vector.evaluate import evaluate

a, b = sp.symbols("a b", real=True)


@pytest.mark.filterwarnings("error")
def test_what_has_no_value_is_infinite_or_not_a_number() -> None:
    assert np.isinf(evaluate(1 / a, {"a": 0.0}))
    assert np.isnan(evaluate(sp.sqrt(a), {"a": -1.0}))
    assert evaluate(a / sp.sqrt(b), {"a": 3.0, "b": 4.0}) == 1.5
