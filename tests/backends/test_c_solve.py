"""Systems eliminated in the order of home: right, or in doubt; and in doubt where home was not."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest
from numpy.typing import NDArray

from pne_sym.backends.c_backend import CBackend
from pne_sym.backends.c_solve import elimination, tables
from pne_sym.backends.orders import Order, order_at_home
from pne_sym.program.public import Apply
from tests import models
from tests.backends.c_library import WARNINGS, find_compiler, run

Array = NDArray[np.float64]
ORDER = Order((2, 0, 3, 1), (0, 0, -1, -1))
HOME = np.array(
    [[0.2, 1.0, 0.3, 0.1], [0.05, 0.1, 0.2, 0.2], [1.0, 0.1, 0.4, 0.3], [0.1, 0.1, 0.25, 0.1]]
)
B = np.array([1.0, -2.0, 0.5, 3.0])


@pytest.fixture(scope="module")
def solve(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    bundle, folder = models.bundle(models.catalogue("planar_3rpr")), tmp_path_factory.mktemp("c")
    files = CBackend().emit(bundle)
    head = files["planar_3rpr.c"].split("/* ---- parameters ---- */")[0]
    (folder / "planar_3rpr.h").write_text(files["planar_3rpr.h"])
    routine = elimination(4)
    declared = "const real *a, const real *b, real *x, real *unsure, real *total"
    text = [
        *routine.definition(),
        f"void solve({declared});",
        *tables(ORDER, "x"),
        f"void solve({declared})",
        "{",
        "    eliminate_4(1, 4, order_x, sizes_x, a, b, x, unsure, total);",
        "}",
    ]
    source, made = folder / "solve.c", folder / "solve.so"
    source.write_text("\n".join((head, *text)))
    run(find_compiler("gcc"), "-std=c99", "-O1", *WARNINGS, "-shared", "-fPIC", source, "-o", made)
    return ctypes.CDLL(str(made))


def solved(solve: ctypes.CDLL, a: Array) -> tuple[Array, bool]:
    """The solution, and whether it is in doubt."""
    x, unsure, total = np.full(4, 77.0), np.zeros(1), np.ones(1)
    arrays = (np.ascontiguousarray(a), B, x, unsure, total)
    solve.solve(*(v.ctypes.data_as(ctypes.c_void_p) for v in arrays))
    assert unsure[0] > 0 or total[0] == pytest.approx(1.0 + sum(x), rel=1e-12)
    return x, bool(unsure[0])


def test_what_is_like_home_is_solved(solve: ctypes.CDLL) -> None:
    rng = np.random.default_rng(3)
    for _ in range(50):
        a = HOME + rng.uniform(-0.02, 0.02, HOME.shape)
        x, unsure = solved(solve, a)
        assert not unsure
        np.testing.assert_allclose(x, np.linalg.solve(a, B), rtol=1e-12)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("entry", range(16))
def test_what_is_not_finite_is_in_doubt(solve: ctypes.CDLL, entry: int, value: float) -> None:
    a = HOME.copy()
    a.flat[entry] = value
    assert solved(solve, a)[1]


def test_what_is_nearly_singular_is_in_doubt(solve: ctypes.CDLL) -> None:
    for row in range(4):
        a = HOME.copy()
        a[row] = 2 * HOME[(row + 1) % 4] + 1e-5 * HOME[row]
        assert solved(solve, a)[1]


@pytest.mark.parametrize("pivot", [0.02, 0.03])  # with 0.02 the first two rows are dependent
def test_another_order_is_in_doubt(solve: ctypes.CDLL, pivot: float) -> None:
    a = HOME.copy()
    a[2, 0] = pivot
    assert solved(solve, a)[1]


def test_the_order_is_that_of_home() -> None:
    bundle = models.bundle(models.catalogue("planar_3rpr"))
    function = next(f for f in bundle.program.public if f.name == "inverse_dynamics")
    steps = [s for s in function.steps if isinstance(s, Apply) and s.operation == "solve"]
    order = order_at_home(bundle, function, steps[0])
    assert order is not None
    assert sorted(order.rows) == [0, 1, 2]
