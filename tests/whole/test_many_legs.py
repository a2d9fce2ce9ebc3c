"""Fewer and more legs than degrees of freedom: 5, 7 and 60 UPS legs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from pne_sym.model.manipulator import Home, Manipulator
from tests.models import catalogue, manifest, module, source, state_at
from tests.oracle.closure import close_legs
from tests.oracle.comparison import relative_error
from tests.oracle.projection import project
from tests.oracle.randomisation import vector3
from tests.sampling import sampled
from tests.whole.cases import TOLERANCE

COUNTS = (5, 7, 60)


@cache
def with_legs(count: int) -> Manipulator:
    """The Stewart platform with some of its legs, or with more of them at other points."""
    spec = catalogue("stewart")
    rng = np.random.default_rng(count)
    legs = []
    for number in range(count):
        leg = spec.legs[number % 6]
        spread = 0.0 if number < 6 else 0.05
        point = np.array(leg.base_point) + rng.uniform(-spread, spread, 3)
        seat = np.array(leg.platform_point) + rng.uniform(-spread, spread, 3)
        legs.append(replace(leg, base_point=vector3(point), platform_point=vector3(seat)))
    guess = np.tile(np.array(spec.home.q), 10)[: 3 * count]
    moved = replace(spec, name=f"stewart_{count}", legs=tuple(legs))
    q = close_legs(moved, np.array(spec.home.X), guess)
    return replace(moved, home=Home(spec.home.X, tuple(map(float, q))))


@pytest.mark.parametrize("count", sampled(COUNTS, 0, keep=[5, 7]))
def test_right(count: int) -> None:
    spec = with_legs(count)
    model = module(spec)
    assert (count, 3 * count, 6, 0) == (model.NU, model.NJ, model.NV, model.NC)
    assert len(manifest(spec)["actuators"]) == count
    if count == 5:
        state = state_at(catalogue("stewart"), 1)
        q = close_legs(spec, state.X, state.q[: 3 * count])
        state = state._replace(q=q)
    else:
        state = state_at(spec, 1)
    X, _, V, A, wrench = state
    oracle = project(spec, *state)
    M, Z, H = model.dynamics(X, V)
    expected = {"M": oracle.M, "Z": oracle.Z, "H": oracle.H}
    found = {"M": M, "Z": Z, "H": H}
    errors = {name: relative_error(found[name], expected[name]) for name in found}
    assert max(errors.values()) < TOLERANCE, errors
    assert relative_error(model.inverse_kinematics(X), state.q) < TOLERANCE
    assert relative_error(model.joint_accelerations(X, V, A), oracle.qdd) < TOLERANCE
    tau = model.inverse_dynamics(X, V, A, wrench=wrench)
    if count < 6:  # no forces of five actuators give any acceleration
        assert np.isnan(tau).all()
    else:
        assert relative_error(tau, oracle.tau) < TOLERANCE
        assert model.null_space(X).shape == (count, count - 6)
    tau = np.linspace(-20.0, 30.0, count)
    motion = np.linalg.solve(oracle.M, oracle.H @ tau + wrench - oracle.Z)
    assert relative_error(model.forward_dynamics(X, V, tau, wrench=wrench), motion) < TOLERANCE


def test_the_code_does_not_grow_with_the_legs() -> None:
    """Legs of one type are one leg's code; only tables have a row for each."""
    few, many = (source(with_legs(count)).count(" = ") for count in (7, 60))
    assert abs(many - few) < 10
