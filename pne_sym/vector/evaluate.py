"""Numeric values of vector expressions: the meaning of every node, in one place.

Used to verify derivations line by line; it shares nothing with the lowering.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import sympy as sp

from pne_sym.vector import nodes as n


def skew(a: Any) -> Any:
    """Matrix of the cross product, (3,) -> (3, 3)."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def evaluate(expr: Any, values: Mapping[str, Any]) -> Any:
    """Value of an expression, components in one common frame.

    Args:
        expr: vector, tensor or scalar expression without sums over legs.
        values: by name; arrays (3,) for vectors (in the plane the last component is
            zero), (3, 3) for tensors, floats for scalars.

    Raises:
        KeyError: a name has no value.
        TypeError: the node has no numeric meaning here.
    """
    if isinstance(expr, n.VectorSymbol | n.TensorSymbol | sp.Symbol):
        return values[expr.name]
    if expr == n.ZeroVector:
        return np.zeros(3)
    if expr == n.ZeroTensor:
        return np.zeros((3, 3))
    if expr == n.Identity:
        return np.eye(3)
    if isinstance(expr, sp.Number):
        return float(expr)
    if isinstance(expr, n.DualVector | n.DualScalar):
        return _reciprocal(expr, values)
    args = [evaluate(arg, values) for arg in expr.args]
    operation = _OPERATIONS.get(type(expr))
    if operation is None:
        raise TypeError(f"no numeric meaning for {type(expr).__name__}")
    return operation(*args)


def _reciprocal(expr: Any, values: Mapping[str, Any]) -> Any:
    """Force part, or one entry of the moment part, of a reciprocal wrench."""
    *indices, vectors, rows = expr.args
    screws = np.array([evaluate(v, values) for v in vectors]).T
    for row in rows:
        screws = np.vstack((screws, [evaluate(entry, values) for entry in row]))
    wrench = np.linalg.inv(screws)[int(indices[0])]
    return wrench[:3] if len(indices) == 1 else float(wrench[3 + int(indices[1])])


def _axial(t: Any) -> Any:
    return np.array([t[2, 1] - t[1, 2], t[0, 2] - t[2, 0], t[1, 0] - t[0, 1]])


def _cross(a: Any, b: Any) -> Any:
    """As `numpy.cross`, which takes five times as long for two vectors."""
    (a_x, a_y, a_z), (b_x, b_y, b_z) = a, b
    return np.array([a_y * b_z - a_z * b_y, a_z * b_x - a_x * b_z, a_x * b_y - a_y * b_x])


def _power(base: Any, exponent: Any) -> Any:
    """As arrays do it: infinite for a division by zero, NaN for the root of a negative number."""
    with np.errstate(all="ignore"):
        return np.float64(base) ** exponent


_OPERATIONS: dict[type, Any] = {
    n.VectorAdd: lambda *terms: sum(terms),
    n.TensorAdd: lambda *terms: sum(terms),
    n.VectorScale: lambda s, a: s * a,
    n.TensorScale: lambda s, a: s * a,
    n.Cross: _cross,
    n.Dot: lambda a, b: float(np.dot(a, b)),
    n.Trace: lambda t: float(np.trace(t)),
    n.Apply: lambda t, a: t @ a,
    n.Compose: lambda t, s: t @ s,
    n.Transpose: lambda t: t.T,
    n.Skew: skew,
    n.Outer: np.outer,
    n.Axial: _axial,
    sp.Add: lambda *terms: sum(terms),
    sp.Mul: lambda *factors: np.prod(factors),
    sp.Pow: _power,
    sp.sin: np.sin,
    sp.cos: np.cos,
    sp.atan2: np.arctan2,
    sp.acos: np.arccos,
}
