"""Slices of the lowered statements: one function per purpose, in blocks around the leg loops."""

from __future__ import annotations

from collections import ChainMap
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from pne_sym.derivation import Derivation
from pne_sym.lowering.algebra import symbols
from pne_sym.lowering.builder import Builder
from pne_sym.lowering.closures import closures, given_displacements
from pne_sym.lowering.inputs import leg_inputs, unpack
from pne_sym.lowering.meaning import Meaning
from pne_sym.lowering.shapes import shapes
from pne_sym.lowering.simplify import inline_single_use, numbered, renamed, still_used
from pne_sym.lowering.statements import Guard, Statement
from pne_sym.program.ir import (
    VECTORS,
    Assignment,
    Block,
    Check,
    Function,
    Kind,
    LegInput,
    Program,
    Stage,
    Store,
)


class Slice:
    """The statements that a function needs."""

    def __init__(
        self, name: str, arrays: tuple[str, ...], stores: list[tuple[Stage, Store]]
    ) -> None:
        self.name = name
        self.arrays = arrays
        self.stores = stores
        self.guards: list[Guard] | None = None  # None: those of the equations that are needed

    def roots(self, builder: Builder) -> tuple[set[Any], list[Guard]]:
        """Symbols whose values are wanted, and the guards that concern these and what they need."""
        wanted = set().union(*(symbols(sp.sympify(store.value)) for _, store in self.stores))
        made = builder.needed(wanted)
        needed = wanted.union(*(symbols(s.expr) for s in made))
        equations = {s.equation for s in made if s.stage.depends_on_state}
        guards = self.guards or [
            g for g in builder.guards if g.equation in equations and symbols(g.value) <= needed
        ]
        return wanted.union(*(symbols(g.scale) for g in guards)), guards


@dataclass
class _Sliced:
    """A slice with its statements, and the symbols that it uses."""

    part: Slice
    run: list[Statement]
    guards: list[Any]
    used: set[Any]
    constants: set[Any]

    @property
    def uses(self) -> list[tuple[Any, str]]:
        """Expressions with their equations, where they say something of what they use."""
        found = [(s.expr, s.equation) for s in self.run]
        found += [(store.value, store.equation) for _, store in self.part.stores]
        return found + [(e, g.equation) for g in self.guards for e in (g.value, g.scale)]


def program_of(
    derivation: Derivation, builder: Builder, slices: list[Slice], meaning: Meaning
) -> Program:
    """The program of slices: what is prepared once for all, and a function for each."""
    leg_types = [t.name for t in derivation.leg_types]
    run, sliced = _sliced(builder, slices, meaning)
    constants = set().union(*(s.constants for s in sliced))
    stores = [
        (builder.stage_of(s), Store(s.name, s, 0)) for s in sorted(constants, key=lambda s: s.name)
    ]
    statements = inline_single_use(builder.needed(constants), stores, [])
    outside = set(builder.given_names())
    statements = meaning.told(statements, [use for s in sliced for use in s.uses])
    ids = {s.target: s.equation for s in statements}
    names = numbered(statements, outside, meaning.stem)
    means = meaning.by_name(statements, names)
    stores = [(at, replace(s, equation=ids.get(s.value, ""))) for at, s in stores]
    statements, stores, _ = renamed(names, statements, stores, [])
    stores = sorted(
        ((at, replace(s, array=s.value.name)) for at, s in stores), key=lambda item: item[1].array
    )
    prepare = _blocks(statements, stores, [], leg_types, parameters=True)
    listed = tuple((store.array, at.leg_type) for at, store in stores)
    reserved = outside | {name for name, _ in listed} | _input_names(derivation)
    names |= numbered(run, reserved, lambda s, made: meaning.stem(s, ChainMap(made, names)))
    functions = {s.part.name: _function(derivation, builder, s, names, meaning) for s in sliced}
    return Program(
        prepare,
        listed,
        functions,
        shapes(derivation),
        dict(builder.leg_counts),
        closures(derivation),
        given_displacements(derivation),
        means=means,
        lowered=meaning.shown(),
    )


def _sliced(
    builder: Builder, parts: list[Slice], meaning: Meaning
) -> tuple[list[Statement], list[_Sliced]]:
    """All statements of the slices, and each slice with its own of these.

    What is written where it is used, and what values are called, is decided for all slices
    together: what they have in common is the same text in each.
    """
    guarded = [part.roots(builder) for part in parts]
    wanted = set[Any]().union(*(roots for roots, _ in guarded))
    stores = list(dict.fromkeys(store for part in parts for store in part.stores))
    guards = list(dict.fromkeys(g for _, found in guarded for g in found))
    run = [s for s in builder.needed(wanted) if s.stage.depends_on_state]
    run = inline_single_use(run, stores, guards)
    uses = [(store.value, store.equation) for _, store in stores]
    run = meaning.told(run, uses + [(e, g.equation) for g in guards for e in (g.value, g.scale)])
    found = []
    for part, (_, own) in zip(parts, guarded, strict=True):
        needed = still_used(run, part.stores, own)
        used = _used(needed, part.stores, own)
        constants = {s for s in used if not builder.stage_of(s).depends_on_state}
        found.append(_Sliced(part, needed, own, used, constants))
    return run, found


def _used(
    statements: list[Statement], stores: list[tuple[Stage, Store]], guards: list[Any]
) -> set[Any]:
    expressions = [s.expr for s in statements]
    expressions += [sp.sympify(store.value) for _, store in stores]
    expressions += [e for g in guards for e in (g.value, g.scale)]
    return {symbol for e in expressions for symbol in symbols(e)}


def _function(
    derivation: Derivation,
    builder: Builder,
    sliced: _Sliced,
    names: dict[Any, Any],
    meaning: Meaning,
) -> Function:
    vectors, assignments, checks = _unpacked(derivation, sliced)
    per_leg = _read_per_leg(derivation, builder, sliced)
    vectors |= {entry.vector for read in per_leg.values() for entry in read}
    run, stores, guards = renamed(names, sliced.run, sliced.part.stores, sliced.guards)
    constants = {names.get(s, s).name: builder.stage_of(s).leg_type for s in sliced.constants}
    leg_types = [t.name for t in derivation.leg_types]
    return Function(
        sliced.part.name,
        tuple(v for v in VECTORS if v in vectors),
        sliced.part.arrays,
        tuple(assignments),
        tuple(checks),
        _blocks(run, stores, guards, leg_types),
        {t: tuple(found) for t, found in per_leg.items()},
        tuple(sorted(n for n, leg in constants.items() if not leg)),
        {t: tuple(sorted(n for n, leg in constants.items() if leg == t)) for t in leg_types},
        meaning.by_name(sliced.run, names),
    )


def _input_names(derivation: Derivation) -> set[str]:
    """Names of what is read from inputs."""
    return {a.target.name for named, _ in unpack(derivation).values() for a in named}


def _unpacked(
    derivation: Derivation, sliced: _Sliced
) -> tuple[set[str], list[Assignment], list[Check]]:
    """Inputs of which a slice uses something, and what is read from them and must hold of it."""
    assert derivation.coordinates is not None
    vectors, assignments, checks = set[str](), list[Assignment](), list[Check]()
    for vector, (named, conditions) in unpack(derivation).items():
        wanted = {a.target for a in named if a.target in sliced.used}
        if wanted and vector == "base":  # what must hold of a rotation, whatever is used of it
            wanted |= {c.value for c in conditions}
        chain = _closure_of(named, wanted)
        read = [a for a in named if a.target in chain]
        if read:
            vectors.add(vector)
            assignments += read
            checks += [c for c in conditions if c.value in chain]
    return vectors, assignments, checks


def _read_per_leg(
    derivation: Derivation, builder: Builder, sliced: _Sliced
) -> dict[str, list[LegInput]]:
    """What a slice reads for each leg of a type."""
    found: dict[str, list[LegInput]] = {}
    for symbol in sorted(sliced.used, key=lambda s: s.name):
        stage = builder.stage_of(symbol)
        if stage.kind is Kind.STATE_LEG and builder.maker(symbol) is None:
            vector, indices = leg_inputs(derivation, symbol.name)
            found.setdefault(stage.leg_type, []).append(LegInput(symbol, vector, indices))
    return found


def _closure_of(assignments: list[Assignment], wanted: set[Any]) -> set[Any]:
    made = {a.target: a.expr for a in assignments}
    needed: set[Any] = set()
    stack = list(wanted)
    while stack:
        symbol = stack.pop()
        if symbol not in needed:
            needed.add(symbol)
            stack.extend(symbols(made[symbol]) if symbol in made else ())
    return needed


def _blocks(
    statements: list[Statement],
    stores: list[tuple[Stage, Store]],
    guards: list[Any],
    leg_types: list[str],
    *,
    parameters: bool = False,
) -> tuple[Block, ...]:
    kinds = (
        (Kind.PARAMETER, Kind.PARAMETER_LEG, Kind.PARAMETER_TOTAL)
        if parameters
        else (Kind.STATE, Kind.STATE_LEG, Kind.TOTAL)
    )
    stages = [Stage(kinds[0]), *(Stage(kinds[1], t) for t in leg_types), Stage(kinds[2])]
    blocks = []
    for stage in stages:
        own = [s for s in statements if s.stage == stage and not s.total_of]
        totals = [s for s in statements if s.total_of and s.total_of == stage.leg_type]
        blocks.append(
            Block(
                stage.leg_type,
                tuple(Assignment(s.target, s.expr, s.equation) for s in own),
                tuple(
                    Check(g.status, g.value, g.scale, g.power, g.equation)
                    for g in guards
                    if g.stage == stage
                ),
                tuple((s.target, s.expr) for s in totals),
                tuple(store for at, store in stores if at == stage),
                tuple(s.equation for s in totals),
            )
        )
    return tuple(b for b in blocks if b.assignments or b.stores or b.sums or b.checks)
