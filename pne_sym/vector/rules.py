"""Rules I and II of the paper: how an unknown vector is collected.

Reference: Dasgupta & Choudhury (1999), section 2.3.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import sympy as sp

from pne_sym.vector.nodes import Cross, Dot, Identity, Outer, Skew, Tensor, Vector, scale


class Rule(Protocol):
    """A rewriting that brings a product into the form coefficient times unknown."""

    name: str
    statement: str


@dataclass(frozen=True)
class RuleI:
    """(a . x) b = (b a^T) x."""

    name: str = "Rule I"
    statement: str = r"(\mathbf a\cdot\mathbf x)\,\mathbf b=(\mathbf b\,\mathbf a^T)\,\mathbf x"

    def coefficient(self, a: Vector, b: Vector) -> Tensor:
        """The tensor b a^T that replaces (a . x) b."""
        return Outer(b, a)


@dataclass(frozen=True)
class RuleII:
    """a x x = skew(a) x."""

    name: str = "Rule II"
    statement: str = r"\mathbf a\times\mathbf x=\tilde{\mathbf a}\,\mathbf x"

    def coefficient(self, a: Vector) -> Tensor:
        """The tensor skew(a) that replaces a x (.)."""
        return Skew(a)


RULE_I = RuleI()
RULE_II = RuleII()


@dataclass(frozen=True)
class RuleApplication:
    """One recorded use of a rule.

    Attributes:
        rule: the rule used.
        before: the product as it stood.
        after: the same value as coefficient applied to the unknown.
    """

    rule: RuleI | RuleII
    before: Any
    after: Any


def apply_rule_i(a: Vector, x: Vector, b: Vector) -> tuple[Tensor, RuleApplication]:
    """Rule I on (a . x) b, recorded."""
    coefficient = RULE_I.coefficient(a, b)
    return coefficient, RuleApplication(RULE_I, scale(Dot(a, x), b), coefficient @ x)


def apply_rule_ii(a: Vector, x: Vector, factor: sp.Expr) -> tuple[Tensor, RuleApplication]:
    """Rule II on factor (a x x), recorded."""
    coefficient = RULE_II.coefficient(a) * factor
    return coefficient, RuleApplication(RULE_II, scale(factor, Cross(a, x)), coefficient @ x)


__all__ = [
    "RULE_I",
    "RULE_II",
    "Identity",
    "Rule",
    "RuleApplication",
    "RuleI",
    "RuleII",
    "apply_rule_i",
    "apply_rule_ii",
]
