"""From the flat vectors X, V, A and q to the scalars that the derivation names."""

from __future__ import annotations

from itertools import combinations_with_replacement
from typing import Any

import sympy as sp

from pne_sym.derivation import PLATFORM, Derivation, Role
from pne_sym.lowering.algebra import symbol as as_symbol
from pne_sym.program.ir import Assignment, Check, Closure


def entry(vector: str, index: int) -> sp.Symbol:
    """Symbol of an entry of an input vector."""
    return as_symbol(f"{vector}_{index}")


def unpack(derivation: Derivation) -> dict[str, tuple[list[Assignment], list[Check]]]:
    """By input vector: assignments that name its entries, and checks on them."""
    pose, checks = _pose(derivation)
    return {
        "X": (pose, checks),
        "base": _base(derivation),
        "V": (_twist(derivation, "V", Role.VELOCITY, Role.ANGULAR_VELOCITY), []),
        "A": (_twist(derivation, "A", Role.ACCELERATION, Role.ANGULAR_ACCELERATION), []),
    }


def _components(derivation: Derivation, role: Role) -> tuple[Any, ...]:
    """Components of the platform's vector with a role; zeros where it has none."""
    quantity = derivation.with_role(role)
    for given in derivation.givens:
        if quantity is not None and given.symbol.name == quantity.name:
            return given.components
    return (sp.S.Zero,) * 3


def _twist(derivation: Derivation, vector: str, linear: Role, angular: Role) -> list[Assignment]:
    assert derivation.coordinates is not None
    six = (*_components(derivation, linear), *_components(derivation, angular))
    return [
        Assignment(six[c], entry(vector, k), vector)
        for k, c in enumerate(derivation.coordinates.components)
    ]


_BASE = (
    (Role.BASE_ROTATION, 9),
    (Role.BASE_ANGULAR_VELOCITY, 3),
    (Role.BASE_ANGULAR_ACCELERATION, 3),
    (Role.BASE_ACCELERATION, 3),
)
"""What stands in the motion of the base, R row by row."""


def _base(derivation: Derivation) -> tuple[list[Assignment], list[Check]]:
    """Motion of the base; its rotation must be one."""
    made: list[Assignment] = []
    first = 0
    for role, size in _BASE:
        for k, component in enumerate(_components(derivation, role)[:size]):
            if not component.is_Number:
                made.append(Assignment(component, entry("base", first + k), "base"))
        first += size
    rotation = _components(derivation, Role.BASE_ROTATION)
    if len(rotation) == 3:  # the base is at rest
        return [], []
    rows = sp.Matrix(3, 3, rotation)
    off = (rows * rows.T - sp.eye(3)).applyfunc(lambda e: e**2)
    margin, turn = as_symbol("base_margin"), as_symbol("base_turn")
    made.append(Assignment(margin, _NEAR**2 - sum(off), "base"))
    made.append(Assignment(turn, rows.row(0).cross(rows.row(1)).dot(rows.row(2)), "base"))
    return made, [Check("invalid", s, sp.S.One, 1, "base") for s in (margin, turn)]


_NEAR = 1e-5
"""By how much the products of the base's axes may differ from those of unit vectors."""


def _pose(derivation: Derivation) -> tuple[list[Assignment], list[Check]]:
    coordinates = derivation.coordinates
    assert coordinates is not None
    assignments: list[Assignment] = []
    checks: list[Check] = []
    position = _components(derivation, Role.POSITION)
    for k, component in enumerate(coordinates.components[: coordinates.position]):
        assignments.append(Assignment(position[component], entry("X", k), "X"))
    rotation = next((f.rotation for f in derivation.frames if f.name == PLATFORM), None) or ()
    if coordinates.planar and len(coordinates.pose) > coordinates.position:
        phi = entry("X", coordinates.position)
        assignments.append(Assignment(rotation[0], sp.cos(phi), "X"))
        assignments.append(Assignment(rotation[3], sp.sin(phi), "X"))
    if coordinates.has_quaternion:
        named, checks = _quaternion(coordinates.position, rotation)
        assignments.extend(named)
    return assignments, checks


def _quaternion(first: int, rotation: tuple[Any, ...]) -> tuple[list[Assignment], list[Check]]:
    """Rotation matrix of a quaternion of any length other than zero.

    The scale is zero where the squared length overflows, and not finite where that is too small.
    """
    x, y, z, w = (entry("X", first + k) for k in range(4))
    n, s = as_symbol("quaternion_norm2"), as_symbol("quaternion_scale")
    made: list[Assignment] = [
        Assignment(n, x * x + y * y + z * z + w * w, "X"),
        Assignment(s, 2 / n, "X"),
    ]

    def let(name: str, expr: Any) -> sp.Symbol:
        symbol = as_symbol(name)
        made.append(Assignment(symbol, expr, "X"))
        return symbol

    named = {"x": x, "y": y, "z": z}
    scaled = {a: let(f"quaternion_s{a}", s * q) for a, q in named.items()}
    wx, wy, wz = (let(f"quaternion_w{a}", w * q) for a, q in scaled.items())
    xx, xy, xz, yy, yz, zz = (
        let(f"quaternion_{a}{b}", named[a] * scaled[b])
        for a, b in combinations_with_replacement("xyz", 2)
    )
    rows = (
        (1 - (yy + zz), xy - wz, xz + wy),
        (xy + wz, 1 - (xx + zz), yz - wx),
        (xz - wy, yz + wx, 1 - (xx + yy)),
    )
    values = (value for row in rows for value in row)
    made += [Assignment(r, value, "X") for r, value in zip(rotation, values, strict=True)]
    return made, [Check("invalid", s, sp.S.One, 2, "X")]


def leg_inputs(derivation: Derivation, name: str) -> tuple[str, tuple[int, ...]]:
    """Input vector, and index in it per leg, of a scalar that belongs to a leg.

    An extra coordinate (X), its rate (V) or acceleration (A), or a displacement that is
    found by iteration (q).
    """
    coordinates, quantity = derivation.coordinates, derivation.notation[name]
    assert coordinates is not None
    info = next(t for t in derivation.leg_types if t.name == quantity.leg_type)
    joints = [(leg, quantity.joint - 1) for leg in info.indices]
    if joints[0] not in coordinates.extras:
        return "q", tuple(coordinates.joints.index(joint) for joint in joints)
    vector, start = {
        Role.DISPLACEMENT: ("X", len(coordinates.pose)),
        Role.RATE: ("V", len(coordinates.rates)),
        Role.JOINT_ACCELERATION: ("A", len(coordinates.rates)),
    }[quantity.role or Role.DISPLACEMENT]
    return vector, tuple(start + coordinates.extras.index(joint) for joint in joints)


def closures(derivation: Derivation) -> tuple[Closure, ...]:
    """The leg types whose displacements are found by iteration."""
    c = derivation.coordinates
    assert c is not None
    found = []
    for t in derivation.leg_types:
        if t.is_closed:
            continue
        looked_for = [j for j in range(t.joints) if t.methods[j] != "given"]
        joints = tuple(tuple(c.joints.index((i, j)) for j in looked_for) for i in t.indices)
        turning = tuple(j for leg in joints for j in leg if c.turning[j])
        _, signs = derivation.parameters.branches.get(t.orientation_sign, ("", ()))
        found.append(Closure(t.name, joints, turning, t.orientation, signs, t.orientation_sign))
    return tuple(found)


def given_displacements(derivation: Derivation) -> tuple[tuple[int, int], ...]:
    """(position in q, position in X) of the extra coordinates."""
    c = derivation.coordinates
    assert c is not None
    return tuple((c.joints.index(e), k) for k, e in enumerate(c.extras, len(c.pose)))
