"""A generated model with random live parameters at a random state, and the oracle's answer."""

from __future__ import annotations

import inspect
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pne_sym.model.manipulator import Manipulator
from tests.models import catalogue, live_parameters, module, same_branch_spec, state_at
from tests.oracle.base import Carried, base_of
from tests.oracle.comparison import relative_error
from tests.oracle.effects import margins
from tests.oracle.projection import Result, moments_at_home, project
from tests.oracle.specs import State

Array = NDArray[np.float64]
TOLERANCE = 1e-9
GUESS = 0.02
"""How far the first guess of an iterated leg is off, m or rad."""


class Case(NamedTuple):
    """One model at one state.

    Attributes:
        model: the module generated from the catalogue's own numbers.
        p: parameters of `spec`, through the manifest.
        spec: another specification of the same structure.
        state: a random state of `spec`.
        oracle: the independent values.
        guess: first guess of the displacements, for functions that iterate.
    """

    model: Any
    p: Any
    spec: Manipulator
    state: State
    oracle: Result
    guess: dict[str, Array]


def iterates(model: Any) -> bool:
    """Whether the model's functions take a first guess."""
    return "q0" in inspect.signature(model.M).parameters


def guess_of(model: Any, q: Array) -> dict[str, Array]:
    """A first guess near the displacements, where one is needed."""
    if not iterates(model):
        return {}
    return {"q0": q + GUESS * np.cos(np.arange(q.shape[-1]))}


@cache
def case(name: str, seed: int) -> Case:
    """A catalogue entry's model with random parameters at a random state."""
    spec = same_branch_spec(name, seed)
    return at(name, spec, state_at(spec, seed))


def at(name: str, spec: Manipulator, state: State) -> Case:
    """A catalogue entry's model with the parameters of `spec` at a state."""
    model = module(catalogue(name))
    p = live_parameters(catalogue(name), spec)
    oracle = project(spec, *state, moments=moments_at_home(catalogue(name)))
    return Case(model, p, spec, state, oracle, guess_of(model, state.q))


def own(spec: Manipulator, state: State) -> Case:
    """The model generated from a specification, with its defaults."""
    model = Carried(module(spec), base_of(spec)) if spec.moving_base else module(spec)
    guess = guess_of(model, state.q)
    return Case(model, model.Parameters(), spec, state, project(spec, *state), guess)


def answers(c: Case) -> dict[str, Any]:
    """Everything that has an independent value, as the model gives it."""
    m, p, s, guess = c.model, c.p, c.state, c.guess
    M, Z, H = m.dynamics(s.X, s.V, p, **guess)
    tau, lam = _split(m.inverse_dynamics(s.X, s.V, s.A, p, wrench=s.wrench, **guess), m)
    kinetic, potential = m.energy(s.X, s.V, p, **guess)
    found = {
        "M": M,
        "Z": Z,
        "H": H,
        "q": m.inverse_kinematics(s.X, p, **guess),
        "qd": m.joint_rates(s.X, s.V, p, **guess),
        "qdd": m.joint_accelerations(s.X, s.V, s.A, p, **guess),
        "tau": tau,
        "kinetic": kinetic,
        "potential": potential,
        "reactions": m.leg_reactions(s.X, s.V, s.A, p, wrench=s.wrench, **guess),
        "A": _split(m.forward_dynamics(s.X, s.V, c.oracle.tau, p, wrench=s.wrench, **guess), m)[0],
    }
    if _limited(c):
        found["margins"] = m.joint_margins(s.X, p, **guess)[_limited(c)]
        found["within limits"] = m.within_limits(s.X, p, **guess)
    if m.NC:
        Hk = m.Hk(s.X, p, **guess)
        found["constraint forces"] = _by_leg(c, Hk, lam)
        found["constraints"] = m.constraints(s.X, p, **guess)
        found["constraint drift"] = Hk.T @ s.A + m.constraint_bias(s.X, s.V, p, **guess)
    return found


def expected(c: Case) -> dict[str, Any]:
    """The same from the oracle."""
    o = c.oracle
    reactions = np.array([leg.reaction for leg in o.legs])
    found = {
        "M": o.M,
        "Z": o.Z,
        "H": o.H,
        "q": c.state.q,
        "qd": o.qd,
        "qdd": o.qdd,
        "tau": o.tau,
        "kinetic": o.kinetic,
        "potential": o.potential,
        "reactions": reactions[:, : _reaction_size(c)],
        "A": c.state.A,
    }
    if _limited(c):
        found["margins"] = _margins(c)[_limited(c)]
        found["within limits"] = np.array(float((_margins(c) >= 0.0).all()))
    if c.model.NC:
        found["constraint forces"] = _by_leg(c, o.Hk, o.lam)
        found["constraints"] = np.zeros(c.model.NC)
        found["constraint drift"] = np.zeros(c.model.NC)
    return found


def _margins(c: Case) -> Array:
    return margins([joint for leg in c.spec.legs for joint in leg.joints], c.state.q)


def _limited(c: Case) -> list[int]:
    """Joints with limits of displacement."""
    return [int(k) for k in np.flatnonzero(np.isfinite(_margins(c)))]


def _by_leg(c: Case, Hk: Array, lam: Array) -> Array:
    """What each leg's constraints do on the platform: how a leg splits it is a matter of choice."""
    ends = np.cumsum([len(leg.constraint_wrenches) for leg in c.oracle.legs])[:-1]
    return np.array([part.sum(axis=1) for part in np.split(Hk * lam, ends, axis=1)])


def _reaction_size(c: Case) -> int:
    """Entries of a leg's reaction: force, and moment where some leg transmits one."""
    reactions = c.model.leg_reactions(c.state.X, c.state.V, c.state.A, c.p, **c.guess)
    return int(reactions.shape[-1])


def worst_error(c: Case) -> dict[str, float]:
    """Error of every answer, relative to its largest entry (absolute where that is zero)."""
    found, wanted = answers(c), expected(c)
    assert found.keys() == wanted.keys()
    return {name: relative_error(found[name], wanted[name]) for name in wanted}


def assert_right(c: Case, tolerance: float = TOLERANCE) -> None:
    """Every answer is the oracle's."""
    errors = worst_error(c)
    wrong = {name: error for name, error in errors.items() if not error < tolerance}
    assert not wrong


def _split(result: Any, model: Any) -> tuple[Any, Any]:
    """The first of what is returned, and lambda where there are constraints."""
    return result if model.NC else (result, None)
