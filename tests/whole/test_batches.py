"""Leading axes: any number of them, broadcast against each other, every row as if alone."""

from __future__ import annotations

import numpy as np
import pytest

from tests.infinite import finite_parts
from tests.sampling import SAMPLE, sampled
from tests.whole.calls import Outputs, Vectors, call, functions, states
from tests.whole.cases import Array, Case, case

NAMES = (
    "delta",
    "fivebar_offset",
    "hexapod_6ucu",
    "hexapod_6x6r",
    "planar_mixed",
    "planar_redundant",
    "spherical_3ups",
    "stewart_7ups",
    "stewart_sps",
    "tripod_3upu",
)
"""Each space; iterated, constrained, redundant, with extra coordinates, with moments."""
CASES = sampled(NAMES, 0, keep=SAMPLE)


def row_of(vectors: Vectors, row: tuple[int, ...]) -> Vectors:
    return {name: value[row] for name, value in vectors.items()}


def assert_rows(c: Case, name: str, found: Outputs, lead: tuple[int, ...], single: Vectors) -> None:
    """The outputs have the leading axes, and at every row the values of a call of its own."""
    whole = {n: broadcast(v, lead, n) for n, v in single.items() if n in functions(c.model)[name]}
    for row in np.ndindex(*lead):
        alone = call(c, name, row_of(whole, row))
        for many, one in zip(found, alone, strict=True):
            assert many.shape == lead + one.shape, name
            assert np.isfinite(one).all() or name == "joint_margins", name
            found_row, wanted = finite_parts(many[row], one)
            size = np.abs(wanted).max(initial=0.0)
            if name == "power":  # a sum over the actuators, of which little may be left
                size = np.linalg.norm(single["tau"]) * np.abs(c.model.joint_rates(
                    *(whole[n][row] for n in "XV"), c.p, **c.guess)).max()  # fmt: skip
            assert np.abs(found_row - wanted).max(initial=0.0) <= 1e-14 * size


def broadcast(value: Array, lead: tuple[int, ...], name: str) -> Array:
    dimensions = {"R": 2, "s": 0}.get(name, 1)
    core = value.shape[value.ndim - dimensions :]
    return np.broadcast_to(value, lead + core)


# Up to eight states are computed one by one, more as arrays.
@pytest.mark.parametrize("lead", sampled([(2, 1, 3), (3, 4), (1,)], 0, keep=[(2, 1, 3), (3, 4)]))
@pytest.mark.parametrize("name", CASES)
def test_leading_axes(name: str, lead: tuple[int, ...]) -> None:
    c = case(name, 1)
    vectors = states(c, lead)
    for function in functions(c.model):
        assert_rows(c, function, call(c, function, vectors), lead, vectors)


@pytest.mark.parametrize("name", CASES)
def test_broadcasting(name: str) -> None:
    """Each argument in turn has leading axes (3, 1), the others (4,); then the others none."""
    c = case(name, 1)
    few, many = states(c, ()), states(c, (3, 1), seed=1)
    for function, arguments in functions(c.model).items():
        for argument in arguments:
            for lead in ((3, 4), (3, 1))[len(arguments) == 1 :]:
                count = (4,) if lead == (3, 4) else ()
                mixed = {n: broadcast(few[n], count, n) for n in arguments}
                mixed[argument] = many[argument]
                assert_rows(c, function, call(c, function, mixed), lead, mixed)


@pytest.mark.parametrize("name", CASES)
def test_no_states(name: str) -> None:
    c = case(name, 1)
    one = states(c, ())
    for function, arguments in functions(c.model).items():
        none = {n: one[n][None][:0] for n in arguments}
        alone = call(c, function, one)
        for found, value in zip(call(c, function, none), alone, strict=True):
            assert found.shape == (0, *value.shape)


@pytest.mark.parametrize("function", ["dynamics", "inverse_dynamics", "forward_dynamics"])
def test_more_states_than_a_block(function: str) -> None:
    """Blocks are of 2048 states."""
    c = case("planar_redundant", 1)
    vectors = states(c, (2048 + 12,))
    found = call(c, function, vectors)
    for rows in (slice(0, 12), slice(2040, 2052), slice(2048, None)):
        part = call(c, function, {n: v[rows] for n, v in vectors.items()})
        for many, few in zip(found, part, strict=True):
            assert np.array_equal(many[rows], few)


def test_arguments_are_not_touched_and_results_are_not_shared() -> None:
    """Outputs may be written to; what is read again is what stood there before."""
    c = case("stewart_sps", 1)
    vectors = states(c, (2,))
    before = {n: v.copy() for n, v in vectors.items()}
    for function in functions(c.model):
        first = call(c, function, vectors)
        kept = [value.copy() for value in first]
        for value in first:
            value[...] = 1.0
        for value, again in zip(kept, call(c, function, vectors), strict=True):
            assert np.array_equal(value, again)
    assert all(np.array_equal(before[n], v) for n, v in vectors.items())
