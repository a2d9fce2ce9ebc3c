"""Physical dimensions of vector expressions, computed through every node.

An angle is a ratio of lengths: rad counts as 1.  What is zero has every dimension.

>>> from pne_sym.vector import Cross, VectorSymbol
>>> units = {"omega": dimension_of_unit("rad/s"), "r": dimension_of_unit("m")}
>>> print(dimension(Cross(VectorSymbol("omega"), VectorSymbol("r")), units))
m/s
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy as sp

from pne_sym.vector import nodes as n


class DimensionError(ValueError):
    """Terms of a sum, or an argument, of the wrong dimension."""


@dataclass(frozen=True)
class Dimension:
    """Powers of kilogram, metre and second."""

    kg: Fraction = Fraction(0)
    m: Fraction = Fraction(0)
    s: Fraction = Fraction(0)

    def __mul__(self, other: Dimension) -> Dimension:
        return Dimension(self.kg + other.kg, self.m + other.m, self.s + other.s)

    def __truediv__(self, other: Dimension) -> Dimension:
        return self * other ** Fraction(-1)

    def __pow__(self, power: Fraction) -> Dimension:
        return Dimension(self.kg * power, self.m * power, self.s * power)

    @property
    def unit(self) -> str:
        """As people write it, forces in newton; "-" where there is none.

        >>> print(dimension_of_unit("kg m^2/s^2").unit)
        N m
        """
        if self == NONE:
            return "-"
        if self.kg != 1 or self.s > -2:
            return str(self)
        rest = self / _NEWTON
        return "N" if rest == NONE else _WITH_NEWTON.get(rest, f"N {rest}")

    def __str__(self) -> str:
        powers = (("kg", self.kg), ("m", self.m), ("s", self.s))
        above = [u if p == 1 else f"{u}^{p}" for u, p in powers if p > 0]
        below = [u if p == -1 else f"{u}^{-p}" for u, p in powers if p < 0]
        text = " ".join(above) or "1"
        return text + "".join(f"/{u}" for u in below)


NONE = Dimension()
_ONE = Fraction(1)
_KG, _M, _S = Dimension(kg=_ONE), Dimension(m=_ONE), Dimension(s=_ONE)
_NEWTON = _KG * _M / _S / _S
_WITH_NEWTON = {_M: "N m", NONE / _M: "N/m", _S / _M: "N s/m", _M / _S: "W"}
_UNITS = {
    "-": NONE,
    "1": NONE,
    "rad": NONE,
    "kg": _KG,
    "m": _M,
    "s": _S,
    "N": _NEWTON,
    "J": _NEWTON * _M,
    "W": _NEWTON * _M / _S,
}


def dimension_of_unit(unit: str) -> Dimension:
    """The dimension of a unit such as "kg m^2" or "m/s^2"; what follows a slash divides.

    Raises:
        DimensionError: a part of the text is no unit.

    >>> print(dimension_of_unit("N m/rad"))
    kg m^2/s^2
    """
    result = NONE
    for k, part in enumerate(unit.split("/")):
        for factor in part.split():
            name, _, power = factor.partition("^")
            if name not in _UNITS or not (power or "1").isdigit():
                raise DimensionError(f"{unit!r}: {factor!r} is no unit")
            known = _UNITS[name] ** Fraction(int(power or "1"))
            result = result / known if k else result * known
    return result


Units = Mapping[str, Dimension | None]
"""Dimensions by name; None for what is zero."""


def dimension(expr: Any, units: Units) -> Dimension | None:
    """Dimension of an expression; None for zero, which has every dimension.

    Args:
        expr: vector, tensor or scalar expression.
        units: dimensions by name.

    Raises:
        DimensionError: terms of a sum disagree, or a function's argument has a dimension.
        KeyError: a name has no dimension.
        TypeError: the node is unknown.
    """
    if isinstance(expr, n.VectorSymbol | n.TensorSymbol | sp.Symbol):
        return units[expr.name]
    if expr in (n.ZeroVector, n.ZeroTensor) or expr == 0:
        return None
    if isinstance(expr, sp.Number) or expr == n.Identity:
        return NONE
    if isinstance(expr, n.DualVector | n.DualScalar):
        return _reciprocal(expr, units)
    if isinstance(expr, sp.Pow):
        base = dimension(expr.base, units)
        return None if base is None else base ** Fraction(int(expr.exp.p), int(expr.exp.q))
    return _of_parts(expr, units)


def _of_parts(expr: Any, units: Units) -> Dimension | None:
    """Dimension of a node that is made of its arguments' dimensions."""
    if isinstance(expr, _LEG_SUMS):
        return dimension(expr.args[0], units)
    parts = [dimension(arg, units) for arg in expr.args]
    if isinstance(expr, _SUMS):
        return _agreed(expr, parts)
    if isinstance(expr, _PRODUCTS):
        return _product(parts)
    if isinstance(expr, _ANGLES):
        agreed = _agreed(expr, parts)
        if agreed not in (None, NONE) and not isinstance(expr, sp.atan2):
            raise DimensionError(f"{expr}: an argument in {agreed}")
        return NONE
    raise TypeError(f"no dimension for {type(expr).__name__}")


_LEG_SUMS = (n.LegSum, n.VectorLegSum, n.TensorLegSum)
_ANGLES = (sp.sin, sp.cos, sp.acos, sp.atan2)
_SUMS = (sp.Add, n.VectorAdd, n.TensorAdd, sp.Abs, sp.Min, sp.Max)
_PRODUCTS = (
    sp.Mul,
    n.VectorScale,
    n.TensorScale,
    n.Cross,
    n.Dot,
    n.Trace,
    n.Apply,
    n.Compose,
    n.Transpose,
    n.Skew,
    n.Outer,
    n.Axial,
)


def _agreed(expr: Any, parts: list[Dimension | None]) -> Dimension | None:
    """The dimension that all parts have; zeros have it too."""
    found = list(dict.fromkeys(part for part in parts if part is not None))
    if len(found) > 1:
        terms = ", ".join(
            f"{arg} [{part}]" for arg, part in zip(expr.args, parts, strict=True) if part
        )
        raise DimensionError(f"terms of different dimension: {terms}")
    return found[0] if found else None


def _product(parts: list[Dimension | None]) -> Dimension | None:
    result = NONE
    for part in parts:
        if part is None:
            return None
        result = result * part
    return result


def _reciprocal(expr: Any, units: Units) -> Dimension | None:
    """Of w_k, one over that of v_k; of m_ki that times a length: E_ik times one is like v_k."""
    *indices, vectors, rows = expr.args
    velocities = [_of_motion(v, [row[k] for row in rows], units) for k, v in enumerate(vectors)]
    force = NONE / velocities[int(indices[0])]
    return force if len(indices) == 1 else force * _M


def _of_motion(velocity: Any, turns: list[Any], units: Units) -> Dimension:
    """Dimension of a column's velocity, which is that of its turns times a length."""
    angular = (dimension(turn, units) for turn in turns)
    parts = [dimension(velocity, units), *(a and a * _M for a in angular)]
    found = dict.fromkeys(part for part in parts if part is not None)
    if len(found) > 1:
        raise DimensionError(f"no motion: {velocity} [{parts[0]}] and turns {turns} [{parts[1]}]")
    return next(iter(found), _M)
