"""The length by which moments are compared with forces where conditioning is judged."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import sympy as sp

from pne_sym.derivation import Book, Output
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.vector import Dot, sum_over_legs, vector_sum

_TERMS = glossary(r"""
b_c       | \mathbf b_c | LUMPING constant @platform
    centroid of the platform points
spread    | \ell_b      | LUMPING constant
    rms distance of the platform points from their centroid
legs_size | \ell_s      | LUMPING constant
    rms size of the legs, taken where the platform points coincide
""")


def write_lengths(book: Book, legs: Sequence[LegGeometry]) -> None:
    """How far the platform points are apart, and the size of the legs where they coincide."""
    book.chapter("C", "Lengths for conditioning", _TEXT)
    count = sp.Integer(sum(g.leg_type.count for g in legs))

    def mean(of: Callable[[LegGeometry], Any]) -> list[Any]:
        return [sum_over_legs(of(g), g.leg_type.name) / count for g in legs]

    eq = Writer(book, None, _TERMS)
    centroid = eq("b_c", vector_sum(mean(lambda g: g.platform_point)))

    def squared(g: LegGeometry) -> Any:
        arm = g.platform_point - centroid
        return Dot(arm, arm)

    spread = eq("spread", sp.sqrt(sp.Add(*mean(squared))))
    legs_size = eq("legs_size", sp.sqrt(sp.Add(*mean(lambda g: g.size**2))))
    for row, value in enumerate((spread, legs_size)):
        book.outputs.append(Output("lengths", value, ((0, row),)))


_TEXT = (
    r"Singular values of $`\mathbf H`$ have a meaning only where its rows have one unit: moments "
    r"are divided by the length $`\ell_b`$ over which the legs act on the platform."
)
