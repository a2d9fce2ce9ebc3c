"""Small systems of linear equations in C, eliminated straight through in the order of home.

Near home the rows of a system always come in the same order: known beforehand, it needs no search
for pivots and no exchange.  The order, and sizes of rows, are those of the parameters of the
specification; what they do not suit is noticed by the pivots, and is solved with a choice of rows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_text import Routine, in_pairs, indented, listing, statement
from pne_sym.program.evaluate import Status, prepare
from pne_sym.program.interpret import Interpreter, PoseLayout
from pne_sym.program.public import Apply, Argument, PublicFunction

LARGEST = 6
"""Equations of a system that is written out; larger ones would be long texts."""
GROWTH = 10
"""Multiples of the pivot's row that are subtracted at most, rows made of equal size."""
SMALLEST = 1e-3
"""Pivots are larger, in rows made of size one: far from what counts as singular in every type."""
_CLEARLY = 2  # a row further down is better by this factor, as in templates/c/linear.c.jinja
_FOURS = 16  # no more powers of 4 between rows and one: products of entries stay far from underflow

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Order:
    """How a system is eliminated.

    Attributes:
        rows: in the order in which they are pivots.
        sizes: logarithm to the base 4 of the size of these rows, rounded.
    """

    rows: tuple[int, ...]
    sizes: tuple[int, ...]

    def tables(self, name: str) -> list[str]:
        """Declarations of the rows `order_NAME` and the sizes `sizes_NAME`."""
        rows, sizes = (", ".join(map(str, v)) for v in (self.rows, (4.0**s for s in self.sizes)))
        return [
            *listing(f"static const size_t order_{name}[] = {{", [rows], "};"),
            *listing(f"static const real sizes_{name}[] = {{", [sizes], "};"),
        ]


def order_at_home(bundle: Bundle, function: PublicFunction, solve: Apply) -> Order | None:
    """The order for a system of a function; None where it is large, or singular at home."""
    matrix = solve.operands[0]
    if matrix.shape[0] > LARGEST:
        return None
    before = function.steps[: function.steps.index(solve)]
    result = (Argument(matrix, (), ""),)
    part = PublicFunction("part", "", function.inputs, result, before, "")
    c, program = bundle.coordinates, bundle.program
    model = Interpreter(
        program,
        [part],
        prepare(program, bundle.derivation.parameters.values()),
        np.array(c.home[1]),
        PoseLayout(c.position, c.has_quaternion),
    )
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


def elimination(n: int) -> Routine:
    """A routine that solves n equations a x = b in w states side by side, and tells where in doubt.

    What is not finite shows in the total, to which the solutions are added.

    Row i of a begins at a[i*stride*w]; `order` tells which row comes when, `sizes` how large these
    rows are.  Two pivots are found at a time, the second without waiting for the first: what takes
    longest is that each needs the one before.
    """
    lines = []
    for i in range(n):
        lines += [f"real a{i}{j} = a[(order[{i}]*stride + {j})*w + k];" for j in range(n)]
        lines.append(f"real b{i} = b[order[{i}]*w + k];")
    for p in range(0, n, 2):
        lines += _pivots(p, n)
    for p in reversed(range(n)):
        terms = [f"b{p}", *(f"a{p}{j}*x{j}" for j in reversed(range(p + 2, n)))]
        known = f"({' - '.join(terms)})" if len(terms) > 1 else terms[0]
        last = f" - a{p}{p + 1}*f{p}*x{p + 1}" if p + 1 < n else ""
        lines += statement(f"const real x{p} = {known}*f{p}{last}")
    lines += [f"x[{p}*w + k] = x{p};" for p in range(n)]
    lines += statement(f"total[k] += {in_pairs([f'x{p}' for p in range(n)])}")
    lines += _doubts(n)
    parameters = ("size_t w", "size_t stride", "const size_t *order", "const real *sizes",
                  *(f"const real *{v}" for v in "ab"),
                  *(f"real *{v}" for v in ("x", "unsure", "total")))  # fmt: skip
    body = ("for (size_t k = 0; k < w; ++k) {", *indented(lines), "}")
    return Routine(f"eliminate_{n}", parameters, body)


def _pivots(p: int, n: int) -> list[str]:
    """Multiples of rows p and p + 1 are subtracted from the rows further down."""
    q, lines = p + 1, [f"const real f{p} = 1/a{p}{p};"]
    if q == n:
        return lines
    lines.append(f"const real d{q} = a{p}{p}*a{q}{q} - a{q}{p}*a{p}{q};")
    lines.append(f"const real f{q} = a{p}{p}/d{q};")
    for i in range(q, n):
        g = f"g{i}{p}"
        lines.append(f"const real {g} = a{i}{p}*f{p};")
        lines += [f"a{i}{j} -= {g}*a{p}{j};" for j in range(q + (i == q), n)]
        lines.append(f"b{i} -= {g}*b{p};")
    for i in range(q + 1, n):
        g = f"g{i}{q}"
        lines.append(f"const real {g} = a{i}{q}*f{q};")
        lines += [f"a{i}{j} -= {g}*a{q}{j};" for j in range(q + 1, n)]
        lines.append(f"b{i} -= {g}*b{q};")
    return lines


def _doubts(n: int) -> list[str]:
    """Multiples and inverse pivots too large, by the size of rows; a pivot that is no number."""
    lines = []
    for p in range(n - 1):
        multiples = [f"magnitude(g{i}{p})*(sizes[{p}]/sizes[{i}])" for i in range(p + 1, n)]
        lines += statement(f"const real most{p} = {_largest(multiples)}")
    inverse = _largest([f"magnitude(f{p})*sizes[{p}]" for p in range(n)])
    pivots = " + ".join(f"d{p}" if p % 2 else f"a{p}{p}" for p in range(n))
    limits = [(inverse, 1 / SMALLEST)]
    if n > 1:
        limits.append((_largest([f"most{p}" for p in range(n - 1)]), GROWTH))
    conditions = [f"{value} <= R({limit:g})" for value, limit in limits]
    conditions.append(f"is_finite({pivots})")
    return [*lines, *(x for c in conditions for x in statement(f"unsure[k] += UNLESS({c})"))]


def _largest(values: list[str]) -> str:
    """The largest of the first values, and that of the others, which come later."""
    half = len(values) // 2
    if not half:
        return values[0]
    return f"larger({_largest(values[:half])}, {_largest(values[half:])})"
