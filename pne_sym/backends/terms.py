"""Terms of printed sums, brackets, and how tightly a printed text binds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

SUM, CROSS, PRODUCT, ATOM = range(4)


class Term(NamedTuple):
    """A term of a sum.

    Attributes:
        text: LaTeX without the sign.
        negative: whether it is subtracted.
        level: how tightly the text binds.
    """

    text: str
    negative: bool = False
    level: int = ATOM

    def signed(self, *, first: bool) -> str:
        """The term with the sign that it needs at its place."""
        if first:
            return f"-{self.text}" if self.negative else self.text
        return f"{'-' if self.negative else '+'} {self.text}"


def join_terms(terms: Sequence[Term]) -> str:
    """Terms on one line."""
    return " ".join(term.signed(first=k == 0) for k, term in enumerate(terms))


def brackets(text: str) -> str:
    """In round brackets, as high as what they hold."""
    return rf"\left({text}\right)" if r"\frac" in text or r"\sum" in text else f"({text})"


def norm_bars(text: str) -> str:
    r"""Length of a vector; \lVert is safe in tables, where "|" is not."""
    return rf"\lVert {text}\rVert"


def unbracketed(text: str) -> str:
    """Without round brackets around the whole."""
    if text.startswith("(") and text.endswith(")"):
        depth = 0
        for k, mark in enumerate(text):
            depth += (mark == "(") - (mark == ")")
            if depth == 0 and k < len(text) - 1:
                return text
        return text[1:-1]
    return text
