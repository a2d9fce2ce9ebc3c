"""Directions that complete a leg's freedoms to a full basis, and the wrenches reciprocal to them.

A leg with fewer freedoms than its platform joint leaves to be determined restricts the platform.
Auxiliary directions, fixed in the last link, complete its freedoms to a basis; the reciprocal
wrench of an auxiliary direction does no work along any freedom.  Which directions serve is
settled at home, where the basis must be well conditioned for every leg of the type.

Reference: section 3.7, Eqs. 35 to 37.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, product
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from pne_sym.derivation import Book, Law, Quantity, ReciprocalBasis
from pne_sym.mechanics.leg_geometry import LegGeometry, two_across
from pne_sym.mechanics.scope import axes_at, velocity_vectors
from pne_sym.mechanics.structure import is_coordinate
from pne_sym.model.closure import pose_at
from pne_sym.model.manipulator import JointKind, Leg, Manipulator, PlatformJointKind
from pne_sym.vector import (
    DualScalar,
    DualVector,
    Vector,
    VectorSymbol,
    ZeroVector,
    norm,
    vector_sum,
)

Array = NDArray[np.float64]
_PURE = 1e-6  # joint axes make no angle with a moment direction: sine below it
_BETTER = 1.01  # a choice replaces an earlier one only if it is better by this factor


@dataclass(frozen=True)
class Completion:
    """Directions that complete the freedoms of a leg type.

    Attributes:
        forces: coordinate directions of the last link, by number.
        moments: moment directions, by number; their wrenches are pure moments at home.
    """

    forces: tuple[int, ...]
    moments: tuple[int, ...]


def completion_at_home(manipulator: Manipulator, g: LegGeometry, missing: int) -> Completion:
    """The choice for which the worst conditioned leg of a type is conditioned best."""
    bases = [_freedoms(manipulator, g, row) for row in range(g.leg_type.count)]
    transmitted = len(g.pairs)
    turning = [basis[3:] for basis in bases]
    pure = max(transmitted - _rank(rows) for rows in turning)
    choices = list(
        product(combinations(range(3), missing - pure), combinations(range(transmitted), pure))
    )
    best, chosen = 0.0, choices[0]
    for choice in choices:
        forces, moments = choice
        units = np.eye(3 + transmitted)[:, [*forces, *(3 + i for i in moments)]]
        quality = min(float(np.linalg.svd(np.hstack([b, units]))[1][-1]) for b in bases)
        if quality > _BETTER * best:
            best, chosen = quality, choice
    return Completion(*chosen)


def _freedoms(manipulator: Manipulator, g: LegGeometry, row: int) -> Array:
    """Unit columns (3 + moments, freedoms): velocities in the last link's axes, and turning."""
    index = g.leg_type.indices[row]
    leg = manipulator.legs[index]
    start = sum(len(other.joints) for other in manipulator.legs[:index])
    q = np.array(manipulator.home.q[start : start + len(leg.joints)])
    pose = pose_at(manipulator.space, manipulator.home.X, manipulator.fixed_centre)
    free = [j for j, joint in enumerate(leg.joints) if not joint.extra]
    axes, last = axes_at(leg, q)
    turns = [joint.kind is not JointKind.PRISMATIC for joint in leg.joints]
    angular = np.array(axes).T * turns
    linear = velocity_vectors(leg, q)
    tip = last @ g.canonical[g.group[g.count]][row]
    directions = _moment_directions(leg, last, np.array(leg.base_frame).T @ pose.R)
    columns = np.vstack([tip.T @ linear, directions[: len(g.pairs)] @ angular])[:, free]
    return np.asarray(columns / np.linalg.norm(columns, axis=0))


def _moment_directions(leg: Leg, last: Array, leg_R_platform: Array) -> Array:
    """Directions (k, 3) of the moments that a leg's platform joint transmits, in leg axes."""
    end = leg.platform_joint
    if end.kind is PlatformJointKind.RIGID:
        return np.asarray(np.roll(last.T, -2, axis=0))
    if end.axis_link is None or end.axis_platform is None:
        return np.zeros((0, 3))
    platform = leg_R_platform @ np.array(end.axis_platform)
    if end.kind is PlatformJointKind.UNIVERSAL:
        return np.cross(last @ np.array(end.axis_link), platform)[None]
    number = sp.Integer if is_coordinate(end.axis_link) else sp.Float
    across = np.array(two_across([number(c) for c in end.axis_link]), dtype=float)
    return np.asarray(np.cross(across @ last.T, platform))


def _rank(rows: Array) -> int:
    return int(np.sum(np.linalg.svd(rows)[1] > _PURE)) if rows.size else 0


@dataclass(frozen=True)
class LeftOut:
    """A wrench that does no work along a leg's freedoms: lambda is its amount.

    Attributes:
        force: of the leg on the platform at the connection point, per unit lambda.
        amounts: along the moment directions, per unit lambda.
        moment: the moment that they make.
    """

    force: Vector
    amounts: tuple[Any, ...] = ()
    moment: Vector = ZeroVector


@dataclass(frozen=True)
class Freedoms:
    """Freedoms of a leg as columns that are to be completed.

    Attributes:
        vectors: velocity of the connection point, per joint that is not extra.
        rows: per moment direction, the part of each joint's axis along it.
        scales: sizes of the velocity vectors.
        directions: of the moments that the platform joint transmits.
        frame: of the last link.
    """

    vectors: list[Any]
    rows: list[list[Any]]
    scales: list[Any]
    directions: list[Any]
    frame: str


def completed_wrenches(
    book: Book, g: LegGeometry, chosen: Completion, freedoms: Freedoms
) -> list[LeftOut]:
    """The wrenches reciprocal to a leg's freedoms: of unit force, or pure unit moments."""
    count, frame = len(chosen.forces) + len(chosen.moments), freedoms.frame
    units = [direction(book, g, axis, frame) for axis in chosen.forces]
    vectors = [*units, *(ZeroVector for _ in chosen.moments), *freedoms.vectors]
    rows = [
        [*(sp.S.Zero for _ in units), *(sp.Integer(int(i == k)) for k in chosen.moments), *row]
        for i, row in enumerate(freedoms.rows)
    ]
    screws = sp.Tuple(*vectors), sp.Tuple(*(sp.Tuple(*row) for row in rows))
    found, duals, amounts = [], [], []
    for k in range(count):
        wrench = _dual(book, g, k, screws, len(rows), frame)
        duals.append(wrench[0])
        amounts.append(wrench[1])
        of_force = k < len(units)
        found.append(
            _unit_wrench(book, g, freedoms.directions, k + 1, wrench, frame, of_force=of_force)
        )
    frames = dict.fromkeys(g.frame("axes", g.group[j]) for j in range(g.count, -1, -1))
    book.bases.append(
        ReciprocalBasis(
            g.leg_type.name,
            tuple(vectors),
            tuple(duals),
            (*(sp.S.One for _ in range(count)), *freedoms.scales),
            tuple(frames),
            tuple(tuple(row) for row in rows),
            tuple(amounts),
        )
    )
    return found


def direction(book: Book, g: LegGeometry, axis: int, frame: str) -> VectorSymbol:
    """A coordinate direction of the last link."""
    symbol = VectorSymbol(g.name(f"a_c{axis + 1}"))
    if symbol.name not in book.notation:
        meaning = "coordinate direction of the last link, to complete the leg's freedoms"
        latex = rf"\mathbf a_{{c{axis + 1}}}"
        quantity = Quantity(symbol.name, latex, meaning, "-", frame, parameter=True)
        book.give(symbol, frame, tuple(sp.Integer(int(i == axis)) for i in range(3)), quantity)
    return symbol


def _dual(
    book: Book, g: LegGeometry, k: int, screws: tuple[Any, Any], transmitted: int, frame: str
) -> tuple[Any, tuple[Any, ...]]:
    """The reciprocal wrench of auxiliary direction k: force, moment amounts."""
    force = book.define(
        g.name(f"f_c{k + 1}"),
        DualVector(sp.Integer(k), *screws),
        rf"\mathbf f_{{c{k + 1}}}",
        f"force part of the wrench that does no work along the leg's freedoms, {k + 1}",
        Law.RECIPROCITY,
        body=frame,
        reference="Eq. 35",
    )
    amounts = tuple(
        book.define(
            g.name(f"m{i + 1}_c{k + 1}"),
            DualScalar(sp.Integer(k), sp.Integer(i), *screws),
            f"m_{{c{k + 1}{i + 1}}}",
            f"moment part {i + 1} of the wrench that does no work along the leg's freedoms, "
            f"{k + 1}",
            Law.RECIPROCITY,
            reference="Eq. 35",
        )
        for i in range(transmitted)
    )
    return force, amounts


def _unit_wrench(
    book: Book,
    g: LegGeometry,
    directions: list[Any],
    number: int,
    wrench: tuple[Any, tuple[Any, ...]],
    frame: str,
    *,
    of_force: bool,
) -> LeftOut:
    """The wrench for a force, or a moment, of size one."""
    force, amounts = wrench
    size = book.define(
        g.name(f"size_c{number}"),
        norm(force if of_force else _moment(amounts, directions)),
        rf"\ell_{{c{number}}}",
        f"size of the {'force' if of_force else 'moment'}",
        Law.GEOMETRY,
    )
    unit = book.define(
        g.name(f"n_c{number}"),
        force / size,
        rf"\mathbf n_{{c{number}}}",
        "unit force that the leg's freedoms leave out"
        if of_force
        else "force part, zero where the loops close, of the unit moment that the leg's freedoms "
        "leave out",
        Law.GEOMETRY,
        body=frame,
        reference="Eq. 35",
    )
    moments = tuple(
        book.define(
            g.name(f"mu{i}_c{number}"),
            amount / size,
            rf"\mu_{{c{number}{i}}}",
            f"moment along direction {i} that goes with it",
            Law.GEOMETRY,
            reference="Eq. 35",
        )
        for i, amount in enumerate(amounts, 1)
    )
    if not moments:
        return LeftOut(unit)
    moment = book.define(
        g.name(f"mu_c{number}"),
        _moment(moments, directions),
        rf"\boldsymbol\mu_{{c{number}}}",
        "the moment that goes with it",
        Law.GEOMETRY,
        body=frame,
        reference="Eq. 35",
    )
    return LeftOut(unit, moments, moment)


def _moment(amounts: tuple[Any, ...], directions: list[Any]) -> Vector:
    return vector_sum(m * n for m, n in zip(amounts, directions, strict=True))
