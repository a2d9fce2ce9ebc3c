"""Constraint wrenches of a leg that lacks degrees of freedom.

Reference: section 3.7, Eqs. 35 to 37.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import sympy as sp

from pne_sym.derivation import Book, Condition, FailureStatus
from pne_sym.mechanics.directions import AXES, unit
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.reciprocal_wrenches import (
    Column,
    ConstraintWrench,
    completed_wrenches,
    direction,
)
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.model.closure import leg_residual
from pne_sym.model.kinematics import at_home
from pne_sym.model.manipulator import Manipulator
from pne_sym.vector import Cross, Dot, Vector, VectorSymbol, norm, vector_sum

_TERMS = glossary(r"""
n_plane    | \mathbf n                | given @leg
    normal of the plane
n_c        | \mathbf n_c              | GEOMETRY @tip | Eq. 35
    direction of the constraint force
n_c1       | \mathbf n_c              | GEOMETRY @tip | Eq. 35
    direction of the constraint force
f_c_part   | \mathbf n'_c             | GEOMETRY @tip
    force part of the constraint wrench
f_c_size   | \lVert\mathbf n'_c\rVert | GEOMETRY
    its size
n_c:force  | \mathbf n_c              | GEOMETRY @tip | Eq. 35
    unit force of the constraint wrench
volume_c   | \Delta_c                 | GEOMETRY
    triple product of the velocity vectors
n_c:moment | \mathbf n_c              | GEOMETRY @tip | Eq. 35
    force part, zero on the manifold, of the constraint moment
mu_c       | o_c                      | GEOMETRY      | Eq. 35
    moment that goes with it
""")


def constraint_directions(
    book: Book,
    g: LegGeometry,
    v: Mapping[int, Vector],
    joints: list[int],
    missing: int,
    planar: bool,
) -> list[Vector]:
    """Unit vectors perpendicular to all velocity vectors v_j of a leg.

    An axis that is perpendicular to every v_j by structure serves as it is;
    otherwise the unit vector across is formed.
    """
    axis = axis_across(g, joints)
    if planar:
        return [_unit(book, g, "n_c", Cross(plane_normal(book, g), v[joints[0]]))]
    if missing == 1:
        if axis is not None:
            return [axis]
        first, second = (v[j] for j in joints)
        return [_unit(book, g, "n_c", Cross(first, second))]
    (only,) = (v[j] for j in joints)
    if axis is None:
        auxiliary = direction(book, g, g.completion[0].number)
        axis = _unit(book, g, "n_c1", Cross(auxiliary, only))
    return [axis, _unit(book, g, "n_c", Cross(axis, only))]


def plane_normal(book: Book, g: LegGeometry) -> Vector:
    """The normal of the plane: the axis of a joint that turns, or a vector of its own."""
    turning = [g.e[j] for j in range(1, g.count + 1) if g.turns(j)]
    if turning:
        return turning[0]
    normal = VectorSymbol(g.name("n_plane"))
    if normal.name not in book.notation:
        Writer(book, g, _TERMS).give("n_plane", unit(AXES[2]))
    return normal


def constraint_wrenches(
    book: Book, g: LegGeometry, joints: list[int], dofs: list[Column], directions: list[Any]
) -> list[ConstraintWrench]:
    """Wrenches that do no work along a leg that transmits moments.

    Three joints and one moment have a formula of their own, without auxiliary directions.
    """
    if len(directions) != 1 or len(joints) != 3:
        return completed_wrenches(book, g, dofs, directions)
    (n,) = directions
    across = [Cross(dofs[(k + 1) % 3].vector, dofs[(k + 2) % 3].vector) for k in range(3)]
    parts = [-Dot(g.spin(j), n) * a for j, a in zip(joints, across, strict=True) if g.turns(j)]
    volume = Dot(dofs[0].vector, across[0])
    turning = sum(g.kind(j).is_angle for j in joints)  # velocity vectors are lengths there
    if g.pure_moment:
        return [_per_unit_moment(book, g, vector_sum(parts), volume, turning, n)]
    eq = Writer(book, g, _TERMS)
    direction = eq("f_c_part", vector_sum(parts))
    squared = Dot(direction, direction)
    regular = Condition(FailureStatus.SINGULAR, squared, g.size ** (2 * turning - 2), 2)
    length = eq("f_c_size", norm(direction), conditions=(regular,))
    force = eq("n_c:force", direction / length)
    coefficient = eq("mu_c", volume / length)
    return [ConstraintWrench(force, (coefficient,), coefficient * n)]


def _per_unit_moment(
    book: Book, g: LegGeometry, force: Vector, volume: Any, turning: int, n: Vector
) -> ConstraintWrench:
    """The same wrench per unit moment, for legs whose wrench has no force part at home."""
    eq = Writer(book, g, _TERMS)
    regular = Condition(FailureStatus.SINGULAR, volume, g.size**turning)
    scale = eq("volume_c", volume, conditions=(regular,))
    direction: Vector = eq("n_c:moment", force / scale)
    coefficient = eq("mu_c", sp.S.One)
    return ConstraintWrench(direction, (coefficient,), coefficient * n, of_moment=True)


def force_vanishes(manipulator: Manipulator, g: LegGeometry) -> bool:
    """Whether at home the wrenches that the legs leave out are pure moments."""
    if len(g.pairs) != 1:
        return False
    pose, displacements = at_home(manipulator)
    turns = (
        leg_residual(manipulator.legs[index], displacements[index], pose)[1][3:]
        for index in g.leg_type.indices
    )
    return all(np.abs(by_q).max(initial=0.0) <= 1e-6 for by_q in turns)


def axis_across(g: LegGeometry, joints: list[int]) -> Vector | None:
    """A joint axis perpendicular to every velocity vector: e x r is across e itself."""

    def is_across(k: int, j: int) -> bool:
        if g.acts_as_slide(j):
            return g.perpendicular(k, j)
        return not g.slides(j) and g.parallel(k, j) != 0

    for k in range(1, g.count + 1):
        if g.turns(k) and all(is_across(k, j) for j in joints):
            return g.e[k]
    return None


def _unit(book: Book, g: LegGeometry, stem: str, vector: Vector) -> Vector:
    unit: Vector = Writer(book, g, _TERMS)(stem, vector / norm(vector))
    return unit
