"""From the flat vectors X, V, A to the scalars that the derivation names."""

from __future__ import annotations

from typing import Any

import sympy as sp

from pne_sym.derivation import Coordinates, Derivation
from pne_sym.program.ir import Assignment, Check

_AXES = "xyz"


def entry(vector: str, index: int) -> sp.Symbol:
    """Symbol of an entry of an input vector."""
    return sp.Symbol(f"{vector}_{index}", real=True)


def unpack(coordinates: Coordinates) -> dict[str, tuple[list[Assignment], list[Check]]]:
    """By input vector: assignments that name its entries, and checks on them."""
    pose, checks = _pose(coordinates)
    return {
        "X": (pose, checks),
        "V": (_twist(coordinates, "V", "t_dot", "omega"), []),
        "A": (_twist(coordinates, "A", "t_ddot", "alpha"), []),
    }


def _symbol(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)


def _twist(coordinates: Coordinates, vector: str, linear: str, angular: str) -> list[Assignment]:
    return [
        Assignment(
            _symbol(f"{linear if c < 3 else angular}_{_AXES[c % 3]}"), entry(vector, k), vector
        )
        for k, c in enumerate(coordinates.components)
    ]


def _pose(coordinates: Coordinates) -> tuple[list[Assignment], list[Check]]:
    assignments: list[Assignment] = []
    checks: list[Check] = []
    for k, name in enumerate(coordinates.pose):
        if name in _AXES:
            assignments.append(Assignment(_symbol(f"t_{name}"), entry("X", k), "X"))
    if coordinates.planar and "phi" in coordinates.pose:
        phi = entry("X", coordinates.pose.index("phi"))
        assignments.append(Assignment(_symbol("R_xx"), sp.cos(phi), "X"))
        assignments.append(Assignment(_symbol("R_yx"), sp.sin(phi), "X"))
    if coordinates.has_quaternion:
        rotation, checks = _quaternion(coordinates.pose.index("qx"))
        assignments.extend(rotation)
    return assignments, checks


def _quaternion(first: int) -> tuple[list[Assignment], list[Check]]:
    """Rotation matrix of a quaternion of any length other than zero.

    A squared length that overflows leaves nothing of the scale: that is checked too.
    """
    x, y, z, w = (entry("X", first + k) for k in range(4))
    n, s = _symbol("quaternion_norm2"), _symbol("quaternion_scale")
    made: list[Assignment] = [
        Assignment(n, x * x + y * y + z * z + w * w, "X"),
        Assignment(s, 2 / n, "X"),
    ]

    def let(name: str, expr: Any) -> sp.Symbol:
        symbol = _symbol(name)
        made.append(Assignment(symbol, expr, "X"))
        return symbol

    sx, sy, sz = (let(f"quaternion_s{a}", s * q) for a, q in zip(_AXES, (x, y, z), strict=True))
    wx, wy, wz = (let(f"quaternion_w{a}", w * q) for a, q in zip(_AXES, (sx, sy, sz), strict=True))
    xx, xy, xz = (
        let("quaternion_xx", x * sx),
        let("quaternion_xy", x * sy),
        let("quaternion_xz", x * sz),
    )
    yy, yz, zz = (
        let("quaternion_yy", y * sy),
        let("quaternion_yz", y * sz),
        let("quaternion_zz", z * sz),
    )
    rows = (
        (1 - (yy + zz), xy - wz, xz + wy),
        (xy + wz, 1 - (xx + zz), yz - wx),
        (xz - wy, yz + wx, 1 - (xx + yy)),
    )
    for i, row in enumerate(rows):
        for j, value in enumerate(row):
            let(f"R_{_AXES[i]}{_AXES[j]}", value)
    return made, [Check("invalid", value, sp.S.One, 2, "X") for value in (n, s)]


def leg_inputs(derivation: Derivation, symbol: str, leg_type: str) -> tuple[str, tuple[int, ...]]:
    """Input vector, and index in it per leg, of a scalar that belongs to a leg.

    An extra coordinate (X), its rate (V) or acceleration (A), or a displacement that is
    found by iteration (q).
    """
    coordinates = derivation.coordinates
    assert coordinates is not None
    stem = symbol.split("_")
    joint = int(stem[1])
    info = next(t for t in derivation.leg_types if t.name == leg_type)
    if stem[0] == "q":
        return "q", tuple(coordinates.joints.index((leg, joint - 1)) for leg in info.indices)
    vector, start = {
        "y": ("X", len(coordinates.pose)),
        "yd": ("V", len(coordinates.rates)),
        "ydd": ("A", len(coordinates.rates)),
    }[stem[0]]
    places = [coordinates.extras.index((leg, joint - 1)) for leg in info.indices]
    return vector, tuple(start + place for place in places)
