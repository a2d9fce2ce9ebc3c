"""The LaTeX printer of vector, tensor and scalar expressions.

Vectors and tensors are bold (their LaTeX says so), a tilde makes the tensor of
a cross product, divisions are fractions, roots of a . a are norms, and signs
stand between the terms of a sum.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import sympy as sp

from pne_sym.backends.glyphs import Glyph, braced
from pne_sym.backends.terms import (
    ATOM,
    CROSS,
    PRODUCT,
    SUM,
    Term,
    brackets,
    join_terms,
    norm_bars,
    unbracketed,
)
from pne_sym.vector import nodes as n


class LatexPrinter:
    """Prints expressions with the notation of a derivation.

    Args:
        symbols: LaTeX by name.
        per_leg: names that stand for one value per leg -> leg type; inside a sum
            over legs they carry the leg's index.
        legs: leg type -> index of its legs.
        indexed: names per leg carry the index everywhere.
    """

    def __init__(
        self,
        symbols: Mapping[str, str],
        per_leg: Mapping[str, str] | None = None,
        legs: Mapping[str, str] | None = None,
        *,
        indexed: bool = False,
    ) -> None:
        self.symbols = symbols
        self.per_leg = dict(per_leg or {})
        self.legs = dict(legs or {})
        self.indexed = indexed

    def with_index(self) -> LatexPrinter:
        """The same printer with the leg's index on names per leg."""
        return LatexPrinter(self.symbols, self.per_leg, self.legs, indexed=True)

    def doprint(self, expr: Any) -> str:
        """An expression on one line."""
        return join_terms(self.terms(expr))

    def terms(self, expr: Any) -> tuple[Term, ...]:
        """The terms of a sum, or the expression as the only one."""
        if isinstance(expr, n.VectorAdd | n.TensorAdd):
            return tuple(self._term(arg) for arg in expr.args)
        expr = expr if isinstance(expr, n.Vector | n.Tensor) else sp.sympify(expr)
        if isinstance(expr, sp.Add):
            content, primitive = expr.primitive()
            if content != 1:
                return (self._scaled(content, primitive),)
            found = [self._term(arg) for arg in sorted(sp.ordered(expr.args), key=self._place)]
            return tuple(sorted(found, key=lambda term: term.negative))
        return (self._term(expr),)

    def _place(self, expr: Any) -> int:
        """Sums over legs stand last, in the order of the leg types."""
        sums = list(sp.sympify(expr).atoms(n.LegSum))
        return list(self.legs).index(str(sums[0].args[1])) if sums and self.legs else -1

    def glyph(self, expr: Any) -> Glyph:
        """A symbol's LaTeX, taken apart.

        Raises:
            KeyError: the notation does not know the name.
        """
        return self.glyph_of(expr.name)

    def glyph_of(self, name: str) -> Glyph:
        """The LaTeX of a name, taken apart."""
        glyph = Glyph.of(self.symbols[name])
        if self.indexed and name in self.per_leg:
            return glyph.indexed(self._index(self.per_leg[name]))
        return glyph

    def _index(self, leg_type: str) -> str:
        return self.legs.get(leg_type, "i")

    # ---- terms and factors -------------------------------------------------------------

    def _term(self, expr: Any) -> Term:
        if isinstance(expr, n.VectorScale | n.TensorScale):
            return self._scaled(*expr.args)
        if isinstance(expr, n.VectorLegSum | n.TensorLegSum | n.LegSum):
            return self._leg_sum(*expr.args)
        if isinstance(expr, n.Vector | n.Tensor | n.Dot | n.Trace | n.DualScalar):
            return self._node(expr)
        if isinstance(expr, sp.Symbol):
            return self._symbol(expr)
        return self._scaled(expr, None)

    def _node(self, expr: Any) -> Term:
        if isinstance(expr, n.VectorSymbol | n.TensorSymbol):
            return self._symbol(expr)
        if isinstance(expr, n.VectorAdd | n.TensorAdd):
            return Term(self.doprint(expr), level=SUM)
        printer = self._printers().get(type(expr))
        if printer is None:
            raise TypeError(f"no LaTeX for {type(expr).__name__}")
        return printer(*expr.args)

    def _printers(self) -> dict[type, Callable[..., Term]]:
        return {
            type(n.ZeroVector): lambda: Term(r"\mathbf 0"),
            type(n.ZeroTensor): lambda: Term(r"\mathbf 0"),
            type(n.Identity): lambda: Term(r"\mathbf E"),
            n.Cross: lambda a, b: self._between(a, r"\times", b),
            n.Dot: self._dot,
            n.Skew: self._skew,
            n.Apply: self._juxtaposed,
            n.Compose: self._juxtaposed,
            n.Outer: lambda a, b: Term(rf"{self.factor(a)}\,{self.transposed(b)}", level=PRODUCT),
            n.Transpose: lambda a: Term(self.transposed(a)),
            n.DualVector: lambda k, *_: self._reciprocal(k, r"\mathrm F"),
            n.DualScalar: lambda k, i, *_: self._reciprocal(k, rf"\mathrm M_{int(i) + 1}"),
            n.Axial: lambda a: Term(rf"\mathrm{{ax}}{brackets(self.doprint(a))}"),
            n.Trace: lambda a: Term(rf"\mathrm{{tr}}{brackets(self.doprint(a))}"),
        }

    def _reciprocal(self, k: Any, part: str) -> Term:
        """Row k of the inverse of the matrix of the joints' velocities."""
        return Term(rf"\left[\mathcal V^{{-1}}\right]_{{{int(k) + 1},\,{part}}}")

    def _symbol(self, expr: Any) -> Term:
        return Term(str(self.glyph(expr)))

    def factor(self, expr: Any, least: int = PRODUCT) -> str:
        """A factor of a product, in brackets unless it binds so tightly at least."""
        terms = self.terms(expr)
        if len(terms) == 1 and not terms[0].negative and terms[0].level >= least:
            return terms[0].text
        return brackets(join_terms(terms))

    def _between(self, a: Any, sign: str, b: Any) -> Term:
        left, right = self.factor(a, ATOM), self.factor(b)
        return Term(
            f"{left}{sign} {right}" if right[0].isalpha() else f"{left}{sign}{right}", level=CROSS
        )

    def _juxtaposed(self, a: Any, b: Any) -> Term:
        terms = self.terms(a)
        negative = len(terms) > 1 and all(term.negative for term in terms)
        left = self.factor(-a if negative else a)
        return Term(rf"{left}\,{self.factor(b)}", negative, PRODUCT)

    def _dot(self, a: Any, b: Any) -> Term:
        if a == b:
            return Term(rf"{norm_bars(self.doprint(a))}^2")
        return self._between(a, r"\cdot", b)

    def _skew(self, a: Any) -> Term:
        if isinstance(a, n.VectorSymbol):
            return Term(str(self.glyph(a).tilde()))
        return Term(rf"\widetilde{{{brackets(self.doprint(a))}}}")

    def transposed(self, a: Any) -> str:
        """The transpose of a vector or tensor."""
        if isinstance(a, n.VectorSymbol | n.TensorSymbol):
            return self.glyph(a).raised(r"\mathsf T")
        return rf"{brackets(self.doprint(a))}^{{\mathsf T}}"

    def _leg_sum(self, value: Any, leg_type: Any) -> Term:
        terms = self.with_index().terms(value)
        negative = all(term.negative for term in terms)
        if negative:
            terms = tuple(Term(term.text, level=term.level) for term in terms)
        body = join_terms(terms)
        if len(terms) > 1:
            body = brackets(body)
        return Term(rf"\sum_{braced(self._index(str(leg_type)))} {body}", negative, CROSS)

    # ---- products with scalar factors -----------------------------------------------------

    def _scaled(self, factor: Any, of: Any) -> Term:
        """A scalar product, or a scalar times a vector or tensor (`of`)."""
        factor = sp.sympify(factor)
        if isinstance(of, n.VectorAdd | n.TensorAdd) and all(t.negative for t in self.terms(of)):
            factor, of = -factor, -of
        number, numerator, denominator = _split(factor)
        negative = bool(number < 0)
        number = abs(number)
        over = [self._scalar_factor(*item) for item in numerator]
        under = [self._scalar_factor(*item) for item in denominator]
        if isinstance(number, sp.Float):
            over.insert(0, f"{float(number):g}")
        else:
            under[:0] = [str(number.q)] if number.q != 1 else []
            over[:0] = [str(number.p)] if number.p != 1 else []
        if under:
            return self._fraction(over, under, of, negative)
        if of is None:
            return self._product(over, numerator, negative)
        sole = self._term(of)
        text = (
            sole.text if sole.level >= CROSS and not sole.negative else brackets(self.doprint(of))
        )
        level = sole.level if sole.level < PRODUCT and text == sole.text else PRODUCT
        return Term(r"\,".join([*over, text]), negative, level if over else sole.level)

    def _product(self, over: Sequence[str], items: Sequence[Any], negative: bool) -> Term:
        if not over:
            return Term("1", negative)
        if len(over) == 1 and len(items) == 1:
            base, exponent = items[0]
            if exponent == 1 and isinstance(base, n.Dot | sp.Add):
                sole = (
                    self._node(base)
                    if not isinstance(base, sp.Add)
                    else Term(self.doprint(base), level=SUM)
                )
                return Term(sole.text, negative, sole.level)
        return Term(r"\,".join(over), negative, ATOM if len(over) == 1 else PRODUCT)

    def _fraction(self, over: list[str], under: list[str], of: Any, negative: bool) -> Term:
        below = r"\,".join(under)
        if len(under) == 1:
            below = unbracketed(below)
        if of is not None and not over:
            return Term(rf"\frac{{{self.doprint(of)}}}{{{below}}}", negative)
        above = r"\,".join(over) if over else "1"
        if len(over) == 1:
            above = unbracketed(above)
        text = rf"\frac{{{above}}}{{{below}}}"
        if of is None:
            return Term(text, negative)
        return Term(rf"{text}\,{self.factor(of)}", negative, PRODUCT)

    def _scalar_factor(self, base: Any, exponent: Any) -> str:
        """base^exponent, exponent positive."""
        if exponent == sp.Rational(1, 2):
            if isinstance(base, n.Dot) and base.args[0] == base.args[1]:
                return norm_bars(self.doprint(base.args[0]))
            return rf"\sqrt{{{self.doprint(base)}}}"
        if isinstance(base, sp.Symbol):
            glyph = self.glyph(base)
            return str(glyph) if exponent == 1 else glyph.raised(str(exponent))
        if base.func in _FUNCTIONS:
            arguments = r",\,".join(self.doprint(arg) for arg in base.args)
            text = f"{_FUNCTIONS[base.func]}{brackets(arguments)}"
        else:
            text = self.factor(base)
        if exponent == 1:
            return text
        return f"{brackets(unbracketed(text))}^{braced(str(exponent))}"


_FUNCTIONS: dict[Any, str] = {
    sp.sin: r"\sin",
    sp.cos: r"\cos",
    sp.atan2: r"\mathrm{atan2}",
    sp.acos: r"\arccos",
}


def _split(factor: Any) -> tuple[Any, list[tuple[Any, Any]], list[tuple[Any, Any]]]:
    """Number, factors above and factors below the line, each as (base, exponent)."""
    number = sp.S.One
    above: list[tuple[Any, Any]] = []
    below: list[tuple[Any, Any]] = []
    for arg in sp.Mul.make_args(factor):
        if arg.is_Number:
            number *= arg
            continue
        base, exponent = arg.as_base_exp() if arg.is_Pow else (arg, sp.S.One)
        (below if exponent < 0 else above).append((base, abs(exponent)))
    above.sort(key=lambda item: isinstance(item[0], n.Dot | sp.Add))
    return number, above, below
