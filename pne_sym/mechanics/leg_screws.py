"""Velocity vectors of a leg's joints, and the wrenches that are reciprocal to them.

Reference: sections 2.2 and 2.3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from pne_sym.derivation import Book, ReciprocalBasis
from pne_sym.mechanics.constraints import (
    constraint_directions,
    constraint_wrenches,
    plane_normal,
)
from pne_sym.mechanics.leg_chain import LegChain
from pne_sym.mechanics.reciprocal_wrenches import (
    ConstraintWrench,
    DegreesOfFreedom,
    completed_wrenches,
)
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.vector import Cross, Dot, DualScalar, DualVector, Vector, VectorSymbol, vector_sum

_TERMS = glossary(r"""
v_#        | \mathbf v_{#}            | RATE | Sec. 2.2, joint table
    velocity of the connection point per rate of joint #
o_#        | \mathbf o_{#}            | RECIPROCITY RECIPROCAL | Sec. 2.2, joint table
    moment part of reciprocal wrench #
n_m#       | \mathbf n_{m#}           | GEOMETRY | Sec. 2.2, joint table
    direction # of the moment that the platform joint transmits
m#_%       | \upsilon_{&#}            | RECIPROCITY | Sec. 2.2, joint table
    moment part # of reciprocal wrench &
w_#        | \mathbf w_{#}            | RECIPROCITY RECIPROCAL | Sec. 2.3
    reciprocal vector %
wn_#       | \mathbf w_{c#}           | RECIPROCITY RECIPROCAL | Sec. 2.3
    reciprocal vector %
""")
_WRENCH = {"title": "force part of reciprocal wrench {k}", "reference": "Sec. 2.2, joint table"}


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


@dataclass(frozen=True)
class _Screw:
    """A column of a leg's system: a degree of freedom, or what completes these to a basis.

    Attributes:
        stem: of the vector reciprocal to it.
        number: of the joint, or of the wrench.
        is_angle: its displacement is an angle.
    """

    stem: str
    number: int
    is_angle: bool = False

    @property
    def joint(self) -> int:
        """The joint; 0 for a wrench."""
        return self.number if self.stem == "w_#" else 0


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
        vectors: list[Any] = [v[j] for j in joints]
        scales: list[Any] = [g.size * g.turn(j) if g.turns(j) else sp.S.One for j in joints]
        directions = self._moment_directions()
        rows = [[Dot(g.spin(j), n) for j in joints] for n in directions]
        missing = (2 if self.planar else 3) + len(rows) - len(joints)
        frame = self.chain.tip_frame
        dofs = DegreesOfFreedom(
            list(vectors), [list(r) for r in rows], list(scales), directions, frame
        )
        wrenches = self._constraint_wrenches(v, joints, missing, dofs)
        for wrench in wrenches:
            vector, turns = wrench.motion
            vectors.append(vector)
            scales.append(g.size if any(turn != 0 for turn in turns) else sp.S.One)
            for row, turn in zip(rows, turns, strict=True):
                row.append(turn)
        duals, coefficients = self._reciprocals(joints, missing, vectors, rows)
        o, named = self._moment_parts(joints, coefficients, directions)
        self._note_basis(vectors, duals, scales, rows, coefficients)
        w, m = (dict(zip(joints, parts, strict=False)) for parts in (duals, coefficients))
        constraints = [wrench for wrench in wrenches if wrench.acts]
        return LegScrews(self.chain, residual, v, w, o, m, directions, constraints, named)

    def _velocity_vector(self, j: int, rods: dict[int, Vector]) -> Vector:
        g = self.g
        if not g.turns(j):
            return g.e[j]
        vector, like = Cross(g.spin(j), rods[j]) + g.slide(j), g.turn(j) * g.size
        named: Vector = self.eq("v_#", vector, j, body=self.chain.tip_frame, like=like)
        return named

    def _moment_directions(self) -> list[Any]:
        """Directions of the moments that the platform joint transmits."""
        frame = self.chain.tip_frame
        return [
            self.eq("n_m#", Cross(link, platform), k, body=frame)
            for k, (link, platform) in enumerate(self.g.pairs, 1)
        ]

    def _constraint_wrenches(
        self, v: dict[int, Vector], joints: list[int], missing: int, dofs: DegreesOfFreedom
    ) -> list[ConstraintWrench]:
        """Wrenches that do no work along the leg's degrees of freedom."""
        book, g = self.book, self.g
        if missing == 0:
            return []
        if not all(auxiliary.acts for auxiliary in g.completion):
            return completed_wrenches(book, g, g.completion, dofs)
        if dofs.directions:
            return constraint_wrenches(book, g, v, joints, dofs)
        normals = constraint_directions(book, g, v, joints, missing, self.planar)
        return [ConstraintWrench(normal) for normal in normals]

    # ---- reciprocal wrenches -----------------------------------------------------------

    def _reciprocals(
        self, joints: list[int], missing: int, vectors: list[Any], rows: list[list[Any]]
    ) -> tuple[list[Any], list[list[Any]]]:
        """Force parts, and moment parts as coefficients where the leg transmits moments."""
        screws = [
            *(_Screw("w_#", j, self.g.kind(j).is_angle) for j in joints),
            *(_Screw("wn_#", k) for k in range(1, missing + 1)),
        ]
        if rows:
            return self._define_wrenches(vectors, rows, screws)
        return self._define_duals(vectors, screws), []

    def _define_wrenches(
        self, vectors: list[Any], rows: list[list[Any]], screws: list[_Screw]
    ) -> tuple[list[Any], list[list[Any]]]:
        """Reciprocal wrenches where the leg transmits moments."""
        columns = sp.Tuple(*vectors), sp.Tuple(*(sp.Tuple(*row) for row in rows))
        duals, moments = [], []
        for k, screw in enumerate(screws, 1):
            value = DualVector(sp.Integer(k - 1), *columns)
            duals.append(self._reciprocal(k, screw, value, _WRENCH))
            parts = range(1, len(rows) + 1)
            moments.append([self._moment_part(k, i, screw, columns) for i in parts])
        return duals, moments

    def _moment_part(self, k: int, i: int, screw: _Screw, columns: tuple[Any, Any]) -> Any:
        value = DualScalar(sp.Integer(k - 1), sp.Integer(i - 1), *columns)
        name = screw.stem.replace("#", str(screw.number))
        return self.eq("m#_%", value, i, name, k)

    def _define_duals(self, vectors: list[Any], screws: list[_Screw]) -> list[Any]:
        if len(vectors) == 2:
            normal = plane_normal(self.book, self.g)
            others = [(vectors[1], normal), (normal, vectors[0])]
        else:
            others = [(vectors[(k + 1) % 3], vectors[(k + 2) % 3]) for k in range(3)]
        across = [Cross(*pair) for pair in others]
        return [
            self._reciprocal(k, screw, a / Dot(v, a), {})
            for k, (v, a, screw) in enumerate(zip(vectors, across, screws, strict=True), 1)
        ]

    def _reciprocal(self, k: int, screw: _Screw, value: Any, facts: dict[str, str]) -> Any:
        """Vector k reciprocal to the others."""
        told = {name: text.format(k=k) for name, text in facts.items()}
        joint, body = screw.joint, self.chain.tip_frame
        return self.eq(screw.stem, value, screw.number, k, joint=joint, body=body, **told)

    def _moment_parts(
        self, joints: list[int], coefficients: list[list[Any]], directions: list[Any]
    ) -> tuple[dict[int, Vector], dict[Any, Any]]:
        """Moment parts of the reciprocal wrenches by joint, and what has these names."""
        o: dict[int, Vector] = {}
        named: dict[Any, Any] = {}
        for j, own in zip(joints, coefficients, strict=False):
            moment = vector_sum(m * n for m, n in zip(own, directions, strict=True))
            o[j] = named[moment] = self.eq("o_#", moment, j, body=self.chain.tip_frame)
        return o, named

    def _note_basis(
        self,
        vectors: list[Any],
        duals: list[Any],
        scales: list[Any],
        rows: list[list[Any]],
        coefficients: list[list[Any]],
    ) -> None:
        """Tell the lowering what is reciprocal to what."""
        g = self.g
        frames = tuple(dict.fromkeys(g.frame("axes", g.group[j]) for j in range(g.count, -1, -1)))
        self.book.bases.append(
            ReciprocalBasis(
                g.leg_type.name,
                tuple(vectors),
                tuple(duals),
                tuple(scales),
                frames,
                tuple(tuple(row) for row in rows),
                tuple(tuple(m) for m in coefficients),
                g.size,
            )
        )
