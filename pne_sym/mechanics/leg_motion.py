"""Velocities and accelerations of a leg, and their linear forms in the platform's acceleration.

Reference: sections 2.2, 2.3 and 2.5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import sympy as sp

from pne_sym.derivation import Book, ReciprocalBasis, Role
from pne_sym.mechanics.completion import ConstraintWrench, DegreesOfFreedom, completed_wrenches
from pne_sym.mechanics.constraints import (
    constraint_directions,
    constraint_wrenches,
    plane_normal,
)
from pne_sym.mechanics.inverse_kinematics import InverseKinematics
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.linear_writer import Collection, LegMotion, LegRates, LegScrews, LinearWriter
from pne_sym.mechanics.platform_motion import BaseMotion, PlatformMotion
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.model.kinematics import TaskSpace
from pne_sym.vector import (
    Compose,
    Cross,
    Dot,
    DualScalar,
    DualVector,
    Skew,
    Vector,
    VectorSymbol,
    ZeroTensor,
    ZeroVector,
    linear_form,
    vector_sum,
)

_TERMS = glossary(r"""
r_#        | \mathbf r_{#}            | GEOMETRY
    from joint # to the connection point, along the links
S_dot      | \dot{\mathbf S}          | RATE POINT_VELOCITY | Sec. 2.5, step 1.1
    velocity of the connection point
v_#        | \mathbf v_{#}            | RATE | Sec. 2.2, joint table
    velocity of the connection point per rate of joint #
o_#        | \mathbf o_{#}            | RECIPROCITY RECIPROCAL | Sec. 2.2, joint table
    moment part of reciprocal wrench #
n_m#       | \mathbf n_{m#}           | GEOMETRY | Sec. 2.2, joint table
    direction # of the moment that the platform joint transmits
m#_%       | \upsilon_{&#}            | RECIPROCITY | Sec. 2.2, joint table
    moment part # of reciprocal wrench &
S_dot_rest | \dot{\mathbf S}'         | RATE
    velocity of the connection point left to the joints that are not extra
eta_#      | \eta_{#}                 | RATE
    rate at which the joints turn along moment direction #
qd_#       | \dot q_{#}               | RECIPROCITY RATE
    rate of joint #
omega_#    | \boldsymbol\omega_{#}    | RATE
    angular velocity of link #
W_#        | \mathbf C_{#}            | DEFINITION symmetric
    centripetal tensor of link #
u_1        | \mathbf u_1              | RATE | Eq. 23
    centripetal acceleration of the connection point
a_p        | \mathbf a_p              | RATE COLLECTED_ACCELERATION | Eq. 23
    acceleration of the connection point without its centripetal part
S_ddot     | \ddot{\mathbf S}         | RATE POINT_ACCELERATION | Eq. 23
    acceleration of the connection point
zeta_#     | \boldsymbol\zeta_{#}     | RATE
    angular acceleration of link # from the turning of axis #
bias       | \mathfrak b              | RATE BIAS | Sec. 2.2
    acceleration of the connection point at zero joint accelerations
rel        | \ddot{\mathbf S}' ; \mathbf E | RATE
    acceleration of the connection point left to the joint accelerations
etad_#     | \dot\eta_{#} ; \boldsymbol\eta_{#} | RATE
    acceleration with which the joints turn along moment direction #
qdd_#      | \ddot q_{#} ; \mathbf w_{#} | RECIPROCITY JOINT_ACCELERATION | Eqs. 8, 9, 16
    acceleration of joint #
nd_m#      | \dot{\mathbf n}_{m#}     | RATE
    rate of moment direction #
nu_#       | \nu_{#}                  | RATE | Sec. 2.2, joint table
    bias of the angular acceleration along moment direction #
alpha_#    | \boldsymbol\alpha_{#} ; \boldsymbol\Omega_{#} | RATE
    angular acceleration of link #
a_o_#      | \mathbf a_{o#} ; \boldsymbol\Theta_{o#} | RATE
    acceleration of the origin of joint #
w_#        | \mathbf w_{#}            | RECIPROCITY RECIPROCAL | Sec. 2.3
    reciprocal vector %
wn_#       | \mathbf w_{c#}           | RECIPROCITY RECIPROCAL | Sec. 2.3
    reciprocal vector %
yd_#       | \dot y_{#}               | given RATE | U/s
    rate of extra joint #
ydd_#      | \ddot y_{#}              | given JOINT_ACCELERATION | U/s^2
    acceleration of extra joint #
S_ddot_b   | \ddot{\mathbf S}_b       | MOVING_FRAME | beyond the paper
    acceleration of the connection point in space, less that of the base origin
a_b0       | \mathbf a_{b0}           | MOVING_FRAME | beyond the paper
    acceleration of the base point, less that of the base origin
omega_b_#  | \boldsymbol\omega_{b#}   | MOVING_FRAME | beyond the paper
    angular velocity of link # in space
W_b_#      | \mathbf W_{b#}           | DEFINITION symmetric
    centripetal tensor of link # in space
zeta_b_#   | \boldsymbol\zeta_{b#}    | MOVING_FRAME | beyond the paper
    angular acceleration of link # from the turning of its axis in space
beta_#     | \boldsymbol\beta_{#}     | RATE
    angular acceleration of link # at zero joint accelerations
B_#        | \mathbf B_{#}            | DEFINITION
    acceleration tensor of link #
B_#_o      | \mathbf B^{\circ}_{#}    | DEFINITION
    remainder of the acceleration tensor of link #
""")
_WRENCH = {"title": "force part of reciprocal wrench {k}", "reference": "Sec. 2.2, joint table"}

_RATES = (
    r"Each joint j moves the connection point along its velocity vector $`\mathbf v_j`$: "
    r"$`\dot{\mathbf S}=\sum_j\mathbf v_j\,\dot q_j`$. The reciprocal vectors $`\mathbf w_j`$, "
    r"with $`\mathbf w_j\cdot\mathbf v_k=1`$ for $`j=k`$ and 0 otherwise, solve this for the joint "
    r"rates. The centripetal tensor saves work: "
    r"$`\mathbf C_j\,\mathbf r=\boldsymbol\omega_j\times(\boldsymbol\omega_j\times\mathbf r)`$ for "
    r"every vector $`\mathbf r`$."
)
_ACCELERATIONS = (
    r"The bias $`\mathfrak b`$ is the acceleration that the connection point would have with all "
    r"joint accelerations zero; what is left, $`\ddot{\mathbf S}-\mathfrak b"
    r"=\sum_j\mathbf v_j\,\ddot q_j`$, is resolved like the velocity. "
)
_COLLECTED = (
    r"Whatever depends on the acceleration of the platform is then written as coefficient times "
    r"$`\mathbf a_p`$ plus remainder, by Rules I and II; a circle marks the remainder, the same "
    r"formula at $`\mathbf a_p=\mathbf 0`$. "
)
_REMAINDERS = (
    r"The accelerations of the joints are written as coefficient times $`\mathbf a_p`$ plus "
    r"remainder, by Rules I and II; what follows from them is written as it is and as remainder, "
    r"marked by a circle: the same formula at $`\mathbf a_p=\mathbf 0`$. "
)
_TENSOR = (
    r"The acceleration tensor saves work: "
    r"$`\mathbf B_j\,\mathbf r=\boldsymbol\alpha_j\times\mathbf r+\mathbf C_j\,\mathbf r`$."
)


_WITH_BASE = (
    r"Velocities and accelerations in space, in axes that turn with the base: those relative to "
    r"the base, and those of a point or body that is carried along. That of the base origin counts "
    r"with gravity, $`\mathbf g_f`$."
)


@dataclass(frozen=True)
class _Screw:
    """A column of a leg's system: a degree of freedom, or a constraint wrench.

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


@dataclass(frozen=True)
class _Bias:
    """Accelerations at zero joint accelerations.

    Attributes:
        point: of the connection point.
        coriolis: angular, from the turning of the group's axis, by group.
        beta: angular, by group.
    """

    point: Vector
    coriolis: dict[int, Vector]
    beta: dict[int, Vector]


def _resolved(screws: LegScrews, j: int, coefficients: Sequence[Any]) -> Any:
    """Part of joint j in what turns along the moment directions."""
    return sp.Add(*(m * a for m, a in zip(screws.m.get(j, ()), coefficients, strict=False)))


class MotionWriter:
    """Writes rates and accelerations of a leg."""

    def __init__(
        self,
        book: Book,
        g: LegGeometry,
        platform: PlatformMotion,
        space: TaskSpace,
        inverse: InverseKinematics,
    ) -> None:
        self.book, self.g, self.p, self.space = book, g, platform, space
        self.q = inverse.q
        self.x = inverse.x
        self.S = inverse.S
        self.is_closed = inverse.is_closed
        self.eq = Writer(book, g, _TERMS)

    def write(self, prefix: str) -> LegMotion:
        """Write the chapters on rates and accelerations."""
        leg_type = self.g.leg_type
        self.book.chapter(
            f"{prefix}-V", f"Rates of a {leg_type.architecture} leg", _RATES, leg_type.name
        )
        rates = self.velocity()
        self.end_turning = self.p.omega - rates.omega[self.g.group[self.g.count]]
        self.book.chapter(
            f"{prefix}-A",
            f"Accelerations of a {leg_type.architecture} leg",
            _ACCELERATIONS
            + (_REMAINDERS if self.g.composite else _COLLECTED)
            + self._other_accelerations()
            + _TENSOR,
            leg_type.name,
        )
        return self.acceleration(rates)

    def _other_accelerations(self) -> str:
        """Which accelerations are collected besides that of the connection point."""
        others = [r"the platform's $`\boldsymbol\alpha`$"] * bool(
            self.g.pairs and self.space.rotates
        )
        if any(self.g.is_extra(j) for j in range(1, self.g.count + 1)):
            others.append(r"those of the extra joints, $`\ddot y_j`$")
        if not others:
            return ""
        return f"What depends on {' and '.join(others)} is collected likewise. "

    # ---- positions along the chain -------------------------------------------------

    def reach(self, j: int) -> Vector:
        """From the origin of the group of link j to the origin of link j."""
        g = self.g
        first = g.group[j]
        terms = [self._along(first)] if first else []
        for i in range(first + 1, j + 1):
            terms.extend((g.offset[i], self._along(i)))
        return vector_sum(terms)

    def _along(self, j: int) -> Vector:
        """Displacement along axis j."""
        return self.q[j] * self.g.slide(j) if self.g.slides(j) else ZeroVector

    def span(self, group: int) -> Vector:
        """From the origin of a group to the next group's joint, or to the connection point."""
        last = max(j for j in self.g.group if self.g.group[j] == group)
        return vector_sum((self.reach(last), self.g.offset[last + 1]))

    def _rod(self, j: int, following: Vector) -> Vector:
        """From the origin of turning joint j to the connection point."""
        g = self.g
        vector = vector_sum((self.spans[j], following))
        frame, forms = g.frame("axes", j), self._closed_loop(j)
        named: Vector = self.eq.named("r_#", vector, j, body=frame, forms=forms)
        return named

    def _closed_loop(self, j: int) -> tuple[Vector, ...]:
        """The same vector, seen from the base; resolved vectors give way to what they resolve.

        Where the leg restricts the platform the loop may be open: there the links count alone.
        """
        x = self.x.get(j)
        dofs = sum(not self.g.is_extra(i) for i in range(1, self.g.count + 1))
        if dofs < (2 if self.space.planar else 3) + len(self.g.pairs):
            return ()
        while isinstance(x, VectorSymbol):
            quantity = self.book.notation[x.name]
            if quantity.role is not Role.RESOLVED:
                return (x,)
            x = self.x[quantity.joint]
        return ()

    # ---- rates -----------------------------------------------------------------------

    def velocity(self) -> LegRates:
        """Velocity of the connection point, joint screws, reciprocal wrenches, rates."""
        g, p = self.g, self.p
        S_dot = self.S_dot = self.eq(
            "S_dot", p.t_dot + Cross(p.omega, g.platform_point), body="base"
        )
        turning = [j for j in range(1, g.count + 1) if g.turns(j)]
        self.spans = {group: self.span(group) for group in [0, *turning]}
        rods: dict[int, Vector] = {}
        following: Vector = ZeroVector
        for j in reversed(turning):
            following = rods[j] = self._rod(j, following)
        v = {j: self._velocity_vector(j, rods) for j in range(1, g.count + 1)}
        reached = vector_sum((self.spans[0], rods[turning[0]] if turning else ZeroVector))
        # Three joints with a closed form leave no gap, they miss right angles alone.
        closes = self.is_closed and g.pairs and sum(not g.is_extra(j) for j in v) == 3
        screws = self._basis(v, ZeroVector if closes else self.S - reached)
        return self._angular_velocities(screws, self._rates(screws, S_dot))

    def _velocity_vector(self, j: int, rods: dict[int, Vector]) -> Vector:
        g = self.g
        if not g.turns(j):
            return g.e[j]
        vector = Cross(g.spin(j), rods[j]) + g.slide(j)
        like = g.turn(j) * g.size
        named: Vector = self.eq("v_#", vector, j, body=self.tip_frame(), like=like)
        return named

    def tip_frame(self) -> str:
        """Canonical frame of the last link."""
        return self.g.frame("axes", self.g.group[self.g.count])

    def _basis(self, v: dict[int, Vector], gap: Vector) -> LegScrews:
        """Reciprocal wrenches; basis completion where degrees of freedom lack."""
        g = self.g
        joints = [j for j in range(1, g.count + 1) if not g.is_extra(j)]
        vectors: list[Any] = [v[j] for j in joints]
        scales: list[Any] = [g.size * g.turn(j) if g.turns(j) else sp.S.One for j in joints]
        directions = self._moment_directions()
        rows = [[Dot(g.spin(j), n) for j in joints] for n in directions]
        missing = (2 if self.space.planar else 3) + len(rows) - len(joints)
        frame = self.tip_frame()
        dofs = DegreesOfFreedom(
            list(vectors), [list(r) for r in rows], list(scales), directions, frame
        )
        wrenches = self._constraint_wrenches(v, joints, missing, dofs)
        for wrench in wrenches:
            vectors.append(wrench.force)
            scales.append(g.size if wrench.of_moment else sp.S.One)
            for row, coefficient in zip(rows, wrench.coefficients, strict=True):
                row.append(coefficient)
        columns = [
            *(_Screw("w_#", j, g.kind(j).is_angle) for j in joints),
            *(_Screw("wn_#", k) for k in range(1, missing + 1)),
        ]
        duals, coefficients = (
            self._define_wrenches(vectors, rows, columns)
            if rows
            else (self._define_duals(vectors, columns), [])
        )
        o, named = self._moment_parts(joints, coefficients, directions)
        self._note_basis(vectors, duals, scales, rows, coefficients)
        w, m = (dict(zip(joints, parts, strict=False)) for parts in (duals, coefficients))
        constraints = [wrench for wrench in wrenches if wrench.acts]
        return LegScrews(v, w, o, m, directions, constraints, gap, named)

    def _moment_parts(
        self, joints: list[int], coefficients: list[list[Any]], directions: list[Any]
    ) -> tuple[dict[int, Vector], dict[Any, Any]]:
        """Moment parts of the reciprocal wrenches by joint, and what has these names."""
        o: dict[int, Vector] = {}
        named: dict[Any, Any] = {}
        for j, own in zip(joints, coefficients, strict=False):
            moment = vector_sum(m * n for m, n in zip(own, directions, strict=True))
            o[j] = named[moment] = self.eq("o_#", moment, j, body=self.tip_frame())
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

    def _moment_directions(self) -> list[Any]:
        """Directions of the moments that the platform joint transmits."""
        frame = self.tip_frame()
        return [
            self.eq("n_m#", Cross(link, platform), k, body=frame)
            for k, (link, platform) in enumerate(self.g.pairs, 1)
        ]

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

    def _reciprocal(self, k: int, screw: _Screw, value: Any, facts: dict[str, str]) -> Any:
        """Vector k reciprocal to the others."""
        told = {name: text.format(k=k) for name, text in facts.items()}
        joint, body = screw.joint, self.tip_frame()
        return self.eq(screw.stem, value, screw.number, k, joint=joint, body=body, **told)

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
        normals = constraint_directions(book, g, v, joints, missing, self.space.planar)
        return [ConstraintWrench(normal) for normal in normals]

    def _rates(self, screws: LegScrews, S_dot: Vector) -> dict[int, Any]:
        """Joint rates."""
        qd: dict[int, Any] = {}
        target, turning = S_dot, self.p.omega
        for j in self._extras():
            qd[j] = self.eq.note("yd_#", j)
            target = target - qd[j] * screws.v[j]
            turning = turning - qd[j] * self.g.spin(j)
        if qd:
            target = self.eq("S_dot_rest", target)
        turns = [self.eq("eta_#", Dot(n, turning), k) for k, n in enumerate(screws.n, 1)]
        for j, dual in screws.w.items():
            qd[j] = self.eq("qd_#", Dot(dual, target) + _resolved(screws, j, turns), j)
        return qd

    def _extras(self) -> list[int]:
        return [j for j in range(1, self.g.count + 1) if self.g.is_extra(j)]

    def _angular_velocities(self, screws: LegScrews, qd: dict[int, Any]) -> LegRates:
        g, omega, spin = self.g, {0: ZeroVector}, {0: ZeroTensor}
        for j in self.spans:
            if j == 0:
                continue
            previous, frame = omega[g.group[j - 1]], g.frame("axes", j)
            omega[j] = self.eq("omega_#", previous + qd[j] * g.spin(j), j, body=frame)
            spin[j] = self.eq("W_#", Compose(Skew(omega[j]), Skew(omega[j])), j, body=frame)
        slide = {group: self._slide_velocity(group, qd) for group in self.spans}
        return LegRates(**vars(screws), qd=qd, omega=omega, spin=spin, slide=slide)

    def _slide_velocity(self, group: int, qd: dict[int, Any]) -> Vector:
        """Velocity of sliding within a group."""
        members = (j for j in range(1, self.g.count + 1) if self.g.group[j] == group)
        return vector_sum(qd[j] * self.g.slide(j) for j in members)

    # ---- accelerations ---------------------------------------------------------------

    def acceleration(self, rates: LegRates) -> LegMotion:
        """Bias, accelerations of joints and links, and their linear forms."""
        g, p = self.g, self.p
        u_1: Vector = ZeroVector
        if self.space.rotates:
            q, forms = g.platform_point, (p.spin @ g.platform_point,)
            u_1 = self.eq("u_1", Cross(p.omega, Cross(p.omega, q)), body="base", forms=forms)
        a_p = self.eq("a_p", p.t_ddot + Cross(p.alpha, g.platform_point), body="base")
        collection = Collection(a_p, [a_p], {}, rates.named)
        self.eq.collect = LinearWriter(self.book, g, collection).define
        S_ddot = self.eq("S_ddot", a_p + u_1, body="base", forms=self._platform_form())
        collection.known[S_ddot] = linear_form(a_p + u_1, [a_p], {})
        bias = self._bias(rates)
        motion, coriolis = self._joint_accelerations(rates, collection, S_ddot, bias), bias.coriolis
        if p.base:
            motion, coriolis = self._with_base(motion, p.base)
        self._angular_accelerations(motion, coriolis)
        self.motion = motion
        self._origin_accelerations(motion)
        return motion

    def _platform_form(self) -> tuple[Vector, ...]:
        """The same acceleration by the platform's acceleration tensor."""
        if not self.space.rotates:
            return ()
        return (self.p.t_ddot + self.p.tensor @ self.g.platform_point,)

    def _bias(self, rates: LegRates) -> _Bias:
        """Accelerations at zero joint accelerations."""
        g = self.g
        coriolis: dict[int, Vector] = {0: ZeroVector}
        beta: dict[int, Vector] = {0: ZeroVector}
        terms: list[Vector] = []
        forms: list[Vector] = []
        for j in self.spans:
            if j:
                previous, frame = g.group[j - 1], g.frame("axes", j)
                turned = rates.qd[j] * Cross(rates.omega[previous], g.spin(j))
                coriolis[j] = self.eq.named("zeta_#", turned, j, body=frame)
                beta[j] = self.eq.named("beta_#", beta[previous] + coriolis[j], j, body=frame)
            span, omega = self.spans[j], rates.omega[j]
            sliding = Cross(omega, rates.slide[j]) * 2
            terms.extend((Cross(beta[j], span) + Cross(omega, Cross(omega, span)), sliding))
            tensor = Skew(beta[j]) + rates.spin[j]
            forms.extend((tensor @ span if tensor != ZeroTensor else ZeroVector, sliding))
        total, seen = vector_sum(terms), (vector_sum(forms),)
        point: Vector = ZeroVector
        if total != ZeroVector:
            point = self.eq("bias", total, body=self.tip_frame(), forms=seen)
        return _Bias(point, coriolis, beta)

    def _joint_accelerations(
        self, rates: LegRates, collection: Collection, S_ddot: Vector, bias: _Bias
    ) -> LegMotion:
        """Accelerations of the joints; those of links and origins are still to be found."""
        g, qdd = self.g, {}
        target: Vector = S_ddot - bias.point
        turning: Vector = self.p.alpha
        if rates.n and self.p.alpha != ZeroVector:
            collection.unknowns.append(self.p.alpha)
        for j in self._extras():
            qdd[j] = self.eq.note("ydd_#", j)
            collection.unknowns.append(qdd[j])
            target = target - qdd[j] * rates.v[j]
            turning = turning - qdd[j] * g.spin(j)
        ydd = dict(qdd)
        if target != S_ddot:
            target = self.eq.collected("rel", target, body=self.tip_frame())
        nu = self._orientation_bias(rates, bias.beta)
        turns = [
            self.eq.collected("etad_#", Dot(n, turning) + own, k)
            for k, (n, own) in enumerate(zip(rates.n, nu, strict=True), 1)
        ]
        for j, dual in rates.w.items():
            resolved = Dot(dual, target) + _resolved(rates, j, turns)
            qdd[j] = self.eq.collected("qdd_#", resolved, j)
        return LegMotion(
            **vars(rates),
            collection=collection,
            S_ddot=S_ddot,
            qdd=qdd,
            ydd=ydd,
            nu=nu,
            relative=target,
            alpha={0: ZeroVector},
            acceleration_tensor={0: (ZeroTensor, ZeroTensor)},
            origin_acceleration={0: ZeroVector},
        )

    def _orientation_bias(self, rates: LegRates, beta: dict[int, Vector]) -> list[Any]:
        """Per moment direction, what its turning adds to the angular acceleration along it."""
        g, p = self.g, self.p
        last = g.group[g.count]
        omega = rates.omega[last]
        found = []
        for k, ((link, platform), n) in enumerate(zip(g.pairs, rates.n, strict=True), 1):
            turning = Cross(Cross(omega, link), platform) + Cross(link, Cross(p.omega, platform))
            rate = self.eq.named("nd_m#", turning, k, body=self.tip_frame())
            found.append(self.eq("nu_#", Dot(rate, p.omega - omega) - Dot(n, beta[last]), k))
        return found

    def _with_base(
        self, motion: LegMotion, base: BaseMotion
    ) -> tuple[LegMotion, dict[int, Vector]]:
        """The motion in space, and what the turning of axes adds: the base moves."""
        g, w = self.g, base.omega
        self.book.chapter(
            f"{g.leg_type.name}-B",
            f"Motion of a {g.leg_type.architecture} leg with its base",
            _WITH_BASE,
            g.leg_type.name,
        )
        r, coriolis = self.p.t + g.platform_point, Cross(w, self.S_dot) * 2
        total = motion.S_ddot + Cross(base.alpha, r) + Cross(w, Cross(w, r)) + coriolis
        forms = (motion.S_ddot + base.tensor @ r + coriolis,)
        S_ddot = self.eq("S_ddot_b", total, body="base", forms=forms)
        motion.known[S_ddot] = linear_form(total, [motion.a_p], motion.known)
        origin = self.eq(
            "a_b0",
            Cross(base.alpha, g.base_point) + Cross(w, Cross(w, g.base_point)),
            body="base",
            forms=(base.tensor @ g.base_point,),
        )
        omega, spin, turned = {0: w}, {0: ZeroTensor}, {0: ZeroVector}
        for j in self.spans:
            if j:
                previous, frame = omega[g.group[j - 1]], g.frame("axes", j)
                omega[j] = self.eq("omega_b_#", previous + motion.qd[j] * g.spin(j), j, body=frame)
                spin[j] = self.eq("W_b_#", Compose(Skew(omega[j]), Skew(omega[j])), j, body=frame)
                turn = motion.qd[j] * Cross(previous, g.spin(j))
                turned[j] = self.eq.named("zeta_b_#", turn, j, body=frame)
        return replace(
            motion,
            omega=omega,
            spin=spin,
            S_ddot=S_ddot,
            alpha={0: base.alpha},
            acceleration_tensor={0: (base.tensor, base.tensor)},
            origin_acceleration={0: origin},
        ), turned

    def _angular_accelerations(self, motion: LegMotion, coriolis: dict[int, Vector]) -> None:
        g = self.g
        for j in self.spans:
            if j == 0:
                continue
            previous = motion.alpha[g.group[j - 1]]
            frame = g.frame("axes", j)
            rhs = previous + motion.qdd[j] * g.spin(j) + coriolis[j]
            motion.alpha[j] = self.eq.collected(
                "alpha_#",
                rhs,
                j,
                body=frame,
                collected=not g.composite or j == g.group[g.count],
                accelerated=self._turning(motion, j),
            )
            rest = motion.known[motion.alpha[j]].remainder
            motion.acceleration_tensor[j] = (
                self.eq("B_#", Skew(motion.alpha[j]) + motion.spin[j], j, body=frame),
                self.eq("B_#_o", Skew(rest) + motion.spin[j], j, body=frame),
            )

    def _turning(self, motion: LegMotion, group: int) -> Any:
        """What of the last link's angular acceleration the inertia at the tip needs."""
        g = self.g
        if not g.composite or group != g.group[g.count]:
            return None
        return vector_sum(motion.qdd[j] * g.spin(j) for j in self.spans if j)

    def point_acceleration(self, group: int, reach: Vector, slides: Sequence[int]) -> Any:
        """Acceleration of a point of a group: (rhs, form, form of the remainder)."""
        g, motion = self.g, self.motion
        omega = motion.omega[group]
        origin = motion.origin_acceleration[group]
        rest = motion.collection.rest(origin)
        velocity = vector_sum(motion.qd[i] * g.slide(i) for i in slides)
        coriolis = Cross(omega, velocity) * 2
        sliding = vector_sum(motion.qdd[i] * g.slide(i) for i in slides)
        sliding_rest = vector_sum(
            motion.known[motion.qdd[i]].remainder * g.slide(i)
            if motion.qdd[i] in motion.known
            else ZeroVector
            for i in slides
        )
        centripetal = Cross(motion.alpha[group], reach) + Cross(omega, Cross(omega, reach))
        tensor, tensor_rest = motion.acceleration_tensor[group]
        return (
            vector_sum((origin, centripetal, coriolis, sliding)),
            vector_sum((origin, tensor @ reach, coriolis, sliding)),
            vector_sum((rest, tensor_rest @ reach, coriolis, sliding_rest)),
        )

    def _origin_accelerations(self, motion: LegMotion) -> None:
        """Accelerations of the groups' origins, outwards (the last link is seen from the tip)."""
        g, order = self.g, list(self.spans)
        for previous, j in pairwise(order):
            slides = [i for i in range(1, g.count + 1) if g.group[i] == previous and g.slides(i)]
            rhs, form, rest = self.point_acceleration(previous, self.spans[previous], slides)
            if rhs == ZeroVector or isinstance(rhs, VectorSymbol):
                motion.origin_acceleration[j] = rhs
                continue
            motion.origin_acceleration[j] = self.eq.collected(
                "a_o_#",
                rhs,
                j,
                body=g.frame("axes", previous),
                forms=(form,),
                rest_forms=(rest,),
                collected=not g.composite,
            )
