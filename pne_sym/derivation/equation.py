"""Equations, laws, notation: the proof as data.

A derivation is a list of chapters; a chapter is a list of equations, each of
which defines one named vector, tensor or scalar by names that stand before it.
Nothing is expanded: every right-hand side is short.
"""

from __future__ import annotations

import enum
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import sympy as sp

from pne_sym.vector import LegSum, RuleApplication, TensorLegSum, TensorSymbol, VectorLegSum
from pne_sym.vector import VectorSymbol


class Law(enum.StrEnum):
    """Why an equation holds."""

    DEFINITION = "definition"
    GEOMETRY = "geometry"
    LOOP_CLOSURE = "loop closure"
    RATE = "time derivative"
    RECIPROCITY = "reciprocal basis"
    NEWTON = "Newton"
    EULER = "Euler"
    FREEDOM = "component along the joint's freedom"
    REDUCTION = "reduction to the connection point"
    RULES = "Rules I and II"
    ASSEMBLY = "equilibrium of the platform"
    ENERGY = "energy"
    LUMPING = "lumped parameter"


@dataclass(frozen=True)
class Quantity:
    """What a name stands for.

    Attributes:
        name: unique within the derivation; the stem of the names in the code.
        latex: how the report writes it.
        meaning: in words.
        unit: SI unit, or "-".
        body: name of the body in which the vector or tensor is naturally
            observed (a hint for the lowering, nothing else depends on it).
        parameter: the quantity is a parameter or made of parameters alone.
    """

    name: str
    latex: str
    meaning: str
    unit: str = "-"
    body: str | None = None
    parameter: bool = False


@dataclass(frozen=True)
class Equation:
    """One named equation, lhs = rhs.

    Attributes:
        id: stable identifier, printed in report and code.
        title: what the equation says, in words.
        lhs: the symbol that the equation defines.
        rhs: vector, tensor or scalar expression in earlier names.
        law: why it holds.
        reference: the paper's equation or section.
        forms: further expressions of the same value that may lower better.
        steps: uses of Rules I and II that lead to the right-hand side.
        expanded: what stood before Rules I and II were used.
        note: a remark for the reader.
    """

    id: str
    title: str
    lhs: Any
    rhs: Any
    law: Law
    reference: str = ""
    forms: tuple[Any, ...] = ()
    steps: tuple[RuleApplication, ...] = ()
    expanded: Any = None
    note: str = ""

    @property
    def name(self) -> str:
        """Name of the quantity that is defined."""
        return str(self.lhs.name)

    @property
    def uses(self) -> tuple[str, ...]:
        """Names on the right-hand side, sorted."""
        return tuple(sorted(names_in(self.rhs)))


@dataclass(frozen=True)
class ReciprocalBasis:
    """Vectors w_j with w_j . v_k = delta_jk, solved for by the structure of the v_k.

    Attributes:
        id: the equations' id.
        vectors: names of the v_k; two in the plane, three in space.
        duals: names of the w_j.
    """

    id: str
    vectors: tuple[Any, ...]
    duals: tuple[Any, ...]


@dataclass(frozen=True)
class Chapter:
    """A run of equations on one subject.

    Attributes:
        id: prefix of the equations' ids.
        title: for people.
        leg_type: name of the leg type the chapter is about, or None.
        text: an opening paragraph, Markdown.
        equations: in order.
    """

    id: str
    title: str
    leg_type: str | None
    text: str
    equations: tuple[Equation, ...]


@dataclass(frozen=True)
class Derivation:
    """The whole derivation of a manipulator.

    Attributes:
        chapters: in order; names are defined before they are used.
        notation: by name.
        bases: reciprocal bases.
    """

    chapters: tuple[Chapter, ...]
    notation: dict[str, Quantity] = field(default_factory=dict)
    bases: tuple[ReciprocalBasis, ...] = ()

    def equations(self) -> Iterator[Equation]:
        """All equations in order."""
        for chapter in self.chapters:
            yield from chapter.equations

    def definition(self, name: str) -> Equation:
        """The equation that defines a name.

        Raises:
            KeyError: nothing defines it (it is given).
        """
        for equation in self.equations():
            if equation.name == name:
                return equation
        raise KeyError(name)


def names_in(expr: Any) -> set[str]:
    """All names that occur in an expression."""
    if isinstance(expr, VectorSymbol | TensorSymbol | sp.Symbol):
        return {str(expr.name)}
    found: set[str] = set()
    for arg in getattr(expr, "args", ()):
        found |= names_in(arg)
    return found


def has_leg_sum(expr: Any) -> bool:
    """Whether an expression sums over legs."""
    if isinstance(expr, LegSum | VectorLegSum | TensorLegSum):
        return True
    return any(has_leg_sum(arg) for arg in getattr(expr, "args", ()))
