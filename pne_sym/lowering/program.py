"""A derivation to a program: groups of outputs are lowered together, each the cheaper way."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

import sympy as sp

from pne_sym.derivation import Derivation, Output
from pne_sym.lowering.builder import Builder
from pne_sym.lowering.components import Lowering
from pne_sym.lowering.functions import Slice, program_of
from pne_sym.lowering.margins import Margins
from pne_sym.lowering.meaning import Meaning
from pne_sym.lowering.public import public_functions
from pne_sym.lowering.shapes import shapes
from pne_sym.lowering.signs import settle
from pne_sym.lowering.simplify import inline_single_use
from pne_sym.lowering.statements import rewritten
from pne_sym.lowering.stores import stores
from pne_sym.program.ir import Check, Kind, Program, Stage, Store
from pne_sym.program.verify import verify

Group = tuple[tuple[str, tuple[str, ...]], ...]
# Arrays of each function; functions of one group are lowered together, so that they share
# what they have in common.
GROUPS: tuple[Group, ...] = (
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
# Arrays besides where motors are coupled.  A motor turns with several joints, of several legs: what
# its rotor does is no sum over legs; steps of public functions put it together from these arrays.
_ROTORS = ("rotor_roots", "coupling")
_BESIDES: dict[str, tuple[str, ...]] = {
    "dynamics": ("actuated_bias", *_ROTORS),
    "M": ("H", *_ROTORS),
    "Z": ("H", "actuated_bias", *_ROTORS),
    "required": ("actuated_accelerations", *_ROTORS),
}


def lower(derivation: Derivation) -> Program:
    """Lower a derivation to scalar code.

    Raises:
        SingularPatternError: a leg's degrees of freedom are dependent by structure.
    """
    builder = Builder()
    builder.quantity_of = {e.id: e.name for e in derivation.equations()}
    builder.leg_counts = {t.name: len(t.indices) for t in derivation.leg_types}
    _declare(derivation, builder)
    shape_of = shapes(derivation)
    slices, lowerings = [], []
    for group in _groups(derivation):
        together = {a for _, arrays in group for a in arrays}
        stored, lowering = _cheapest_stores(derivation, builder, together, group[0][1])
        lowerings.append(lowering)
        for name, arrays in group:
            chosen = [
                store
                for output, found in stored.items()
                if output.array in arrays
                for store in found
            ]
            # What is zero throughout, as the force of massless legs is, has no stores.
            present = tuple(a for a in arrays if 0 not in shape_of.get(a, (0,)))
            if present:
                slices.append(Slice(name, present, chosen))
    _add_margins(derivation, builder, {s.name: s for s in slices})
    meaning = Meaning(derivation, lowerings)
    _settle_signs(builder, meaning, slices)
    program = program_of(derivation, builder, slices, meaning)
    program = replace(program, relations=derivation.relations)
    table = derivation.parameters
    outside = {name: parameter.leg_type or "" for name, (parameter, _) in table.entries.items()}
    verify(program, outside | {name: leg for name, (leg, _) in table.branches.items()})
    return replace(program, public=public_functions(derivation, program))


def _add_margins(derivation: Derivation, builder: Builder, slices: dict[str, Slice]) -> None:
    """H, Hk and the margins of all guards of M, Z, H and inverse dynamics join the lengths."""
    guards: list[Check] = []
    for name in ("dynamics", "required"):
        known = {g.equation for g in guards}  # of the same values, lowered for other functions
        guards += [g for g in slices[name].roots(builder)[1] if g.equation not in known]
    margins = Margins(derivation, builder, guards)
    made = slices["condition"]
    made.arrays = ("H", *(("Hk",) if "Hk" in slices else ()), *made.arrays, "pivots", "reach")
    matrices = [store for name in ("H", "Hk") if name in slices for store in slices[name].stores]
    made.stores = [*matrices, *made.stores, *margins.stores]
    made.guards = margins.guards


def _groups(derivation: Derivation) -> Iterator[Group]:
    """Groups of functions, one per leg type whose displacements are found by iteration too."""
    made = {output.array for output in derivation.outputs}
    besides = _BESIDES if "rotor_roots" in made else {}
    for group in GROUPS:
        yield tuple(
            (name, arrays + tuple(a for a in besides.get(name, ()) if a == "H" or a in made))
            for name, arrays in group
        )
    for t in (t for t in derivation.leg_types if not t.is_closed):
        yield ((f"closure_{t.name}", (f"residual_{t.name}", f"jacobian_{t.name}")),)


_Stored = dict[Output, list[Store]]


def _cheapest_stores(
    derivation: Derivation, builder: Builder, arrays: set[str], first: tuple[str, ...]
) -> tuple[_Stored, Lowering]:
    """Lower the outputs of a group with each choice of rotations; keep the cheaper.

    Args:
        derivation: whose outputs they are.
        builder: makes the statements.
        arrays: of all functions of the group.
        first: of its first function, which is to be cheap.
    """
    outputs = [o for o in derivation.outputs if o.array in arrays]
    if not outputs:
        return {}, Lowering(derivation, builder)

    cheap = [o for o in outputs if o.array in first]
    others = [o for o in outputs if o.array not in first]

    mark = builder.mark()
    by_columns = Lowering(derivation, builder, cheap)
    builder.keep_nothing()
    by_columns.form_tip_axes()
    of_columns = {output: stores(by_columns, output) for output in (*cheap, *others)}
    most = builder.cost_of_all([s.value for output in cheap for s in of_columns[output]])

    forgotten = builder.rollback(mark)
    by_steps = Lowering(derivation, builder, cheap)
    builder.keep_nothing()
    of_steps: _Stored = {}
    for output in cheap:
        of_steps[output] = stores(by_steps, output)
        values = [s.value for found in of_steps.values() for s in found]
        if builder.cost_of_all(values) > most:  # more outputs would only add to it
            builder.rollback(mark)
            builder.redo(forgotten)
            builder.keep_nothing()
            return of_columns, by_columns
    of_steps |= {output: stores(by_steps, output) for output in others}
    builder.keep_nothing()
    return of_steps, by_steps


def _settle_signs(builder: Builder, meaning: Meaning, slices: list[Slice]) -> None:
    """Values that are components get their signs, where that costs nothing."""
    used = builder.needed(set().union(*(part.roots(builder)[0] for part in slices)))
    stored = dict.fromkeys(store for part in slices for store in part.stores)
    printed = inline_single_use(used, [*stored, *builder.guards])
    turned = settle(builder, meaning, printed, [store.value for store in stored])
    signs = {symbol: -symbol for symbol in turned}
    for part in slices:
        part.stores = [rewritten(store, signs) for store in part.stores]
        if part.guards is not None:
            part.guards = [rewritten(guard, signs) for guard in part.guards]


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
