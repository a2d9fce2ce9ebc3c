"""Kinematics in motion: derivatives by differences, there and back, drift of constraints."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.models import catalogue, drawn, module, state_at
from tests.oracle.comparison import relative_error
from tests.oracle.coordinates import actuated_indices, displaced, step_between
from tests.oracle.specs import randomise
from tests.sampling import entries
from tests.whole.cases import Array, Case, case, own

STEP = 1e-5
CONSTRAINED = ("fivebar_offset", "tripod_3prs", "tripod_3rps", "tripod_3upu")
CONSTRAINED_ITERATED = ("spatial_2rr_2hr", "translational_pprhu_rr")
"""Drawn ones: with platform joints that transmit forces, and moments too."""


def later(c: Case, h: float) -> tuple[Array, Array]:
    """X and V after a time, with an error that is even in h: central differences do not see it."""
    s = c.state
    return displaced(c.spec, s.X, h * s.V + h**2 / 2 * s.A), s.V + h * s.A


def rate_of(function: Any, c: Case) -> Array:
    """Derivative by time of a function of X and V along the motion of a case."""
    ahead, behind = function(*later(c, STEP)), function(*later(c, -STEP))
    return np.asarray((ahead - behind) / (2 * STEP))


@pytest.mark.parametrize("name", entries())
def test_joint_rates_and_accelerations_are_derivatives(name: str) -> None:
    c = case(name, 1)
    m, p, s = c.model, c.p, c.state
    qd = rate_of(lambda X, _: m.inverse_kinematics(X, p, **c.guess), c)
    assert relative_error(m.joint_rates(s.X, s.V, p, **c.guess), qd) < 1e-8
    qdd = rate_of(lambda X, V: m.joint_rates(X, V, p, **c.guess), c)
    assert relative_error(m.joint_accelerations(s.X, s.V, s.A, p, **c.guess), qdd) < 1e-7


def constrained(name: str) -> Case:
    """A constrained manipulator of the catalogue, or a drawn one at a state of its own."""
    if name in CONSTRAINED:
        return case(name, 1)
    return own(drawn(name), state_at(drawn(name), 1))


@pytest.mark.parametrize("name", CONSTRAINED_ITERATED)
def test_project_with_a_first_guess_for_each_pose(name: str) -> None:
    """Poses off the manifold come back to it, one by one as together."""
    c = constrained(name)
    m, p, s = c.model, c.p, c.state
    rng = np.random.default_rng(0)
    off = np.array([displaced(c.spec, s.X, step) for step in rng.uniform(-0.005, 0.005, (6, m.NV))])
    guess = c.guess["q0"] + rng.uniform(-0.02, 0.02, (6, m.NJ))
    missed = np.abs(m.constraints(off, p, q0=guess)).max(axis=1)
    assert missed.min() > 1e-5
    found = m.project(off.reshape(2, 3, -1), p, q0=guess.reshape(2, 3, -1)).reshape(6, -1)
    assert np.abs(m.constraints(found, p, q0=guess)).max() < 1e-9
    steps = np.array([step_between(c.spec, a, b) for a, b in zip(off, found, strict=True)])
    assert (np.abs(steps).max(axis=1) < 30 * missed).all()
    for k in range(6):
        assert np.array_equal(m.project(off[k], p, q0=guess[k]), found[k])
    shared = m.project(off, p, q0=guess[0])
    assert np.abs(shared - [m.project(x, p, q0=guess[0]) for x in off]).max() == 0.0


@pytest.mark.parametrize("name", CONSTRAINED + CONSTRAINED_ITERATED)
def test_hk_and_bias_are_derivatives_of_the_constraints(name: str) -> None:
    """On the manifold, for motions that leave it: the rate of `constraints` is Hk^T V."""
    c = constrained(name)
    m, p, s = c.model, c.p, c.state
    Hk = m.Hk(s.X, p, **c.guess)
    drift = rate_of(lambda X, V: m.Hk(X, p, **c.guess).T @ V, c)
    expected = Hk.T @ s.A + m.constraint_bias(s.X, s.V, p, **c.guess)
    scale = np.abs(Hk.T).max() * np.abs(s.A).max()
    assert np.abs(expected).max() < 1e-10 * scale
    assert np.abs(drift).max() < 1e-7 * scale
    V = np.linspace(-1.0, 1.3, m.NV)
    leaving = c._replace(state=s._replace(V=V, A=np.zeros(m.NV)))
    rate = rate_of(lambda X, _: m.constraints(X, p, **c.guess), leaving)
    assert np.abs(Hk.T @ V).max() > 1e-2
    assert relative_error(Hk.T @ V, rate) < 1e-7


@pytest.mark.parametrize("name", entries())
def test_forward_kinematics_undoes_inverse_kinematics(name: str) -> None:
    c = case(name, 1)
    q = c.state.q[actuated_indices(c.spec)]
    X0 = np.array(c.spec.home.X)
    if c.spec.name == "stewart_sps":
        X0[7:] = c.state.X[7:]  # spins, which no actuator determines, stay
    found = c.model.forward_kinematics(q, X0, c.p)
    assert np.abs(found - X0).max() > 1e-2
    assert np.abs(step_between(c.spec, c.state.X, found)).max() < 1e-9


def test_a_turn_of_a_screw_is_a_displacement() -> None:
    """Unlike that of a revolute joint it moves the platform: every leg one pitch longer."""
    c = case("hexapod_6uhs", 1)
    q = c.state.q[actuated_indices(c.spec)]
    longer = c.model.forward_kinematics(q + 2 * np.pi, c.state.X, c.p)
    again = c.model.inverse_kinematics(longer, c.p)[actuated_indices(c.spec)]
    assert np.abs(again - q - 2 * np.pi).max() < 1e-8


@pytest.mark.only_in_all
def test_the_displacement_of_an_iterated_screw_has_no_bounds() -> None:
    """Joint axes tilted, so that displacements are iterated; screws far beyond half a turn."""
    rng = np.random.default_rng(5)
    spec = randomise(catalogue("hexapod_6uhs"), rng, structure_kept=False)
    state = state_at(spec, 5)
    q = module(spec).inverse_kinematics(state.X, q0=state.q + 0.02)
    screws = q[actuated_indices(spec)]
    assert screws.min() > np.pi
    assert relative_error(q, state.q) < 1e-9
