"""Quantities that depend on the acceleration, with their linear forms.

Every such quantity is written three times: as it is (Eq. 3), and as coefficient
times acceleration plus remainder (Eq. 4); the remainder carries the mark "o" and
follows the same formula with the acceleration a_p (and those of extra
coordinates) put to zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import sympy as sp

from pne_sym.derivation import Book, Law, Role
from pne_sym.mechanics.completion import LeftOut
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.vector import (
    LinearForm,
    TensorSymbol,
    Vector,
    VectorSymbol,
    ZeroVector,
    linear_form,
)


@dataclass
class LegMotion:
    """Symbols of a leg's motion, by joint number or group.

    Attributes:
        a_p: acceleration of the connection point without its centripetal part.
        u_1: centripetal acceleration of the connection point.
        S_ddot: acceleration of the connection point.
        v: velocity vectors v_j of the joints at the connection point.
        w: reciprocal vectors w_j (without extra joints).
        o: moment parts of the reciprocal wrenches, where the leg transmits moments.
        m: the same as amounts along the moment directions.
        n: moment directions.
        nu: biases of the angular acceleration along the moment directions.
        left_out: wrenches that do no work along the leg's freedoms.
        qd, qdd: joint rates and accelerations.
        omega, alpha: angular velocity and acceleration, by group.
        spin: centripetal tensor omega~ omega~, by group.
        acceleration_tensor: alpha~ + omega~ omega~, by group; its remainder.
        slide: velocity with which the slides of a group move its far end, by group.
        origin_acceleration: of the groups' origins, by group.
        known: linear forms of everything that depends on the acceleration.
        unknowns: a_p, the platform's alpha where moments are transmitted, and ydd.
        ydd: accelerations of the extra coordinates, by joint.
        gap: from the connection point as the links reach it to the platform's.
        relative: acceleration of the connection point less the bias.
        named: expressions that have a name, for coefficients that come out as such.
    """

    a_p: Any = None
    u_1: Any = None
    S_ddot: Any = None
    v: dict[int, Vector] = field(default_factory=dict)
    w: dict[int, VectorSymbol] = field(default_factory=dict)
    o: dict[int, Vector] = field(default_factory=dict)
    m: dict[int, list[Any]] = field(default_factory=dict)
    n: list[Any] = field(default_factory=list)
    nu: list[Any] = field(default_factory=list)
    left_out: list[LeftOut] = field(default_factory=list)
    qd: dict[int, Any] = field(default_factory=dict)
    qdd: dict[int, Any] = field(default_factory=dict)
    omega: dict[int, Vector] = field(default_factory=dict)
    alpha: dict[int, Vector] = field(default_factory=dict)
    spin: dict[int, Any] = field(default_factory=dict)
    acceleration_tensor: dict[int, Any] = field(default_factory=dict)
    slide: dict[int, Vector] = field(default_factory=dict)
    origin_acceleration: dict[int, Vector] = field(default_factory=dict)
    known: dict[Any, LinearForm] = field(default_factory=dict)
    unknowns: list[Any] = field(default_factory=list)
    ydd: dict[int, Any] = field(default_factory=dict)
    gap: Any = None
    relative: Any = None
    named: dict[Any, Any] = field(default_factory=dict)


class LinearWriter:
    """Defines quantities that depend on the acceleration, with their linear forms."""

    def __init__(self, book: Book, g: LegGeometry, motion: LegMotion) -> None:
        self.book = book
        self.g = g
        self.motion = motion

    def define(
        self,
        stem: str,
        rhs: Any,
        latex: str,
        title: str,
        law: Law,
        *,
        unit: str,
        coefficient_latex: str,
        body: str | None = None,
        forms: Sequence[Any] = (),
        rest_forms: Sequence[Any] = (),
        reference: str = "",
        collected: bool = True,
        accelerated: Any = None,
        role: Role | None = None,
        joint: int = 0,
    ) -> Any:
        """Define x = rhs, its coefficients and its remainder; returns x.

        The coefficients are those of `accelerated`, an expression that depends on the
        acceleration as x does (default: rhs itself).  If not `collected`, nobody needs them.
        """
        book, g, motion = self.book, self.g, self.motion
        name = g.name(stem)
        form = linear_form(rhs, motion.unknowns, motion.known)
        if not collected:
            form = LinearForm({}, form.remainder)
        elif accelerated is not None:
            other = linear_form(accelerated, motion.unknowns, motion.known)
            form = replace(other, remainder=form.remainder)
        symbol = book.define(
            name,
            rhs,
            latex,
            title,
            law,
            unit=unit,
            body=body,
            forms=forms,
            reference=reference,
            role=role,
            joint=joint,
        )
        words = latex, coefficient_latex, title
        coefficients = {
            unknown: self._coefficient(k, unknown, form, words, rhs, name=name, body=body)
            for k, unknown in enumerate(form.coefficients)
        }
        remainder = form.remainder
        if not (isinstance(remainder, VectorSymbol | sp.Symbol) or remainder in (ZeroVector, 0)):
            remainder = book.define(
                f"{name}_o",
                remainder,
                f"{latex}^{{\\circ}}",
                f"remainder without the acceleration in: {title}",
                Law.RULES,
                unit=unit,
                body=body,
                forms=rest_forms,
                expanded=rhs,
                reference="Sec. 2.3, Eq. 4",
                remainder_of=name,
            )
        motion.known[symbol] = LinearForm(coefficients, remainder)
        if collected:
            book.collect(name, motion.known[symbol], form)
        else:
            book.collect_no_coefficients(name)
        return symbol

    def _mark(self, unknown: Any) -> str:
        """How a coefficient names its unknown: y_3 for an extra coordinate, else alpha."""
        joint = self.book.notation[unknown.name].joint
        return f"y_{joint}" if joint else r"\boldsymbol\alpha"

    def _coefficient(
        self,
        k: int,
        unknown: Any,
        form: LinearForm,
        words: tuple[str, str, str],
        rhs: Any,
        *,
        name: str,
        body: str | None,
    ) -> Any:
        """Coefficient k of a form: by its name if it has one, else defined.

        The words are the quantity's LaTeX, that of its first coefficient, and its title.
        """
        value = self.motion.named.get(form.coefficients[unknown], form.coefficients[unknown])
        if isinstance(value, VectorSymbol | TensorSymbol | sp.Symbol) or not value.args:
            return value
        latex, coefficient_latex, title = words
        first = unknown == self.motion.a_p
        return self.book.define(
            f"d_{name}" if first else f"d{k}_{name}",
            value,
            coefficient_latex if first else f"{latex}^{{({self._mark(unknown)})}}",
            f"coefficient of the acceleration in: {title}",
            Law.RULES,
            body=body,
            linear=form if first else None,
            expanded=rhs,
            reference="Sec. 2.3, Eq. 4",
        )
