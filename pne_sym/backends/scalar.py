"""Scalar expressions as text: one printer for Python and C, powers as products."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import sympy as sp
from sympy.printing.precedence import PRECEDENCE, precedence
from sympy.printing.str import StrPrinter

Terms = tuple[tuple[bool, Any], ...]


class Dialect(NamedTuple):
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

    def _print_Rational(self, expr: Any) -> str:
        return self._number(int(expr.p) / int(expr.q))

    _print_Integer = _print_Half = _print_Rational
    _print_One = _print_NegativeOne = _print_Zero = _print_Rational

    def _print_Float(self, expr: Any) -> str:
        return self._number(float(expr))

    def _print(self, expr: Any, **settings: Any) -> str:
        """The text of what is found most often, without a search for its method."""
        if expr.is_Symbol:
            return self._print_Symbol(expr)
        if expr.is_Mul:
            return self._print_Mul(expr)
        return self._print_Add(expr) if expr.is_Add else str(super()._print(expr, **settings))

    def terms(self, expr: Any) -> Terms:
        """Terms of a sum in their order: whether each is negative, and what it is without sign."""
        return _terms(expr)

    def _print_Add(self, expr: Any, order: Any = None) -> str:
        text = ""
        for negative, term in self.terms(expr):
            level = PRECEDENCE["Mul" if negative else "Add"]  # a sum behind a minus needs them
            body = self.parenthesize(term, level)
            sign = "-" if negative else "+" if text else ""
            text += f" {sign} {body}" if text else f"{sign}{body}"
        return text

    def _print_Mul(self, expr: Any) -> str:
        if _is_negative(expr):
            return f"-{self.parenthesize(-expr, PRECEDENCE['Mul'])}"
        top, bottom = _factors(expr)
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
        if item.is_Symbol:
            return self._print_Symbol(item)
        own, text = _level(item), self._print(item)
        needed = own < level or (own == level and not strict and level == PRECEDENCE["Pow"])
        return f"({text})" if needed else text

    def _print_Function(self, expr: Any) -> str:
        name = self.dialect.functions.get(type(expr).__name__)
        if name is None:
            raise TypeError(f"no function {type(expr).__name__} in generated code")
        return f"{name}({', '.join(self._print(arg) for arg in expr.args)})"

    _print_sin = _print_cos = _print_atan2 = _print_acos = _print_Abs = _print_Function

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


@lru_cache(1 << 16)
def _terms(expr: Any) -> Terms:
    """Those of a sum: positive ones first."""
    told = ((_is_negative(term), term) for term in expr.args)
    ordered = sorted(told, key=lambda t: (t[0], sort_key(t[1])))
    return tuple((minus, -term if minus else term) for minus, term in ordered)


@lru_cache(1 << 16)
def _factors(expr: Any) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """Factors of a product as they are printed, and what it is divided by."""
    factors = sorted(expr.args, key=sort_key)
    under = [f for f in factors if f.is_Pow and f.exp.is_negative]
    bottom = tuple(sp.Pow(f.base, -f.exp) for f in under)
    return tuple(f for f in factors if f not in under), bottom


def _is_negative(term: Any) -> bool:
    """Whether a minus sign stands before it."""
    if term.is_Mul:
        return bool(term.args[0].is_Number and term.args[0].is_negative)
    return bool(not term.is_Symbol and term.could_extract_minus_sign())


def _level(expr: Any) -> int:
    """How tightly its text binds."""
    if expr.is_Mul:
        return int(PRECEDENCE["Add" if _is_negative(expr) else "Mul"])
    level: int = PRECEDENCE["Add"] if expr.is_Add else precedence(expr)
    return level


@lru_cache(1 << 16)
def sort_key(expr: Any) -> Any:
    """SymPy's `default_sort_key`, quicker for what programs are made of."""
    if expr.is_Symbol:
        return _SYMBOL, (1, (expr.name,)), _ONE, sp.S.One
    if expr.is_Pow and (expr.base.is_Symbol or expr.base.is_Add):
        return (*sort_key(expr.base)[:2], sp.default_sort_key(expr.exp), sp.S.One)
    if expr.is_Add and all(_is_multiple(term) for term in expr.args):
        keys = sorted(map(sort_key, expr.args))
        return sp.Add.class_key(), (len(keys), tuple(keys)), _ONE, sp.S.One
    if not expr.is_Mul:
        return sp.default_sort_key(expr)
    factor, rest = (expr.args[0], expr.args[1:]) if expr.args[0].is_Number else (1, expr.args)
    if len(rest) == 1:
        return (*sort_key(rest[0])[:3], factor)
    keys = sorted(map(sort_key, rest))
    return sp.Mul.class_key(), (len(keys), tuple(keys)), _ONE, sp.sympify(factor)


def _is_multiple(term: Any) -> bool:
    """Whether it is a symbol, or a number times one."""
    number, *others = term.args if term.is_Mul else (sp.S.One, term)
    return bool(number.is_Number and len(others) == 1 and others[0].is_Symbol)


_SYMBOL, _ONE = sp.Symbol.class_key(), sp.default_sort_key(sp.S.One)


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
