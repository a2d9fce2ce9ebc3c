"""Kinematic redundancy and passive spin: coordinates beyond the platform's own (Eqs. 6, 7).

M_xx x'' + M_xy y'' + Z_x = H_x tau + W
M_yx x'' + M_yy y'' + Z_y = H_y tau
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from pne_sym.backends.report import ReportBackend
from pne_sym.model.manipulator import JointKind, Manipulator
from tests.models import bundle, catalogue, live_parameters, module, random_spec, state_at
from tests.oracle.projection import project
from tests.oracle.specs import State

Array = NDArray[np.float64]
DRIVEN = ("hybrid_3rrrs_redundant", "planar_redundant")
PASSIVE = ("stewart_sps",)
EXTRA = (*DRIVEN, *PASSIVE)
SEEDS = (1, 2, 3)


class Case(NamedTuple):
    """A model with random parameters at a random state."""

    model: Any
    p: Any
    spec: Manipulator
    state: State

    def blocks(self) -> tuple[Array, Array, Array]:
        """M, Z, H."""
        M, Z, H = self.model.dynamics(self.state.X, self.state.V, self.p)
        return M, Z, H

    @property
    def x(self) -> slice:
        """The platform's rows."""
        return slice(0, self.model.NW)

    @property
    def y(self) -> slice:
        """The extra rows."""
        return slice(self.model.NW, None)

    def joints(self, mark: str) -> list[int]:
        """Places in q of the joints with a mark: actuated, extra."""
        joints = [joint for leg in self.spec.legs for joint in leg.joints]
        return [k for k, joint in enumerate(joints) if getattr(joint, mark)]


def case(name: str, seed: int) -> Case:
    """A random manipulator in the nominal one's assembly (branches are fixed at generation)."""
    nominal = catalogue(name)
    model = module(nominal)
    for attempt in range(100 * seed, 100 * seed + 50):
        other = random_spec(name, attempt)
        p, state = live_parameters(nominal, other), state_at(other, attempt)
        if np.allclose(model.inverse_kinematics(state.X, p), state.q, atol=1e-8):
            return Case(model, p, other, state)
    raise AssertionError(f"no {name} in the same assembly")


@pytest.mark.parametrize("name", EXTRA)
def test_sizes(name: str) -> None:
    model = module(catalogue(name))
    count = sum(joint.extra for leg in catalogue(name).legs for joint in leg.joints)
    pose = 7 if model.NW == 6 else 3
    assert (pose + count, model.NW + count) == (model.NQ, model.NV)


@pytest.mark.parametrize("name", EXTRA)
@pytest.mark.parametrize("seed", SEEDS)
def test_extra_coordinates_are_displacements_of_their_joints(name: str, seed: int) -> None:
    """In q, in the rates and in the accelerations they stand as they are in X, V and A."""
    c = case(name, seed)
    X, _, V, A, _ = c.state
    places = c.joints("extra")
    q = c.model.inverse_kinematics(X, c.p)
    assert np.allclose(q[places], X[len(X) - len(places) :], rtol=0, atol=1e-15)
    assert np.array_equal(c.model.joint_rates(X, V, c.p)[places], V[c.y])
    assert np.array_equal(c.model.joint_accelerations(X, V, A, c.p)[places], A[c.y])


@pytest.mark.parametrize("name", EXTRA)
@pytest.mark.parametrize("seed", SEEDS)
def test_inertia_is_partitioned(name: str, seed: int) -> None:
    """M_xx with the extra joints held, M_yy with the platform held, M_xy between them."""
    c = case(name, seed)
    M, X, V, q = c.blocks()[0], c.state.X, c.state.V, c.state.q
    platform, extra = np.array(V), np.array(V)
    platform[c.y], extra[c.x] = 0.0, 0.0

    def kinetic(motion: Array) -> float:
        return float(project(c.spec, X, q, motion).kinetic)

    first, second, both = kinetic(platform), kinetic(extra), kinetic(V)
    assert np.isclose(V[c.x] @ M[c.x, c.x] @ V[c.x] / 2, first, rtol=1e-11)
    assert np.isclose(V[c.y] @ M[c.y, c.y] @ V[c.y] / 2, second, rtol=1e-10)
    coupling = both - first - second
    assert np.isclose(V[c.x] @ M[c.x, c.y] @ V[c.y], coupling, rtol=1e-9, atol=1e-10 * both)
    assert np.array_equal(M[c.x, c.y], M[c.y, c.x].T)
    assert np.linalg.eigvalsh(M[c.y, c.y]).min() > 0.0


@pytest.mark.parametrize("name", EXTRA)
@pytest.mark.parametrize("seed", SEEDS)
def test_actuators_are_partitioned(name: str, seed: int) -> None:
    """tau . q' of the actuators is V . H tau: H_y tells what they do with the platform held."""
    c = case(name, seed)
    H, rng = c.blocks()[2], np.random.default_rng(seed)
    actuated = c.joints("actuated")
    for rows in (c.x, c.y, slice(None)):
        V = np.zeros(c.model.NV)
        V[rows] = rng.uniform(-1.0, 1.0, V[rows].shape)
        rates = c.model.joint_rates(c.state.X, V, c.p)[actuated]
        assert np.allclose(H.T @ V, rates, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("name", PASSIVE)
@pytest.mark.parametrize("seed", SEEDS)
def test_no_actuator_reaches_a_passive_spin(name: str, seed: int) -> None:
    """Eq. 7: H_y is zero, and the platform's columns are those without spin."""
    c = case(name, seed)
    assert not c.blocks()[2][c.y].any()


@pytest.mark.parametrize("name", DRIVEN)
@pytest.mark.parametrize("seed", SEEDS)
def test_actuators_reach_a_redundant_joint(name: str, seed: int) -> None:
    """Eq. 6: its own actuator by 1, those of its leg by the motion that it forces on them."""
    c = case(name, seed)
    H = c.blocks()[2]
    own = [c.joints("actuated").index(k) for k in c.joints("extra")]
    assert np.array_equal(H[c.y][:, own], np.eye(len(own)))
    assert not H[c.x][:, own].any()
    assert np.count_nonzero(H[c.y]) > len(own)


@pytest.mark.parametrize("name", PASSIVE)
@pytest.mark.parametrize("seed", SEEDS)
def test_spins_feel_their_own_leg_only(name: str, seed: int) -> None:
    """M_yy is diagonal: the inertia of each leg about its own line."""
    c = case(name, seed)
    M, X, q = c.blocks()[0], c.state.X, c.state.q
    spins = M[c.y, c.y]
    assert np.array_equal(spins, np.diag(np.diag(spins)))
    legs = project(c.spec, X, q, c.state.V).legs
    for index, (leg, found) in enumerate(zip(c.spec.legs, legs, strict=True)):
        axis, inertia = np.array(found.motion.rotation[2][:, 0]), 0.0
        for number, joint in enumerate(leg.joints):
            R = found.motion.rotation[number]
            arm = np.cross(axis, found.motion.centre[number] - np.array(leg.base_point))
            tensor = R @ np.array(joint.link.inertia) @ R.T
            inertia += joint.link.mass * float(arm @ arm) + float(axis @ tensor @ axis)
        assert np.isclose(spins[index, index], inertia, rtol=1e-10)


@pytest.mark.parametrize("name", PASSIVE)
@pytest.mark.parametrize("seed", SEEDS)
def test_complete_acceleration(name: str, seed: int) -> None:
    """The spins' own rows give their accelerations; the platform's entries stay."""
    c = case(name, seed)
    X, _, V, A, _ = c.state
    M, Z, _ = c.blocks()
    given = np.array(A)
    given[c.y] = 1e3  # whatever stands there
    found = c.model.complete_acceleration(X, V, given, c.p)
    assert np.array_equal(found[c.x], A[c.x])
    assert np.abs((M @ found + Z)[c.y]).max() < 1e-12 * np.abs(Z).max()
    assert np.allclose(found, A, rtol=1e-8, atol=1e-8)  # the oracle's
    again = c.model.complete_acceleration(X, V, found, c.p)
    assert np.allclose(again, found, rtol=1e-12)
    assert given[-1] == 1e3  # the argument is not touched


@pytest.mark.parametrize("name", DRIVEN)
def test_complete_acceleration_leaves_actuated_coordinates(name: str) -> None:
    c = case(name, 1)
    X, _, V, A, _ = c.state
    assert np.array_equal(c.model.complete_acceleration(X, V, A, c.p), A)


@pytest.mark.parametrize("name", EXTRA)
@pytest.mark.parametrize("seed", SEEDS)
def test_forward_dynamics(name: str, seed: int) -> None:
    """The inverse of inverse dynamics, and what the partitioned equations say."""
    c = case(name, seed)
    X, _, V, A, wrench = c.state
    tau = c.model.inverse_dynamics(X, V, A, c.p, wrench=wrench)
    found = c.model.forward_dynamics(X, V, tau, c.p, wrench=wrench)
    assert np.allclose(found, A, rtol=1e-8, atol=1e-8)
    expected = project(c.spec, X, c.state.q, V, A, wrench).tau
    assert np.allclose(tau, expected, rtol=1e-8, atol=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize("name", EXTRA)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_wrench_on_the_platform_has_no_share_in_the_extra_rows(name: str, seed: int) -> None:
    """Right-hand sides of Eqs. 6 and 7: (W, 0)."""
    c = case(name, seed)
    X, _, V, _, wrench = c.state
    M, Z, H = c.blocks()
    tau = np.random.default_rng(seed).uniform(-20.0, 20.0, c.model.NU)
    A = c.model.forward_dynamics(X, V, tau, c.p, wrench=wrench)
    right = H @ tau + np.concatenate((wrench, np.zeros(c.model.NV - c.model.NW))) - Z
    assert np.allclose(M @ A, right, rtol=1e-9, atol=1e-9 * np.abs(right).max())
    loads = np.eye(c.model.NW)
    change = c.model.forward_dynamics(X, V, tau, c.p, wrench=loads) - c.model.forward_dynamics(
        X, V, tau, c.p
    )
    free = M[c.x, c.x] - M[c.x, c.y] @ np.linalg.solve(M[c.y, c.y], M[c.y, c.x])
    assert np.allclose(change[:, c.x], np.linalg.inv(free), rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize(("name", "words"), [("planar_redundant", "Eq. 6"), (PASSIVE[0], "Eq. 7")])
def test_the_report_names_the_blocks(name: str, words: str) -> None:
    text = ReportBackend().emit(bundle(catalogue(name)))[f"{name}.md"]
    (line,) = (line for line in text.splitlines() if line.startswith("**Partition.**"))
    assert words in line
    block = text.split(line)[1].split("```")[1]
    assert all(rf"\mathbf M_{{{b}}}" in block for b in ("xx", "xy", "yx", "yy"))
    assert (r"\mathbf H_y" in block) == (words == "Eq. 6")


@pytest.mark.parametrize("name", PASSIVE)
def test_spin_angles_do_not_matter_to_axisymmetric_legs(name: str) -> None:
    """The catalogue's legs are bodies of revolution: spin is felt through its rate alone."""
    model = module(catalogue(name))
    X, V = np.array(model.HOME_X), np.zeros(model.NV)
    turned = X + np.concatenate((np.zeros(7), np.linspace(0.3, 2.0, 6)))
    V[:6] = 0.5
    still = model.Z(X, V)
    assert np.allclose(model.M(turned), model.M(X), rtol=0, atol=1e-13)
    assert np.allclose(model.Z(turned, V), still, rtol=0, atol=1e-12)
    V[6:] = 20.0
    assert np.abs(model.Z(X, V)[:6] - still[:6]).max() > 1e-3  # gyroscopic


@pytest.mark.parametrize("name", PASSIVE)
def test_spins_keep_turning(name: str) -> None:
    """With the platform at rest and axisymmetric legs nothing brakes or speeds up a spin."""
    model = module(catalogue(name))
    X, V = np.array(model.HOME_X), np.zeros(model.NV)
    V[6:] = np.linspace(-5.0, 5.0, 6)
    A = model.complete_acceleration(X, V, np.zeros(model.NV))
    assert np.abs(A).max() < 1e-9


@pytest.mark.parametrize("name", EXTRA)
def test_a_simulated_second_keeps_its_energy(name: str) -> None:
    """Forward dynamics in motion: energy changes by the work of the actuators."""
    model = module(catalogue(name))
    spec = catalogue(name)
    joints = [joint for leg in spec.legs for joint in leg.joints]
    actuated = [k for k, joint in enumerate(joints) if joint.actuated]
    X, V = np.array(model.HOME_X), np.zeros(model.NV)
    V[model.NW :] = 0.5 * (name in PASSIVE)
    home = model.inverse_kinematics(X)[actuated]
    hold = model.inverse_dynamics(X, np.zeros(model.NV), np.zeros(model.NV))
    slides = np.array([joints[k].kind is JointKind.PRISMATIC for k in actuated])
    gain, damping = np.where(slides, 900, 300), np.where(slides, 60, 6)
    turning = X.size - model.NV == 1

    def rate(state: Array, time: float) -> Array:
        X, V = state[: model.NQ], state[model.NQ : -1]
        q, qd = model.inverse_kinematics(X)[actuated], model.joint_rates(X, V)[actuated]
        phase = 2 * np.pi * time + np.arange(len(actuated))
        wanted = home + 0.04 * (np.sin(phase) - np.sin(phase - 2 * np.pi * time))
        tau = hold + gain * (wanted - q) - damping * qd
        A = model.forward_dynamics(X, V, tau)
        return np.concatenate((model.X_dot(X, V) if turning else V, A, [tau @ qd]))

    state, h = np.concatenate((X, V, [0.0])), 0.005
    start = sum(model.energy(X, V))
    energies = [start]
    for number in range(200):
        t = number * h
        k1 = rate(state, t)
        k2 = rate(state + h / 2 * k1, t + h / 2)
        k3 = rate(state + h / 2 * k2, t + h / 2)
        k4 = rate(state + h * k3, t + h)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        if turning:
            state[3:7] /= np.linalg.norm(state[3:7])
        energies.append(sum(model.energy(state[: model.NQ], state[model.NQ : -1])))
    turned_over = np.ptp(energies)
    assert turned_over > 0.05
    assert abs(energies[-1] - start - state[-1]) < 1e-4 * turned_over
