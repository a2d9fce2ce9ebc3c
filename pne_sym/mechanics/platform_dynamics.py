"""Newton-Euler of the platform with the legs' forces, and assembly of M, Z, H.

Reference: section 2.4, Eqs. 5 to 7 and 32 to 34.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import sympy as sp

from pne_sym.derivation import Book, Law, Output
from pne_sym.mechanics.completion import ConstraintWrench
from pne_sym.mechanics.leg_dynamics import LegDynamics
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.leg_motion import LegMotion
from pne_sym.mechanics.moving_base import carried_platform
from pne_sym.mechanics.platform_blocks import BlockWriter
from pne_sym.mechanics.platform_motion import PlatformMotion
from pne_sym.model.kinematics import TaskSpace
from pne_sym.vector import (
    Axial,
    Cross,
    Dot,
    Identity,
    LinearForm,
    Outer,
    TensorSymbol,
    Transpose,
    Vector,
    ZeroTensor,
    ZeroVector,
    linear_form,
    sum_over_legs,
    tensor_sum,
    vector_sum,
)


@dataclass(frozen=True)
class Leg:
    """Everything written about one leg type."""

    g: LegGeometry
    motion: LegMotion
    dynamics: LegDynamics

    @property
    def name(self) -> str:
        """Name of the leg type."""
        return self.g.leg_type.name


_LUMPED = (
    "The mass of a leg's last link, gathered at the connection point, moves with the platform "
    "and is counted with it; this changes no force that the platform sees."
)
_NOT_LUMPED = "The platform's own mass, first moment and inertia tensor, about its origin."
_KEPT = (
    " Legs that restrict the platform keep the mass of their last links, so that the multipliers "
    "are the physical reactions."
)
_CARRIES = " The payload moves with the platform and is counted with it."
_PLATFORM = (
    "Newton's and Euler's equations of the platform with the legs' forces; moments about the "
    "platform origin."
)


class PlatformWriter:
    """Writes the platform's equations and the blocks of M, Z, H."""

    def __init__(
        self, book: Book, space: TaskSpace, platform: PlatformMotion, legs: list[Leg]
    ) -> None:
        self.book, self.space, self.p, self.legs = book, space, platform, legs

    def total(self, pick: Callable[[Leg], Any], start: Any) -> Any:
        """A quantity plus its sum over the legs of all types."""
        for leg in self.legs:
            value = pick(leg)
            if value != 0 and value not in (ZeroVector, ZeroTensor):
                start = start + sum_over_legs(value, leg.name)
        return start

    def lump(self) -> None:
        """Platform inertia with the gathered masses."""
        book, p = self.book, self.p
        gathered = any(leg.dynamics.tip_mass != 0 for leg in self.legs)
        kept = any(leg.motion.constraints for leg in self.legs)
        text = (_LUMPED if gathered else _NOT_LUMPED) + (_KEPT if kept else "")
        text += _CARRIES if p.payload else ""
        book.chapter(
            "L", "Platform inertia with the masses gathered at the connection points", text
        )
        bodies = [(p.mass, p.centre, p.inertia), *([p.payload] if p.payload else [])]

        def point_inertia(mass: Any, r: Vector) -> Any:
            return mass * (Dot(r, r) * Identity - Outer(r, r))

        self.mass = book.define(
            "m_star",
            self.total(lambda leg: leg.dynamics.tip_mass, sp.Add(*(mass for mass, *_ in bodies))),
            r"m^*",
            "mass of the platform with the gathered masses",
            Law.LUMPING,
            parameter=True,
        )
        self.moment = book.define(
            "h_star",
            self.total(
                lambda leg: leg.dynamics.tip_mass * leg.g.platform_point,
                vector_sum(mass * centre for mass, centre, _ in bodies),
            ),
            r"\mathbf h^*",
            "first moment about the platform origin",
            Law.LUMPING,
            body="platform",
            parameter=True,
        )
        inertia = tensor_sum(
            part for mass, R, own in bodies for part in (own, point_inertia(mass, R))
        )
        self.inertia = book.define(
            "J_star",
            self.total(
                lambda leg: (
                    point_inertia(leg.dynamics.tip_mass, leg.g.platform_point)
                    if leg.dynamics.tip_mass != 0
                    else ZeroTensor
                ),
                inertia,
            ),
            r"\mathbf J^*",
            "inertia tensor about the platform origin",
            Law.LUMPING,
            body="platform",
            parameter=True,
            symmetric=True,
        )

    def equilibrium(self) -> None:
        """Eq. 3 route: the generalised force that actuators and wrench must give."""
        book, p, space = self.book, self.p, self.space
        book.chapter("E", "Equilibrium of the platform", _PLATFORM)
        h, omega, alpha = self.moment, p.omega, p.alpha
        self.n_newton = self.n_euler = None
        self.relative = (
            -p.gravity
            if not space.translates
            else book.define(
                "a_t",
                p.t_ddot - p.gravity,
                r"\mathbf a_t",
                "acceleration of the platform origin, less gravity",
                Law.RATE,
                body="base",
                reference="Eq. 32",
            )
        )
        if space.translates:
            rhs = self.mass * self.relative + Cross(alpha, h) + Cross(omega, Cross(omega, h))
            self.n_newton = book.define(
                "f_p",
                rhs,
                r"\mathbf f_p",
                "inertia force of the platform less its weight",
                Law.NEWTON,
                body="base",
                reference="Eq. 32",
                forms=self._tensor_form_newton(),
            )
        if space.rotates:
            self.n_euler = book.define(
                "mu_p",
                vector_sum(
                    (
                        Cross(h, self.relative),
                        self.inertia @ alpha,
                        Cross(omega, self.inertia @ omega),
                    )
                ),
                r"\boldsymbol\mu_p",
                "inertia moment of the platform less that of its weight",
                Law.EULER,
                body="base" if space.planar else "platform",
                reference="Eq. 33",
            )
        self.from_base = carried_platform(book, p, self.mass, h, self.inertia)
        self._required()

    def _tensor_form_newton(self) -> tuple[Any, ...]:
        if not self.space.rotates:
            return ()
        return (self.mass * self.relative + self.p.tensor @ self.moment,)

    def _required(self) -> None:
        """What H tau plus the external wrench must equal."""
        book = self.book
        if self.n_newton is not None:
            force = book.define(
                "R_t",
                self.total(lambda leg: -leg.dynamics.force, self.n_newton + self.from_base[0]),
                r"\mathbf R_t",
                "force that actuators and external wrench must give",
                Law.ASSEMBLY,
                body="base",
                reference="Eq. 32",
            )
            self._vector_output("required", force, 0)
        if self.n_euler is not None:
            moment = book.define(
                "R_a",
                self.total(
                    lambda leg: (
                        -Cross(leg.g.platform_point, leg.dynamics.force) - leg.dynamics.moment
                    ),
                    self.n_euler + self.from_base[1],
                ),
                r"\mathbf R_\alpha",
                "moment that actuators and external wrench must give",
                Law.ASSEMBLY,
                body="base",
                reference="Eq. 33",
            )
            self._vector_output("required", moment, 3)
        for leg, j, rows in self._extras():
            self._leg_scalar("required", leg, leg.dynamics.extra_rows[j][0], rows)

    # ---- blocks of M, Z, H -----------------------------------------------------------

    def blocks(self) -> None:
        """Eq. 4 route: M, Z, H."""
        self.book.chapter("M", "M, Z and H", _BLOCKS)
        blocks = BlockWriter(self.book, self.p, self.legs, self.mass, self.moment).write()
        for name, row, column in (("tt", 0, 0), ("ta", 0, 3), ("aa", 3, 3)):
            if name in blocks:
                diagonal = row == column
                self._tensor_output(
                    "M", blocks[name], row, column, mirrored=not diagonal, symmetric=diagonal
                )
        for name, first in (("Z_t", 0), ("Z_a", 3)):
            if name in blocks:
                self._vector_output("Z", blocks[name], first)
        self._extra_blocks()
        self._columns()

    def _extra_blocks(self) -> None:
        """Rows and columns of the extra coordinates (Eqs. 6, 7)."""
        book = self.book
        for leg, j, rows in self._extras():
            form = leg.dynamics.extra_rows[j][1]
            motion, g = leg.motion, leg.g
            self._leg_scalar("Z", leg, form.remainder, rows)
            own = self._by_platform(leg, form)
            if own.coefficients:
                if self.space.translates:
                    self._leg_vector("M", leg, own.coefficients[self.p.t_ddot], 0, leg_rows=rows)
                if self.space.rotates:
                    arm = book.define(
                        g.name(f"M_ya_{j}"),
                        own.coefficients[self.p.alpha],
                        rf"\mathbf M_{{y\alpha,{j}}}",
                        f"coupling of extra joint {j} with the rotation of the platform",
                        Law.RULES,
                        body="base",
                        linear=LinearForm({}, sp.S.Zero, own.steps),
                        reference="Eqs. 6, 7",
                    )
                    self._leg_vector("M", leg, arm, 3, leg_rows=rows)
            for k, unknown in motion.ydd.items():
                if k >= j and unknown in form.coefficients:
                    columns = self._extra_rows_of(leg, k)
                    self.book.outputs.append(
                        Output(
                            "M",
                            form.coefficients[unknown],
                            ((0, 0),),
                            ((0, 0),),
                            leg.name,
                            rows,
                            columns,
                            mirrored=k != j,
                        )
                    )

    def _by_platform(self, leg: Leg, form: LinearForm) -> LinearForm:
        """A leg's form collected anew, its connection point moving with the platform."""
        a_p, alpha = leg.motion.a_p, self.p.alpha
        given = (e.rhs for e in self.book.all_equations() if e.lhs == a_p)
        moved = {a_p: next(given, a_p), alpha: alpha}
        parts = (Dot(form.coefficients.get(x, ZeroVector), to) for x, to in moved.items())
        return linear_form(sp.Add(*parts), [x for x in (self.p.t_ddot, alpha) if x != ZeroVector])

    def _extra_rows_of(self, leg: Leg, j: int) -> tuple[int, ...]:
        return next(rows for other, k, rows in self._extras() if other is leg and k == j)

    def _extras(self) -> list[tuple[Leg, int, tuple[int, ...]]]:
        """Extra joints with the rows of their coordinates, per leg."""
        start = len(self.space.components)
        order = sorted(
            (index, j)
            for leg in self.legs
            for index in leg.g.leg_type.indices
            for j in leg.motion.ydd
        )
        row = {key: start + k for k, key in enumerate(order)}
        return [
            (leg, j, tuple(row[(index, j)] for index in leg.g.leg_type.indices))
            for leg in self.legs
            for j in leg.motion.ydd
        ]

    def _columns(self) -> None:
        """Columns of H: the reciprocal vectors of actuated joints, and their moments."""
        order = sorted(
            (index, j)
            for leg in self.legs
            for index in leg.g.leg_type.indices
            for j, joint in enumerate(leg.g.leg_type.model.joints, 1)
            if joint.actuated
        )
        column = {key: k for k, key in enumerate(order)}
        for leg in self.legs:
            for j, joint in enumerate(leg.g.leg_type.model.joints, 1):
                if joint.actuated:
                    places = tuple(column[(i, j)] for i in leg.g.leg_type.indices)
                    self._column(leg, j, places)
        self._constraint_columns()

    def _column(self, leg: Leg, j: int, places: tuple[int, ...]) -> None:
        motion, book = leg.motion, self.book
        if j in motion.w:
            w: Any = motion.w[j]
            o = motion.o.get(j, ZeroVector)
            self._force_column("H", leg, (w, o), f"H_a_{j}", rf"\mathbf H_{{\alpha,{j}}}", places)
            self._wrench_rows("actuator", leg, (w, o), places)
        for k, other, rows in self._extras():
            if k is not leg:
                continue
            value = sp.S.One if other == j else -self._work(leg, j, other)
            if value != 0:
                book.outputs.append(
                    Output("H", value, ((0, 0),), ((0, 0),), leg.name, rows, places)
                )

    @staticmethod
    def _work(leg: Leg, j: int, extra: int) -> Any:
        """Work of reciprocal wrench j along the degree of freedom of an extra joint."""
        motion, g = leg.motion, leg.g
        if j not in motion.w:
            return sp.S.Zero
        twin, sign = g.same_freedom(extra)
        if twin:  # by reciprocity, without computing it
            return sp.Integer(sign if twin == j else 0)
        work = Dot(motion.w[j], motion.v[extra])
        return work + Dot(motion.o.get(j, ZeroVector), g.spin(extra))

    def _wrench_rows(
        self, array: str, leg: Leg, wrench: tuple[Any, Any], places: tuple[int, ...]
    ) -> None:
        """Force, and moment where some leg transmits one, along rows of an array."""
        for first, part in zip((0, 3), wrench, strict=True):
            if part != ZeroVector:
                self.book.outputs.append(
                    Output(
                        array,
                        part,
                        ((0, 0),),
                        tuple((c, first + c) for c in range(3)),
                        leg.name,
                        places,
                    )
                )

    def _force_column(
        self,
        array: str,
        leg: Leg,
        wrench: tuple[Any, Any],
        stem: str,
        latex: str,
        places: tuple[int, ...],
    ) -> None:
        w, o = wrench
        if self.space.translates:
            self._leg_vector(array, leg, w, 0, leg_columns=places)
        if self.space.rotates:
            moment = self.book.define(
                leg.g.name(stem),
                Cross(leg.g.platform_point, w) + o,
                latex,
                "moment of the column's unit force about the platform origin",
                Law.ASSEMBLY,
                body="base",
                reference="Eq. 34",
            )
            self._leg_vector(array, leg, moment, 3, leg_columns=places)

    def _constraint_columns(self) -> None:
        """Columns of Hk: the constraint wrenches of the legs (Eq. 36)."""
        order = sorted(
            (index, k)
            for leg in self.legs
            for index in leg.g.leg_type.indices
            for k in range(len(leg.motion.constraints))
        )
        column = {key: c for c, key in enumerate(order)}
        for leg in self.legs:
            for k, constraint in enumerate(leg.motion.constraints):
                places = tuple(column[(i, k)] for i in leg.g.leg_type.indices)
                wrench = constraint.force, constraint.moment
                self._force_column(
                    "Hk", leg, wrench, f"Hk_a_{k + 1}", rf"\mathbf H_{{k\alpha,{k + 1}}}", places
                )
                self._constrained_extras(leg, constraint, places)
                self._constraint(leg, k, constraint, places)

    def _constrained_extras(
        self, leg: Leg, constraint: ConstraintWrench, places: tuple[int, ...]
    ) -> None:
        """What the constraint does along the extra degrees of freedom of its leg."""
        for other, j, rows in self._extras():
            if other is not leg or leg.g.same_freedom(j)[0]:
                continue
            work = Dot(constraint.force, leg.motion.v[j]) + Dot(constraint.moment, leg.g.spin(j))
            if work != 0:
                self.book.outputs.append(
                    Output("Hk", -work, ((0, 0),), ((0, 0),), leg.name, rows, places)
                )

    def _constraint(
        self, leg: Leg, k: int, constraint: ConstraintWrench, places: tuple[int, ...]
    ) -> None:
        """The constraint, and its second derivative (Eq. 37)."""
        book, g, motion = self.book, leg.g, leg.motion
        normal = constraint.force
        # Of the position, and of the right angles of the platform joint.
        coefficients = constraint.coefficients
        angles = [a * Dot(*pair) for a, pair in zip(coefficients, g.pairs, strict=True)]
        residual = Dot(normal, motion.gap) - sp.Add(*angles)
        turning = sp.Add(*(a * nu for a, nu in zip(coefficients, motion.nu, strict=True)))
        gap = book.define(
            g.name(f"phi_c{k + 1}"),
            residual,
            rf"\chi_{{{k + 1}}}",
            "loop-closure residual about the constraint moment"
            if constraint.of_moment
            else "loop-closure residual along the constraint force",
            Law.LOOP_CLOSURE,
            reference="Eq. 37",
        )
        self._leg_scalar("constraints", leg, gap, places)
        rest = (
            motion.known[motion.relative].remainder
            if motion.relative in motion.known
            else (motion.relative)
        )
        bias = book.define(
            g.name(f"gamma_c{k + 1}"),
            Dot(normal, rest) + turning,
            rf"\iota_{{{k + 1}}}",
            "part of the constraint's second derivative that does not hold the acceleration",
            Law.LOOP_CLOSURE,
            reference="Eq. 37",
        )
        self._leg_scalar("constraint_bias", leg, bias, places)
        self._wrench_rows("constraint_direction", leg, (normal, constraint.moment), places)

    # ---- placing ---------------------------------------------------------------------

    def _places(self, first: int) -> tuple[tuple[int, int], ...]:
        """(component, position) of the linear (0) or angular (3) components."""
        return tuple(
            (c - first, position)
            for position, c in enumerate(self.space.components)
            if first <= c < first + 3
        )

    def _vector_output(self, array: str, value: Any, first: int) -> None:
        self.book.outputs.append(Output(array, value, self._places(first)))

    def _tensor_output(
        self,
        array: str,
        value: Any,
        row: int,
        column: int,
        *,
        mirrored: bool = False,
        symmetric: bool = False,
    ) -> None:
        self.book.outputs.append(
            Output(
                array,
                value,
                self._places(row),
                self._places(column),
                mirrored=mirrored,
                symmetric=symmetric,
            )
        )

    def _leg_vector(
        self,
        array: str,
        leg: Leg,
        value: Any,
        first: int,
        *,
        leg_rows: tuple[int, ...] = (),
        leg_columns: tuple[int, ...] = (),
    ) -> None:
        if leg_rows:  # laid along a row of M, and its mirror
            self.book.outputs.append(
                Output(
                    array,
                    value,
                    ((0, 0),),
                    self._places(first),
                    leg.name,
                    leg_rows,
                    (),
                    mirrored=True,
                )
            )
        else:
            self.book.outputs.append(
                Output(array, value, self._places(first), ((0, 0),), leg.name, (), leg_columns)
            )

    def _leg_scalar(self, array: str, leg: Leg, value: Any, rows: tuple[int, ...]) -> None:
        self.book.outputs.append(Output(array, value, ((0, 0),), (), leg.name, rows))


_BLOCKS = (
    "The legs' forces are put into the equations of the platform in closed form (Eq. 4), with the "
    "accelerations that the platform gives to their connection points. Rules I and II collect the "
    "platform's acceleration: its coefficients are the blocks of M, what remains is Z. The "
    "reciprocal vectors of the actuated joints are the columns of H."
)

__all__ = ["Axial", "Leg", "PlatformWriter", "TensorSymbol", "Transpose", "tensor_sum"]
