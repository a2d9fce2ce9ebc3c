"""A base that moves: poses relative to it as functions of time, seen from space."""

from __future__ import annotations

import inspect
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from pne_sym.model.manipulator import Manipulator
from tests.oracle.coordinates import Pose, cross_matrix, is_planar
from tests.oracle.jets import Array, Jet, apply, compose


@dataclass(frozen=True)
class Base:
    """Motion of the base at one instant, in its axes.

    Attributes:
        rotation: (3, 3) world_R_base.
        spin: (3,) angular velocity.
        spin_rate: (3,) angular acceleration.
        acceleration: (3,) of its origin, without gravity.
    """

    rotation: Array
    spin: Array
    spin_rate: Array
    acceleration: Array

    def carries(self, pose: Pose) -> Pose:
        """A pose relative to the base, in the space of which these are now the axes."""
        lead = pose.origin.value.shape[:-1]
        w = cross_matrix(self.spin)
        turn = np.stack([np.eye(3), w, cross_matrix(self.spin_rate) + w @ w])
        way = np.stack([np.zeros(3), np.zeros(3), self.acceleration])
        ones = [1] * len(lead)
        rotation, origin = Jet(turn.reshape(3, *ones, 3, 3)), Jet(way.reshape(3, *ones, 3))
        return Pose(origin + apply(rotation, pose.origin), compose(rotation, pose.rotation))

    @property
    def given(self) -> tuple[Array, Array, Array, Array]:
        """As functions take it."""
        return self.rotation, self.spin, self.spin_rate, self.acceleration

    @property
    def flat(self) -> Array:
        """The same 18 numbers, as C takes them."""
        return np.concatenate([part.ravel() for part in self.given])


REST = Base(np.eye(3), np.zeros(3), np.zeros(3), np.zeros(3))


def base_of(manipulator: Manipulator) -> Base:
    """Any motion of the base of a mechanism that has one; else at rest."""
    if not manipulator.moving_base:
        return REST
    turns, moves = np.array([0.3, -0.5, 0.8]), np.array([3.0, -4.0, 2.0])
    if is_planar(manipulator.space):
        turns, moves = turns * (0.0, 0.0, 1.0), moves * (1.0, 1.0, 0.0)
    return Base(rotation_of(turns), -1.7 * turns[::-1] if turns[0] else turns, 4.0 * turns, moves)


def rotation_of(vector: Array) -> Array:
    """Rotation matrix of a rotation vector."""
    angle = float(np.linalg.norm(vector))
    n = cross_matrix(vector / angle)
    return np.asarray(np.eye(3) + np.sin(angle) * n + (1.0 - np.cos(angle)) * n @ n)


class Carried:
    """A generated module whose functions are called with this motion of the base."""

    def __init__(self, module: Any, base: Base) -> None:
        self._module, self._base = module, base

    def __getattr__(self, name: str) -> Any:
        member = getattr(self._module, name)
        if inspect.isfunction(member) and "base" in inspect.signature(member).parameters:
            return partial(member, base=self._base.given)
        return member
