"""Rotations and poses: the contract's conventions, written out."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.models import catalogue, module
from tests.oracle.coordinates import displaced, platform_rotation
from tests.sampling import entries
from tests.whole.cases import Array

QUATERNION = ("spherical_3ups", "stewart", "stewart_sps", "tripod_3rps")
PLANAR = ("planar_3rpr", "planar_redundant", "fivebar_offset")
HALF_TURNS = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.8, 0.0])


def about(axis: int, angle: float) -> Array:
    """Rotation matrix about a coordinate axis."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R = np.eye(3)
    R[[i, j], [i, j]] = np.cos(angle)
    R[j, i], R[i, j] = np.sin(angle), -np.sin(angle)
    return R


def place(model: Any) -> Array:
    """A position, as long as the space has one."""
    return np.array([0.1, -0.2, 0.7])[: 3 if model.NW == 6 else 0]


@pytest.mark.parametrize("name", entries())
def test_where_the_space_has_rotation(name: str) -> None:
    model, turns = (
        module(catalogue(name)),
        catalogue(name).space.value in ("planar", "spatial", "spherical"),
    )
    assert hasattr(model, "rotation") == hasattr(model, "pose") == hasattr(model, "X_dot") == turns
    assert hasattr(model, "pose_from_rpy") == (turns and catalogue(name).space.value != "planar")


@pytest.mark.parametrize("name", QUATERNION)
def test_roll_pitch_yaw_are_about_fixed_axes(name: str) -> None:
    model = module(catalogue(name))
    roll, pitch, yaw = rpy = (0.3, -0.7, 2.4)
    X = model.pose_from_rpy(place(model), rpy)
    assert X.shape == (model.NQ,)
    assert np.array_equal(X[: place(model).size], place(model))
    assert not X[place(model).size + 4 :].any()
    R = about(2, yaw) @ about(1, pitch) @ about(0, roll)
    assert np.abs(model.rotation(X) - R).max() < 1e-15
    assert np.abs(platform_rotation(catalogue(name), X) - R).max() < 1e-15
    quarter = model.pose_from_rpy(place(model), [0.0, 0.0, np.pi / 2])[place(model).size :][:4]
    assert np.abs(quarter - [0.0, 0.0, 0.5**0.5, 0.5**0.5]).max() < 1e-15  # scalar last


@pytest.mark.parametrize("name", QUATERNION)
def test_pose_and_rotation_are_inverse(name: str) -> None:
    """Also for half turns, where three of four formulas for a quaternion fail."""
    model, rng = module(catalogue(name)), np.random.default_rng(1)
    quaternions = rng.normal(size=(40, 4))
    quaternions[:4] = np.column_stack([HALF_TURNS, np.zeros(4)])
    X = np.tile(np.array(model.HOME_X), (40, 1))
    first = place(model).size
    X[:, first : first + 4] = quaternions
    R = model.rotation(X)
    assert np.abs(R @ np.swapaxes(R, 1, 2) - np.eye(3)).max() < 1e-15 * 10
    assert np.abs(np.linalg.det(R) - 1.0).max() < 1e-14
    again = model.pose(X[:, :first], R)
    assert np.abs(np.linalg.norm(again[:, first : first + 4], axis=1) - 1.0).max() < 1e-15 * 4
    assert np.abs(model.rotation(again) - R).max() < 1e-14


@pytest.mark.parametrize("name", QUATERNION)
def test_quaternions_are_normalised_on_entry(name: str) -> None:
    """Length and sign of a quaternion do not matter to any function."""
    model = module(catalogue(name))
    X, V = np.array(model.HOME_X), np.linspace(-1.0, 1.0, model.NV)
    first = place(model).size
    X[first : first + 4] = model.pose_from_rpy(place(model), [0.1, -0.05, 0.08])[first : first + 4]
    for factor in (-1.0, 3.0, 1e-3):
        other = X.copy()
        other[first : first + 4] *= factor
        for found, expected in zip(model.dynamics(other, V), model.dynamics(X, V), strict=True):
            assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()
        assert np.abs(model.rotation(other) - model.rotation(X)).max() < 1e-15


@pytest.mark.parametrize("name", [*QUATERNION, *PLANAR])
def test_x_dot(name: str) -> None:
    """The derivative of X, angular velocity in base axes."""
    spec, model, h = catalogue(name), module(catalogue(name)), 1e-6
    X, V = np.array(model.HOME_X), np.linspace(-1.0, 1.3, model.NV)
    if name in QUATERNION:
        first = place(model).size
        X[first : first + 4] = model.pose_from_rpy(place(model), [0.4, -0.5, 0.8])[
            first : first + 4
        ]
    rate = (displaced(spec, X, h * V) - displaced(spec, X, -h * V)) / (2 * h)
    assert np.abs(model.X_dot(X, V) - rate).max() < 1e-9


@pytest.mark.parametrize("name", PLANAR)
def test_in_the_plane(name: str) -> None:
    model = module(catalogue(name))
    X = model.pose([0.1, 0.2], about(2, 2.5)[:2, :2])
    assert np.abs(X - [0.1, 0.2, 2.5, *[0.0] * (model.NQ - 3)]).max() < 1e-15
    assert np.abs(model.rotation(X) - about(2, 2.5)[:2, :2]).max() < 1e-15


def test_without_a_position() -> None:
    """About a fixed centre a pose is a rotation: no position is given."""
    model = module(catalogue("spherical_3ups"))
    X = model.pose(None, about(0, 0.3))
    assert np.abs(X - [np.sin(0.15), 0.0, 0.0, np.cos(0.15)]).max() < 1e-15
    assert np.abs(model.pose_from_rpy(None, [0.3, 0.0, 0.0]) - X).max() < 1e-15


@pytest.mark.parametrize("name", QUATERNION)
def test_rotation_is_orthogonal_for_all_lengths(name: str) -> None:
    model, rng, first = module(catalogue(name)), np.random.default_rng(3), 0
    first = place(model).size
    X = np.tile(np.array(model.HOME_X), (3000, 1))
    X[:, first : first + 4] = rng.normal(size=(3000, 4)) * 10.0 ** rng.uniform(-307, 153, (3000, 1))
    R = model.rotation(X)
    assert np.abs(R @ np.swapaxes(R, 1, 2) - np.eye(3)).max() < 1e-15
    assert np.abs(np.linalg.det(R) - 1.0).max() < 1e-14
    q = X[:, first : first + 4] / np.abs(X[:, first : first + 4]).max(axis=1, keepdims=True)
    X[:, first : first + 4] = q
    assert np.abs(model.rotation(X) - R).max() < 1e-14
    for length, good in ((1e-161, True), (5e-324, True), (0.0, False), (1.4e154, False)):
        X[0, first : first + 4] = [0.0, length, 0.0, 0.0]
        assert np.array_equal(model.rotation(X[0]), np.diag([-1.0, 1.0, -1.0])) == good
        assert np.isnan(model.rotation(X[0])).all() != good


@pytest.mark.parametrize("name", [*QUATERNION, "planar_3rpr"])
def test_the_nearest_rotation(name: str) -> None:
    """That of least sum of squares: no small turn of it is nearer; on request alone."""
    model, rng = module(catalogue(name)), np.random.default_rng(8)
    n = model.rotation(model.HOME_X).shape[0]
    t = place(model) if n == 3 else np.zeros(2)
    turns = [about(k, s * 1e-4)[:n, :n] for k in ((0, 1, 2) if n == 3 else (2,)) for s in (-1, 1)]
    noise = rng.normal(size=(50, n, n))
    noise[:20] = np.eye(n) + 0.1 * noise[:20]
    with pytest.raises(ValueError, match="pose: R is no rotation matrix, with orthonormal rows to"):
        model.pose(t, noise)
    with pytest.raises(TypeError):
        model.pose(t, noise, True)
    for R in noise:
        found = model.rotation(model.pose(t, R, nearest=True))
        assert np.abs(found @ found.T - np.eye(n)).max() < 1e-14
        assert np.linalg.det(found) > 0.0
        distance = np.linalg.norm(found - R)
        assert all(np.linalg.norm(turn @ found - R) > distance for turn in turns)
    again = model.rotation(model.pose(t, noise, nearest=True))
    assert (
        np.abs(again - [model.rotation(model.pose(t, R, nearest=True)) for R in noise]).max()
        < 1e-14
    )
    assert (
        np.abs(model.pose(t, 2.0 * np.eye(n), nearest=True) - model.pose(t, np.eye(n))).max()
        < 1e-15
    )
    several = [np.zeros((n, n)), np.diag([1.0] * (n - 1) + [-1.0])]
    several += [-np.eye(3)] if n == 3 else []
    for R in several:
        with pytest.raises(ValueError, match="pose: R has no single nearest rotation"):
            model.pose(t, R, nearest=True)


@pytest.mark.parametrize("name", ["stewart", "planar_3rpr"])
def test_poses_in_batches(name: str) -> None:
    """NaN in the rows of what is not finite; an error where a rotation is none."""
    model = module(catalogue(name))
    good = model.rotation(model.HOME_X)
    R = np.tile(good, (4, 1, 1))
    R[1, 0, 0] = np.nan
    t = np.zeros(3 if len(good) == 3 else 2)
    for nearest in (False, True):
        np.testing.assert_array_equal(
            np.isnan(model.pose(t, R, nearest=nearest)).any(axis=1), [False, True, False, False]
        )
    R[2] *= 1.01
    with pytest.raises(ValueError, match="pose: R is no rotation matrix"):
        model.pose(t, R)
    for wrong in (np.eye(4), np.ones(3), np.float64(2.0)):
        with pytest.raises(ValueError, match=r"pose: R has shape .*, expected \(\.\.\., "):
            model.pose(t, wrong)
    assert model.pose(t, np.empty((0, *good.shape))).shape == (0, model.NQ)
