"""Sums in C add last what is known last."""

from __future__ import annotations

from typing import Any

import sympy as sp

from pne_sym.backends.waiting import WaitingPrinter, ready, ready_after
from pne_sym.program.ir import Assignment

a, b, c, late, later = sp.symbols("a_1 b_1 c_1 late_1 later_1")
KNOWN = {"late_1": 40, "later_1": 60}


def text(expr: Any) -> str:
    return WaitingPrinter(KNOWN).text(expr)


def test_what_comes_last_is_added_last() -> None:
    assert text(later * a + late + b * c) == "b_1*c_1 + late_1 + a_1*later_1"
    assert text(a - late + b * later - c) == "a_1 - c_1 - late_1 + b_1*later_1"
    assert text(a * (later + b + late)) == "a_1*(b_1 + late_1 + later_1)"


def test_a_positive_term_stands_first() -> None:
    assert text(later - a) == "later_1 - a_1"
    assert text(-later - a) == "-a_1 - later_1"


def test_equal_waits_keep_the_order_of_all_languages() -> None:
    assert text(c + b * a - late * b + late) == "c_1 + a_1*b_1 + late_1 - b_1*late_1"
    assert WaitingPrinter({}).text(b * later + a * late) == "a_1*late_1 + b_1*later_1"


def test_cycles() -> None:
    assert ready(a * late, KNOWN) == 44
    assert ready(a * b + c * late, KNOWN) == 44  # the second product is made as it is added
    assert ready(a + late + b * c, KNOWN) == 44
    assert ready(1 / late, KNOWN) > ready(late**2, KNOWN) == 44
    assert ready(sp.sqrt(later), KNOWN) > 60
    assert ready(sp.Integer(1), KNOWN) == ready(a, KNOWN) == 0
    first, second = sp.symbols("first second")
    made = [Assignment(first, late * a, "e"), Assignment(second, first + b, "e")]
    assert ready_after(made, KNOWN)["second"] == 48
