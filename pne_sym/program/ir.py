"""The program: what is computed when, for which function."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import sympy as sp


@dataclass(frozen=True, order=True)
class Stage:
    """When a value can be computed.

    Attributes:
        depends_on_state: needs X, V, A (else parameters alone).
        leg_type: per leg of this type; "" when not per leg.
        after_legs: needs a sum over legs.
    """

    depends_on_state: bool = False
    leg_type: str = ""
    after_legs: bool = False

    @property
    def per_leg(self) -> bool:
        """Whether there is one value per leg."""
        return bool(self.leg_type)

    def after_sum(self) -> Stage:
        """Stage of the sum of such values over the legs."""
        return Stage(self.depends_on_state, "", True)

    @staticmethod
    def join(stages: Iterable[Stage]) -> Stage:
        """Stage of an expression made of values of these stages.

        Raises:
            ValueError: values of two leg types meet outside a sum.
        """
        state, legs, after = False, set(), False
        for stage in stages:
            state |= stage.depends_on_state
            after |= stage.after_legs and stage.depends_on_state
            if stage.leg_type:
                legs.add(stage.leg_type)
            if stage.after_legs and not stage.depends_on_state:
                after_parameters = True
            else:
                after_parameters = False
            after |= after_parameters and not state
        if len(legs) > 1:
            raise ValueError(f"values of several leg types meet: {sorted(legs)}")
        leg = legs.pop() if legs else ""
        return Stage(state, leg, after and not leg)


@dataclass(frozen=True)
class Assignment:
    """target = expr, tagged with the equation it belongs to."""

    target: sp.Symbol
    expr: Any
    equation: str


@dataclass(frozen=True)
class Check:
    """A guard: failing means the state is impossible.

    UNREACHABLE: value >= 0.  SINGULAR: |value| > tolerance^power * scale.
    """

    trouble: str
    value: Any
    scale: Any
    power: int
    equation: str


@dataclass(frozen=True)
class Store:
    """An entry of an output array.

    For a value per leg, `row` and `column` are tables over the legs of the type.
    """

    array: str
    value: Any
    row: int | tuple[int, ...]
    column: int | tuple[int, ...] | None = None


@dataclass(frozen=True)
class Block:
    """A run of statements: before the legs, over the legs of a type, or after.

    Attributes:
        leg_type: name of the leg type looped over, or "".
        assignments: in order.
        checks: guards evaluated at the end of the block.
        sums: (target, value) accumulated over the legs.
        stores: outputs written.
    """

    leg_type: str
    assignments: tuple[Assignment, ...]
    checks: tuple[Check, ...] = ()
    sums: tuple[tuple[sp.Symbol, Any], ...] = ()
    stores: tuple[Store, ...] = ()


@dataclass(frozen=True)
class Counts:
    """Operations; those of a leg loop count once per leg."""

    mul: int = 0
    add: int = 0
    div: int = 0
    sqrt: int = 0
    trig: int = 0

    @property
    def total(self) -> int:
        """Multiplications, additions, divisions and roots (no trigonometric calls)."""
        return self.mul + self.add + self.div + self.sqrt

    def __add__(self, other: Counts) -> Counts:
        return Counts(self.mul + other.mul, self.add + other.add, self.div + other.div,
                      self.sqrt + other.sqrt, self.trig + other.trig)

    def times(self, n: int) -> Counts:
        """n times these operations."""
        return Counts(n * self.mul, n * self.add, n * self.div, n * self.sqrt, n * self.trig)


@dataclass(frozen=True)
class Function:
    """A generated computation: inputs to output arrays.

    Attributes:
        name: such as "dynamics".
        inputs: names of input vectors, in order ("X", "V", "A").
        arrays: output arrays (name, shape).
        blocks: in order of execution.
        prepared: names of prepared values that it reads.
    """

    name: str
    inputs: tuple[str, ...]
    arrays: tuple[tuple[str, tuple[int, ...]], ...]
    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Program:
    """All functions of a model and the preparation of its parameters.

    Attributes:
        prepare: computes the prepared values from the parameters.
        prepared: prepared values read at run time: (name, leg type or "").
        functions: by name.
    """

    prepare: Function
    prepared: tuple[tuple[str, str], ...]
    functions: dict[str, Function] = field(default_factory=dict)
