"""Small systems of linear equations, eliminated straight through in the order of home.

Near home the rows of a system always come in the same order: known beforehand, it needs no search
for pivots and no exchange.  The order, and sizes of rows, are those of the parameters of the
specification; what they do not suit is noticed by the pivots, and is solved with a choice of rows.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pne_sym.backends.bundle import Bundle
from pne_sym.program.evaluate import Array, Status, prepare
from pne_sym.program.interpret import Interpreter
from pne_sym.program.public import Apply, Argument, PublicFunction

LARGEST = 6
"""Equations of a system that is written out; larger ones would be long texts."""
GROWTH = 10
"""Multiples of the pivot's row that are subtracted at most, rows made of equal size."""
SMALLEST = 1e-3
"""Pivots are larger, in rows made of size one: far from what counts as singular in every type."""
_CLEARLY = 2  # a row further down is better by this factor, as where rows are chosen
_FOURS = 16  # no more powers of 4 between rows and one: products of entries stay far from underflow


class Order(NamedTuple):
    """How a system is eliminated.

    Attributes:
        rows: in the order in which they are pivots.
        sizes: logarithm to the base 4 of the size of these rows, rounded.
    """

    rows: tuple[int, ...]
    sizes: tuple[int, ...]


def order_at_home(bundle: Bundle, function: PublicFunction, solve: Apply) -> Order | None:
    """The order for a system of a function; None where it is large, or singular at home."""
    matrix = solve.operands[0]
    if matrix.shape[0] > LARGEST:
        return None
    before = function.steps[: function.steps.index(solve)]
    result = (Argument(matrix, (), ""),)
    part = PublicFunction("part", "", function.inputs, result, before, "")
    c, program = bundle.coordinates, bundle.program
    values = prepare(program, bundle.derivation.parameters.values())
    model = Interpreter(program, values, c.home[1], part)
    given = {a.name: np.zeros((1, *a.value.shape)) for a in part.required} | {
        "X": np.array([c.home[0]])
    }
    answer = model.call("part", **given)
    return _order(answer.outputs[0][0]) if answer.status[0] == Status.OK else None


def _order(matrix: Array) -> Order | None:
    """Elimination with a choice of rows of equal size."""
    most = np.max(np.abs(matrix), axis=1)
    if not most.all():
        return None
    a, rows = matrix / most[:, None], list(range(len(matrix)))
    for p in range(len(a)):
        column = np.abs(a[p:, p])
        best = p + int(np.argmax(column))
        if column[best - p] > _CLEARLY * column[0]:
            a[[p, best]] = a[[best, p]]
            rows[p], rows[best] = rows[best], rows[p]
        if not abs(a[p, p]) > SMALLEST:
            return None
        a[p + 1 :] -= np.outer(a[p + 1 :, p] / a[p, p], a[p])
    sizes = tuple(round(math.log(float(most[r]), 4)) for r in rows)
    return Order(tuple(rows), sizes) if max(map(abs, sizes)) <= _FOURS else None
