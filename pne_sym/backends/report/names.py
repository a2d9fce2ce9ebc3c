"""Who is who in a derivation: titles of leg types, names that stand for one value per leg."""

from __future__ import annotations

from typing import Any

from pne_sym.backends.latex import LatexPrinter
from pne_sym.derivation import Derivation, LegTypeInfo, names_in
from pne_sym.vector import LegSum, TensorLegSum, VectorLegSum


def leg_title(info: LegTypeInfo) -> str:
    """Architecture with the actuated joint underlined, for Markdown text."""
    return _marked(info, "<ins>", "</ins>").replace("*", r"\*") + _number(info)


def _marked(info: LegTypeInfo, before: str, after: str) -> str:
    text, actuated = "", False
    for letter in info.title:
        if letter == "_":
            actuated = True
        else:
            text += f"{before}{letter}{after}" if actuated else letter
            actuated = False
    return text


def _number(info: LegTypeInfo) -> str:
    """Number of a leg type whose architecture another type has, too."""
    return f" {info.number}" if info.number > 1 else ""


def plain_names(text: str, derivation: Derivation) -> str:
    """A text of the derivation with architectures as the report writes them."""
    for info in sorted(derivation.leg_types, key=lambda t: -len(t.title)):
        text = text.replace(f" {info.title} ", f" {leg_title(info)} ")
    return text


INDICES = "ilnrsu"


def leg_indices(derivation: Derivation) -> dict[str, str]:
    """Leg type -> the letter that runs over its legs."""
    letters = (*INDICES, *(f"i_{k}" for k in range(1, len(derivation.leg_types))))
    return dict(zip((info.name for info in derivation.leg_types), letters, strict=False))


def printer_for(derivation: Derivation) -> LatexPrinter:
    """The LaTeX printer with a derivation's notation."""
    symbols = {name: code_latex(name) for name in derivation.parameters.entries}
    symbols |= {name: quantity.latex for name, quantity in derivation.notation.items()}
    return LatexPrinter(symbols, per_leg_names(derivation), leg_indices(derivation))


def code_latex(name: str) -> str:
    """A name of the code in a formula."""
    escaped = name.replace("_", r"\_")
    return rf"\mathtt{{{escaped}}}"


def per_leg_names(derivation: Derivation) -> dict[str, str]:
    """Names of quantities of which every leg has its own -> leg type."""
    table = derivation.parameters
    entries = {name: field.leg_type for name, (field, _) in table.entries.items()}
    found = {name: leg_type for name, leg_type in entries.items() if leg_type}
    found |= {name: leg_type for name, (leg_type, _) in table.branches.items()}
    for given in derivation.givens:
        if owner := derivation.notation[given.symbol.name].leg_type:
            found[given.symbol.name] = owner
    for chapter in derivation.chapters:
        for equation in chapter.equations:
            names = names_outside_sums(equation.rhs)
            if chapter.leg_type:
                found[equation.name] = chapter.leg_type
                # not defined, not given: extra coordinates, their rates and accelerations
                known = found.keys() | derivation_givens(derivation)
                found |= dict.fromkeys(names - known, chapter.leg_type)
            elif names & found.keys():
                found[equation.name] = found[min(names & found.keys())]
    return found


def derivation_givens(derivation: Derivation) -> set[str]:
    """Names with given components, and those that platform equations define."""
    shared = {e.name for c in derivation.chapters if not c.leg_type for e in c.equations}
    return {g.symbol.name for g in derivation.givens} | set(derivation.parameters.entries) | shared


def names_outside_sums(expr: Any) -> set[str]:
    """Names in an expression that do not stand within a sum over legs."""
    if isinstance(expr, LegSum | VectorLegSum | TensorLegSum):
        return set()
    args = getattr(expr, "args", ())
    if not args or hasattr(expr, "name"):
        return set(names_in(expr))
    return {name for arg in args for name in names_outside_sums(arg)}
