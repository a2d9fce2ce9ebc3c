"""Statements in C, and what they read: loads, entries of vectors, places of legs."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_stages import Shared, aliases
from pne_sym.backends.c_text import WIDTH, c_name, comment, statement, table
from pne_sym.backends.describe import equation_titles
from pne_sym.backends.scalar import wrap
from pne_sym.program.ir import Assignment, Function, LegInput
from pne_sym.program.slices import read_in

_WORTH = 3
_HEAD = re.compile(r"^( *)/\* \((\S+)\) \*/$", re.MULTILINE)


def vector_name(vector: str) -> str:
    """Argument of an input vector; the displacements are told from the output q by their name."""
    return "joints" if vector == "q" else vector


def statements(
    assignments: Iterable[Assignment],
    printer: Shared,
    loads: dict[str, str] | None = None,
) -> list[str]:
    """Assignments, headed by the equations they belong to; what they read is loaded before them.

    Args:
        assignments: in order.
        printer: of expressions; a value that has a place there is put into it.
        loads: where the names stand that are not yet at hand; those that are read are taken out.
    """
    waiting = {} if loads is None else loads
    rows = (
        (
            a.equation,
            [
                *loaded(waiting, a.expr),
                *statement(printer.assigned(a.target.name, printer.text(a.expr))),
            ],
        )
        for a in assignments
    )
    return headed(rows)


def headed(rows: Iterable[tuple[str, list[str]]]) -> list[str]:
    """Lines with the equations they belong to, under these."""
    lines: list[str] = []
    known = ""
    for equation, own in rows:
        if equation and equation != known:
            known = equation
            lines.append(f"/* ({equation}) */")
        lines += own
    return lines


class Titles:
    """Tells the title of an equation where a file names it first."""

    def __init__(self, bundle: Bundle) -> None:
        self.titles = equation_titles(bundle.derivation)

    def told(self, text: str) -> str:
        """Text with titles behind the ids over statements; names of inputs are no equations."""
        return _HEAD.sub(self._head, text)

    def _head(self, found: re.Match[str]) -> str:
        indent, equation = found.groups()
        title = self.titles.get(equation)
        self.titles |= {equation: ""} if title else {}
        named = f"{equation}: named entries" if title is None else f"({equation}) {title}"
        return "\n".join(f"{indent}{line}" for line in comment(named.rstrip()))


def loaded(loads: dict[str, str], *expressions: Any) -> list[str]:
    """Loads of what expressions read and is not yet at hand."""
    if not loads:
        return []
    read = loads.keys() & set[str]().union(*(read_in(e) for e in expressions))
    return [f"const real {c_name(n)} = {loads.pop(n)};" for n in sorted(read)]


def entries(bundle: Bundle, function: Function, index: str) -> dict[str, str]:
    """Where entries of the input vectors stand, by name, and names that are entries."""
    found = {
        f"{vector}_{e}": f"{vector_name(vector)}[{e}*w + {index}]"
        for vector in function.inputs
        for e in range(bundle.coordinates.lengths[vector])
    }
    return found | {n: found[e] for n, e in aliases(function).items()}


def leg_input(bundle: Bundle, item: LegInput, leg: str, tables: list[str]) -> str:
    """An entry of a vector that belongs to a leg."""
    places = item.indices
    if len(set(places)) > 1:
        copies = capacity(bundle.leg_counts[leg]) - len(places)
        places = (*places, *places[:1] * copies)
    place = place_text(places, "i", f"place_{item.symbol.name}", tables)
    return f"{vector_name(item.vector)}[{factor(place)}*w + j]"


def capacity(legs: int) -> int:
    """Length of the model's arrays over legs: vectors of four entries, where these are worth it."""
    return legs if legs < _WORTH else -(-legs // 4) * 4


def factor(place: str) -> str:
    """A place as a factor."""
    return f"({place})" if " " in place else place


def place_text(places: tuple[int, ...], index: str, name: str, tables: list[str]) -> str:
    """Index text of the place of a leg; a table is declared where one is needed."""
    even = table(places, index)
    if even is not None:
        return even
    text = f"static const size_t {name}[] = {{{', '.join(map(str, places))}}};"
    tables += wrap(text, WIDTH - 8, "    ")
    return f"{name}[{index}]"
