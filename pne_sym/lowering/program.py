"""Slices of the lowered statements: one function per purpose, in blocks around the leg loops."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from pne_sym.derivation import Derivation, Output
from pne_sym.lowering.algebra import replaced, symbols
from pne_sym.lowering.builder import Builder
from pne_sym.lowering.closures import closures, given_displacements
from pne_sym.lowering.components import Lowering
from pne_sym.lowering.coupling import with_coupling
from pne_sym.lowering.inputs import leg_inputs, unpack
from pne_sym.lowering.margins import Margins
from pne_sym.lowering.meaning import Meaning
from pne_sym.lowering.public import public_functions
from pne_sym.lowering.signs import settle
from pne_sym.lowering.simplify import inline_single_use, numbered, renamed
from pne_sym.lowering.statements import Atom, Guard, Statement
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
from pne_sym.program.verify import verify
from pne_sym.vector import Tensor, Vector

# Arrays of each function; functions of one group are lowered together, so that they share
# what they have in common.
GROUPS: tuple[tuple[tuple[str, tuple[str, ...]], ...], ...] = (
    (
        ("dynamics", ("M", "Z", "H", "Hk", "constraint_bias")),
        ("M", ("M",)),
        ("Z", ("Z",)),
        ("H", ("H",)),
        ("Hk", ("Hk",)),
        ("constraint_bias", ("constraint_bias",)),
    ),
    (
        ("required", ("required", "H", "Hk")),
        ("inverse_kinematics", ("q",)),
        ("joint_rates", ("qd",)),
        ("joint_accelerations", ("qdd",)),
        ("constraints", ("constraints",)),
        ("legs", ("leg_force", "actuator", "constraint_direction")),
    ),
    (("potential", ("potential",)),),
    (("dissipation", ("dissipation",)),),
    (("motors", ("motor_rates", "per_turn", "actuated_rates", "ratios", "coupling")),),
    (("joint_margins", ("margins",)),),
    (("effort_limits", ("effort_limits",)),),
    (("condition", ("lengths",)),),
)


def lower(derivation: Derivation) -> Program:
    """Lower a derivation to scalar code.

    Raises:
        SingularPatternError: a leg's degrees of freedom are dependent by structure.
    """
    builder = Builder()
    builder.quantity_of = {e.id: e.name for e in derivation.equations()}
    builder.leg_counts = {t.name: len(t.indices) for t in derivation.leg_types}
    _declare(derivation, builder)
    shapes = _shapes(derivation)
    slices, lowerings = [], []
    groups = with_coupling(GROUPS, {output.array for output in derivation.outputs})
    for group in (*groups, *_closure_groups(derivation)):
        together = {a for _, arrays in group for a in arrays}
        stores, lowering = _cheapest_stores(derivation, builder, together)
        lowerings.append(lowering)
        for name, arrays in group:
            chosen = [
                (stage, store)
                for output, found in stores.items()
                if output.array in arrays
                for stage, store in found
            ]
            # What is zero throughout, as the force of massless legs is, has no stores.
            present = tuple(a for a in arrays if 0 not in shapes.get(a, (0,)))
            if present:
                slices.append(_Slice(name, present, chosen))
    _add_margins(derivation, builder, {s.name: s for s in slices})
    meaning = Meaning(derivation, lowerings)
    _settle_signs(builder, meaning, slices)
    program = _program(derivation, builder, slices, meaning)
    table = derivation.parameters
    outside = {name: parameter.leg_type or "" for name, (parameter, _) in table.entries.items()}
    verify(program, outside | {name: leg for name, (leg, _) in table.branches.items()})
    return replace(program, public=public_functions(derivation, program))


def _add_margins(derivation: Derivation, builder: Builder, slices: dict[str, _Slice]) -> None:
    """H, Hk and the margins of all guards of M, Z, H and inverse dynamics join the lengths."""
    guards: list[Guard] = []
    for name in ("dynamics", "required"):
        known = {g.equation for g in guards}  # of the same values, lowered for other functions
        guards += [g for g in slices[name].roots(builder)[1] if g.equation not in known]
    margins = Margins(derivation, builder, guards)
    made = slices["condition"]
    made.arrays = ("H", *(("Hk",) if "Hk" in slices else ()), *made.arrays, "pivots", "reach")
    matrices = [store for name in ("H", "Hk") if name in slices for store in slices[name].stores]
    made.stores = [*matrices, *made.stores, *margins.stores]
    made.guards = margins.guards


def _closure_groups(derivation: Derivation) -> list[tuple[tuple[str, tuple[str, ...]], ...]]:
    """A function per leg type whose displacements are found by iteration."""
    return [
        ((f"closure_{t.name}", (f"gap_{t.name}", f"jacobian_{t.name}")),)
        for t in derivation.leg_types
        if not t.is_closed
    ]


_Stored = dict[Output, list[tuple[Stage, Store]]]


def _cheapest_stores(
    derivation: Derivation, builder: Builder, arrays: set[str]
) -> tuple[_Stored, Lowering]:
    """Lower the outputs of a group with each choice of rotations; keep the cheaper."""
    outputs = [o for o in derivation.outputs if o.array in arrays]
    if not outputs:
        return {}, Lowering(derivation, builder)

    def run(*, columns: bool) -> tuple[int, tuple[_Stored, Lowering]]:
        builder.keep_nothing()
        lowering = Lowering(derivation, builder)
        if columns:
            lowering.form_tip_axes()
        stores = {output: _stores(lowering, output) for output in outputs}
        builder.keep_nothing()
        cost = builder.cost([s.value for found in stores.values() for _, s in found])
        return cost, (stores, lowering)

    mark = builder.mark()
    step_cost, by_steps = run(columns=False)
    forgotten = builder.rollback(mark)
    column_cost, by_columns = run(columns=True)
    if column_cost < step_cost:
        return by_columns
    builder.rollback(mark)
    builder.redo(forgotten)
    return by_steps


def _settle_signs(builder: Builder, meaning: Meaning, slices: list[_Slice]) -> None:
    """Values that are components get their signs, where that costs nothing."""
    used = builder.needed(set().union(*(part.roots(builder)[0] for part in slices)))
    stores = dict.fromkeys(store for part in slices for store in part.stores)
    printed = inline_single_use(used, list(stores), builder.guards)
    turned = settle(builder, meaning, printed, [store.value for _, store in stores])
    signs = {symbol: -symbol for symbol in turned}
    for part in slices:
        part.stores = [
            (at, replace(store, value=replaced(sp.sympify(store.value), signs)))
            for at, store in part.stores
        ]
        if part.guards is not None:
            part.guards = [g.rewritten(signs) for g in part.guards]


def _declare(derivation: Derivation, builder: Builder) -> None:
    """Stages of the symbols that come from outside."""
    table = derivation.parameters
    for name, (parameter, _) in table.entries.items():
        leg = parameter.leg_type
        stage = Stage(Kind.PARAMETER_LEG, leg) if leg else Stage(Kind.PARAMETER)
        builder.declare(sp.Symbol(name, real=True), stage)
    for name, (leg_type, _) in table.branches.items():
        sign = builder.declare(sp.Symbol(name, real=True), Stage(Kind.PARAMETER_LEG, leg_type))
        builder.signs.add(sign)
    for given in derivation.givens:
        _declare_state(builder, given.components)
    for frame in derivation.frames:
        _declare_state(builder, frame.rotation or ())
    for quantity in derivation.leg_state():
        symbol = sp.Symbol(quantity.name, real=True)
        builder.declare(symbol, Stage(Kind.STATE_LEG, quantity.leg_type))


def _declare_state(builder: Builder, components: Iterable[Any]) -> None:
    for component in components:
        for symbol in getattr(component, "free_symbols", ()):
            if not builder.is_declared(symbol):
                builder.declare(symbol, Stage(Kind.STATE))


def _stores(lowering: Lowering, output: Output) -> list[tuple[Stage, Store]]:
    """Entries of an output array with the atoms that go there."""
    value, b = output.value, lowering.b
    b.equation = lowering.equation_of(value)
    components: dict[tuple[int, int], Atom]
    if isinstance(value, Tensor):
        t = lowering.tensor(value, output.frame)
        components = {(i, j): t[i][j] for i in range(3) for j in range(3)}
    elif isinstance(value, Vector):
        v = lowering.vector(value, output.frame)
        along_columns = output.rows == ((0, 0),) and output.columns not in ((), ((0, 0),))
        components = {((0, k) if along_columns else (k, 0)): v[k] for k in range(3)}
    else:
        components = {(0, 0): lowering.scalar(sp.sympify(value))}
    b.keep(components.values())
    found = []
    for (i, row), (j, column) in _pairs(output):
        atom = components[i, j]
        if (output.symmetric and i > j) or atom == 0:
            continue  # arrays start at zero
        stage = b.stage_of(atom)
        stage = stage if stage.depends_on_state else Stage(Kind.STATE)
        if output.leg_type:
            stage = Stage(Kind.STATE_LEG, output.leg_type)
        places = [(row, column)]
        off_diagonal = (output.mirrored or output.symmetric) and row != column
        if off_diagonal or (output.mirrored and output.leg_rows != output.leg_columns):
            places.append((column, row))
        for k, (r, c) in enumerate(places):
            swap = k == 1
            legs_r = output.leg_columns if swap else output.leg_rows
            legs_c = output.leg_rows if swap else output.leg_columns
            found.append(
                (
                    stage,
                    Store(
                        output.array,
                        atom,
                        _place(r, legs_r, output),
                        _place(c, legs_c, output),
                        b.equation,
                    ),
                )
            )
    return found


def _pairs(output: Output) -> list[tuple[tuple[int, int], tuple[int, Any]]]:
    columns: Sequence[tuple[int, Any]] = output.columns or ((0, None),)
    return [(row, column) for row in output.rows for column in columns]


def _place(position: Any, per_leg: tuple[int, ...], output: Output) -> Any:
    """Index in an array, a table over the legs, or None for an array with one index."""
    if position is None:
        return None
    if not output.leg_type or not per_leg:
        return position
    return tuple(position + k for k in per_leg)


class _Slice:
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

    part: _Slice
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


def _program(
    derivation: Derivation, builder: Builder, slices: list[_Slice], meaning: Meaning
) -> Program:
    leg_types = [t.name for t in derivation.leg_types]
    sliced = [_sliced(builder, part, meaning) for part in slices]
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
    reserved = outside | {name for name, _ in listed}
    functions = {
        s.part.name: _function(derivation, builder, s, names, reserved, meaning) for s in sliced
    }
    return Program(
        prepare,
        listed,
        functions,
        _shapes(derivation),
        dict(builder.leg_counts),
        closures(derivation),
        given_displacements(derivation),
        means=means,
        lowered=meaning.shown(),
    )


def _sliced(builder: Builder, part: _Slice, meaning: Meaning) -> _Sliced:
    wanted, guards = part.roots(builder)
    run = [s for s in builder.needed(wanted) if s.stage.depends_on_state]
    run = inline_single_use(run, part.stores, guards)
    uses = [(store.value, store.equation) for _, store in part.stores]
    run = meaning.told(run, uses + [(e, g.equation) for g in guards for e in (g.value, g.scale)])
    used = _used(run, part.stores, guards)
    constants = {s for s in used if not builder.stage_of(s).depends_on_state}
    return _Sliced(part, run, guards, used, constants)


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
    prepared_names: dict[Any, Any],
    reserved: set[str],
    meaning: Meaning,
) -> Function:
    assert derivation.coordinates is not None
    inputs, assignments, checks = [], [], []
    for vector, (named, conditions) in unpack(derivation).items():
        wanted = {a.target for a in named if a.target in sliced.used}
        if wanted and vector == "base":  # what must hold of a rotation, whatever is used of it
            wanted |= {c.value for c in conditions}
        chain = _closure_of(named, wanted)
        read = [a for a in named if a.target in chain]
        if read:
            inputs.append(vector)
            assignments += read
            checks += [c for c in conditions if c.value in chain]
    per_leg: dict[str, list[LegInput]] = {}
    for symbol in sorted(sliced.used, key=lambda s: s.name):
        stage = builder.stage_of(symbol)
        if stage.kind is Kind.STATE_LEG and builder.maker(symbol) is None:
            vector, indices = leg_inputs(derivation, symbol.name)
            per_leg.setdefault(stage.leg_type, []).append(LegInput(symbol, vector, indices))
            inputs.append(vector)
    given = {s.name for s in sliced.used if builder.maker(s) is None} | {
        a.target.name for a in assignments
    }
    own = numbered(
        sliced.run,
        reserved | given,
        lambda s, made: meaning.stem(s, ChainMap(made, prepared_names)),
    )
    names = prepared_names | own
    run, stores, guards = renamed(names, sliced.run, sliced.part.stores, sliced.guards)
    constants = {names.get(s, s).name: builder.stage_of(s).leg_type for s in sliced.constants}
    return Function(
        sliced.part.name,
        tuple(v for v in VECTORS if v in inputs),
        sliced.part.arrays,
        tuple(assignments),
        tuple(checks),
        _blocks(run, stores, guards, [t.name for t in derivation.leg_types]),
        {t: tuple(found) for t, found in per_leg.items()},
        tuple(sorted(n for n, leg in constants.items() if not leg)),
        {
            t.name: tuple(sorted(n for n, leg in constants.items() if leg == t.name))
            for t in derivation.leg_types
        },
        meaning.by_name(sliced.run, own),
    )


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


def _shapes(derivation: Derivation) -> dict[str, tuple[int, ...]]:
    """Shape of every output array."""
    assert derivation.coordinates is not None
    n = derivation.coordinates.sizes
    legs = sum(len(t.indices) for t in derivation.leg_types)
    wide = 6 if derivation.coordinates.transmits_moments else 3
    closures = {
        f"{stem}_{t.name}": (len(t.indices), rows * (t.unknowns if stem == "jacobian" else 1))
        for t in derivation.leg_types
        if not t.is_closed
        for rows in ((2 if derivation.coordinates.planar else 3) + t.transmitted,)
        for stem in ("gap", "jacobian")
    }
    return {
        **closures,
        "M": (n["NV"], n["NV"]),
        "Z": (n["NV"],),
        "H": (n["NV"], n["NU"]),
        "Hk": (n["NV"], n["NC"]),
        "required": (n["NV"],),
        "q": (n["NJ"],),
        "qd": (n["NJ"],),
        "qdd": (n["NJ"],),
        "leg_force": (legs, wide),
        "actuator": (n["NU"], wide),
        "constraint_direction": (n["NC"], wide),
        "potential": (1,),
        **({"dissipation": (1,)} if _is_made(derivation, "dissipation") else {}),
        **{name: (n["NU"],) for name in _OF_MOTORS if _is_made(derivation, name)},
        **({"coupling": (n["NU"], n["NU"])} if _is_made(derivation, "coupling") else {}),
        **({"margins": (n["NJ"],)} if _is_made(derivation, "margins") else {}),
        **({"effort_limits": (n["NU"],)} if _is_made(derivation, "effort_limits") else {}),
        "constraints": (n["NC"],),
        "constraint_bias": (n["NC"],),
        "lengths": (2,),
        "pivots": (legs,),
        "reach": (legs,),
    }


_OF_MOTORS = (
    "motor_rates",
    "per_turn",
    "ratios",
    "actuated_rates",
    "actuated_accelerations",
    "actuated_bias",
    "rotor_roots",
)


def _is_made(derivation: Derivation, array: str) -> bool:
    """Whether something stands in an array that not every mechanism has."""
    return any(output.array == array for output in derivation.outputs)


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
                    Check(g.trouble, g.value, g.scale, g.power, g.equation)
                    for g in guards
                    if g.stage == stage
                ),
                tuple((s.target, s.expr) for s in totals),
                tuple(store for at, store in stores if at == stage),
                tuple(s.equation for s in totals),
            )
        )
    return tuple(b for b in blocks if b.assignments or b.stores or b.sums or b.checks)
