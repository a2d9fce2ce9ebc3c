"""Scalar arithmetic with value numbering: equal expressions are computed once.

Every value is an *atom*: a symbol, a negated symbol or a number.  Zeros, ones
and signs therefore vanish as expressions are built, and what depends on
parameters alone is told apart by its stage.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import sympy as sp

from pne_sym.lowering import algebra
from pne_sym.lowering.algebra import terms_of
from pne_sym.lowering.statements import Atom, Statements

_ZERO, _ONE, _MINUS = sp.S.Zero, sp.S.One, sp.S.NegativeOne


class Builder(Statements):
    """Makes a statement where a value is new."""

    def __init__(self) -> None:
        super().__init__()
        self.signs: set[sp.Symbol] = set()

    # ---- values ----------------------------------------------------------------------

    def let(self, expr: Any, hint: str = "", *, named: bool = False) -> Atom:
        """The atom of an expression; a new statement only when the value is new."""
        if not isinstance(expr, sp.Basic):
            expr = sp.sympify(expr)
        if expr.is_Symbol or expr.is_Number:
            return expr
        if expr.is_Mul and len(expr.args) == 2:
            factor, other = expr.args
            if factor is _MINUS and other.is_Symbol:
                return expr
        asked = self._value_of(expr)
        if asked.signed is None:
            sign, key = algebra.signed(expr)
            asked.signed = sign, key, self._value_of(key)
        sign, key, value = asked.signed
        if value.atom is not None:
            return value.atom if sign == 1 else algebra.negative(value.atom)
        if not hint:  # only what has a name keeps its sign: names do not lie
            made = self._remember(value, self._record(key, hint, named=named))
            return made if sign == 1 else algebra.negative(made)
        symbol = self._record(expr, hint, named=named)
        self._remember(value, symbol if sign == 1 else algebra.negative(symbol))
        return symbol

    def total(self, atom: Atom, leg_type: str, hint: str) -> Atom:
        """Sum of a value over the legs of a type."""
        if atom == 0:
            return _ZERO
        if atom.could_extract_minus_sign():
            return -self.total(-atom, leg_type, hint)
        if not self.stage_of(atom).per_leg:
            return self.let(self.leg_counts[leg_type] * atom, hint)
        value = self._value_of(("total", leg_type, atom))
        if value.atom is not None:
            return value.atom
        return self._remember(value, self._record(atom, hint, named=True, total_of=leg_type))

    # ---- arithmetic on atoms -----------------------------------------------------------

    def add(self, terms: Iterable[Atom], hint: str = "", *, named: bool = False) -> Atom:
        """Sum of atoms."""
        present = [t for t in terms if t is not _ZERO]
        if len(present) < 2:
            return present[0] if present else _ZERO
        value = self._value_of(("sum", *present))
        if value.atom is not None:
            return value.atom
        if value.total is None:
            value.total = algebra.total(*present)
        return self._remember(value, self.let(self._opened(value.total), hint, named=named))

    def dot(
        self, u: Iterable[Atom], v: Iterable[Atom], hint: str = "", *, named: bool = False
    ) -> Atom:
        """Sum of the products of atoms."""
        return self.add([self.mul(x, y) for x, y in zip(u, v, strict=True)], hint, named=named)

    def _opened(self, total: Any) -> Any:
        """The sum with named sums in it opened, where terms then cancel."""
        if not total.is_Add or len(total.args) > 6:
            return total
        inner = []
        for term in total.args:
            sign, symbol = algebra.signed(term)
            made = self.maker(symbol)
            is_sum = made is not None and made.expr.is_Add and not made.total_of
            expr = made.expr if made is not None and is_sum else None
            inner.append(algebra.negative(expr) if expr is not None and sign == -1 else expr)
        if all(expr is None for expr in inner):
            return total
        return algebra.opened(total, tuple(inner))

    def difference(self, a: Atom, b: Atom) -> Atom:
        """a - b; of two named sums only what does not cancel."""
        terms = [t for atom, sign in ((a, 1), (b, -1)) for t in self._terms(atom, sign)]
        total = algebra.total(*terms)
        return self.let(total if terms_of(total) <= 2 else a - b)

    def mul(self, a: Atom, b: Atom, hint: str = "", *, named: bool = False) -> Atom:
        """Product of atoms; x/b times b is x."""
        if a is _ZERO or b is _ZERO:
            return _ZERO
        if a is _ONE or b is _ONE:
            return b if a is _ONE else a
        value = self._value_of(("product", a, b))
        if value.atom is not None:
            return value.atom
        return self._remember(value, self._product(a, b, hint, named=named))

    def _product(self, a: Atom, b: Atom, hint: str, *, named: bool) -> Atom:
        if a.is_Number or b.is_Number:
            return self.let(algebra.product(a, b), hint, named=named)
        sign = 1
        if a.is_Mul:
            a, sign = algebra.negative(a), -sign
        if b.is_Mul:
            b, sign = algebra.negative(b), -sign
        of_a, of_b = self._written(a), self._written(b)
        cancelled = self._square_of_root(a) if a is b or (hash(a) == hash(b) and a == b) else None
        if cancelled is None:
            cancelled = self._cancel(of_a, b, of_b)
        if cancelled is None:
            cancelled = self._cancel(of_b, a, of_a)
        if cancelled is None:
            cancelled = self.let(algebra.product(a, b), hint, named=named)
        return cancelled if sign == 1 else algebra.negative(cancelled)

    def _square_of_root(self, a: Atom) -> Atom | None:
        """x for a = sign sqrt(x)."""
        made = self.maker(a)
        if made is None or made.total_of:
            return None
        factors = made.expr.args if made.expr.is_Mul else (made.expr,)
        radicands = []
        for factor in factors:
            if factor in self.signs:
                continue
            inner = self.maker(factor)
            source = factor if inner is None else inner.expr
            if not (source.is_Pow and source.exp == sp.Rational(1, 2)):
                return None
            radicands.append(source.base)
        return radicands[0] if len(radicands) == 1 else None

    def _written(self, symbol: sp.Symbol) -> Any:
        """The expression of a value; None of sums over legs and of what is given."""
        made = self.maker(symbol)
        return None if made is None or made.total_of else made.expr

    def _cancel(self, of_a: Any, b: sp.Symbol, of_b: Any) -> Atom | None:
        """a b where a is made of 1/b, or b is 1/x and a is made of x; None if neither."""
        if of_a is None or not (of_a.is_Mul or of_a.is_Pow):
            return None
        if of_a.is_Mul:
            base = of_b.base if of_b is not None and of_b.is_Pow and of_b.exp == -1 else None
            for wanted in (self._value_of(algebra.inverse(b)).atom, base):
                if wanted is not None and wanted in of_a.args:
                    return self.let(algebra.quotient(of_a, wanted))
            return None
        return _ONE if of_a == algebra.inverse(b) else None

    def inverse(self, a: Atom) -> Atom:
        """1 / atom."""
        if a.is_Number:
            return 1 / a
        if a.is_Mul:
            return -self.inverse(-a)
        made = self.maker(a)
        if made is not None and made.expr.is_Pow and made.expr.exp == -1:
            return made.expr.base
        return self.let(algebra.inverse(a), f"inv_{a.name}")

    def divide(self, a: Atom, b: Atom, hint: str = "", *, named: bool = False) -> Atom:
        """a / b; where terms of a hold the factor b it cancels term by term."""
        if a == 0 or b == 1:
            return a
        if b == -1:
            return -a
        if b.is_Mul:
            return -self.divide(a, -b, hint, named=named)
        inverse = self.inverse(b)
        terms = [inner for term in self._terms(a) for inner in self._terms(term)]
        quotients = [self._quotient(term, b) for term in terms]
        if len(terms) > 1 and any(q is not None for q in quotients):
            rest = self.add([t for t, q in zip(terms, quotients, strict=True) if q is None])
            cancelled = [q for q in quotients if q is not None]
            return self.add([self.mul(rest, inverse), *cancelled], hint, named=named)
        return self.mul(a, inverse, hint, named=named)

    def _terms(self, a: Atom, outer: int = 1) -> list[Atom]:
        """Terms of a named sum, with a sign; the atom itself where it is none."""
        if a.is_Number:
            return [outer * a]
        sign, symbol = algebra.signed(a)
        made = self.maker(symbol)
        if made is None or made.total_of or not made.expr.is_Add:
            return [outer * a]
        return [outer * sign * term for term in made.expr.args]

    def _quotient(self, term: Any, b: sp.Symbol) -> Atom | None:
        """term / b if the factor b is visible in the term."""
        sign = 1
        if term.could_extract_minus_sign():
            term, sign = -term, -1
        made = self.maker(term) if term.is_Symbol else None
        product = made.expr if made is not None and not made.total_of else term
        if product.is_Mul and b in product.args:
            return sign * self.let(algebra.quotient(product, b))
        return None
