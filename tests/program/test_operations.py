"""Operations on arrays of one state, where their definition is easily got wrong."""

from __future__ import annotations

import numpy as np

from pne_sym.program.operations import OPERATIONS


def test_rows_of_rounding_are_no_directions() -> None:
    """A row that is zero but for rounding is not scaled up: rows of the others stay independent."""
    rng = np.random.default_rng(0)
    k = rng.normal(size=(3, 6, 3))
    k[1, 2] = 0.0
    k[2] = k[1]
    k[2, 2] = 1e-17 * rng.normal(size=3)
    resolved, others = OPERATIONS["resolve"]((k, k), (3,))
    assert np.isfinite(resolved).all()
    assert np.abs(others @ k).max() < 1e-14
    h = rng.normal(size=(3, 6, 4))
    for rows, matrix in ((resolved, k), (others, h)):
        values = np.linalg.svd(rows @ matrix, compute_uv=False)
        assert (values[:, -1] > 0.02).all()
    np.testing.assert_allclose(np.abs(others[2]), np.abs(others[1]), atol=1e-12)


def test_rows_of_other_units_are_directions() -> None:
    rng = np.random.default_rng(0)
    k = rng.normal(size=(1, 4, 4))
    k[0, 2] *= 1e-9
    resolved, _ = OPERATIONS["resolve"]((k, k), (4,))
    assert np.isfinite(resolved).all()
    k[0, 3] = k[0, 0]
    resolved, _ = OPERATIONS["resolve"]((k, k), (4,))
    assert np.isnan(resolved).all()
    zero = np.zeros((1, 4, 2))
    (nothing, _) = OPERATIONS["resolve"]((zero, zero), (2,))
    assert np.isnan(nothing).all()


def test_rows_keep_the_weight_that_their_equations_have() -> None:
    """A row of which hardly anything is in k, and much in what stands beside it, is not scaled up:
    what is left when k is gone stays as far from singular as all of it was.
    """
    rng = np.random.default_rng(0)
    k, h = rng.normal(size=(1, 6, 3)), rng.normal(size=(1, 6, 4))
    k[0, 2] *= 1e-7
    resolved, others = OPERATIONS["resolve"]((k, np.concatenate((k, h), axis=2)), (3,))
    assert np.abs(others @ k).max() < 1e-15
    for rows, matrix in ((resolved, k), (others, h)):
        values = np.linalg.svd(rows @ matrix, compute_uv=False)
        assert (values[:, -1] > 0.05 * values[:, 0]).all()


def test_lengths_and_rows() -> None:
    lengths = np.array([[2.0, 3.0], [1e-10, 3.0], [2.0, 3.0]])
    (length,) = OPERATIONS["choose_length"]((lengths, np.array([0.0, 0.0, 5.0])), ())
    np.testing.assert_array_equal(length, [2.0, 3.0, 5.0])
    (divided,) = OPERATIONS["divide_rows"]((np.ones((3, 3, 2)), length), (0, 2))
    np.testing.assert_allclose(divided[:, :, 0], [[0.5, 1, 0.5], [1 / 3, 1, 1 / 3], [0.2, 1, 0.2]])
