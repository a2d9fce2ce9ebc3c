"""Rotations and poses: the contract's conventions, written out."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.models import catalogue, module
from tests.oracle.coordinates import displaced, platform_rotation
from tests.whole.cases import Array
from tests.whole.supported import SUPPORTED

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


@pytest.mark.parametrize("name", SUPPORTED)
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
