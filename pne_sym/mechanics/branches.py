"""Assembly branches: the signs of the roots of the inverse kinematics at home."""

from __future__ import annotations

from typing import Any

import numpy as np
import sympy as sp

from pne_sym.derivation import Book
from pne_sym.mechanics.leg_displacements import InverseKinematics
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.platform_directions import right_angles
from pne_sym.model.errors import SpecError
from pne_sym.model.kinematics import Array, at_home, chain_pose, rotation_about
from pne_sym.model.manipulator import Leg, Manipulator
from pne_sym.vector.evaluate import evaluate


def branch_signs(
    manipulator: Manipulator, g: LegGeometry, inverse: InverseKinematics, book: Book
) -> list[tuple[int, ...]]:
    """For every branch of the inverse kinematics, the sign that each leg has at home.

    Raises:
        SpecError: a root vanishes at home, where two branches meet.
    """
    rows = []
    pose, displacements = at_home(manipulator)
    for index in g.leg_type.indices:
        q = displacements[index]
        rows.append(_signs_of_leg(manipulator.name, index, q, g, inverse, book, pose.R))
    return [tuple(row[k] for row in rows) for k in range(len(inverse.branches))]


def _signs_of_leg(
    name: str,
    index: int,
    q: Array,
    g: LegGeometry,
    inverse: InverseKinematics,
    book: Book,
    base_R_platform: Array,
) -> list[int]:
    leg = g.leg_type.legs[g.leg_type.indices.index(index)]
    values = _values_at(leg, q, g, g.leg_type.indices.index(index), base_R_platform)
    for j in range(1, g.count + 1):
        values[g.name(f"q_{j}")] = q[j - 1]
        values[g.name(f"y_{j}_extra")] = q[j - 1]
    branches = {branch.symbol: branch for branch in inverse.branches}
    signs: dict[sp.Symbol, int] = {}
    chapter = book.open_equations()
    for equation in chapter:
        for symbol in branches.keys() - signs.keys():
            if symbol in getattr(equation.rhs, "free_symbols", ()):
                branch = branches[symbol]
                root = evaluate(branch.root, values) / g.arm**branch.power
                signs[symbol] = _sign(name, index, branch.joint, root)
                values[symbol.name] = float(signs[symbol])
        if equation.name not in values:
            values[equation.name] = evaluate(equation.rhs, values)
    return [signs[branch.symbol] for branch in inverse.branches]


def _sign(name: str, index: int, joint: int, root: float) -> int:
    if not np.isfinite(root) or abs(root) < 1e-12:
        raise SpecError(
            name,
            f"legs[{index}].joints[{joint - 1}]",
            "two solutions of the inverse kinematics meet at home",
            "a home position off that singularity",
        )
    return 1 if root > 0 else -1


def _values_at(
    leg: Leg, q: Array, g: LegGeometry, row: int, base_R_platform: Array
) -> dict[str, Any]:
    """All given vectors of a leg at displacements q, in leg axes (base point at the origin)."""
    chain = chain_pose(leg, q)
    spec = chain.rotations
    # Axes as their joints leave them: rotation by x about e maps e to itself.
    axes = [R @ np.array(joint.axis) for R, joint in zip(spec[1:], leg.joints, strict=True)]
    values: dict[str, Any] = {g.e[j].name: axis for j, axis in enumerate(axes, 1)}
    offsets = [*(joint.offset for joint in leg.joints), leg.platform_joint.offset]
    for j, vector in g.offset.items():
        if hasattr(vector, "name"):
            values[vector.name] = spec[j - 1] @ np.array(offsets[j - 1])
    values[g.name("S")] = chain.tip
    values |= {g.pitch[j].name: leg.joints[j - 1].pitch for j in g.pitch}
    leg_R_platform = np.array(leg.base_frame).T @ base_R_platform
    pairs = zip(g.pairs, right_angles(g.leg_type, leg), strict=True) if g.pairs else ()
    for (link, platform), (in_link, in_platform) in pairs:
        values[link.name] = spec[-1] @ in_link
        values[platform.name] = leg_R_platform @ in_platform
    values[g.name("size")] = 1.0
    _frame_vectors(values, leg, q, g, spec, row)
    return values


def _frame_vectors(
    values: dict[str, Any], leg: Leg, q: Array, g: LegGeometry, spec: tuple[Array, ...], row: int
) -> None:
    """Reference directions, canonical axes, cosines and sines of the joints."""
    for j in range(1, g.count + 1):
        if not g.turns(j):
            continue
        axes = spec[j] @ g.canonical[j][row]
        x_axis, e = axes[:, 0], axes[:, 2]
        cosine, sine = g.zero_angle[j][row]
        before = spec[j] @ rotation_about(
            leg.joints[j - 1].axis, -leg.joints[j - 1].turn * q[j - 1]
        )
        zero = before @ g.canonical[j][row][:, 0]
        reference = cosine * zero - sine * np.cross(e, zero)
        values[g.name(f"ref_{j}")] = reference
        values[g.name(f"across_{j}")] = np.cross(e, reference)
        values[g.name(f"link_x_{j}")] = x_axis
        values[g.name(f"link_y_{j}")] = axes[:, 1]
        values[g.name(f"c_{j}")] = float(reference @ x_axis)
        values[g.name(f"s_{j}")] = float(e @ np.cross(reference, x_axis))
