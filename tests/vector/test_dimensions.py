"""Dimensions of expressions."""

from __future__ import annotations

import pytest
import sympy as sp

from pne_sym.vector import Cross, Dot, DualScalar, DualVector, Skew, VectorSymbol, ZeroVector
from pne_sym.vector.dimensions import NONE, DimensionError, dimension, dimension_of_unit

r, v, w, e = (VectorSymbol(name) for name in ("r", "v", "w", "e"))
L, q = sp.symbols("L q", real=True)
UNITS = {
    name: dimension_of_unit(unit)
    for name, unit in {"r": "m", "v": "m/s", "w": "rad/s", "e": "-", "L": "m", "q": "rad"}.items()
}


@pytest.mark.parametrize(
    ("unit", "other"),
    [("N m", "kg m^2/s^2"), ("rad", "-"), ("N/m", "kg/s^2"), ("J", "N m"), ("W/N", "m/s")],
)
def test_units_that_are_the_same(unit: str, other: str) -> None:
    assert dimension_of_unit(unit) == dimension_of_unit(other)


@pytest.mark.parametrize("unit", ["furlong", "m^x", "m^-1", "N*m"])
def test_what_is_no_unit(unit: str) -> None:
    with pytest.raises(DimensionError, match="is no unit"):
        dimension_of_unit(unit)


@pytest.mark.parametrize(
    ("expr", "unit"),
    [
        (Cross(w, r) + v, "m/s"),
        (sp.sqrt(Dot(r, r)), "m"),
        (Skew(w) @ v, "m/s^2"),
        (sp.cos(q) * L, "m"),
        (sp.atan2(L, sp.sqrt(Dot(r, r))), "rad"),
        (DualVector(sp.Integer(0), sp.Tuple(r, e), sp.Tuple()), "1/m"),
        (DualVector(sp.Integer(1), sp.Tuple(r, e), sp.Tuple()), "-"),
        (DualScalar(sp.Integer(0), sp.Integer(0), sp.Tuple(r, e), sp.Tuple(sp.Tuple(q, 0))), "-"),
        (DualScalar(sp.Integer(1), sp.Integer(0), sp.Tuple(r, e), sp.Tuple(sp.Tuple(q, 0))), "m"),
    ],
)
def test_computed(expr: object, unit: str) -> None:
    assert dimension(expr, UNITS) == dimension_of_unit(unit)


def test_zero_has_every_dimension() -> None:
    assert dimension(ZeroVector, UNITS) is None
    assert dimension(sp.S.Zero, UNITS) is None
    assert dimension(sp.Rational(1, 2), UNITS) == NONE


_A_WRENCH = sp.Tuple(r, e), sp.Tuple(sp.Tuple(q, L))
"""A motion, and a unit force with its moment among motions: only a length would make it one."""


@pytest.mark.parametrize(
    "expr",
    [
        *(r + v, L + q, sp.sin(L), 1 + Dot(r, r), sp.atan2(L, q), sp.sqrt(L + Dot(r, r))),
        DualVector(sp.Integer(0), *_A_WRENCH),
        DualScalar(sp.Integer(1), sp.Integer(0), *_A_WRENCH),
    ],
)
def test_what_does_not_fit(expr: object) -> None:
    with pytest.raises(DimensionError):
        dimension(expr, UNITS)
