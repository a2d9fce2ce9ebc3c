"""Straight-line Python: statements, tuples that are unpacked and returned, guards."""

from __future__ import annotations

from typing import Any

import sympy as sp

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import equation_titles
from pne_sym.backends.scalar import PYTHON, ScalarPrinter, wrap
from pne_sym.program.ir import Assignment

WIDTH = 98
_PRINTER = ScalarPrinter(PYTHON)


class PythonText:
    """Writes the lines of function bodies, for places that are indented so far."""

    def __init__(self, bundle: Bundle, indent: int = 4) -> None:
        self.width = WIDTH - indent
        self.printer = _PRINTER
        self.titles = equation_titles(bundle.derivation)

    def of(self, expr: Any) -> str:
        """A scalar expression."""
        return str(self.printer.doprint(sp.sympify(expr)))

    def statements(self, assignments: tuple[Assignment, ...]) -> list[str]:
        """Assignments, headed by the equations they belong to."""
        lines: list[str] = []
        equation = ""
        for assignment in assignments:
            if assignment.equation != equation:
                equation = assignment.equation
                title = self.titles.get(equation, "")
                lines.append(f"# ({equation}) {title}" if title else f"# {equation}: named entries")
            lines += self.assign(str(assignment.target), self.of(assignment.expr))
        return lines

    def assign(self, target: str, value: str) -> list[str]:
        """An assignment, on several lines if it is long."""
        line = f"{target} = {value}"
        if len(line) <= self.width:
            return [line]
        return [f"{target} = (", *wrap(f"    {value}", self.width, "    "), ")"]

    def names(self, names: list[str], source: str) -> list[str]:
        """Unpack a tuple; nothing for an empty one."""
        return unpacked(names, source, self.width)


def unpacked(names: list[str], source: str, width: int) -> list[str]:
    """A tuple unpacked; nothing for an empty one."""
    if not names:
        return []
    line = f"{', '.join(names)}{',' if len(names) == 1 else ''} = {source}"
    if len(line) <= width:
        return [line]
    lines = ["(", *wrap("    " + ", ".join(names) + ",", width, "    ")]
    return [*lines, *wrap(f") = {source}", width, "    ")]
