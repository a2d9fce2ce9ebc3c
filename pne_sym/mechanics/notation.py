"""The author's symbols in the place of the engine's, in formulas only.

Names in the code do not change.  What is named after a quantity follows it: the
rates of a displacement get its dots, a remainder its circle.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from pne_sym.derivation import Derivation, Quantity, Role, full_name, full_names, names_in
from pne_sym.model.entry import nearest
from pne_sym.model.errors import show
from pne_sym.model.manipulator import Manipulator
from pne_sym.model.symbols import split_symbol
from pne_sym.vector import TensorSymbol, VectorSymbol

# Quantities whose symbols stand in the report's own sentences and statements.
_COMMON = {
    Role[name]
    for name in """
        POSITION VELOCITY ACCELERATION ANGULAR_VELOCITY ANGULAR_ACCELERATION GRAVITY
        POINT POINT_VELOCITY POINT_ACCELERATION COLLECTED_ACCELERATION BIAS
    """.split()
}
# Symbols that mean the same in every report, though no quantity of a derivation has them.
TAKEN = (
    r"\mathbf{E} \mathbf{M} \mathbf{Z} \mathbf{H} \mathbf{H}_{k} \mathbf{F} \mathbf{A} \mathbf{T}"
    r" \mathbf{R} \mathbf{N} \mathbf{V} \mathbf{q}_{a} \mathbf{q}_{m} \mathbf{y} \boldsymbol\chi"
    r" \boldsymbol\iota \boldsymbol\tau \boldsymbol\lambda \tau \lambda X V i j"
).split()
# What follows a displacement, and the dots that it then has.
_DERIVATIVES = {Role.RATE: "dot", Role.JOINT_ACCELERATION: "ddot"}


class Mark(NamedTuple):
    r"""An author's symbol as LaTeX.

    >>> Mark("r", "u", bold=True).latex()
    '\\mathbf{r}_{u}'
    >>> Mark("\\theta", "", bold=False).latex("dot")
    '\\dot{\\theta}'
    """

    base: str
    sub: str
    bold: bool

    def latex(self, dots: str = "") -> str:
        """The symbol, under dots where their command is given."""
        if self.base.startswith("\\"):
            text = rf"\boldsymbol{self.base}" if self.bold else self.base
        elif self.bold:
            text = rf"\mathbf{{{self.base}}}"
        else:
            text = self.base if len(self.base) == 1 else rf"\mathrm{{{self.base}}}"
        if dots:
            text = rf"\{dots}{{{text}}}"
        if not self.sub:
            return text
        word = len(self.sub) > 1 and self.sub.isalpha()
        return text + (rf"_{{\mathrm{{{self.sub}}}}}" if word else f"_{{{self.sub}}}")


class Symbol(NamedTuple):
    """LaTeX of a quantity, and the field of the author's table it comes from."""

    latex: str
    key: str


def with_symbols(
    derivation: Derivation, manipulator: Manipulator, equal: Iterable[tuple[str, str]]
) -> Derivation:
    """The derivation in the author's symbols.

    Args:
        derivation: in the engine's notation.
        manipulator: whose symbols are wanted.
        equal: pairs of names of the same vector, which may share a symbol.

    Raises:
        SpecError: a name that the derivation does not have or that keeps its symbol, or
            a symbol that another quantity has.
    """
    if not manipulator.symbols:
        return derivation
    places, bold = _places(derivation), _bold(derivation)
    following: dict[str, Symbol] = {}
    own: dict[str, Symbol] = {}
    for key, name, text in _in_all_types(manipulator, derivation, places):
        _check_name(manipulator, key, name, derivation, places.keys() & derivation.notation.keys())
        parts = split_symbol(text)
        assert parts is not None, text
        mark = Mark(*parts, bold=name in bold)
        quantity = derivation.notation[name]
        following |= {n: Symbol(latex, key) for n, latex in _following(derivation, quantity, mark)}
        own |= {n: Symbol(latex, key) for n, latex in _itself(derivation, name, mark)}
    changed = following | own
    notation = {
        name: replace(quantity, latex=changed[name].latex) if name in changed else quantity
        for name, quantity in derivation.notation.items()
    }
    shared = {frozenset(pair) for pair in equal}
    for name in sorted(changed.keys() & places.keys()):
        others = (n for n in places if n in notation and n != name and {n, name} not in shared)
        taken = {n: notation[n].latex for n in others if _meet(places[n], places[name])}
        _refuse_collision(manipulator, changed[name], taken)
    return replace(derivation, notation=notation)


def _in_all_types(
    manipulator: Manipulator, derivation: Derivation, places: Collection[str]
) -> Iterator[tuple[str, str, str]]:
    """The author's keys, quantities, symbols; a key without a leg type is of all that have it."""
    own = {full_name(derivation, key) for key, _ in manipulator.symbols}
    for key, text in manipulator.symbols:
        names = full_names(derivation, key)
        found = [n for n in names if n in places] or [full_name(derivation, key)]
        yield from ((key, n, text) for n in found if len(names) == 1 or n not in own or n == key)


def _check_name(
    manipulator: Manipulator, key: str, name: str, derivation: Derivation, known: Collection[str]
) -> None:
    where = f"symbols.{key}"
    if name not in known:
        problem = f"no quantity {show(key)}{nearest(key, _short(derivation, known))}"
        raise manipulator.fault(where, problem, "a name that occurs in the derivation")
    quantity = derivation.notation[name]
    common = derivation.notation.get(quantity.remainder_of, quantity)
    if common.role in _COMMON:
        problem = "its symbol is the same in every report"
        raise manipulator.fault(where, problem, "no such field")


def _short(derivation: Derivation, names: Collection[str]) -> list[str]:
    """Names as they may be written: without the leg type where there is only one."""
    (first, *others) = (f"{info.name}_" for info in derivation.leg_types)
    return [name if others else name.removeprefix(first) for name in names]


def _itself(
    derivation: Derivation, name: str, mark: Mark, dots: str = ""
) -> Iterator[tuple[str, str]]:
    """A quantity and its remainder."""
    yield name, mark.latex(dots)
    for quantity in derivation.notation.values():
        if quantity.remainder_of == name:
            yield quantity.name, rf"{mark.latex(dots)}^{{\circ}}"


def _following(
    derivation: Derivation, displacement: Quantity, mark: Mark
) -> Iterator[tuple[str, str]]:
    """The derivatives of a displacement."""
    if displacement.role is not Role.DISPLACEMENT:
        return
    owner = displacement.leg_type, displacement.joint
    for quantity in derivation.notation.values():
        if (quantity.leg_type, quantity.joint) == owner and quantity.role in _DERIVATIVES:
            yield from _itself(derivation, quantity.name, mark, _DERIVATIVES[quantity.role])


def _meet(places: set[str | None], others: set[str | None]) -> bool:
    """Whether names of these chapters occur in one; those of the platform alone do not count."""
    return {None} in (places, others) or bool((places & others) - {None})


def _refuse_collision(manipulator: Manipulator, symbol: Symbol, taken: Mapping[str, str]) -> None:
    """Refuse a symbol that another quantity of the same chapters has."""
    where, wanted = f"symbols.{symbol.key}", _plain(symbol.latex)
    if wanted in map(_plain, TAKEN):
        problem = f"{symbol.latex} means something in every report"
        raise manipulator.fault(where, problem, "another symbol")
    for other, latex in taken.items():
        if _plain(latex) == wanted:
            problem = f"{symbol.latex} is the symbol of {other} as well"
            expected = f"another symbol, or a symbol for {other}, too"
            raise manipulator.fault(where, problem, expected)


def _plain(latex: str) -> str:
    """LaTeX without the braces and blanks that change nothing."""
    return re.sub(r"[{}\s]", "", latex)


def _places(derivation: Derivation) -> dict[str, set[str | None]]:
    """The leg types (None: the platform) in whose chapters a name occurs."""
    places: dict[str, set[str | None]] = {}
    for chapter in derivation.chapters:
        for equation in chapter.equations:
            parts: list[Any] = [equation.lhs, equation.rhs, *equation.forms]
            parts += [value for c in equation.conditions for value in (c.value, c.scale)]
            for name in {n for part in parts for n in names_in(part)}:
                places.setdefault(name, set()).add(chapter.leg_type)
    return places


def _bold(derivation: Derivation) -> set[str]:
    """Names of vectors and tensors."""
    symbols = [given.symbol for given in derivation.givens]
    symbols += [equation.lhs for equation in derivation.equations()]
    return {s.name for s in symbols if isinstance(s, VectorSymbol | TensorSymbol)}
