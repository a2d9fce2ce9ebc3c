"""Dimensions of a derivation's names, and the check of what its equations state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any

import sympy as sp

from pne_sym.derivation.equation import Derivation, Equation, Quantity, Trouble
from pne_sym.derivation.parameters import ParameterTable
from pne_sym.vector.dimensions import (
    NONE,
    Dimension,
    DimensionError,
    dimension,
    dimension_of_unit,
)

_of_unit = lru_cache(maxsize=None)(dimension_of_unit)


class Dimensions(Mapping[str, Dimension]):
    """Dimension by name: of quantities, of entries of parameters, of branches' signs."""

    def __init__(self, notation: Mapping[str, Quantity], table: ParameterTable) -> None:
        self.notation, self.table = notation, table

    def __getitem__(self, name: str) -> Dimension:
        if name in self.notation:
            return _of_unit(self.notation[name].unit)
        if name in self.table.entries:
            return _of_unit(self.table.entries[name][0].unit)
        if name in self.table.branches:
            return NONE
        raise KeyError(name)

    def __iter__(self) -> Iterator[str]:
        return iter({**self.notation, **self.table.entries, **self.table.branches})

    def __len__(self) -> int:
        return len(list(iter(self)))


def wrong_dimensions(derivation: Derivation) -> Iterator[str]:
    """What contradicts itself: an equation's id and name, what is stated and what is computed.

    Right-hand sides and other forms must have the dimension of the stated unit, the terms of
    every sum one dimension, a tested quantity that of its scale.  A measured number (a float,
    all that stands right) has the unit that is stated.
    """
    units = Dimensions(derivation.notation, derivation.parameters)
    for equation in derivation.equations():
        where = f"{equation.id} {equation.name}"
        stated = units[equation.name]
        try:
            for expr in (equation.rhs, *equation.forms):
                if isinstance(expr, sp.Float):
                    continue
                found = dimension(expr, units)
                if found not in (None, stated):
                    yield f"{where}: stated {stated}, computed {found} of {expr}"
            yield from (f"{where}: {text}" for text in _conditions(equation, units))
        except DimensionError as error:
            yield f"{where}: {error}"


def _conditions(equation: Equation, units: Mapping[str, Any]) -> Iterator[str]:
    for condition in equation.conditions:
        value, scale = dimension(condition.value, units), dimension(condition.scale, units)
        if condition.trouble is Trouble.SINGULAR and value != scale:
            yield f"{condition.value} in {value} is compared with {condition.scale} in {scale}"
