"""Random expressions of the vector algebra, and numbers for the names in them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from pne_sym.vector import (
    Axial,
    Cross,
    Dot,
    Identity,
    LinearForm,
    Outer,
    Skew,
    TensorSymbol,
    Transpose,
    VectorSymbol,
    norm,
)
from pne_sym.vector.evaluate import evaluate

Array = NDArray[np.float64]


def real(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)


VECTORS = tuple(VectorSymbol(name) for name in "abc")
TENSORS = (TensorSymbol("T"), TensorSymbol("V"), TensorSymbol("J", True))
SCALARS = (real("k"), real("m"))
VECTOR_UNKNOWNS = (VectorSymbol("x"), VectorSymbol("y"))
SCALAR_UNKNOWNS = (real("s"), real("r"))
UNKNOWNS = (*VECTOR_UNKNOWNS, *SCALAR_UNKNOWNS)
KNOWN_VECTOR, KNOWN_SCALAR = VectorSymbol("z"), real("w")
KNOWN = {
    KNOWN_VECTOR: LinearForm(
        {
            VECTOR_UNKNOWNS[0]: TensorSymbol("Czx"),
            VECTOR_UNKNOWNS[1]: Identity,
            SCALAR_UNKNOWNS[0]: VectorSymbol("czs"),
        },
        VectorSymbol("z0"),
    ),
    KNOWN_SCALAR: LinearForm(
        {VECTOR_UNKNOWNS[0]: VectorSymbol("cwx"), SCALAR_UNKNOWNS[1]: real("cwr")}, real("w0")
    ),
}


def random_values(rng: np.random.Generator) -> dict[str, Any]:
    """Numbers for every name; `z` and `w` by their linear forms."""
    values: dict[str, Any] = {}
    for symbol in (*VECTORS, *VECTOR_UNKNOWNS, *map(VectorSymbol, ("czs", "z0", "cwx"))):
        values[symbol.name] = rng.uniform(-2.0, 2.0, 3)
    for tensor in (*TENSORS, TensorSymbol("Czx")):
        matrix = rng.uniform(-2.0, 2.0, (3, 3))
        values[tensor.name] = matrix + matrix.T if tensor.is_symmetric else matrix
    for scalar in (*SCALARS, *SCALAR_UNKNOWNS, real("cwr"), real("w0")):
        values[scalar.name] = float(rng.uniform(0.3, 2.0))
    for symbol, form in KNOWN.items():
        values[symbol.name] = value_of_form(form, values)
    return values


def value_of_form(form: LinearForm, values: dict[str, Any]) -> Any:
    """The sum of coefficient times unknown, plus the remainder."""
    total = evaluate(form.remainder, values)
    for unknown, coefficient in form.coefficients.items():
        c, x = evaluate(coefficient, values), values[unknown.name]
        total = total + (c * x if isinstance(unknown, sp.Symbol) else c @ x)
    return total


@dataclass
class Maker:
    """Draws expressions; those called linear are linear in the unknowns."""

    rng: np.random.Generator
    drawn: set[str] = field(default_factory=set)

    def _pick(self, *makers: Any) -> Any:
        return makers[self.rng.integers(len(makers))]()

    def _of(self, symbols: Any) -> Any:
        return symbols[self.rng.integers(len(symbols))]

    # ---- without unknowns ---------------------------------------------------------------

    def vector(self, depth: int) -> Any:
        if depth == 0:
            return self._of(VECTORS)
        d = depth - 1
        makers = [
            lambda: self.vector(d) + self.vector(d),
            lambda: self.vector(d) - self.vector(d),
            lambda: self.scalar(d) * self.vector(d),
            lambda: self.tensor(d) @ self.vector(d),
        ]
        makers += [
            lambda: Cross(self.vector(d), self.vector(d)),
            lambda: Axial(self.tensor(d)),
        ]
        return self._pick(*makers)

    def tensor(self, depth: int) -> Any:
        if depth == 0:
            return self._of((*TENSORS, Identity))
        d = depth - 1
        makers = [
            lambda: self.tensor(d) + self.tensor(d),
            lambda: self.scalar(d) * self.tensor(d),
            lambda: self.tensor(d) @ self.tensor(d),
            lambda: Outer(self.vector(d), self.vector(d)),
            lambda: Transpose(self.tensor(d)),
        ]
        makers.append(lambda: Skew(self.vector(d)))
        return self._pick(*makers)

    def scalar(self, depth: int) -> Any:
        if depth == 0:
            return self._of((*SCALARS, sp.Integer(2), sp.Rational(-1, 2)))
        d = depth - 1
        makers = [
            lambda: self.scalar(d) + self.scalar(d),
            lambda: self.scalar(d) * self.scalar(d),
            lambda: Dot(self.vector(d), self.vector(d)),
            lambda: norm(self._of(VECTORS)),
            lambda: self._pick(
                lambda: sp.sin(SCALARS[0]),
                lambda: sp.cos(SCALARS[1]),
                lambda: sp.sqrt(SCALARS[0]),
                lambda: 1 / SCALARS[1],
                lambda: SCALARS[0] ** 2,
                lambda: 1 / sp.sqrt(SCALARS[1]),
                lambda: sp.atan2(*SCALARS),
            ),
        ]
        return self._pick(*makers)

    # ---- linear in the unknowns ----------------------------------------------------------

    def linear_vector(self, depth: int) -> Any:
        if depth == 0:
            return self._of((*VECTOR_UNKNOWNS, KNOWN_VECTOR, *VECTORS))
        d = depth - 1
        makers = [
            lambda: self.linear_vector(d) + self.linear_vector(d),
            lambda: self.linear_vector(d) - self.linear_vector(d),
            lambda: self.scalar(d) * self.linear_vector(d),
            lambda: self.linear_scalar(d) * self.vector(d),
            lambda: self.tensor(d) @ self.linear_vector(d),
        ]
        makers += [
            lambda: Cross(self.vector(d), self.linear_vector(d)),
            lambda: Cross(self.linear_vector(d), self.vector(d)),
        ]
        return self._pick(*makers)

    def linear_scalar(self, depth: int) -> Any:
        if depth == 0:
            return self._of((*SCALAR_UNKNOWNS, KNOWN_SCALAR, *SCALARS))
        d = depth - 1
        makers = [
            lambda: self.linear_scalar(d) + self.linear_scalar(d),
            lambda: self.scalar(d) * self.linear_scalar(d),
            lambda: self.linear_scalar(d) / SCALARS[0],
            lambda: Dot(self.vector(d), self.linear_vector(d)),
            lambda: Dot(self.linear_vector(d), self.vector(d)),
        ]
        return self._pick(*makers)
