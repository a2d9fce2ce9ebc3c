"""Straight-line Python: statements, tuples that are unpacked and returned, guards."""

from __future__ import annotations

from typing import Any

import sympy as sp

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import equation_titles
from pne_sym.backends.scalar import PYTHON, ScalarPrinter, wrap
from pne_sym.program.ir import Assignment

WIDTH = 98


class PythonText:
    """Writes the lines of function bodies."""

    def __init__(self, bundle: Bundle) -> None:
        self.printer = ScalarPrinter(PYTHON)
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
        if len(line) <= WIDTH - 4:
            return [line]
        return [f"{target} = (", *wrap(f"    {value}", WIDTH - 4, "    "), ")"]

    def names(self, names: list[str], source: str) -> list[str]:
        """Unpack a tuple; nothing for an empty one."""
        if not names:
            return []
        line = (
            f"{', '.join(names)}, = {source}"
            if len(names) == 1
            else f"{', '.join(names)} = {source}"
        )
        if len(line) <= WIDTH - 4:
            return [line]
        return ["(", *wrap("    " + ", ".join(names) + ",", WIDTH - 4, "    "), f") = {source}"]

    def returns(self, values: list[str]) -> list[str]:
        """Return a tuple."""
        if not values:
            return ["return ()"]
        line = f"return ({', '.join(values)},)"
        if len(line) <= WIDTH - 4:
            return [line]
        return ["return (", *wrap("    " + ", ".join(values) + ",", WIDTH - 4, "    "), ")"]

    def checks(self, block_checks: Any) -> str:
        """One truth value of all guards of a block."""
        parts = []
        for check in block_checks:
            value = self.of(check.value)
            if check.trouble == "unreachable":
                parts.append(f"({value} >= 0.0)")
                continue
            tolerance = "_TOLERANCE * _TOLERANCE" if check.power == 2 else "_TOLERANCE"
            parts.append(f"(abs({value}) > {tolerance} * {self.of(check.scale)})")
        return " & ".join(dict.fromkeys(parts)) or "True"
