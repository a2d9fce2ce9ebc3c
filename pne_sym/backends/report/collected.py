"""What Rules I and II made of each quantity: coefficient times acceleration plus remainder.

The derivation defines coefficients and remainders under names of their own; here
they are put together again, for the reader to see what belongs together.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import sympy as sp

from pne_sym.derivation import Derivation, Equation, Law, names_in
from pne_sym.vector import (
    Dot,
    LinearForm,
    Tensor,
    TensorSymbol,
    Vector,
    VectorSymbol,
    linear_form,
)
from pne_sym.vector.linear import NotLinearError


@dataclass
class Collected:
    """Linear forms by quantity, and what collected equations belong to.

    Attributes:
        forms: name -> coefficients and remainder, in names of the derivation.
        origin: id of a coefficient's or remainder's equation -> the equation collected.
        unknowns: by leg type, accelerations that are collected.
    """

    forms: dict[str, LinearForm] = field(default_factory=dict)
    origin: dict[str, Equation] = field(default_factory=dict)
    unknowns: dict[str, tuple[Any, ...]] = field(default_factory=dict)


def collect(derivation: Derivation) -> Collected:
    """Linear forms of everything that depends on the platform's acceleration."""
    result = Collected()
    for info in derivation.leg_types:
        equations = [e for c in derivation.chapters if c.leg_type == info.name for e in c.equations]
        result.unknowns[info.name] = unknowns = tuple(_unknowns(equations, info.name))
        known: dict[Any, LinearForm] = {}
        for equation in equations:
            parts = [e for e in equations if e.expanded is not None and e.expanded == equation.rhs]
            if equation.law is Law.RULES or equation.lhs in unknowns:
                continue
            form = _form(equation.rhs, unknowns, known)
            if form is None or not form.coefficients:
                continue
            for part in parts:
                result.origin[part.id] = equation
            named = LinearForm(
                {x: _named(value, parts) for x, value in form.coefficients.items()},
                _named(form.remainder, parts),
                form.steps,
            )
            known[equation.lhs] = result.forms[equation.name] = named
    return result


def _unknowns(equations: list[Equation], leg_type: str) -> Iterator[Any]:
    for equation in equations:
        if equation.name in ("a_p", f"a_p_{leg_type}"):
            yield equation.lhs
    names = sorted({n for e in equations for n in names_in(e.rhs) if n.startswith("ydd_")})
    for name in names:
        yield sp.Symbol(name, real=True)


def _form(rhs: Any, unknowns: tuple[Any, ...], known: dict[Any, LinearForm]) -> LinearForm | None:
    if isinstance(rhs, Tensor):
        return None
    try:
        return linear_form(rhs, unknowns, known)
    except NotLinearError:
        return None


def _named(value: Any, parts: list[Equation]) -> Any:
    """The name that one of the equations gives to a value."""
    return next((e.lhs for e in parts if e.rhs == value), value)


def collected_sum(form: LinearForm) -> Any:
    """Coefficients times accelerations plus remainder, as one expression."""
    total: Any = None
    for unknown, coefficient in form.coefficients.items():
        part = _times(coefficient, unknown)
        total = part if total is None else total + part
    return total + form.remainder if total is not None else form.remainder


def _times(coefficient: Any, unknown: Any) -> Any:
    if isinstance(unknown, VectorSymbol):
        if isinstance(coefficient, Vector):
            return Dot(coefficient, unknown)
        return coefficient @ unknown
    return coefficient * unknown


def is_name(value: Any) -> bool:
    """Whether a value is a symbol."""
    return isinstance(value, VectorSymbol | TensorSymbol | sp.Symbol)
