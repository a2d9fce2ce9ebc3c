"""Scalar expressions as text: one printer for Python and C, powers as products."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import sympy as sp
from sympy.printing.precedence import PRECEDENCE, precedence
from sympy.printing.str import StrPrinter


@dataclass(frozen=True)
class Dialect:
    """How a language writes what is not + - * /.

    Attributes:
        functions: SymPy function name -> spelling.
        number: format of a floating-point literal, with {} for the digits.
    """

    functions: dict[str, str]
    number: str


PYTHON = Dialect(
    {"sqrt": "sqrt", "sin": "sin", "cos": "cos", "atan2": "atan2", "Abs": "abs", "Min": "least"},
    "{}",
)


class ScalarPrinter(StrPrinter):
    """Prints expressions of the closed set; anything else is an error."""

    def __init__(self, dialect: Dialect) -> None:
        super().__init__({"order": "none"})
        self.dialect = dialect
        self._text = lru_cache(1 << 16)(super().doprint)

    def doprint(self, expr: Any) -> str:
        """The text; functions share statements, so that it is kept."""
        return str(self._text(expr))

    def _print_Symbol(self, expr: Any) -> str:
        return str(expr.name)

    def _number(self, value: float) -> str:
        return self.dialect.number.format(repr(float(value)))

    def _print_Integer(self, expr: Any) -> str:
        return self._number(int(expr))

    def _print_Rational(self, expr: Any) -> str:
        return self._number(int(expr.p) / int(expr.q))

    def _print_Half(self, expr: Any) -> str:
        return self._number(0.5)

    def _print_One(self, expr: Any) -> str:
        return self._number(1)

    def _print_NegativeOne(self, expr: Any) -> str:
        return self._number(-1)

    def _print_Zero(self, expr: Any) -> str:
        return self._number(0)

    def _print_Float(self, expr: Any) -> str:
        return self._number(float(expr))

    def _print_Add(self, expr: Any, order: Any = None) -> str:
        terms = sorted(
            expr.args, key=lambda t: (t.could_extract_minus_sign(), sp.default_sort_key(t))
        )
        text = ""
        for term in terms:
            negative = term.could_extract_minus_sign()
            level = PRECEDENCE["Mul" if negative else "Add"]  # a sum behind a minus needs them
            body = self.parenthesize(-term if negative else term, level)
            text += (
                f" - {body}"
                if negative and text
                else f"-{body}"
                if negative
                else (f" + {body}" if text else body)
            )
        return text

    def _print_Mul(self, expr: Any) -> str:
        coefficient, rest = expr.as_coeff_Mul()
        if coefficient < 0:
            return f"-{self.parenthesize(-expr, PRECEDENCE['Mul'])}"
        factors = sorted(expr.args, key=sp.default_sort_key)
        top = [f for f in factors if not (f.is_Pow and f.exp.is_negative)]
        bottom = [sp.Pow(f.base, -f.exp) for f in factors if f.is_Pow and f.exp.is_negative]
        del rest
        text = "*".join(self.parenthesize(f, PRECEDENCE["Mul"]) for f in top) or self._number(1)
        for factor in bottom:
            text += f"/{self.parenthesize(factor, PRECEDENCE['Pow'])}"
        return text

    def _print_Pow(self, expr: Any, rational: bool = False) -> str:
        base, exponent = expr.args
        if exponent == sp.Rational(1, 2):
            return f"{self.dialect.functions['sqrt']}({self._print(base)})"
        if exponent.is_negative:
            inner = self.parenthesize(sp.Pow(base, -exponent), PRECEDENCE["Pow"])
            return f"{self._number(1)}/{inner}"
        if not exponent.is_Integer:
            raise TypeError(f"no power {exponent} in generated code")
        factor = self.parenthesize(base, PRECEDENCE["Mul"])
        return "*".join([factor] * int(exponent))

    def parenthesize(self, item: Any, level: int, strict: bool = False) -> str:
        """Parentheses where the precedence needs them; for powers, which are products, behind /."""
        own, text = precedence(item), self._print(item)
        return (
            f"({text})"
            if own < level
            or (own == level and not strict and level == PRECEDENCE["Pow"] and not item.is_Symbol)
            else str(text)
        )

    def _print_Function(self, expr: Any) -> str:
        name = self.dialect.functions.get(type(expr).__name__)
        if name is None:
            raise TypeError(f"no function {type(expr).__name__} in generated code")
        return f"{name}({', '.join(self._print(arg) for arg in expr.args)})"

    _print_sin = _print_cos = _print_atan2 = _print_acos = _print_Function

    def _print_Abs(self, expr: Any) -> str:
        return self._print_Function(expr)

    def _print_Min(self, expr: Any) -> str:
        """The least of several, two at a time."""
        name = self.dialect.functions["Min"]
        first, *others = sorted(expr.args, key=sp.default_sort_key)
        text = str(self._print(first))
        for other in others:
            text = f"{name}({text}, {self._print(other)})"
        return text

    def emptyPrinter(self, expr: Any) -> str:
        """Refuse what is not in the closed set."""
        raise TypeError(f"no {type(expr).__name__} in generated code")


def wrap(text: str, width: int, indent: str) -> list[str]:
    """Break a long line at its outermost sums, else at spaces; the parts are indented."""
    lines, line = [], ""
    for word in text.split(" "):
        if line and len(line) + 1 + len(word) > width:
            lines.append(line)
            line = indent + word
        else:
            line = f"{line} {word}" if line else word
    lines.append(line)
    return lines
