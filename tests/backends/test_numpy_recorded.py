"""Functions that NumPy modules record: in groups of steps, or step by step for many states."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from tests import models

SOME = (5, 17, 200)
"""Numbers of states that are done in groups; the second is not a size for which rows are made."""


@pytest.fixture(name="m")
def fixture_m() -> ModuleType:
    """A module of its own, with nothing recorded."""
    made = ModuleType("recorded")
    exec(models.source(models.catalogue("planar_3rpr")), made.__dict__)
    return made


def states(m: ModuleType, count: int) -> tuple[Any, Any, Any]:
    """X, V, A around home."""
    rng = np.random.default_rng(count)
    X = m.HOME_X + 0.05 * rng.uniform(-1.0, 1.0, (count, m.NQ))
    return X, *rng.uniform(-1.0, 1.0, (2, count, m.NV))


@pytest.mark.parametrize("count", SOME)
def test_groups_give_the_bits_of_single_steps(m: ModuleType, count: int) -> None:
    given = states(m, count)
    found = m.inverse_dynamics(*given)
    m._KEPT.clear()
    m.__dict__["_SOME"] = 0
    np.testing.assert_array_equal(found, m.inverse_dynamics(*given))
    alone = [m.inverse_dynamics(*(v[k] for v in given)) for k in range(count)]
    np.testing.assert_allclose(found, alone, rtol=1e-12, atol=1e-12)


def test_groups_are_few(m: ModuleType) -> None:
    """Ten states are no ten times the calls of a single one."""
    m.inverse_dynamics(*states(m, 10))
    replay = m._KEPT[m._run_required, 10]
    assert (
        len(replay.record.steps) > 300
    )  # of three legs: with six there are more, in as many groups
    assert len(replay.calls) < 0.3 * len(replay.record.steps)


def test_other_parameters_and_other_states_leave_nothing_behind(m: ModuleType) -> None:
    heavy = m.Parameters(platform_mass=9.0)
    given, others = states(m, 20), states(m, 19)
    want = m.inverse_dynamics(*given), m.inverse_dynamics(*given, heavy)
    assert not np.allclose(*want)
    others[0][3] = np.nan
    lost = m.inverse_dynamics(*others)
    assert np.isnan(lost[3]).all()
    assert np.isfinite(np.delete(lost, 3, axis=0)).all()
    np.testing.assert_array_equal(m.inverse_dynamics(*given), want[0])
    np.testing.assert_array_equal(m.inverse_dynamics(*given, heavy), want[1])


def test_threads_have_arrays_of_their_own(m: ModuleType) -> None:
    given = [states(m, 20 + k // 8) for k in range(16)]
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda g: m.inverse_dynamics(*g), given * 5))
    for k, tau in enumerate(found):
        np.testing.assert_array_equal(tau, m.inverse_dynamics(*given[k % 16]))


def test_memory_that_is_kept_is_bounded(m: ModuleType) -> None:
    for count in range(100, 1300, 100):
        m.inverse_dynamics(*states(m, count))
    kept = sum(replay.rows.nbytes for replay in m._KEPT.values())
    assert kept > 0
    m.__dict__["_MEMORY"] = kept // 4
    m.inverse_dynamics(*states(m, 100))
    assert 0 < sum(replay.rows.nbytes for replay in m._KEPT.values()) <= kept // 4
