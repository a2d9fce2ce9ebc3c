"""Scalar and tensor expressions of a derivation as statements: their values are kept."""

from __future__ import annotations

from typing import Any

import pytest
import sympy as sp

from pne_sym.derivation import Book, Derivation, Law, Output
from pne_sym.lowering.builder import Builder
from pne_sym.lowering.components import Lowering
from pne_sym.vector import Axial, Compose, Skew, TensorSymbol, VectorSymbol
from tests.lowering.numbers import inputs, run, value
from tests.models import bundle, catalogue

X, Y = sp.symbols("x y", real=True)
VALUES = {"x": 1.7, "y": 0.6}


def derivation() -> Derivation:
    """A derivation of nothing but a scalar."""
    book = Book()
    book.chapter("T", "Test", "")
    one = book.define("one", sp.Integer(1), "1", "one", Law.DEFINITION)
    book.outputs.append(Output("potential", one, ((0, 0),)))
    return book.close()


def lowered(expr: Any) -> float:
    """The value of an expression by its statements."""
    builder = Builder()
    known = {s: VALUES[s.name] for s in inputs(builder, VALUES)}
    atom = Lowering(derivation(), builder).scalar(expr)
    return value(atom, run(builder.statements, known))


@pytest.mark.parametrize(
    "expr",
    [
        X**2,
        X**3,
        X**-1,
        X**-2,
        X**-3 * Y,
        sp.sqrt(X),
        1 / sp.sqrt(X),
        Y / sp.sqrt(X),
        X * Y / sp.sqrt(X + Y),
        sp.sqrt(X) * sp.sqrt(X),
        (X - Y) / (X + Y) ** 2,
        sp.atan2(X, -Y),
        sp.sin(X) * sp.cos(Y) - sp.Rational(1, 2),
        sp.sqrt(sp.Integer(4)) * X,
    ],
    ids=str,
)
def test_scalars_keep_their_value(expr: Any) -> None:
    wanted = float(expr.subs({X: VALUES["x"], Y: VALUES["y"]}))
    assert lowered(expr) == pytest.approx(wanted, rel=1e-14)


def test_other_powers_are_refused() -> None:
    with pytest.raises(TypeError, match="no power"):
        lowered(X ** sp.Rational(1, 3))


@pytest.mark.parametrize(
    "tensor", [Skew(VectorSymbol("a")), Compose(TensorSymbol("B", False), TensorSymbol("C", False))]
)
def test_axial_vectors_are_of_products_with_symmetric_tensors(tensor: Any) -> None:
    with pytest.raises(TypeError, match="axial vector"):
        Lowering(derivation(), Builder()).vector(Axial(tensor), "base")


@pytest.mark.parametrize(("also_stored", "operations"), [(False, 2), (True, 4)])
def test_what_nothing_else_uses_is_left_out(also_stored: bool, operations: int) -> None:
    """A form that does without it then costs less; what is there anyway costs nothing."""
    book = Book()
    book.chapter("T", "Test", "")
    for name in VALUES:
        book.parameters.add_branch(name, "", ())
    inner = book.define("inner", X * Y + X + Y, "i", "inner", Law.DEFINITION)
    outer = book.define("outer", X * inner, "o", "outer", Law.DEFINITION, forms=(X * Y + 3,))
    book.outputs.append(Output("potential", outer, ((0, 0),)))
    if also_stored:
        book.outputs.append(Output("potential", inner, ((1, 0),)))
    builder = Builder()
    inputs(builder, VALUES)
    of = Lowering(book.close(), builder, book.outputs)
    stored = [of.scalar(output.value) for output in book.outputs]
    builder.keep_nothing()
    assert builder.cost(stored) == operations


def test_the_square_of_a_root_is_tested_in_the_form_that_it_took() -> None:
    """The length across the first axis: another form's would be of values that nothing needs."""
    for function in bundle(catalogue("stewart")).program.functions.values():
        block = next(b for b in function.blocks if b.leg_type)
        made = {a.target: a.expr for a in block.assignments}
        if {"ups_root_1", "ups_c_1"} & {target.name for target in made}:
            (check,) = (c for c in block.checks if c.equation == "ups-root_1")
            assert made[check.value].is_Add, function.name
