"""An equation of a derivation explained: what it says, why, from what, for what, in which code.

>>> from pne_sym.pipeline import compile_bundle
>>> from pne_sym.generation import find
>>> from pne_sym.review.explain import explain
>>> told = explain(compile_bundle(find("planar_3rpr")), "S")
>>> told.equation.id, told.formula
('rpr-S', 'rpr_S = t + rpr_q - rpr_b')
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Set
from dataclasses import dataclass

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.report.names import printer_for
from pne_sym.derivation import (
    Derivation,
    Equation,
    Quantity,
    full_name,
    full_names,
    names_in,
    rotations_by_place,
)
from pne_sym.review.plain import plain
from pne_sym.vector.arrays import Relation


class UnknownEquationError(ValueError):
    """No equation has the id or defines the name; the message has the nearest ones."""


@dataclass(frozen=True)
class Related:
    """A quantity that an equation uses, or one that uses it.

    Attributes:
        id: of the equation that defines it; "given" or "parameter" otherwise.
        name: of the quantity.
        meaning: in words.
    """

    id: str
    name: str
    meaning: str


@dataclass(frozen=True)
class Explanation:
    """All that is known of an equation.

    Attributes:
        equation: the equation.
        quantity: what it defines.
        chapter: title of its chapter.
        formula: plain text.
        forms: other expressions of the same value, plain text.
        latex: as in the report.
        uses: what stands on its right-hand side, in order of derivation.
        used_by: equations on whose right-hand side it stands, and outputs.
    """

    equation: Equation
    quantity: Quantity
    chapter: str
    formula: str
    forms: tuple[str, ...]
    latex: str
    uses: tuple[Related, ...]
    used_by: tuple[Related, ...]


def _all(derivation: Derivation) -> tuple[Equation, ...]:
    return (*derivation.equations(), *derivation.rotations())


def find_equation(derivation: Derivation, wanted: str) -> Equation:
    """The equation of an id (ups-rho2_1) or of the name that it defines.

    The name may lack its leg type where only one type has it (`find_equations` knows all); the
    fifth equation of a chapter is found under the chapter's id, too (ups-K5).

    Raises:
        UnknownEquationError: there is none; the message has the nearest ids and names.
    """
    equations = _all(derivation)
    known = {f"{c.id}{k}": e for c in derivation.chapters for k, e in enumerate(c.equations, 1)}
    known |= {key: e for e in equations for key in (e.name, e.id)}
    found = known.get(wanted) or known.get(full_name(derivation, wanted))
    if found is not None:
        return found
    same = [e for e in equations if wanted.lower() in (e.id.lower(), e.name.lower())]
    if len(same) == 1:
        return same[0]
    name = full_name(derivation, wanted)
    if name in derivation.notation or name in derivation.parameters.entries:
        users = [e.id for e in equations if name in names_in(e.rhs)]
        raise UnknownEquationError(
            f"{wanted!r} is given, no equation defines it; used by "
            f"{', '.join(users[:12]) or 'the outputs'}"
        )
    ids = [key for e in equations for key in (e.id, e.name)]
    ids += [r.id for r in derivation.relations]
    close = difflib.get_close_matches(wanted[:60], ids, n=4, cutoff=0.4)
    hint = f"; nearest: {', '.join(close)}" if close else ""
    raise UnknownEquationError(f"no equation {wanted[:60]!r}{hint}; without it all are listed")


def find_relation(derivation: Derivation, wanted: str) -> Relation | None:
    """The relation between arrays of an id, which is also the name of what it defines."""
    found = (r for r in derivation.relations if r.id.lower() == wanted.lower())
    return next(found, None)


def find_equations(derivation: Derivation, wanted: str) -> list[Equation]:
    """The same; a name without its leg type is that of every type that has it."""
    names = full_names(derivation, wanted)
    found = [e for e in _all(derivation) if e.name in names]
    return found if len(found) > 1 else [find_equation(derivation, wanted)]


def explain(bundle: Bundle, wanted: str, *, transitively: bool = False) -> Explanation:
    """Explain an equation.

    Args:
        bundle: the compiled manipulator.
        wanted: an equation's id or the name that it defines.
        transitively: also what its uses use, and what uses its users.

    Raises:
        UnknownEquationError: there is none; the message has the nearest ids and names.
    """
    derivation = bundle.derivation
    equation = find_equation(derivation, wanted)
    printer = printer_for(derivation)
    rotations = rotations_by_place(derivation)
    chapter = next(
        c
        for c in derivation.chapters
        if equation in c.equations
        or any(equation in e for (i, _), e in rotations.items() if i == c.id)
    )
    used = printer if chapter.leg_type else printer.with_index()
    uses = {e.name: names_in(e.rhs) for e in _all(derivation)}
    users: dict[str, set[str]] = {}
    for name, used_names in uses.items():
        for each in used_names:
            users.setdefault(each, set()).add(name)
    return Explanation(
        equation,
        derivation.notation[equation.name],
        chapter.title,
        f"{equation.name} = {plain(equation.rhs)}",
        tuple(plain(form) for form in equation.forms),
        f"{used.doprint(equation.lhs)} = {used.doprint(equation.rhs)}",
        tuple(_related(derivation, _reach(uses, equation.name, transitively))),
        (
            *_related(derivation, _reach(users, equation.name, transitively)),
            *_outputs(derivation, equation.name),
        ),
    )


def _reach(graph: Mapping[str, Set[str]], start: str, transitively: bool) -> set[str]:
    found: set[str] = set()
    stack = list(graph.get(start, ()))
    while stack:
        name = stack.pop()
        if name not in found:
            found.add(name)
            stack += graph.get(name, ()) if transitively else ()
    return found


def _related(derivation: Derivation, names: set[str]) -> Iterable[Related]:
    """The quantities of these names: given ones first, then in order of derivation."""
    equations = {e.name: e for e in _all(derivation)}
    for name in sorted(names - equations.keys()):
        table, quantity = derivation.parameters, derivation.notation.get(name)
        known = "sign of the assembly branch" if name in table.branches else "an input"
        if name in table.entries:
            known = table.entries[name][0].meaning
        id_ = "parameter" if name in table.entries else "given"
        yield Related(id_, name, quantity.meaning if quantity else known)
    for name, equation in equations.items():
        if name in names:
            yield Related(equation.id, name, equation.title)


def _outputs(derivation: Derivation, name: str) -> Iterable[Related]:
    arrays = dict.fromkeys(o.array for o in derivation.outputs if name in names_in(o.value))
    return [Related("output", array, "array of the generated code") for array in arrays]
