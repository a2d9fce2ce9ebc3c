"""Every guard compares quantities of one dimension: the same mechanism, larger or smaller.

Lengths are multiplied, masses and times stay. The ratio of a tested value to its scale may not
change, neither may a status; results are those of the original, times a power of the factor.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from pne_sym import manipulators
from pne_sym.backends.bundle import Bundle
from pne_sym.model.manipulator import Manipulator
from tests.mechanics.structures import drawn
from tests.models import bundle, catalogue, module, state_at
from tests.sampling import entries, sampled
from tests.scaling import lengths
from tests.scaling.guards import checks_at
from tests.whole.cases import Array, iterates

LARGE, SMALL = 1e3, 1e-3
DRAWN = ("one slide, universal at the platform", "cylindrical at the base", "three slides")
METRIC = ("quadrupod", "tricept")
"""Legs that transmit moments and leave out wrenches of force and moment: their reciprocal wrenches
are completed in a metric of 1 m per rad, on which M, Z, H and one basis depend, tau does not."""
SMALL_ONES = ("planar_3rpr", "spherical_3ups", "tripod_3rps")
STATES = 3


def states(made: Bundle) -> dict[str, Array]:
    """Some closed states."""
    found = [state_at(made.manipulator, seed) for seed in range(STATES)]
    return {n: np.array([getattr(s, n) for s in found]) for n in ("X", "V", "A", "q")}


def changed_ratios(spec: Manipulator, factor: float) -> Iterator[str]:
    """Guards whose value over scale is not what it was."""
    made, large = bundle(spec), bundle(lengths.larger(spec, factor))
    vectors = states(made)
    before = checks_at(made, vectors)
    after = checks_at(large, lengths.scaled(made, vectors, factor))
    for one, other in zip(before, after, strict=True):
        assert one.check.value == other.check.value
        if one.check.status == "singular":
            a, b = one.value * other.scale, other.value * one.scale
            if not np.all(np.abs(a - b) <= 1e-6 * np.abs(a)):
                yield one.check.equation


@pytest.mark.parametrize("name", entries(4))
def test_guards_of_the_catalogue(name: str) -> None:
    changed = set(changed_ratios(catalogue(name), LARGE))
    names = {e.name for e in bundle(catalogue(name)).derivation.equations() if e.id in changed}
    if name in METRIC:  # of nothing but the completed basis
        assert names
        assert all(n.startswith(("w_", "qd_", "qdd_", "wn_")) for n in names), names
    else:
        assert not names


@pytest.mark.parametrize("name", sampled(DRAWN, 0, keep=DRAWN[1:2]))
def test_guards_of_other_structures(name: str) -> None:
    assert not list(changed_ratios(drawn(name), LARGE))


def near(spec: Manipulator, X: Array, rng: np.random.Generator) -> Array:
    """Poses around those given, some of them where a leg is almost of no length."""
    poses = np.repeat(X, 8, axis=0)
    poses += 10.0 ** rng.uniform(-9.0, 0.0, (len(poses), 1)) * rng.uniform(-1.0, 1.0, poses.shape)
    if spec.space in ("spatial", "planar", "translational"):
        leg = spec.legs[0]
        apart = np.array(leg.base_point) - np.array(leg.platform_point)
        places = 2 if spec.space == "planar" else 3
        poses[::8] = 0.0
        poses[::8, :places] = apart[:places] + 10.0 ** rng.uniform(-9.0, -5.0, (len(X), 1))
        poses[::8, 6:7] = 1.0
    return poses


def situations(made: Bundle, model: Any) -> tuple[Array, Array, Array, dict[str, Array]]:
    """Poses, velocities and accelerations that the loops allow, and first guesses."""
    rng, drawn_states = np.random.default_rng(0), states(made)
    X = near(made.manipulator, drawn_states["X"], rng)
    V = rng.uniform(-1.0, 1.0, (len(X), model.NV))
    guess: dict[str, Array] = {}
    if iterates(model):  # its steps are at most half a metre, and end at 1e-11 m
        q = model.inverse_kinematics(X, q0=np.repeat(drawn_states["q"], 8, axis=0))
        good = np.isfinite(q).all(axis=1)
        assert good.sum() > STATES
        X, V, guess = X[good], V[good], {"q0": q[good]}
    if model.NC:  # off the manifold M has the metric of 1 m per rad of the nearest closure
        X = model.project(X, **guess)
        good = np.isfinite(X).all(axis=1)
        X, V, guess = X[good], V[good], {n: q[good] for n, q in guess.items()}
    A = np.flip(V, axis=0)
    if model.NC:  # what the loops allow
        across = np.linalg.pinv(np.nan_to_num(np.swapaxes(model.Hk(X, **guess), -1, -2)))
        rows = np.swapaxes(np.nan_to_num(model.Hk(X, **guess)), -1, -2)
        V = V - (across @ (rows @ V[..., None]))[..., 0]
        bias = np.nan_to_num(model.constraint_bias(X, V, **guess))
        A = A - (across @ ((rows @ A[..., None])[..., 0] + bias)[..., None])[..., 0]
    return X, V, A, guess


@pytest.mark.parametrize(
    ("name", "factor"),
    sampled(
        [*((name, LARGE) for name in manipulators.names()), *((n, SMALL) for n in SMALL_ONES)], 12
    ),
)
def test_statuses_and_results(name: str, factor: float) -> None:
    """The condition, its status, M, Z and H at ordinary and at nearly singular poses."""
    made, model = bundle(catalogue(name)), module(catalogue(name))
    large = module(lengths.larger(catalogue(name), factor))
    X, V, A, guess = situations(made, model)
    other = lengths.scaled(made, {"X": X, "V": V, "A": A}, factor)
    guess_large = {n: lengths.scaled(made, {"q": q}, factor)["q"] for n, q in guess.items()}
    sigma, legs, status = model.condition(X, **guess)
    sigma_large, legs_large, status_large = large.condition(other["X"], **guess_large)
    assert np.array_equal(status, status_large)
    assert (status == 0).sum() > STATES
    good = status == 0  # what M, Z, H and inverse dynamics all accept
    tau = model.inverse_dynamics(X, V, A, **guess)
    tau_large = large.inverse_dynamics(other["X"], other["V"], other["A"], **guess_large)
    if model.NC:
        tau, tau_large = tau[0], tau_large[0]
    tau_large = tau_large / factor ** lengths.actuator_powers(made).astype(float)
    assert np.array_equal(np.isnan(tau), np.isnan(tau_large))
    solved = model.condition_constrained(X, **guess)[0] if model.NC else sigma
    assert _off(tau_large, tau, good, legs, solved[:, 0] / solved[:, -1]) < 1.0
    if name in METRIC:
        return
    np.testing.assert_allclose(legs_large, legs, rtol=1e-5)
    rows, columns = lengths.force_powers(made), lengths.actuator_powers(made)
    if len(set(columns)) == 1:
        scale = factor ** (1.0 - columns[0])
        np.testing.assert_allclose(sigma_large, scale * sigma, rtol=1e-6, atol=1e-9 * scale)
    for name_, small, big, powers in (
        ("H", model.H(X, **guess), large.H(other["X"], **guess_large),
         rows[:, None] - columns),
        ("M", model.M(X, **guess), large.M(other["X"], **guess_large),
         rows[:, None] - lengths.rate_powers(made)),
        ("Z", model.Z(X, V, **guess), large.Z(other["X"], other["V"], **guess_large),
         rows),
    ):  # fmt: skip
        back = big / factor ** powers.astype(float)
        assert np.array_equal(np.isnan(back), np.isnan(small)), name_
        assert _off(back, small, good, legs, np.ones(len(X))) < 1.0, name_


def _off(found: Array, want: Array, good: Array, legs: Array, condition: Array) -> float:
    """Largest difference over 1e-12 times the condition, where both are numbers."""
    good = good & np.isfinite(want).reshape(len(want), -1).all(axis=1)
    size = np.max(np.abs(want[good]).reshape(good.sum(), -1), axis=1)
    off = np.max(np.abs(found - want)[good].reshape(good.sum(), -1), axis=1)
    bound = 1e-12 / np.minimum(legs[good].min(axis=1), 1.0) ** 2 * condition[good]
    return float(np.max(off / (bound * size), initial=0.0))
