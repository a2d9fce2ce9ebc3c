"""Energy: its rate is the power of actuators and wrench; a free motion keeps it."""

from __future__ import annotations

import numpy as np
import pytest

from tests.models import catalogue, module
from tests.oracle.comparison import relative_error
from tests.oracle.coordinates import actuated_indices, displaced
from tests.sampling import entries
from tests.whole.cases import Array, case

STEP = 2e-6
FREE = ("delta", "fivebar_offset", "planar_redundant", "spherical_3ups", "stewart", "tripod_3ups")
"""One of each space, constrained and with an extra coordinate among them."""


@pytest.mark.parametrize("name", entries())
def test_power_balance(name: str) -> None:
    """d/dt (kinetic + potential) = tau . qd of the actuators + wrench . V; lambda does no work."""
    c = case(name, 2)
    m, p, s = c.model, c.p, c.state

    def energy(h: float) -> Array:
        X = displaced(c.spec, s.X, h * s.V + h**2 / 2 * s.A)
        return np.array(m.energy(X, s.V + h * s.A, p, **c.guess))

    tau = m.inverse_dynamics(s.X, s.V, s.A, p, wrench=s.wrench, **c.guess)
    tau = tau[0] if m.NC else tau
    actuated = m.joint_rates(s.X, s.V, p, **c.guess)[actuated_indices(c.spec)]
    power = np.array([tau @ actuated, s.wrench @ s.V[: m.NW]])
    rates = (energy(STEP) - energy(-STEP)) / (2 * STEP)
    assert abs(power.sum() - rates.sum()) < 1e-7 * np.abs([*power, *rates]).max()


@pytest.mark.parametrize("name", entries())
def test_inverse_dynamics_undoes_forward_dynamics(name: str) -> None:
    """Forces drawn at random: what H and Hk make of them is found again."""
    c = case(name, 2)
    m, p, s = c.model, c.p, c.state
    tau = np.random.default_rng(2).uniform(-30.0, 30.0, m.NU)
    A = m.forward_dynamics(s.X, s.V, tau, p, wrench=s.wrench, **c.guess)
    A, lam = A if m.NC else (A, np.zeros(0))
    again = m.inverse_dynamics(s.X, s.V, A, p, wrench=s.wrench, **c.guess)
    again, lam_again = again if m.NC else (again, np.zeros(0))
    H = m.H(s.X, p, **c.guess)
    Hk = m.Hk(s.X, p, **c.guess) if m.NC else np.zeros((m.NV, 0))
    both = np.hstack([H, Hk])
    assert relative_error(H @ again + Hk @ lam_again, H @ tau + Hk @ lam) < 1e-9
    if np.linalg.matrix_rank(both) == m.NU + m.NC:  # else many forces do the same
        assert relative_error(again, tau) < 1e-9
        assert relative_error(lam_again, lam) < 1e-9


@pytest.mark.parametrize("name", FREE)
def test_a_free_motion_keeps_its_energy(name: str) -> None:
    """Drives idle, in free fall from home: the drift is the integrator's, of order four."""
    coarse, fine = drift(name, 8), drift(name, 16)
    assert coarse < 2e-3
    assert fine < coarse / 10 or fine < 1e-12


def drift(name: str, steps: int) -> float:
    """Change of the energy over 0.15 s by the largest kinetic energy; classical Runge-Kutta."""
    m, h = module(catalogue(name)), 0.15 / steps
    idle = np.zeros(m.NU)

    def rate(x: Array) -> Array:
        X, V = x[: m.NQ], x[m.NQ :]
        A = m.forward_dynamics(X, V, idle)
        return np.concatenate((m.X_dot(X, V) if hasattr(m, "X_dot") else V, A[0] if m.NC else A))

    # A push, or the mechanism would fall symmetrically.
    V = np.linspace(-0.3, 0.4, m.NV)
    if m.NC:
        V -= np.linalg.pinv(m.Hk(m.HOME_X).T) @ (m.Hk(m.HOME_X).T @ V)
    x = np.concatenate((m.HOME_X, V))
    energies = [m.energy(m.HOME_X, V)]
    for _ in range(steps):
        k1 = rate(x)
        k2 = rate(x + h / 2 * k1)
        k3 = rate(x + h / 2 * k2)
        k4 = rate(x + h * k3)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        energies.append(m.energy(x[: m.NQ], x[m.NQ :]))
    total = np.sum(energies, axis=1)
    return float(abs(total[-1] - total[0]) / np.max(energies, axis=0)[0])
