"""Impossible states: every output of the call is NaN for that state, others are untouched.

A cause counts only where the function needs it.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from tests.models import catalogue, module
from tests.oracle.coordinates import displaced, platform_position, platform_rotation
from tests.whole.calls import Outputs, Vectors, call, functions, states
from tests.whole.cases import Array, Case, case
from tests.whole.test_batches import CASES

FEW, MANY = 3, 12  # computed one by one, and as arrays
OF_THE_LEGS = (
    "inverse_kinematics", "joint_rates", "joint_accelerations", "leg_reactions", "energy",
    "M", "Z", "H", "dynamics", "inverse_dynamics", "forward_dynamics", "forward_kinematics",
)  # fmt: skip
"""What needs the displacements of the legs."""
UNREACHABLE = (
    "delta",
    "fivebar_revolute",
    "hexaglide",
    "hexapod_6x6r",
    "hybrid_3rrrs",
    "tripod_3prs",
)


def is_needed(c: Case, function: str, argument: str) -> bool:
    """Not where nothing is to be completed, no forces without effect are spanned, nothing rubs."""
    if function == "dissipation":
        return any(joint.friction for leg in c.spec.legs for joint in leg.joints)
    if function == "complete_acceleration":
        return argument == "A" or c.spec.name == "stewart_sps"
    return function != "null_space" or c.model.NU > c.model.NV


def spoilt(vectors: Vectors, argument: str, row: int, value: float) -> Vectors:
    """One entry of an argument in one row replaced."""
    changed = vectors[argument].copy()
    entries = changed.reshape(len(changed), -1)
    entries[row, entries.shape[1] // 2] = value
    return vectors | {argument: changed}


def assert_only(before: Outputs, after: Outputs, row: int, message: str) -> None:
    """All outputs of a row are NaN, all others what they were."""
    for good, found in zip(before, after, strict=True):
        assert np.isnan(found[row]).all(), message
        others = np.delete(np.arange(len(good)), row)
        assert np.array_equal(found[others], good[others]), message


@pytest.mark.parametrize("count", [FEW, MANY])
@pytest.mark.parametrize("name", CASES)
def test_input_that_is_not_finite(name: str, count: int) -> None:
    c = case(name, 1)
    vectors = states(c, (count,))
    for function, arguments in functions(c.model).items():
        before = call(c, function, vectors)
        for argument in arguments:
            if vectors[argument][0].size and is_needed(c, function, argument):
                for value in (np.nan, np.inf):
                    wrong = spoilt(vectors, argument, 1, value)
                    message = f"{function}, {argument} = {value}"
                    assert_only(before, call(c, function, wrong), 1, message)


@pytest.mark.parametrize("count", [FEW, MANY])
@pytest.mark.parametrize("name", ["spherical_3ups", "stewart"])
def test_a_quaternion_of_no_length_or_too_long(name: str, count: int) -> None:
    """Its squared length vanishes, or overflows; shorter ones need not be normalised."""
    c = case(name, 1)
    vectors = states(c, (count,))
    start = 3 if name == "stewart" else 0
    for function in (*OF_THE_LEGS[:-1], "rotation"):
        before = call(c, function, vectors)
        for factor in (0.0, 1e160, 1e100):
            X = vectors["X"].copy()
            X[1, start : start + 4] *= factor
            found = call(c, function, vectors | {"X": X})
            if factor == 1e100:
                assert all(np.isfinite(value).all() for value in found), function
            else:
                assert_only(before, found, 1, f"{function}, {factor}")


@pytest.mark.parametrize("count", [FEW, MANY])
@pytest.mark.parametrize("name", UNREACHABLE)
def test_a_leg_that_does_not_reach(name: str, count: int) -> None:
    """The platform tens of metres off: no function has a value there."""
    c = case(name, 1)
    vectors = states(c, (count,))
    far = vectors["X"].copy()
    far[1, 0] += 30.0
    outside = vectors | {"X": far, "X0": np.where(far == vectors["X"], vectors["X0"], far)}
    for function in OF_THE_LEGS:
        before = call(c, function, vectors)
        assert_only(before, call(c, function, outside), 1, function)


@pytest.mark.parametrize("name", ["delta", "fivebar_revolute", "hybrid_3rrrs"])
def test_actuators_that_no_pose_fits(name: str) -> None:
    """Forward kinematics fails rather than giving the nearest pose."""
    c = case(name, 1)
    vectors = states(c, (FEW,))
    before = call(c, "forward_kinematics", vectors)
    asked = vectors["q_actuated"].copy()
    asked[1] += np.where(np.arange(c.model.NU) % 2, 2.0, -2.0)
    found = call(c, "forward_kinematics", vectors | {"q_actuated": asked})
    assert_only(before, found, 1, name)


@pytest.mark.parametrize("count", [FEW, MANY])
@pytest.mark.parametrize("name", ["fivebar_revolute", "planar_3rpr", "stewart", "tripod_3ups"])
def test_a_singular_leg(name: str, count: int) -> None:
    """The first leg stretched, or its slide of no length; close by all is well."""
    c = case(name, 1)
    vectors = states(c, (count,))
    before = {function: call(c, function, vectors) for function in OF_THE_LEGS}
    for off, singular in ((0.0, True), (1e-3, False)):
        X = vectors["X"].copy()
        X[1] = _pose_with_first_leg_singular(c, X[1], off)
        for function in OF_THE_LEGS[:-1]:  # forward kinematics starts elsewhere
            found = call(c, function, vectors | {"X": X})
            if singular:
                assert_only(before[function], found, 1, function)
            assert all(np.isfinite(value).all() for value in found) != singular, function


def _pose_with_first_leg_singular(c: Case, X: Array, off: float) -> Array:
    leg = c.spec.legs[0]
    arm = platform_rotation(c.spec, X) @ np.array(leg.platform_point)
    base = np.array(leg.base_point)
    step = base - platform_position(c.spec, X) - arm
    step *= 1.0 + off
    if c.spec.name == "fivebar_revolute":
        # At its reach itself displacements exist, and rounding decides on the rest.
        reach = (1.0 - off if off else 1.0 + 1e-12) * (
            leg.joints[1].offset[0] + leg.platform_joint.offset[0]
        )
        step -= reach * step / np.linalg.norm(step)
    step.resize(c.model.NV)
    return displaced(c.spec, X, step)


@pytest.mark.parametrize("name", ["planar_3rpr", "stewart"])
def test_singular_actuators(name: str) -> None:
    """Where det H = 0 inverse dynamics fails; M, Z, H and forward dynamics do not."""
    model = module(catalogue(name))
    X = pose_of_singular_actuators(model)
    V, tau = np.linspace(-1.0, 1.0, model.NV), np.linspace(-5.0, 9.0, model.NU)
    for count in (1, MANY):
        poses = np.tile(np.array(model.HOME_X), (count, 1))
        poses[count // 2] = X
        found = model.inverse_dynamics(poses, V, V)
        bad = np.isnan(found)
        assert bad[count // 2].all()
        assert bad.sum() == model.NU
        assert np.isnan(model.leg_reactions(poses, V, V)[count // 2]).all()
        assert all(np.isfinite(value).all() for value in model.dynamics(poses, V))
        assert np.isfinite(model.forward_dynamics(poses, V, tau)).all()


def pose_of_singular_actuators(model: Any) -> Array:
    """From home about the vertical: where the determinant of H changes its sign."""

    def turned(yaw: float) -> Array:
        if model.NQ == 3:
            return np.asarray(model.HOME_X + np.array([0.05, 0.03, yaw]))
        return np.asarray(model.pose_from_rpy(model.HOME_X[:3], [0.0, 0.0, yaw]))

    def determinant(yaw: float) -> float:
        return float(np.linalg.det(model.H(turned(yaw))))

    grid = np.linspace(0.0, 3.0, 301)
    signs = np.sign([determinant(yaw) for yaw in grid])
    change = int(np.flatnonzero(np.diff(signs))[0])
    low, high, start = grid[change], grid[change + 1], signs[change]
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.sign(determinant(middle)) == start else (low, middle)
    return turned(low)


@pytest.mark.parametrize("name", ["planar_3rpr", "stewart", "tripod_3rps"])
def test_no_inertia(name: str) -> None:
    """Without masses M, or the KKT matrix, is singular: forward dynamics alone fails."""
    model = module(catalogue(name))
    p = model.Parameters()
    empty = p.replace(
        **{n: 0.0 * getattr(p, n) for n in vars(p) if n.endswith(("mass", "inertia"))}
    )
    still, tau = np.zeros(model.NV), np.ones(model.NU)
    for lead in ((), (MANY,)):
        X = np.broadcast_to(model.HOME_X, (*lead, model.NQ))
        accelerations = _all(model.forward_dynamics(X, still, tau, empty))
        forces = _all(model.inverse_dynamics(X, still, still, empty))
        assert not np.any(model.M(X, empty))
        assert np.isnan(accelerations).all()
        assert np.array_equal(forces, np.zeros_like(forces))


def _all(result: Any) -> Array:
    return np.concatenate(result if isinstance(result, tuple) else (result,), axis=None)


@pytest.mark.parametrize("name", CASES)
def test_wrong_shapes_are_named(name: str) -> None:
    """The message tells the argument, what is expected and what was given."""
    c = case(name, 1)
    vectors = states(c, (2,))
    for function, arguments in functions(c.model).items():
        for argument in arguments:
            if argument == "s":  # a number has no dimensions of its own
                continue
            size = vectors[argument].shape[-1]
            wrong = vectors | {argument: np.zeros((*vectors[argument].shape[:-1], size + 1))}
            expected = (
                "(..., " + ("2, 2)" if size == 2 else "3, 3)")
                if argument == "R"
                else f"(..., {size})"
            )
            message = rf"{argument} has shape {wrong[argument].shape}, expected {expected}"
            with pytest.raises(ValueError, match=re.escape(message)):
                call(c, function, wrong)
            with pytest.raises(ValueError, match=rf"{argument} has shape \(\), expected"):
                call(c, function, vectors | {argument: np.array(0.5)})
