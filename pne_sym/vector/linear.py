"""Vector expressions that are linear in an unknown as coefficient times unknown plus remainder.

`linear_form` walks the expression once.  Products that hide the unknown are
opened by Rule I and Rule II, and each use of a rule is recorded.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import sympy as sp

from pne_sym.vector.nodes import (
    Apply,
    Cross,
    Dot,
    Identity,
    Outer,
    Skew,
    Transpose,
    Vector,
    VectorAdd,
    VectorLegSum,
    VectorScale,
    VectorSymbol,
    ZeroVector,
    sum_over_legs,
    vector_sum,
)

Coefficients = dict[Any, Any]
RULE_I = "Rule I"
"""(a . x) b = (b a^T) x."""
RULE_II = "Rule II"
"""a x x = skew(a) x."""


@dataclass(frozen=True)
class RuleApplication:
    """One recorded use of a rule.

    Attributes:
        rule: the rule used.
        before: the product as it stood.
        after: the same value as coefficient applied to the unknown.
    """

    rule: str
    before: Any
    after: Any


class NotLinearError(ValueError):
    """The expression is not linear in the unknowns."""


@dataclass(frozen=True)
class LinearForm:
    """expr = sum over unknowns of coefficient * unknown + remainder.

    Attributes:
        coefficients: by unknown.  For a vector unknown a tensor (of a vector
            expression) or a vector c meaning c . x (of a scalar expression);
            for a scalar unknown a vector or a scalar.
        remainder: the part without unknowns, of the expression's own type.
        steps: the uses of Rules I and II, in order.
    """

    coefficients: Mapping[Any, Any]
    remainder: Any
    steps: tuple[RuleApplication, ...] = field(default=())


def linear_form(
    expr: Any,
    unknowns: Sequence[Any],
    known: Mapping[Any, LinearForm] | None = None,
) -> LinearForm:
    """Collect the unknowns of a vector or scalar expression.

    Args:
        expr: vector or scalar expression, linear in the unknowns.
        unknowns: vector symbols or scalar symbols.
        known: linear forms of names that depend on the unknowns themselves.

    Raises:
        NotLinearError: the expression is not linear in the unknowns.

    Reference: section 2.3, Rules I and II, Eq. 4.
    """
    collector = _Collector(tuple(unknowns), dict(known or {}))
    coefficients, remainder = collector.collect(sp.sympify(expr))
    return LinearForm(coefficients, remainder, tuple(collector.steps))


class _Collector:
    def __init__(self, unknowns: tuple[Any, ...], known: dict[Any, LinearForm]) -> None:
        self.unknowns = unknowns
        self.known = known
        self.steps: list[RuleApplication] = []
        self.rules: dict[type, Callable[..., tuple[Coefficients, Any]]] = {
            VectorAdd: self._sum,
            VectorScale: self._scaled,
            VectorLegSum: self._over_legs,
            Cross: self._cross,
            Apply: self._applied,
            sp.Add: self._sum,
            sp.Mul: self._multiple,
            Dot: self._product,
        }

    def depends(self, expr: Any) -> bool:
        if expr in self.unknowns or expr in self.known:
            return True
        return any(self.depends(arg) for arg in getattr(expr, "args", ()))

    def collect(self, expr: Any) -> tuple[Coefficients, Any]:
        """Coefficients by unknown, and remainder."""
        if expr in self.known:
            form = self.known[expr]
            return dict(form.coefficients), form.remainder
        if expr in self.unknowns:
            if isinstance(expr, Vector):
                return {expr: Identity}, ZeroVector
            return {expr: sp.S.One}, sp.S.Zero
        if not self.depends(expr):
            return {}, expr
        if type(expr) not in self.rules:
            raise NotLinearError(f"not linear in the unknowns: {expr}")
        return self.rules[type(expr)](*expr.args)

    def _moving(self, factors: Sequence[Any]) -> Any:
        """The one factor that holds unknowns."""
        moving = [factor for factor in factors if self.depends(factor)]
        if len(moving) > 1:
            raise NotLinearError("a product of two factors that both hold unknowns")
        return moving[0]

    def _sum(self, *terms: Any) -> tuple[Coefficients, Any]:
        parts = [self.collect(term) for term in terms]
        total: Coefficients = {}
        for coefficients, _ in parts:
            for x, c in coefficients.items():
                total[x] = total[x] + c if x in total else c
        remainders = [remainder for _, remainder in parts]
        if all(isinstance(r, Vector) for r in remainders):
            return total, vector_sum(remainders)
        return total, sp.Add(*remainders)

    def _applied(self, tensor: Any, vector: Any) -> tuple[Coefficients, Any]:
        if self.depends(tensor):
            raise NotLinearError(f"not linear in the unknowns: {tensor @ vector}")
        coefficients, remainder = self.collect(vector)
        return {x: tensor @ c for x, c in coefficients.items()}, tensor @ remainder

    def _over_legs(self, body: Any, leg_type: Any) -> tuple[Coefficients, Any]:
        """A sum over legs, of unknowns that are the same for all of them."""
        first = len(self.steps)
        coefficients, remainder = self.collect(body)
        self.steps[first:] = [
            RuleApplication(s.rule, *(sum_over_legs(x, leg_type.name) for x in (s.before, s.after)))
            for s in self.steps[first:]
        ]
        summed = {x: sum_over_legs(c, leg_type.name) for x, c in coefficients.items()}
        return summed, sum_over_legs(remainder, leg_type.name)

    def _scaled(self, factor: Any, vector: Any) -> tuple[Coefficients, Any]:
        if not self.depends(factor):
            coefficients, remainder = self.collect(vector)
            return {x: c * factor for x, c in coefficients.items()}, remainder * factor
        scalar_coefficients, remainder = self.collect(self._moving((factor, vector)))
        result: Coefficients = {}
        for x, c in scalar_coefficients.items():
            if isinstance(x, VectorSymbol):
                result[x], before = Outer(vector, c), Dot(c, x) * vector
                self.steps.append(RuleApplication(RULE_I, before, result[x] @ x))
            else:
                result[x] = vector * c
        return result, vector * remainder

    def _cross(self, a: Any, b: Any) -> tuple[Coefficients, Any]:
        fixed, moving, sign = (a, b, 1) if self._moving((a, b)) == b else (b, a, -1)
        coefficients, remainder = self.collect(moving)
        result: Coefficients = {}
        for x, c in coefficients.items():
            if not isinstance(x, VectorSymbol):
                result[x] = Cross(fixed, c) * sign
                continue
            result[x] = (Skew(fixed) * sign) @ c
            before = Cross(fixed, c @ x) if sign == 1 else Cross(c @ x, fixed)
            self.steps.append(RuleApplication(RULE_II, before, result[x] @ x))
        return result, Cross(fixed, remainder) * sign

    def _multiple(self, *factors: Any) -> tuple[Coefficients, Any]:
        moving = self._moving(factors)
        factor = sp.Mul(*factors) / moving
        coefficients, remainder = self.collect(moving)
        return {x: c * factor for x, c in coefficients.items()}, factor * remainder

    def _product(self, a: Any, b: Any) -> tuple[Coefficients, Any]:
        moving = self._moving((a, b))
        coefficients, remainder = self.collect(moving)
        fixed = a if moving == b else b
        return {x: _dot(fixed, c, x) for x, c in coefficients.items()}, Dot(fixed, remainder)


def _dot(fixed: Any, coefficient: Any, unknown: Any) -> Any:
    """Coefficient of fixed . (coefficient unknown)."""
    if isinstance(unknown, VectorSymbol):
        return Transpose(coefficient) @ fixed
    return Dot(fixed, coefficient)
