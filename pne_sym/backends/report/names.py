"""Who is who in a derivation: titles of leg types, names that stand for one value per leg."""

from __future__ import annotations

from typing import Any

from pne_sym.backends.latex import LatexPrinter
from pne_sym.derivation import Derivation, LegTypeInfo, names_in
from pne_sym.vector import LegSum, TensorLegSum, VectorLegSum


def leg_title(info: LegTypeInfo) -> str:
    """Architecture with the driven joint underlined, for Markdown text."""
    return _marked(info, "<ins>", "</ins>") + _number(info)


def leg_latex(info: LegTypeInfo) -> str:
    """The same for formulas."""
    text = _marked(info, r"\underline{", "}")
    number = _number(info).strip()
    return rf"\mathrm{{{text}}}" + (f"_{{{number}}}" if number else "")


def _marked(info: LegTypeInfo, before: str, after: str) -> str:
    text, driven = "", False
    for letter in info.title:
        if letter == "_":
            driven = True
        else:
            text += f"{before}{letter}{after}" if driven else letter
            driven = False
    return text


def _number(info: LegTypeInfo) -> str:
    """Number of a leg type whose architecture another type has, too."""
    stem = info.title.replace("_", "").replace("*", "").lower()
    number = info.name.removeprefix(stem)
    return f" {number}" if number else ""


def plain_names(text: str, derivation: Derivation) -> str:
    """A text of the derivation with architectures as the report writes them."""
    for info in sorted(derivation.leg_types, key=lambda t: -len(t.title)):
        text = text.replace(f" {info.title} ", f" {leg_title(info)} ")
    return text


def printer_for(derivation: Derivation) -> LatexPrinter:
    """The LaTeX printer with a derivation's notation."""
    several = len(derivation.leg_types) > 1
    legs = {
        info.name: rf"i\in {leg_latex(info)}" if several else "i" for info in derivation.leg_types
    }
    symbols = {name: code_latex(name) for name in derivation.parameters.entries}
    symbols |= {name: quantity.latex for name, quantity in derivation.notation.items()}
    return LatexPrinter(symbols, per_leg_names(derivation), legs)


def code_latex(name: str) -> str:
    """A name of the code in a formula."""
    escaped = name.replace("_", r"\_")
    return rf"\mathtt{{{escaped}}}"


def per_leg_names(derivation: Derivation) -> frozenset[str]:
    """Names of quantities of which every leg has its own."""
    table = derivation.parameters
    found = {name for name, (field, _) in table.entries.items() if field.leg_type}
    found |= set(table.branches)
    legs = tuple(f"{info.name}." for info in derivation.leg_types)
    for given in derivation.givens:
        entries = {n for component in given.components for n in names_in(component)}
        if given.frame.startswith(legs) or entries & found:
            found.add(given.symbol.name)
    for chapter in derivation.chapters:
        for equation in chapter.equations:
            if chapter.leg_type or names_outside_sums(equation.rhs) & found:
                found.add(equation.name)
    defined = {equation.name for equation in derivation.equations()}
    given_names = {given.symbol.name for given in derivation.givens}
    for chapter in derivation.chapters:  # extra coordinates, rates and accelerations
        if chapter.leg_type:
            used = {n for e in chapter.equations for n in names_in(e.rhs)}
            found |= used - defined - given_names - set(table.entries)
    return frozenset(found)


def names_outside_sums(expr: Any) -> set[str]:
    """Names in an expression that do not stand within a sum over legs."""
    if isinstance(expr, LegSum | VectorLegSum | TensorLegSum):
        return set()
    args = getattr(expr, "args", ())
    if not args or hasattr(expr, "name"):
        return names_in(expr)
    return {name for arg in args for name in names_outside_sums(arg)}
