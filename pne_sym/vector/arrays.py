"""Equations between whole arrays, of all legs: what is no sum over legs.

>>> columns = Relation("columns", "what motors do", product("H", transposed("C")), "coupling")
>>> columns.uses
('H', 'C')
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial


@dataclass(frozen=True)
class Applied:
    """An operation of arrays.

    Attributes:
        operation: its name in `pne_sym.program.operations`.
        operands: other operations, and arrays by name.
    """

    operation: str
    operands: tuple[Applied | str, ...]


@dataclass(frozen=True)
class Relation:
    """An equation that defines a whole array; steps of public functions are made of it.

    Attributes:
        id: cited in report and code: the name of the array that it defines.
        title: what the equation says, in words.
        rhs: expression of arrays of the program, of inputs and of relations before.
        law: why it holds.
    """

    id: str
    title: str
    rhs: Applied
    law: str

    @property
    def uses(self) -> tuple[str, ...]:
        """Arrays on the right-hand side, in order, each once."""
        return tuple(dict.fromkeys(_arrays(self.rhs)))


def _arrays(expr: Applied | str) -> list[str]:
    if isinstance(expr, str):
        return [expr]
    return [name for operand in expr.operands for name in _arrays(operand)]


def _applied(operation: str, *operands: Applied | str) -> Applied:
    return Applied(operation, operands)


transposed = partial(_applied, "transposed")
"""The transpose of a matrix."""
product = partial(_applied, "product")
"""A product of matrices."""
times = partial(_applied, "times")
"""A matrix times a vector."""
scale_rows = partial(_applied, "multiply")
"""diag(d) x, of d and a vector x."""
scale_columns = partial(_applied, "scale_columns")
"""A diag(d), of a matrix A and d."""
solution = partial(_applied, "solve")
"""The x with a x = b, of a and b."""


def written(expr: Applied | str, names: dict[str, str], forms: dict[str, str]) -> str:
    """An expression as text.

    Args:
        expr: of arrays.
        names: array -> text; others stand as they are.
        forms: operation -> text, with {0}, {1} for its operands.
    """
    if isinstance(expr, str):
        return names.get(expr, expr)
    return forms[expr.operation].format(*(written(o, names, forms) for o in expr.operands))
