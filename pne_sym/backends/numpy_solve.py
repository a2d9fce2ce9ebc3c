"""Small systems of linear equations in NumPy modules, written out in the order of home.

A function per number of equations, over floats or over arrays of states; the order of rows, and
how large multiples may become, are tables.
"""

from __future__ import annotations

import textwrap

from pne_sym.backends.orders import GROWTH, SMALLEST, Order
from pne_sym.backends.python_text import WIDTH
from pne_sym.backends.scalar import wrap


def name_of(n: int) -> str:
    """The function that solves so many equations."""
    return f"_straight_{n}"


def table(order: Order) -> str:
    """Rows in the order of their pivots; limits of multiples, column by column, and of 1/pivot."""
    sizes = [4.0**s for s in order.sizes]
    n = len(sizes)
    limits = [GROWTH * sizes[i] / sizes[p] for p in range(n) for i in range(p + 1, n)]
    limits += [1 / SMALLEST / size for size in sizes]
    return f"_Order({name_of(n)}, {order.rows}, ({', '.join(f'{v:.12g}' for v in limits)},))"


def elimination(n: int) -> str:
    """The function: solutions, and whether these are beyond doubt."""
    limits = [f"l{i}{p}" for p in range(n) for i in range(p + 1, n)] + [f"l{p}" for p in range(n)]
    lines = [
        f'"""Solve {n} equations a x = b straight through; and whether that is beyond doubt."""'
    ]
    rows = [f"({', '.join(f'a{i}{j}' for j in range(n))},)" for i in range(n)]
    lines += _wrapped(f"{', '.join(rows)}, = [a[{n} * k : {n} * k + {n}] for k in rows]")
    lines += _wrapped(f"{', '.join(f'b{i}' for i in range(n))}, = [b[k] for k in rows]")
    lines += _wrapped(f"{', '.join(limits)}, = limits")
    for p in range(n):
        lines.append(f"f{p} = 1.0/a{p}{p}")
        for i in range(p + 1, n):
            g = f"g{i}{p}"
            lines.append(f"{g} = a{i}{p}*f{p}")
            lines += [f"a{i}{j} = a{i}{j} - {g}*a{p}{j}" for j in range(p + 1, n)]
            lines.append(f"b{i} = b{i} - {g}*b{p}")
    for p in reversed(range(n)):
        known = " - ".join([f"b{p}", *(f"a{p}{j}*x{j}" for j in reversed(range(p + 1, n)))])
        lines.append(f"x{p} = ({known})*f{p}" if p + 1 < n else f"x{p} = b{p}*f{p}")
    solution = [f"x{p}" for p in range(n)]
    doubts = [f"(abs({v.replace('l', 'f' if len(v) == 2 else 'g')}) <= {v})" for v in limits]
    finite = [*solution, *(f"a{p}{p}" for p in range(n))]
    doubts.append(f"(abs({' + '.join(finite)}) < math.inf)")
    sure = wrap("    " + " & ".join(doubts), WIDTH - 4, "    ")
    lines += ["sure = (", *sure, ")", f"return sure, ([{', '.join(solution)}],)"]
    body = textwrap.indent("\n".join(lines), "    ")
    return f"def {name_of(n)}(a, b, rows, limits):\n{body}"


def _wrapped(line: str) -> list[str]:
    """An assignment to many names."""
    targets, value = line.split(" = ")
    if len(line) <= WIDTH - 4:
        return [line]
    return ["(", *wrap("    " + targets, WIDTH - 4, "    "), f") = {value}"]
