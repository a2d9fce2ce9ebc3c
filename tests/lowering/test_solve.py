"""Systems of screws against NumPy, by determinants and by an orthogonal basis."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy as sp
from numpy.typing import NDArray

from pne_sym.lowering.builder import Builder
from pne_sym.lowering.solve import Screws, SingularPatternError, solve, solve_transposed
from tests.lowering.numbers import inputs, run, value

Array = NDArray[np.float64]


def _pattern(rng: np.random.Generator, n: int, density: float) -> Array:
    """Zeros and ones with a transversal, so that values in general position can be solved for."""
    found = (rng.random((n, n)) < density).astype(float)
    found[np.arange(n), rng.permutation(n)] = 1.0
    return found


def _screws(b: Builder, matrix: Array, weights: Array) -> tuple[Screws, dict[Any, float]]:
    """Symbols where the matrix is not zero, and their values."""
    n = len(weights)
    names = {f"s{i}{j}": matrix[i, j] for i in range(n) for j in range(n) if matrix[i, j]}
    known = inputs(b, {**names, **{f"k{i}": w for i, w in enumerate(weights)}})
    by_name = {symbol.name: symbol for symbol in known}
    rows = [[by_name.get(f"s{i}{j}", sp.S.Zero) for j in range(n)] for i in range(n)]

    return Screws(
        rows, [sp.S.One] * n, [by_name[f"k{i}"] for i in range(n)], dict.setdefault
    ), known


@pytest.mark.parametrize("n", range(1, 7))
@pytest.mark.parametrize("density", [0.2, 0.6, 1.0])
@pytest.mark.parametrize("across", [False, True])
def test_the_solution_is_that_of_the_matrix(n: int, density: float, across: bool) -> None:
    rng = np.random.default_rng([n, int(10 * density), across])
    matrix = _pattern(rng, n, density) * rng.uniform(0.5, 2.0, (n, n))
    if abs(np.linalg.det(matrix)) < 1e-3:
        matrix = np.eye(n) * 2.0 + matrix
    right, weights = rng.normal(size=n), rng.uniform(0.3, 3.0, n)
    b = Builder()
    screws, known = _screws(b, matrix, weights)
    r = inputs(b, {f"r{i}": x for i, x in enumerate(right)})
    found = (
        solve_transposed(b, screws, list(r))
        if across
        else solve(b, screws, list(r), [f"x{i}" for i in range(n)])
    )
    known = run(b.statements, {**known, **r})
    expected = np.linalg.solve(matrix.T if across else matrix, right)
    assert [value(x, known) for x in found] == pytest.approx(expected, rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("n", [4, 5])
def test_only_what_is_large_and_dense_takes_roots(n: int) -> None:
    b = Builder()
    screws, _ = _screws(b, np.random.default_rng(0).normal(size=(n, n)), np.ones(n))
    solve(b, screws, [sp.S.One] * n, [""] * n)
    roots = [s for s in b.statements if s.expr.atoms(sp.Pow) and s.expr.exp == sp.Rational(1, 2)]
    assert len(roots) == (n if n > 4 else 0)


def test_the_basis_is_shared_by_both_ways() -> None:
    b = Builder()
    screws, known = _screws(b, np.random.default_rng(1).normal(size=(5, 5)), np.ones(5))
    r = inputs(b, {f"r{i}": 1.0 + i for i in range(5)})
    solve(b, screws, list(r), [""] * 5)
    roots = sum(s.expr.is_Pow and s.expr.exp == sp.Rational(1, 2) for s in b.statements)
    solve_transposed(b, screws, list(r))
    again = sum(s.expr.is_Pow and s.expr.exp == sp.Rational(1, 2) for s in b.statements)
    assert roots == again == 5
    assert run(b.statements, {**known, **r})


@pytest.mark.parametrize("n", range(1, 7))
@pytest.mark.parametrize("across", [False, True])
def test_dependent_screws_are_noticed(n: int, across: bool) -> None:
    """A guard fails where the matrix has lost its rank, and none where it has not."""
    rng = np.random.default_rng(n)
    regular = rng.normal(size=(n, n)) + 2.0 * np.eye(n)
    singular = regular.copy()
    singular[:, -1] = singular[:, :-1] @ rng.normal(size=n - 1)
    for matrix, expected in ((regular, False), (singular, True)):
        b = Builder()
        names = {f"s{i}{j}": matrix[i, j] for i in range(n) for j in range(n)}
        known = inputs(b, names)
        rows = [[sp.Symbol(f"s{i}{j}", real=True) for j in range(n)] for i in range(n)]
        screws = Screws(rows, [sp.S.One] * n, [sp.S.One] * n, dict.setdefault)
        one = [sp.S.One] * n
        if across:
            solve_transposed(b, screws, one)
        else:
            solve(b, screws, one, [""] * n)
        values = run(b.statements, known)
        small = [abs(value(g.value, values)) < 1e-9 * value(g.scale, values) for g in b.guards]
        assert any(small) == expected
        assert {g.status for g in b.guards} == {"singular"}


@pytest.mark.parametrize("pattern", ["dense", "single entries"])
@pytest.mark.parametrize("n", [3, 4, 5])
@pytest.mark.parametrize("across", [False, True])
def test_what_is_singular_does_not_depend_on_the_unit_of_length(
    n: int, across: bool, pattern: str
) -> None:
    """Velocities in the first rows, angles in the last two: sizes and weights are lengths."""
    matrix = np.random.default_rng(n).normal(size=(n, n)) + 2.0 * np.eye(n)
    if pattern == "single entries":
        matrix = np.diag(np.diag(matrix))
        matrix[0, -1] = 0.7
    ratios = []
    for unit in (1.0, 1e3):
        lengths = np.where(np.arange(n) < n - 2, unit, 1.0)
        b = Builder()
        length, *entries = inputs(
            b, {"l": 0.3 * unit, **{f"s{i}": x for i, x in enumerate(np.ravel(matrix))}}
        )
        known = {length: 0.3 * unit}
        rows = []
        for i in range(n):
            own = entries[n * i : n * (i + 1)]
            known |= dict(zip(own, matrix[i] * lengths[i], strict=True))
            rows.append([e if x else sp.S.Zero for e, x in zip(own, matrix[i], strict=True)])
        weights = [length if i >= n - 2 else sp.S.One for i in range(n)]
        screws = Screws(rows, [length] * n, weights, dict.setdefault)
        one = [sp.S.One] * n
        if across:
            solve_transposed(b, screws, one)
        else:
            solve(b, screws, one, [""] * n)
        values = run(b.statements, known)
        ratios.append([value(g.value, values) / value(g.scale, values) for g in b.guards])
        assert ratios[-1]
    assert ratios[0] == pytest.approx(ratios[1], rel=1e-9)


def test_rows_of_zeros_are_left_out() -> None:
    b = Builder()
    known = inputs(b, {"s00": 2.0, "s21": 4.0, "r0": 6.0, "r1": 0.0, "r2": 2.0})
    s00, s21, *right = known
    rows = [[s00, sp.S.Zero], [sp.S.Zero, sp.S.Zero], [sp.S.Zero, s21]]
    screws = Screws(rows, [sp.S.One] * 2, [sp.S.One] * 3, dict.setdefault)
    along = solve(b, screws, right, ["", ""])
    across = solve_transposed(b, screws, right[::2])
    known = run(b.statements, known)
    assert [value(x, known) for x in along] == [3.0, 0.5]
    assert [value(x, known) for x in across] == [3.0, 0.0, 0.5]


def test_screws_that_are_dependent_by_structure_are_refused() -> None:
    a, c = sp.symbols("a c", real=True)
    with pytest.raises(SingularPatternError, match="dependent by structure"):
        Screws([[a, c], [sp.S.Zero, sp.S.Zero]], [sp.S.One] * 2, [sp.S.One] * 2, dict.setdefault)
