"""Platforms with constraints in motion: on their constraints, with their energy accounted for.

A tripod and a five-bar with an offset output are moved for a second by position controllers under
gravity and a wrench.  Two standard stabilisations are shown, both by public functions alone:
Baumgarte's, and projection of pose and velocity after every step.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.models import catalogue, live_parameters, module, random_spec, state_at

Array = NDArray[np.float64]
NAMES = ("tripod_3rps", "fivebar_offset")
CONSTRAINED = (*NAMES, "tripod_3prs")
STEP = 0.004  # s
RATE = 25.0  # 1/s, Baumgarte's: twice in the velocity's term, squared in the position's


class Run(NamedTuple):
    """A simulated second.

    Attributes:
        residual, slip: largest residual of the constraints and of their rate, step by step.
        energy: kinetic and potential, step by step.
        work: of actuators and wrench, step by step.
        speed: largest entry of V, step by step.
    """

    residual: Array
    slip: Array
    energy: Array
    work: Array
    speed: Array


class Rig:
    """A manipulator under position control, with a wrench on the platform."""

    def __init__(self, name: str) -> None:
        self.model: Any = module(catalogue(name))
        joints = [joint for leg in catalogue(name).legs for joint in leg.joints]
        self.actuated = [k for k, joint in enumerate(joints) if joint.actuated]
        self.X = np.array(self.model.HOME_X)
        self.V = np.zeros(self.model.NV)
        self.target = self.model.inverse_kinematics(self.X)[self.actuated]
        self.wrench = np.linspace(-3.0, 4.0, self.model.NW)
        hold = self.model.inverse_dynamics(self.X, self.V, self.V, wrench=self.wrench)[0]
        self.hold = hold
        self.gain = 400.0 if name.startswith("tripod") else 30.0
        self.swing = 0.06 if name.startswith("tripod") else 0.25

    def control(self, X: Array, V: Array, time: float) -> tuple[Array, float]:
        """Actuator forces, and the power of actuators and wrench."""
        q = self.model.inverse_kinematics(X)[self.actuated]
        qd = self.model.joint_rates(X, V)[self.actuated]
        phase = 2 * np.pi * (1.5 * time + np.arange(len(self.actuated)) / 3)
        wanted = self.target + self.swing * (np.sin(phase) - np.sin(phase - 3 * np.pi * time))
        tau = self.hold + self.gain * (wanted - q) - 0.15 * self.gain * qd
        return tau, float(tau @ qd + self.wrench @ V)

    def rate(self, X: Array, V: Array) -> Array:
        """Time derivative of X."""
        return np.asarray(self.model.X_dot(X, V) if len(X) == 7 else V)

    def push(self, X: Array, amount: Array) -> Array:
        """What Hk, weighed by the inertia, needs to change Hk^T V by an amount."""
        M, k = self.model.M(X), self.model.Hk(X)
        spread = np.linalg.solve(M, k)
        return np.asarray(spread @ np.linalg.solve(k.T @ spread, amount))

    def derivative(self, state: Array, time: float, stabilised: bool) -> Array:
        """Rates of X, V and work."""
        nq, nv = self.model.NQ, self.model.NV
        X, V = state[:nq], state[nq : nq + nv]
        tau, power = self.control(X, V, time)
        A, _ = self.model.forward_dynamics(X, V, tau, wrench=self.wrench)
        if stabilised:
            slip, residual = self.model.Hk(X).T @ V, self.model.constraints(X)
            A = A - self.push(X, 2 * RATE * slip + RATE**2 * residual)
        return np.concatenate((self.rate(X, V), A, [power]))

    def projected(self, state: Array) -> Array:
        """Pose and velocity brought back to the constraints."""
        nq, nv = self.model.NQ, self.model.NV
        X = self.model.project(state[:nq])
        V = state[nq : nq + nv]
        V = V - self.push(X, self.model.Hk(X).T @ V)
        return np.concatenate((X, V, state[nq + nv :]))

    def look(self, state: Array) -> tuple[float, ...]:
        """What is recorded of a state."""
        nq, nv = self.model.NQ, self.model.NV
        X, V = state[:nq], state[nq : nq + nv]
        residual, slip = self.model.constraints(X), self.model.Hk(X).T @ V
        energy = sum(float(e) for e in self.model.energy(X, V))
        return (
            float(np.max(np.abs(residual))),
            float(np.max(np.abs(slip))),
            energy,
            float(state[-1]),
            float(np.max(np.abs(V))),
        )


def runge_kutta(f: Callable[[Array, float], Array], x: Array, t: float, h: float) -> Array:
    """One step of the classical method of order four."""
    k1 = f(x, t)
    k2 = f(x + h / 2 * k1, t + h / 2)
    k3 = f(x + h / 2 * k2, t + h / 2)
    k4 = f(x + h * k3, t + h)
    return np.asarray(x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4))


@cache
def simulated(name: str, method: str, offset: float = 0.0, step: float = STEP) -> Run:
    """A second of motion; `offset`: how far the pose starts from the constraints."""
    rig = Rig(name)
    X = rig.X + offset * np.linspace(-1.0, 1.0, len(rig.X))
    state = np.concatenate((X, rig.V, [0.0]))
    seen = [rig.look(state)]
    for number in range(round(1.0 / step)):
        state = runge_kutta(
            lambda x, t: rig.derivative(x, t, method == "baumgarte"), state, number * step, step
        )
        if method == "projection":
            state = rig.projected(state)
        if rig.model.NQ == 7:
            state[3:7] /= np.linalg.norm(state[3:7])
        seen.append(rig.look(state))
    return Run(*(np.array(column) for column in zip(*seen, strict=True)))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("method", ["baumgarte", "projection"])
def test_stays_on_its_constraints(name: str, method: str) -> None:
    run = simulated(name, method)
    assert run.speed.max() > 0.3  # it moves
    assert run.residual.max() < 1e-7
    assert run.slip.max() < 1e-6


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("method", ["baumgarte", "projection"])
def test_energy_is_accounted_for(name: str, method: str) -> None:
    """Kinetic and potential energy change by the work of actuators and wrench."""
    run = simulated(name, method)
    turned_over = np.ptp(run.energy)
    assert turned_over > 0.3
    error = np.abs(run.energy - run.energy[0] - run.work).max()
    assert error < 1e-5 * turned_over


@pytest.mark.parametrize("name", NAMES)
def test_projection_stops_the_drift(name: str) -> None:
    """Steps of 20 ms: without, the errors of the integrator add up."""
    assert simulated(name, "none", step=0.02).residual[-1] > 1e-7
    assert simulated(name, "projection", step=0.02).residual.max() < 1e-12


@pytest.mark.parametrize("name", NAMES)
def test_baumgarte_finds_back(name: str) -> None:
    """It starts some millimetres off its constraints; left alone it stays off."""
    left, led = (simulated(name, method, offset=5e-3) for method in ("none", "baumgarte"))
    assert np.isfinite(np.array(left)).all()
    assert np.isfinite(np.array(led)).all()
    assert led.residual[0] == left.residual[0] > 1e-3
    assert left.residual[-1] > 0.1 * left.residual[0]
    assert led.residual[-1] < 1e-7


def off_the_manifold(name: str, seed: int) -> tuple[Any, Any, Array, Array, Array]:
    """Module, random parameters, poses off the constraints, velocities, accelerations."""
    nominal, other = catalogue(name), random_spec(name, seed)
    model, p, state = module(nominal), live_parameters(nominal, other), state_at(other, seed)
    rng = np.random.default_rng(seed)
    X = state.X + rng.uniform(-0.03, 0.03, (40, len(state.X)))
    V, A = rng.uniform(-1.0, 1.0, (2, 40, len(state.V)))
    return model, p, X, V, A


@pytest.mark.parametrize("name", CONSTRAINED)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_everything_is_finite_off_the_manifold(name: str, seed: int) -> None:
    model, p, X, V, A = off_the_manifold(name, seed)
    assert np.median(np.abs(model.constraints(X, p))) > 1e-3
    tau, lam = model.inverse_dynamics(X, V, A, p)
    values = [
        *model.dynamics(X, V, p), tau, lam, *model.forward_dynamics(X, V, tau, p),
        model.M(X, p), model.Z(X, V, p), model.H(X, p), model.Hk(X, p),
        model.constraints(X, p), model.constraint_bias(X, V, p),
        model.inverse_kinematics(X, p), model.joint_rates(X, V, p),
        model.joint_accelerations(X, V, A, p), model.leg_reactions(X, V, A, p),
        *model.energy(X, V, p), model.project(X, p), model.null_space(X, p),
    ]  # fmt: skip
    assert all(np.isfinite(value).all() for value in values)


@pytest.mark.parametrize("name", CONSTRAINED)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_forward_and_inverse_dynamics_agree_off_the_manifold(name: str, seed: int) -> None:
    """The KKT system and [H Hk] hold there too: only closure is missing."""
    model, p, X, V, _ = off_the_manifold(name, seed)
    tau = np.random.default_rng(seed).uniform(-20.0, 20.0, (len(X), model.NU))
    A, lam = model.forward_dynamics(X, V, tau, p)
    found_tau, found_lam = model.inverse_dynamics(X, V, A, p)
    assert np.allclose(found_tau, tau, rtol=1e-9, atol=1e-8)
    assert np.allclose(found_lam, lam, rtol=1e-9, atol=1e-8)
    residual = np.einsum("...ij,...i->...j", model.Hk(X, p), A) + model.constraint_bias(X, V, p)
    assert np.abs(residual).max() < 1e-9


@pytest.mark.parametrize("name", CONSTRAINED)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_project_finds_a_near_pose(name: str, seed: int) -> None:
    """On the constraints, off along them only, and not moved where it is there already."""
    model, p, X, _, _ = off_the_manifold(name, seed)
    there = model.project(X, p)
    assert np.abs(model.constraints(there, p)).max() < 1e-12
    if model.NQ == 7:
        assert np.allclose(np.linalg.norm(there[:, 3:], axis=1), 1.0)
        X = X / np.where(np.arange(7) < 3, 1.0, np.linalg.norm(X[:, 3:], axis=1)[:, None])
    distance = np.abs(there - X).max()
    assert distance < 10 * np.abs(model.constraints(X, p)).max()
    assert np.abs(model.project(there, p) - there).max() < 1e-12


@pytest.mark.parametrize("name", CONSTRAINED)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_constraints_and_their_derivatives(name: str, seed: int) -> None:
    """Along a motion on the manifold: Hk^T V = 0 stays so for Hk^T A = -bias."""
    nominal, other = catalogue(name), random_spec(name, seed)
    model, p, state = module(nominal), live_parameters(nominal, other), state_at(other, seed)

    def moved(h: float) -> Array:
        """The pose after a time, of second order in the time."""

        def rate(X: Array, V: Array) -> Array:
            return np.asarray(model.X_dot(X, V) if model.NQ == 7 else V)

        middle = state.X + h / 2 * rate(state.X, state.V)
        return np.asarray(state.X + h * rate(middle, state.V + h / 2 * state.A))

    h = 1e-4
    assert np.abs(model.constraints(state.X, p)).max() < 1e-12
    assert np.abs(model.Hk(state.X, p).T @ state.V).max() < 1e-12
    bias = model.constraint_bias(state.X, state.V, p)
    assert np.abs(model.Hk(state.X, p).T @ state.A + bias).max() < 1e-10
    residual = [model.constraints(moved(t), p) for t in (-h, h)]
    assert np.abs(residual[1] - residual[0]).max() / (2 * h) < 1e-5 * (1 + np.abs(state.V).max())
    slip = [model.Hk(moved(t), p).T @ (state.V + t * state.A) for t in (-h, h)]
    assert np.abs(slip[1] - slip[0]).max() / (2 * h) < 1e-4 * (1 + np.abs(bias).max())
