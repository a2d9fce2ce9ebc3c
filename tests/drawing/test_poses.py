"""Poses as they are typed, and the closures at which mechanisms are drawn."""

from __future__ import annotations

import math

import numpy as np
import pytest

import pne_sym
from pne_sym import manipulators
from pne_sym.drawing.poses import CLOSED, closed, pose_of
from pne_sym.generation import InputError
from pne_sym.model.kinematics import pose_at
from pne_sym.model.loops import Loops
from pne_sym.model.rotation import rotation_from_rpy
from tests.sampling import entries, sampled


def test_roll_pitch_yaw_about_the_fixed_axes() -> None:
    model = manipulators.load("stewart")
    rng = np.random.default_rng(3)
    for _ in range(20):
        t, rpy = rng.uniform(-1, 1, 3), rng.uniform(-math.pi, math.pi, 3)
        pose = pose_at(model.space, pose_of(model, [*t, *rpy]), None)
        np.testing.assert_allclose(pose.R, np.array(rotation_from_rpy(tuple(rpy))), atol=1e-12)
        np.testing.assert_array_equal(pose.t, t)


@pytest.mark.parametrize("name", entries())
def test_home_in_every_form(name: str) -> None:
    """X itself is taken as it is; where there are fewer numbers, angles stand for a quaternion."""
    model = manipulators.load(name)
    X = list(model.home.X)
    assert pose_of(model, X) == X
    q = closed(model, X, None).q
    np.testing.assert_allclose(q, model.home.q, atol=1e-9)
    for size in range(len(X) + 3):
        forms = {len(X)} | ({len(X) - 1} if model.space in {"spatial", "spherical"} else set())
        if size not in forms:
            with pytest.raises(InputError, match=r"numbers \(.*\) are needed, not "):
                pose_of(model, [0.0] * size)


def test_numbers_that_are_not_finite() -> None:
    with pytest.raises(InputError, match="are needed, not 3"):
        pose_of(manipulators.load("planar_3rpr"), [0.0, math.inf, 0.0])


@pytest.mark.parametrize("factor", [2.0, -1.0, 1e-200, 1e200])
def test_a_quaternion_of_any_length_and_sign(factor: float) -> None:
    model = manipulators.load("stewart")
    X = pose_of(model, [0.05, 0.0, 0.8, 0.2, -0.1, 0.4])
    same = closed(model, [*X[:3], *(factor * x for x in X[3:])], None)
    np.testing.assert_allclose(same.q, closed(model, X, None).q, atol=1e-9)


@pytest.mark.parametrize(
    "name", sampled(["stewart", "hexapod_6rus", "hexaglide", "planar_3rrr", "delta"], 3)
)
def test_the_branch_is_that_of_the_generated_inverse_kinematics(name: str) -> None:
    """Displacements are those that the generated code, which stays on home's branch, gives."""
    model = manipulators.load(name)
    namespace: dict[str, object] = {"__name__": name}
    exec(compile(pne_sym.compile_model(model)[f"{name}.py"], name, "exec"), namespace)
    rng = np.random.default_rng(5)
    for _ in range(3):
        X = np.array(model.home.X) + 0.03 * rng.uniform(-1, 1, len(model.home.X))
        found = closed(model, X.tolist(), None)
        expected = namespace["inverse_kinematics"](found.X)
        np.testing.assert_allclose(np.cos(found.q - expected), 1.0, atol=1e-9)
        loops = Loops(model.space, model.legs, model.fixed_centre)
        assert max(loops.residuals(found.X, expected)) < CLOSED


def test_a_first_guess_chooses_the_assembly() -> None:
    """An elbow given on the other side stays there."""
    model = manipulators.load("planar_3rrr")
    home = closed(model, None, None)
    turned = home.q.copy()
    turned[1] = -turned[1]
    other = closed(model, None, turned.tolist())
    np.testing.assert_array_equal(other.X, home.X)
    assert other.q[1] * home.q[1] < 0.0
    np.testing.assert_allclose(other.q[3:], home.q[3:], atol=1e-9)


def test_where_legs_constrain_the_platform_the_message_says_what_helps() -> None:
    with pytest.raises(InputError, match=r"3 constraints on the platform; project\(\)"):
        closed(manipulators.load("tripod_3rps"), [0.2, 0.0, 0.8, 0.0, 0.0, 0.3, 0.9], None)
