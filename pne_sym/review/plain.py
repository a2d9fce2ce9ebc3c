"""Expressions as plain text, the way people type them: `t + q - b`, `omega x (omega x r)`."""

from __future__ import annotations

from typing import Any

import sympy as sp

from pne_sym.vector import nodes as n

_SUM, _CROSS, _PRODUCT, _ATOM = range(4)
_Piece = tuple[str, int]
"""A text and how tightly it binds."""


def plain(expr: Any) -> str:
    """A vector, tensor or scalar expression as plain text.

    `x` is the cross product, `.` the scalar product, `*` any other; `[a]x` is the tensor
    of the cross product with a, `a b^T` the product tensor, `E` the identity.

    >>> from pne_sym.vector import Cross, VectorSymbol
    >>> w, r = VectorSymbol("omega"), VectorSymbol("r")
    >>> plain(-Cross(w, Cross(w, r)))
    '-omega x (omega x r)'
    """
    return _piece(expr)[0]


def _piece(expr: Any) -> _Piece:
    if isinstance(expr, n.VectorSymbol | n.TensorSymbol | sp.Symbol):
        return str(expr.name), _ATOM
    if expr in (n.ZeroVector, n.ZeroTensor):
        return "0", _ATOM
    if expr is n.Identity:
        return "E", _ATOM
    if isinstance(expr, n.VectorAdd | n.TensorAdd):
        return _sum([plain(arg) for arg in expr.args]), _SUM
    if isinstance(expr, n.VectorScale | n.TensorScale):
        return _scaled(expr.args[0], expr.args[1])
    printer = _NODES.get(type(expr))
    return printer(*expr.args) if printer else _scalar(sp.sympify(expr))


def _sum(terms: list[str]) -> str:
    text = terms[0]
    for term in terms[1:]:
        text += f" - {term[1:]}" if term.startswith("-") else f" + {term}"
    return text


def _wrap(expr: Any, least: int) -> str:
    """An operand, in brackets where it binds less than needed."""
    text, level = _piece(expr)
    return text if level >= least and not text.startswith("-") else f"({text})"


def _scaled(factor: Any, of: Any) -> _Piece:
    if factor == -1:
        return f"-{_wrap(of, _CROSS)}", _SUM
    negative = factor.could_extract_minus_sign() and not factor.is_Add
    text, level = _piece(-factor if negative else factor)
    if level < _PRODUCT:
        text = f"({text})"
    return f"{'-' if negative else ''}{text} * {_wrap(of, _PRODUCT)}", _PRODUCT


def _scalar(expr: Any) -> _Piece:
    if isinstance(expr, sp.Add):
        return _sum([plain(arg) for arg in sp.ordered(expr.args)]), _SUM
    if isinstance(expr, sp.Mul):
        return _product(expr)
    if isinstance(expr, sp.Pow):
        return _power(*expr.args)
    if isinstance(expr, sp.Function):
        return f"{expr.func.__name__}({', '.join(map(plain, expr.args))})", _ATOM
    if isinstance(expr, sp.Float):
        return f"{float(expr):g}", _ATOM
    if isinstance(expr, sp.Number):
        return str(expr), _ATOM if expr >= 0 and expr.is_Integer else _PRODUCT
    return str(expr), _ATOM


def _product(expr: Any) -> _Piece:
    sign = "-" if expr.could_extract_minus_sign() else ""
    above, below = [], []
    for factor in sp.Mul.make_args(-expr if sign else expr):
        if factor.is_Rational and factor.q != 1:
            below.append(str(factor.q))
            above += [str(factor.p)] if factor.p != 1 else []
        elif factor.is_Pow and factor.exp.could_extract_minus_sign():
            below.append(_wrap(1 / factor, _ATOM))
        else:
            above.append(_wrap(factor, _PRODUCT))
    text = " * ".join(above) or "1"
    if below:
        text += f" / {below[0]}" if len(below) == 1 else f" / ({' * '.join(below)})"
    return sign + text, _PRODUCT


def _power(base: Any, exponent: Any) -> _Piece:
    if exponent == sp.Rational(1, 2):
        if isinstance(base, n.Dot) and base.args[0] == base.args[1]:
            return f"|{plain(base.args[0])}|", _ATOM
        return f"sqrt({plain(base)})", _ATOM
    if exponent.could_extract_minus_sign():
        return f"1 / {_wrap(base**-exponent, _ATOM)}", _PRODUCT
    return f"{_wrap(base, _ATOM)}^{exponent}", _ATOM


def _dual(index: Any, vectors: Any, rows: Any) -> _Piece:
    parts = ", ".join(map(plain, vectors))
    moments = "".join(f"; {', '.join(map(plain, row))}" for row in rows)
    return f"reciprocal_{int(index) + 1}({parts}{moments})", _ATOM


def _dual_scalar(index: Any, moment: Any, vectors: Any, rows: Any) -> _Piece:
    return f"moment_{int(moment) + 1} of {_dual(index, vectors, rows)[0]}", _PRODUCT


def _leg_sum(value: Any, leg_type: Any) -> _Piece:
    return f"sum over {leg_type} of ({plain(value)})", _CROSS


_NODES: dict[type, Any] = {
    n.Cross: lambda a, b: (f"{_wrap(a, _PRODUCT)} x {_wrap(b, _PRODUCT)}", _CROSS),
    n.Dot: lambda a, b: (f"{_wrap(a, _PRODUCT)} . {_wrap(b, _PRODUCT)}", _CROSS),
    n.Skew: lambda a: (f"[{plain(a)}]x", _ATOM),
    n.Axial: lambda a: (f"axial({plain(a)})", _ATOM),
    n.Trace: lambda a: (f"trace({plain(a)})", _ATOM),
    n.Apply: lambda a, b: (f"{_wrap(a, _ATOM)} * {_wrap(b, _ATOM)}", _PRODUCT),
    n.Compose: lambda a, b: (f"{_wrap(a, _ATOM)} * {_wrap(b, _ATOM)}", _PRODUCT),
    n.Outer: lambda a, b: (f"{_wrap(a, _ATOM)} {_wrap(b, _ATOM)}^T", _PRODUCT),
    n.Transpose: lambda a: (f"{_wrap(a, _ATOM)}^T", _ATOM),
    n.DualVector: _dual,
    n.DualScalar: _dual_scalar,
    n.VectorLegSum: _leg_sum,
    n.TensorLegSum: _leg_sum,
    n.LegSum: _leg_sum,
}
