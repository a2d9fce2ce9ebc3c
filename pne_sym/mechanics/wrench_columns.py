"""Columns of H and Hk: wrenches of the actuators and of constraints on the platform.

Reference: section 2.4, Eqs. 34, 36 and 37.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

from pne_sym.derivation import Book
from pne_sym.mechanics.legs import Leg
from pne_sym.mechanics.placing import Placer, Rows, actuated
from pne_sym.mechanics.reciprocal_wrenches import ConstraintWrench
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.vector import Cross, Dot, ZeroVector

_TERMS = glossary(r"""
H_a_#    | \mathbf H_{\alpha,#}  | ASSEMBLY @base | Eq. 34
    moment of the column's unit force about the platform origin
Hk_a_#   | \mathbf H_{k\alpha,#} | ASSEMBLY @base | Eq. 34
    moment of the column's unit force about the platform origin
phi_c#   | \chi_{#}  | LOOP_CLOSURE | Eq. 37
    loop-closure residual along the constraint force
phi_c#:m | \chi_{#}  | LOOP_CLOSURE | Eq. 37
    loop-closure residual about the constraint moment
gamma_c# | \iota_{#} | LOOP_CLOSURE | Eq. 37
    part of the constraint's second derivative that does not hold the acceleration
""")


class ColumnWriter:
    """Writes the columns of H and Hk, and the constraints."""

    def __init__(self, book: Book, put: Placer) -> None:
        self.book, self.put = book, put

    def write(self, legs: Sequence[Leg]) -> None:
        """Columns of all legs: in the order of legs, in one leg from the base."""
        for leg, j, places in self.put.numbered(legs, actuated):
            self._actuator(leg, j, places)
        for leg, k, places in self.put.numbered(legs, _constraints):
            constraint = leg.motion.constraints[k]
            self._wrench("Hk", leg, (constraint.force, constraint.moment), k + 1, places)
            self._constrained_extras(leg, constraint, places)
            self._constraint(leg, k + 1, constraint, places)

    def _actuator(self, leg: Leg, j: int, places: Rows) -> None:
        """Column of an actuator: the reciprocal wrench of its joint."""
        motion = leg.motion
        if j in motion.w:
            wrench = motion.w[j], motion.o.get(j, ZeroVector)
            self._wrench("H", leg, wrench, j, places)
            self.put.wrench_rows("actuator", leg, wrench, places)
        for other, rows in self.put.extras_of(leg):
            value = sp.S.One if other == j else -self._work(leg, j, other)
            if value != 0:
                self.put.leg_entry("H", leg, value, rows, places)

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

    def _wrench(
        self, array: str, leg: Leg, wrench: tuple[Any, Any], number: int, places: Rows
    ) -> None:
        """A wrench at the connection point, as force and moment at the platform origin."""
        force, moment = wrench
        if self.put.space.translates:
            self.put.leg_column(array, leg, force, 0, places)
        if self.put.space.rotates:
            total = Cross(leg.g.platform_point, force) + moment
            eq = Writer(self.book, leg.g, _TERMS)
            about_origin = eq(f"{array}_a_#", total, number)
            self.put.leg_column(array, leg, about_origin, 3, places)

    def _constrained_extras(self, leg: Leg, constraint: ConstraintWrench, places: Rows) -> None:
        """What the constraint does along the extra degrees of freedom of its leg."""
        for j, rows in self.put.extras_of(leg):
            if leg.g.same_freedom(j)[0]:
                continue
            work = Dot(constraint.force, leg.motion.v[j]) + Dot(constraint.moment, leg.g.spin(j))
            if work != 0:
                self.put.leg_entry("Hk", leg, -work, rows, places)

    def _constraint(self, leg: Leg, k: int, constraint: ConstraintWrench, places: Rows) -> None:
        """The constraint, and its second derivative (Eq. 37)."""
        motion, normal = leg.motion, constraint.force
        eq = Writer(self.book, leg.g, _TERMS)
        # Of the position, and of the right angles of the platform joint.
        coefficients = constraint.coefficients
        angles = [a * Dot(*pair) for a, pair in zip(coefficients, leg.g.pairs, strict=True)]
        along = Dot(normal, motion.residual) - sp.Add(*angles)
        residual = eq("phi_c#:m" if constraint.of_moment else "phi_c#", along, k)
        self.put.leg_scalar("constraints", leg, residual, places)
        turning = sp.Add(*(a * nu for a, nu in zip(coefficients, motion.nu, strict=True)))
        rest = motion.collection.rest(motion.relative)
        bias = eq("gamma_c#", Dot(normal, rest) + turning, k)
        self.put.leg_scalar("constraint_bias", leg, bias, places)
        self.put.wrench_rows("constraint_direction", leg, (normal, constraint.moment), places)


def _constraints(leg: Leg) -> range:
    """Numbers of the constraints of a leg type."""
    return range(len(leg.motion.constraints))
