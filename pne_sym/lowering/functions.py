"""Slices of the lowered statements: one function per purpose, in blocks around the leg loops."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from pne_sym.derivation import Derivation
from pne_sym.lowering.algebra import symbols
from pne_sym.lowering.builder import Builder
from pne_sym.lowering.inputs import closures, given_displacements, leg_inputs, unpack
from pne_sym.lowering.meaning import Meaning
from pne_sym.lowering.shapes import shapes
from pne_sym.lowering.simplify import inline_single_use, numbered, renamed, still_used
from pne_sym.lowering.statements import End, Statement, read_by, rewritten
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

    def __init__(self, name: str, arrays: tuple[str, ...], stores: list[Store]) -> None:
        self.name = name
        self.arrays = arrays
        self.stores = stores
        self.guards: list[Check] | None = None  # None: those of the equations that are needed

    def roots(self, builder: Builder) -> tuple[set[Any], list[Check]]:
        """Symbols whose values are wanted, and the guards that concern these and what they need."""
        wanted = read_by(self.stores)
        made = builder.needed(wanted)
        needed = wanted | read_by(made)
        equations = {s.equation for s in made if s.stage.depends_on_state}
        guards = self.guards or [
            g for g in builder.guards if g.equation in equations and symbols(g.value) <= needed
        ]
        return wanted.union(*(symbols(g.scale) for g in guards)), guards


@dataclass
class _Sliced:
    """A slice with its statements, what becomes of them, and the symbols that it uses."""

    part: Slice
    run: list[Statement]
    ends: list[End]
    used: set[Any]
    constants: set[Any]


def program_of(
    derivation: Derivation, builder: Builder, slices: list[Slice], meaning: Meaning
) -> Program:
    """The program of slices: what is prepared once for all, and a function for each."""
    leg_types = [t.name for t in derivation.leg_types]
    run, sliced = _sliced(builder, slices, meaning)
    constants = set().union(*(s.constants for s in sliced))
    stores = [Store("", s, 0, stage=builder.stage_of(s)) for s in constants]
    statements = inline_single_use(builder.needed(constants), stores)
    outside = set(builder.given_names())
    statements = meaning.told(statements, [use for s in sliced for use in (*s.run, *s.ends)])
    ids = {s.target: s.equation for s in statements}
    names = numbered(statements, outside, meaning.stem)
    means = meaning.by_name(statements, names)
    stores = [rewritten(replace(s, equation=ids.get(s.value, "")), names) for s in stores]
    stores = sorted((replace(s, array=s.value.name) for s in stores), key=lambda s: s.array)
    prepare = _blocks(renamed(names, statements), stores, leg_types)
    listed = tuple((store.array, store.stage.leg_type) for store in stores)
    reserved = outside | {name for name, _ in listed} | _input_names(derivation)
    names |= numbered(run, reserved, lambda s, made: meaning.stem(s, ChainMap(made, names)))
    called = dict(zip((s.target for s in run), renamed(names, run), strict=True))
    functions = {
        s.part.name: _function(derivation, builder, s, names, called, meaning) for s in sliced
    }
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
    ends: list[list[End]] = [
        [*part.stores, *guards] for part, (_, guards) in zip(parts, guarded, strict=True)
    ]
    run = [s for s in builder.needed(wanted) if s.stage.depends_on_state]
    every = list(dict.fromkeys(end for own in ends for end in own))
    run = meaning.told(inline_single_use(run, every), every)
    found = []
    for part, own in zip(parts, ends, strict=True):
        needed = still_used(run, own)
        used = read_by((*needed, *own))
        constants = {s for s in used if not builder.stage_of(s).depends_on_state}
        found.append(_Sliced(part, needed, own, used, constants))
    return run, found


def _function(
    derivation: Derivation,
    builder: Builder,
    sliced: _Sliced,
    names: dict[Any, Any],
    called: dict[Any, Statement],
    meaning: Meaning,
) -> Function:
    vectors, assignments, checks = _unpacked(derivation, sliced)
    per_leg = _read_per_leg(derivation, builder, sliced)
    vectors |= {entry.vector for read in per_leg.values() for entry in read}
    run = [called[s.target] for s in sliced.run]
    ends = [rewritten(end, names) for end in sliced.ends]
    constants = {names.get(s, s).name: builder.stage_of(s).leg_type for s in sliced.constants}
    leg_types = [t.name for t in derivation.leg_types]
    return Function(
        sliced.part.name,
        tuple(v for v in VECTORS if v in vectors),
        sliced.part.arrays,
        tuple(assignments),
        tuple(checks),
        _blocks(run, ends, leg_types),
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
    statements: list[Statement], ends: Sequence[End], leg_types: list[str]
) -> tuple[Block, ...]:
    blocks = []
    of_legs = (Kind.PARAMETER_LEG, Kind.STATE_LEG)
    for stage in (Stage(k, t) for k in Kind for t in (leg_types if k in of_legs else [""])):
        own = [s for s in statements if s.stage == stage and not s.total_of]
        totals = [
            s for s in statements if (s.total_of, s.stage) == (stage.leg_type, stage.after_sum())
        ]
        here = [end for end in ends if end.stage == stage]
        blocks.append(
            Block(
                stage.leg_type,
                tuple(Assignment(s.target, s.expr, s.equation) for s in own),
                tuple(end for end in here if isinstance(end, Check)),
                tuple(Assignment(s.target, s.expr, s.equation) for s in totals),
                tuple(end for end in here if isinstance(end, Store)),
            )
        )
    return tuple(b for b in blocks if b.assignments or b.ends)
