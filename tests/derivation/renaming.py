"""A derivation with other names for all that it names: quantities, components, parameters."""

from __future__ import annotations

import enum
from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from typing import Any

import sympy as sp

from pne_sym.derivation import Derivation, LegTypeInfo, ParameterField, Quantity
from pne_sym.derivation.parameters import AxisRelation, ParameterTable
from pne_sym.vector import TensorSymbol, VectorSymbol

Names = Callable[[str], str]
_NAMES = {
    Quantity: ("name", "remainder_of"),
    ParameterField: ("name",),
    AxisRelation: ("first", "second"),
    LegTypeInfo: ("orientation_sign",),
}
"""Fields that hold names; every other text is words, or the name of a frame, leg type or array."""


def renamed(derivation: Derivation, names: Names) -> Derivation:
    """The same derivation under other names, in the same order."""
    found: Derivation = _Renaming(names).of(derivation)
    return found


def all_names(derivation: Derivation) -> list[str]:
    """All that `renamed` gives another name, sorted."""
    seen = set[str]()

    def noted(name: str) -> str:
        seen.add(name)
        return name

    renamed(derivation, noted)
    return sorted(seen)


class _Renaming:
    def __init__(self, names: Names) -> None:
        self.names = names

    def of(self, item: Any) -> Any:
        """Anything that a derivation consists of."""
        if isinstance(item, sp.Basic):
            return self.expression(item)
        if isinstance(item, str | int | float | enum.Enum) or item is None:
            return item
        if isinstance(item, tuple | list):
            return type(item)(self.of(each) for each in item)
        if isinstance(item, ParameterTable):
            return self.table(item)
        if isinstance(item, dict):  # by name, or by symbol
            return {self.key(k): self.of(v) for k, v in item.items()}
        return self.record(item) if is_dataclass(item) else item

    def key(self, key: Any) -> Any:
        return self.name(key) if isinstance(key, str) else self.of(key)

    def name(self, name: Any) -> Any:
        return self.names(name) if isinstance(name, str) and name else name

    def record(self, item: Any) -> Any:
        named = _NAMES.get(type(item), ())
        changes = {}
        for field in fields(item):
            value = getattr(item, field.name)
            changes[field.name] = self.name(value) if field.name in named else self.of(value)
        return replace(item, **changes)

    def table(self, table: ParameterTable) -> ParameterTable:
        return ParameterTable(
            self.of(table.fields),
            {self.name(n): (self.record(of), k) for n, (of, k) in table.entries.items()},
            {self.name(n): branch for n, branch in table.branches.items()},
            self.of(table.relations),
        )

    def expression(self, expr: Any) -> Any:
        """With other symbols, rebuilt from the leaves: scalars, vectors, tensors."""
        if isinstance(expr, VectorSymbol):
            return VectorSymbol(self.names(expr.name))
        if isinstance(expr, TensorSymbol):
            return TensorSymbol(self.names(expr.name), expr.is_symmetric)
        if expr.is_Symbol:
            return sp.Symbol(self.names(expr.name), **expr.assumptions0)
        found = {symbol: self.expression(symbol) for symbol in _symbols(expr)}
        return expr.xreplace(found)


def _symbols(expr: Any) -> set[Any]:
    if isinstance(expr, VectorSymbol | TensorSymbol) or expr.is_Symbol:
        return {expr}
    return {symbol for arg in expr.args for symbol in _symbols(arg)}
