"""What is stored: the entries of outputs, with the values that go there."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any

import sympy as sp

from pne_sym.derivation import Output
from pne_sym.lowering.components import Lowering
from pne_sym.lowering.statements import Atom
from pne_sym.program.ir import Kind, Stage, Store
from pne_sym.vector import Tensor, Vector


def stores(lowering: Lowering, output: Output) -> list[Store]:
    """Entries of an output array with the atoms that go there."""
    b = lowering.b
    components = _components(lowering, output)
    b.keep(components.values())
    found = []
    for (i, row), (j, column) in product(output.rows, output.columns or ((0, None),)):
        atom = components[i, j]
        if (output.symmetric and i > j) or atom == 0:
            continue  # arrays start at zero
        stage = b.stage_of(atom)
        stage = stage if stage.depends_on_state else Stage(Kind.STATE)
        if output.leg_type:
            stage = Stage(Kind.STATE_LEG, output.leg_type)
        for r, c in _places(output, row, column):
            found.append(Store(output.array, atom, r, c, b.equation, stage))
    return found


def _components(lowering: Lowering, output: Output) -> dict[tuple[int, int], Atom]:
    """Of what is stored; a scalar has one."""
    value, b = output.value, lowering.b
    b.equation = lowering.equation_of(value)
    if isinstance(value, Tensor):
        t = lowering.tensor(value, output.frame)
        return {(i, j): t[i][j] for i in range(3) for j in range(3)}
    if isinstance(value, Vector):
        v = lowering.vector(value, output.frame)
        along_columns = output.rows == ((0, 0),) and output.columns not in ((), ((0, 0),))
        return {((0, k) if along_columns else (k, 0)): v[k] for k in range(3)}
    return {(0, 0): lowering.scalar(sp.sympify(value))}


def _places(output: Output, row: int, column: Any) -> Iterator[tuple[Any, Any]]:
    """Rows and columns at which an entry stands: mirrored ones at two."""
    legs = output.leg_rows, output.leg_columns
    yield _place(row, legs[0], output), _place(column, legs[1], output)
    off_diagonal = (output.mirrored or output.symmetric) and row != column
    if off_diagonal or (output.mirrored and legs[0] != legs[1]):
        yield _place(column, legs[1], output), _place(row, legs[0], output)


def _place(position: Any, per_leg: tuple[int, ...], output: Output) -> Any:
    """Index in an array, a table over the legs, or None for an array with one index."""
    if position is None or not output.leg_type or not per_leg:
        return position
    return tuple(position + k for k in per_leg)
