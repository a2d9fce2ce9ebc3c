"""The interpreter: what a program means, on arrays over states and legs.

A value before or after the legs is an array (states,), a value of a leg type (legs, states),
prepared values (1,) and (legs, 1).  Nothing is printed and nothing is executed but NumPy, so that
what a back end prints can be compared with it, and every local value is there to be looked at.
"""

from __future__ import annotations

import enum
import math
import operator
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from pne_sym.program.ir import Assignment, Block, Check, Function, Program, Store
from pne_sym.program.slices import columns, flat_places

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

TOLERANCE = 2.0**-26
"""Lengths below this fraction of a leg's size count as zero: the root of the machine epsilon."""


class Status(enum.IntEnum):
    """Why a state is impossible; the numbers are those of the generated C."""

    OK = 0
    UNREACHABLE = 1
    SINGULAR = 2
    INVALID = 3
    NOT_CONVERGED = 4


@dataclass(frozen=True)
class Failure:
    """A guard that fails somewhere.

    Attributes:
        check: the guard.
        leg_type: whose legs it is about, or "".
        failed: where: (states,), or (legs, states).
    """

    check: Check
    leg_type: str
    failed: Flags


@dataclass(frozen=True)
class Evaluation:
    """A function of a program at some states.

    Attributes:
        outputs: array name -> (states, *shape); NaN where the state is impossible.
        status: `Status` of every state.
        values: every local value by name, (states,) or (legs, states), also where it is nonsense.
        failures: the guards that fail somewhere, in their order.
    """

    outputs: dict[str, Array]
    status: NDArray[np.int_]
    values: dict[str, Array]
    failures: tuple[Failure, ...]


def prepare(program: Program, given: Mapping[str, Array]) -> dict[str, Array]:
    """Values that depend on the parameters alone.

    Args:
        program: of the model.
        given: entries of the parameters and signs of the branches by name: numbers, or (legs,).

    Returns:
        every value by name, (1,) or (legs, 1), what was given among them.
    """
    values = {n: np.atleast_1d(np.asarray(v, dtype=float))[:, None] for n, v in given.items()}
    values = {n: v[0] if np.ndim(given[n]) == 0 else v for n, v in values.items()}
    legs = program.leg_counts
    with np.errstate(all="ignore"):
        for block in program.prepare:
            _assign(block.assignments, values)
            for s in block.sums:
                terms = np.broadcast_to(value_of(s.expr, values), (legs[block.leg_type], 1))
                values[s.target.name] = np.sum(terms, axis=0)
    return values


def evaluate(
    program: Program, name: str, prepared: Mapping[str, Array], vectors: Mapping[str, Array]
) -> Evaluation:
    """A function of a program at some states.

    Args:
        program: of the model.
        name: of the function.
        prepared: what `prepare` has found.
        vectors: the inputs by name, "X" (states, NQ) and so on; others than the function's are
            not looked at.

    Raises:
        KeyError: no such function, or an input is missing.
    """
    return _Run(program, program.functions[name], prepared, vectors).evaluation()


class _Run:
    """One function at some states, block by block."""

    def __init__(
        self,
        program: Program,
        function: Function,
        prepared: Mapping[str, Array],
        vectors: Mapping[str, Array],
    ) -> None:
        self.f = function
        self.legs = program.leg_counts
        self.inputs = {v: np.asarray(vectors[v], dtype=float) for v in function.inputs}
        self.states = next(iter(self.inputs.values())).shape[0] if self.inputs else 1
        self.values = {n: prepared[n] for n in function.shared}
        self.values |= {n: prepared[n] for names in function.per_leg.values() for n in names}
        self.outputs = {a: np.zeros((self.states, *program.shapes[a])) for a in function.arrays}
        self.failures: list[Failure] = []

    def evaluation(self) -> Evaluation:
        """Values, guards, outputs; one status for every state."""
        f = self.f
        with np.errstate(all="ignore"):
            for vector, entries in self.inputs.items():
                self.values |= {f"{vector}_{k}": entries[:, k] for k in range(entries.shape[1])}
            _assign(f.unpack, self.values)
            self._check(f.unpack_checks, "")
            for item in (item for items in f.leg_inputs.values() for item in items):
                self.values[item.symbol.name] = self.inputs[item.vector][:, list(item.indices)].T
            for block in f.blocks:
                self._block(block)
        status = self._status()
        for array in self.outputs.values():
            array[status != Status.OK] = np.nan
        return Evaluation(self.outputs, status, self.values, tuple(self.failures))

    def _block(self, block: Block) -> None:
        _assign(block.assignments, self.values)
        self._check(block.checks, block.leg_type)
        for s in block.sums:
            self.values[s.target.name] = np.sum(self._over_legs(s.expr, block.leg_type), axis=0)
        for store in block.stores:
            self._store(store, block.leg_type)

    def _over_legs(self, expr: Any, leg_type: str) -> Array:
        """Values (legs, states); one row where they are of no leg."""
        return np.broadcast_to(
            value_of(expr, self.values), (self.legs.get(leg_type, 1), self.states)
        )

    def _store(self, store: Store, leg_type: str) -> None:
        array, values = self.outputs[store.array], self._over_legs(store.value, leg_type)
        places = flat_places(store, columns(array.shape[1:]), len(values))
        flat = array.reshape(self.states, math.prod(array.shape[1:]))  # the same memory
        flat[:, places] = values.T

    def _check(self, checks: Iterable[Check], leg_type: str) -> None:
        shape = (self.legs[leg_type], self.states) if leg_type else (self.states,)
        for check in checks:
            value = value_of(check.value, self.values)
            if check.status == "singular":
                bound = TOLERANCE**check.power * value_of(check.scale, self.values)
                good = np.abs(value) > bound
            elif check.status == "invalid":
                good = (value > 0.0) & np.isfinite(value)
            else:
                good = value >= 0.0
            failed = ~np.broadcast_to(good, shape)
            if failed.any():
                self.failures.append(Failure(check, leg_type, failed))

    def _status(self) -> NDArray[np.int_]:
        """The first cause that holds: input, reach, singular, then what is not finite."""
        status = np.full(self.states, int(Status.OK))
        for array in self.outputs.values():
            own = tuple(range(1, array.ndim))
            status[~np.isfinite(array).all(axis=own)] = Status.INVALID
        for cause in (Status.SINGULAR, Status.UNREACHABLE, Status.INVALID):
            for failure in self.failures:
                if failure.check.status == cause.name.lower():
                    failed = failure.failed.reshape(-1, self.states).any(axis=0)
                    status[failed] = cause
        for entries in self.inputs.values():
            status[~np.isfinite(entries).all(axis=1)] = Status.INVALID
        return status


def _assign(assignments: Iterable[Assignment], values: dict[str, Array]) -> None:
    for a in assignments:
        values[a.target.name] = value_of(a.expr, values)


# ---- expressions -------------------------------------------------------------------------


def value_of(expr: Any, values: Mapping[str, Array]) -> Array:
    """A scalar expression of the closed set, at the values of its symbols.

    Raises:
        TypeError: the expression is outside the closed set.
        KeyError: a symbol has no value.
    """
    if isinstance(expr, int | float):
        return np.float64(expr)  # type: ignore[return-value]
    if expr.is_Symbol:
        return values[expr.name]
    if expr.is_Number:
        return np.float64(int(expr.p) / int(expr.q) if expr.is_Rational else float(expr))  # type: ignore[return-value]
    rule = _RULES.get(expr.func)
    if rule is None:
        raise TypeError(f"no {expr.func.__name__} in a program")
    return rule(expr, values)


def _product(expr: Any, values: Mapping[str, Array]) -> Array:
    """Factors, then divisors: 1/x is a division here as it is where it is printed."""
    top: Any = None
    divisors = []
    for factor in expr.args:
        if factor.is_Pow and factor.exp.is_negative:
            divisors.append(_power(factor.base, -factor.exp, values))
        else:
            value = value_of(factor, values)
            top = value if top is None else top * value
    for divisor in divisors:
        top = (1.0 if top is None else top) / divisor
    return np.asarray(top)


def _power(base: Any, exponent: Any, values: Mapping[str, Array]) -> Array:
    """A power with an exponent that is positive: a product, or a root."""
    value = value_of(base, values)
    if exponent == sp.S.Half:
        return np.asarray(np.sqrt(value))
    if not exponent.is_Integer:
        raise TypeError(f"no power {exponent} in a program")
    return math.prod([value] * (int(exponent) - 1), start=value)


def _signed_power(expr: Any, values: Mapping[str, Array]) -> Array:
    if expr.exp.is_negative:
        return 1.0 / _power(expr.base, -expr.exp, values)
    return _power(expr.base, expr.exp, values)


def _function(function: Callable[..., Any]) -> Callable[[Any, Mapping[str, Array]], Array]:
    return lambda expr, values: np.asarray(function(*(value_of(a, values) for a in expr.args)))


def _of_two(function: Callable[..., Any]) -> Callable[[Any, Mapping[str, Array]], Array]:
    """The function of the first two arguments, then of what it gives and the next."""
    return lambda expr, values: reduce(function, (value_of(a, values) for a in expr.args))


_RULES: dict[Any, Callable[[Any, Mapping[str, Array]], Array]] = {
    sp.Add: _of_two(operator.add),
    sp.Mul: _product,
    sp.Pow: _signed_power,
    sp.sin: _function(np.sin),
    sp.cos: _function(np.cos),
    sp.acos: _function(np.arccos),
    sp.atan2: _function(np.arctan2),
    sp.Abs: _function(np.abs),
    sp.Min: _of_two(np.minimum),  # not a number where one is none
}
