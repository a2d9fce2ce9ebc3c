"""Equations, given quantities and frames as texts that can be compared."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pne_sym.derivation import Equation, Frame, Given, ReciprocalBasis, leg_sums
from pne_sym.review.plain import plain
from pne_sym.vector.arrays import Relation, written


def formula(equation: Equation) -> str:
    """name = right-hand side = other forms."""
    return joined(equation.name, [equation.rhs, *equation.forms])


def joined(name: str, sides: Sequence[Any]) -> str:
    """An equation with all its sides, those of equal text once."""
    return " = ".join((name, *dict.fromkeys(map(plain, sides))))


def relation_formula(relation: Relation) -> str:
    """name = right-hand side, of whole arrays."""
    return f"{relation.id} = {written(relation.rhs, _NAMES, _FORMS)}"


_NAMES = {name: f"diag({name})" for name in ("ratios", "per_turn", "rotor_roots")}
_FORMS = {
    **dict.fromkeys(("product", "times", "multiply", "scale_columns"), "{0} {1}"),
    "transposed": "{0}^T",
    "solve": "({0})^-1 {1}",
}


def conditions(equation: Equation) -> str:
    """What must hold, as one text."""
    return str([(str(c.status), c.value, c.scale, c.power) for c in equation.conditions])


def text_of(equation: Equation) -> tuple[str, ...]:
    """All that an equation says."""
    return (formula(equation), conditions(equation))


def components(entries: Sequence[Any]) -> str:
    """(x, y, z)."""
    return f"({', '.join(map(str, entries))})"


def given_text(given: Given) -> str:
    """Components of what is given."""
    return components(given.components)


def frame_text(frame: Frame) -> str:
    """How a frame stands in its parent."""
    return str((frame.rotation, frame.axes, frame.rows, frame.angle))


def basis_facts(basis: ReciprocalBasis) -> dict[str, str]:
    """What a reciprocal basis is solved from, by words."""
    words = {
        "vectors": basis.vectors, "reciprocal": basis.duals, "sizes": basis.scales,
        "frames": basis.frames, "further rows": basis.rows,
        "along moments": basis.moment_duals, "length": basis.length,
    }  # fmt: skip
    return {word: str(value) for word, value in words.items()}


def summed_types(expr: Any) -> list[str]:
    """The leg types that an expression sums over, in order."""
    return list(dict.fromkeys(str(total.args[1]) for total in leg_sums(expr)))
