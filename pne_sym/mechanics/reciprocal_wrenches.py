"""Wrenches reciprocal to a leg's degrees of freedom and the directions that complete them.

Each does work along one direction of the basis alone, and that unit work: those of auxiliary
directions do none along any degree of freedom of the leg, and constrain the platform.

Reference: section 3.7, Eqs. 35 to 37.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from pne_sym.derivation import Book, Condition, FailureStatus, ReciprocalBasis
from pne_sym.mechanics.completion import Auxiliary, Kind
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.terms import Writer, glossary
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

_TERMS = glossary(r"""
a_c#        | \hat{\mathbf a}_{c#} | given
    coordinate direction of the last link, to complete the leg's degrees of freedom
t_c#        | \mathbf t_{c#}      | GEOMETRY
    velocity of the connection point as it turns about the fixed centre
f_c#        | \mathbf n'_{c#}     | RECIPROCITY | Eq. 35
    force part of constraint wrench #
m#_c%       | \upsilon'_{c%#}     | RECIPROCITY | Eq. 35
    moment part # of constraint wrench %
size_c#     | \psi_{c#}           | GEOMETRY
    size of the %
n_c#        | \mathbf n_{c#}      | GEOMETRY | Eq. 35
    unit force of the constraint wrench
mu#_c%      | \upsilon_{c%#}      | GEOMETRY | Eq. 35
    moment along direction # that goes with it
mu_c#       | \mathbf o_{c#}      | GEOMETRY | Eq. 35
    the moment that goes with it
""")


@dataclass(frozen=True)
class ConstraintWrench:
    """A wrench that does no work along a leg's degrees of freedom: lambda is its coefficient.

    Attributes:
        force: of the leg on the platform at the connection point, per unit lambda.
        coefficients: along the moment directions, per unit lambda.
        moment: the moment that they make.
        acts: it does work along some motion of the platform.
        of_moment: lambda is a moment, not a force.
        auxiliary: motion that completes the leg's degrees of freedom in its place; None: its own.
    """

    force: Vector
    coefficients: tuple[Any, ...] = ()
    moment: Vector = ZeroVector
    acts: bool = True
    of_moment: bool = False
    auxiliary: tuple[Any, tuple[Any, ...]] | None = None

    @property
    def motion(self) -> tuple[Any, tuple[Any, ...]]:
        """What completes the leg's degrees of freedom: velocity, turns along the directions.

        Along its force, or about its moment: the leg's force has lambda, and no more, of what
        works on that motion, so lambda is its component.  Force and moment together would be no
        motion: a length would have to make them one.
        """
        if self.auxiliary is not None:
            return self.auxiliary
        if self.of_moment:
            return ZeroVector, self.coefficients
        return self.force, tuple(sp.S.Zero for _ in self.coefficients)


@dataclass(frozen=True)
class DegreesOfFreedom:
    """Degrees of freedom of a leg as columns that are to be completed.

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
    book: Book, g: LegGeometry, chosen: Sequence[Auxiliary], dofs: DegreesOfFreedom
) -> list[ConstraintWrench]:
    """The wrenches reciprocal to a leg's degrees of freedom: of unit force, or unit moments."""
    columns = [_column(book, g, auxiliary, dofs) for auxiliary in chosen]
    vectors = [*(vector for vector, _ in columns), *dofs.vectors]
    rows = [[*(entries[i] for _, entries in columns), *row] for i, row in enumerate(dofs.rows)]
    screws = sp.Tuple(*vectors), sp.Tuple(*(sp.Tuple(*row) for row in rows))
    writer = _WrenchWriter(book, g, dofs.directions, dofs.frame)
    parts = [writer.reciprocal(k, a, screws, len(rows)) for k, a in enumerate(chosen)]
    found = [writer.of_unit_size(k, a, *parts[k]) for k, a in enumerate(chosen)]
    if any(auxiliary.kind is Kind.TURN for auxiliary in chosen):
        # Forces of several wrenches may be in one plane there.
        columns_of = [(vector, tuple(entries)) for vector, entries in columns]
        found = [replace(w, auxiliary=c) for w, c in zip(found, columns_of, strict=True)]
    frames = dict.fromkeys(g.frame("axes", g.group[j]) for j in range(g.count, -1, -1))
    book.bases.append(
        ReciprocalBasis(
            g.leg_type.name,
            tuple(vectors),
            tuple(force for force, _ in parts),
            # Turns move points by lengths.
            (*(sp.S.One if a.kind is Kind.SLIDE else g.size for a in chosen), *dofs.scales),
            tuple(frames),
            tuple(tuple(row) for row in rows),
            tuple(coefficients for _, coefficients in parts),
            g.size,
        )
    )
    return found


def _column(
    book: Book, g: LegGeometry, auxiliary: Auxiliary, dofs: DegreesOfFreedom
) -> tuple[Any, list[Any]]:
    """Velocity of the connection point, and angular velocity along the moment directions."""
    number = auxiliary.number
    if auxiliary.kind is Kind.RIGHT_ANGLE:
        return ZeroVector, [sp.Integer(int(i == number)) for i in range(len(dofs.rows))]
    a = direction(book, g, number, dofs.frame)
    if auxiliary.kind is Kind.SLIDE:
        return a, [sp.S.Zero for _ in dofs.rows]
    eq = Writer(book, g, _TERMS)
    velocity = eq("t_c#", Cross(a, g.platform_point), number + 1, body=dofs.frame)
    return velocity, [Dot(a, n) for n in dofs.directions]


def direction(book: Book, g: LegGeometry, axis: int, frame: str) -> VectorSymbol:
    """A coordinate direction of the last link."""
    symbol = VectorSymbol(g.name(f"a_c{axis + 1}"))
    if symbol.name in book.notation:
        return symbol
    components = (sp.Integer(int(i == axis)) for i in range(3))
    return Writer(book, g, _TERMS).give("a_c#", frame, components, axis + 1)


class _WrenchWriter:
    """Defines the wrenches reciprocal to auxiliary directions."""

    def __init__(self, book: Book, g: LegGeometry, directions: list[Any], frame: str) -> None:
        self.g, self.directions, self.frame = g, directions, frame
        self.eq = Writer(book, g, _TERMS)

    def reciprocal(
        self, k: int, auxiliary: Auxiliary, screws: tuple[Any, Any], transmitted: int
    ) -> tuple[Any, tuple[Any, ...]]:
        """The reciprocal wrench of auxiliary direction k: force, moment coefficients."""
        value = DualVector(sp.Integer(k), *screws)
        force = self.eq("f_c#", value, k + 1, body=self.frame)
        duals = (DualScalar(sp.Integer(k), sp.Integer(i), *screws) for i in range(transmitted))
        return force, tuple(self.eq("m#_c%", dual, i, k + 1) for i, dual in enumerate(duals, 1))

    def of_unit_size(
        self, k: int, auxiliary: Auxiliary, force: Any, coefficients: tuple[Any, ...]
    ) -> ConstraintWrench:
        """The same wrench for a force, or a moment, of size one."""
        number, acts, of_force = k + 1, auxiliary.acts, auxiliary.of_force
        size = self._size(number, auxiliary, force, coefficients)
        n = self.eq("n_c#", force / size, number, body=self.frame)
        moments = tuple(
            self.eq("mu#_c%", coefficient / size, i, number)
            for i, coefficient in enumerate(coefficients, 1)
        )
        if not moments:
            return ConstraintWrench(n, acts=acts, of_moment=not of_force)
        total = vector_sum(m * n for m, n in zip(moments, self.directions, strict=True))
        moment = self.eq("mu_c#", total, number, body=self.frame)
        return ConstraintWrench(n, moments, moment, acts, not of_force)

    def _size(
        self, number: int, auxiliary: Auxiliary, force: Any, coefficients: tuple[Any, ...]
    ) -> Any:
        """Size of the force, or of the moment: singular where it vanishes."""
        if auxiliary.of_force:
            size, what, slides_unit, turns_unit = norm(force), "force", 0, -1
        else:
            size, what, slides_unit, turns_unit = _size(coefficients), "moment", 1, 0
        power_of_length = slides_unit if auxiliary.kind is Kind.SLIDE else turns_unit
        regular = Condition(FailureStatus.SINGULAR, size, self.g.size**power_of_length)
        return self.eq("size_c#", size, number, what, conditions=(regular,))


def _size(coefficients: tuple[Any, ...]) -> Any:
    """Size of a moment by its parts along orthonormal directions; a single one keeps its sign."""
    return (
        coefficients[0]
        if len(coefficients) == 1
        else sp.sqrt(sp.Add(*(a**2 for a in coefficients)))
    )
