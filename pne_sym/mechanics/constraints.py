"""Directions of the connection point that a leg's freedoms leave out.

Reference: section 3.7, Eqs. 35 to 37.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import sympy as sp

from pne_sym.derivation import Book, Condition, Law, Quantity, Trouble
from pne_sym.mechanics.completion import Freedoms, LeftOut, completed_wrenches, direction
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.scope import moment_directions
from pne_sym.model.kinematics import chain_pose, pose_at
from pne_sym.model.manipulator import Manipulator
from pne_sym.vector import Cross, Dot, Vector, VectorSymbol, norm, vector_sum

_POWERS_OF_METRE = ("-", "m", "m^2", "m^3")


def directions_left_out(
    book: Book, g: LegGeometry, motion: Any, joints: list[int], missing: int, planar: bool
) -> list[Vector]:
    """Unit vectors perpendicular to all velocity vectors v_j of a leg.

    An axis that is perpendicular to every v_j by structure serves as it is;
    otherwise the unit vector across is formed.
    """
    axis = axis_across(g, joints)
    if planar:
        return [_unit(book, g, "n_c", Cross(plane_normal(book, g), motion.v[joints[0]]))]
    if missing == 1:
        if axis is not None:
            return [axis]
        first, second = (motion.v[j] for j in joints)
        return [_unit(book, g, "n_c", Cross(first, second))]
    (only,) = (motion.v[j] for j in joints)
    if axis is None:
        auxiliary = direction(book, g, g.completion[0].number, g.frame("axes", g.group[g.count]))
        axis = _unit(book, g, "n_c1", Cross(auxiliary, only))
    return [axis, _unit(book, g, "n_c", Cross(axis, only))]


def plane_normal(book: Book, g: LegGeometry) -> Vector:
    """The normal of the plane: the axis of a joint that turns, or a vector of its own."""
    turning = [g.e[j] for j in range(1, g.count + 1) if g.turns(j)]
    if turning:
        return turning[0]
    normal = VectorSymbol(g.name("n_plane"))
    if normal.name not in book.notation:
        meaning = "normal of the plane"
        frame = g.frame("spec", 0)
        quantity = Quantity(normal.name, r"\mathbf n", meaning, "-", frame, parameter=True)
        book.give(normal, frame, (sp.S.Zero, sp.S.Zero, sp.S.One), quantity)
    return normal


def wrenches_left_out(
    book: Book, g: LegGeometry, motion: Any, joints: list[int], freedoms: Freedoms
) -> list[LeftOut]:
    """Wrenches that do no work along a leg that transmits moments.

    Three joints and one moment have a formula of their own, without auxiliary directions.
    """
    if len(motion.n) != 1 or len(joints) != 3:
        return completed_wrenches(book, g, g.completion, freedoms)
    (n,) = motion.n
    across = [Cross(motion.v[joints[(k + 1) % 3]], motion.v[joints[(k + 2) % 3]]) for k in range(3)]
    parts = [-Dot(g.spin(j), n) * a for j, a in zip(joints, across, strict=True) if g.turns(j)]
    frame = g.frame("axes", g.group[g.count])
    volume = Dot(motion.v[joints[0]], across[0])
    turning = sum(g.kind(j).is_angle for j in joints)  # velocity vectors are lengths there
    if g.pure_moment:
        return [_per_unit_moment(book, g, vector_sum(parts), volume, turning, frame, n)]
    direction = book.define(
        g.name("f_c_part"),
        vector_sum(parts),
        r"\mathbf f'_c",
        "force that with the moment does no work along the leg's freedoms",
        Law.GEOMETRY,
        body=frame,
        unit=_POWERS_OF_METRE[turning - 1],
    )
    squared = Dot(direction, direction)
    length = book.define(
        g.name("f_c_size"),
        norm(direction),
        r"\lVert\mathbf f'_c\rVert",
        "its size",
        Law.GEOMETRY,
        unit=_POWERS_OF_METRE[turning - 1],
        conditions=(Condition(Trouble.SINGULAR, squared, g.size ** (2 * turning - 2), 2),),
    )
    force = book.define(
        g.name("n_c"),
        direction / length,
        r"\mathbf n_c",
        "unit force that the leg's freedoms leave out",
        Law.GEOMETRY,
        body=frame,
        reference="Eq. 35",
    )
    amount = book.define(
        g.name("mu_c"),
        volume / length,
        r"\mu_c",
        "moment that goes with it",
        Law.GEOMETRY,
        unit="m",
        reference="Eq. 35",
    )
    return [LeftOut(force, (amount,), amount * n)]


def _per_unit_moment(
    book: Book, g: LegGeometry, force: Vector, volume: Any, turning: int, frame: str, n: Vector
) -> LeftOut:
    """The same wrench per unit moment, for legs whose wrench has no force part at home."""
    condition = Condition(Trouble.SINGULAR, volume, g.size**turning)
    scale = book.define(
        g.name("volume_c"),
        volume,
        r"\Delta_c",
        "triple product of the velocity vectors",
        Law.GEOMETRY,
        unit=_POWERS_OF_METRE[turning],
        conditions=(condition,),
    )
    direction: Vector = book.define(
        g.name("n_c"),
        force / scale,
        r"\mathbf n_c",
        "force part, zero on the manifold, of the unit moment that the leg's freedoms leave out",
        Law.GEOMETRY,
        body=frame,
        unit="1/m",
        reference="Eq. 35",
    )
    amount = book.define(
        g.name("mu_c"),
        sp.S.One,
        r"\mu_c",
        "moment that goes with it",
        Law.GEOMETRY,
        reference="Eq. 35",
    )
    return LeftOut(direction, (amount,), amount * n, of_moment=True)


def force_vanishes(manipulator: Manipulator, g: LegGeometry) -> bool:
    """Whether at home the wrenches that the legs leave out are pure moments."""
    if len(g.pairs) != 1:
        return False
    starts = np.cumsum([0, *(len(leg.joints) for leg in manipulator.legs)])
    pose = pose_at(manipulator.space, manipulator.home.X, manipulator.fixed_centre)
    for index in g.leg_type.indices:
        leg = manipulator.legs[index]
        q = np.array(manipulator.home.q[starts[index] : starts[index + 1]])
        chain = chain_pose(leg, q)
        leg_R_platform = np.array(leg.base_frame).T @ pose.R
        n = moment_directions(g.leg_type, leg, chain.last, leg_R_platform)
        if np.abs(n @ chain.spins).max(initial=0.0) > 1e-6:
            return False
    return True


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
    unit: Vector = book.define(
        g.name(stem),
        vector / norm(vector),
        r"\mathbf n_c",
        "unit vector that the leg's freedoms leave out",
        Law.GEOMETRY,
        body=g.frame("axes", g.group[g.count]),
        reference="Eq. 35",
    )
    return unit
