"""How the displacements of a leg's joints are found."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import sympy as sp

from pne_sym.vector import Vector, ZeroVector


class Branch(NamedTuple):
    """A root whose sign is that of home.

    Attributes:
        symbol: the sign's symbol.
        joint: joint number.
        root: expression with the sign that the branch has (uses the true
            cosine and sine, or displacement, of the joint).
        power: of a length that the root is.
    """

    symbol: sp.Symbol
    joint: int
    root: Any
    power: int


class Resolved(NamedTuple):
    """The vector to the connection point in the canonical axes that a joint opens.

    Attributes:
        group: number of that joint.
        parts: along x, y, z.
    """

    group: int
    parts: tuple[Any, Any, Any]

    def along(self, direction: Sequence[Any]) -> Any:
        """Component along a direction given in these axes."""
        return sp.Add(*(d * part for d, part in zip(direction, self.parts, strict=True)))


class InverseKinematics(NamedTuple):
    """How each joint of a leg is found.

    Attributes:
        q: displacement symbols by joint.
        methods: joint -> "linear", "sphere", "direct", "given" or "numeric".
        reasons: why a joint has no closed form.
        branches: roots whose sign is that of home.
        x: from the origin of a joint to the connection point, seen from the base.
        S: from the base point to the connection point.
        swings: all joints that turn swing the connection point in a plane across their axes, so
            that its components there give their angles.
    """

    q: dict[int, Any]
    methods: dict[int, str]
    reasons: dict[int, str]
    branches: list[Branch]
    x: dict[int, Vector]
    S: Vector = ZeroVector
    swings: bool = False

    @property
    def is_closed(self) -> bool:
        """Whether every joint has a closed form."""
        return not self.reasons
