"""Equations between whole arrays, of all legs: what is no sum over legs.

>>> columns = Relation("columns", "what motors do", product("H", transposed("C")), "coupling")
>>> columns.uses
('H', 'C')
"""

from __future__ import annotations

from dataclasses import dataclass


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


def transposed(a: Applied | str) -> Applied:
    """The transpose of a matrix."""
    return Applied("transposed", (a,))


def product(a: Applied | str, b: Applied | str) -> Applied:
    """A product of matrices."""
    return Applied("product", (a, b))


def times(a: Applied | str, x: Applied | str) -> Applied:
    """A matrix times a vector."""
    return Applied("times", (a, x))


def scale_rows(d: Applied | str, x: Applied | str) -> Applied:
    """diag(d) x, of a vector x."""
    return Applied("multiply", (d, x))


def scale_columns(a: Applied | str, d: Applied | str) -> Applied:
    """A diag(d), of a matrix."""
    return Applied("scale_columns", (a, d))


def solution(a: Applied | str, b: Applied | str) -> Applied:
    """The x with a x = b."""
    return Applied("solve", (a, b))


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
