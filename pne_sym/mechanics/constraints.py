"""Directions of the connection point, and wrenches, that a leg's freedoms leave out.

Where a leg transmits moments and the wrench is not to be had by a cross product, the joints'
screws are completed to a basis with unit forces and moments; which ones is settled by the home
position.  The reciprocal wrenches of those do no work along the joints.

Reference: section 3.7, Eqs. 35 to 37.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from pne_sym.derivation import Book, Condition, Law, Quantity, ReciprocalBasis, Trouble
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.vector import (
    Cross,
    Dot,
    DualScalar,
    DualVector,
    Vector,
    VectorSymbol,
    ZeroVector,
    norm,
    vector_sum,
)

Array = NDArray[np.float64]
_PURE_MOMENT = 1e-6  # relative force of a wrench that counts as a moment


@dataclass(frozen=True)
class LeftOut:
    """A wrench on the platform that does no work along a leg's freedoms.

    Attributes:
        force: at the connection point.
        amounts: of the moments along the leg's moment directions.
    """

    force: Vector
    amounts: tuple[Any, ...] = ()


def directions_left_out(
    book: Book, g: LegGeometry, motion: Any, joints: list[int], missing: int, planar: bool
) -> list[LeftOut]:
    """Unit forces perpendicular to all velocity vectors v_j of a leg.

    An axis that is perpendicular to every v_j by structure serves as it is;
    otherwise the unit vector across is formed.
    """
    if planar:
        across = Cross(plane_normal(book, g), motion.v[joints[0]])
        return [LeftOut(_unit(book, g, 1, across))]
    axis = axis_across(g, joints)
    if missing == 1:
        if axis is not None:
            return [LeftOut(axis)]
        first, second = (motion.v[j] for j in joints)
        return [LeftOut(_unit(book, g, 1, Cross(first, second)))]
    (v,) = (motion.v[j] for j in joints)
    if axis is None:
        axis = _unit(book, g, 1, Cross(v, _direction(book, g, _farthest(g))))
    return [LeftOut(axis), LeftOut(_unit(book, g, 2, Cross(axis, v)))]


def _farthest(g: LegGeometry) -> int:
    """The axis of the last link that is farthest from the only velocity vector at home."""
    vectors = g.screws[:, :3, 0]
    along = np.abs(vectors) / np.linalg.norm(vectors, axis=1, keepdims=True)
    return int(np.argmin(along.max(axis=0)))


def _direction(book: Book, g: LegGeometry, k: int) -> Vector:
    """Axis k of the last link."""
    symbol = VectorSymbol(g.name(f"end_{'xyz'[k]}"))
    if symbol.name not in book.notation:
        frame = g.frame("spec", g.group[g.count])
        quantity = Quantity(
            symbol.name,
            rf"\mathbf i_{{{'xyz'[k]}}}",
            f"direction {'xyz'[k]} of the last link",
            "-",
            frame,
            parameter=True,
        )
        book.give(symbol, frame, [sp.Integer(int(i == k)) for i in range(3)], quantity)
    return symbol


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
    book: Book, g: LegGeometry, motion: Any, joints: list[int], missing: int
) -> list[LeftOut]:
    """Wrenches that do no work along the freedoms of a leg that transmits moments.

    Each has a unit force, or a unit moment where it has no force at home.
    """
    if missing == 1 and len(joints) == 3:
        return [_beside_three_joints(book, g, motion, joints)]
    return _completed(book, g, motion, joints, missing)


def _beside_three_joints(book: Book, g: LegGeometry, motion: Any, joints: list[int]) -> LeftOut:
    """The wrench in closed form: three velocity vectors and one moment direction."""
    (n,) = motion.n
    across = [Cross(motion.v[joints[(k + 1) % 3]], motion.v[joints[(k + 2) % 3]]) for k in range(3)]
    parts = [-Dot(g.e[j], n) * a for j, a in zip(joints, across, strict=True) if g.turns(j)]
    volume = Dot(motion.v[joints[0]], across[0])
    force, amount = (
        vector_sum(parts),
        book.define(
            g.name("volume_c"),
            volume,
            r"\Delta_c",
            "triple product of the velocity vectors",
            Law.GEOMETRY,
            unit="m^3",
        ),
    )
    at_home = [np.linalg.svd(screws.T)[2][-1] for screws in g.screws[:, :, [j - 1 for j in joints]]]
    if all(np.linalg.norm(wrench[:3]) < _PURE_MOMENT for wrench in at_home):
        condition = Condition(Trouble.SINGULAR, amount, g.size**3)
        return _scaled(book, g, 1, LeftOut(force, (amount,)), amount, (condition,))
    return _per_unit_force(book, g, 1, LeftOut(force, (amount,)), g.size**4, "m^2")


def _completed(
    book: Book, g: LegGeometry, motion: Any, joints: list[int], missing: int
) -> list[LeftOut]:
    """The wrenches that a completed basis leaves beside the joints' own."""
    chosen, at_home = _completion(g, [j - 1 for j in joints], missing)
    vectors = [motion.v[j] for j in joints]
    rows = [[Dot(g.e[j], n) if g.turns(j) else sp.S.Zero for j in joints] for n in motion.n]
    for c in chosen:
        vectors.append(_direction(book, g, c) if c < 3 else ZeroVector)
        for i, row in enumerate(rows):
            row.append(sp.Integer(int(c == 3 + i)))
    screws = sp.Tuple(*vectors), sp.Tuple(*(sp.Tuple(*row) for row in rows))
    wrenches = [
        _reciprocal_wrench(book, g, c, (sp.Integer(len(joints) + c - 1), screws), len(motion.n))
        for c in range(1, missing + 1)
    ]
    sizes = [g.size if g.turns(j) else sp.S.One for j in joints]
    book.bases.append(
        ReciprocalBasis(
            g.leg_type.name,
            tuple(vectors),
            (*(None for _ in joints), *(wrench.force for wrench in wrenches)),
            (*sizes, *(sp.S.One for _ in wrenches)),
            tuple(dict.fromkeys(g.frame("axes", g.group[j]) for j in range(g.count, -1, -1))),
            tuple(tuple(row) for row in rows),
            (*(() for _ in joints), *(wrench.amounts for wrench in wrenches)),
            g.size,
        )
    )
    return [
        _per_unit_moment(book, g, c, wrench)
        if np.all(np.linalg.norm(there[:, :3], axis=1) < _PURE_MOMENT)
        else _per_unit_force(book, g, c, wrench, *_measure(g, chosen[c - 1]))
        for c, (wrench, there) in enumerate(zip(wrenches, at_home, strict=True), 1)
    ]


def _reciprocal_wrench(
    book: Book, g: LegGeometry, c: int, dual: tuple[Any, Any], moments: int
) -> LeftOut:
    """A wrench reciprocal to all screws of a basis but one (its place, the screws)."""
    place, screws = dual
    force = book.define(
        g.name(f"u_c{c}"),
        DualVector(place, *screws),
        rf"\mathbf u_{{c{c}}}",
        f"force part of wrench {c} that does no work along the leg's freedoms",
        Law.RECIPROCITY,
        body=g.frame("axes", g.group[g.count]),
        reference="Eq. 35",
    )
    amounts = tuple(
        book.define(
            g.name(f"mu{i + 1}_u_c{c}"),
            DualScalar(place, sp.Integer(i), *screws),
            rf"\mu^u_{{c{c},{i + 1}}}",
            f"moment part {i + 1} of that wrench",
            Law.RECIPROCITY,
            reference="Eq. 35",
        )
        for i in range(moments)
    )
    return LeftOut(force, amounts)


def _measure(g: LegGeometry, completed_by: int) -> tuple[Any, str]:
    """What the squared force of a reciprocal wrench is measured by, and the force's unit."""
    return (sp.S.One, "-") if completed_by < 3 else (g.size**-2, "1/m")


def _completion(g: LegGeometry, joints: list[int], missing: int) -> tuple[tuple[int, ...], Array]:
    """Unit screws that best complete the leg's own at home: forces 0 to 2, moments from 3.

    Also the wrenches that then belong to them, (missing, legs, 3 + moments), of unit length.
    """
    own = g.screws[:, :, joints]
    own = own / np.linalg.norm(own, axis=1, keepdims=True)
    unit = np.eye(own.shape[1])

    def completed(choice: tuple[int, ...]) -> Array:
        columns = np.broadcast_to(unit[:, choice], (len(own), len(unit), len(choice)))
        return np.concatenate((own, columns), axis=2)

    def distance(choice: tuple[int, ...]) -> float:
        return float(np.linalg.svd(completed(choice), compute_uv=False)[:, -1].min())

    # Moments first: wrenches without a force come out as such.
    choices = combinations(sorted(range(len(unit)), reverse=True), missing)
    best = max(choices, key=lambda choice: round(distance(choice), 6))
    wrenches = np.linalg.inv(completed(best))[:, own.shape[2] :, :]
    wrenches = wrenches / np.linalg.norm(wrenches, axis=2, keepdims=True)
    return best, np.swapaxes(wrenches, 0, 1)


def _per_unit_force(
    book: Book, g: LegGeometry, c: int, wrench: LeftOut, least: Any, unit: str
) -> LeftOut:
    """A wrench divided by the size of its force, whose square is measured by `least`."""
    force = wrench.force
    if not isinstance(force, VectorSymbol):
        force = book.define(
            g.name(f"f_c{c}_part"),
            force,
            rf"\mathbf f'_{{c{c}}}",
            "force that with the moment does no work along the leg's freedoms",
            Law.GEOMETRY,
            body=g.frame("axes", g.group[g.count]),
            unit=unit,
        )
    length = book.define(
        g.name(f"f_c{c}_size"),
        norm(force),
        rf"\lVert\mathbf f'_{{c{c}}}\rVert",
        "size of its force",
        Law.GEOMETRY,
        unit=unit,
        conditions=(Condition(Trouble.SINGULAR, Dot(force, force), least, 2),),
    )
    return _scaled(book, g, c, LeftOut(force, wrench.amounts), length)


def _per_unit_moment(book: Book, g: LegGeometry, c: int, wrench: LeftOut) -> LeftOut:
    """A wrench divided by the size of its moment, for one without a force at home."""
    if len(wrench.amounts) == 1:
        (amount,) = wrench.amounts
        return _scaled(book, g, c, wrench, amount, (Condition(Trouble.SINGULAR, amount, sp.S.One),))
    squared = sp.Add(*(amount**2 for amount in wrench.amounts))
    length = book.define(
        g.name(f"mu_c{c}_size"),
        sp.sqrt(squared),
        rf"\lVert\boldsymbol\mu_{{c{c}}}\rVert",
        "size of its moment",
        Law.GEOMETRY,
        conditions=(Condition(Trouble.SINGULAR, squared, sp.S.One, 2),),
    )
    return _scaled(book, g, c, wrench, length)


def _scaled(
    book: Book,
    g: LegGeometry,
    c: int,
    wrench: LeftOut,
    size: Any,
    conditions: tuple[Condition, ...] = (),
) -> LeftOut:
    """A wrench over a size."""
    direction = book.define(
        g.name(f"n_c{c}"),
        wrench.force / size,
        rf"\mathbf n_{{c{c}}}",
        f"force of unit wrench {c} that the leg's freedoms leave out",
        Law.GEOMETRY,
        body=g.frame("axes", g.group[g.count]),
        reference="Eq. 35",
        conditions=conditions,
    )
    several = len(wrench.amounts) > 1
    parts = tuple(
        sp.S.One
        if amount == size
        else book.define(
            g.name(f"mu_c{c}" + (f"_{i}" if several else "")),
            amount / size,
            rf"\mu_{{c{c},{i}}}" if several else rf"\mu_{{c{c}}}",
            "moment that goes with it" + (f", along direction {i}" if several else ""),
            Law.GEOMETRY,
            unit="m",
            reference="Eq. 35",
        )
        for i, amount in enumerate(wrench.amounts, 1)
    )
    return LeftOut(direction, parts)


def axis_across(g: LegGeometry, joints: list[int]) -> Vector | None:
    """A joint axis perpendicular to every velocity vector: e x r is across e itself."""
    for k in range(1, g.count + 1):
        if not g.turns(k):
            continue
        if all(_stays_across(g, k, j) for j in joints):
            return g.e[k]
    return None


def _stays_across(g: LegGeometry, k: int, j: int) -> bool:
    """Whether joint j cannot move the connection point along axis k, by structure."""
    if g.turns(j):
        return j not in g.pitch and bool(g.parallel(k, j))
    return bool(g.perpendicular(k, j))


def _unit(book: Book, g: LegGeometry, c: int, vector: Vector) -> Vector:
    unit: Vector = book.define(
        g.name(f"n_c{c}"),
        vector / norm(vector),
        rf"\mathbf n_{{c{c}}}",
        "unit vector that the leg's freedoms leave out",
        Law.GEOMETRY,
        body=g.frame("axes", g.group[g.count]),
        reference="Eq. 35",
    )
    return unit
