"""Inertia of the platform with what moves with it: payload, masses at the connection points.

Reference: section 2.4.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import sympy as sp

from pne_sym.derivation import Book
from pne_sym.mechanics.legs import Leg, plus_sums
from pne_sym.mechanics.platform_motion import PlatformMotion
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.vector import Dot, Identity, Outer, Vector, ZeroTensor, tensor_sum, vector_sum

_TERMS = glossary(r"""
m_star | m^*         | LUMPING constant
    mass of the platform with the gathered masses
h_star | \mathbf h^* | LUMPING constant @platform
    first moment about the platform origin
J_star | \mathbf J^* | LUMPING constant symmetric @platform
    inertia tensor about the platform origin
""")
_TITLE = "Platform inertia with the masses gathered at the connection points"
_LUMPED = (
    "The mass of a leg's last link, gathered at the connection point, moves with the platform "
    "and is counted with it; this changes no force that the platform sees."
)
_NOT_LUMPED = "The platform's own mass, first moment and inertia tensor, about its origin."
_KEPT = (
    " Legs that restrict the platform keep the mass of their last links, so that the multipliers "
    "are the physical reactions."
)
_CARRIES = " The payload moves with the platform and is counted with it."


class PlatformInertia(NamedTuple):
    """Of the platform and all that is counted with it.

    Attributes:
        mass: scalar.
        moment: first moment about the platform origin.
        tensor: inertia tensor about it.
    """

    mass: Any
    moment: Vector
    tensor: Any


def write_inertia(book: Book, p: PlatformMotion, legs: Sequence[Leg]) -> PlatformInertia:
    """The chapter on the platform's inertia with the gathered masses."""
    gathered = any(leg.dynamics.tip_mass != 0 for leg in legs)
    kept = any(leg.motion.constraints for leg in legs)
    text = (_LUMPED if gathered else _NOT_LUMPED) + _KEPT * kept + _CARRIES * bool(p.payload)
    book.chapter("L", _TITLE, text)
    eq = Writer(book, None, _TERMS)
    bodies = [(p.mass, p.centre, p.inertia), *([p.payload] if p.payload else [])]
    mass = sp.Add(*(mass for mass, *_ in bodies))
    moment = vector_sum(mass * centre for mass, centre, _ in bodies)
    tensor = tensor_sum(part for mass, R, own in bodies for part in (own, _of_point(mass, R)))
    mass = plus_sums(mass, legs, lambda leg: leg.dynamics.tip_mass)
    moment = plus_sums(moment, legs, lambda leg: leg.dynamics.tip_mass * leg.g.platform_point)
    tensor = plus_sums(
        tensor, legs, lambda leg: _of_point(leg.dynamics.tip_mass, leg.g.platform_point)
    )
    return PlatformInertia(
        eq("m_star", mass),
        eq("h_star", moment),
        eq("J_star", tensor),
    )


def _of_point(mass: Any, r: Vector) -> Any:
    """Inertia tensor of a point mass."""
    return mass * (Dot(r, r) * Identity - Outer(r, r)) if mass != 0 else ZeroTensor
