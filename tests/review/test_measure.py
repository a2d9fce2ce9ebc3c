"""The largest relative difference, and where it is."""

from __future__ import annotations

import numpy as np
import pytest

from pne_sym.review.measure import gap_between

NAN = float("nan")


def test_none_where_there_is_none() -> None:
    values = np.array([[1.0, NAN], [2.0, 3.0]])
    assert gap_between(values, values.copy()) is None
    assert gap_between(np.zeros((2, 0)), np.zeros((2, 0))) is None


def test_the_largest_is_told_with_its_place() -> None:
    before = np.array([[1.0, 2.0], [3.0, 4.0]])
    after = before + np.array([[0.0, 0.1], [0.0, -0.4]])
    found = gap_between(before, after, legs=[0, 2])
    assert found is not None
    assert (found.where, found.before, found.after) == ("[1] of leg 3", 4.0, 3.6)
    assert found.size == pytest.approx(0.1)


def test_a_value_that_one_side_does_not_have() -> None:
    before, after = np.array([[1.0, NAN]]), np.array([[1.0, 2.0]])
    for sides in ((before, after), (after, before)):
        found = gap_between(*sides)
        assert found is not None
        assert found.size == np.inf
        assert found.where == "[1]"


def test_other_shapes() -> None:
    found = gap_between(np.zeros((2, 3)), np.zeros((2, 4)))
    assert found is not None
    assert found.size == np.inf
    assert "[3] and [4]" in found.where


def test_rounding_of_large_terms_is_none() -> None:
    before, after = np.array([[1e-13]]), np.array([[2e-13]])
    assert gap_between(before, after, floor=1.0) is None
    found = gap_between(before, after, floor=0.01)
    assert found is not None
    assert found.size == pytest.approx(0.5)


def test_infinite_on_both_sides() -> None:
    before, after = np.array([[np.inf, 1.0]]), np.array([[np.inf, 1.5]])
    assert gap_between(before, before.copy()) is None
    found = gap_between(before, after)
    assert found is not None
    assert (found.where, found.size) == ("[1]", pytest.approx(1 / 3))
    found = gap_between(before, np.array([[-np.inf, 1.0]]))
    assert found is not None
    assert found.size == np.inf
