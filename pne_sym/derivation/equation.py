"""Equations with their laws, and the names in them.

Each defines one named vector, tensor or scalar by names that stand before it.
Nothing is expanded: every right-hand side is short.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import sympy as sp

from pne_sym.vector import (
    LegSum,
    RuleApplication,
    TensorLegSum,
    TensorSymbol,
    VectorLegSum,
    VectorSymbol,
)


class Law(enum.StrEnum):
    """Why an equation holds."""

    DEFINITION = "definition"
    GEOMETRY = "geometry"
    LOOP_CLOSURE = "loop closure"
    RATE = "time derivative"
    RECIPROCITY = "reciprocal basis"
    NEWTON = "Newton"
    EULER = "Euler"
    FREEDOM = "component along the joint's axis"
    REDUCTION = "reduction to the connection point"
    RULES = "Rules I and II"
    ASSEMBLY = "equilibrium of the platform"
    FRICTION = "friction"
    SPRING = "spring"
    ROTOR = "rotor"
    COUPLING = "coupling"
    LIMIT = "limit"
    MOVING_FRAME = "moving frame"
    ENERGY = "energy"
    LUMPING = "lumped parameter"


class FailureStatus(enum.StrEnum):
    """Why a state is impossible."""

    UNREACHABLE = "unreachable"
    SINGULAR = "singular"


@dataclass(frozen=True)
class Condition:
    """What must hold for an equation to be usable.

    UNREACHABLE: value >= 0.  SINGULAR: |value| > tolerance^power * scale.

    Attributes:
        status: what it means when the condition fails.
        value: scalar expression.
        scale: scalar made of parameters alone, of the value's unit.
        power: 1 for a value, 2 for a squared value.
    """

    status: FailureStatus
    value: Any
    scale: Any = sp.S.Zero
    power: int = 1


@dataclass(frozen=True)
class Equation:
    """One named equation, lhs = rhs.

    Attributes:
        id: cited in report and code: the name that it defines, ups-q_3 of leg type ups.
        title: what the equation says, in words.
        lhs: the symbol that the equation defines.
        rhs: vector, tensor or scalar expression in earlier names.
        law: why it holds.
        reference: the paper's equation or section.
        forms: further expressions of the same value that may lower better.
        steps: uses of Rules I and II that lead to the right-hand side.
        expanded: what stood before Rules I and II were used.
        conditions: what must hold for the equation to be usable.
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
    conditions: tuple[Condition, ...] = ()

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
        duals: names of the w_j; of the first few only, where no other is needed.
        scales: sizes of the v_k, made of parameters alone, by which a singular
            basis is recognised.
        frames: names of frames in which the basis may be solved.
        rows: further rows of scalars, one entry per vector: where the leg transmits
            moments, the parts of the joints' axes along the moment directions.
        moment_duals: per vector, the scalars that multiply the moment directions.
        length: a length of the leg, made of parameters alone, that makes moment rows
            comparable with the others.
    """

    id: str
    vectors: tuple[Any, ...]
    duals: tuple[Any, ...]
    scales: tuple[Any, ...]
    frames: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...] = ()
    moment_duals: tuple[tuple[Any, ...], ...] = ()
    length: Any = sp.S.One


@lru_cache(1 << 16)  # of whole equations, again and again
def names_in(expr: Any) -> frozenset[str]:
    """All names that occur in an expression."""
    if isinstance(expr, VectorSymbol | TensorSymbol | sp.Symbol):
        return frozenset((str(expr.name),))
    return frozenset().union(*map(names_in, getattr(expr, "args", ())))


def leg_sums(expr: Any) -> list[Any]:
    """The sums over legs in an expression."""
    if isinstance(expr, LegSum | VectorLegSum | TensorLegSum):
        return [expr]
    return [found for arg in getattr(expr, "args", ()) for found in leg_sums(arg)]
