"""Velocity vectors of a leg's joints, and the wrenches that are reciprocal to them.

Reference: sections 2.2 and 2.3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from pne_sym.derivation import Book
from pne_sym.mechanics.constraints import constraint_directions, constraint_wrenches, plane_normal
from pne_sym.mechanics.leg_chain import LegChain
from pne_sym.mechanics.reciprocal_wrenches import (
    Column,
    ConstraintWrench,
    completed_wrenches,
    note_basis,
    reciprocal_values,
)
from pne_sym.mechanics.terms import Writer, filled, glossary
from pne_sym.vector import Cross, Dot, Vector, VectorSymbol, vector_sum

_TERMS = glossary(r"""
v_#        | \mathbf v_{#}            | RATE @tip | Sec. 2.2, joint table
    velocity of the connection point per rate of joint #
o_#        | \mathbf o_{#}            | RECIPROCITY RECIPROCAL @tip | Sec. 2.2, joint table
    moment part of reciprocal wrench #
n_m#       | \mathbf n_{m#}           | GEOMETRY @tip | Sec. 2.2, joint table
    direction # of the moment that the platform joint transmits
m#_%       | \upsilon_{&#}            | RECIPROCITY | Sec. 2.2, joint table
    moment part # of reciprocal wrench &
w_#        | \mathbf w_{#}            | RECIPROCITY RECIPROCAL @tip | Sec. 2.3
    reciprocal vector %
wn_#       | \mathbf w_{c#}           | RECIPROCITY RECIPROCAL @tip | Sec. 2.3
    reciprocal vector %
w_#:wrench | \mathbf w_{#}            | RECIPROCITY RECIPROCAL @tip | Sec. 2.2, joint table
    force part of reciprocal wrench %
wn_#:wrench | \mathbf w_{c#}          | RECIPROCITY RECIPROCAL @tip | Sec. 2.2, joint table
    force part of reciprocal wrench %
""")


@dataclass(frozen=True)
class LegScrews:
    """How the joints of a leg move the connection point.

    Attributes:
        chain: where its links are.
        residual: from the connection point as the links reach it to the platform's.
        v: velocity vectors v_j of the joints at the connection point.
        w: reciprocal vectors w_j (without extra joints).
        o: moment parts of the reciprocal wrenches, where the leg transmits moments.
        m: the same as coefficients along the moment directions.
        n: moment directions.
        constraints: wrenches that do no work along the leg's degrees of freedom.
        named: expressions that have a name, for coefficients that come out as such.
    """

    chain: LegChain
    residual: Any
    v: dict[int, Vector]
    w: dict[int, VectorSymbol]
    o: dict[int, Vector]
    m: dict[int, list[Any]]
    n: list[Any]
    constraints: list[ConstraintWrench]
    named: dict[Any, Any]

    def resolved(self, j: int, coefficients: Sequence[Any]) -> Any:
        """Part of joint j in what turns along the moment directions."""
        return sp.Add(*(m * a for m, a in zip(self.m.get(j, ()), coefficients, strict=False)))


class ScrewWriter:
    """Writes velocity vectors and reciprocal wrenches of a leg."""

    def __init__(self, book: Book, chain: LegChain, *, planar: bool) -> None:
        self.book, self.chain, self.g, self.planar = book, chain, chain.g, planar
        self.eq = Writer(book, chain.g, _TERMS)

    def write(self, rods: dict[int, Vector], residual: Vector) -> LegScrews:
        """Velocity vectors, reciprocal wrenches; basis completion where degrees of freedom lack.

        Args:
            rods: from the origins of turning joints to the connection point.
            residual: from the connection point as the links reach it to the platform's.
        """
        g = self.g
        v = {j: self._velocity_vector(j, rods) for j in self.chain.joints}
        joints = [j for j in self.chain.joints if not g.is_extra(j)]
        # Directions of the moments that the platform joint transmits.
        directions = [self.eq("n_m#", Cross(*pair), k) for k, pair in enumerate(g.pairs, 1)]
        dofs = [
            Column(
                v[j],
                tuple(Dot(g.spin(j), n) for n in directions),
                g.size * g.turn(j) if g.turns(j) else sp.S.One,
            )
            for j in joints
        ]
        wrenches = self._constraint_wrenches(v, joints, dofs, directions)
        columns = [*dofs, *(wrench.motion(g.size) for wrench in wrenches)]
        duals, coefficients = self._reciprocals(joints, columns)
        o, named = self._moment_parts(joints, coefficients, directions)
        note_basis(self.book, g, columns, duals, coefficients)
        w, m = (dict(zip(joints, parts, strict=False)) for parts in (duals, coefficients))
        constraints = [wrench for wrench in wrenches if wrench.acts]
        return LegScrews(self.chain, residual, v, w, o, m, directions, constraints, named)

    def _velocity_vector(self, j: int, rods: dict[int, Vector]) -> Vector:
        g = self.g
        if not g.turns(j):
            return g.e[j]
        vector, like = Cross(g.spin(j), rods[j]) + g.slide(j), g.turn(j) * g.size
        named: Vector = self.eq("v_#", vector, j, like=like)
        return named

    def _constraint_wrenches(
        self, v: dict[int, Vector], joints: list[int], dofs: list[Column], directions: list[Any]
    ) -> list[ConstraintWrench]:
        """Wrenches that do no work along the leg's degrees of freedom."""
        book, g = self.book, self.g
        missing = (2 if self.planar else 3) + len(directions) - len(joints)
        if missing == 0:
            return []
        if not all(auxiliary.acts for auxiliary in g.completion):
            return completed_wrenches(book, g, dofs, directions)
        if directions:
            return constraint_wrenches(book, g, joints, dofs, directions)
        normals = constraint_directions(book, g, v, joints, missing, self.planar)
        return [ConstraintWrench(normal) for normal in normals]

    # ---- reciprocal wrenches -----------------------------------------------------------

    def _reciprocals(
        self, joints: list[int], columns: list[Column]
    ) -> tuple[list[Any], list[list[Any]]]:
        """Force parts, and moment parts as coefficients where the leg transmits moments."""
        moments = bool(columns[0].turns)
        values = reciprocal_values(columns) if moments else self._across(columns)
        others = range(1, len(columns) - len(joints) + 1)
        stems = [*(("w_#", j, j) for j in joints), *(("wn_#", k, 0) for k in others)]
        duals, coefficients = [], []
        for k, ((stem, number, joint), (force, parts)) in enumerate(
            zip(stems, values, strict=True), 1
        ):
            row = f"{stem}:wrench" if moments else stem
            duals.append(self.eq(row, force, number, k, joint=joint))
            name = filled(stem, (number,))
            coefficients.append([self.eq("m#_%", m, i, name, k) for i, m in enumerate(parts, 1)])
        return duals, coefficients if moments else []

    def _across(self, columns: list[Column]) -> list[tuple[Any, list[Any]]]:
        """Vectors reciprocal to others: each across all others."""
        vectors = [column.vector for column in columns]
        if len(vectors) == 2:
            normal = plane_normal(self.book, self.g)
            others = [(vectors[1], normal), (normal, vectors[0])]
        else:
            others = [(vectors[(k + 1) % 3], vectors[(k + 2) % 3]) for k in range(3)]
        across = [Cross(*pair) for pair in others]
        return [(a / Dot(v, a), []) for v, a in zip(vectors, across, strict=True)]

    def _moment_parts(
        self, joints: list[int], coefficients: list[list[Any]], directions: list[Any]
    ) -> tuple[dict[int, Vector], dict[Any, Any]]:
        """Moment parts of the reciprocal wrenches by joint, and what has these names."""
        o: dict[int, Vector] = {}
        named: dict[Any, Any] = {}
        for j, own in zip(joints, coefficients, strict=False):
            moment = vector_sum(m * n for m, n in zip(own, directions, strict=True))
            o[j] = named[moment] = self.eq("o_#", moment, j)
        return o, named
