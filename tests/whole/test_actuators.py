"""What a controller calls: actuators, motors, power, momentum; poses moved and compared."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pne_sym.model.effects import Actuator, Friction, Limits
from pne_sym.model.manipulator import JointKind, Manipulator
from pne_sym.model.reader import checked
from tests.backends.c_library import CLibrary
from tests.models import bundle, catalogue, module, state_at
from tests.oracle.comparison import relative_error
from tests.oracle.coordinates import (
    actuated_indices,
    displaced,
    rotation_from_quaternion,
    step_between,
)
from tests.oracle.effects import margins
from tests.sampling import SAMPLE, entries, sampled
from tests.whole.calls import states
from tests.whole.cases import assert_right, case, own

NAMES = sampled(SAMPLE, 4)


@pytest.mark.parametrize("name", NAMES)
def test_actuators(name: str) -> None:
    c = case(name, 2)
    m, p, s = c.model, c.p, c.state
    places = actuated_indices(c.spec)
    assert list(m.ACTUATED) == places
    assert len(m.ACTUATOR_NAMES) == m.NU == len(set(m.ACTUATOR_NAMES))
    found = [
        m.actuator_positions(s.X, p, **c.guess),
        m.actuator_rates(s.X, s.V, p, **c.guess),
        m.actuator_accelerations(s.X, s.V, s.A, p, **c.guess),
    ]
    for mine, theirs in zip(found, (s.q, c.oracle.qd, c.oracle.qdd), strict=True):
        assert relative_error(mine, theirs[places]) < 1e-9
    np.testing.assert_allclose(found[1], m.H(s.X, p, **c.guess).T @ s.V, atol=1e-9)


def test_names_tell_leg_and_joint() -> None:
    assert module(catalogue("fivebar_redundant")).ACTUATOR_NAMES[0] == "leg1_joint1"
    assert module(catalogue("stewart")).ACTUATOR_NAMES[5] == "leg6_joint3"


@pytest.mark.parametrize("name", NAMES)
def test_power_and_momentum(name: str) -> None:
    c = case(name, 2)
    m, p, s = c.model, c.p, c.state
    tau = np.random.default_rng(3).uniform(-9.0, 9.0, m.NU)
    power = m.power(s.X, s.V, tau, p, **c.guess)
    assert power == pytest.approx(tau @ c.oracle.qd[actuated_indices(c.spec)], rel=1e-9)
    momentum = m.momentum(s.X, s.V, p, **c.guess)
    assert relative_error(momentum, m.M(s.X, p, **c.guess) @ s.V) < 1e-12
    kinetic, _ = m.energy(s.X, s.V, p, **c.guess)
    assert momentum @ s.V == pytest.approx(2 * kinetic, rel=1e-12)
    assert m.dissipation(s.X, s.V, p, **c.guess) == 0.0


def with_motors() -> Manipulator:
    """Friction everywhere; motors at the legs but the last, which is actuated directly."""
    plain, legs = catalogue("planar_3rpr"), []
    for k, leg in enumerate(plain.legs):
        turn, slide = (replace(joint, friction=Friction(2.0, 3.0, 0.1)) for joint in leg.joints)
        motor = Actuator(1e-4, -50.0 - k) if k < 2 else None
        legs.append(replace(leg, joints=(turn, replace(slide, actuator=motor))))
    return checked(replace(plain, legs=tuple(legs)))


def test_motors() -> None:
    """tau = n times the motors' torques; their rates are n times those of the joints."""
    m = module(with_motors())
    X, V, A = np.array(m.HOME_X), np.array([0.3, -0.2, 0.5]), np.array([1.0, 2.0, -3.0])
    n, tau = np.array([-50.0, -51.0, 1.0]), m.inverse_dynamics(X, V, A)
    np.testing.assert_allclose(n * m.motor_torques(X, V, A, tau), tau, rtol=1e-14)
    rates = m.motor_rates(X, V)
    np.testing.assert_allclose(rates, n * m.actuator_rates(X, V), rtol=1e-14)
    assert m.motor_torques(X, V, A, tau) @ rates == pytest.approx(m.power(X, V, tau), rel=1e-12)
    other = m.Parameters().replace(rpr_joint2_gear_ratio=np.array([10.0, 20.0]))
    np.testing.assert_allclose(
        m.motor_rates(X, V, other)[:2], [10, 20] * m.actuator_rates(X, V)[:2]
    )
    assert not hasattr(module(catalogue("planar_3rpr")), "motor_torques")


def test_dissipation() -> None:
    m = module(with_motors())
    X, V = np.array(m.HOME_X), np.array([0.3, -0.2, 0.5])
    qd = m.joint_rates(X, V)
    wanted = np.sum((2.0 + 3.0 / np.hypot(qd, 0.1)) * qd**2)
    assert m.dissipation(X, V) == pytest.approx(wanted, rel=1e-13)
    assert m.dissipation(X, 0 * V) == 0.0
    many = m.dissipation(X, np.random.default_rng(0).normal(size=(50, 3)))
    assert many.shape == (50,)
    assert (many > 0.0).all()


@pytest.mark.parametrize(
    "name",
    sampled(
        ["planar_3rpr", "planar_redundant", "hybrid_3rrrs_redundant"],
        0,
        keep=["planar_3rpr", "planar_redundant"],
    ),
)
def test_margins(name: str) -> None:
    """Of hinges, slides and extra coordinates, some beyond their limits."""
    plain = catalogue(name)
    home, legs = iter(plain.home.q), []
    for i, leg in enumerate(plain.legs):
        joints = []
        for k, joint in enumerate(leg.joints):
            middle = next(home)
            between = (middle + 0.5, middle + 0.9) if i == 0 else (middle - 0.4, middle + 1.0)
            joints.append(replace(joint, limits=Limits(between) if k else None))
        legs.append(replace(leg, joints=tuple(joints)))
    spec = replace(plain, legs=tuple(legs))
    c = own(spec, state_at(spec, 3))
    assert_right(c)
    m, wanted = c.model, margins([joint for leg in legs for joint in leg.joints], c.state.q)
    X = np.array([c.state.X, np.full(m.NQ, np.nan), *[c.state.X] * 10])
    found = m.joint_margins(X)
    np.testing.assert_allclose(found[0], wanted, rtol=0, atol=1e-9)
    assert (found[0] < 0.0).any()
    assert np.isnan(found[1]).all()
    np.testing.assert_array_equal(found[2:], np.broadcast_to(found[0], (10, m.NJ)))
    np.testing.assert_array_equal(m.within_limits(X), [0.0, np.nan, *[0.0] * 10])
    names = [n for n in vars(m.Parameters()) if n.endswith("_limits")]
    turned = m.Parameters().replace(**{n: getattr(m.Parameters(), n) + 2.0 * np.pi for n in names})
    joints = [joint for leg in legs for joint in leg.joints if joint.limits]
    full = np.array([joint.kind is JointKind.REVOLUTE and not joint.extra for joint in joints])
    at = np.isfinite(wanted)
    same = np.abs(m.joint_margins(c.state.X, turned)[at] - found[0][at]) < 1e-9
    np.testing.assert_array_equal(same, full)  # where full turns do not count
    wide = {n: np.add(getattr(m.Parameters(), n), [-9.0, 9.0]) for n in names}
    assert m.within_limits(c.state.X, m.Parameters().replace(**wide)) == 1.0


def test_without_limits() -> None:
    m = module(catalogue("planar_3rpr"))
    assert (m.joint_margins(m.HOME_X) == np.inf).all()
    assert m.within_limits(m.HOME_X) == 1.0
    assert np.isnan(m.joint_margins(0.0 * m.HOME_X + np.nan)).all()
    assert np.isnan(m.within_limits(0.0 * m.HOME_X + 1e200))


def test_margins_in_c(tmp_path: Path) -> None:
    slide = Limits((0.1, 0.63))
    plain, legs = catalogue("planar_3rpr"), []
    for leg in plain.legs:
        legs.append(replace(leg, joints=(leg.joints[0], replace(leg.joints[1], limits=slide))))
    spec = checked(replace(plain, legs=tuple(legs)))
    m, library = module(spec), CLibrary(bundle(spec), tmp_path, flags=("-O0",))
    X = np.array(m.HOME_X) + np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [np.nan, 0.0, 0.0]])
    for name in ("joint_margins", "within_limits"):
        wanted = getattr(m, name)(X)
        (found,), status = library.batch(name, X)
        np.testing.assert_allclose(found.reshape(wanted.shape), wanted, atol=1e-13)
        np.testing.assert_array_equal(status, [0, 0, 3])
        (alone,), _ = library.single(name, X[1])
        np.testing.assert_array_equal(alone, found[1])
    assert library.single("within_limits", X[0])[0] == [1.0]
    assert library.single("within_limits", X[1])[0] == [0.0]


@pytest.mark.parametrize("name", entries(2))
def test_poses_moved_and_compared(name: str) -> None:
    """`retract` is the displacement by hand, `difference` its inverse."""
    c = case(name, 2)
    m, rng = c.model, np.random.default_rng(7)
    X = states(c, (6,))["X"]
    steps = rng.uniform(-0.8, 0.8, (6, m.NV))
    moved = m.retract(X, steps)
    for x, step, found in zip(X, steps, moved, strict=True):
        np.testing.assert_allclose(found, displaced(c.spec, x, step), atol=1e-13)
        np.testing.assert_allclose(step_between(c.spec, x, found), step, atol=1e-12)
    np.testing.assert_allclose(m.difference(X, moved), steps, atol=1e-12)
    tiny = 1e-9 * steps
    np.testing.assert_allclose(m.difference(X, m.retract(X, tiny)), tiny, atol=1e-15)
    assert not m.difference(X, X).any()
    for s in (0.0, 0.25, 1.0):
        way = m.interpolate(X, moved, s)
        np.testing.assert_allclose(m.difference(X, way), s * steps, atol=1e-12)


def test_the_shorter_way() -> None:
    m = module(catalogue("stewart"))
    X = np.array(m.HOME_X)
    for angle in (3.0, np.pi - 1e-9, 3.3, 6.0, -5.0):
        turn = np.array([0.0, 0.0, 0.0, 0.48, -0.6, 0.64]) * angle
        moved = m.retract(X, turn)
        found = m.difference(X, moved)
        wrapped = np.remainder(angle + np.pi, 2 * np.pi) - np.pi
        np.testing.assert_allclose(found, turn * (wrapped / angle), atol=1e-7)
        other = moved * np.array([1, 1, 1, -1, -1, -1, -1])
        np.testing.assert_allclose(m.difference(X, other), found, atol=1e-13)
    half = m.difference(X, m.retract(X, [0, 0, 0, 0, 0, np.pi]))
    assert np.linalg.norm(half) == pytest.approx(np.pi, rel=1e-12)
    planar = module(catalogue("planar_3rpr"))
    assert planar.difference([0, 0, 3.0], [0, 0, -3.0])[2] == pytest.approx(2 * np.pi - 6)


def test_rotations_compose_from_the_left() -> None:
    """Base axes: R becomes exp([phi]) R, the origin moves by d alone."""
    m = module(catalogue("stewart"))
    X = m.pose_from_rpy([0.1, 0.2, 0.9], [0.3, -0.2, 0.5])
    moved = m.retract(X, [0.01, 0.02, 0.03, 0.0, 0.0, 0.7])
    c, s = np.cos(0.7), np.sin(0.7)
    turn: Any = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(
        m.rotation(moved), turn @ rotation_from_quaternion(X[3:]), atol=1e-14
    )
    np.testing.assert_allclose(moved[:3] - X[:3], [0.01, 0.02, 0.03], atol=1e-15)
