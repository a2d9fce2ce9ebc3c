"""Truncated Taylor numbers of time: a value with its first two derivatives.

A position or a rotation matrix pushed through these numbers comes out with its exact
velocity and acceleration: there is no step size and no truncation error.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Jet:
    """An array as a function of time, to second order about t = 0.

    All three arrays have the same shape; leading axes may hold several motions.

    Attributes:
        value: at t = 0.
        first: first time derivative.
        second: second time derivative.
    """

    value: Array
    first: Array
    second: Array

    def __add__(self, other: Jet) -> Jet:
        return Jet(self.value + other.value, self.first + other.first, self.second + other.second)

    def __sub__(self, other: Jet) -> Jet:
        return Jet(self.value - other.value, self.first - other.first, self.second - other.second)

    def component(self, index: int) -> Jet:
        """One entry along the last axis."""
        return self.linear(lambda array: array[..., index])

    def linear(self, function: Callable[[Array], Array]) -> Jet:
        """Apply a constant linear function of arrays."""
        return Jet(function(self.value), function(self.first), function(self.second))


def constant(value: Array) -> Jet:
    """A quantity that does not change."""
    return Jet(value, np.zeros_like(value), np.zeros_like(value))


def bilinear(product: Callable[[Array, Array], Array], left: Jet, right: Jet) -> Jet:
    """Product rule to second order for any bilinear `product`."""
    return Jet(
        product(left.value, right.value),
        product(left.first, right.value) + product(left.value, right.first),
        product(left.second, right.value)
        + 2.0 * product(left.first, right.first)
        + product(left.value, right.second),
    )


def apply(matrix: Jet, vector: Jet) -> Jet:
    """Matrix (..., 3, 3) times vector (..., 3)."""
    return bilinear(lambda a, b: np.einsum("...ij,...j->...i", a, b), matrix, vector)


def compose(left: Jet, right: Jet) -> Jet:
    """Matrix (..., 3, 3) times matrix (..., 3, 3)."""
    return bilinear(np.matmul, left, right)


def dot(left: Jet, right: Jet) -> Jet:
    """Scalar product over the last axis: (..., 3), (..., 3) -> (...)."""
    return bilinear(lambda a, b: np.einsum("...i,...i->...", a, b), left, right)


def sine(angle: Jet) -> Jet:
    """Sine of an angle in radians."""
    sin, cos = np.sin(angle.value), np.cos(angle.value)
    return Jet(sin, cos * angle.first, cos * angle.second - sin * angle.first**2)


def cosine(angle: Jet) -> Jet:
    """Cosine of an angle in radians."""
    sin, cos = np.sin(angle.value), np.cos(angle.value)
    return Jet(cos, -sin * angle.first, -sin * angle.second - cos * angle.first**2)


def cross_matrix(vector: Array) -> Array:
    """The matrix (..., 3, 3) whose product with b is `vector` x b."""
    matrix = np.zeros((*vector.shape, 3))
    for row, column, component in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        matrix[..., row, column] = -vector[..., component]
        matrix[..., column, row] = vector[..., component]
    return matrix


def cross_vector(matrix: Array) -> Array:
    """Axial vector (..., 3) of the antisymmetric part of a matrix (..., 3, 3)."""
    difference = 0.5 * (matrix - np.swapaxes(matrix, -1, -2))
    return np.stack([difference[..., 2, 1], difference[..., 0, 2], difference[..., 1, 0]], axis=-1)


def rotation_about(axis: Array, angle: Jet) -> Jet:
    """Rotation matrix (..., 3, 3) about the fixed unit vector `axis` (3,) by `angle` (...)."""
    tilde = cross_matrix(axis)
    sin, cos = sine(angle), cosine(angle)
    swing = sin.linear(lambda s: s[..., None, None] * tilde)
    # 1 - cos: the constant enters the value only.
    bend = cos.linear(lambda c: -c[..., None, None] * (tilde @ tilde))
    return constant(np.broadcast_to(np.eye(3) + tilde @ tilde, swing.value.shape)) + swing + bend


def angular_velocity(rotation: Jet) -> Array:
    """Angular velocity (..., 3) of a rotation matrix (..., 3, 3), fixed axes, rad/s."""
    return cross_vector(rotation.first @ np.swapaxes(rotation.value, -1, -2))


def angular_acceleration(rotation: Jet) -> Array:
    """Angular acceleration (..., 3) of a rotation matrix, fixed axes, rad/s^2.

    R'' R^T = [alpha] + [omega]^2, and the square is symmetric.
    """
    return cross_vector(rotation.second @ np.swapaxes(rotation.value, -1, -2))
