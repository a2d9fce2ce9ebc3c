"""Quantities that depend on the acceleration, with their linear forms.

Every such quantity is written three times: as it is (Eq. 3), and as coefficient
times acceleration plus remainder (Eq. 4); the remainder carries the mark "o" and
follows the same formula with the acceleration a_p (and those of extra
coordinates) put to zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from pne_sym.derivation import Book, Law, Role
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.vector import (
    LinearForm,
    TensorSymbol,
    VectorSymbol,
    ZeroVector,
    linear_form,
)


@dataclass(frozen=True)
class Collection:
    """What is written as coefficient times acceleration plus remainder.

    Attributes:
        a_p: acceleration of the connection point without its centripetal part.
        unknowns: a_p, the platform's alpha where moments are transmitted, and ydd.
        known: linear forms of everything that depends on the acceleration; it grows.
        named: expressions that have a name, for coefficients that come out as such.
    """

    a_p: Any
    unknowns: list[Any]
    known: dict[Any, LinearForm]
    named: dict[Any, Any]

    def rest(self, symbol: Any) -> Any:
        """Remainder of a quantity at zero acceleration."""
        return self.known[symbol].remainder if symbol in self.known else symbol


class LinearWriter:
    """Defines quantities that depend on the acceleration, with their linear forms."""

    def __init__(self, book: Book, g: LegGeometry, collection: Collection) -> None:
        self.book = book
        self.g = g
        self.collection = collection

    def define(
        self,
        stem: str,
        rhs: Any,
        latex: str,
        title: str,
        law: Law,
        *,
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
        book, g, motion = self.book, self.g, self.collection
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
            body=body,
            forms=forms,
            reference=reference,
            role=role,
            joint=joint,
        )
        words = latex, coefficient_latex, title
        coefficients = {
            unknown: self._coefficient(unknown, form, words, rhs, stem=stem, body=body)
            for unknown in form.coefficients
        }
        remainder = form.remainder
        if not (isinstance(remainder, VectorSymbol | sp.Symbol) or remainder in (ZeroVector, 0)):
            remainder = book.define(
                g.name(f"{stem}_o"),
                remainder,
                f"{latex}^{{\\circ}}",
                f"remainder of: {title}",
                Law.RULES,
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
        """How a coefficient's symbol names its unknown: y_3 for an extra coordinate, else alpha."""
        joint = self.book.notation[unknown.name].joint
        return f"y_{joint}" if joint else r"\boldsymbol\alpha"

    def _stem(self, unknown: Any, stem: str) -> str:
        """The name of a coefficient: dy_3_G, dalpha_G, or d_G of the connection point."""
        joint = self.book.notation[unknown.name].joint
        of = "" if unknown == self.collection.a_p else f"y_{joint}" if joint else "alpha"
        return f"d{of}_{stem}"

    def _coefficient(
        self,
        unknown: Any,
        form: LinearForm,
        words: tuple[str, str, str],
        rhs: Any,
        *,
        stem: str,
        body: str | None,
    ) -> Any:
        """A coefficient of a form: by its name if it has one, else defined.

        The words are the quantity's LaTeX, that of its first coefficient, and its title.
        """
        value = self.collection.named.get(form.coefficients[unknown], form.coefficients[unknown])
        if isinstance(value, VectorSymbol | TensorSymbol | sp.Symbol) or not value.args:
            return value
        latex, coefficient_latex, title = words
        first = unknown == self.collection.a_p
        return self.book.define(
            self.g.name(self._stem(unknown, stem)),
            value,
            coefficient_latex if first else f"{latex}^{{({self._mark(unknown)})}}",
            f"coefficient of the acceleration in: {title}",
            Law.RULES,
            body=body,
            linear=form if first else None,
            expanded=rhs,
            reference="Sec. 2.3, Eq. 4",
        )
