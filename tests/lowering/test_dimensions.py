"""Units of all statements of programs: of sums, of thresholds, of what is stored in arrays."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import pytest
import sympy as sp

from pne_sym.derivation import Coordinates, Derivation
from pne_sym.derivation.dimensions import Dimensions
from pne_sym.program.ir import Block, Function, Program
from pne_sym.vector.dimensions import Dimension, DimensionError, dimension, dimension_of_unit
from tests.models import bundle, catalogue
from tests.sampling import sampled

POWER, SECOND = dimension_of_unit("W"), dimension_of_unit("s")
FORCE, MOMENT = dimension_of_unit("N"), dimension_of_unit("N m")
_NUMBER = sp.Symbol("a measured number, which has any unit")
Entry = tuple[str, int, int]


class Units(dict[str, Any]):
    """Dimensions of the names of a program; those of statements as they are executed."""

    def __init__(self, derivation: Derivation) -> None:
        super().__init__(Dimensions(derivation.notation, derivation.parameters))
        self[_NUMBER.name] = None
        c = derivation.coordinates
        assert c is not None
        linear = sum(axis < 3 for axis in c.components)
        metres = [*["m"] * linear, *["-"] * (len(c.pose) - linear)]
        self |= {f"X_{k}": dimension_of_unit(unit) for k, unit in enumerate(metres)}
        for k, axis in enumerate(c.components):
            self[f"V_{k}"] = dimension_of_unit("m/s" if axis < 3 else "rad/s")
            self[f"A_{k}"] = self[f"V_{k}"] / SECOND

    def of(self, expr: Any) -> Dimension | None:
        floats = sp.sympify(expr).atoms(sp.Float)
        return dimension(sp.sympify(expr).xreplace(dict.fromkeys(floats, _NUMBER)), self)


def contradictions(program: Program, derivation: Derivation) -> Iterator[str]:
    """Statements whose terms have different units, thresholds of another unit than what is tested.

    Then entries of arrays that do not fit together: of M V', Z, H tau, Hk lambda.
    """
    shared = Units(derivation)
    for block in program.prepare:
        yield from _in_block("preparation", block, shared)
    stored: dict[Entry, Dimension] = {}
    for function in program.functions.values():
        units = Units.__new__(Units)
        dict.__init__(units, shared)
        yield from _in_function(function, units, stored)
    coordinates = derivation.coordinates
    assert coordinates is not None
    yield from _conjugate(stored, coordinates)


def _in_function(function: Function, units: Units, stored: dict[Entry, Dimension]) -> Iterator[str]:
    unpacked = Block("", function.unpack, function.unpack_checks)
    for block in (unpacked, *function.blocks):
        yield from _in_block(function.name, block, units)
        for store in block.stores:
            found = units.of(store.value)
            rows, columns = _places(store.row), _places(store.column)
            for k in range(max(len(rows), len(columns))):
                entry = store.array, rows[k % len(rows)], columns[k % len(columns)]
                if found is not None and stored.setdefault(entry, found) != found:
                    yield f"{function.name}: {entry} in {found} and {stored[entry]}"


def _places(place: int | tuple[int, ...] | None) -> Sequence[int]:
    return place if isinstance(place, tuple) else (place or 0,)


def _in_block(where: str, block: Block, units: Units) -> Iterator[str]:
    for a in block.assignments:
        try:
            units[a.target.name] = units.of(a.expr)
        except DimensionError as error:
            yield f"{where}: ({a.equation}) {a.target}: {error}"
            units[a.target.name] = None
    for check in block.checks:
        value, scale = units.of(check.value), units.of(check.scale)
        if check.status == "singular" and None not in (value, scale) and value != scale:
            yield f"{where}: ({check.equation}) {check.value} [{value}] against [{scale}]"
    for s in block.sums:
        units[s.target.name] = units.of(s.expr)


def _conjugate(stored: dict[Entry, Dimension], c: Coordinates) -> Iterator[str]:
    """Forces times rates are powers: rows of Z tell the units of all other arrays."""
    force = {row: unit for (array, row, _), unit in stored.items() if array == "Z"}
    for k, axis in enumerate(c.components):
        if force.get(k) != (FORCE if axis < 3 else MOMENT):
            yield f"row {k} of Z in {force.get(k)}"
    rate = {k: POWER / unit for k, unit in force.items()}
    rates_of_q = {row: unit for (array, row, _), unit in stored.items() if array == "qd"}
    actuator = {k: POWER / rates_of_q[c.joints.index(j)] for k, j in enumerate(c.actuators)}
    reaction = {k: dimension_of_unit(unit) for k, unit in enumerate(c.constraint_units)}
    factor = {
        "M": {k: unit / SECOND for k, unit in rate.items()},
        "H": actuator,
        "Hk": reaction,
        "required": {0: dimension_of_unit("-")},
    }
    for (array, row, column), unit in stored.items():
        if array in factor and unit * factor[array][column] != force[row]:
            yield f"{array}[{row}, {column}] in {unit}"
        power = {"constraints": SECOND, "constraint_bias": SECOND**-1}.get(array)
        if power and unit * reaction[row] != POWER * power:
            yield f"{array}[{row}] in {unit}"


NAMES = ("planar_3rpr", "tripod_3rps", "hybrid_3rrrs", "planar_4rpr_free", "stewart", "tripod_3upu")


@pytest.mark.parametrize("name", sampled(list(NAMES), 2))
def test_all_statements_and_stores(name: str) -> None:
    compiled = bundle(catalogue(name))
    assert not list(contradictions(compiled.program, compiled.derivation))


@pytest.mark.parametrize("kind", ["assignments", "checks", "stores"])
def test_planted_faults_are_found(kind: str) -> None:
    """A statement, a threshold and a store with a factor of a length too much."""
    compiled = bundle(catalogue("planar_3rrr"))
    functions = compiled.program.functions
    blocks = list(functions["dynamics"].blocks)
    k, i = next(
        (k, i)
        for k, block in enumerate(blocks)
        for i, item in enumerate(getattr(block, kind))
        if not sp.sympify(getattr(item, FACTOR[kind])).is_number
        and (kind != "assignments" or _is_summed(item.target, block))
    )
    items = list(getattr(blocks[k], kind))
    wrong = getattr(items[i], FACTOR[kind]) * sp.Symbol("rrr_platform_point_x", real=True)
    items[i] = replace(items[i], **{FACTOR[kind]: wrong})
    blocks[k] = replace(blocks[k], **{kind: tuple(items)})
    faulty = replace(functions["dynamics"], blocks=tuple(blocks))
    program = replace(
        compiled.program,
        functions={"dynamics": faulty, "joint_rates": functions["joint_rates"]},
    )
    assert list(contradictions(program, compiled.derivation))


FACTOR = {"assignments": "expr", "checks": "scale", "stores": "value"}


def _is_summed(target: sp.Symbol, block: Block) -> bool:
    """Whether a statement's value is a term of a sum."""
    return any(isinstance(a.expr, sp.Add) and a.expr.has(target) for a in block.assignments)
