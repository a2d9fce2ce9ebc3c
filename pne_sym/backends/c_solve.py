"""Small systems of linear equations in C, eliminated straight through in the order of home."""

from __future__ import annotations

from pne_sym.backends.c_text import Routine, in_pairs, listing, side_by_side, statement
from pne_sym.backends.orders import GROWTH, SMALLEST, Order


def tables(order: Order, name: str) -> list[str]:
    """Declarations of the rows `order_NAME` and the sizes `sizes_NAME`."""
    rows, sizes = (", ".join(map(str, v)) for v in (order.rows, (4.0**s for s in order.sizes)))
    return [
        *listing(f"static const size_t order_{name}[] = {{", [rows], "};"),
        *listing(f"static const real sizes_{name}[] = {{", [sizes], "};"),
    ]


class Eliminations:
    """Routines that solve small systems, and tables of their orders, each written once.

    Attributes:
        before: texts that the next function needs before it; taken by whoever prints it.
    """

    def __init__(self) -> None:
        self.before: list[str] = []
        self._routines: dict[int, Routine] = {}
        self._orders: dict[Order, str] = {}

    def routine(self, n: int) -> Routine:
        """Of n equations."""
        if n not in self._routines:
            self._routines[n] = elimination(n)
            self.before.append("\n".join(self._routines[n].definition()))
        return self._routines[n]

    def order(self, order: Order, solved: str, function: str) -> str:
        """Name of the tables of an order: what is solved first with it, in full if need be."""
        if order not in self._orders:
            name = f"{function}_{solved}" if solved in self._orders.values() else solved
            self._orders[order] = name
            self.before.append("\n".join(tables(order, name)))
        return self._orders[order]

    def taken(self) -> list[str]:
        """The texts, which are no longer needed before the function after that."""
        texts, self.before = self.before, []
        return texts


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
    body = tuple(side_by_side("w", lines))
    return Routine(f"eliminate_{n}", parameters, body)


def _pivots(p: int, n: int) -> list[str]:
    """Multiples of rows p and p + 1 are subtracted from the rows further down."""
    q, lines = p + 1, [f"const real f{p} = 1/a{p}{p};"]
    if q == n:
        return lines
    lines.append(f"const real d{q} = a{p}{p}*a{q}{q} - a{q}{p}*a{p}{q};")
    lines.append(f"const real f{q} = a{p}{p}/d{q};")
    for r in (p, q):
        for i in range(r + 1, n):
            g = f"g{i}{r}"
            lines.append(f"const real {g} = a{i}{r}*f{r};")
            lines += [f"a{i}{j} -= {g}*a{r}{j};" for j in range(r + 1 + (i == q), n)]
            lines.append(f"b{i} -= {g}*b{r};")
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
