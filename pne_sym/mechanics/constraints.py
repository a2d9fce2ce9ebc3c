"""Directions of the connection point that a leg's freedoms leave out.

Reference: section 3.7, Eqs. 35 to 37.
"""

from __future__ import annotations

from typing import Any

from pne_sym.derivation import Book, Law
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.vector import Cross, Vector, norm


def directions_left_out(
    book: Book, g: LegGeometry, motion: Any, joints: list[int], missing: int, planar: bool
) -> list[Vector]:
    """Unit vectors perpendicular to all velocity vectors v_j of a leg.

    An axis that is perpendicular to every v_j by structure serves as it is;
    otherwise the unit vector across is formed.
    """
    axis = axis_across(g, joints)
    if planar:
        return [_unit(book, g, "n_c", Cross(g.e[1], motion.v[joints[0]]))]
    if missing == 1:
        if axis is not None:
            return [axis]
        first, second = (motion.v[j] for j in joints)
        return [_unit(book, g, "n_c", Cross(first, second))]
    if axis is None:
        raise ValueError("a leg with a single freedom along its slide leaves out a plane")
    return [axis, _unit(book, g, "n_c", Cross(axis, motion.v[joints[0]]))]


def axis_across(g: LegGeometry, joints: list[int]) -> Vector | None:
    """A joint axis perpendicular to every velocity vector: e x r is across e itself."""
    for k in range(1, g.count + 1):
        if not g.turns(k):
            continue
        if all(g.parallel(k, j) if g.turns(j) else g.perpendicular(k, j) for j in joints):
            return g.e[k]
    return None


def _unit(book: Book, g: LegGeometry, stem: str, vector: Vector) -> Vector:
    unit: Vector = book.define(
        g.name(stem), vector / norm(vector), r"\mathbf n_c",
        "unit vector that the leg's freedoms leave out", Law.GEOMETRY,
        body=g.frame("axes", g.group[g.count]), reference="Eq. 35")
    return unit
