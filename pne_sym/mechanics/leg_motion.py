"""Velocities and accelerations of a leg, and their linear forms in the platform's acceleration.

Reference: sections 2.2, 2.3 and 2.5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import sympy as sp

from pne_sym.derivation import Book, Law, Quantity, ReciprocalBasis, Role
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
        stem, latex: of the vector reciprocal to it.
        is_angle: its displacement is an angle.
        joint: from 1; 0 for a wrench.
    """

    stem: str
    latex: str
    is_angle: bool = False
    joint: int = 0


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
        if isinstance(vector, VectorSymbol) or vector == ZeroVector:
            return vector
        named: Vector = self.book.define(
            g.name(f"r_{j}"),
            vector,
            rf"\mathbf r_{{{j}}}",
            f"from joint {j} to the connection point, along the links",
            Law.GEOMETRY,
            unit="m",
            body=g.frame("axes", j),
            forms=self._closed_loop(j),
        )
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
        g, book, p = self.g, self.book, self.p
        self.S_dot = book.define(
            g.name("S_dot"),
            p.t_dot + Cross(p.omega, g.platform_point),
            r"\dot{\mathbf S}",
            "velocity of the connection point",
            Law.RATE,
            unit="m/s",
            reference="Sec. 2.5, step 1.1",
            body="base",
            role=Role.POINT_VELOCITY,
        )
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
        named: Vector = self.book.define(
            g.name(f"v_{j}"),
            vector,
            rf"\mathbf v_{{{j}}}",
            f"velocity of the connection point per rate of joint {j}",
            Law.RATE,
            unit=g.kind(j).velocity_unit,
            body=self.tip_frame(),
            reference="Sec. 2.2, joint table",
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
            *(_Screw(f"w_{j}", rf"\mathbf w_{{{j}}}", g.kind(j).is_angle, j) for j in joints),
            *(_Screw(f"wn_{k}", rf"\mathbf w_{{c{k}}}") for k in range(1, missing + 1)),
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
            motion.o[j] = motion.named[moment] = self.book.define(
                g.name(f"o_{j}"),
                moment,
                rf"\mathbf o_{{{j}}}",
                f"moment part of reciprocal wrench {j}",
                Law.RECIPROCITY,
                unit=_MOMENT_PART[g.kind(j).is_angle],
                body=self.tip_frame(),
                reference="Sec. 2.2, joint table",
                role=Role.RECIPROCAL,
                joint=j,
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
            self.motion.n.append(
                self.book.define(
                    self.g.name(f"n_m{k}"),
                    Cross(link, platform),
                    rf"\mathbf n_{{m{k}}}",
                    f"direction {k} of the moment that the platform joint transmits",
                    Law.GEOMETRY,
                    body=self.tip_frame(),
                    reference="Sec. 2.2, joint table",
                )
            )

    def _define_wrenches(
        self, vectors: list[Any], rows: list[list[Any]], screws: list[_Screw]
    ) -> tuple[list[Any], list[list[Any]]]:
        """Reciprocal wrenches where the leg transmits moments."""
        book, g = self.book, self.g
        columns = sp.Tuple(*vectors), sp.Tuple(*(sp.Tuple(*row) for row in rows))
        duals, moments = [], []
        for k, screw in enumerate(screws):
            duals.append(
                book.define(
                    g.name(screw.stem),
                    DualVector(sp.Integer(k), *columns),
                    screw.latex,
                    f"force part of reciprocal wrench {k + 1}",
                    Law.RECIPROCITY,
                    unit=_FORCE_PART[screw.is_angle],
                    body=self.tip_frame(),
                    reference="Sec. 2.2, joint table",
                    role=Role.RECIPROCAL,
                    joint=screw.joint,
                )
            )
            moments.append(
                [
                    book.define(
                        g.name(f"m{i + 1}_{screw.stem}"),
                        DualScalar(sp.Integer(k), sp.Integer(i), *columns),
                        f"m_{{{k + 1}{i + 1}}}",
                        f"moment part {i + 1} of reciprocal wrench {k + 1}",
                        Law.RECIPROCITY,
                        unit=_MOMENT_PART[screw.is_angle],
                        reference="Sec. 2.2, joint table",
                    )
                    for i in range(len(rows))
                ]
            )
        return duals, moments

    def _define_duals(self, vectors: list[Any], screws: list[_Screw]) -> list[Any]:
        book, g = self.book, self.g
        duals = []
        planar = len(vectors) == 2
        if planar:
            normal = plane_normal(book, g)
            others = [(vectors[1], normal), (normal, vectors[0])]
        else:
            others = [(vectors[(k + 1) % 3], vectors[(k + 2) % 3]) for k in range(3)]
        for k, (vector, screw) in enumerate(zip(vectors, screws, strict=True)):
            across = Cross(*others[k])
            duals.append(
                book.define(
                    g.name(screw.stem),
                    across / Dot(vector, across),
                    screw.latex,
                    f"reciprocal vector {k + 1}",
                    Law.RECIPROCITY,
                    unit=_FORCE_PART[screw.is_angle],
                    body=self.tip_frame(),
                    reference="Sec. 2.3",
                    role=Role.RECIPROCAL,
                    joint=screw.joint,
                )
            )
        return duals

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
        g, book, motion = self.g, self.book, self.motion
        extras = [j for j in range(1, g.count + 1) if g.is_extra(j)]
        target: Vector = self.S_dot
        turning: Vector = self.p.omega
        for j in extras:
            name = g.name(f"yd_{j}")
            book.note_quantity(
                Quantity(
                    name,
                    rf"\dot y_{{{j}}}",
                    f"rate of extra joint {j}",
                    f"{g.kind(j).unit}/s",
                    role=Role.RATE,
                    joint=j,
                )
            )
            motion.qd[j] = sp.Symbol(name, real=True)
            target = target - motion.qd[j] * motion.v[j]
            turning = turning - motion.qd[j] * g.spin(j)
        if extras:
            target = book.define(
                g.name("S_dot_rest"),
                target,
                r"\dot{\mathbf S}'",
                "velocity of the connection point left to the joints that are not extra",
                Law.RATE,
                unit="m/s",
            )
        turns = [
            book.define(
                g.name(f"eta_{k}"),
                Dot(n, turning),
                rf"\eta_{{{k}}}",
                f"rate at which the joints turn along moment direction {k}",
                Law.RATE,
                unit="rad/s",
            )
            for k, n in enumerate(motion.n, 1)
        ]
        for j, dual in motion.w.items():
            motion.qd[j] = book.define(
                g.name(f"qd_{j}"),
                Dot(dual, target) + self._resolved(j, turns),
                rf"\dot q_{{{j}}}",
                f"rate of joint {j}",
                Law.RECIPROCITY,
                unit=f"{g.kind(j).unit}/s",
                role=Role.RATE,
                joint=j,
            )
        self._angular_velocities()

    def _resolved(self, j: int, amounts: Sequence[Any]) -> Any:
        """Part of joint j in what turns along the moment directions."""
        return sp.Add(*(m * a for m, a in zip(self.motion.m.get(j, ()), amounts, strict=False)))

    def _angular_velocities(self) -> None:
        g, book, motion = self.g, self.book, self.motion
        motion.omega[0], motion.spin[0] = ZeroVector, ZeroTensor
        motion.slide[0] = self._slide_velocity(0)
        for j in self.spans:
            if j == 0:
                continue
            previous = motion.omega[g.group[j - 1]]
            frame = g.frame("axes", j)
            motion.omega[j] = book.define(
                g.name(f"omega_{j}"),
                previous + motion.qd[j] * g.spin(j),
                rf"\boldsymbol\omega_{{{j}}}",
                f"angular velocity of link {j}",
                Law.RATE,
                unit="rad/s",
                body=frame,
            )
            motion.spin[j] = book.define(
                g.name(f"W_{j}"),
                Compose(Skew(motion.omega[j]), Skew(motion.omega[j])),
                rf"\mathbf W_{{{j}}}",
                f"centripetal tensor of link {j}",
                Law.DEFINITION,
                unit="1/s^2",
                body=frame,
                symmetric=True,
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
        g, book, p, motion = self.g, self.book, self.p, self.motion
        q = g.platform_point
        motion.u_1 = ZeroVector
        if self.space.rotates:
            motion.u_1 = book.define(
                g.name("u_1"),
                Cross(p.omega, Cross(p.omega, q)),
                r"\mathbf u_1",
                "centripetal acceleration of the connection point",
                Law.RATE,
                unit="m/s^2",
                body="base",
                forms=(p.spin @ q,),
                reference="Eq. 23",
            )
        motion.a_p = book.define(
            g.name("a_p"),
            p.t_ddot + Cross(p.alpha, q),
            r"\mathbf a_p",
            "acceleration of the connection point without its centripetal part",
            Law.RATE,
            unit="m/s^2",
            body="base",
            reference="Eq. 23",
            role=Role.COLLECTED_ACCELERATION,
        )
        motion.unknowns.append(motion.a_p)
        writer = LinearWriter(book, g, motion)
        motion.S_ddot = book.define(
            g.name("S_ddot"),
            motion.a_p + motion.u_1,
            r"\ddot{\mathbf S}",
            "acceleration of the connection point",
            Law.RATE,
            unit="m/s^2",
            body="base",
            reference="Eq. 23",
            forms=self._platform_form(),
            role=Role.POINT_ACCELERATION,
        )
        motion.known[motion.S_ddot] = linear_form(
            motion.a_p + motion.u_1, motion.unknowns, motion.known
        )
        bias = self._bias()
        self._joint_accelerations(writer, bias)
        self._angular_accelerations(writer)
        self._origin_accelerations(writer)

    def _platform_form(self) -> tuple[Vector, ...]:
        """The same acceleration by the platform's acceleration tensor."""
        if not self.space.rotates:
            return ()
        return (self.p.t_ddot + self.p.tensor @ self.g.platform_point,)

    beta: dict[int, Vector]

    def _bias(self) -> Vector:
        """Acceleration of the connection point at zero joint accelerations."""
        g, book, motion = self.g, self.book, self.motion
        self.coriolis: dict[int, Vector] = {0: ZeroVector}
        beta = self.beta = {0: ZeroVector}
        terms: list[Vector] = []
        forms: list[Vector] = []
        for j in self.spans:
            if j:
                previous = g.group[j - 1]
                turned = motion.qd[j] * Cross(motion.omega[previous], g.spin(j))
                if turned != ZeroVector:
                    turned = book.define(
                        g.name(f"zeta_{j}"),
                        turned,
                        rf"\boldsymbol\zeta_{{{j}}}",
                        f"angular acceleration of link {j} from the turning of axis {j}",
                        Law.RATE,
                        unit="rad/s^2",
                        body=g.frame("axes", j),
                    )
                self.coriolis[j] = turned
                beta[j] = self._named_sum(
                    f"beta_{j}",
                    beta[previous] + turned,
                    rf"\boldsymbol\beta_{{{j}}}",
                    f"angular acceleration of link {j} at zero joint accelerations",
                    g.frame("axes", j),
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
        named: Vector = book.define(
            g.name("bias"),
            total,
            r"\mathfrak b",
            "acceleration of the connection point at zero joint accelerations",
            Law.RATE,
            unit="m/s^2",
            body=self.tip_frame(),
            forms=(vector_sum(forms),),
            reference="Sec. 2.2",
            role=Role.BIAS,
        )
        return named

    def _named_sum(self, stem: str, value: Vector, latex: str, title: str, frame: str) -> Vector:
        if value == ZeroVector or isinstance(value, VectorSymbol):
            return value
        named: Vector = self.book.define(
            self.g.name(stem), value, latex, title, Law.RATE, unit="rad/s^2", body=frame
        )
        return named

    def _joint_accelerations(self, writer: LinearWriter, bias: Vector) -> None:
        g, book, motion = self.g, self.book, self.motion
        target: Vector = motion.S_ddot - bias
        turning: Vector = self.p.alpha
        if motion.n and self.p.alpha != ZeroVector:
            motion.unknowns.append(self.p.alpha)
        for j in [j for j in range(1, g.count + 1) if g.is_extra(j)]:
            name = g.name(f"ydd_{j}")
            book.note_quantity(
                Quantity(
                    name,
                    rf"\ddot y_{{{j}}}",
                    f"acceleration of extra joint {j}",
                    f"{g.kind(j).unit}/s^2",
                    role=Role.JOINT_ACCELERATION,
                    joint=j,
                )
            )
            motion.ydd[j] = motion.qdd[j] = sp.Symbol(name, real=True)
            motion.unknowns.append(motion.ydd[j])
            target = target - motion.ydd[j] * motion.v[j]
            turning = turning - motion.ydd[j] * g.spin(j)
        if target != motion.S_ddot:
            target = writer.define(
                "rel",
                target,
                r"\ddot{\mathbf S}'",
                "acceleration of the connection point left to the joint accelerations",
                Law.RATE,
                unit="m/s^2",
                coefficient_latex=r"\mathbf E",
                body=self.tip_frame(),
            )
        motion.relative = target
        turns = [
            writer.define(
                f"etad_{k}",
                Dot(n, turning) + nu,
                rf"\dot\eta_{{{k}}}",
                f"acceleration with which the joints turn along moment direction {k}",
                Law.RATE,
                unit="rad/s^2",
                coefficient_latex=rf"\boldsymbol\eta_{{{k}}}",
            )
            for k, (n, nu) in enumerate(zip(motion.n, self._orientation_bias(), strict=True), 1)
        ]
        for j, dual in motion.w.items():
            motion.qdd[j] = writer.define(
                f"qdd_{j}",
                Dot(dual, target) + self._resolved(j, turns),
                rf"\ddot q_{{{j}}}",
                f"acceleration of joint {j}",
                Law.RECIPROCITY,
                unit=f"{g.kind(j).unit}/s^2",
                coefficient_latex=rf"\mathbf w_{{{j}}}",
                reference="Eqs. 8, 9, 16",
                role=Role.JOINT_ACCELERATION,
                joint=j,
            )

    def _orientation_bias(self) -> list[Any]:
        """Per moment direction, what its turning adds to the angular acceleration along it."""
        g, book, motion, p = self.g, self.book, self.motion, self.p
        last = g.group[g.count]
        omega = motion.omega[last]
        found = []
        for k, ((link, platform), n) in enumerate(zip(g.pairs, motion.n, strict=True), 1):
            turning = Cross(Cross(omega, link), platform) + Cross(link, Cross(p.omega, platform))
            rate = (
                turning
                if turning == ZeroVector
                else book.define(
                    g.name(f"nd_m{k}"),
                    turning,
                    rf"\dot{{\mathbf n}}_{{m{k}}}",
                    f"rate of moment direction {k}",
                    Law.RATE,
                    unit="1/s",
                    body=self.tip_frame(),
                )
            )
            found.append(
                book.define(
                    g.name(f"nu_{k}"),
                    Dot(rate, p.omega - omega) - Dot(n, self.beta[last]),
                    rf"\nu_{{{k}}}",
                    f"bias of the angular acceleration along moment direction {k}",
                    Law.RATE,
                    unit="rad/s^2",
                    reference="Sec. 2.2, joint table",
                )
            )
        motion.nu = found
        return found

    def _angular_accelerations(self, writer: LinearWriter) -> None:
        g, book, motion = self.g, self.book, self.motion
        motion.alpha[0] = ZeroVector
        motion.acceleration_tensor[0] = (ZeroTensor, ZeroTensor)
        for j in self.spans:
            if j == 0:
                continue
            previous = motion.alpha[g.group[j - 1]]
            frame = g.frame("axes", j)
            rhs = previous + motion.qdd[j] * g.spin(j) + self.coriolis[j]
            motion.alpha[j] = writer.define(
                f"alpha_{j}",
                rhs,
                rf"\boldsymbol\alpha_{{{j}}}",
                f"angular acceleration of link {j}",
                Law.RATE,
                unit="rad/s^2",
                coefficient_latex=rf"\boldsymbol\Omega_{{{j}}}",
                body=frame,
                collected=not g.composite or j == g.group[g.count],
                accelerated=self._turning(j),
            )
            tensors = []
            rest = motion.known[motion.alpha[j]].remainder
            for mark, alpha in (("", motion.alpha[j]), ("_o", rest)):
                circle = r"^{\circ}" if mark else ""
                tensors.append(
                    book.define(
                        g.name(f"B_{j}") + mark,
                        Skew(alpha) + motion.spin[j],
                        rf"\mathbf B{circle}_{{{j}}}",
                        f"{'remainder of the ' if mark else ''}acceleration tensor of link {j}",
                        Law.DEFINITION,
                        unit="1/s^2",
                        body=frame,
                    )
                )
            motion.acceleration_tensor[j] = (tensors[0], tensors[1])

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

    def _origin_accelerations(self, writer: LinearWriter) -> None:
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
            motion.origin_acceleration[j] = writer.define(
                f"a_o{j}",
                rhs,
                rf"\mathbf a_{{o{j}}}",
                f"acceleration of the origin of joint {j}",
                Law.RATE,
                unit="m/s^2",
                coefficient_latex=rf"\mathbf V_{{{j}}}",
                body=g.frame("axes", previous),
                forms=(form,),
                rest_forms=(rest,),
                collected=not g.composite,
            )
