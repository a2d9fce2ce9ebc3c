"""Velocities and accelerations of a leg, and their linear forms in the platform's acceleration.

Reference: sections 2.2, 2.3 and 2.5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import sympy as sp

from pne_sym.derivation import Book, ReciprocalBasis, Role
from pne_sym.mechanics.completion import Freedoms, LeftOut, completed_wrenches
from pne_sym.mechanics.constraints import (
    directions_left_out,
    plane_normal,
    wrenches_left_out,
)
from pne_sym.mechanics.inverse_kinematics import InverseKinematics
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.linear_writer import LegMotion, LinearWriter
from pne_sym.mechanics.platform_motion import PlatformMotion
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

# Units of what is reciprocal to the freedom of a joint, by whether its displacement is an angle.
_FORCE_PART = {True: "1/m", False: "-"}
_MOMENT_PART = {True: "-", False: "m"}

_TERMS = glossary(r"""
r_# | \mathbf r_{#} | m | GEOMETRY
    from joint # to the connection point, along the links
S_dot | \dot{\mathbf S} | m/s | RATE POINT_VELOCITY | Sec. 2.5, step 1.1
    velocity of the connection point
v_# | \mathbf v_{#} |  | RATE | Sec. 2.2, joint table
    velocity of the connection point per rate of joint #
o_# | \mathbf o_{#} |  | RECIPROCITY RECIPROCAL | Sec. 2.2, joint table
    moment part of reciprocal wrench #
n_m# | \mathbf n_{m#} |  | GEOMETRY | Sec. 2.2, joint table
    direction # of the moment that the platform joint transmits
m#_% | m_{&#} |  | RECIPROCITY | Sec. 2.2, joint table
    moment part # of reciprocal wrench &
S_dot_rest | \dot{\mathbf S}' | m/s | RATE
    velocity of the connection point left to the joints that are not extra
eta_# | \eta_{#} | rad/s | RATE
    rate at which the joints turn along moment direction #
qd_# | \dot q_{#} | U/s | RECIPROCITY RATE
    rate of joint #
omega_# | \boldsymbol\omega_{#} | rad/s | RATE
    angular velocity of link #
W_# | \mathbf W_{#} | 1/s^2 | DEFINITION symmetric
    centripetal tensor of link #
u_1 | \mathbf u_1 | m/s^2 | RATE | Eq. 23
    centripetal acceleration of the connection point
a_p | \mathbf a_p | m/s^2 | RATE COLLECTED_ACCELERATION | Eq. 23
    acceleration of the connection point without its centripetal part
S_ddot | \ddot{\mathbf S} | m/s^2 | RATE POINT_ACCELERATION | Eq. 23
    acceleration of the connection point
zeta_# | \boldsymbol\zeta_{#} | rad/s^2 | RATE
    angular acceleration of link # from the turning of axis #
bias | \mathfrak b | m/s^2 | RATE BIAS | Sec. 2.2
    acceleration of the connection point at zero joint accelerations
rel | \ddot{\mathbf S}' ; \mathbf E | m/s^2 | RATE
    acceleration of the connection point left to the joint accelerations
etad_# | \dot\eta_{#} ; \boldsymbol\eta_{#} | rad/s^2 | RATE
    acceleration with which the joints turn along moment direction #
qdd_# | \ddot q_{#} ; \mathbf w_{#} | U/s^2 | RECIPROCITY JOINT_ACCELERATION | Eqs. 8, 9, 16
    acceleration of joint #
nd_m# | \dot{\mathbf n}_{m#} | 1/s | RATE
    rate of moment direction #
nu_# | \nu_{#} | rad/s^2 | RATE | Sec. 2.2, joint table
    bias of the angular acceleration along moment direction #
alpha_# | \boldsymbol\alpha_{#} ; \boldsymbol\Omega_{#} | rad/s^2 | RATE
    angular acceleration of link #
a_o# | \mathbf a_{o#} ; \mathbf V_{#} | m/s^2 | RATE
    acceleration of the origin of joint #
w_# | \mathbf w_{#} |  | RECIPROCITY RECIPROCAL | Sec. 2.3
    reciprocal vector %
wn_# | \mathbf w_{c#} |  | RECIPROCITY RECIPROCAL | Sec. 2.3
    reciprocal vector %
yd_# | \dot y_{#} | U/s | given RATE
    rate of extra joint #
ydd_# | \ddot y_{#} | U/s^2 | given JOINT_ACCELERATION
    acceleration of extra joint #
beta_# | \boldsymbol\beta_{#} | rad/s^2 | RATE
    angular acceleration of link # at zero joint accelerations
B_# | \mathbf B_{#} | 1/s^2 | DEFINITION
    acceleration tensor of link #
B_#_o | \mathbf B^{\circ}_{#} | 1/s^2 | DEFINITION
    remainder of the acceleration tensor of link #
""")
_WRENCH = {"title": "force part of reciprocal wrench {k}", "reference": "Sec. 2.2, joint table"}

_RATES = (
    r"Each joint j moves the connection point along its velocity vector $`\mathbf v_j`$: "
    r"$`\dot{\mathbf S}=\sum_j\mathbf v_j\,\dot q_j`$. The reciprocal vectors $`\mathbf w_j`$, "
    r"with $`\mathbf w_j\cdot\mathbf v_k=1`$ for $`j=k`$ and 0 otherwise, solve this for the joint "
    r"rates. The centripetal tensor saves work: "
    r"$`\mathbf W_j\,\mathbf r=\boldsymbol\omega_j\times(\boldsymbol\omega_j\times\mathbf r)`$ for "
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
    r"$`\mathbf B_j\,\mathbf r=\boldsymbol\alpha_j\times\mathbf r+\mathbf W_j\,\mathbf r`$."
)


@dataclass(frozen=True)
class _Screw:
    """A column of a leg's system: a joint's freedom, or a wrench that the freedoms leave out.

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
        self.motion = LegMotion()
        self.eq = Writer(book, g, _TERMS, LinearWriter(book, g, self.motion).define)

    def write(self, prefix: str) -> LegMotion:
        """Write the chapters on rates and accelerations."""
        leg_type = self.g.leg_type
        self.book.chapter(
            f"{prefix}-V", f"Rates of a {leg_type.architecture} leg", _RATES, leg_type.name
        )
        self.velocity()
        self.book.chapter(
            f"{prefix}-A",
            f"Accelerations of a {leg_type.architecture} leg",
            _ACCELERATIONS
            + (_REMAINDERS if self.g.composite else _COLLECTED)
            + self._other_accelerations()
            + _TENSOR,
            leg_type.name,
        )
        self.acceleration()
        return self.motion

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
        freedoms = sum(not self.g.is_extra(i) for i in range(1, self.g.count + 1))
        if freedoms < (2 if self.space.planar else 3) + len(self.g.pairs):
            return ()
        while isinstance(x, VectorSymbol):
            quantity = self.book.notation[x.name]
            if quantity.role is not Role.RESOLVED:
                return (x,)
            x = self.x[quantity.joint]
        return ()

    # ---- rates -----------------------------------------------------------------------

    def velocity(self) -> None:
        """Velocity of the connection point, joint screws, reciprocal wrenches, rates."""
        g, p = self.g, self.p
        self.S_dot = self.eq("S_dot", p.t_dot + Cross(p.omega, g.platform_point), body="base")
        turning = [j for j in range(1, g.count + 1) if g.turns(j)]
        self.spans = {group: self.span(group) for group in [0, *turning]}
        rods: dict[int, Vector] = {}
        following: Vector = ZeroVector
        for j in reversed(turning):
            following = rods[j] = self._rod(j, following)
        for j in range(1, g.count + 1):
            self.motion.v[j] = self._velocity_vector(j, rods)
        first = turning[0] if turning else None
        reached = vector_sum((self.spans[0], rods[first] if first else ZeroVector))
        # Three joints with a closed form leave no gap, they miss right angles alone.
        closes = self.is_closed and g.pairs and sum(not g.is_extra(j) for j in self.motion.v) == 3
        self.motion.gap = ZeroVector if closes else self.S - reached
        self._basis()
        self._rates()

    def _velocity_vector(self, j: int, rods: dict[int, Vector]) -> Vector:
        g = self.g
        if not g.turns(j):
            return g.e[j]
        vector = Cross(g.spin(j), rods[j]) + g.slide(j)
        named: Vector = self.eq(
            "v_#", vector, j, body=self.tip_frame(), unit=g.kind(j).velocity_unit
        )
        return named

    def tip_frame(self) -> str:
        """Canonical frame of the last link."""
        return self.g.frame("axes", self.g.group[self.g.count])

    def _basis(self) -> None:
        """Reciprocal wrenches; directions that the freedoms leave out complete the basis."""
        g, motion = self.g, self.motion
        joints = [j for j in range(1, g.count + 1) if not g.is_extra(j)]
        vectors: list[Any] = [motion.v[j] for j in joints]
        scales: list[Any] = [g.size * g.turn(j) if g.turns(j) else sp.S.One for j in joints]
        self._moment_directions()
        rows = [[Dot(g.spin(j), n) for j in joints] for n in motion.n]
        missing = (2 if self.space.planar else 3) + len(rows) - len(joints)
        frame = self.tip_frame()
        freedoms = Freedoms(list(vectors), [list(r) for r in rows], list(scales), motion.n, frame)
        wrenches = self._left_out(joints, missing, freedoms)
        motion.left_out = [wrench for wrench in wrenches if wrench.acts]
        for wrench in wrenches:
            vectors.append(wrench.force)
            scales.append(g.size if wrench.of_moment else sp.S.One)
            for row, amount in zip(rows, wrench.amounts, strict=True):
                row.append(amount)
        screws = [
            *(_Screw("w_#", j, g.kind(j).is_angle) for j in joints),
            *(_Screw("wn_#", k) for k in range(1, missing + 1)),
        ]
        duals, moment_duals = (
            self._define_wrenches(vectors, rows, screws)
            if rows
            else (self._define_duals(vectors, screws), [])
        )
        motion.w = dict(zip(joints, duals, strict=False))
        for j, amounts in zip(joints, moment_duals, strict=False):
            motion.m[j] = amounts
            moment = vector_sum(m * n for m, n in zip(amounts, motion.n, strict=True))
            motion.o[j] = motion.named[moment] = self.eq(
                "o_#", moment, j, body=self.tip_frame(), unit=_MOMENT_PART[g.kind(j).is_angle]
            )
        frames = tuple(dict.fromkeys(g.frame("axes", g.group[j]) for j in range(g.count, -1, -1)))
        self.book.bases.append(
            ReciprocalBasis(
                g.leg_type.name,
                tuple(vectors),
                tuple(duals),
                tuple(scales),
                frames,
                tuple(tuple(row) for row in rows),
                tuple(tuple(m) for m in moment_duals),
                g.size,
            )
        )

    def _moment_directions(self) -> None:
        """Directions of the moments that the platform joint transmits."""
        for k, (link, platform) in enumerate(self.g.pairs, 1):
            self.motion.n.append(self.eq("n_m#", Cross(link, platform), k, body=self.tip_frame()))

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
        return self.eq("m#_%", value, i, name, k, unit=_MOMENT_PART[screw.is_angle])

    def _reciprocal(self, k: int, screw: _Screw, value: Any, facts: dict[str, str]) -> Any:
        """Vector k reciprocal to the others."""
        told = {name: text.format(k=k) for name, text in facts.items()}
        unit, joint, body = _FORCE_PART[screw.is_angle], screw.joint, self.tip_frame()
        return self.eq(
            screw.stem, value, screw.number, k, unit=unit, joint=joint, body=body, **told
        )

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

    def _left_out(self, joints: list[int], missing: int, freedoms: Freedoms) -> list[LeftOut]:
        """Wrenches that do no work along the leg's freedoms."""
        if missing == 0:
            return []
        if not all(auxiliary.acts for auxiliary in self.g.completion):
            return completed_wrenches(self.book, self.g, self.g.completion, freedoms)
        if self.motion.n:
            return wrenches_left_out(self.book, self.g, self.motion, joints, freedoms)
        normals = directions_left_out(
            self.book, self.g, self.motion, joints, missing, self.space.planar
        )
        return [LeftOut(normal) for normal in normals]

    def _rates(self) -> None:
        g, motion = self.g, self.motion
        extras = [j for j in range(1, g.count + 1) if g.is_extra(j)]
        target: Vector = self.S_dot
        turning: Vector = self.p.omega
        for j in extras:
            motion.qd[j] = self.eq.note("yd_#", j)
            target = target - motion.qd[j] * motion.v[j]
            turning = turning - motion.qd[j] * g.spin(j)
        if extras:
            target = self.eq("S_dot_rest", target)
        turns = [self.eq("eta_#", Dot(n, turning), k) for k, n in enumerate(motion.n, 1)]
        for j, dual in motion.w.items():
            motion.qd[j] = self.eq("qd_#", Dot(dual, target) + self._resolved(j, turns), j)
        self._angular_velocities()

    def _resolved(self, j: int, amounts: Sequence[Any]) -> Any:
        """Part of joint j in what turns along the moment directions."""
        return sp.Add(*(m * a for m, a in zip(self.motion.m.get(j, ()), amounts, strict=False)))

    def _angular_velocities(self) -> None:
        g, motion = self.g, self.motion
        motion.omega[0], motion.spin[0] = ZeroVector, ZeroTensor
        motion.slide[0] = self._slide_velocity(0)
        for j in self.spans:
            if j == 0:
                continue
            previous = motion.omega[g.group[j - 1]]
            frame = g.frame("axes", j)
            motion.omega[j] = self.eq("omega_#", previous + motion.qd[j] * g.spin(j), j, body=frame)
            motion.spin[j] = self.eq(
                "W_#", Compose(Skew(motion.omega[j]), Skew(motion.omega[j])), j, body=frame
            )
            motion.slide[j] = self._slide_velocity(j)

    def _slide_velocity(self, group: int) -> Vector:
        """Velocity of sliding within a group."""
        g = self.g
        members = (j for j in range(1, g.count + 1) if g.group[j] == group)
        return vector_sum(self.motion.qd[j] * g.slide(j) for j in members)

    # ---- accelerations ---------------------------------------------------------------

    def acceleration(self) -> None:
        """Bias, accelerations of joints and links, and their linear forms."""
        g, p, motion = self.g, self.p, self.motion
        q = g.platform_point
        motion.u_1 = ZeroVector
        if self.space.rotates:
            motion.u_1 = self.eq(
                "u_1", Cross(p.omega, Cross(p.omega, q)), body="base", forms=(p.spin @ q,)
            )
        motion.a_p = self.eq("a_p", p.t_ddot + Cross(p.alpha, q), body="base")
        motion.unknowns.append(motion.a_p)
        motion.S_ddot = self.eq(
            "S_ddot", motion.a_p + motion.u_1, body="base", forms=self._platform_form()
        )
        motion.known[motion.S_ddot] = linear_form(
            motion.a_p + motion.u_1, motion.unknowns, motion.known
        )
        bias = self._bias()
        self._joint_accelerations(bias)
        self._angular_accelerations()
        self._origin_accelerations()

    def _platform_form(self) -> tuple[Vector, ...]:
        """The same acceleration by the platform's acceleration tensor."""
        if not self.space.rotates:
            return ()
        return (self.p.t_ddot + self.p.tensor @ self.g.platform_point,)

    beta: dict[int, Vector]

    def _bias(self) -> Vector:
        """Acceleration of the connection point at zero joint accelerations."""
        g, motion = self.g, self.motion
        self.coriolis: dict[int, Vector] = {0: ZeroVector}
        beta = self.beta = {0: ZeroVector}
        terms: list[Vector] = []
        forms: list[Vector] = []
        for j in self.spans:
            if j:
                previous = g.group[j - 1]
                turned = motion.qd[j] * Cross(motion.omega[previous], g.spin(j))
                turned = self.eq.named("zeta_#", turned, j, body=g.frame("axes", j))
                self.coriolis[j] = turned
                beta[j] = self.eq.named(
                    "beta_#", beta[previous] + turned, j, body=g.frame("axes", j)
                )
            span, omega = self.spans[j], motion.omega[j]
            centripetal = Cross(beta[j], span) + Cross(omega, Cross(omega, span))
            coriolis = Cross(omega, motion.slide[j]) * 2
            terms.extend((centripetal, coriolis))
            tensor = Skew(beta[j]) + motion.spin[j]
            forms.extend((tensor @ span if tensor != ZeroTensor else ZeroVector, coriolis))
        total = vector_sum(terms)
        if total == ZeroVector:
            return ZeroVector
        named: Vector = self.eq("bias", total, body=self.tip_frame(), forms=(vector_sum(forms),))
        return named

    def _joint_accelerations(self, bias: Vector) -> None:
        g, motion = self.g, self.motion
        target: Vector = motion.S_ddot - bias
        turning: Vector = self.p.alpha
        if motion.n and self.p.alpha != ZeroVector:
            motion.unknowns.append(self.p.alpha)
        for j in [j for j in range(1, g.count + 1) if g.is_extra(j)]:
            motion.ydd[j] = motion.qdd[j] = self.eq.note("ydd_#", j)
            motion.unknowns.append(motion.ydd[j])
            target = target - motion.ydd[j] * motion.v[j]
            turning = turning - motion.ydd[j] * g.spin(j)
        if target != motion.S_ddot:
            target = self.eq.collected("rel", target, body=self.tip_frame())
        motion.relative = target
        turns = [
            self.eq.collected("etad_#", Dot(n, turning) + nu, k)
            for k, (n, nu) in enumerate(zip(motion.n, self._orientation_bias(), strict=True), 1)
        ]
        for j, dual in motion.w.items():
            motion.qdd[j] = self.eq.collected(
                "qdd_#", Dot(dual, target) + self._resolved(j, turns), j
            )

    def _orientation_bias(self) -> list[Any]:
        """Per moment direction, what its turning adds to the angular acceleration along it."""
        g, motion, p = self.g, self.motion, self.p
        last = g.group[g.count]
        omega = motion.omega[last]
        found = []
        for k, ((link, platform), n) in enumerate(zip(g.pairs, motion.n, strict=True), 1):
            turning = Cross(Cross(omega, link), platform) + Cross(link, Cross(p.omega, platform))
            rate = self.eq.named("nd_m#", turning, k, body=self.tip_frame())
            found.append(self.eq("nu_#", Dot(rate, p.omega - omega) - Dot(n, self.beta[last]), k))
        motion.nu = found
        return found

    def _angular_accelerations(self) -> None:
        g, motion = self.g, self.motion
        motion.alpha[0] = ZeroVector
        motion.acceleration_tensor[0] = (ZeroTensor, ZeroTensor)
        for j in self.spans:
            if j == 0:
                continue
            previous = motion.alpha[g.group[j - 1]]
            frame = g.frame("axes", j)
            rhs = previous + motion.qdd[j] * g.spin(j) + self.coriolis[j]
            motion.alpha[j] = self.eq.collected(
                "alpha_#",
                rhs,
                j,
                body=frame,
                collected=not g.composite or j == g.group[g.count],
                accelerated=self._turning(j),
            )
            rest = motion.known[motion.alpha[j]].remainder
            motion.acceleration_tensor[j] = (
                self.eq("B_#", Skew(motion.alpha[j]) + motion.spin[j], j, body=frame),
                self.eq("B_#_o", Skew(rest) + motion.spin[j], j, body=frame),
            )

    def _turning(self, group: int) -> Any:
        """What of the last link's angular acceleration the inertia at the tip needs."""
        g = self.g
        if not g.composite or group != g.group[g.count]:
            return None
        return vector_sum(self.motion.qdd[j] * g.spin(j) for j in self.spans if j)

    def point_acceleration(self, group: int, reach: Vector, slides: Sequence[int]) -> Any:
        """Acceleration of a point of a group: (rhs, form, form of the remainder)."""
        g, motion = self.g, self.motion
        omega = motion.omega[group]
        origin = motion.origin_acceleration[group]
        rest = motion.known[origin].remainder if origin in motion.known else origin
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

    def _origin_accelerations(self) -> None:
        """Accelerations of the groups' origins, outwards (the last link is seen from the tip)."""
        g, motion = self.g, self.motion
        order = list(self.spans)
        motion.origin_acceleration[order[0]] = ZeroVector
        for previous, j in pairwise(order):
            slides = [i for i in range(1, g.count + 1) if g.group[i] == previous and g.slides(i)]
            rhs, form, rest = self.point_acceleration(previous, self.spans[previous], slides)
            if rhs == ZeroVector or isinstance(rhs, VectorSymbol):
                motion.origin_acceleration[j] = rhs
                continue
            motion.origin_acceleration[j] = self.eq.collected(
                "a_o#",
                rhs,
                j,
                body=g.frame("axes", previous),
                forms=(form,),
                rest_forms=(rest,),
                collected=not g.composite,
            )
