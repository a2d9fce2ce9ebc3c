"""The promise about single states and batches, at hostile and at nearly singular states.

Values are equal to 1e-12 times the condition; statuses are equal but where an intermediate result
overflows in one way of computing and not in the other.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.backends.c_library import FAST, INVALID, OK, SINGULAR, Array, CLibrary
from tests.backends.hostile import compare, compared, inputs
from tests.models import bundle, catalogue, module
from tests.sampling import sampled
from tests.whole.test_impossible import pose_of_singular_actuators

COUNT = 4000
NAMES = sampled(("stewart", "hexaglide", "tripod_3rps"), 3)


@pytest.fixture(scope="module", params=NAMES)
def library(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> CLibrary:
    made = bundle(catalogue(request.param))
    return CLibrary(made, tmp_path_factory.mktemp(request.param), flags=FAST)


def test_hostile_states(library: CLibrary) -> None:
    for name, given, found in compared(library, library.name, COUNT, 3):
        k = np.flatnonzero(found.disagree)
        assert not k.size, (name, k[0], {n: v[k[0]] for n, v in given.items()})
        ordinary = np.all([np.abs(v).max(axis=1) < 1e6 for v in given.values()], axis=0)
        assert np.array_equal(found.single[ordinary], found.batch[ordinary]), name
        both = (found.single == OK) & (found.batch == OK)
        assert both.sum() > 100
        with np.errstate(all="ignore"):
            known = both & np.isfinite(found.bound) & np.isfinite(found.error)
        assert known.sum() > 100
        assert (found.error <= found.bound)[known].all(), name


@pytest.mark.parametrize("name", sampled(["stewart", "planar_3rpr"], 2))
def test_around_the_threshold(name: str, tmp_path: Path) -> None:
    """Closer and closer to singular actuators: both sides of the threshold, and right at it."""
    made, model = bundle(catalogue(name)), module(catalogue(name))
    library = CLibrary(made, tmp_path, flags=FAST)
    rng = np.random.default_rng(5)
    off = 10.0 ** rng.uniform(-13.5, -10.0, (COUNT, 1)) * rng.normal(0.0, 1.0, (COUNT, model.NQ))
    X: Array = pose_of_singular_actuators(model) + off
    given = inputs(name, COUNT, rng, X)
    given |= {n: rng.uniform(-1.0, 1.0, given[n].shape) for n in ("V", "A", "wrench")}
    found = compare(library, "inverse_dynamics", given, np.ones(COUNT))
    np.testing.assert_array_equal(found.single, found.batch)
    assert (found.single == SINGULAR).sum() > 50
    assert (found.single == OK).sum() > 50
    assert not (found.single == INVALID).any()
    tau = model.inverse_dynamics(X, given["V"], given["A"], wrench=given["wrench"])
    failed = np.isnan(tau).any(axis=1)
    # rounding moves a pivot by some epsilon, which is 1e-4 of the threshold
    assert np.sum(failed != (found.single != OK)) < 0.02 * COUNT


def test_sums_over_all_types_of_legs_are_taken_in_one_order(tmp_path: Path) -> None:
    """So that without fused operations single states and batches have the same bits."""
    made, m = bundle(catalogue("planar_redundant")), module(catalogue("planar_redundant"))
    assert len(made.derivation.leg_types) > 1
    library = CLibrary(made, tmp_path, flags=("-O1", "-ffp-contract=off"))
    rng = np.random.default_rng(2)
    X = m.HOME_X + rng.uniform(-0.02, 0.02, (64, m.NQ))
    V = rng.uniform(-1.0, 1.0, (64, m.NV))
    batch, status = library.batch("dynamics", X, V)
    assert (status == OK).all()
    for k in range(64):
        alone, _ = library.single("dynamics", X[k], V[k])
        for one, all_of_it in zip(alone, batch, strict=True):
            np.testing.assert_array_equal(one.reshape(-1), all_of_it[k].reshape(-1))
