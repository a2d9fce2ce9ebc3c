"""What Rules I and II made of each quantity: coefficient times acceleration plus remainder.

The derivation defines coefficients and remainders under names of their own; here
they are put together again, for the reader to see what belongs together.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import sympy as sp

from pne_sym.backends.latex import LatexPrinter
from pne_sym.backends.terms import Term
from pne_sym.derivation import Derivation, Equation, Law, Role
from pne_sym.vector import Dot, LinearForm, Tensor, Vector, VectorSymbol, linear_form
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
        unknowns = tuple(_unknowns(derivation, equations, info.name))
        result.unknowns[info.name] = unknowns
        known: dict[Any, LinearForm] = {}
        for k, equation in enumerate(equations):
            if equation.law is Law.RULES or equation.lhs in unknowns:
                continue
            parts = _parts(equations, k)
            result.origin.update({part.id: equation for part in parts})
            form = (
                derivation.collected[equation.name]
                if equation.name in derivation.collected
                else _form(equation.rhs, unknowns, known)
            )
            if form is not None and (form.coefficients or parts):
                known[equation.lhs] = result.forms[equation.name] = form
    _of_the_platform(derivation, result)
    return result


def _of_the_platform(derivation: Derivation, result: Collected) -> None:
    """Forms of the platform's forces and moments; their parts stand in a later chapter."""
    equations = [e for c in derivation.chapters if not c.leg_type for e in c.equations]
    for equation in equations:
        form = derivation.collected.get(equation.name)
        if form is not None:
            result.forms[equation.name] = form
            parts = (e for e in equations if e.law is Law.RULES and e.expanded == equation.rhs)
            result.origin.update({part.id: equation for part in parts})


def _unknowns(derivation: Derivation, equations: list[Equation], leg_type: str) -> Iterator[Any]:
    """Accelerations: of the connection point, of the platform's turning, of extra joints."""
    notation = derivation.notation
    yield from (e.lhs for e in equations if notation[e.name].role is Role.COLLECTED_ACCELERATION)
    turning = derivation.with_role(Role.ANGULAR_ACCELERATION)
    yield from (g.symbol for g in derivation.givens if turning and g.symbol.name == turning.name)
    for quantity in derivation.leg_state():
        if quantity.leg_type == leg_type and quantity.role is Role.JOINT_ACCELERATION:
            yield sp.Symbol(quantity.name, real=True)


def _parts(equations: list[Equation], at: int) -> list[Equation]:
    """The equations after one that name its coefficients and its remainder."""
    parts = []
    for equation in equations[at + 1 :]:
        if equation.law is not Law.RULES or equation.expanded != equations[at].rhs:
            break
        parts.append(equation)
    return parts


def _form(rhs: Any, unknowns: tuple[Any, ...], known: dict[Any, LinearForm]) -> LinearForm | None:
    if isinstance(rhs, Tensor):
        return None
    try:
        return linear_form(rhs, unknowns, known)
    except NotLinearError:
        return None


def renamed(form: LinearForm, names: Mapping[Any, Any]) -> LinearForm:
    """A form with other names for its coefficients and remainder."""
    coefficients = {x: names.get(c, c) for x, c in form.coefficients.items()}
    return LinearForm(coefficients, names.get(form.remainder, form.remainder))


def collected_terms(form: LinearForm, printer: LatexPrinter) -> tuple[Term, ...]:
    """Coefficients times accelerations, then the remainder."""
    terms = [_times(value, unknown, printer) for unknown, value in form.coefficients.items()]
    if form.remainder != 0 and (not isinstance(form.remainder, Vector) or form.remainder.args):
        terms.extend(printer.terms(form.remainder))
    return tuple(terms)


def _times(coefficient: Any, unknown: Any, printer: LatexPrinter) -> Term:
    if not isinstance(unknown, VectorSymbol):
        text = printer.factor(coefficient)
        return Term(
            rf"{text}\,{printer.doprint(unknown)}" if text != "1" else printer.doprint(unknown)
        )
    if isinstance(coefficient, Vector):
        return printer.terms(Dot(coefficient, unknown))[0]
    return printer.terms(coefficient @ unknown)[0]
