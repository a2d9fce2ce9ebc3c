"""Expressions and statements on arrays of any namespace: roots and divisors are guarded."""

from __future__ import annotations

from typing import Any

import sympy as sp

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.numpy_text import PythonText
from pne_sym.backends.scalar import Dialect, ScalarPrinter
from pne_sym.program.ir import Assignment, Check

_PLAIN = Dialect({"sqrt": "xp.sqrt", "sin": "xp.sin", "cos": "xp.cos", "atan2": "xp.atan2"}, "{}")
_GUARDED = Dialect(
    {
        "sqrt": "s.sqrt",
        "sin": "xp.sin",
        "cos": "xp.cos",
        "atan2": "s.atan2",
        "nonzero": "s.nonzero",
    },
    "{}",
)
_nonzero = sp.Function("nonzero", real=True)


class XpText(PythonText):
    """Writes lines of code on arrays.

    What depends on parameters alone is printed as it is; elsewhere roots and divisors go through
    the guards of the state, which keep values and derivatives finite where a state is impossible.
    """

    def __init__(self, bundle: Bundle) -> None:
        super().__init__(bundle)
        self.plain, self.guarded = ScalarPrinter(_PLAIN), ScalarPrinter(_GUARDED)
        self.printer = self.guarded

    def of(self, expr: Any) -> str:
        """A scalar expression."""
        expr = sp.sympify(expr)
        if self.printer is self.guarded:
            expr = expr.replace(
                lambda e: e.is_Pow and e.exp.is_negative,
                lambda e: _nonzero(e.base**-e.exp) ** -1,
            )
        return str(self.printer.doprint(expr))

    def lines(self, assignments: tuple[Assignment, ...], *, guarded: bool) -> list[str]:
        """Assignments."""
        self.printer = self.guarded if guarded else self.plain
        found = self.statements(assignments)
        self.printer = self.guarded
        return found

    def required(self, checks: tuple[Check, ...]) -> list[str]:
        """What a block's guards demand."""
        relation = {"unreachable": ">= 0.0", "invalid": "> 0.0"}
        found = []
        for check in checks:
            value = self.of(check.value)
            if check.trouble in relation:
                found.append(f"s.require({value} {relation[check.trouble]})")
                continue
            bound = " * ".join(["s.tolerance"] * check.power)
            found.append(f"s.require(abs({value}) > {bound} * ({self.of(check.scale)}))")
        return list(dict.fromkeys(found))
