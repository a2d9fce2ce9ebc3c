"""The LaTeX printer: node by node, and every formula read back as numbers."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
import sympy as sp

from pne_sym import manipulators
from pne_sym.backends.glyphs import Glyph, visible_width
from pne_sym.backends.latex import LatexPrinter
from pne_sym.backends.report.names import printer_for
from pne_sym.derivation import Derivation, Equation, full_names, leg_sums, names_in
from pne_sym.mechanics.derive import derive
from pne_sym.mechanics.notation import TAKEN
from pne_sym.model.manipulator import Manipulator
from pne_sym.vector import (
    Axial,
    Compose,
    Cross,
    Dot,
    DualScalar,
    DualVector,
    Identity,
    Outer,
    Skew,
    TensorSymbol,
    Trace,
    Transpose,
    VectorSymbol,
    ZeroTensor,
    ZeroVector,
    norm,
    sum_over_legs,
)
from pne_sym.vector.evaluate import evaluate
from tests.backends.formulas import Reader
from tests.sampling import entries, sampled
from tests.whole.test_coupling import coupled

A, B, C = (VectorSymbol(name) for name in "abc")
T, S = TensorSymbol("T"), TensorSymbol("S", True)
X, Y, M = sp.symbols("x y m", real=True)
SYMBOLS = {
    "a": r"\mathbf a", "b": r"\mathbf b_{2}", "c": r"\mathbf c^{\circ}", "T": r"\mathbf T",
    "S": r"\mathbf S'", "x": "x", "y": r"y_{1}^2", "m": "m_{3}",
}  # fmt: skip
PRINTER = LatexPrinter(SYMBOLS, {"b": "ups", "m": "ups"}, {"ups": "i"})


@pytest.mark.parametrize(
    ("expression", "latex"),
    [
        (A, r"\mathbf a"),
        (-A, r"-\mathbf a"),
        (A - B, r"\mathbf a - \mathbf b_2"),
        (2 * A, r"2\,\mathbf a"),
        (X * (A - B), r"x\,(\mathbf a - \mathbf b_2)"),
        (A / X, r"\frac{\mathbf a}{x}"),
        (A * X / M, r"\frac{x}{m_3}\,\mathbf a"),
        (A / 2, r"\frac{\mathbf a}{2}"),
        (Cross(A, B), r"\mathbf a\times\mathbf b_2"),
        (Cross(A, Cross(A, B)), r"\mathbf a\times(\mathbf a\times\mathbf b_2)"),
        (Cross(Cross(A, B), A), r"(\mathbf a\times\mathbf b_2)\times\mathbf a"),
        (Cross(A, T @ B), r"\mathbf a\times\mathbf T\,\mathbf b_2"),
        (Cross(T @ A, B), r"(\mathbf T\,\mathbf a)\times\mathbf b_2"),
        (-Cross(A, B), r"-\mathbf a\times\mathbf b_2"),
        (Dot(A, B) * A, r"(\mathbf a\cdot\mathbf b_2)\,\mathbf a"),
        (Dot(A, A) * A, r"\lVert \mathbf a\rVert^2\,\mathbf a"),
        (B / norm(A), r"\frac{\mathbf b_2}{\lVert \mathbf a\rVert}"),
        (Dot(A, B + C), r"\mathbf a\cdot(\mathbf b_2 + \mathbf c^{\circ})"),
        (X - Dot(A, B), r"x - \mathbf a\cdot\mathbf b_2"),
        (-X * Dot(A, B), r"-x\,(\mathbf a\cdot\mathbf b_2)"),
        (T @ (A - B), r"\mathbf T\,(\mathbf a - \mathbf b_2)"),
        ((T - S) @ A, r"(\mathbf T - \mathbf S^{\prime})\,\mathbf a"),
        ((-T - S) @ A, r"-(\mathbf T + \mathbf S^{\prime})\,\mathbf a"),
        (Compose(Skew(A), Skew(B)), r"\tilde{\mathbf a}\,\tilde{\mathbf b}_2"),
        (Skew(A + B), r"\widetilde{(\mathbf a + \mathbf b_2)}"),
        (Outer(A, B), r"\mathbf a\,\mathbf b_2^{\mathsf T}"),
        (Outer(A, C), r"\mathbf a\,(\mathbf c^{\circ})^{\mathsf T}"),
        (Transpose(T) @ A, r"\mathbf T^{\mathsf T}\,\mathbf a"),
        (Transpose(T @ T), r"(\mathbf T\,\mathbf T)^{\mathsf T}"),
        (Trace(T), r"\mathrm{tr}(\mathbf T)"),
        (2 * Trace(3 * T), r"6\,\mathrm{tr}(\mathbf T)"),
        (Axial(T @ S), r"\mathrm{ax}(\mathbf T\,\mathbf S^{\prime})"),
        (X * Identity - T, r"x\,\mathbf E - \mathbf T"),
        (ZeroVector, r"\mathbf 0"),
        (ZeroTensor, r"\mathbf 0"),
        (X**2 - M**2, r"x^2 - m_3^2"),
        (Y**2, r"(y_1^2)^2"),
        (Dot(A, B) ** 2, r"(\mathbf a\cdot\mathbf b_2)^2"),
        (Dot(A, A) ** 2, r"(\lVert \mathbf a\rVert^2)^2"),
        (sp.cos(X) ** 2, r"(\cos(x))^2"),
        ((X + 1) ** 2, r"(1 + x)^2"),
        (-X * (A + B), r"-x\,(\mathbf a + \mathbf b_2)"),
        ((-A - B) / X, r"-\frac{\mathbf a + \mathbf b_2}{x}"),
        (sp.sqrt(X**2 + M**2), r"\sqrt{m_3^2 + x^2}"),
        (1 / sp.sqrt(X), r"\frac{1}{\sqrt{x}}"),
        (X / (M + 1), r"\frac{x}{1 + m_3}"),
        ((X + 1) * M, r"m_3\,(1 + x)"),
        ((X + M) / 2, r"\frac{m_3 + x}{2}"),
        (sp.atan2(-X, M), r"\mathrm{atan2}(-x,\,m_3)"),
        (sp.cos(X) * M - sp.sin(X), r"m_3\,\cos(x) - \sin(x)"),
        (sum_over_legs(B, "ups"), r"\sum_i \mathbf b_{2,i}"),
        (A - sum_over_legs(M * B, "ups"), r"\mathbf a - \sum_i m_{3,i}\,\mathbf b_{2,i}"),
        (A + sum_over_legs(-B, "ups"), r"\mathbf a - \sum_i \mathbf b_{2,i}"),
        (X + sum_over_legs(M, "ups"), r"x + \sum_i m_{3,i}"),
        (sum_over_legs(T - S, "ups"), r"\sum_i (\mathbf T - \mathbf S^{\prime})"),
        (
            DualVector(sp.Integer(1), sp.Tuple(A, B, C), sp.Tuple()),
            r"\left[\mathcal V^{-1}\right]_{2,\,\mathrm F}",
        ),
        (
            DualScalar(sp.Integer(1), sp.Integer(0), sp.Tuple(A, B, C), sp.Tuple()),
            r"\left[\mathcal V^{-1}\right]_{2,\,\mathrm M_1}",
        ),
    ],
)
def test_nodes(expression: Any, latex: str) -> None:
    assert PRINTER.doprint(expression) == latex


def test_unknown_name_is_an_error() -> None:
    with pytest.raises(KeyError):
        PRINTER.doprint(VectorSymbol("unheard_of"))


def test_unknown_node_is_an_error() -> None:
    with pytest.raises(TypeError, match="no LaTeX"):
        PRINTER.doprint(TensorSymbol.__mro__[2]())


@pytest.mark.parametrize(
    ("latex", "base", "sub", "sup"),
    [
        (r"\mathbf h_{2}", r"\mathbf h", "2", ""),
        (r"\ddot{\mathbf S}'^{\circ}", r"\ddot{\mathbf S}", "", r"\prime\circ"),
        (r"\mathbf B^{\circ}_{2}", r"\mathbf B", "2", r"\circ"),
        (r"\mathbf u_1", r"\mathbf u", "1", ""),
        (r"\mathbf R_\alpha", r"\mathbf R", r"\alpha", ""),
        (r"\mathbf h^*", r"\mathbf h", "", "*"),
        (r"\mathbf G^{(y_2)}", r"\mathbf G", "", "(y_2)"),
    ],
)
def test_glyph_parts(latex: str, base: str, sub: str, sup: str) -> None:
    assert Glyph.of(latex) == Glyph(base, sub, sup)


@pytest.mark.parametrize("latex", ["x_", "x^", "{x", "x}"])
def test_broken_symbol(latex: str) -> None:
    with pytest.raises(ValueError, match=r"script|braces"):
        Glyph.of(latex)


def test_width_counts_what_is_seen() -> None:
    assert visible_width(r"\boldsymbol\omega\times\mathbf r") == visible_width(r"a\times b")
    assert visible_width(r"\frac{abc}{d}") == 3


@pytest.fixture(scope="module", params=entries())
def manipulator(request: pytest.FixtureRequest) -> Manipulator:
    return manipulators.load(request.param)


@pytest.fixture(scope="module")
def derivation(manipulator: Manipulator) -> Derivation:
    return derive(manipulator)


def test_formulas_read_back(derivation: Derivation) -> None:
    """Every right-hand side and form, read as people read it, has the value it stands for."""
    rng = np.random.default_rng(7)
    printer = printer_for(derivation)
    for equation in derivation.equations():
        for expression in _readable(equation):
            symbols = {n: printer.symbols[n] for n in sorted(names_in(expression))}
            drawn = {latex: _random(derivation, n, rng) for n, latex in symbols.items()}
            values = {n: drawn[latex] for n, latex in symbols.items()}
            printed = printer.doprint(expression)
            np.testing.assert_allclose(
                Reader(symbols, values).read(printed),
                evaluate(expression, values),
                rtol=1e-9,
                atol=1e-9,
                err_msg=f"{equation.id}: {printed}",
            )


def _readable(equation: Equation) -> list[Any]:
    """What can be evaluated: no sums over legs, no inverse of a matrix told elsewhere."""
    found = [e for e in (equation.rhs, *equation.forms) if not leg_sums(e)]
    return [e for e in found if not isinstance(e, DualVector | DualScalar) and e != ZeroVector]


def _random(derivation: Derivation, name: str, rng: np.random.Generator) -> Any:
    """A value of the right kind; scalars are positive, for the roots."""
    symbols = {e.name: e.lhs for e in derivation.equations()}
    symbols |= {g.symbol.name: g.symbol for g in derivation.givens}
    symbol = symbols.get(name)
    if isinstance(symbol, VectorSymbol):
        return rng.normal(size=3)
    if isinstance(symbol, TensorSymbol):
        value = rng.normal(size=(3, 3))
        return value + value.T if symbol.is_symmetric else value
    return float(rng.uniform(1.0, 2.0))


@pytest.mark.parametrize(
    "name", sampled(manipulators.names(), 0, keep=("planar_3rpr", "hybrid_3rrrs"))
)
def test_symbols_of_what_acts_in_joints_are_distinct(name: str) -> None:
    found = coupled(name)
    are_distinct(found, derive(found))


def test_symbols_are_distinct(manipulator: Manipulator, derivation: Derivation) -> None:
    are_distinct(manipulator, derivation)


def are_distinct(manipulator: Manipulator, derivation: Derivation) -> None:
    """Within a leg's chapters and the platform's no two quantities are written alike.

    Letters are told apart without their weight.
    """
    printer = printer_for(derivation)
    used = {
        n for e in derivation.equations() for x in (e.lhs, e.rhs, *e.forms) for n in names_in(x)
    }
    # those of the specification may be shared: checked where they are read
    chosen = {n for name, _ in manipulator.symbols for n in full_names(derivation, name)}
    directions = re.compile(rf"({'|'.join(t.name for t in derivation.leg_types)})_unit\d_")
    seen: dict[tuple[str, str], str] = {}
    for name in sorted(used):
        if directions.match(name):
            continue  # coordinate directions: the same three, whatever they are used for
        light = without_weight(str(Glyph.of(printer.symbols[name])))
        assert light not in map(without_weight, TAKEN), name
        key = (light, printer.per_leg.get(name, ""))
        other = seen.setdefault(key, name)
        assert other == name or {other, name} <= chosen, f"{name} and {other} are both {light}"


def without_weight(latex: str) -> str:
    return re.sub(r"\\(?:mathbf|boldsymbol)(?![a-z])|[{}\s]", "", latex)


def test_every_quantity_has_notation(derivation: Derivation) -> None:
    for equation in derivation.equations():
        assert derivation.notation[equation.name].latex
        assert derivation.notation[equation.name].meaning
