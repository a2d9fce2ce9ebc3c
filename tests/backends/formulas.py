"""Reads printed formulas: LaTeX to numbers, by the rules that a reader follows.

Shares nothing with the printer but the notation of symbols.  Vectors are columns,
their transposes rows, so that a product written side by side is a matrix product.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from pne_sym.backends.glyphs import Glyph

_TOKENS = re.compile(
    r"(?P<space>\s+|\\,)|(?P<open>\\left\(|\()|(?P<close>\\right\)|\))|(?P<number>\d+(\.\d+)?)"
    r"|(?P<sum>\\sum_(\{[^}]*\}|.))|(?P<dual>\\left\[\\mathcal V\^\{-1\}\\right\]_\{[^}]*\})"
    r"|(?P<mark>\\times|\\cdot(?![a-z])|\\lVert|\\rVert|\\frac|\\sqrt|\\widetilde|\\mathrm\{ax\}"
    r"|\\mathrm\{tr\}|\\mathrm\{atan2\}|\\sin|\\cos|\\mathbf E(?![a-z])|\\mathbf 0|[-+{}^,])"
)
_TRANSPOSED = r"{\mathsf T}"
_FUNCTIONS = {r"\sin": np.sin, r"\cos": np.cos, r"\mathrm{atan2}": np.arctan2}
_ENDS = ("", "+", "-", ")", r"\right)", r"\times", r"\cdot", "}", ",", r"\rVert")
Value = Callable[[Any], Any]
"""A formula: from what its symbols stand for to its value."""


def tilde(a: Any) -> Any:
    """Tensor of the cross product of a column."""
    x, y, z = a.ravel()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def ax(t: Any) -> Any:
    """Axial vector of a tensor."""
    return np.array([[t[2, 1] - t[1, 2]], [t[0, 2] - t[2, 0]], [t[1, 0] - t[0, 1]]])


def column(value: Any) -> Any:
    """Vectors as columns, all else as it is."""
    value = np.asarray(value, dtype=float)
    return value.reshape(3, 1) if value.shape == (3,) else value


def plain(value: Any) -> Any:
    """A float, (3,) or (3, 3)."""
    return float(np.squeeze(value)) if np.size(value) == 1 else np.squeeze(value)


def times(a: Any, b: Any) -> Any:
    """What stands side by side."""
    scalar = np.ndim(a) == 0 or np.ndim(b) == 0
    value = a * b if scalar else a @ b
    return np.squeeze(value) if np.shape(value) == (1, 1) else value


def _within(known: Any, used: set[str]) -> Any:
    """Lengths and scalar products do not depend on the axes: those of a body will do."""
    return known.within(used) if hasattr(known, "within") else known


def _dot(known: Any, a: Value, b: Value) -> Any:
    return np.squeeze(a(known).T @ b(known))


class Parser:
    """Formulas written with known symbols.

    Args:
        symbols: what they are written as; that under a tilde is known, too.
    """

    def __init__(self, symbols: Iterable[str]) -> None:
        self.known: dict[str, tuple[str, bool]] = {}
        for latex in symbols:
            glyph = Glyph.of(latex)
            self.known.setdefault(str(glyph), (str(glyph), False))
            self.known.setdefault(str(glyph.tilde()), (str(glyph), True))
        self.longest = sorted(self.known, key=len, reverse=True)

    def read(self, latex: str) -> tuple[Value, set[str]]:
        """The formula, and the symbols that it uses."""
        self.text, self.at, self.used = latex, 0, set[str]()
        value = self._sum()
        assert self.at == len(self.text), f"not understood from {self.text[self.at :]!r}"
        return value, self.used

    # ---- tokens ------------------------------------------------------------------------

    def _peek(self) -> str:
        """Token at the reading position; a symbol stands for itself."""
        while self.at < len(self.text):
            symbol = next((s for s in self.longest if self.text.startswith(s, self.at)), None)
            if symbol is not None:
                return symbol
            match = _TOKENS.match(self.text, self.at)
            assert match, f"not understood: {self.text[self.at :]!r}"
            if match.lastgroup != "space":
                return match.group()
            self.at = match.end()
        return ""

    def _take(self, expected: str = "") -> str:
        token = self._peek()
        assert not expected or token in expected.split(), f"{expected} expected, {token!r} found"
        self.at += len(token)
        return token

    # ---- grammar -----------------------------------------------------------------------

    def _sum(self) -> Value:
        terms = []
        sign = -1.0 if self._peek() == "-" and self._take() else 1.0
        terms.append((sign, self._cross()))
        while self._peek() in ("+", "-"):
            sign = -1.0 if self._take() == "-" else 1.0
            terms.append((sign, self._cross()))
        return lambda known: sum(s * term(known) for s, term in terms)

    def _cross(self) -> Value:
        outside, self.used = self.used, set()
        value = self._between()
        self.used = outside | self.used
        return value

    def _between(self) -> Value:
        left = self._product()
        if self._peek() == r"\times":
            self._take()
            right = self._product()
            return lambda known: tilde(left(known)) @ right(known)
        if self._peek() == r"\cdot":
            self._take()
            other, used = self._product(), self.used
            return lambda known: _dot(_within(known, used), left, other)
        return left

    def _product(self) -> Value:
        value = self._power()
        while self._peek() not in _ENDS:
            value = self._side_by_side(value, self._power())
        return value

    def _side_by_side(self, a: Value, b: Value) -> Value:
        return lambda known: times(a(known), b(known))

    def _power(self) -> Value:
        base = self._atom()
        if self._peek() != "^":
            return base
        self._take("^")
        if self.text.startswith(_TRANSPOSED, self.at):
            self.at += len(_TRANSPOSED)
            return lambda known: base(known).T
        exponent = self._atom()
        return lambda known: base(known) ** float(exponent(known))

    def _atom(self) -> Value:
        token = self._take()
        if token in self.known:
            name, crossed = self.known[token]
            self.used.add(name)
            return lambda known: tilde(known[name]) if crossed else known[name]
        if token[:1].isdigit():
            return lambda _: float(token)
        if token in ("(", r"\left("):
            value = self._sum()
            self._take(r") \right)")
            return value
        if token == "{":
            value = self._sum()
            self._take("}")
            return value
        return self._command(token)

    def _command(self, token: str) -> Value:
        if token == r"\mathbf E":
            return lambda _: np.eye(3)
        if token == r"\mathbf 0":
            return lambda _: 0.0
        if token.startswith(r"\sum_"):
            index, body = token[5:].strip("{}"), self._cross()
            return lambda known: known.over_legs(index, body)
        if token.startswith(r"\left["):
            place = re.findall(r"\d+|F", token.rpartition("_{")[2])
            return lambda known: known.reciprocal(place)
        if token == r"\lVert":
            outside, self.used = self.used, set()
            inner, used = self._sum(), self.used
            self.used = outside | used
            self._take(r"\rVert")
            return lambda known: np.linalg.norm(inner(_within(known, used)))
        if token == r"\frac":
            above, below = self._atom(), self._atom()
            return lambda known: above(known) / below(known)
        one = {
            r"\sqrt": np.sqrt, r"\widetilde": tilde, r"\mathrm{ax}": ax, r"\mathrm{tr}": np.trace
        }.get(token)  # fmt: skip
        if one is not None:
            argument = self._atom()
            return lambda known: one(argument(known))
        return self._function(_FUNCTIONS[token])

    def _function(self, function: Callable[..., Any]) -> Value:
        self._take(r"( \left(")
        arguments = [self._sum()]
        while self._peek() == ",":
            self._take()
            arguments.append(self._sum())
        self._take(r") \right)")
        return lambda known: function(*(argument(known) for argument in arguments))


class Reader:
    """Values of formulas written with known symbols.

    Args:
        symbols: LaTeX by name.
        values: by name; (3,) vectors, (3, 3) tensors, floats.
    """

    def __init__(self, symbols: Mapping[str, str], values: Mapping[str, Any]) -> None:
        self.values = {str(Glyph.of(s)): column(values[name]) for name, s in symbols.items()}
        self.parser = Parser(symbols.values())

    def read(self, latex: str) -> Any:
        """Value of a formula: float, (3,) or (3, 3)."""
        return plain(self.parser.read(latex)[0](self.values))
