"""Quantities that depend on the acceleration, with their linear forms.

Every such quantity is written three times: as it is (Eq. 3), and as coefficient
times acceleration plus remainder (Eq. 4); the remainder carries the mark "o" and
follows the same formula with the acceleration a_p (and those of extra
coordinates) put to zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from pne_sym.derivation import Book, Law
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.terms import Term, Writer, filled
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


class LinearWriter(Writer):
    """Writes quantities that depend on the acceleration, with their linear forms."""

    def __init__(
        self, book: Book, g: LegGeometry, table: Mapping[str, Term], collection: Collection
    ) -> None:
        super().__init__(book, g, table)
        self.collection = collection

    def collected(
        self,
        stem: str,
        rhs: Any,
        *numbers: Any,
        rest_forms: Sequence[Any] = (),
        collected: bool = True,
        accelerated: Any = None,
        **facts: Any,
    ) -> Any:
        """Define x = rhs, its coefficients and its remainder; returns x.

        The coefficients are those of `accelerated`, an expression that depends on the
        acceleration as x does (default: rhs itself).  If not `collected`, nobody needs them.
        """
        motion = self.collection
        form = linear_form(rhs, motion.unknowns, motion.known)
        if not collected:
            form = LinearForm({}, form.remainder)
        elif accelerated is not None:
            other = linear_form(accelerated, motion.unknowns, motion.known)
            form = replace(other, remainder=form.remainder)
        symbol = self(stem, rhs, *numbers, **facts)
        stem, term, body = (
            filled(stem, numbers),
            self.table[stem].numbered(numbers),
            facts.get("body"),
        )
        coefficients = {
            unknown: self._coefficient(unknown, form, term, rhs, stem=stem, body=body)
            for unknown in form.coefficients
        }
        remainder = self._remainder(
            form.remainder, symbol, term, rhs, rest_forms, stem=stem, body=body
        )
        motion.known[symbol] = LinearForm(coefficients, remainder)
        if collected:
            self.book.collect(symbol.name, motion.known[symbol], form)
        else:
            self.book.collect_no_coefficients(symbol.name)
        return symbol

    def _remainder(
        self,
        value: Any,
        symbol: Any,
        term: Term,
        rhs: Any,
        forms: Sequence[Any],
        *,
        stem: str,
        body: str | None,
    ) -> Any:
        """The remainder of a form: by its name if it has one, else defined."""
        if isinstance(value, VectorSymbol | sp.Symbol) or value in (ZeroVector, 0):
            return value
        return self.book.define(
            self._name(f"{stem}_o"),
            value,
            f"{term.latex}^{{\\circ}}",
            f"remainder of: {term.meaning}",
            Law.RULES,
            body=body,
            forms=forms,
            expanded=rhs,
            reference="Sec. 2.3, Eq. 4",
            remainder_of=symbol.name,
        )

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
        self, unknown: Any, form: LinearForm, term: Term, rhs: Any, *, stem: str, body: str | None
    ) -> Any:
        """A coefficient of a form: by its name if it has one, else defined."""
        value = self.collection.named.get(form.coefficients[unknown], form.coefficients[unknown])
        if isinstance(value, VectorSymbol | TensorSymbol | sp.Symbol) or not value.args:
            return value
        first = unknown == self.collection.a_p
        return self.book.define(
            self._name(self._stem(unknown, stem)),
            value,
            term.coefficient if first else f"{term.latex}^{{({self._mark(unknown)})}}",
            f"coefficient of the acceleration in: {term.meaning}",
            Law.RULES,
            body=body,
            linear=form if first else None,
            expanded=rhs,
            reference="Sec. 2.3, Eq. 4",
        )
