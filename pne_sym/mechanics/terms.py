"""What the quantities of a leg are called: tables beside the equations that define them.

A row has name | symbol | law, role, marks | reference; below it stands the meaning.  The
marks # % & stand for numbers, of joints mostly: `v_#` is `v_2` for joint 2.  What has no law
is given; where a reference would stand is the unit of what is no parameter.  After an @
stands the frame in which a vector or tensor is naturally observed, after a semicolon
the symbol of the first coefficient of what depends on the acceleration.
After a colon a name may say which of several rows it is.
Without a meaning of its own it is what its role says.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import sympy as sp

from pne_sym.derivation import Book, Law, Quantity, Role
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.model.leg_types import a_leg
from pne_sym.vector import TensorSymbol, Vector, VectorSymbol, ZeroTensor, ZeroVector

_MARKS = "#%&"


class Term(NamedTuple):
    """A row of a table.

    Attributes:
        latex, law, role, reference, meaning: of the quantity.
        unit: of an input; U is that of its joint's displacement.
        coefficient: LaTeX of its first coefficient.
        frame: in which it is naturally observed: see `Writer.frame`.
        parameter: it is constant: made of parameters alone.
        symmetric: it is a symmetric tensor.
    """

    latex: str
    law: Law | None
    role: Role | None
    reference: str
    meaning: str
    coefficient: str = ""
    parameter: bool = False
    symmetric: bool = False
    unit: str = ""
    frame: str = ""

    def numbered(self, numbers: Sequence[Any]) -> Term:
        """With numbers in the places of the marks."""
        latex, coefficient, meaning = (
            filled(text, numbers) for text in (self.latex, self.coefficient, self.meaning)
        )
        return self._replace(latex=latex, coefficient=coefficient, meaning=meaning)


def filled(text: str, numbers: Sequence[Any]) -> str:
    """A text with numbers, or words, in the places of the marks."""
    for mark, number in zip(_MARKS, numbers, strict=False):
        text = text.replace(mark, str(number))
    return text


def is_named(value: Any) -> bool:
    """Whether a value is a symbol, or zero, which needs no name."""
    named = isinstance(value, sp.Symbol | VectorSymbol | TensorSymbol)
    return named or value in (0, ZeroVector, ZeroTensor)


def rows_of(table: str) -> dict[str, tuple[list[str], str]]:
    """The rows of a table by name: other cells, and what stands below."""
    found: dict[str, tuple[list[str], list[str]]] = {}
    below: list[str] = []
    for line in table.strip("\n").splitlines():
        if line.startswith(" "):
            below.append(line.strip())
        else:
            below = []
            name, *cells = (cell.strip() for cell in line.split("|"))
            found[name] = cells, below
    return {name: (cells, " ".join(below)) for name, (cells, below) in found.items()}


def glossary(table: str) -> dict[str, Term]:
    """The terms of a table by name."""
    return {name: _term(*row) for name, row in rows_of(table).items()}


def _term(cells: list[str], meaning: str) -> Term:
    latex, facts, reference = (*cells, "")[:3]
    latex, _, coefficient = (part.strip() for part in latex.partition(" ; "))
    first, *words = facts.split()
    law = None if first == "given" else Law[first]
    roles = [Role[word] for word in words if word in Role.__members__]
    role = roles[0] if roles else None
    return Term(
        latex,
        law,
        role,
        reference if law else "",
        meaning or (role.value if role else ""),
        coefficient,
        "constant" in words,
        "symmetric" in words,
        "" if law else reference,
        next((word[1:] for word in words if word.startswith("@")), ""),
    )


class Writer:
    """Writes equations of a leg, or of the platform: names, symbols, meanings stand in a table."""

    def __init__(self, book: Book, g: LegGeometry | None, table: Mapping[str, Term]) -> None:
        self.book, self.g, self.table = book, g, table

    def __call__(self, stem: str, rhs: Any, *numbers: Any, **facts: Any) -> Any:
        """Define a quantity; returns its symbol.

        Args:
            stem: a name of the table.
            rhs: what it is.
            numbers: for the marks of its row.
            facts: what `Book.define` takes besides, instead of the table's too.
        """
        term = self.table[stem].numbered(numbers)
        told = {
            "reference": term.reference,
            "role": term.role,
            "joint": numbers[0] if term.role and numbers else 0,
            "parameter": term.parameter,
            "symmetric": term.symmetric,
            "body": self.frame(term, numbers),
            **facts,
        }
        title, law = told.pop("title", term.meaning), told.pop("law", term.law)
        assert law is not None, stem
        name = self._name(stem, numbers)
        return self.book.define(name, rhs, term.latex, title, law, **told)

    def named(self, stem: str, rhs: Any, *numbers: Any, **facts: Any) -> Any:
        """The same, unless it is zero or has a name already."""
        return rhs if is_named(rhs) else self(stem, rhs, *numbers, **facts)

    def chapter(self, letter: str, title: str, text: str) -> None:
        """Open a chapter of the leg type; & in the title stands for the leg."""
        assert self.g is not None
        of = self.g.leg_type
        title = title.replace("&", a_leg(of.architecture))
        self.book.chapter(f"{of.name}-{letter}", title, text, of.name)

    def frame(self, term: Term, numbers: Sequence[Any]) -> str | None:
        """The frame that a row has after an @; None if it has none.

        It is that of base or platform, or of a link's axes: tip, the last one's; link, those of
        link #; before, of the link before joint #; turn, of that turned to the axis of joint #;
        own, as the specification has those of link #; last, as it has those of the last link;
        leg, those of the leg.
        """
        word, g = term.frame, self.g
        if g is None or word in ("", "base", "platform"):
            return word or None
        if word == "turn":
            return g.frame("turn", numbers[0])
        ends = {"tip": g.count, "last": g.count, "leg": 0}
        j = ends[word] if word in ends else numbers[0] - (word == "before")
        return g.frame("spec" if word in ("last", "own", "leg") else "axes", g.group[j])

    def _name(self, stem: str, numbers: Sequence[Any] = ()) -> str:
        """The name, in this leg type."""
        name = filled(stem, numbers).partition(":")[0]
        return self.g.name(name) if self.g else name

    def _unit(self, term: Term, numbers: Sequence[Any]) -> str:
        """Unit of what is given, where it has no components that tell."""
        of_joint = self.g.kind(numbers[0]).unit if self.g and term.unit else ""
        return term.unit.replace("U", of_joint) or "-"

    def give(
        self,
        stem: str,
        components: Iterable[Any],
        *numbers: Any,
        frame: str | None = None,
        symmetric: bool = True,
    ) -> Any:
        """Introduce a vector, or a tensor, with its components in a frame; returns its symbol.

        Args:
            stem: a name of the table.
            components: three of a vector, nine of a tensor.
            numbers: for the marks of its row.
            frame: in which it is fixed, where the row does not say it.
            symmetric: it is a symmetric tensor.
        """
        parts, name = tuple(components), self._name(stem, numbers)
        symbol = VectorSymbol(name) if len(parts) == 3 else TensorSymbol(name, symmetric)
        frame = frame or self.frame(self.table[stem], numbers)
        assert frame is not None, stem
        return self.book.give(symbol, frame, parts, self._quantity(stem, frame, numbers))

    def given(self, stem: str, active: str) -> Vector:
        """Introduce a vector that is an input, by its components along the active base axes."""
        if not active:
            return ZeroVector
        parts = (sp.Symbol(f"{stem}_{a}", real=True) if a in active else sp.S.Zero for a in "xyz")
        vector: Vector = self.give(stem, parts, frame="base")
        return vector

    def note(self, stem: str, *numbers: Any) -> sp.Symbol:
        """Introduce a scalar that is an input; returns its symbol."""
        quantity = self._quantity(stem, None, numbers)
        self.book.note_quantity(quantity)
        return sp.Symbol(quantity.name, real=True)

    def _quantity(self, stem: str, body: str | None, numbers: Sequence[Any]) -> Quantity:
        term = self.table[stem].numbered(numbers)
        return Quantity(
            self._name(stem, numbers),
            term.latex,
            term.meaning,
            self._unit(term, numbers),
            body,
            term.parameter or (body is not None and not term.unit),
            role=term.role,
            joint=numbers[0] if term.role and numbers else 0,
        )
