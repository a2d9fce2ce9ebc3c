"""What names stand for: quantities, what is given, frames."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import Any


class Role(enum.StrEnum):
    """What a quantity is in the mechanics, where other stages need to know it."""

    POSITION = "position of the platform origin"
    VELOCITY = "velocity of the platform origin"
    ACCELERATION = "acceleration of the platform origin"
    ROTATION = "rotation of the platform"
    ANGULAR_VELOCITY = "angular velocity of the platform"
    ANGULAR_ACCELERATION = "angular acceleration of the platform"
    GRAVITY = "acceleration of gravity"
    BASE_ROTATION = "rotation from base axes to world axes"
    BASE_ANGULAR_VELOCITY = "angular velocity of the base"
    BASE_ANGULAR_ACCELERATION = "angular acceleration of the base"
    BASE_ACCELERATION = "acceleration of the base origin, without gravity"
    POINT = "from the leg's base point to its connection point"
    POINT_VELOCITY = "velocity of the connection point"
    POINT_ACCELERATION = "acceleration of the connection point"
    COLLECTED_ACCELERATION = "that acceleration without its centripetal part"
    BIAS = "acceleration of the connection point without joint accelerations"
    DISPLACEMENT = "displacement of a joint"
    RATE = "rate of a joint"
    JOINT_ACCELERATION = "acceleration of a joint"
    RECIPROCAL = "reciprocal vector of a joint"
    RESOLVED = "vector beyond a joint, resolved along its link"
    LEG_INERTIA = "coefficient of the acceleration in a leg's force"
    LEG_BIAS = "remainder of a leg's force"


@dataclass(frozen=True)
class Quantity:
    """What a name stands for.

    Attributes:
        name: unique within the derivation; the stem of the names in the code.
        latex: how the report writes it.
        meaning: in words.
        unit: SI unit, or "-".
        body: name of the body in which the vector or tensor is naturally
            observed (a hint for the lowering, nothing else depends on it).
        parameter: the quantity is a parameter or made of parameters alone.
        role: what it is in the mechanics, where other stages ask for it.
        leg_type: the leg type that has it, or "" for the platform's.
        joint: the joint that it belongs to, from 1; 0 for none.
        remainder_of: the quantity whose remainder (Eq. 4) it is, or "".
    """

    name: str
    latex: str
    meaning: str
    unit: str = "-"
    body: str | None = None
    parameter: bool = False
    role: Role | None = None
    leg_type: str = ""
    joint: int = 0
    remainder_of: str = ""


@dataclass(frozen=True)
class Given:
    """A vector, tensor or scalar that is given: parameter, constant or state.

    Attributes:
        symbol: the symbol.
        frame: name of the frame in which the components are given ("" for scalars).
        components: SymPy symbols and numbers; 1, 3 or 9 (row by row).
    """

    symbol: Any
    frame: str
    components: tuple[Any, ...]


PLATFORM = "platform"
"""Name of the frame fixed in the platform."""


@dataclass(frozen=True)
class Frame:
    """A frame of axes, seen from its parent.

    Attributes:
        name: unique name.
        parent: name of the parent frame; None for the base.
        rotation: nine entries row by row, parent_R_child; numbers, symbols, or
            None where the entry is to be taken from `axes` or `rows`.
        axes: the child's x, y, z axes as vectors known in the parent frame.
        rows: the parent's x, y, z axes as vectors known in the child frame.
        angle: (cosine, sine) symbols of a turn about the common z axis, or None.
    """

    name: str
    parent: str | None
    rotation: tuple[Any, ...] | None = None
    axes: tuple[Any, ...] | None = None
    rows: tuple[Any, ...] | None = None
    angle: tuple[Any, Any] | None = None
