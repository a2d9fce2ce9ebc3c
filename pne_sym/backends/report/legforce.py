"""The force of a leg on the platform as Eqs. 3 and 4 of the paper state it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pne_sym.backends.latex import LatexPrinter
from pne_sym.backends.report.collected import Collected, collected_terms, renamed
from pne_sym.backends.report.markdown import display, inline
from pne_sym.backends.report.view import Statement
from pne_sym.backends.terms import Term
from pne_sym.derivation import Derivation, Equation, Law, Output, Role
from pne_sym.vector import LinearForm, linear_form

_FORCE = r"\mathbf F"
_MOMENT = r"\mathbf N"


def leg_force_statements(
    derivation: Derivation, collected: Collected, leg_type: str, printer: LatexPrinter
) -> Iterator[Statement]:
    """Eq. 3 and Eq. 4 of a leg type."""
    force = next((o.value for o in _outputs(derivation, leg_type, "leg_force", 0)), None)
    if force is None:
        return
    actuators = tuple(_applied(derivation, leg_type, printer, 0))
    constrained = _outputs(derivation, leg_type, "constraint_direction", 0)
    others = " and the constraints" if constrained else ""
    yield Statement(
        f"**The leg's force on the platform, Eq. 3.** What the actuators{others} give, "
        "and a rest that inverse dynamics evaluates as a number, accelerations included:",
        display(_FORCE, [(*actuators, *printer.terms(force))]),
    )
    closed = closed_force(derivation, collected, leg_type, printer)
    if closed:
        yield Statement(
            "**The leg's force on the platform, Eq. 4.** In closed form, the acceleration "
            "collected:",
            closed,
        )
    yield from _moment(derivation, collected, leg_type, printer)
    final = _final(derivation, leg_type)
    definition = _definition(derivation, force)
    if final and definition is not None and definition.law is Law.NEWTON:
        names = " and ".join(inline(printer.doprint(e.lhs)) for e in final)
        yield Statement(
            f"{names} leave out the mass of the last link: gathered at the connection point, it "
            "moves with the platform and is counted with the platform below.",
            (),
        )


def closed_force(
    derivation: Derivation, collected: Collected, leg_type: str, printer: LatexPrinter
) -> tuple[str, ...]:
    """Lines of Eq. 4 of a leg type; none where it has no closed form."""
    force = next((o.value for o in _outputs(derivation, leg_type, "leg_force", 0)), None)
    form = closed_form(derivation, collected, leg_type, force) if force is not None else None
    if form is None:
        return ()
    actuators = _applied(derivation, leg_type, printer, 0)
    return display(_FORCE, [(*actuators, *collected_terms(form, printer))])


def _moment(
    derivation: Derivation, collected: Collected, leg_type: str, printer: LatexPrinter
) -> Iterator[Statement]:
    """The moment that the leg transmits, where it does."""
    for output in _outputs(derivation, leg_type, "leg_force", 3):
        actuators = tuple(_applied(derivation, leg_type, printer, 3))
        rows = [(*actuators, *printer.terms(output.value))]
        form = closed_form(derivation, collected, leg_type, output.value)
        if form is not None:
            rows.append((*actuators, *collected_terms(form, printer)))
        yield Statement(
            "**The leg's moment on the platform**, which its platform joint transmits, likewise:",
            display(_MOMENT, rows),
        )


def _applied(
    derivation: Derivation, leg_type: str, printer: LatexPrinter, first: int
) -> Iterator[Term]:
    """What actuators and constraints give: w tau, n lambda."""
    for output in _outputs(derivation, leg_type, "actuator", first):
        joint = _joint_of(derivation, output)
        effort = rf"\tau_{joint}" if joint else r"\tau"
        yield Term(rf"{printer.factor(output.value)}\,{effort}")
    normals = _outputs(derivation, leg_type, "constraint_direction", first)
    for k, output in enumerate(normals, 1):
        index = f"_{k}" if len(normals) > 1 else ""
        yield Term(rf"{printer.factor(output.value)}\,\lambda{index}")


def _outputs(derivation: Derivation, leg_type: str, array: str, first: int) -> list[Output]:
    """Outputs of a leg type's array: forces (first = 0) or moments (first = 3)."""
    return [
        o
        for o in derivation.outputs
        if o.array == array and o.leg_type == leg_type and o.columns and o.columns[0][1] == first
    ]


def _joint_of(derivation: Derivation, output: Output) -> str:
    """Number of the joint that a reciprocal vector belongs to, or nothing."""
    quantity = derivation.notation.get(str(getattr(output.value, "name", "")))
    return str(quantity.joint) if quantity and quantity.joint else ""


def _definition(derivation: Derivation, symbol: Any) -> Equation | None:
    return next((e for e in derivation.equations() if e.lhs == symbol), None)


def closed_form(
    derivation: Derivation, collected: Collected, leg_type: str, force: Any
) -> LinearForm | None:
    """Linear form of the leg's force in Q and U."""
    definitions = {e.name: e for e in derivation.equations()}
    names = {-e.rhs: -e.lhs for e in _final(derivation, leg_type)}
    forms = {definitions[n].lhs: form for n, form in collected.forms.items()}
    known = {symbol: renamed(form, names) for symbol, form in forms.items()}
    definition = _definition(derivation, force)
    if force not in known or definition is None:
        return None
    form = known.pop(force)
    if form != forms[force]:
        return form
    return linear_form(definition.rhs, collected.unknowns[leg_type], known)


def _final(derivation: Derivation, leg_type: str) -> list[Equation]:
    """The equations of Q and U."""
    wanted = (Role.LEG_INERTIA, Role.LEG_BIAS)
    return [
        e
        for c in derivation.chapters
        if c.leg_type == leg_type
        for e in c.equations
        if derivation.notation[e.name].role in wanted
    ]
