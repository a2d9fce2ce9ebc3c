"""Systems that NumPy modules eliminate in the order of home: right, or in doubt."""

from __future__ import annotations

import math
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from pne_sym.backends.numpy_solve import elimination, table
from pne_sym.backends.orders import Order
from tests import models

Array = NDArray[np.float64]
ORDER = Order((2, 0, 3, 1), (0, 0, -1, -1))
HOME = np.array(
    [[0.2, 1.0, 0.3, 0.1], [0.05, 0.1, 0.2, 0.2], [1.0, 0.1, 0.4, 0.3], [0.1, 0.1, 0.25, 0.1]]
)
B = np.array([1.0, -2.0, 0.5, 3.0])
NEAR = 0.02


def solved(a: Array) -> tuple[Any, Any]:
    """Solutions and whether they are beyond doubt, of a (4, 4) or (4, 4, states)."""
    scope: dict[str, Any] = {"math": math, "_Order": lambda *parts: parts}
    exec(elimination(4), scope)
    solve, rows, limits = eval(table(ORDER), scope)
    flat = a.reshape(16, *a.shape[2:])
    try:
        sure, (x,) = solve(flat if a.ndim > 2 else flat.tolist(), B.tolist(), rows, limits)
    except ZeroDivisionError:  # of floats: modules take it for a doubt
        return None, False
    return np.array(x), sure


def test_what_is_like_home_is_solved() -> None:
    moved = np.random.default_rng(3).uniform(-NEAR, NEAR, (4, 4, 50))
    many, sure = solved(HOME[..., None] + moved)
    assert sure.all()
    for k in range(50):
        a = HOME + moved[..., k]
        x, alone = solved(a)
        assert alone
        np.testing.assert_array_equal(x, many[:, k])  # a row of a batch is what it is alone
        np.testing.assert_allclose(x, np.linalg.solve(a, B), rtol=1e-12)


def test_what_is_not_like_home_is_in_doubt() -> None:
    odd = [HOME.copy() for _ in range(21)]
    for row, a in enumerate(odd[:4]):  # nearly singular
        a[row] = 2 * HOME[(row + 1) % 4] + 1e-5 * HOME[row]
    odd[4][2, 0] = 0.02  # wants another order
    for entry, a in enumerate(odd[5:]):
        a.flat[entry] = (np.nan, np.inf, -np.inf)[entry % 3]
    with np.errstate(all="ignore"):
        _, sure = solved(np.moveaxis(odd, 0, -1))
        assert not sure.any()
        assert not any(solved(a)[1] for a in odd)


@pytest.mark.parametrize("count", [1, 30, 3000])  # floats, steps in groups, step by step
def test_what_is_in_doubt_is_solved_with_a_choice_of_rows(count: int) -> None:
    manipulator = models.catalogue("planar_3rpr")
    m, wary = models.module(manipulator), ModuleType("wary")
    exec(models.source(manipulator), wary.__dict__)
    rng = np.random.default_rng(1)
    X = m.HOME_X + 0.05 * rng.uniform(-1.0, 1.0, (count, m.NQ))
    V, A = rng.uniform(-1.0, 1.0, (2, count, m.NV))
    (order,) = (o for o in wary._ORDERS[:1])
    pivots = np.abs(m.H(X)[:, order.rows[0], 0])
    first = m.NV * (m.NV - 1) // 2  # of the limits of 1/pivot
    order.limits = (
        *order.limits[:first],
        1.0 / np.median(pivots) * 0.999,
        *order.limits[first + 1 :],
    )
    with pytest.MonkeyPatch.context() as patch:
        chosen = list[int]()
        solve = wary._solve
        patch.setattr(wary, "_solve", lambda a, b: (chosen.append(1), solve(a, b))[1])
        found = wary.inverse_dynamics(X, V, A)
    assert chosen
    np.testing.assert_allclose(found, m.inverse_dynamics(X, V, A), rtol=1e-12, atol=1e-12)
