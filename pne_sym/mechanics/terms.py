"""What the quantities of a leg are called: tables beside the equations that define them.

A row has name | symbol | law, role, marks | reference; below it stands the meaning.  The
marks # % & stand for numbers, of joints mostly: `v_#` is `v_2` for joint 2.  What has no law
is given; where a reference would stand is the unit of what is no parameter.  After a
colon a name may say which of several rows it is.  After a semicolon stands
the symbol of the first coefficient of what depends on the acceleration.
Without a meaning of its own it is what its role says.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import sympy as sp

from pne_sym.derivation import Book, Law, Quantity, Role
from pne_sym.model.joint_kinds import JointKind
from pne_sym.vector import TensorSymbol, Vector, VectorSymbol, ZeroTensor, ZeroVector

_MARKS = "#%&"


@dataclass(frozen=True)
class Term:
    """A row of a table.

    Attributes:
        latex, law, role, reference, meaning: of the quantity.
        unit: of an input; U is that of its joint's displacement.
        coefficient: LaTeX of its first coefficient.
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

    def numbered(self, numbers: Sequence[Any]) -> Term:
        """With numbers in the places of the marks."""
        latex, coefficient, meaning = (
            filled(text, numbers) for text in (self.latex, self.coefficient, self.meaning)
        )
        return replace(self, latex=latex, coefficient=coefficient, meaning=meaning)


def filled(text: str, numbers: Sequence[Any]) -> str:
    """A text with numbers, or words, in the places of the marks."""
    for mark, number in zip(_MARKS, numbers, strict=False):
        text = text.replace(mark, str(number))
    return text


def glossary(table: str) -> dict[str, Term]:
    """The rows of a table by name."""
    found: dict[str, tuple[list[str], list[str]]] = {}
    below: list[str] = []
    for line in table.strip("\n").splitlines():
        if line.startswith(" "):
            below.append(line.strip())
        else:
            below = []
            name, *cells = (cell.strip() for cell in line.split("|"))
            found[name] = cells, below
    return {name: _term(cells, " ".join(below)) for name, (cells, below) in found.items()}


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
    )


class Named(Protocol):
    """What tells names of leg types apart: see `leg_geometry.LegGeometry`."""

    def name(self, stem: str) -> str:
        """The stem with the leg type's name, and the names of joints."""

    def kind(self, j: int) -> JointKind:
        """Kind of joint j."""


class Writer:
    """Writes equations of a leg, or of the platform: names, symbols, meanings stand in a table."""

    def __init__(self, book: Book, g: Named | None, table: Mapping[str, Term]) -> None:
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
            **facts,
        }
        title, law = told.pop("title", term.meaning), told.pop("law", term.law)
        assert law is not None, stem
        name = self._name(stem, numbers)
        return self.book.define(name, rhs, term.latex, title, law, **told)

    def named(self, stem: str, rhs: Any, *numbers: Any, **facts: Any) -> Any:
        """The same, unless it is zero or has a name already."""
        named = isinstance(rhs, sp.Symbol | VectorSymbol | TensorSymbol)
        if named or rhs in (0, ZeroVector, ZeroTensor):
            return rhs
        return self(stem, rhs, *numbers, **facts)

    def _name(self, stem: str, numbers: Sequence[Any] = ()) -> str:
        """The name, in this leg type."""
        name = filled(stem, numbers).partition(":")[0]
        return self.g.name(name) if self.g else name

    def _unit(self, term: Term, numbers: Sequence[Any]) -> str:
        """Unit of what is given, where it has no components that tell."""
        of_joint = self.g.kind(numbers[0]).unit if self.g and term.unit else ""
        return term.unit.replace("U", of_joint) or "-"

    def give(self, stem: str, frame: str, components: Iterable[Any], *numbers: Any) -> VectorSymbol:
        """Introduce a vector with its components, fixed in a frame; returns its symbol."""
        symbol = VectorSymbol(self._name(stem, numbers))
        self.book.give(symbol, frame, tuple(components), self._quantity(stem, frame, numbers))
        return symbol

    def given(self, stem: str, active: str) -> Vector:
        """Introduce a vector that is an input, by its components along the active base axes."""
        if not active:
            return ZeroVector
        parts = (sp.Symbol(f"{stem}_{a}", real=True) if a in active else sp.S.Zero for a in "xyz")
        return self.give(stem, "base", parts)

    def give_tensor(
        self,
        stem: str,
        frame: str,
        components: Iterable[Any],
        *numbers: Any,
        symmetric: bool = True,
    ) -> TensorSymbol:
        """The same of a tensor."""
        symbol = TensorSymbol(self._name(stem, numbers), symmetric)
        self.book.give(symbol, frame, tuple(components), self._quantity(stem, frame, numbers))
        return symbol

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
