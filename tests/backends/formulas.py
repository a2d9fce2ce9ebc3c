"""Reads printed formulas back: LaTeX to numbers, by the rules that a reader follows.

Shares nothing with the printer but the notation of symbols.  Vectors are columns,
their transposes rows, so that a product written side by side is a matrix product.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from pne_sym.backends.glyphs import Glyph

_TOKENS = re.compile(
    r"(?P<space>\s+|\\,)|(?P<open>\\left\(|\()|(?P<close>\\right\)|\))|(?P<number>\d+(\.\d+)?)"
    r"|(?P<mark>\\times|\\cdot(?![a-z])|\\lVert|\\rVert|\\frac|\\sqrt|\\widetilde|\\mathrm\{ax\}"
    r"|\\mathrm\{atan2\}|\\sin|\\cos|\\mathbf E(?![a-z])|[-+{}^,])"
)
_TRANSPOSED = r"{\mathsf T}"
_FUNCTIONS = {r"\sin": np.sin, r"\cos": np.cos, r"\mathrm{atan2}": np.arctan2}


def tilde(a: Any) -> Any:
    """Tensor of the cross product of a column."""
    x, y, z = a.ravel()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def ax(t: Any) -> Any:
    """Axial vector of a tensor."""
    return np.array([[t[2, 1] - t[1, 2]], [t[0, 2] - t[2, 0]], [t[1, 0] - t[0, 1]]])


class Reader:
    """Values of formulas written with known symbols.

    Args:
        symbols: LaTeX by name.
        values: by name; (3,) vectors, (3, 3) tensors, floats.
    """

    def __init__(self, symbols: Mapping[str, str], values: Mapping[str, Any]) -> None:
        self.known: dict[str, Any] = {}
        for name, latex in symbols.items():
            value = np.asarray(values[name], dtype=float)
            value = value.reshape(3, 1) if value.shape == (3,) else value
            self.known[str(Glyph.of(latex))] = value
            if value.shape == (3, 1):
                self.known[str(Glyph.of(latex).tilde())] = tilde(value)
        self.longest = sorted(self.known, key=len, reverse=True)

    def read(self, latex: str) -> Any:
        """Value of a formula: float, (3,) or (3, 3)."""
        self.text, self.at = latex, 0
        value = self._sum()
        assert self.at == len(self.text), f"not understood from {self.text[self.at :]!r}"
        return float(value) if np.ndim(value) == 0 or value.shape == (1, 1) else np.squeeze(value)

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

    def _sum(self) -> Any:
        negative = self._peek() == "-" and bool(self._take())
        value = self._cross()
        value = -value if negative else value
        while self._peek() in ("+", "-"):
            sign = -1.0 if self._take() == "-" else 1.0
            value = value + sign * self._cross()
        return value

    def _cross(self) -> Any:
        left = self._product()
        if self._peek() == r"\times":
            self._take()
            return tilde(left) @ self._product()
        if self._peek() == r"\cdot":
            self._take()
            return np.squeeze(left.T @ self._product())
        return left

    def _product(self) -> Any:
        value = self._power()
        while self._peek() not in (
            "",
            "+",
            "-",
            ")",
            r"\right)",
            r"\times",
            r"\cdot",
            "}",
            ",",
            r"\rVert",
        ):
            factor = self._power()
            scalar = np.ndim(value) == 0 or np.ndim(factor) == 0
            value = value * factor if scalar else value @ factor
            value = np.squeeze(value) if np.shape(value) == (1, 1) else value
        return value

    def _power(self) -> Any:
        base = self._atom()
        if self._peek() != "^":
            return base
        self._take("^")
        if self.text.startswith(_TRANSPOSED, self.at):
            self.at += len(_TRANSPOSED)
            return base.T
        exponent = self._atom()
        return base ** float(exponent)

    def _atom(self) -> Any:
        token = self._take()
        if token in self.known:
            return self.known[token]
        if token[:1].isdigit():
            return float(token)
        if token in ("(", r"\left("):
            value = self._sum()
            self._take(r") \right)")
            return value
        if token == "{":
            value = self._sum()
            self._take("}")
            return value
        return self._command(token)

    def _command(self, token: str) -> Any:
        if token == r"\mathbf E":
            return np.eye(3)
        if token == r"\lVert":
            length = np.linalg.norm(self._sum())
            self._take(r"\rVert")
            return length
        if token == r"\frac":
            above, below = self._atom(), self._atom()
            return above / below
        if token == r"\sqrt":
            return np.sqrt(self._atom())
        if token == r"\widetilde":
            return tilde(self._atom())
        if token == r"\mathrm{ax}":
            return ax(self._atom())
        self._take(r"( \left(")
        arguments = [self._sum()]
        while self._peek() == ",":
            self._take()
            arguments.append(self._sum())
        self._take(r") \right)")
        return _FUNCTIONS[token](*arguments)
