"""Quantities that depend on the acceleration, with their linear forms.

Every such quantity is written three times: as it is (Eq. 3), and as coefficient
times acceleration plus remainder (Eq. 4); the remainder carries the mark "o" and
follows the same formula with the acceleration a_p (and those of extra
coordinates) put to zero.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

from pne_sym.derivation import Book, Law
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.terms import Term, Writer, filled, is_named
from pne_sym.vector import LinearForm, linear_form


class Collection(NamedTuple):
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

    def form(self, expr: Any) -> LinearForm:
        """An expression collected in the unknowns."""
        return linear_form(expr, self.unknowns, self.known)

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
        form = self.collection.form(rhs)
        if not collected:
            form = LinearForm({}, form.remainder)
        elif accelerated is not None:
            form = replace(self.collection.form(accelerated), remainder=form.remainder)
        symbol = self(stem, rhs, *numbers, **facts)
        term, stem = self.table[stem].numbered(numbers), filled(stem, numbers)
        body, reference = self.frame(term, numbers), "Sec. 2.3, Eq. 4"
        define = partial(self.book.define, law=Law.RULES, reference=reference)
        by_rules = partial(define, body=body, expanded=rhs)
        coefficients = {
            x: self._coefficient(x, form, stem, term, by_rules) for x in form.coefficients
        }
        rest = form.remainder
        if not is_named(rest):
            latex, title = rf"{term.latex}^{{\circ}}", f"remainder of: {term.meaning}"
            name, own = self._name(f"{stem}_o"), symbol.name
            rest = by_rules(name, rest, latex, title, forms=rest_forms, remainder_of=own)
        known = self.collection.known[symbol] = LinearForm(coefficients, rest)
        if collected:
            self.book.collect(symbol.name, known, form)
        else:
            self.book.collect_no_coefficients(symbol.name)
        return symbol

    def _coefficient(
        self, unknown: Any, form: LinearForm, stem: str, term: Term, by_rules: Callable[..., Any]
    ) -> Any:
        """A coefficient of a form: by its name if it has one, else defined.

        It is called d_G of the connection point's acceleration, dy_3_G of an extra coordinate's,
        dalpha_G of the platform's.
        """
        value = self.collection.named.get(form.coefficients[unknown], form.coefficients[unknown])
        if is_named(value) or not value.args:
            return value
        title = f"coefficient of the acceleration in: {term.meaning}"
        if unknown == self.collection.a_p:
            return by_rules(self._name(f"d_{stem}"), value, term.coefficient, title, linear=form)
        joint = self.book.notation[unknown.name].joint
        of, mark = (f"y_{joint}",) * 2 if joint else ("alpha", r"\boldsymbol\alpha")
        return by_rules(self._name(f"d{of}_{stem}"), value, f"{term.latex}^{{({mark})}}", title)
