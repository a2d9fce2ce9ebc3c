"""`condition`: what it says, in NumPy and C, and that it bounds the error of inverse dynamics."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pne_sym.model.manipulator import Manipulator
from tests.backends.c_library import INVALID, OK, QUICK, SINGULAR, Array, CLibrary
from tests.models import bundle, catalogue, module, random_spec, state_at
from tests.oracle.coordinates import displaced, platform_position, platform_rotation
from tests.sampling import entries, sampled
from tests.whole.cases import guess_of
from tests.whole.test_impossible import pose_of_singular_actuators

EPSILON = float(np.finfo(float).eps)
CONSTANT = 50.0
"""Error of tau over epsilon sigma_1 / sigma_n / legs; measured: up to 7."""
STATES = 12


def poses(name: str) -> tuple[Array, Array]:
    """Poses around closed states, and displacements there."""
    spec, model = catalogue(name), module(catalogue(name))
    rng = np.random.default_rng(0)
    found = [state_at(spec, seed) for seed in range(3)]
    X = np.resize([s.X for s in found], (STATES, model.NQ))
    q = np.resize([s.q for s in found], (STATES, model.NJ))
    steps = rng.uniform(-1e-3, 1e-3, (STATES, model.NV))
    return np.array([displaced(spec, x, s) for x, s in zip(X, steps, strict=True)]), q


def rms_distance(spec: Manipulator) -> float:
    points = np.array([leg.platform_point for leg in spec.legs])
    return float(np.sqrt(np.sum((points - points.mean(axis=0)) ** 2) / len(points)))


def moment_rows(model: Any, spec: Manipulator) -> list[int]:
    linear = {"point": 2, "planar": 2, "spatial": 3, "translational": 3, "spherical": 0}[spec.space]
    turning = [joint.kind != "P" for leg in spec.legs for joint in leg.joints if joint.extra]
    first = model.NV - len(turning)
    return [*range(linear, first), *(first + k for k, turns in enumerate(turning) if turns)]


@pytest.mark.parametrize("name", entries(3))
def test_singular_values_and_codes(name: str, tmp_path: Path) -> None:
    """Those of H with rows scaled; the same numbers and codes in C, one by one and in a batch."""
    spec, model = catalogue(name), module(catalogue(name))
    X, q = poses(name)
    X[1, 0] = np.nan
    X[2] = 1e200
    guess = guess_of(model, q)
    library = CLibrary(bundle(spec), tmp_path, flags=QUICK)
    for function in ("condition", "condition_constrained")[: 1 + bool(model.NC)]:
        sigma, legs, status = getattr(model, function)(X, **guess)
        assert status[1] == INVALID
        assert status[2] != OK
        good = status == OK
        assert good.sum() >= STATES - 4
        assert np.isnan(sigma[~good]).all()
        assert np.isnan(legs[~good]).all()
        assert (legs[good] > 0).all()
        H = model.H(X, **guess)
        if function != "condition":
            H = np.concatenate((H, model.Hk(X, **guess)), axis=-1)
        for length in (None, 0.37):
            rows, scale = moment_rows(model, spec), length or rms_distance(spec)
            scaled = H[good].copy()
            if rows and scale > 0.0:
                scaled[:, rows] /= scale
                want = np.linalg.svd(scaled, compute_uv=False)
                got = getattr(model, function)(X, length=length, **guess)[0][good]
                assert np.abs(got - want).max() < 1e-12 * want.max()
        given = [X, *guess.values()]
        (found, margins), codes = library.batch(function, *given)
        np.testing.assert_array_equal(codes, status)
        assert np.abs(found - sigma)[good].max() < 1e-12 * sigma[good].max()
        np.testing.assert_allclose(margins[good], legs[good], rtol=1e-7)
        for k in range(4):
            (one, _), code = library.single(function, *(v[k] for v in given))
            assert code == status[k]
            np.testing.assert_array_equal(one, found[k])


def test_the_length_follows_the_parameters() -> None:
    model, other = module(catalogue("stewart")), random_spec("stewart", 3)
    points = np.array([leg.platform_point for leg in other.legs])
    p = model.Parameters(ups_platform_point=points)
    got = model.condition(model.HOME_X, p)[0]
    want = model.condition(model.HOME_X, p, length=rms_distance(other))[0]
    np.testing.assert_allclose(got, want, rtol=1e-13)
    assert not np.allclose(got, model.condition(model.HOME_X, p, length=1.0)[0])


def test_points_that_coincide() -> None:
    """The size of the legs stands in: never a division by zero."""
    model = module(catalogue("stewart"))
    p = model.Parameters(ups_platform_point=np.tile([0.1, 0.0, 0.2], (6, 1)))
    sigma, legs, status = model.condition(model.HOME_X, p)
    assert status == OK
    assert np.isfinite(sigma).all()
    assert np.isfinite(legs).all()


@pytest.mark.parametrize("length", [0.0, -1.0, np.nan, np.inf, [1.0, 2.0]])
def test_wrong_lengths(length: Any) -> None:
    model = module(catalogue("stewart"))
    with pytest.raises(ValueError, match=r"condition: length is .*, expected a positive number"):
        model.condition(model.HOME_X, length=length)


def near_singular(name: str, rng: np.random.Generator, count: int) -> Array:
    """Poses at distances of 1e-12 to 1 from singular actuators, or a first leg of no length."""
    spec, model = catalogue(name), module(catalogue(name))
    off = 10.0 ** rng.uniform(-12.0, 0.0, (count, 1))
    found = pose_of_singular_actuators(model) + off * rng.normal(0.0, 1.0, (count, model.NQ))
    leg = spec.legs[0]
    for k in range(count // 2):
        x = model.HOME_X + rng.normal(0.0, 0.1, model.NQ)
        arm = platform_rotation(spec, x) @ np.array(leg.platform_point)
        away = 10.0 ** rng.uniform(-7.5, 0.0) * rng.normal(0.0, 1.0, 3)
        step = np.array(leg.base_point) - platform_position(spec, x) - arm + away
        step.resize(model.NV)
        found[k] = displaced(spec, x, step)
    return np.asarray(found)


@pytest.mark.parametrize("name", sampled(["planar_3rpr", "stewart"], 2))
def test_error_of_inverse_dynamics(name: str, tmp_path: Path) -> None:
    """Against the same formulas in long double: error <= 50 epsilon sigma_1 / sigma_n / legs."""
    model, count, rng = module(catalogue(name)), 400, np.random.default_rng(2)
    made = bundle(catalogue(name))
    exact = CLibrary(made, tmp_path, "long double", flags=QUICK)
    plain = CLibrary(made, tmp_path, flags=QUICK)
    X = near_singular(name, rng, count)
    given = [X, *(rng.uniform(-1.0, 1.0, (count, n)) for n in (model.NV, model.NV, model.NW))]
    (want,), status = exact.batch("inverse_dynamics", *given)
    (found,), other = plain.batch("inverse_dynamics", *given)
    (sigma, legs), _ = plain.batch("condition", X)
    good = (status == OK) & (other == OK)
    assert good.sum() > 0.8 * count
    error = np.abs(found - want).max(axis=1)[good] / np.abs(want).max(axis=1)[good]
    least = np.minimum(legs[good].min(axis=1), 1.0)
    condition = sigma[good, 0] / sigma[good, -1] / least
    assert (error <= CONSTANT * EPSILON * condition).all()
    assert condition.max() > 1e7
    assert error.max() > 1e-10, "no state was near a singularity"
    assert (error.astype(float) > 1e3 * EPSILON).sum() > 20


def test_a_singular_leg() -> None:
    model = module(catalogue("stewart"))
    p = model.Parameters()
    X = np.array([*(p.ups_base_point[0] - p.ups_platform_point[0]), 0.0, 0.0, 0.0, 1.0])
    sigma, legs, status = model.condition(X)
    assert status == SINGULAR
    assert np.isnan(sigma).all()
    assert np.isnan(legs).all()
    for off in (1e-6, 1e-4, 1e-2):
        X[2] = off
        _, legs, status = model.condition(X)
        assert status == OK
        assert np.argmin(legs) == 0
