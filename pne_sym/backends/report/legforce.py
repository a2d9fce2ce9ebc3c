"""The force of a leg on the platform as Eqs. 3 and 4 of the paper state it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.latex import LatexPrinter, Term
from pne_sym.backends.report.collected import Collected, collected_sum
from pne_sym.backends.report.markdown import display, inline
from pne_sym.backends.report.view import Statement
from pne_sym.derivation import Derivation, Equation, Law, Output
from pne_sym.vector import LinearForm, Tensor, linear_form
from pne_sym.vector.nodes import split_scale, split_tensor_scale

_FORCE = r"\mathbf F"


def leg_force_statements(
    bundle: Bundle, collected: Collected, leg_type: str, printer: LatexPrinter
) -> Iterator[Statement]:
    """Eq. 3 and Eq. 4 of a leg type."""
    derivation = bundle.derivation
    output = next(
        (o for o in derivation.outputs if o.array == "leg_force" and o.leg_type == leg_type), None
    )
    if output is None:
        return
    drives = tuple(_applied(derivation, leg_type, printer))
    yield Statement(
        "**The leg's force, Eq. 3.** The force on the platform is what the actuators give "
        f"along their reciprocal vectors{_multiplier_words(derivation, leg_type)}, and a rest "
        "that inverse dynamics evaluates as a number, with the accelerations as they are:",
        display(_FORCE, [(*drives, *printer.terms(output.value))]),
    )
    form = _closed_form(derivation, collected, leg_type, output.value)
    if form is not None:
        yield Statement(
            "**The leg's force, Eq. 4.** In closed form, with the acceleration collected:",
            display(_FORCE, [(*drives, *printer.terms(collected_sum(form)))]),
        )
    reduced = _reduced(derivation, leg_type, output, printer)
    if reduced:
        yield Statement(reduced, ())


def _applied(derivation: Derivation, leg_type: str, printer: LatexPrinter) -> Iterator[Term]:
    """What actuators and constraints give: w tau, n lambda."""
    for output in _columns(derivation, leg_type, "drive"):
        joint = _joint_of(output)
        text = printer.factor(output.value)
        yield Term(rf"{text}\,\tau_{joint}" if joint else rf"{text}\,\tau")
    normals = [o for o in _columns(derivation, leg_type, "Hk") if o.rows[0][1] == 0]
    for k, output in enumerate(normals, 1):
        index = f"_{k}" if len(normals) > 1 else ""
        yield Term(rf"{printer.factor(output.value)}\,\lambda{index}")


def _columns(derivation: Derivation, leg_type: str, array: str) -> list[Output]:
    return [o for o in derivation.outputs if o.array == array and o.leg_type == leg_type]


def _joint_of(output: Output) -> str:
    """Number of the joint that a reciprocal vector belongs to, from its name."""
    parts = str(getattr(output.value, "name", "")).split("_")
    return parts[1] if len(parts) > 1 and parts[1].isdigit() else ""


def _multiplier_words(derivation: Derivation, leg_type: str) -> str:
    if _columns(derivation, leg_type, "Hk"):
        return ", the reactions along the directions that the leg leaves out"
    return ""


def _closed_form(derivation: Derivation, collected: Collected, leg_type: str, value: Any) -> Any:
    """Linear form of the leg's force in Q and U."""
    definitions = {e.name: e for e in derivation.equations()}
    names = _final_names(derivation, leg_type)
    known = {definitions[n].lhs: _renamed(form, names) for n, form in collected.forms.items()}
    if value in known:
        form = known[value]
        equation = definitions.get(str(getattr(value, "name", "")))
        if equation is None:
            return form
        return (
            linear_form(
                equation.rhs,
                collected.unknowns[leg_type],
                {x: f for x, f in known.items() if x != value},
            )
            if _holds_known(equation, known)
            else form
        )
    return None


def _holds_known(equation: Equation, known: dict[Any, LinearForm]) -> bool:
    """Whether a force is made of another force that has been collected (a tip mass is added)."""
    return equation.law is Law.NEWTON and any(
        split_scale(arg)[1] in known for arg in getattr(equation.rhs, "args", ())
    )


def _final_names(derivation: Derivation, leg_type: str) -> dict[Any, Any]:
    """What Q and U rename: coefficient -> -Q, remainder -> -U."""
    names: dict[Any, Any] = {}
    for equation in _final(derivation, leg_type):
        rhs = equation.rhs
        factor, symbol = (
            split_scale(rhs)
            if hasattr(rhs, "args") and not _is_tensor(rhs)
            else split_tensor_scale(rhs)
        )
        if factor == -1:
            names[symbol] = -equation.lhs
    return names


def _final(derivation: Derivation, leg_type: str) -> list[Equation]:
    """The equations of Q and U: named by the rules, but no part of another equation."""
    return [
        e
        for c in derivation.chapters
        if c.leg_type == leg_type
        for e in c.equations
        if e.law is Law.RULES and e.expanded is None and e.reference.startswith("Eq. 4")
    ]


def _is_tensor(value: Any) -> bool:
    return isinstance(value, Tensor)


def _renamed(form: LinearForm, names: dict[Any, Any]) -> LinearForm:
    return LinearForm(
        {x: names.get(c, c) for x, c in form.coefficients.items()},
        names.get(form.remainder, form.remainder),
    )


def _reduced(derivation: Derivation, leg_type: str, output: Output, printer: LatexPrinter) -> str:
    """What the platform's equations use instead, where the last link's mass moves to it."""
    equation = next((e for e in derivation.equations() if e.lhs == output.value), None)
    if equation is None or equation.law is not Law.NEWTON:
        return ""
    names = " and ".join(inline(printer.doprint(e.lhs)) for e in _final(derivation, leg_type))
    return (
        f"{names} leave out the mass of the last link: gathered at the connection point it moves "
        "with the platform and is counted there, which changes nothing else."
    )
