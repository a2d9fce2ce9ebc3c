"""Wrenches reciprocal to a leg's degrees of freedom and the directions that complete them.

Each does work along one direction of the basis alone, and that unit work: those of auxiliary
directions do none along any degree of freedom of the leg, and constrain the platform.

Reference: section 3.7, Eqs. 35 to 37.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import sympy as sp

from pne_sym.derivation import Book, Condition, FailureStatus, ReciprocalBasis
from pne_sym.mechanics.completion import Auxiliary, Kind
from pne_sym.mechanics.directions import AXES, unit
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
a_c#        | \hat{\mathbf a}_{c#} | given @tip
    coordinate direction of the last link, to complete the leg's degrees of freedom
t_c#        | \mathbf t_{c#}      | GEOMETRY @tip
    velocity of the connection point as it turns about the fixed centre
f_c#        | \mathbf n'_{c#}     | RECIPROCITY @tip | Eq. 35
    force part of constraint wrench #
m#_c%       | \upsilon'_{c%#}     | RECIPROCITY | Eq. 35
    moment part # of constraint wrench %
size_c#     | \psi_{c#}           | GEOMETRY
    size of the %
n_c#        | \mathbf n_{c#}      | GEOMETRY @tip | Eq. 35
    unit force of the constraint wrench
mu#_c%      | \upsilon_{c%#}      | GEOMETRY | Eq. 35
    moment along direction # that goes with it
mu_c#       | \mathbf o_{c#}      | GEOMETRY @tip | Eq. 35
    the moment that goes with it
""")


class Column(NamedTuple):
    """A column of a leg's system: a degree of freedom, or what completes these to a basis.

    Attributes:
        vector: velocity of the connection point.
        turns: angular velocity along the directions of the moments that are transmitted.
        scale: size of the vector.
    """

    vector: Any
    turns: tuple[Any, ...]
    scale: Any


class ConstraintWrench(NamedTuple):
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
    auxiliary: Column | None = None

    def motion(self, length: Any) -> Column:
        """What completes the leg's degrees of freedom.

        Along its force, or about its moment: the leg's force has lambda, and no more, of what
        works on that motion, so lambda is its component.  Force and moment together would be no
        motion: a length would have to make them one.

        Args:
            length: of the leg, by which what turns moves points.
        """
        vector, turns = self.force, tuple(sp.S.Zero for _ in self.coefficients)
        if self.auxiliary is not None:
            vector, turns = self.auxiliary.vector, self.auxiliary.turns
        elif self.of_moment:
            vector, turns = ZeroVector, self.coefficients
        return Column(vector, turns, length if any(turn != 0 for turn in turns) else sp.S.One)


def reciprocal_values(columns: Sequence[Column]) -> list[tuple[Any, list[Any]]]:
    """Of the wrench reciprocal to each column: its force part, its moment parts."""
    rows = [sp.Tuple(*row) for row in _rows(columns)]
    screws = sp.Tuple(*(c.vector for c in columns)), sp.Tuple(*rows)
    return [
        (DualVector(k, *screws), [DualScalar(k, sp.Integer(i), *screws) for i in range(len(rows))])
        for k in map(sp.Integer, range(len(columns)))
    ]


def note_basis(
    book: Book,
    g: LegGeometry,
    columns: Sequence[Column],
    duals: Iterable[Any],
    moments: Iterable[Sequence[Any]],
) -> None:
    """Tell the lowering what is reciprocal to what."""
    frames = dict.fromkeys(g.frame("axes", g.group[j]) for j in range(g.count, -1, -1))
    book.bases.append(
        ReciprocalBasis(
            g.leg_type.name,
            tuple(c.vector for c in columns),
            tuple(duals),
            tuple(c.scale for c in columns),
            tuple(frames),
            _rows(columns),
            tuple(map(tuple, moments)),
            g.size,
        )
    )


def _rows(columns: Sequence[Column]) -> tuple[tuple[Any, ...], ...]:
    """Turns of all columns, by moment directions."""
    return tuple(zip(*(c.turns for c in columns), strict=True))


def completed_wrenches(
    book: Book, g: LegGeometry, dofs: Sequence[Column], directions: list[Any]
) -> list[ConstraintWrench]:
    """The wrenches reciprocal to a leg's degrees of freedom: of unit force, or unit moments."""
    chosen, eq = g.completion, Writer(book, g, _TERMS)
    own = [_column(book, g, auxiliary, directions) for auxiliary in chosen]
    parts = []
    values = reciprocal_values([*own, *dofs])[: len(chosen)]
    for k, (force, moments) in enumerate(values, 1):
        named = eq("f_c#", force, k)
        parts.append((named, tuple(eq("m#_c%", m, i, k) for i, m in enumerate(moments, 1))))
    found = [
        _of_unit_size(eq, k, auxiliary, force, moments, directions)
        for k, (auxiliary, (force, moments)) in enumerate(zip(chosen, parts, strict=True), 1)
    ]
    if any(auxiliary.kind is Kind.TURN for auxiliary in chosen):
        # Forces of several wrenches may be in one plane there.
        found = [w._replace(auxiliary=c) for w, c in zip(found, own, strict=True)]
    forces, moments_of = zip(*parts, strict=True)
    note_basis(book, g, [*own, *dofs], forces, moments_of)
    return found


def _column(book: Book, g: LegGeometry, auxiliary: Auxiliary, directions: list[Any]) -> Column:
    """Velocity of the connection point, and angular velocity along the moment directions."""
    number = auxiliary.number
    if auxiliary.kind is Kind.RIGHT_ANGLE:
        turns = tuple(sp.Integer(int(i == number)) for i in range(len(directions)))
        return Column(ZeroVector, turns, g.size)
    a = direction(book, g, number)
    if auxiliary.kind is Kind.SLIDE:
        return Column(a, tuple(sp.S.Zero for _ in directions), sp.S.One)
    velocity = Writer(book, g, _TERMS)("t_c#", Cross(a, g.platform_point), number + 1)
    return Column(velocity, tuple(Dot(a, n) for n in directions), g.size)


def direction(book: Book, g: LegGeometry, axis: int) -> VectorSymbol:
    """A coordinate direction of the last link."""
    symbol = VectorSymbol(g.name(f"a_c{axis + 1}"))
    if symbol.name not in book.notation:
        Writer(book, g, _TERMS).give("a_c#", unit(AXES[axis]), axis + 1)
    return symbol


def _of_unit_size(
    eq: Writer,
    k: int,
    auxiliary: Auxiliary,
    force: Any,
    coefficients: tuple[Any, ...],
    directions: list[Any],
) -> ConstraintWrench:
    """The same wrench for a force, or a moment, of size one."""
    acts, of_moment = auxiliary.acts, not auxiliary.of_force
    size = _size(eq, k, auxiliary, force, coefficients)
    n = eq("n_c#", force / size, k)
    moments = tuple(eq("mu#_c%", m / size, i, k) for i, m in enumerate(coefficients, 1))
    if not moments:
        return ConstraintWrench(n, acts=acts, of_moment=of_moment)
    total = vector_sum(m * n for m, n in zip(moments, directions, strict=True))
    return ConstraintWrench(n, moments, eq("mu_c#", total, k), acts, of_moment)


def _size(
    eq: Writer, k: int, auxiliary: Auxiliary, force: Any, coefficients: tuple[Any, ...]
) -> Any:
    """Size of the force, or of the moment: singular where it vanishes.

    That of a moment is by its parts along orthonormal directions; a single one keeps its sign.
    """
    assert eq.g is not None
    size, what, power = norm(force), "force", 0
    if not auxiliary.of_force:
        squares = (a**2 for a in coefficients)
        size = coefficients[0] if len(coefficients) == 1 else sp.sqrt(sp.Add(*squares))
        what, power = "moment", 1
    power_of_length = power - (auxiliary.kind is not Kind.SLIDE)
    regular = Condition(FailureStatus.SINGULAR, size, eq.g.size**power_of_length)
    return eq("size_c#", size, k, what, conditions=(regular,))
