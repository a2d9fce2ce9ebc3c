"""Live parameters: fields of the model, from where they stand in a specification."""

from __future__ import annotations

from typing import Any, TypedDict, Unpack

import numpy as np
import sympy as sp

from pne_sym.derivation import Book, ParameterField, Quantity, Rule
from pne_sym.mechanics.structure import LegType
from pne_sym.model.manipulator import Leg


class Demands(TypedDict, total=False):
    """Which entries are zero by structure, and what values must be: see `ParameterField`."""

    zeros: tuple[int, ...]
    rule: Rule


def of_all(
    book: Book,
    name: str,
    path: str,
    values: Any,
    unit: str,
    meaning: str,
    **demands: Unpack[Demands],
) -> tuple[sp.Expr, ...]:
    """A parameter of the whole machine: symbols of its entries."""
    default = np.array(values, dtype=float)
    return book.parameters.add(
        ParameterField(name, None, default.shape, unit, meaning, (path,), default, **demands)
    )


def of_legs(
    book: Book,
    legs: LegType,
    name: str,
    path: str,
    unit: str,
    meaning: str,
    **demands: Unpack[Demands],
) -> tuple[sp.Expr, ...]:
    """A parameter over the legs of a type, by its path in a leg: symbols of its entries."""
    name, paths = f"{legs.name}_{name}", tuple(f"legs[{i}].{path}" for i in legs.indices)
    values = legs.over_legs(lambda leg: value_at(leg, path))
    shape = values.shape[1:]
    return book.parameters.add(
        ParameterField(name, legs.name, shape, unit, meaning, paths, values, **demands)
    )


def note(book: Book, symbol: Any, latex: str, meaning: str) -> Any:
    """Tell what an entry of a parameter is; returns its symbol."""
    book.note_quantity(Quantity(symbol.name, latex, meaning, parameter=True))
    return symbol


def value_at(leg: Leg, path: str) -> Any:
    """A value of a leg by its path, such as `joints[2].axis`."""
    value: Any = leg
    for part in path.split("."):
        name, _, index = part.partition("[")
        value = getattr(value, name)
        value = value[int(index[:-1])] if index else value
    return value
