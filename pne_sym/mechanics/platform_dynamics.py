"""Newton-Euler of the platform with the legs' forces, and assembly of M, Z, H.

Reference: section 2.4, Eqs. 5 to 7 and 32 to 34.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

from pne_sym.derivation import Book
from pne_sym.mechanics.legs import Leg, plus_sums
from pne_sym.mechanics.lumping import PlatformInertia
from pne_sym.mechanics.moving_base import carried_platform
from pne_sym.mechanics.placing import Placer
from pne_sym.mechanics.platform_blocks import BlockWriter
from pne_sym.mechanics.platform_motion import PlatformMotion
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.mechanics.wrench_columns import ColumnWriter
from pne_sym.model.kinematics import TaskSpace
from pne_sym.vector import Cross, Dot, LinearForm, Vector, ZeroVector, linear_form, vector_sum

_TERMS = glossary(r"""
a_t    | \mathbf a_t          | RATE @base | Eq. 32
    acceleration of the platform origin, less gravity
f_p    | \mathbf f_p          | NEWTON @base | Eq. 32
    inertia force of the platform less its weight
mu_p   | \boldsymbol\mu_p     | EULER    | Eq. 33
    inertia moment of the platform less that of its weight
R_t    | \mathbf R_t          | ASSEMBLY @base | Eq. 32
    force that actuators and external wrench must give
R_a    | \mathbf R_\alpha     | ASSEMBLY @base | Eq. 33
    moment that actuators and external wrench must give
M_ya_# | \mathbf M_{y\alpha,#} | RULES @base | Eqs. 6, 7
    coupling of extra joint # with the rotation of the platform
""")
_EQUILIBRIUM = (
    "Newton's and Euler's equations of the platform with the legs' forces; moments about the "
    "platform origin."
)
_BLOCKS = (
    "The legs' forces are put into the equations of the platform in closed form (Eq. 4), with the "
    "accelerations that the platform gives to their connection points. Rules I and II collect the "
    "platform's acceleration: its coefficients are the blocks of M, what remains is Z. The "
    "reciprocal vectors of the actuated joints are the columns of H."
)


class PlatformWriter:
    """Writes the platform's equations and the blocks of M, Z, H."""

    def __init__(
        self,
        book: Book,
        space: TaskSpace,
        platform: PlatformMotion,
        inertia: PlatformInertia,
        legs: Sequence[Leg],
    ) -> None:
        self.book, self.space, self.p, self.legs = book, space, platform, legs
        self.inertia, self.put = inertia, Placer(book, space, legs)
        self.eq = Writer(book, None, _TERMS)

    # ---- equilibrium: what actuators and wrench must give ------------------------------

    def equilibrium(self) -> None:
        """Eq. 3 route: the generalised force that actuators and wrench must give."""
        p, mass, h, J = self.p, self.inertia.mass, self.inertia.moment, self.inertia.tensor
        self.book.chapter("E", "Equilibrium of the platform", _EQUILIBRIUM)
        relative: Vector = -p.gravity
        if self.space.translates:
            relative = self.eq("a_t", p.t_ddot - p.gravity)
        force = self._newton(relative) if self.space.translates else None
        moment = self._euler(relative) if self.space.rotates else None
        more_force, more_moment = carried_platform(self.book, p, mass, h, J)
        if force is not None:
            self._force(force + more_force)
        if moment is not None:
            self._moment(moment + more_moment)
        for leg, j, rows in self.put.extras:
            self.put.leg_scalar("required", leg, leg.dynamics.extra_rows[j][0], rows)

    def _newton(self, relative: Vector) -> Any:
        """Inertia force of the platform less its weight."""
        p, mass, h = self.p, self.inertia.mass, self.inertia.moment
        turning = Cross(p.alpha, h) + Cross(p.omega, Cross(p.omega, h))
        forms = (mass * relative + p.tensor @ h,) if self.space.rotates else ()
        return self.eq("f_p", mass * relative + turning, forms=forms)

    def _euler(self, relative: Vector) -> Any:
        """Inertia moment of the platform less that of its weight."""
        p, h, J = self.p, self.inertia.moment, self.inertia.tensor
        terms = Cross(h, relative), J @ p.alpha, Cross(p.omega, J @ p.omega)
        body = "base" if self.space.planar else "platform"
        return self.eq("mu_p", vector_sum(terms), body=body)

    def _force(self, own: Any) -> None:
        """What H tau plus the external wrench must equal: force."""
        total = plus_sums(own, self.legs, lambda leg: -leg.dynamics.force)
        self.put.vector("required", self.eq("R_t", total), 0)

    def _moment(self, own: Any) -> None:
        """The same: moment about the platform origin."""

        def of_leg(leg: Leg) -> Any:
            return -Cross(leg.g.platform_point, leg.dynamics.force) - leg.dynamics.moment

        total = plus_sums(own, self.legs, of_leg)
        self.put.vector("required", self.eq("R_a", total), 3)

    # ---- blocks of M, Z, H -----------------------------------------------------------

    def blocks(self) -> None:
        """Eq. 4 route: M, Z, H."""
        self.book.chapter("M", "M, Z and H", _BLOCKS)
        mass, moment = self.inertia.mass, self.inertia.moment
        blocks = BlockWriter(self.book, self.p, self.legs, mass, moment).write()
        for name, row, column in (("tt", 0, 0), ("ta", 0, 3), ("aa", 3, 3)):
            if name in blocks:
                self.put.block("M", blocks[name], row, column)
        for name, first in (("Z_t", 0), ("Z_a", 3)):
            if name in blocks:
                self.put.vector("Z", blocks[name], first)
        for leg, j, rows in self.put.extras:
            self._extra_row(leg, j, rows)
        ColumnWriter(self.book, self.put).write(self.legs)

    def _extra_row(self, leg: Leg, j: int, rows: tuple[int, ...]) -> None:
        """Row and column of an extra coordinate (Eqs. 6, 7)."""
        form = leg.dynamics.extra_rows[j][1]
        self.put.leg_scalar("Z", leg, form.remainder, rows)
        own = self._by_platform(leg, form)
        if own.coefficients:
            if self.space.translates:
                self.put.leg_row("M", leg, own.coefficients[self.p.t_ddot], 0, rows)
            if self.space.rotates:
                write = Writer(self.book, leg.g, _TERMS)
                rules = LinearForm({}, sp.S.Zero, own.steps)
                arm = write("M_ya_#", own.coefficients[self.p.alpha], j, linear=rules)
                self.put.leg_row("M", leg, arm, 3, rows)
        for k, columns in self.put.extras_of(leg):
            value = form.coefficients.get(leg.motion.ydd[k], 0)
            if k >= j and value != 0:
                self.put.leg_entry("M", leg, value, rows, columns, mirrored=k != j)

    def _by_platform(self, leg: Leg, form: LinearForm) -> LinearForm:
        """A leg's form collected anew, its connection point moving with the platform."""
        a_p, alpha = leg.motion.a_p, self.p.alpha
        given = (e.rhs for e in self.book.all_equations() if e.lhs == a_p)
        moved = {a_p: next(given, a_p), alpha: alpha}
        parts = (Dot(form.coefficients.get(x, ZeroVector), to) for x, to in moved.items())
        return linear_form(sp.Add(*parts), [x for x in (self.p.t_ddot, alpha) if x != ZeroVector])
