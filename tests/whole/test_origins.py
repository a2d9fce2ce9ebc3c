"""No choice of origins changes an answer: where base, platform, links and slides are told from.

Lengths that decide what is singular, and that weigh moments against forces, must not depend on it.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from pne_sym.model.manipulator import Home, Leg, Manipulator, PlatformJointKind, Space
from pne_sym.model.reader import checked
from tests.models import catalogue, module, state_at
from tests.oracle.comparison import relative_error
from tests.oracle.projection import admissible, project
from tests.oracle.randomisation import vector3
from tests.oracle.specs import State, random_state
from tests.random.drawing import draw
from tests.random.judging import judge
from tests.sampling import entries, sampled
from tests.whole.cases import guess_of
from tests.whole.rewriting import Rewriting, drawn_shifts

TOLERANCE = 1e-10
EXACT = 1e-11
SEEDS = (0, 4, 6, 8, 24, 62, 9, 45, 64, 90)
"""Of the random draw: every space, joint and platform joint."""


# ---- central legs, both ends at the origins or a residue away ------------------------------


def single_up() -> Manipulator:
    """The Tricept's central leg alone, all its joints actuated: a serial arm in space."""
    whole = catalogue("tricept")
    leg = whole.legs[-1]
    joints = tuple(replace(joint, actuated=True) for joint in leg.joints)
    home = Home(whole.home.X, whole.home.q[-3:])
    return replace(
        whole, name="single_up", legs=(replace(leg, joints=joints),), home=home, symbols=()
    )


def a_residue_away(manipulator: Manipulator, residue: float) -> Manipulator:
    """Base and platform origins a little off the ends of the legs that sit there."""
    legs = tuple(_off(leg, residue) for leg in manipulator.legs)
    return checked(replace(manipulator, name="residue", legs=legs))


def _off(leg: Leg, residue: float) -> Leg:
    if any(leg.base_point) or any(leg.platform_point):
        return leg
    turn = np.array(leg.base_frame) @ np.array(leg.platform_joint.rotation)
    by = residue * np.array([0.6, -0.8, 0.0])
    return replace(leg, base_point=vector3(turn @ by), platform_point=vector3(by))


CENTRAL = [*(("single_up", x) for x in (0.0, 1e-6, 1e-7, 1e-12)), ("tricept", 1e-7)]


@pytest.mark.parametrize(("name", "residue"), sampled(CENTRAL, 0, keep=[("single_up", 1e-7)]))
def test_a_central_leg_at_the_origins(name: str, residue: float) -> None:
    """Right, not NaN and not nearly right."""
    spec = single_up() if name == "single_up" else catalogue(name)
    if residue:
        spec = a_residue_away(spec, residue)
    verdict = judge(spec, np.random.default_rng(3), states=2, with_c=name == "single_up")
    assert verdict.refused == ""
    assert not verdict.stateless
    assert {what: e for what, e in verdict.errors.items() if not e < EXACT} == {}


@pytest.mark.parametrize("name", sampled(["tricept", "quadrupod"], 2))
def test_reactions_and_lambda_of_a_central_leg(name: str) -> None:
    """What the constraints do, and forces in the actuators, by the independent projection."""
    spec = catalogue(name)
    m = module(spec)
    for seed in range(3):
        s = state_at(spec, seed)
        ours = project(spec, *s)
        tau, lam = m.inverse_dynamics(s.X, s.V, s.A, wrench=s.wrench)
        assert relative_error(tau, ours.tau) < EXACT
        assert relative_error(m.Hk(s.X) @ lam, ours.Hk @ ours.lam) < EXACT
        for found, wanted in zip(m.dynamics(s.X, s.V), (ours.M, ours.Z, ours.H), strict=True):
            assert relative_error(found, wanted) < EXACT
        A, again = m.forward_dynamics(s.X, s.V, tau, wrench=s.wrench)
        assert relative_error(A, s.A) < EXACT
        assert relative_error(again, lam) < EXACT


# ---- everything told from elsewhere -----------------------------------------------------------


def answers(spec: Manipulator, s: State, tau: Any) -> dict[str, Any]:
    """Every function at a state."""
    m = module(spec)
    guess = guess_of(m, s.q)
    M, Z, H = m.dynamics(s.X, s.V, **guess)
    forces = m.inverse_dynamics(s.X, s.V, s.A, wrench=s.wrench, **guess)
    motion = m.forward_dynamics(s.X, s.V, tau, wrench=s.wrench, **guess)
    found = {
        "M": M,
        "Z": Z,
        "H": H,
        "q": m.inverse_kinematics(s.X, **guess),
        "qd": m.joint_rates(s.X, s.V, **guess),
        "qdd": m.joint_accelerations(s.X, s.V, s.A, **guess),
        "kinetic": m.energy(s.X, s.V, **guess)[0],
        "tau": forces[0] if m.NC else forces,
        "A": motion[0] if m.NC else motion,
    }
    if m.NC:
        Hk = m.Hk(s.X, **guess)
        found |= {"lambda": forces[1], "lambda of A": motion[1], "Hk": Hk}
        # Its terms may cancel to nothing but rounding: an error is absolute where they are small.
        found["bias"] = np.append(m.constraint_bias(s.X, s.V, **guess), 1.0)
    return found


def same(spec: Manipulator, s: State, rewriting: Rewriting) -> dict[str, float]:
    """How far the answers of the two writings are apart."""
    tau = np.random.default_rng(1).uniform(-20.0, 20.0, module(spec).NU)
    wanted = rewriting.answers(s, answers(spec, s, tau))
    found = answers(rewriting.after, rewriting.state(s), tau)
    assert found.keys() == wanted.keys()
    return {name: _gap(found[name], wanted[name]) for name in wanted}


def _gap(found: Any, wanted: Any) -> float:
    if np.isnan(found).all() and np.isnan(wanted).all():
        return 0.0
    return relative_error(found, wanted)


def _rewritten(spec: Manipulator, seed: int, *, seats: bool) -> Rewriting:
    rng = np.random.default_rng(seed)
    shifts = drawn_shifts(spec, rng, 0.7, seats=seats)
    return Rewriting(replace(spec, symbols=()), shifts)


def _holds_by_moments(spec: Manipulator) -> bool:
    """Whether a leg holds the platform by moments: which ones is told about its end."""
    planar = spec.space in (Space.PLANAR, Space.POINT)
    transmits = any(leg.platform_joint.kind is not PlatformJointKind.SPHERICAL for leg in spec.legs)
    return transmits and not planar


@pytest.mark.parametrize("name", entries(4))
def test_entries_told_from_elsewhere(name: str) -> None:
    spec = catalogue(name)
    s = state_at(spec, 4)
    seats = not (_holds_by_moments(spec) and module(spec).NC)
    errors = same(spec, s, _rewritten(spec, 7, seats=seats))
    assert {what: e for what, e in errors.items() if not e < TOLERANCE} == {}


@pytest.mark.parametrize("name", sampled(["tricept", "quadrupod"], 2))
def test_another_point_at_a_rigid_end(name: str) -> None:
    """Constraints are told about another point: what they leave of the motion is the same."""
    spec = catalogue(name)
    s = state_at(spec, 4)
    rewriting = _rewritten(spec, 7, seats=True)
    assert rewriting.after.legs[-1].platform_joint.offset != (0.0, 0.0, 0.0)
    there = rewriting.state(s)
    tau = np.arange(1.0, module(spec).NU + 1.0)
    wanted = rewriting.answers(s, answers(spec, s, tau))
    found = answers(rewriting.after, there, tau)
    for quantity in ("q", "qd", "qdd", "kinetic", "tau", "A"):
        assert relative_error(found[quantity], wanted[quantity]) < TOLERANCE, quantity
    N, c = admissible(project(rewriting.after, *there))
    for reduced in (
        lambda x: N.T @ x["M"] @ N,
        lambda x: N.T @ (x["M"] @ c + x["Z"]),
        lambda x: N.T @ x["H"],
    ):
        assert relative_error(reduced(found), reduced(wanted)) < TOLERANCE


@cache
def _random(seed: int) -> Manipulator:
    return checked(draw(seed, light=True))


@pytest.mark.parametrize("seed", sampled(SEEDS, 8))
def test_random_mechanisms_told_from_elsewhere(seed: int) -> None:
    spec = _random(seed)
    s = random_state(spec, np.random.default_rng(seed), 0.7)
    seats = not (_holds_by_moments(spec) and module(spec).NC)
    errors = same(spec, s, _rewritten(spec, seed, seats=seats))
    assert {what: e for what, e in errors.items() if not e < TOLERANCE} == {}
