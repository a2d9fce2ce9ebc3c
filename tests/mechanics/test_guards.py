"""Where a value is divided by something that the state decides, the code looks at it first."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
import sympy as sp

from pne_sym.program.ir import Function, Program
from tests.mechanics.structures import drawn
from tests.models import bundle, catalogue
from tests.sampling import entries, sampled

COMPLETED = (
    "two revolutes, universal at the platform",
    "two joints, revolute at the platform",
    "one helix, revolute at the platform",
)
"""Legs whose degrees of freedom are completed to a basis, as the Tricept's central one: the sizes
of wrenches are divided by."""


def _divisors(function: Function) -> Iterator[tuple[str, Any]]:
    """Equation and divisor of every division."""
    for block in function.blocks:
        for assignment in block.assignments:
            for power in assignment.expr.atoms(sp.Pow):
                if power.exp.is_negative and not power.base.is_Number:
                    yield assignment.equation, power.base


def unguarded(program: Program) -> set[tuple[str, str]]:
    """Equations and divisors that no check looks at: as they are, or as what they are roots of."""
    found = set()
    for function in program.functions.values():
        made = {a.target: a.expr for block in function.blocks for a in block.assignments}
        looked_at = {check.value for block in function.blocks for check in block.checks}
        for equation, divisor in _divisors(function):
            value = made.get(divisor, divisor)
            roots = {power.base for power in value.atoms(sp.Pow) if power.exp == sp.Rational(1, 2)}
            if not looked_at & {divisor, -divisor, *roots}:
                found.add((equation, str(divisor)))
    return found


@pytest.mark.parametrize("name", entries())
def test_catalogue(name: str) -> None:
    assert not unguarded(bundle(catalogue(name)).program)


@pytest.mark.parametrize("name", sampled(["tricept", *COMPLETED], 0, keep=["tricept"]))
def test_completed_legs(name: str) -> None:
    compiled = bundle(catalogue(name) if name == "tricept" else drawn(name))
    sizes = [e for e in compiled.derivation.equations() if "-size_c" in e.id]
    assert sizes
    assert not unguarded(compiled.program)
