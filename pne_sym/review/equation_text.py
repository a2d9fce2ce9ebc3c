"""Equations, given quantities and frames as texts that can be compared."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from pne_sym.derivation import Equation, Frame, ReciprocalBasis, leg_sums
from pne_sym.review.plain import plain
from pne_sym.vector.arrays import Relation, written


def formula(equation: Equation) -> str:
    """name = right-hand side = other forms, those of equal text once."""
    return text_of(equation)[0]


def relation_formula(relation: Relation) -> str:
    """name = right-hand side, of whole arrays."""
    return f"{relation.id} = {written(relation.rhs, _NAMES, _FORMS)}"


_NAMES = {name: f"diag({name})" for name in ("ratios", "per_turn", "rotor_roots")}
_FORMS = {
    **dict.fromkeys(("product", "times", "multiply", "scale_columns"), "{0} {1}"),
    "transposed": "{0}^T",
    "solve": "({0})^-1 {1}",
}


def text_of(
    equation: Equation, name: str = "", of: Callable[[Any], Any] = lambda expr: expr
) -> tuple[str, str]:
    """All that an equation says: its sides, and what must hold.

    Args:
        equation: the equation.
        name: of what it defines; default its own.
        of: expressions as they are to be shown.
    """
    sides = [of(side) for side in (equation.rhs, *equation.forms)]
    held = [(str(c.status), of(c.value), of(c.scale), c.power) for c in equation.conditions]
    return " = ".join((name or equation.name, *dict.fromkeys(map(plain, sides)))), str(held)


def components(entries: Sequence[Any]) -> str:
    """(x, y, z)."""
    return f"({', '.join(map(str, entries))})"


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
