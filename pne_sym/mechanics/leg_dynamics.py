"""Newton-Euler of a leg, from the most distal link to the base, along the degrees of freedom only.

The inertia force f_u of the last link and the leg's force F on the platform act
at the same point, so the equilibrium of the distal links along the degree of freedom of
joint j reads v_j . (F + f_u) = tau_j - Gamma_j, where Gamma_j collects the
moments (revolute), forces (prismatic) or both (helical) of everything but f_u.
Joint reactions never appear.

Reference: sections 2.2, 2.3 and 2.5, Eqs. 1 to 4.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp

from pne_sym.derivation import Book, Law, ParameterField, Quantity, Role, Rule
from pne_sym.mechanics.composite import CompositeWriter
from pne_sym.mechanics.joint_forces import JointForces
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.leg_motion import MotionWriter
from pne_sym.mechanics.linear_writer import LegMotion, LinearWriter
from pne_sym.mechanics.platform_motion import PlatformMotion, symmetric_entries
from pne_sym.vector import (
    Axial,
    Compose,
    Cross,
    Dot,
    Identity,
    LinearForm,
    Outer,
    TensorSymbol,
    Vector,
    VectorSymbol,
    ZeroTensor,
    ZeroVector,
    tensor_sum,
    vector_sum,
)


@dataclass(frozen=True)
class LinkBody:
    """A link with inertia.

    Attributes:
        joint: number of the joint that moves it.
        group: the group that it turns with.
        at_tip: its reference point is the connection point, else its joint.
        mass: scalar.
        first_moment: m r about the reference point, fixed in the link.
        inertia: tensor about the reference point.
    """

    joint: int
    group: int
    at_tip: bool
    mass: Any
    first_moment: Vector
    inertia: Any


@dataclass
class LegDynamics:
    """What the platform needs of a leg.

    Attributes:
        bodies: links with inertia.
        tip_mass: mass gathered at the connection point.
        forces: friction, springs and rotors of its joints.
        force: c, the reduced leg force without actuation (Eq. 3).
        columns: actuated joint -> (w_j, extra rows) of H.
        Q, U: reduced closed form F = h tau - Q a_p - U (Eq. 4).
        true_force: Eq. 3 with the tip mass.
        extra_rows: extra joint -> (row force, its linear form).
        reach: of the links' reference points, for the potential energy.
        form: linear form of the reduced force.
        moment, moment_form: the moment that the leg transmits, likewise.
    """

    bodies: list[LinkBody]
    tip_mass: Any
    forces: JointForces
    force: Any = None
    true_force: Any = None
    Q: Any = None
    U: Any = None
    form: LinearForm | None = None
    moment: Any = ZeroVector
    moment_form: LinearForm = field(default_factory=lambda: LinearForm({}, ZeroVector))
    extra_rows: dict[int, tuple[Any, LinearForm]] = field(default_factory=dict)


def introduce_bodies(book: Book, g: LegGeometry, planar: bool) -> list[LinkBody]:
    """Parameters of the links, and their lumped inertia about their reference points."""
    bodies = []
    free = sum(not joint.extra for joint in g.leg_type.model.joints)
    # Only a leg that lets the connection point move freely carries its acceleration over to the
    # last link; else that link moves as its own joints let it.
    unconstrained = free == (2 if planar else 3) + len(g.pairs)
    last_moving = g.count if unconstrained else 0
    for j, joint in enumerate(g.leg_type.model.joints, 1):
        if joint.link.is_massless:
            continue
        bodies.append(_body(book, g, j, at_tip=j == last_moving, planar=planar))
    return bodies


def _body(book: Book, g: LegGeometry, j: int, *, at_tip: bool, planar: bool) -> LinkBody:
    """Lumped inertia of link j about its reference point."""
    frame = g.frame("spec", g.group[j])
    mass, rho, inertia = _link_parameters(book, g, j, planar=planar)
    arm = rho
    if at_tip and g.offset[g.count + 1] != ZeroVector:
        arm = book.define(
            g.name(f"rho_tip_{j}"),
            rho - g.offset[g.count + 1],
            rf"\boldsymbol\rho'_{{{j}}}",
            f"connection point to the centre of mass of link {j}",
            Law.LUMPING,
            body=frame,
            parameter=True,
        )
    point = "the connection point" if at_tip else f"the origin of link {j}"
    moment = book.define(
        g.name(f"h_{j}"),
        mass * arm,
        rf"\mathbf h_{{{j}}}",
        f"first moment of link {j} about {point}",
        Law.LUMPING,
        body=frame,
        parameter=True,
    )
    tensor = book.define(
        g.name(f"J_{j}"),
        inertia + mass * (Dot(arm, arm) * Identity - Outer(arm, arm)),
        rf"\mathbf J_{{{j}}}",
        f"inertia tensor of link {j} about {point}",
        Law.LUMPING,
        body=frame,
        parameter=True,
        symmetric=True,
    )
    return LinkBody(j, g.group[j], at_tip, mass, moment, tensor)


def _link_parameters(book: Book, g: LegGeometry, j: int, *, planar: bool) -> tuple[Any, Any, Any]:
    """Mass, centre of mass and inertia tensor of link j, as its specification has them."""
    frame = g.frame("spec", g.group[j])
    (mass,) = _link_field(book, g, j, "mass", rule=Rule.MASS)
    book.note_quantity(Quantity(mass.name, f"m_{{{j}}}", f"mass of link {j}", parameter=True))
    centre = _link_field(book, g, j, "centre_of_mass", (2,) if planar else ())
    rule = Rule.PLANAR_INERTIA if planar else Rule.INERTIA
    entries = _link_field(book, g, j, "inertia", rule=rule)
    rho = g.name(f"rho_{j}")
    rho_quantity = Quantity(
        rho,
        rf"\boldsymbol\rho_{{{j}}}",
        f"origin of link {j} to its centre of mass, fixed in the link",
        body=frame,
        parameter=True,
    )
    inertia = g.name(f"I_{j}")
    inertia_quantity = Quantity(
        inertia,
        rf"\mathbf I_{{{j}}}",
        f"inertia tensor of link {j} about its centre of mass",
        body=frame,
        parameter=True,
    )
    return (
        mass,
        book.give(VectorSymbol(rho), frame, centre, rho_quantity),
        book.give(
            TensorSymbol(inertia, True), frame, symmetric_entries(entries, planar), inertia_quantity
        ),
    )


_LINK_FIELDS: dict[str, tuple[tuple[int, ...], str, str]] = {
    "mass": ((), "kg", "mass of link {j}"),
    "centre_of_mass": ((3,), "m", "centre of mass of link {j}, link frame"),
    "inertia": ((3, 3), "kg m^2", "inertia tensor of link {j} about its centre of mass, link axes"),
}
"""Field of a link -> shape, unit, meaning."""


def _link_field(
    book: Book,
    g: LegGeometry,
    j: int,
    field_name: str,
    zeros: tuple[int, ...] = (),
    rule: Rule = Rule.FREE,
) -> tuple[Any, ...]:
    """A live parameter of link j: symbols of its entries."""
    legs, (shape, unit, meaning) = g.leg_type, _LINK_FIELDS[field_name]
    return book.parameters.add(
        ParameterField(
            f"{legs.name}_{legs.part('link', j)}_{field_name}",
            legs.name,
            shape,
            unit,
            meaning.format(j=j),
            tuple(f"legs[{i}].joints[{j - 1}].link.{field_name}" for i in legs.indices),
            np.asarray(legs.over_legs(lambda leg: getattr(leg.joints[j - 1].link, field_name))),
            zeros,
            rule,
        )
    )


class DynamicsWriter:
    """Writes Newton-Euler of a leg."""

    def __init__(
        self,
        book: Book,
        g: LegGeometry,
        platform: PlatformMotion,
        motion: LegMotion,
        kinematics: MotionWriter,
        bodies: list[LinkBody],
        forces: JointForces,
    ) -> None:
        self.book, self.g, self.p, self.motion, self.k = book, g, platform, motion, kinematics
        self.forces = forces
        self.write = LinearWriter(book, g, motion.collection)
        self.bodies = bodies

    def rest(self, symbol: Any) -> Any:
        """Remainder of a quantity at zero acceleration."""
        return self.motion.known[symbol].remainder if symbol in self.motion.known else symbol

    def body_forces(self, body: LinkBody) -> tuple[Any, Any]:
        """Inertia-minus-gravity force f and the part of the moment from h x a."""
        g, motion, j = self.g, self.motion, body.joint
        tensor, tensor_rest = motion.acceleration_tensor[body.group]
        h, omega, alpha = body.first_moment, motion.omega[body.group], motion.alpha[body.group]
        frame = g.frame("axes", body.group)
        relative = self._relative_acceleration(body)
        turning: Any = ZeroVector
        if omega != ZeroVector:
            turning = self.write.define(
                f"phi_{j}",
                Cross(alpha, h) + Cross(omega, Cross(omega, h)),
                rf"\mathbf f^{{\omega}}_{{{j}}}",
                f"inertia force of link {j} from its turning about its reference point",
                Law.NEWTON,
                coefficient_latex=rf"\boldsymbol\Phi_{{{j}}}",
                body=frame,
                forms=(tensor @ h,),
                rest_forms=(tensor_rest @ h,),
                reference="Eq. 1",
                collected=body.at_tip or not g.composite,
            )
        return turning, relative

    def _relative_acceleration(self, body: LinkBody) -> Any:
        """Acceleration of the reference point minus gravity."""
        g, motion, j = self.g, self.motion, body.joint
        frame = g.frame("axes", body.group)
        if body.at_tip:
            rhs = motion.S_ddot - self.p.gravity
            forms: tuple[Any, ...] = ()
            rests: tuple[Any, ...] = ()
        else:
            slides = [i for i in range(1, j + 1) if g.group[i] == body.group and g.slides(i)]
            value, form, rest = self.k.point_acceleration(body.group, self.k.reach(j), slides)
            rhs = value - self.p.gravity
            forms, rests = (form - self.p.gravity,), (rest - self.p.gravity,)
        return self.write.define(
            f"acc_{j}",
            rhs,
            rf"\mathbf a_{{{j}}}",
            f"acceleration of the reference point of link {j}, less gravity",
            Law.RATE,
            coefficient_latex=rf"\boldsymbol\Theta_{{{j}}}",
            body=frame,
            forms=forms,
            rest_forms=rests,
            reference="Eqs. 10, 11, 17, 18",
            collected=body.at_tip or not g.composite,
        )

    def group_moment(self, group: int, relative: dict[int, Any]) -> Any:
        """Moment of inertia of a group's links about their own reference points (Euler)."""
        g, motion = self.g, self.motion
        members = [b for b in self.bodies if b.group == group]
        if not members or group == 0:
            return ZeroVector
        J, second = self._group_inertia(group, members)
        omega, alpha = motion.omega[group], motion.alpha[group]
        moments = [Cross(b.first_moment, relative[b.joint]) for b in members]
        rest_moments = [Cross(b.first_moment, self.rest(relative[b.joint])) for b in members]
        ways = [(moments, rest_moments), *self._gathered_moments(members, relative)]
        turning, turning_rest = (
            Axial(Compose(tensor, second)) for tensor in motion.acceleration_tensor[group]
        )
        return self.write.define(
            f"mu_{group}",
            vector_sum((J @ alpha, Cross(omega, J @ omega), *moments)),
            rf"\boldsymbol\mu_{{{group}}}",
            f"inertia moment of the links that turn with link {group}, about their "
            f"reference points",
            Law.EULER,
            coefficient_latex=rf"\boldsymbol\Psi_{{{group}}}",
            body=g.frame("axes", group),
            forms=tuple(vector_sum((turning, *terms)) for terms, _ in ways),
            rest_forms=tuple(vector_sum((turning_rest, *terms)) for _, terms in ways),
            reference="Eq. 2",
            collected=not g.composite,
        )

    def _group_inertia(self, group: int, members: list[LinkBody]) -> tuple[Any, Any]:
        """Inertia tensor J of a group's links, each about its reference point; tr(J)/2 E - J."""
        g, frame = self.g, self.g.frame("axes", group)
        J = tensor_sum(b.inertia for b in members)
        if not isinstance(J, TensorSymbol):
            J = self.book.define(
                g.name(f"J_group_{group}"),
                J,
                rf"\mathbf J^\Sigma_{{{group}}}",
                f"inertia of the links that turn with link {group}, each about its reference point",
                Law.LUMPING,
                body=frame,
                parameter=True,
                symmetric=True,
            )
        second = self.book.define(
            g.name(f"Sigma_{group}"),
            self._half_trace(J, group) * Identity - J,
            rf"\boldsymbol\Sigma_{{{group}}}",
            f"second moment of mass of the links that turn with link {group}",
            Law.LUMPING,
            body=frame,
            parameter=True,
            symmetric=True,
        )
        return J, second

    def _gathered_moments(
        self, members: list[LinkBody], relative: dict[int, Any]
    ) -> list[tuple[list[Any], list[Any]]]:
        """The moments h x (a - g) with gravity taken out once: (terms, terms at rest), or none."""
        g, gravity = self.g, self.p.gravity
        if len(members) < 2:
            return []
        accelerations: dict[int, tuple[Any, Any]] = {}
        for b in members:
            found = self._without_gravity(relative[b.joint])
            if found is None:
                return []
            accelerations[b.joint] = found
        total = self.book.define(
            g.name(f"h_group_{members[0].group}"),
            vector_sum(b.first_moment for b in members),
            rf"\mathbf h^\Sigma_{{{members[0].group}}}",
            f"first moments of the links that turn with link {members[0].group}",
            Law.LUMPING,
            body=g.frame("axes", members[0].group),
            parameter=True,
        )
        weight = -Cross(total, gravity)
        terms, rest = (
            [weight, *(Cross(b.first_moment, accelerations[b.joint][k]) for b in members)]
            for k in (0, 1)
        )
        return [(terms, rest)]

    def _without_gravity(self, relative: Any) -> tuple[Any, Any] | None:
        """Acceleration and its remainder, where the relative one is a named difference."""
        if relative == -self.p.gravity:
            return ZeroVector, ZeroVector
        equation = next((e for e in self.book.all_equations() if e.lhs == relative), None)
        if equation is None:
            return None
        terms = [t for t in getattr(equation.rhs, "args", ()) if t != -self.p.gravity]
        if equation.rhs == -self.p.gravity:
            return ZeroVector, ZeroVector
        plain = vector_sum(terms) if len(terms) == 1 else None
        if not isinstance(plain, VectorSymbol):
            return None
        return plain, self.rest(plain)

    def _half_trace(self, J: Any, group: int) -> Any:
        """Half the trace of the group's inertia."""
        axes = []
        for k in range(3):
            name = self.g.name(f"unit{k}_{group}")
            symbol = VectorSymbol(name)
            components = [sp.Integer(int(i == k)) for i in range(3)]
            frame = self.book.notation[J.name].body or "base"
            self.book.give(
                symbol,
                frame,
                components,
                Quantity(
                    name,
                    rf"\mathbf{{i}}_{{{k + 1}}}",
                    "coordinate direction",
                    body=frame,
                    parameter=True,
                ),
            )
            axes.append(symbol)
        return self.book.define(
            self.g.name(f"trace_J_{group}"),
            sp.Add(*(Dot(a, J @ a) for a in axes)) / 2,
            self.book.notation[J.name].latex.replace(r"\mathbf J", "j"),
            "half the trace of that inertia tensor",
            Law.LUMPING,
            parameter=True,
        )

    def run(self) -> LegDynamics:
        """Write Newton-Euler from the last link to the base and solve for the leg's force."""
        motion = self.motion
        tip = next((b for b in self.bodies if b.at_tip), None)
        forces: dict[int, Any] = {}
        relative: dict[int, Any] = {}
        phi_tip: Any = ZeroVector
        for body in self.bodies:
            turning, acceleration = self.body_forces(body)
            relative[body.joint] = acceleration
            if body.at_tip:
                phi_tip = turning
                continue
            forces[body.joint] = self._link_force(body, turning, acceleration)
        self.inertia = (
            CompositeWriter(self.book, self.g, self.k, self.bodies).inertia()
            if self.g.composite
            else {}
        )
        self.tip_moment = Cross(tip.first_moment, relative[tip.joint]) if tip else ZeroVector
        gamma = self._recursion(forces, relative)
        result = LegDynamics(self.bodies, tip.mass if tip else sp.S.Zero, self.forces)
        self._solve(result, gamma, phi_tip, relative.get(tip.joint) if tip else None)
        for j in motion.ydd:
            self._extra_row(result, j, gamma)
        return result

    def _link_force(self, body: LinkBody, turning: Any, acceleration: Any) -> Any:
        j = body.joint
        return self.write.define(
            f"f_{j}",
            body.mass * acceleration + turning,
            rf"\mathbf f_{{{j}}}",
            f"inertia force of link {j} less its weight",
            Law.NEWTON,
            coefficient_latex=rf"\boldsymbol\Upsilon_{{{j}}}",
            body=self.g.frame("axes", body.group),
            reference="Eq. 1",
            collected=not self.g.composite,
        )

    def _recursion(self, forces: dict[int, Any], relative: dict[int, Any]) -> dict[int, Any]:
        """Gamma_j of every joint, from the tip to the base."""
        g = self.g
        groups = sorted({0, *g.group.values()}, reverse=True)
        force_out: Any = ZeroVector  # inertia force of all groups beyond
        moment_out: Any = ZeroVector  # their moment about the next group's origin
        gamma: dict[int, Any] = {}
        for group in groups:
            frame = g.frame("axes", group)
            members = [j for j in range(1, g.count + 1) if g.group[j] == group]
            moment = self._group_total(group, members, forces, relative, force_out, moment_out)
            force: Any = force_out
            for j in reversed(members):
                force = self._sum_force(j, force, forces.get(j, ZeroVector), frame)
                if j != group:
                    gamma[j] = self._freedom(j, Dot(g.slide(j), force))
            if group:
                component = Dot(g.spin(group), moment) + Dot(g.slide(group), force)
                gamma[group] = self._freedom(group, component)
            force_out, moment_out = force, moment
        return gamma

    def _group_total(
        self,
        group: int,
        members: list[int],
        forces: dict[int, Any],
        relative: dict[int, Any],
        force_out: Any,
        moment_out: Any,
    ) -> Any:
        """Moment about the group's origin of everything from the group outwards."""
        g = self.g
        if group == 0:
            return ZeroVector
        terms = [
            self.group_moment(group, relative),
            moment_out,
            Cross(self.k.spans[group], force_out),
        ]
        terms += [Cross(self.k.reach(j), forces[j]) for j in members if j in forces]
        total = vector_sum(terms)
        if isinstance(total, VectorSymbol) or total == ZeroVector:
            return total
        return self.write.define(
            f"N_{group}",
            total,
            rf"\mathbf N_{{{group}}}",
            f"moment about joint {group} of the links from {group} outwards, the force at the "
            f"connection point left out",
            Law.EULER,
            coefficient_latex=rf"\boldsymbol\Xi_{{{group}}}",
            body=g.frame("axes", group),
            reference="Sec. 2.5, step 1.3",
            collected=not g.composite,
        )

    def _sum_force(self, j: int, outer: Any, own: Any, frame: str) -> Any:
        total = vector_sum((own, outer))
        if isinstance(total, VectorSymbol) or total == ZeroVector:
            return total
        return self.write.define(
            f"T_{j}",
            total,
            rf"\mathbf f^{{\Sigma}}_{{{j}}}",
            f"inertia force of the links from {j} outwards, the last link left out",
            Law.NEWTON,
            coefficient_latex=rf"\boldsymbol{{\mathcal F}}_{{{j}}}",
            body=frame,
            collected=not self.g.composite,
        )

    def _freedom(self, j: int, component: Any) -> Any:
        other = self.forces.along(j)
        if component == 0 and other == 0:
            return sp.S.Zero
        return self.write.define(
            f"Gamma_{j}",
            component + other,
            rf"\Gamma_{{{j}}}",
            f"{self.g.kind(j).effort} axis {j} of the distal links' inertia and weight"
            + ", and of what acts in the joint" * (other != 0),
            Law.FREEDOM,
            coefficient_latex=rf"\boldsymbol\gamma_{{{j}}}",
            reference="Sec. 2.2, joint table",
            accelerated=self._accelerated(j) if self.g.composite else None,
        )

    def _accelerated(self, j: int) -> Any:
        """What of Gamma_j depends on the accelerations of the joints and of the tip."""
        total = sp.Add(*(self.inertia.get((j, k), 0) * qdd for k, qdd in self.motion.qdd.items()))
        total = total + self.forces.accelerating(j)
        return total + Dot(self.g.spin(j), self.tip_moment)

    def _solve(self, result: LegDynamics, gamma: dict[int, Any], phi: Any, a_tip: Any) -> None:
        """The leg's force on the platform, Eq. 3 and Eq. 4."""
        self.G = self._force_balance(gamma)
        self.G_m: Any = self._moment_balance(gamma)
        self._reduced_force(result, phi)
        self._moments(result)
        self._velocity_terms(result)
        tip_force = result.tip_mass * a_tip if a_tip is not None else ZeroVector
        result.true_force = result.force
        if tip_force != ZeroVector:
            result.true_force = self.book.define(
                self.g.name("c_true"),
                result.force - tip_force,
                r"\mathbf c^*",
                "leg force on the platform without actuation, the last link's mass included",
                Law.NEWTON,
                body=self.k.tip_frame(),
                reference="Eq. 3",
            )

    def _force_balance(self, gamma: dict[int, Any]) -> Any:
        """Force at the connection point, from the coefficients along the degrees of freedom."""
        G: Any = vector_sum(gamma[j] * w for j, w in self.motion.w.items() if gamma[j] != 0)
        if ZeroVector == G:
            return ZeroVector
        return self.write.define(
            "G",
            G,
            r"\mathbf G",
            "force at the connection point that balances the leg's "
            "inertia and weight along all degrees of freedom",
            Law.RECIPROCITY,
            coefficient_latex=r"\boldsymbol{\mathcal G}",
            body=self.k.tip_frame(),
            reference="Sec. 2.3",
        )

    def _reduced_force(self, result: LegDynamics, phi: Any) -> None:
        """The leg's force without its actuators and the mass at the tip, and its inertia Q."""
        frame, a_p = self.k.tip_frame(), self.motion.a_p
        c: Any = ZeroVector
        if self.G + phi != ZeroVector:
            c = self.write.define(
                "c",
                -(self.G + phi),
                r"\mathbf c",
                "leg force on the platform without actuation and without the mass at the "
                "connection point",
                Law.REDUCTION,
                coefficient_latex=r"\boldsymbol{\mathcal C}",
                body=frame,
                reference="Eq. 3",
            )
        result.force = c
        result.form = self.motion.known.get(c, LinearForm({}, ZeroVector))
        result.Q = ZeroTensor
        if a_p in result.form.coefficients:
            result.Q = self.book.define(
                self.g.name("Q"),
                -result.form.coefficients[a_p],
                r"\mathbf Q",
                "inertia of the leg at the connection point, without the mass gathered there",
                Law.RULES,
                body=frame,
                symmetric=True,
                reference="Eq. 4",
                role=Role.LEG_INERTIA,
            )

    def _velocity_terms(self, result: LegDynamics) -> None:
        """What is left of the leg's force at zero acceleration: U."""
        assert result.form is not None
        result.U = ZeroVector
        if result.form.remainder != ZeroVector:
            result.U = self.book.define(
                self.g.name("U"),
                -result.form.remainder,
                r"\mathbf U",
                "velocity and gravity terms of the leg force",
                Law.RULES,
                body=self.k.tip_frame(),
                reference="Eq. 4",
                role=Role.LEG_BIAS,
            )

    def _moment_balance(self, gamma: dict[int, Any]) -> Any:
        """Moment of the leg, from its coefficients along the moment directions."""
        motion, coefficients = self.motion, []
        for k, n in enumerate(motion.n, 1):
            coefficient = sp.Add(*(gamma[j] * m[k - 1] for j, m in motion.m.items()))
            if coefficient != 0:
                coefficients.append(
                    n
                    * self.write.define(
                        f"G_m{k}",
                        coefficient,
                        f"G_{{m{k}}}",
                        f"moment along moment direction {k} that balances the leg's inertia "
                        "and weight along all degrees of freedom",
                        Law.RECIPROCITY,
                        coefficient_latex=rf"\boldsymbol{{\mathcal G}}_{{m{k}}}",
                        reference="Sec. 2.2, joint table",
                    )
                )
        if not coefficients:
            return ZeroVector
        return self.write.define(
            "G_m",
            vector_sum(coefficients),
            r"\mathbf G_m",
            "moment at the connection point that balances the leg's inertia and weight along "
            "all degrees of freedom",
            Law.RECIPROCITY,
            coefficient_latex=r"\boldsymbol{\mathcal G}_m",
            body=self.k.tip_frame(),
            reference="Sec. 2.2, joint table",
        )

    def _moments(self, result: LegDynamics) -> None:
        """The moment that the leg transmits, with its linear form."""
        total = self.G_m + self.forces.end
        if total == ZeroVector:
            return
        c = self.write.define(
            "c_m",
            -total,
            r"\mathbf c_m",
            "moment of the leg on the platform without actuation",
            Law.REDUCTION,
            coefficient_latex=r"\boldsymbol{\mathcal C}_m",
            body=self.k.tip_frame(),
            reference="Eq. 3",
        )
        result.moment, result.moment_form = c, self.motion.known.get(c, LinearForm({}, c))

    def _extra_row(self, result: LegDynamics, j: int, gamma: dict[int, Any]) -> None:
        """Equilibrium along an extra joint: a row of its own (Eqs. 6, 7)."""
        g, motion = self.g, self.motion
        row = gamma[j] - Dot(motion.v[j], self.G) - Dot(g.spin(j), self.G_m)
        symbol = self.write.define(
            f"P_{j}",
            row,
            rf"P_{{{j}}}",
            f"inertia and weight of the leg along the extra degree of freedom of joint {j}",
            Law.FREEDOM,
            coefficient_latex=rf"\mathbf M_{{yt,{j}}}",
            reference="Eqs. 6, 7",
        )
        result.extra_rows[j] = (symbol, motion.known[symbol])
