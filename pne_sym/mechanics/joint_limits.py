"""How far the joints of a leg are from their limits of displacement; limits of actuator forces.

Of a hinge that is no extra coordinate a full turn changes nothing: the displacement counts that is
nearest to the middle of the range.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import sympy as sp

from pne_sym.derivation import Book, Output
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.live import Place, note, of_legs
from pne_sym.mechanics.terms import Writer, glossary

_TERMS = glossary(r"""
middle_#   | q^m_{#}          | LUMPING constant
    middle of the range of joint #
half_#     | \varrho_{#}      | LUMPING constant
    half the range of joint #
off_#      | \bar q_{#}       | LIMIT | beyond the paper
    displacement of joint # from the middle of its range
off2_#     | \varsigma_{#}    | LIMIT | beyond the paper
    square of that displacement of joint #
margin_#   | \bar\chi_{#}     | LIMIT | beyond the paper
    distance of joint # from the nearer limit
""")
_TEXT = (
    "How far a joint is from the nearer of its limits, negative beyond it. Limits do not act on "
    "the joint."
)
_HINGES = " Full turns of a hinge do not count."


def write_margins(
    book: Book, g: LegGeometry, q: Mapping[int, Any], places: Sequence[slice]
) -> None:
    """The chapter on the limits of a leg's joints, where there are any.

    Args:
        book: of the derivation.
        g: of the leg.
        q: displacements by joint.
        places: where the joints of each leg stand in q.
    """
    limited = [j for j, joint in enumerate(g.leg_type.model.joints, 1) if joint.has_stroke]
    if not limited:
        return
    wraps = {j: g.kind(j).is_hinge and not g.is_extra(j) for j in limited}
    write = Writer(book, g, _TERMS)
    write.chapter("L", "Limits of &", _TEXT + _HINGES * any(wraps.values()))
    for j in limited:
        least, largest = _limits(book, g, j)
        middle = write("middle_#", (least + largest) / 2, j)
        half = write("half_#", (largest - least) / 2, j)
        off = q[j] - middle
        off = sp.atan2(sp.sin(off), sp.cos(off)) if wraps[j] else off
        off = write("off_#", off, j)
        margin = write("margin_#", half - sp.sqrt(write("off2_#", off**2, j)), j)
        rows = tuple(places[i].start + j - 1 for i in g.leg_type.indices)
        book.outputs.append(Output("margins", margin, ((0, 0),), (), g.leg_type.name, rows))


def _limits(book: Book, g: LegGeometry, j: int) -> tuple[Any, ...]:
    """The live parameters of joint j: its least and its largest displacement."""
    symbols = of_legs(book, g.leg_type, Place.joint(g.leg_type, j), "limits")
    for symbol, mark, word in zip(symbols, "-+", ("least", "largest"), strict=True):
        note(book, symbol, f"q^{mark}_{{{j}}}", f"{word} displacement of joint {j}")
    return symbols


def write_efforts(book: Book, g: LegGeometry, actuators: Sequence[tuple[int, int]]) -> None:
    """Limits of the forces of a leg's actuators, as parameters that functions look at.

    Args:
        book: of the derivation.
        g: of the leg.
        actuators: (leg, joint) of every entry of tau, counted from 0.
    """
    for j, joint in enumerate(g.leg_type.model.joints, 1):
        if not joint.has_effort:
            continue
        (limit,) = of_legs(book, g.leg_type, Place.joint(g.leg_type, j), "effort")
        rows = tuple(actuators.index((i, j - 1)) for i in g.leg_type.indices)
        book.outputs.append(Output("effort_limits", limit, ((0, 0),), (), g.leg_type.name, rows))
