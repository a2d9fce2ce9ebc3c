"""The gate behind the lowering: what back ends and readers may rely on.

Every value is assigned once and before it is used, every entry of an output is written at most
once (what is not written is zero), every statement carries the id of its equation, and
expressions are made of a closed set of nodes, so that no power function is ever printed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Any

import sympy as sp

from pne_sym.program.ir import VECTORS, Block, Check, Function, Program, Store
from pne_sym.program.slices import places_of

_FUNCTIONS = (sp.sin, sp.cos, sp.atan2, sp.acos, sp.Abs, sp.Min)
_ROOTS = (sp.Rational(1, 2), sp.Rational(-1, 2))
_STATUSES = ("invalid", "unreachable", "singular")


class ProgramError(Exception):
    """A program that must not be printed."""


def verify(program: Program, parameters: Mapping[str, str]) -> None:
    """Check a whole program.

    Args:
        program: as lowered.
        parameters: entries of parameters and signs of branches -> leg type, or "".

    Raises:
        ProgramError: what is wrong, in which function and statement.
    """
    scope = _Scope("prepare", {}, parameters.items())
    scope.blocks(program.prepare, None)
    prepared = dict(program.prepared)
    scope.require(len(prepared) == len(program.prepared), "a value is prepared twice")
    for name, leg_type in program.prepared:
        scope.use([sp.Symbol(name, real=True)], leg_type, f"prepared value {name}")
    for name, function in program.functions.items():
        _verify_function(name, function, program.shapes, prepared)


def _verify_function(name: str, f: Function, shapes: Any, prepared: Mapping[str, str]) -> None:
    given = [(n, leg) for leg, names in {"": f.shared, **f.per_leg}.items() for n in names]
    scope = _Scope(name, shapes, given)
    scope.require(f.name == name, f"calls itself {f.name!r}")
    for value, leg_type in given:
        scope.require(prepared.get(value) == leg_type, f"{value} is not a prepared value")
    scope.require(set(f.inputs) <= set(VECTORS), f"inputs are {f.inputs}")
    scope.entries = tuple(f"{vector}_" for vector in f.inputs)
    for a in f.unpack:
        scope.assign(a.target, a.expr, "", a.equation)
    scope.checks(f.unpack_checks, "")
    scope.entries = ()
    for leg_type, entry in ((leg, e) for leg in f.leg_inputs for e in f.leg_inputs[leg]):
        scope.require(entry.vector in f.inputs, f"{entry.symbol} is no input")
        scope.introduce(entry.symbol, leg_type)
    scope.blocks(f.blocks, f.arrays)


class _Scope:
    """The names known so far: everywhere (""), and within the loop over a leg type."""

    def __init__(self, function: str, shapes: Mapping[str, tuple[int, ...]], given: Any) -> None:
        self.function, self.shapes = function, shapes
        self.known: dict[str, str] = dict(given)
        self.entries: tuple[str, ...] = ()  # prefixes of input entries
        self.written: set[tuple[str, int, int]] = set()

    def require(self, condition: bool, *message: object) -> None:
        """Raise where the condition fails; only then is the message made."""
        if not condition:
            raise ProgramError(f"{self.function}: " + "".join(map(str, message)))

    def introduce(self, symbol: Any, leg_type: str) -> None:
        name = getattr(symbol, "name", "")
        real = isinstance(symbol, sp.Symbol) and _nodes(symbol)[1] == ((name, True),)
        self.require(real, symbol, " is not a real symbol")
        self.require(name not in self.known, name, " is assigned twice")
        self.known[name] = leg_type

    def use(self, expressions: Iterable[Any], leg_type: str, *what: object) -> None:
        """Require known nodes, and symbols that are defined before."""
        for strange, symbols in map(_nodes, map(sp.sympify, expressions)):
            self.require(not strange, *what, ": ", *strange[:1], " is outside the closed set")
            for name, is_real in symbols:
                vector, line, number = name.rpartition("_")
                entry = vector + line in self.entries and number.isdigit()
                defined = entry or self.known.get(name) in ("", leg_type)
                self.require(defined, *what, ": ", name, " is not defined before")
                self.require(is_real, *what, ": ", name, " is not real")

    def assign(self, target: Any, expr: Any, leg_type: str, equation: str) -> None:
        self.require(bool(equation), target, " = ", expr, ": no equation id")
        self.use([expr], leg_type, target, " = ", expr)
        self.introduce(target, leg_type)

    def checks(self, checks: Iterable[Check], leg_type: str) -> None:
        for check in checks:
            what = ("check of ", check.value)
            self.require(check.status in _STATUSES, *what, ": status ", check.status)
            self.require(bool(check.equation), *what, ": no equation id")
            self.require(check.power in (1, 2), *what, ": power ", check.power)
            self.use([check.value, check.scale], leg_type, *what)

    def blocks(self, blocks: Iterable[Block], arrays: tuple[str, ...] | None) -> None:
        """Blocks in order; sums are known behind the loops (arrays None: nothing is stored)."""
        looped, totals = set[str](), list[Any]()
        for block in blocks:
            leg_type = block.leg_type
            self.require(leg_type not in looped, f"two loops over {leg_type!r}")
            looped |= {leg_type} - {""}
            while totals and not leg_type:
                self.introduce(totals.pop(), "")
            for a in block.assignments:
                self.assign(a.target, a.expr, leg_type, a.equation)
            self.checks(block.checks, leg_type)
            self.require(bool(leg_type) or not block.sums, "a sum over no legs")
            for s in block.sums:
                self.require(bool(s.equation), "a sum without an equation id")
                self.use([s.expr], leg_type, f"sum {s.target}")
                totals.append(s.target)
            for store in block.stores if arrays is not None else ():
                self.use([store.value], leg_type, f"output {store.array}")
                self.require(store.array in (arrays or ()), f"{store.array} is not an output")
                self.require(bool(store.equation), f"output {store.array}: no equation id")
                self._write(store)
        for symbol in totals:
            self.introduce(symbol, "")

    def _write(self, store: Store) -> None:
        shape, tables = self.shapes[store.array], (store.row, store.column)
        legs = {len(i) for i in tables if isinstance(i, tuple)} or {1}
        self.require(len(legs) == 1, f"{store.array}: uneven tables of places")
        for place in places_of(store, *legs):
            where = f"{store.array}{list(place)}"
            inside = all(0 <= i < n for i, n in zip(place, (*shape, 1), strict=False))
            self.require(inside, f"{where} is outside the shape {shape}")
            self.require((store.array, *place) not in self.written, f"{where} is written twice")
            self.written.add((store.array, *place))


@lru_cache(1 << 16)  # functions share statements
def _nodes(expr: Any) -> tuple[tuple[Any, ...], tuple[tuple[str, bool], ...]]:
    """Nodes outside the closed set; names of the symbols, and whether they are real ones."""
    nodes = dict.fromkeys(sp.preorder_traversal(expr))
    symbols = [n for n in nodes if n.is_Symbol]
    return (
        tuple(n for n in nodes if not _is_allowed(n)),
        tuple((n.name, n == sp.Symbol(n.name, real=True)) for n in symbols),
    )


def _is_allowed(node: Any) -> bool:
    if node.is_Pow:
        return bool(node.exp.is_Integer) or node.exp in _ROOTS
    if node.is_Number:
        return bool(node.is_finite)
    return bool(node.is_Symbol or node.is_Add or node.is_Mul) or isinstance(node, _FUNCTIONS)
