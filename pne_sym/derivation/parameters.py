"""The live parameters of a derivation: fields, and the symbols of their entries."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

_AXES = "xyz"


class NameTakenError(ValueError):
    """Two quantities of one name."""

    def __init__(self, name: str) -> None:
        super().__init__(f"the name {name!r} is already used")
        self.name = name


class Rule(enum.StrEnum):
    """What the values of a parameter must be, beyond finite: as the reader demands of a spec."""

    FREE = "free"
    MASS = "mass"
    """Not negative."""
    INERTIA = "inertia"
    """Symmetric, and without negative principal moments."""
    PLANAR_INERTIA = "planar_inertia"
    """izz not negative; other entries do not count."""
    ROTATION = "rotation"
    """Orthonormal rows, determinant +1."""
    PLANAR_ROTATION = "planar_rotation"
    """A rotation about z."""
    UNIT = "unit"
    """Of length 1."""
    POSITIVE = "positive"
    """At least `values.SNAP`: its square must not vanish."""
    NONZERO = "nonzero"
    """Of that size at least."""
    INVERTIBLE = "invertible"
    """A matrix with an inverse."""


@dataclass(frozen=True)
class ParameterField:
    """One named parameter of the generated model.

    Attributes:
        name: field name in `Parameters` and in the C structure.
        leg_type: name of the leg type whose legs it runs over, or None.
        shape: shape of one leg's entry (or of the whole when not over legs).
        unit: SI unit.
        meaning: in words, with the frame.
        paths: where it stands in the full form, one path per leg.
        default: values of the specification, (legs,) + shape or shape.
        zeros: flat indices (of one leg's entry) that are zero by structure.
        rule: what its values must be.
    """

    name: str
    leg_type: str | None
    shape: tuple[int, ...]
    unit: str
    meaning: str
    paths: tuple[str, ...]
    default: NDArray[np.float64]
    zeros: tuple[int, ...] = ()
    rule: Rule = Rule.FREE

    @property
    def size(self) -> int:
        """Number of entries of one leg (or of the whole)."""
        return int(np.prod(self.shape, dtype=int))


@dataclass(frozen=True)
class AxisRelation:
    """Axes of a leg that are perpendicular or parallel by structure: live ones must stay so.

    Attributes:
        leg_type: whose legs' axes these are.
        first: name of the field of an axis.
        second: that of the other, or its components where these are fixed.
        cosine: 0, 1 or -1.
    """

    leg_type: str
    first: str
    second: str | tuple[int, ...]
    cosine: int


@dataclass
class ParameterTable:
    """All fields, and which symbol is which entry.

    Attributes:
        fields: in the order of the generated structure.
        entries: symbol name -> (field, flat index).
        branches: symbol name -> sign (+1 or -1) per leg; fixed at generation.
        relations: between live axes, and between these and fixed ones.
    """

    fields: list[ParameterField] = field(default_factory=list)
    entries: dict[str, tuple[ParameterField, int]] = field(default_factory=dict)
    branches: dict[str, tuple[str, tuple[int, ...]]] = field(default_factory=dict)
    relations: list[AxisRelation] = field(default_factory=list)

    def add(self, parameter: ParameterField) -> tuple[sp.Expr, ...]:
        """Add a field; returns its entries' symbols, zeros where the structure says so.

        Raises:
            NameTakenError: another field has the name, or an entry of another.
        """
        self.fields.append(parameter)
        symbols: list[sp.Expr] = []
        for index in range(parameter.size):
            if index in parameter.zeros:
                symbols.append(sp.S.Zero)
                continue
            symbol = sp.Symbol(entry_name(parameter, index), real=True)
            if symbol.name in self.entries:
                raise NameTakenError(symbol.name)
            self.entries[symbol.name] = (parameter, index)
            symbols.append(symbol)
        return tuple(symbols)

    def values(self, given: Mapping[str, Any] | None = None) -> dict[str, NDArray[np.float64]]:
        """Every entry by name, and the signs of the branches: a number, or (legs,).

        Args:
            given: the parameters by name; None for their defaults.
        """
        found: dict[str, NDArray[np.float64]] = {
            name: np.asarray(of.default if given is None else given[of.name], dtype=float).reshape(
                -1, of.size
            )[:, index]
            for name, (of, index) in self.entries.items()
        }
        found = {n: v if self.entries[n][0].leg_type else v[0] for n, v in found.items()}
        signs = {n: np.array(v, dtype=float) for n, (_, v) in self.branches.items()}
        return found | signs

    def add_branch(self, name: str, leg_type: str, signs: tuple[int, ...]) -> sp.Symbol:
        """Add a sign per leg that is fixed at generation."""
        symbol = sp.Symbol(name, real=True)
        self.branches[name] = (leg_type, signs)
        return symbol


def entry_name(parameter: ParameterField, index: int) -> str:
    """Name of one entry: field_x, field_xy, field_1_2 of what has no axes, or the field's own."""
    name, shape = parameter.name, parameter.shape
    if parameter.rule is Rule.INVERTIBLE:
        row, column = divmod(index, shape[1])
        return f"{name}_{row + 1}_{column + 1}"
    if shape == ():
        return name
    if shape == (3,):
        return f"{name}_{_AXES[index]}"
    if shape == (3, 3):
        return f"{name}_{_AXES[index // 3]}{_AXES[index % 3]}"
    return f"{name}_{index}"
