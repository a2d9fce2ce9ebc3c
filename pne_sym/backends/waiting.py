"""How long a value has to be waited for, and sums printed so that the last to come is added last.

Sums are evaluated from left to right.  A term that comes late and stands early holds up all behind
it; one that stands at the end costs one addition.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import sympy as sp

from pne_sym.backends.c_text import CPrinter
from pne_sym.backends.scalar import Terms
from pne_sym.program.ir import Assignment

_STEP = 4  # cycles of an addition, a product, or both at once
_QUOTIENT, _ROOT, _OTHER = 16, 24, 60


def ready(expr: Any, known: Mapping[str, int]) -> int:
    """Cycles until an expression is known, that is the latest of these names and what follows.

    Args:
        expr: in the closed set.
        known: name -> cycles until it is known; 0 for those of inputs.
    """
    if expr.is_Symbol:
        return known.get(expr.name, 0)
    if expr.is_Add:
        return _summed(sorted(_wait(term, known) for term in expr.args))
    times = [ready(part, known) for part in expr.args if not part.is_Number]
    if expr.is_Mul:
        return max(times, default=0) + _STEP * (len(times) - 1)
    if expr.is_Pow:
        exponent = expr.exp
        root = _ROOT * (not exponent.is_Integer)
        return max(times, default=0) + root + (_QUOTIENT if exponent.is_negative else _STEP)
    return max(times, default=0) + _OTHER * bool(times)


def _wait(term: Any, known: Mapping[str, int]) -> int:
    """Cycles until a term can be added: a product is added as it is made."""
    fused = _STEP * (term.is_Mul and sum(not f.is_Number for f in term.args) > 1)
    return ready(term, known) - fused


def _summed(waits: list[int]) -> int:
    time = waits[0]
    for wait in waits[1:]:
        time = max(time, wait) + _STEP
    return time


def ready_after(assignments: Iterable[Assignment], known: dict[str, int]) -> dict[str, int]:
    """The same for all that assignments define, beside what is known."""
    found = dict(known)
    for a in assignments:
        found[a.target.name] = ready(a.expr, found)
    return found


class WaitingPrinter(CPrinter):
    """Prints the terms of sums in the order in which they come to be known.

    Args:
        known: name -> cycles until it is known.
    """

    def __init__(self, known: Mapping[str, int]) -> None:
        super().__init__()
        self.known = known

    def terms(self, expr: sp.Add) -> Terms:
        """A positive term first, where there is one."""
        found = sorted(super().terms(expr), key=lambda t: _wait(t[1], self.known))
        first = next((t for t in found if not t[0]), found[0])
        return (first, *(t for t in found if t is not first))
