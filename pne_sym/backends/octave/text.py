"""MATLAB as text, in the part of the language that Octave has too: expressions, functions, help."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import sympy as sp

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import equation_titles
from pne_sym.backends.scalar import Dialect, ScalarPrinter, wrap
from pne_sym.program.ir import Assignment

WIDTH = 94
NEXT = "\n    "


class MatlabText:
    """Writes expressions and statements; arrays over legs (L x 1 or L x n) and states (1 x n)."""

    def __init__(self, bundle: Bundle) -> None:
        self.bundle, self.internal = bundle, f"{bundle.name}.internal."
        names = {"Abs": "abs", "sin": "sin", "cos": "cos", "atan2": "atan2"}
        own = {"sqrt": "root", "acos": "arccos", "Min": "least"}
        names |= {function: self.internal + name for function, name in own.items()}
        self.printer = _Printer(Dialect(names, "{}"))
        self.titles = equation_titles(bundle.derivation)

    def of(self, expr: Any) -> str:
        """A scalar expression, entry by entry: * and / stand in it as products and quotients."""
        text = str(self.printer.doprint(sp.sympify(expr)))
        return text.replace("*", ".*").replace("/", "./")

    def statements(self, assignments: tuple[Assignment, ...]) -> list[str]:
        """Assignments, headed by the equations they belong to."""
        lines: list[str] = []
        equation = ""
        for assignment in assignments:
            if assignment.equation != equation:
                equation = assignment.equation
                title = self.titles.get(equation, "")
                lines.append(f"% ({equation}) {title}" if title else f"% {equation}: named entries")
            lines.append(f"{named(assignment.target)} = {self.of(assignment.expr)};")
        return lines


class _Printer(ScalarPrinter):
    def _print_Symbol(self, expr: Any) -> str:  # noqa: N802
        return named(expr)

    _print_acos = ScalarPrinter._print_Function


def named(symbol: object) -> str:
    """The name of a variable: none begins with an underscore."""
    name = str(symbol)
    return f"tmp{name}" if name.startswith("_") else name


def indices(numbers: Iterable[int]) -> str:
    """Places in an array, which count from 1."""
    return f"[{', '.join(str(n + 1) for n in numbers)}]"


def column(values: Iterable[float], end: str = ";") -> str:
    """Numbers in a column, or in a row; shortest digits that read back the same."""
    return f"[{f'{end} '.join(repr(float(v) + 0.0) for v in values)}]"


def by_columns(array: Any, *, legs: bool) -> str:
    """A constant array, column by column; with one row per leg, legs are the last dimension."""
    given = np.asarray(array, dtype=float)
    rows = list(given) if legs else [given]
    core = (given.shape[1:] or (1,)) if legs else (*given.shape, 1, 1)[: max(given.ndim, 2)]
    shape = ", ".join(map(str, (*core, *([len(rows)] * legs))))
    texts = [column(row.ravel(order="F"), ",")[1:-1] for row in rows]
    return f"reshape([{(', ...' + NEXT).join(texts)}], [{shape}])"


def define(head: str, summary: str, body: Iterable[str]) -> str:
    """A function; long lines are continued."""
    lines = [f"function {head}", f"%{summary}", *body]
    return "\n".join(
        (lines[0], *(line for text in lines[1:] for line in _continued(text)), "end\n")
    )


def _continued(text: str) -> list[str]:
    if len(text) <= WIDTH or text.startswith("%") or NEXT in text:
        return [text]
    *lines, last = wrap(text, WIDTH - 4, "    ")
    return [*(f"{line} ..." for line in lines), last]
