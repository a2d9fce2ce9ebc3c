"""Markdown with formulas as GitHub shows them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from pne_sym.backends.glyphs import visible_width
from pne_sym.backends.report.view import Lines
from pne_sym.backends.terms import Term

LINE = 66.0
SOURCE = 92
_SPECIAL = re.compile(r"([\\`*_{}\[\]#|~$&]|:(?=\w))")


def escape(text: str) -> str:
    """A user's text, printed as it is: no markup, no tag, no formula, one line."""
    flat = " ".join("".join(ch if ch.isprintable() else " " for ch in text).split())
    return _SPECIAL.sub(r"\\\1", flat).replace("<", "&lt;").replace(">", "&gt;")


def inline(latex: str) -> str:
    """A formula within a line."""
    return f"$`{latex}`$"


def table(head: Sequence[str], rows: Iterable[Sequence[str]], numbers: int = 0) -> Lines:
    """A table; the last `numbers` columns are aligned to the right."""
    marks = ["---"] * (len(head) - numbers) + ["---:"] * numbers
    return tuple(map(_row, (head, marks, *rows)))


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def unit(text: str) -> str:
    """A unit as people write it.

    >>> unit("kg m^2")
    'kg·m²'
    """
    text = text.replace(" ", "·")
    return (
        text.replace("^2", "²").replace("^3", "³").replace("^4", "⁴")
        if text not in ("", "-")
        else "1"
    )


def matrix(left: str, rows: Sequence[Sequence[str]]) -> Lines:
    """Lines of a matrix behind what it is: a cell per line."""
    lines = [left, r"\begin{bmatrix}"]
    for k, (first, *others) in enumerate(rows, 1):
        lines += [first, *(f"& {cell}" for cell in others)]
        lines[-1] += r" \\" * (k < len(rows))
    return (*lines, r"\end{bmatrix}")


def display(left: str, rows: Sequence[Sequence[Term]]) -> tuple[str, ...]:
    """Lines of a displayed equation: left = row = row ...; long rows one term per line.

    Args:
        left: the left-hand side.
        rows: terms of each right-hand side.
    """
    width = visible_width(left) + sum(visible_width(t.text) + 3 for row in rows for t in row)
    if len(rows) == 1 and width <= LINE:
        lines = _terms(rows[0], "= ")
        one = f"{left} {' '.join(lines)}"
        return (one,) if len(one) <= SOURCE else (left, *lines)
    lines = [r"\begin{aligned}", left]
    for k, row in enumerate(rows):
        if k:
            lines[-1] += r" \\"
        lines += _wrapped(row)
    return (*lines, r"\end{aligned}")


def _terms(terms: Sequence[Term], sign: str) -> list[str]:
    return [sign + terms[0].signed(first=True), *(t.signed(first=False) for t in terms[1:])]


def _wrapped(terms: Sequence[Term]) -> list[str]:
    """Terms of a row of an aligned formula, broken where the line is full."""
    lines, width = [], 0.0
    for k, term in enumerate(terms):
        size = visible_width(term.text) + 3
        if k == 0:
            lines.append(f"&= {term.signed(first=True)}")
        elif width + size > LINE:
            lines[-1] += r" \\"
            lines.append(rf"&\quad {{}}{term.signed(first=False)}")
            width = 0.0
        else:
            lines.append(term.signed(first=False))
        width += size
    return lines
