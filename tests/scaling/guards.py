"""The guards of a program in numbers: value and scale of every check, leg by leg."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from types import CodeType
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.scalar import PYTHON, ScalarPrinter
from pne_sym.derivation import ParameterField
from pne_sym.program.ir import Block, Check, Function

_PRINTER = ScalarPrinter(PYTHON)
_MATH = {"sqrt": lambda x: math.sqrt(x) if x >= 0 else math.nan}
_MATH |= {"sin": math.sin, "cos": math.cos, "atan2": math.atan2, "abs": abs, "min": min}

Values = dict[str, float]


class Tested(NamedTuple):
    """A check at a state.

    Attributes:
        function, leg, check: where it stands; the leg is a number within its type.
        value, scale: what is compared; a squared value comes with a squared scale.
    """

    function: str
    leg: int
    check: Check
    value: float
    scale: float

    @property
    def pivot(self) -> float:
        """The value over its scale, a ratio of lengths (not of their squares)."""
        return (abs(self.value) / self.scale) ** (1.0 / self.check.power)


class Guards:
    """The checks of a model's program at given parameters and states."""

    def __init__(self, bundle: Bundle) -> None:
        self.bundle = bundle
        self.table = bundle.derivation.parameters
        self.code: dict[int, CodeType] = {}

    def at(self, parameters: Mapping[str, Any], vectors: Mapping[str, Any]) -> list[Tested]:
        """Every check of every function, at X, V, A and q."""
        shared, legs = self._prepared(parameters)
        found: list[Tested] = []
        for function in self.bundle.program.functions.values():
            found += self._function(function, dict(shared), legs, vectors)
        return found

    def _prepared(self, parameters: Mapping[str, Any]) -> tuple[Values, dict[str, list[Values]]]:
        shared: Values = {}
        legs = {t: [Values() for _ in range(n)] for t, n in self.bundle.leg_counts.items()}
        for name, (field, index) in self.table.entries.items():
            values = np.asarray(parameters[field.name], dtype=float)
            if field.leg_type:
                for own, row in zip(legs[field.leg_type], values, strict=True):
                    own[name] = _entry(field, row, index)
            else:
                shared[name] = _entry(field, values, index)
        for name, (leg_type, signs) in self.table.branches.items():
            for own, sign in zip(legs[leg_type], signs, strict=True):
                own[name] = float(sign)
        for block in self.bundle.program.prepare:
            for own, _ in self._run(block, shared, legs):
                store = legs[block.leg_type] if block.leg_type else [shared]
                for s in block.stores:
                    store[own][s.array] = store[own][str(s.value)]
        return shared, legs

    def _function(
        self,
        function: Function,
        shared: Values,
        legs: Mapping[str, list[Values]],
        vectors: Mapping[str, Any],
    ) -> Iterator[Tested]:
        for vector in function.inputs:
            shared |= {f"{vector}_{k}": float(v) for k, v in enumerate(vectors[vector])}
        own = {t: [dict(v) for v in values] for t, values in legs.items()}
        for leg_type, entries in function.leg_inputs.items():
            for entry in entries:
                for leg, index in enumerate(entry.indices):
                    own[leg_type][leg][str(entry.symbol)] = float(vectors[entry.vector][index])
        exec(self._code(function, function.unpack), dict(_MATH), shared)
        for block in function.blocks:
            for leg, scope in self._run(block, shared, own):
                for check in block.checks:
                    value, scale = (
                        float(eval(_PRINTER.doprint(e), dict(_MATH), scope))
                        for e in (check.value, check.scale)
                    )
                    yield Tested(function.name, leg, check, value, scale)

    def _run(
        self, block: Block, shared: Values, legs: Mapping[str, list[Values]]
    ) -> Iterator[tuple[int, Values]]:
        """The scopes of a block after its assignments; sums go to the shared values."""
        scopes = [{**shared, **v} for v in legs[block.leg_type]] if block.leg_type else [shared]
        for leg, scope in enumerate(scopes):
            exec(self._code(block, block.assignments), dict(_MATH), scope)
            if block.leg_type:
                legs[block.leg_type][leg].update(scope)
            for target, value in block.sums:
                term = float(eval(_PRINTER.doprint(sp.sympify(value)), dict(_MATH), scope))
                shared[str(target)] = shared.get(str(target), 0.0) + term
            yield leg, scope

    def _code(self, owner: object, assignments: Iterable[Any]) -> CodeType:
        if id(owner) not in self.code:
            lines = [f"{a.target} = {_PRINTER.doprint(sp.sympify(a.expr))}" for a in assignments]
            self.code[id(owner)] = compile("\n".join(lines), "<block>", "exec")
        return self.code[id(owner)]


def _entry(field: ParameterField, values: Any, index: int) -> float:
    return float(np.reshape(values, -1)[index]) if field.shape else float(values)
