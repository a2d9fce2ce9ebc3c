"""Truncated Taylor numbers of time: a value with its first two derivatives.

A position or a rotation matrix pushed through these numbers comes out with its exact
velocity and acceleration: there is no step size and no truncation error.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from pne_sym.model.manipulator import Vector3

Array = NDArray[np.float64]


class Jet:
    """An array as a function of time, to second order about t = 0.

    Leading axes of the three may hold several motions.

    Attributes:
        terms: (3, ...) the value and its first two time derivatives at t = 0.
    """

    __slots__ = ("terms",)

    def __init__(self, terms: Array) -> None:
        self.terms = terms

    @property
    def value(self) -> Array:
        """At t = 0."""
        value: Array = self.terms[0]
        return value

    @property
    def first(self) -> Array:
        """First time derivative."""
        first: Array = self.terms[1]
        return first

    @property
    def second(self) -> Array:
        """Second time derivative."""
        second: Array = self.terms[2]
        return second

    def __add__(self, other: Jet) -> Jet:
        return Jet(self.terms + other.terms)

    def __sub__(self, other: Jet) -> Jet:
        return Jet(self.terms - other.terms)

    def component(self, index: int) -> Jet:
        """One entry along the last axis."""
        return Jet(self.terms[..., index])

    def linear(self, function: Callable[[Array], Array]) -> Jet:
        """Apply a constant linear function of arrays with any leading axes."""
        return Jet(function(self.terms))


def taylor(value: Array, first: Array, second: Array) -> Jet:
    """A value with its derivatives, which have all leading axes."""
    terms = np.empty((3, *first.shape))
    terms[0], terms[1], terms[2] = value, first, second
    return Jet(terms)


def constant(value: Array, shape: tuple[int, ...] = ()) -> Jet:
    """A quantity that does not change, with these leading axes."""
    terms = np.zeros((3, *shape, *np.shape(value)))
    terms[0] = value
    return Jet(terms)


def bilinear(product: Callable[[Array, Array], Array], left: Jet, right: Jet) -> Jet:
    """Product rule to second order for any bilinear `product` of arrays with any leading axes."""
    both = product(left.terms[_LEFT], right.terms[_RIGHT])
    return taylor(both[0], both[1] + both[2], both[3] + 2.0 * both[4] + both[5])


_LEFT = [0, 1, 0, 2, 1, 0]
_RIGHT = [0, 0, 1, 0, 1, 2]
"""The derivatives of the factors in a product's value, first and second derivative."""


def compose(left: Jet, right: Jet) -> Jet:
    """Matrix (..., 3, 3) times matrix (..., 3, 3)."""
    return bilinear(np.matmul, left, right)


def dot(left: Jet, right: Jet) -> Jet:
    """Scalar product over the last axis: (..., 3), (..., 3) -> (...)."""
    return bilinear(lambda a, b: (a * b).sum(axis=-1), left, right)


def scaled(vector: Jet, factor: Jet) -> Jet:
    """Vector (..., 3) times scalar (...)."""
    return bilinear(lambda a, b: a * b[..., None], vector, factor)


def apply(matrix: Jet, vector: Jet) -> Jet:
    """Matrix (..., 3, 3) times vector (..., 3)."""
    return bilinear(lambda a, b: (a @ b[..., None])[..., 0], matrix, vector)


def cross_matrix(vector: Array) -> Array:
    """The matrix (..., 3, 3) whose product with b is `vector` x b."""
    matrix = np.zeros((*vector.shape, 3))
    matrix[..., _COLUMNS, _ROWS] = vector
    matrix[..., _ROWS, _COLUMNS] = -vector
    return matrix


_ROWS = [1, 2, 0]
_COLUMNS = [2, 0, 1]
"""Where a cross product's matrix has minus the components of its vector, in their order."""


def cross(left: Array, right: Array) -> Array:
    """Cross product over the last axis, of (..., 3) and (..., 3)."""
    product: Array = left[..., _ROWS] * right[..., _COLUMNS]
    product -= left[..., _COLUMNS] * right[..., _ROWS]
    return product


def cross_vector(matrix: Array) -> Array:
    """Axial vector (..., 3) of the antisymmetric part of a matrix (..., 3, 3)."""
    vector: Array = 0.5 * (matrix[..., _COLUMNS, _ROWS] - matrix[..., _ROWS, _COLUMNS])
    return vector


def rotation_about(axis: Vector3, angle: Jet) -> Jet:
    """Rotation matrix (..., 3, 3) about the fixed unit vector `axis` by `angle` (...), rad."""
    tilde, square = _powers(axis)
    sin, cos = np.sin(angle.value), np.cos(angle.value)
    rate, square_of_rate = angle.first, angle.first**2
    swing = taylor(sin, cos * rate, cos * angle.second - sin * square_of_rate).terms
    bend = taylor(-cos, sin * rate, sin * angle.second + cos * square_of_rate).terms
    bend[0] += 1.0
    return Jet(swing[..., None, None] * tilde + bend[..., None, None] * square + _at_rest(swing))


@cache
def _powers(axis: Vector3) -> tuple[Array, Array]:
    tilde = cross_matrix(np.array(axis, dtype=float))
    return tilde, tilde @ tilde


def _at_rest(like: Array) -> Array:
    """No rotation, with the leading axes of other terms."""
    terms = np.zeros((*like.shape, 3, 3))
    terms[0] = np.eye(3)
    return terms


def angular_velocity(rotation: Jet) -> Array:
    """Angular velocity (..., 3) of a rotation matrix (..., 3, 3), fixed axes, rad/s."""
    return cross_vector(rotation.first @ np.swapaxes(rotation.value, -1, -2))


def angular_acceleration(rotation: Jet) -> Array:
    """Angular acceleration (..., 3) of a rotation matrix, fixed axes, rad/s^2.

    R'' R^T = [alpha] + [omega]^2, and the square is symmetric.
    """
    return cross_vector(rotation.second @ np.swapaxes(rotation.value, -1, -2))
