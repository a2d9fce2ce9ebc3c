"""Numbers, vectors, axes, rotations and inertias of a specification.

Structure is snapped here: components below `SNAP` of axes and offsets become
exactly zero, so that later stages may compare with zero.
"""

from __future__ import annotations

import math

from pne_sym.model.entry import Entry
from pne_sym.model.manipulator import IDENTITY3, Matrix3, Vector3
from pne_sym.model.rotation import is_rotation, matrix3, orthonormalised, rotation_from_rpy, vector3

SNAP = 1e-9
"""Components of axes (-) and offsets (m) below it are structural zeros."""
ROUNDING = 1e-6
"""Unit vectors and rotations off by less are taken as rounded, and mended."""
EXACT = 1e-14
"""Unit vectors and rotations off by less are left as they are, digit by digit."""
LARGEST = 1e12
"""Numbers beyond it are taken as mistakes; keeps later arithmetic finite."""

DIRECTIONS: dict[str, Vector3] = {
    sign + letter: (unit * (k == 0), unit * (k == 1), unit * (k == 2))
    for sign, unit in (("", 1.0), ("+", 1.0), ("-", -1.0))
    for k, letter in enumerate("xyz")
}


def number(entry: Entry) -> float:
    """A finite number.

    Raises:
        SpecError: not a number, not finite, or absurdly large.
    """
    value = entry.value
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise entry.fault("a number")
    # Integers of arbitrary size compare exactly; float() of them could overflow.
    if not -LARGEST <= value <= LARGEST:
        raise entry.fault(f"a finite number, at most {LARGEST:g} in size")
    return float(value) + 0.0


def not_negative(entry: Entry) -> float:
    """A finite number that is zero or positive.

    Raises:
        SpecError: negative, or not a finite number.
    """
    value = number(entry)
    if value < 0.0:
        raise entry.fault("zero or a positive number")
    return value


def numbers(entry: Entry, length: int, meaning: str) -> tuple[float, ...]:
    """A list of a given number of finite numbers.

    Raises:
        SpecError: another shape, or an element that is not a finite number.
    """
    if not isinstance(entry.value, list | tuple) or len(entry.value) != length:
        got = f" ({len(entry.value)} given)" if isinstance(entry.value, list | tuple) else ""
        raise entry.fault(f"{meaning}{got}")
    return tuple(number(item) for item in entry.items())


def vector(entry: Entry, *, plane: bool = False) -> Vector3:
    """A vector; in the plane two components, or three of which the last is zero.

    Raises:
        SpecError: another shape, not finite, or out of the plane.
    """
    if plane and isinstance(entry.value, list | tuple) and len(entry.value) == 2:
        x, y = numbers(entry, 2, "a list of two numbers")
        return (x, y, 0.0)
    meaning = "a list of two numbers (x, y)" if plane else "a list of three numbers (x, y, z)"
    x, y, z = numbers(entry, 3, meaning)
    if plane and abs(z) > SNAP:
        raise entry.fault("z = 0: the mechanism moves in the plane z = 0")
    return (x, y, 0.0 if plane else z)


def offset(entry: Entry, *, plane: bool = False) -> Vector3:
    """A vector whose components near zero are structural zeros."""
    return _snapped(vector(entry, plane=plane))


def axis(entry: Entry, *, plane: bool = False) -> Vector3:
    """A unit vector, given by components or by name ("x", "-y" ...).

    Components below `SNAP` become zero, so that an axis along a coordinate
    direction is exactly that.

    Raises:
        SpecError: not of unit length, or an unknown name.
    """
    if isinstance(entry.value, str):
        if entry.value not in DIRECTIONS:
            raise entry.fault('a unit vector or one of "x", "y", "z", "-x", "-y", "-z"')
        return DIRECTIONS[entry.value]
    x = vector(entry, plane=plane)
    length = math.hypot(*x)
    if abs(length - 1.0) > ROUNDING:
        told = "a zero vector" if length == 0.0 else f"a vector of length {length:.9g}"
        raise entry.fault(f"a unit vector (length 1 to {ROUNDING:g}), got {told}")
    x = _snapped(x)
    length = math.hypot(*x)
    if sum(1 for c in x if c) == 1:
        return vector3([math.copysign(1.0, c) if c else 0.0 for c in x])
    return x if abs(length - 1.0) <= EXACT else vector3([c / length for c in x])


def rotation(entry: Entry, *, plane: bool = False) -> Matrix3:
    """A rotation matrix: by rows, or as roll, pitch, yaw about fixed axes x, y, z.

    Raises:
        SpecError: not a proper rotation, or in the plane not about z.
    """
    if isinstance(entry.value, dict):
        table = entry.table(("rpy", "rpy_deg"))
        if len(table.fields) != 1:
            raise entry.fault("either rpy (radians) or rpy_deg (degrees)")
        name, angles = next(iter(table.fields.items()))
        rpy = numbers(angles, 3, "three angles: roll, pitch, yaw")
        if name == "rpy" and max(map(abs, rpy)) > math.tau:
            angles.warn(": more than a turn; rpy_deg is in degrees")
        result = rotation_from_rpy(vector3(rpy), degrees=name == "rpy_deg")
    else:
        result = matrix(entry, plane=plane)
    if not is_rotation(result, ROUNDING):
        raise entry.fault(f"a rotation matrix (orthonormal rows to {ROUNDING:g}, determinant +1)")
    if plane and abs(result[2][2] - 1.0) > SNAP:
        raise entry.fault("a rotation about z: the mechanism moves in the plane z = 0")
    return result if is_rotation(result, EXACT) else orthonormalised(result)


def matrix(entry: Entry, *, plane: bool = False) -> Matrix3:
    """A 3x3 matrix by rows; in the plane 2x2 is completed by the unit row and column."""
    shape = "a 3x3 matrix (three rows of three numbers)"
    if not isinstance(entry.value, list | tuple):
        raise entry.fault(shape)
    rows = entry.items()
    if plane and len(rows) == 2:
        (a, b), (c, d) = (numbers(row, 2, "two numbers (a row of a 2x2 matrix)") for row in rows)
        return ((a, b, 0.0), (c, d, 0.0), IDENTITY3[2])
    if len(rows) != 3:
        raise entry.fault(shape)
    return matrix3(numbers(row, 3, "three numbers (a row of the matrix)") for row in rows)


def flags(entry: Entry | None, count: int) -> tuple[bool, ...]:
    """True or false for each of `count` degrees of freedom; left out means false.

    Raises:
        SpecError: another shape, or a single `true` for several degrees of freedom.
    """
    if entry is None or entry.value is False:
        return (False,) * count
    if isinstance(entry.value, list | tuple):
        if len(entry.value) != count:
            raise entry.fault(f"{count} values true or false, one for each degree of freedom")
        return tuple(item.flag() for item in entry.items())
    if count > 1:
        raise entry.fault(f"a list of {count} values true or false, one for each degree of freedom")
    return (entry.flag(),)


def _snapped(x: Vector3) -> Vector3:
    return vector3([0.0 if abs(c) < SNAP else c for c in x])
