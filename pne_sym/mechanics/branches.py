"""Assembly branches: the signs of the roots of the inverse kinematics at home."""

from __future__ import annotations

from typing import Any

import numpy as np

from pne_sym.derivation import Book
from pne_sym.mechanics.leg_displacements import Branch, InverseKinematics
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.platform_directions import right_angles
from pne_sym.model.kinematics import Array, at_home, chain_pose
from pne_sym.model.manipulator import Manipulator
from pne_sym.vector.evaluate import evaluate


def branch_signs(
    manipulator: Manipulator, g: LegGeometry, inverse: InverseKinematics, book: Book
) -> list[tuple[int, ...]]:
    """For every branch of the inverse kinematics, the sign that each leg has at home.

    Raises:
        SpecError: a root vanishes at home, where two branches meet.
    """
    pose, displacements = at_home(manipulator)
    rows = []
    for row, index in enumerate(g.leg_type.indices):
        values = _values_at(g, row, displacements[index], pose.R)
        rows.append(_signs_of_leg(manipulator, index, values, g, inverse, book))
    return list(zip(*rows, strict=True))


def _signs_of_leg(
    manipulator: Manipulator,
    index: int,
    values: dict[str, Any],
    g: LegGeometry,
    inverse: InverseKinematics,
    book: Book,
) -> list[int]:
    signs: dict[Branch, int] = {}
    for equation in book.open_equations():
        for branch in inverse.branches:
            if branch not in signs and branch.symbol in getattr(equation.rhs, "free_symbols", ()):
                root = evaluate(branch.root, values) / g.arm**branch.power
                if not np.isfinite(root) or abs(root) < 1e-12:
                    raise manipulator.fault(
                        f"legs[{index}].joints[{branch.joint - 1}]",
                        "two solutions of the inverse kinematics meet at home",
                        "a home position off that singularity",
                    )
                signs[branch] = 1 if root > 0 else -1
                values[branch.symbol.name] = float(signs[branch])
        if equation.name not in values:
            values[equation.name] = evaluate(equation.rhs, values)
    return [signs[branch] for branch in inverse.branches]


def _values_at(g: LegGeometry, row: int, q: Array, base_R_platform: Array) -> dict[str, Any]:
    """All that is given of a leg at displacements q, in leg axes (base point at the origin)."""
    leg = g.leg_type.legs[row]
    chain = chain_pose(leg, q)
    spec = chain.rotations
    # Axes as their joints leave them: rotation by x about e maps e to itself.
    axes = [R @ np.array(joint.axis) for R, joint in zip(spec[1:], leg.joints, strict=True)]
    values: dict[str, Any] = {g.e[j].name: axis for j, axis in enumerate(axes, 1)}
    for j, vector in g.offset.items():
        if hasattr(vector, "name"):
            values[vector.name] = spec[j - 1] @ np.array(leg.offsets[j - 1])
    values[g.name("S")] = chain.tip
    values |= {g.pitch[j].name: leg.joints[j - 1].pitch for j in g.pitch}
    leg_R_platform = np.array(leg.base_frame).T @ base_R_platform
    pairs = zip(g.pairs, right_angles(g.leg_type, leg), strict=True) if g.pairs else ()
    for (link, platform), (in_link, in_platform) in pairs:
        values[link.name] = spec[-1] @ in_link
        values[platform.name] = leg_R_platform @ in_platform
    values[g.name("size")] = 1.0
    for j, displacement in enumerate(q, 1):
        values[g.name(f"q_{j}")] = values[g.name(f"y_{j}_extra")] = displacement
        if g.turns(j):
            _frame_vectors(values, g, j, row, spec)
    return values


def _frame_vectors(
    values: dict[str, Any], g: LegGeometry, j: int, row: int, spec: tuple[Array, ...]
) -> None:
    """Reference direction, canonical axes, cosine and sine of a joint that turns."""
    axes = spec[j] @ g.canonical[j][row]
    x_axis, e = axes[:, 0], axes[:, 2]
    cosine, sine = g.zero_angle[j][row]
    zero = spec[j - 1] @ g.canonical[j][row][:, 0]
    reference = cosine * zero - sine * np.cross(e, zero)
    values[g.name(f"ref_{j}")] = reference
    values[g.name(f"across_{j}")] = np.cross(e, reference)
    values[g.name(f"link_x_{j}")] = x_axis
    values[g.name(f"link_y_{j}")] = axes[:, 1]
    values[g.name(f"c_{j}")] = float(reference @ x_axis)
    values[g.name(f"s_{j}")] = float(e @ np.cross(reference, x_axis))
