"""Dimensions of a derivation's names, and units as people read them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from typing import Any

import sympy as sp

from pne_sym.derivation.equation import Condition, FailureStatus, Law
from pne_sym.derivation.parameters import ParameterTable
from pne_sym.derivation.quantity import Quantity, Role
from pne_sym.vector import Tensor
from pne_sym.vector.dimensions import (
    NONE,
    Dimension,
    DimensionError,
    Units,
    dimension,
    dimension_of_unit,
)

_of_unit = lru_cache(maxsize=None)(dimension_of_unit)
_TURNING = {_of_unit(unit): unit for unit in ("rad/s", "rad/s^2")}
_OF_MOTION = (Law.RATE, Law.RECIPROCITY, Law.RULES, Law.ROTOR, Law.MOVING_FRAME)
OF_ZERO = ""
"""Unit of what is zero: it has every dimension."""


class Dimensions(Mapping[str, Dimension | None]):
    """Dimension by name: of quantities, of entries of parameters, of branches' signs."""

    def __init__(self, notation: Mapping[str, Quantity], table: ParameterTable) -> None:
        self.notation, self.table = notation, table

    def __getitem__(self, name: str) -> Dimension | None:
        if name in self.notation:
            unit = self.notation[name].unit
            return None if unit == OF_ZERO else _of_unit(unit)
        if name in self.table.entries:
            return _of_unit(self.table.entries[name][0].unit)
        if name in self.table.branches:
            return NONE
        raise KeyError(name)

    def __iter__(self) -> Iterator[str]:
        return iter({**self.notation, **self.table.entries, **self.table.branches})

    def __len__(self) -> int:
        return len(list(iter(self)))


def unit_of_equation(
    rhs: Any,
    others: Iterable[Any],
    conditions: Iterable[Condition],
    units: Units,
    *,
    law: Law,
    role: Role | None,
) -> str:
    """The unit of a right-hand side, computed; radians where something turns, joule of energies.

    Args:
        rhs: the right-hand side.
        others: further expressions of the same dimension; what is zero has theirs.
        conditions: what is tested: a value, and its scale.
        units: dimensions of the names.
        law: of the equation: of energy has joules, of motion radians per second.
        role: of the quantity; a displacement without a length is an angle.

    Raises:
        DimensionError: terms of a sum disagree, or other expressions of the value, or what is
            tested and its scale.
    """
    found = dimension(rhs, units)
    for expr in others:
        other = dimension(expr, units)
        if found is not None and other not in (None, found):
            raise DimensionError(f"{rhs} [{found}] is said to be like {expr} [{other}]")
        found = found or other
    for c in conditions:
        value, scale = dimension(c.value, units), dimension(c.scale, units)
        if c.status is FailureStatus.SINGULAR and value != scale:
            raise DimensionError(f"{c.value} [{value}] is compared with {c.scale} [{scale}]")
    if found is None:
        return OF_ZERO
    if law is Law.ENERGY:
        return "J" if found == _of_unit("J") else found.unit
    if role is Role.DISPLACEMENT and found == NONE:
        return "rad"
    turns = law in _OF_MOTION and not isinstance(rhs, Tensor)
    return _TURNING.get(found, found.unit) if turns else found.unit


def unit_of_components(components: Iterable[Any], units: Units) -> str | None:
    """The unit of a vector's or tensor's components; None where they are coordinates of a state.

    Raises:
        DimensionError: they disagree.
    """
    symbols = [c for c in components if not sp.sympify(c).is_number]
    if not symbols:
        return NONE.unit
    if any(name not in units for c in symbols for name in map(str, c.free_symbols)):
        return None
    found = {dimension(c, units) for c in symbols}
    if len(found) > 1:
        raise DimensionError(f"components of different dimension: {symbols}")
    (one,) = found
    return one.unit if one else OF_ZERO
