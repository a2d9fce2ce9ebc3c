"""A book of equations: every name once, nothing that nobody needs, forms in names that exist."""

from __future__ import annotations

from typing import Any

import pytest
import sympy as sp

from pne_sym.derivation import Book, Condition, Derivation, FailureStatus, Law, Output, Quantity
from pne_sym.vector import Cross, Dot, LinearForm, Outer, TensorSymbol, VectorSymbol, linear_form

a, b, x = VectorSymbol("a"), VectorSymbol("b"), VectorSymbol("x")


def book() -> Book:
    found = Book()
    for symbol in (a, b, x):
        found.give(symbol, "base", sp.symbols(f"{symbol.name}_x:z", real=True), _meaning(symbol))
    found.chapter("k-", "Kinematics", "How it moves.")
    return found


def _meaning(symbol: Any) -> Quantity:
    return Quantity(symbol.name, symbol.name, "given", "-")


def define(to: Book, name: str, rhs: Any, **more: Any) -> Any:
    return to.define(name, rhs, name, f"what {name} is", Law.GEOMETRY, **more)


def wanted(to: Book, *values: Any) -> Derivation:
    to.outputs.extend(Output(f"out{k}", value, ((0, 0),)) for k, value in enumerate(values))
    return to.close()


def test_a_definition_gives_a_symbol_of_the_kind_of_its_right_hand_side() -> None:
    found = book()
    assert isinstance(define(found, "c", Cross(a, b)), VectorSymbol)
    assert isinstance(define(found, "T", Outer(a, b)), TensorSymbol)
    assert define(found, "S", Outer(a, a), symmetric=True).is_symmetric
    assert define(found, "s", Dot(a, b)) == sp.Symbol("s", real=True)
    assert [e.id for e in found.open_equations()] == ["c", "T", "S", "s"]


def test_an_equation_is_cited_by_the_name_that_it_defines() -> None:
    """In a chapter on a leg type or on the platform, whatever stands before it."""
    found = book()
    found.chapter("ups-K", "", "", "ups")
    found.chapter("ups_long-K", "", "", "ups_long")
    for name in ("ups_q_3", "ups_long_q_3", "m_star"):
        define(found, name, a + b)
    found.chapter("M", "", "")
    define(found, "ups_H_a_3", a + b)
    ids = [e.id for e in found.all_equations()]
    assert ids == ["ups-q_3", "ups_long-q_3", "m_star", "ups-H_a_3"]


@pytest.mark.parametrize("taken", ["a", "c"])
def test_a_name_has_one_meaning(taken: str) -> None:
    found = book()
    define(found, "c", Cross(a, b))
    with pytest.raises(ValueError, match=f"the name '{taken}' is already used"):
        define(found, taken, a + b)


def test_what_nothing_needs_is_left_out() -> None:
    found = book()
    needed = define(found, "c", Cross(a, b))
    define(found, "idle", a + b)
    through_form = define(found, "f", a - b)
    in_condition = define(found, "size", Dot(a, a))
    in_scale = define(found, "scale", Dot(b, b))
    last = define(
        found,
        "last",
        Dot(needed, x),
        forms=(Dot(through_form, x),),
        conditions=(Condition(FailureStatus.SINGULAR, in_condition, in_scale),),
    )
    found.chapter("d-", "Dynamics", "")
    define(found, "unused", b - a)
    derivation = wanted(found, last)
    assert [e.id for e in derivation.equations()] == ["c", "f", "size", "scale", "last"]
    assert [chapter.id for chapter in derivation.chapters] == ["k-"]
    assert derivation.definition("c").rhs == Cross(a, b)
    with pytest.raises(KeyError):
        derivation.definition("idle")


def test_striking_out_gives_names_free() -> None:
    found = book()
    define(found, "kept", a + b)
    mark = found.mark()
    define(found, "tried", a - b)
    found.give(VectorSymbol("g"), "base", (0, 0, 1), _meaning(VectorSymbol("g")))
    found.reset(mark)
    assert [e.name for e in found.all_equations()] == ["kept"]
    assert {given.symbol.name for given in found.givens} == {"a", "b", "x"}
    again = define(found, "tried", a + x)
    define(found, "g", b + x)
    assert [e.id for e in found.open_equations()] == ["kept", "tried", "g"]
    assert wanted(found, again).definition("tried").rhs == a + x


def _collected(*, coefficient_needed: bool, rest_needed: bool) -> LinearForm | None:
    """y = (b . x) a + b, linear in x: coefficient C = a b^T and remainder b, in names."""
    found = book()
    y = define(found, "y", Dot(b, x) * a + b)
    plain = linear_form(Dot(b, x) * a + b, [x])
    C = define(found, "C", plain.coefficients[x])
    rest = define(found, "y_o", plain.remainder)
    found.collect("y", LinearForm({x: C}, rest), plain)
    values = [y, *([C] if coefficient_needed else []), *([rest] if rest_needed else [])]
    return wanted(found, *values).collected["y"]


@pytest.mark.parametrize("coefficient_needed", [True, False])
@pytest.mark.parametrize("rest_needed", [True, False])
def test_collected_parts_without_an_equation_are_what_they_stand_for(
    coefficient_needed: bool, rest_needed: bool
) -> None:
    form = _collected(coefficient_needed=coefficient_needed, rest_needed=rest_needed)
    assert form is not None
    assert form.coefficients[x] == (TensorSymbol("C") if coefficient_needed else Outer(a, b))
    assert form.remainder == (VectorSymbol("y_o") if rest_needed else b)


def test_a_form_in_names_that_are_left_out_is_not_shown() -> None:
    found = book()
    y = define(found, "y", a + b)
    idle = define(found, "idle", Outer(a, b))
    form = LinearForm({x: idle}, b)
    found.collect("y", form, form)
    found.collect_no_coefficients("z")
    assert wanted(found, y).collected == {"y": None, "z": None}
