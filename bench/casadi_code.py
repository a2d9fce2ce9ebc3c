"""CasADi's C of the same equations: the program's statements as a CasADi graph.

Parameters are prepared outside, as in our C.  H tau = f is eliminated without pivots, in an order
of rows that suits home: CasADi's own solutions of symbolic systems are far longer.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import casadi
import numpy as np
import sympy as sp

from bench.cases import Array, Case
from pne_sym.program.ir import Assignment, Block, Function, Store
from pne_sym.program.slices import places_of

Graph = Any
"""Of CasADi: a scalar, or a column with an entry for each leg."""


def prepared_vector(case: Case) -> Array:
    """The prepared parameters, one behind the other."""
    return np.concatenate([case.prepared[name].ravel() for name in sorted(case.prepared)])


def _prepared(case: Case, vector: Graph) -> dict[str, Graph]:
    values, at = {}, 0
    for name in sorted(case.prepared):
        size = case.prepared[name].size
        values[name] = vector[at : at + size]
        at += size
    return values


def _value(expr: Any, values: Mapping[str, Graph]) -> Graph:
    """A scalar expression of the program."""
    if isinstance(expr, int | float):
        return float(expr)
    if expr.is_Symbol:
        return values[expr.name]
    if expr.is_Number:
        return float(expr)
    arguments = [_value(a, values) for a in expr.args]
    if expr.is_Add:
        return sum(arguments[1:], start=arguments[0])
    if expr.is_Mul:
        return math.prod(arguments[1:], start=arguments[0])
    if expr.is_Pow:
        root = casadi.sqrt(arguments[0]) if abs(expr.exp) == sp.S.Half else None
        power = math.prod([arguments[0]] * int(abs(expr.exp))) if root is None else root
        return 1.0 / power if expr.exp.is_negative else power
    return getattr(casadi, {"Abs": "fabs"}.get(expr.func.__name__, expr.func.__name__))(*arguments)


def _assign(assignments: Iterable[Assignment], values: dict[str, Graph]) -> None:
    for a in assignments:
        values[a.target.name] = _value(a.expr, values)


class _Traced:
    """A function of the program on symbols."""

    def __init__(self, case: Case, function: Function, inputs: Mapping[str, Graph]) -> None:
        self.program, self.function = case.bundle.program, function
        self.values = _prepared(case, inputs["prepared"])
        for vector in function.inputs:
            x = inputs[vector]
            self.values |= {f"{vector}_{k}": x[k] for k in range(x.shape[0])}
        shapes = self.program.shapes
        self.arrays = {a: casadi.SX.zeros(*(*shapes[a], 1)[:2]) for a in function.arrays}

    def outputs(self) -> dict[str, Graph]:
        """Arrays by name."""
        _assign(self.function.unpack, self.values)
        for block in self.function.blocks:
            self._block(block)
        return self.arrays

    def _block(self, block: Block) -> None:
        legs = self.program.leg_counts.get(block.leg_type, 1)
        _assign(block.assignments, self.values)
        for total in block.sums:
            self.values[total.target.name] = casadi.sum1(self._of_legs(total.expr, legs))
        for store in block.stores:
            self._store(store, legs)

    def _of_legs(self, value: Any, legs: int) -> Graph:
        found = casadi.SX(_value(value, self.values))
        return casadi.repmat(found, legs, 1) if found.shape[0] == 1 else found

    def _store(self, store: Store, legs: int) -> None:
        entries = self._of_legs(store.value, legs)
        for leg, (row, column) in enumerate(places_of(store, legs)):
            self.arrays[store.array][row, column] = entries[leg]


def _order(H: Array) -> list[int]:
    """Rows in the order of elimination with pivots."""
    H, rows = np.array(H), list(range(len(H)))
    for k in range(len(H)):
        best = k + int(np.argmax(np.abs(H[k:, k])))
        H[[k, best]], (rows[k], rows[best]) = H[[best, k]], (rows[best], rows[k])
        H[k + 1 :] -= np.outer(H[k + 1 :, k] / H[k, k], H[k])
    return rows


def _solution(H: Graph, f: Graph, order: list[int]) -> Graph:
    n = len(order)
    H, f = H[order, :], f[order]
    for k in range(n):
        inverse = 1.0 / H[k, k]
        for row in range(k + 1, n):
            factor = H[row, k] * inverse
            H[row, k:] -= factor * H[k, k:]
            f[row] -= factor * f[k]
    for k in reversed(range(n)):
        for other in range(k + 1, n):
            f[k] -= H[k, other] * f[other]
        f[k] /= H[k, k]
    return f


def _functions(case: Case) -> list[Any]:
    """Inverse dynamics and M, Z, H as functions of CasADi; matrices by rows."""
    m, functions = case.module(), case.bundle.program.functions
    X, V, A = (casadi.SX.sym(n, k) for n, k in (("X", m.NQ), ("V", m.NV), ("A", m.NV)))
    prepared = casadi.SX.sym("prepared", prepared_vector(case).size)
    inputs = {"X": X, "V": V, "A": A, "prepared": prepared}
    found = _Traced(case, functions["dynamics"], inputs).outputs()
    matrices = [casadi.densify(found[name].T) for name in "MZH"]
    dynamics = casadi.Function("casadi_dynamics", [X, V, prepared], matrices)
    found = _Traced(case, functions["required"], inputs).outputs()
    home = np.array(m.HOME_X)
    H = np.hstack([m.H(home), m.Hk(home)]) if m.NC else m.H(home)
    both = casadi.horzcat(found["H"], found["Hk"]) if m.NC else found["H"]
    forces = _solution(both, found["required"], _order(H))
    results = [casadi.densify(part) for part in (forces[: m.NU], forces[m.NU :]) if part.numel()]
    return [dynamics, casadi.Function("casadi_inverse_dynamics", [X, V, A, prepared], results)]


def write_casadi(case: Case) -> None:
    """casadi_code.c and .h in the model's folder; sizes are those of NAME.h."""
    options = {"with_header": True, "casadi_real": "double", "casadi_int": "int"}
    code = casadi.CodeGenerator("casadi_generated.c", options)
    for function in _functions(case):
        code.add(function)
    code.generate(f"{case.folder}/")
    text = (case.folder / "casadi_generated.c").read_text(encoding="utf-8")
    (case.folder / "casadi_code.c").write_text(text, encoding="utf-8")
    header = f'#include "{case.name}.h"\n#include "casadi_generated.h"\n'
    (case.folder / "casadi_code.h").write_text(header, encoding="utf-8")
