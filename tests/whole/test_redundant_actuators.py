"""More actuators than degrees of freedom: least effort, weights, forces that cancel each other."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from pne_sym.model.manipulator import Manipulator
from tests.models import catalogue, live_parameters, module, random_spec, state_at
from tests.oracle.specs import State

Array = NDArray[np.float64]
REDUNDANT = {"planar_4rpr": 1, "fivebar_redundant": 1, "stewart_7ups": 1}
"""Name -> how many actuators more than degrees of freedom."""
FREE = {"planar_4rpr_free": "planar_4rpr", "stewart_7ups_free": "stewart_7ups"}
SEEDS = (1, 2, 3)


class Case(NamedTuple):
    """A model with random parameters at a random state."""

    model: Any
    p: Any
    spec: Manipulator
    state: State

    @property
    def force(self) -> Array:
        """What the actuators must give, with the wrench."""
        X, _, V, A, wrench = self.state
        M, Z, _ = self.model.dynamics(X, V, self.p)
        return np.asarray(M @ A + Z - wrench)

    def tau(self, **options: Any) -> Array:
        """Inverse dynamics."""
        X, _, V, A, wrench = self.state
        return np.asarray(self.model.inverse_dynamics(X, V, A, self.p, wrench=wrench, **options))


def case(name: str, seed: int) -> Case:
    other = random_spec(name, seed)
    nominal = catalogue(name)
    return Case(module(nominal), live_parameters(nominal, other), other, state_at(other, seed))


@pytest.mark.parametrize("name", REDUNDANT)
@pytest.mark.parametrize("seed", SEEDS)
def test_least_norm(name: str, seed: int) -> None:
    """The Moore-Penrose solution, which has no part that does nothing."""
    c = case(name, seed)
    H, tau = c.model.H(c.state.X, c.p), c.tau()
    assert H.shape == (c.model.NV, c.model.NV + REDUNDANT[name])
    expected = np.linalg.pinv(H) @ c.force
    assert np.allclose(tau, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
    idle = c.model.null_space(c.state.X, c.p)
    assert np.abs(idle.T @ tau).max() < 1e-10 * np.abs(tau).max()


@pytest.mark.parametrize("name", REDUNDANT)
@pytest.mark.parametrize("seed", SEEDS)
def test_weights(name: str, seed: int) -> None:
    """tau W tau is the least: no step along the null space makes it less."""
    c = case(name, seed)
    weights = np.random.default_rng(seed).uniform(0.1, 10.0, c.model.NU)
    tau, idle = c.tau(weights=weights), c.model.null_space(c.state.X, c.p)
    H = c.model.H(c.state.X, c.p)
    assert np.allclose(H @ tau, c.force, rtol=1e-9, atol=1e-9 * np.abs(c.force).max())
    assert np.abs(idle.T @ (weights * tau)).max() < 1e-9 * np.abs(weights * tau).max()
    for step in (-0.1, 0.1):
        other = tau + step * np.abs(tau).max() * idle[:, 0]
        assert weights @ other**2 > weights @ tau**2
    spread = H.T / weights[:, None]
    assert np.allclose(tau, spread @ np.linalg.solve(H @ spread, c.force), rtol=1e-8)


@pytest.mark.parametrize("name", REDUNDANT)
def test_equal_weights_are_no_weights(name: str) -> None:
    c = case(name, 1)
    weights = np.full(c.model.NU, 7.0)
    assert np.allclose(c.tau(weights=weights), c.tau(), rtol=1e-12)


@pytest.mark.parametrize("name", REDUNDANT)
def test_a_heavy_actuator_rests(name: str) -> None:
    """A weight beyond all others takes an actuator out: its force goes to zero."""
    c = case(name, 2)
    weights = np.ones(c.model.NU)
    weights[0] = 1e8
    tau = c.tau(weights=weights)
    assert abs(tau[0]) < 1e-5 * np.abs(tau).max()


@pytest.mark.parametrize("name", REDUNDANT)
@pytest.mark.parametrize("seed", SEEDS)
def test_null_space(name: str, seed: int) -> None:
    """Orthonormal, without effect on the platform, felt by the legs."""
    c = case(name, seed)
    X, _, V, _, wrench = c.state
    idle, H = c.model.null_space(X, c.p), c.model.H(X, c.p)
    assert idle.shape == (c.model.NU, REDUNDANT[name])
    assert np.allclose(idle.T @ idle, np.eye(REDUNDANT[name]), atol=1e-12)
    assert np.abs(H @ idle).max() < 1e-12 * np.abs(H).max()
    tau = c.tau()
    strained = tau + idle @ np.full(REDUNDANT[name], 50.0)
    first, second = (c.model.forward_dynamics(X, V, t, c.p, wrench=wrench) for t in (tau, strained))
    assert np.allclose(first, c.state.A, rtol=1e-9, atol=1e-8)
    assert np.allclose(second, c.state.A, rtol=1e-9, atol=1e-8)


@pytest.mark.parametrize("name", REDUNDANT)
def test_in_batches(name: str) -> None:
    """Row by row the same, with weights and with a state that is impossible."""
    c = case(name, 1)
    rng = np.random.default_rng(0)
    X = c.state.X + rng.uniform(-0.02, 0.02, (2, 5, c.model.NQ))
    V, A = rng.uniform(-1.0, 1.0, (2, 2, 5, c.model.NV))
    weights = np.linspace(1.0, 3.0, c.model.NU)
    X[1, 2, 0] = np.nan
    tau = c.model.inverse_dynamics(X, V, A, c.p, weights=weights)
    idle = c.model.null_space(X, c.p)
    for row in np.ndindex(2, 5):
        if row == (1, 2):
            assert np.isnan(tau[row]).all()
            assert np.isnan(idle[row]).all()
            continue
        single = c.model.inverse_dynamics(X[row], V[row], A[row], c.p, weights=weights)
        assert np.allclose(tau[row], single, rtol=1e-10, atol=1e-10)
        overlap = np.abs(idle[row].T @ c.model.null_space(X[row], c.p))
        assert np.allclose(overlap, np.eye(REDUNDANT[name]), atol=1e-10)


@pytest.mark.parametrize("name", REDUNDANT)
@pytest.mark.parametrize("weight", [0.0, -1.0, np.nan])
def test_weights_are_positive(name: str, weight: float) -> None:
    c = case(name, 1)
    weights = np.ones(c.model.NU)
    weights[-1] = weight
    with pytest.raises(ValueError, match="weights must be positive"):
        c.tau(weights=weights)


def test_no_redundancy_no_null_space() -> None:
    model = module(catalogue("stewart"))
    assert model.null_space(model.HOME_X).shape == (6, 0)
    assert model.null_space(np.tile(model.HOME_X, (3, 1))).shape == (3, 6, 0)


@pytest.mark.parametrize(("name", "actuated"), FREE.items())
@pytest.mark.parametrize("seed", SEEDS)
def test_a_free_leg_has_no_column_but_its_inertia(name: str, actuated: str, seed: int) -> None:
    """Section 3.3: with its actuator off, the same M and Z, and H without a column."""
    c = case(actuated, seed)
    free = module(catalogue(name))
    p = live_parameters(catalogue(name), c.spec)
    X, _, V, _, _ = c.state
    M, Z, H = c.model.dynamics(X, V, c.p)
    M_free, Z_free, H_free = free.dynamics(X, V, p)
    assert np.allclose(M_free, M, rtol=1e-12, atol=1e-12 * np.abs(M).max())
    assert np.allclose(Z_free, Z, rtol=1e-12, atol=1e-12 * np.abs(Z).max())
    assert np.allclose(H_free, H[:, :-1], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("seed", SEEDS)
def test_an_elbow_actuated_too(seed: int) -> None:
    """Section 3.4: the column of the elbow's actuator is -S / (l u sin(elbow))."""
    c = case("fivebar_redundant", seed)
    leg, q = c.spec.legs[0], c.model.inverse_kinematics(c.state.X, c.p)
    S = c.state.X - np.array(leg.base_point)[:2]
    lower, upper = leg.joints[1].offset[0], leg.platform_joint.offset[0]
    expected = -S / (lower * upper * np.sin(q[1]))
    assert np.allclose(c.model.H(c.state.X, c.p)[:, 1], expected, rtol=1e-10)


def test_what_a_guide_bears_is_exact_where_its_force_along_an_axis_is_small() -> None:
    """All forces at once, and of these the least tau: next to home, where a force across the guide
    has hardly a component along z, on which all actuators act.
    """
    m = module(catalogue("quadrupod"))
    rng = np.random.default_rng(4)
    X = m.project(m.HOME_X + 1e-5 * rng.normal(size=(20, m.NQ)))
    wrench = rng.normal(size=(20, m.NW))
    rest = np.zeros((20, m.NV))
    found = np.concatenate(m.inverse_dynamics(X, rest, rest, wrench=wrench), axis=1)
    needed = m.Z(X, rest) - wrench
    for x, force, both in zip(X, needed, found, strict=True):
        system = np.concatenate((m.H(x), m.Hk(x)), axis=1)
        some, idle = np.linalg.lstsq(system, force)[0], np.linalg.svd(system)[2][-1]
        tau = slice(0, m.NU)
        some = some - idle * (idle[tau] @ some[tau]) / (idle[tau] @ idle[tau])
        assert np.abs(both - some).max() < 1e-12 * np.abs(some).max()
