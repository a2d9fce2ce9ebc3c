"""A mistake in the derivation is found, and placed at the equation that has it."""

from __future__ import annotations

from dataclasses import replace

import pytest
import sympy as sp

from pne_sym.backends.bundle import Bundle
from pne_sym.review import diff_text
from pne_sym.review.difference import Verdict
from pne_sym.review.model import from_bundle
from pne_sym.vector import Cross, Outer, VectorSymbol
from pne_sym.vector import nodes as n
from tests.models import bundle, catalogue
from tests.review.versions import (
    block,
    change,
    compare,
    compiled,
    of,
    rewritten,
    verdicts,
    version,
    with_rhs,
)
from tests.sampling import sampled


def flip_last_term(rhs):
    *others, last = rhs.args
    return rhs.func(*others, -last)


def drop_last_term(rhs):
    return n.vector_sum(rhs.args[:-1])


def swap(first: str, second: str):
    a, b = VectorSymbol(first), VectorSymbol(second)
    return lambda rhs: rhs.xreplace({a: b, b: a})


GRAVITY = VectorSymbol("g")
MUTATIONS = {
    "a sign in the loop": ("ups_S", flip_last_term, "M"),
    "the Coriolis term dropped": ("ups_bias", drop_last_term, "Z"),
    "a swapped index": ("ups_qd_2", swap("ups_w_2", "ups_w_1"), "Z"),
    "swapped reciprocal vectors": ("ups_G_o", swap("ups_w_1", "ups_w_2"), "Z"),
    "a sign of a moment": ("ups_mu_2_o", flip_last_term, "Z"),
    "a coefficient transposed": ("ups_d_alpha_1", lambda rhs: Outer(*rhs.args[::-1]), "M"),
    "a lumped tensor without a body": ("ups_J_group_2", lambda rhs: rhs.args[0], "M"),
    "a factor two": ("ups_omega_1", lambda rhs: 2 * rhs, "Z"),
    "an angle's sine": ("ups_s_2", lambda rhs: -rhs, "M"),
}


@pytest.mark.parametrize("case", sampled(MUTATIONS, 9))
def test_found_and_placed(case: str) -> None:
    name, mutation, spoilt = MUTATIONS[case]
    found = change("stewart", {name: with_rhs(mutation)})
    assert not found.equal
    assert [e.name for e in found.origins] == [name]
    assert block(found, spoilt) is Verdict.DIFFERENT
    told = of(found, name)
    assert told.before != told.after
    assert told.gap is not None
    assert told.gap.size > 1e-6
    changed = set(verdicts(found).values())
    assert changed <= {Verdict.DIFFERENT, Verdict.FOLLOWS}
    assert Verdict.FOLLOWS in changed


def test_the_entry_with_the_largest_difference_is_told() -> None:
    found = change("stewart", {"M_ta": with_rhs(lambda rhs: rhs + Outer(GRAVITY, GRAVITY))})
    told = of(found, "M_ta")
    assert told.gap is not None
    assert told.gap.where == "[2, 2]"  # gravity is along z but for a few per cent


@pytest.mark.only_in_all
def test_of_two_mistakes_both_are_placed_and_the_first_told_first() -> None:
    found = change(
        "stewart", {"ups_Q": with_rhs(lambda r: 2 * r), "ups_S_dot": with_rhs(flip_last_term)}
    )
    assert [e.name for e in found.origins] == ["ups_S_dot", "ups_Q"]
    assert found.to_dict()["first_difference"] == of(found, "ups_S_dot").id


@pytest.mark.only_in_all
def test_a_wrong_other_form_is_found_though_the_definition_is_right() -> None:
    def spoilt(e):
        return replace(e, forms=(*e.forms, -e.rhs))

    found = change("stewart", {"ups_bias": spoilt})
    assert [e.name for e in found.origins] == ["ups_bias"]
    assert "in the form" in of(found, "ups_bias").note


def test_a_condition_that_changed_is_found() -> None:
    def spoilt(e):
        return replace(e, conditions=tuple(replace(c, value=-c.value) for c in e.conditions))

    found = change("stewart", {"ups_root_1": spoilt})
    assert [e.name for e in found.origins] == ["ups_root_1"]
    assert "condition" in of(found, "ups_root_1").note


def test_a_swapped_index_of_an_output_is_found() -> None:
    manipulator = catalogue("stewart")
    derivation = bundle(manipulator).derivation
    outputs = tuple(
        replace(o, rows=((0, 1), (1, 0), (2, 2))) if o.array == "Z" and o.rows[0] == (0, 0) else o
        for o in derivation.outputs
    )
    found = compare(
        version(manipulator), compiled(manipulator, replace(derivation, outputs=outputs))
    )
    assert [(e.id, e.name) for e in found.origins] == [("output", "Z")]
    assert block(found, "Z") is Verdict.DIFFERENT
    assert block(found, "M") is Verdict.IDENTICAL


@pytest.mark.only_in_all
def test_a_given_vector_that_changed_is_found() -> None:
    manipulator = catalogue("stewart")
    derivation = bundle(manipulator).derivation
    givens = tuple(
        replace(g, components=(g.components[1], g.components[0], g.components[2]))
        if g.symbol.name == "ups_rho_2"
        else g
        for g in derivation.givens
    )
    found = compare(version(manipulator), compiled(manipulator, replace(derivation, givens=givens)))
    assert [(e.id, e.name) for e in found.origins] == [("given", "ups_rho_2")]


@pytest.mark.parametrize(
    ("model", "name"),
    sampled(
        [("delta", "rus_Q"), ("planar_3rrr", "rrr_omega_2"), ("tripod_3rps", "rps_gamma_c1")], 3
    ),
)
def test_other_structures(model: str, name: str) -> None:
    found = change(model, {name: with_rhs(lambda rhs: sp.Integer(2) * rhs)})
    assert [e.name for e in found.origins] == [name]


def test_a_mistake_outside_the_equations_is_told_as_such() -> None:
    """The derivation is right, the program is not: its first statement that differs is told."""
    manipulator = catalogue("stewart")
    right = bundle(manipulator)
    wrong = compiled(manipulator, rewritten(right.derivation, {"ups_U": with_rhs(lambda r: -r)}))
    assert wrong.bundle is not None
    lowered = from_bundle("after", Bundle(manipulator, right.derivation, wrong.bundle.program))
    found = compare(version(manipulator), lowered)
    assert not found.equal
    assert not found.origins
    assert found.statement is not None
    assert found.statement.equation == right.derivation.definition("ups_U").id
    (contradiction,) = found.contradictions
    assert (contradiction.version, contradiction.equation) == ("after", found.statement.equation)
    assert diff_text.verdict(found).startswith(
        f"different: the lowering, first at {found.statement.equation} ({contradiction.target}"
    )


def test_a_cross_product_the_wrong_way_round() -> None:
    found = change("stewart", {"ups_H_a_3": with_rhs(lambda rhs: Cross(*rhs.args[::-1]))})
    assert [e.name for e in found.origins] == ["ups_H_a_3"]
    assert block(found, "H") is Verdict.DIFFERENT
    assert block(found, "M") is block(found, "Z") is Verdict.IDENTICAL
