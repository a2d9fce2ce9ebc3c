"""What only looks different is called equal; what is renamed is matched by its values."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
import sympy as sp

from pne_sym.derivation import Derivation, Equation, Quantity
from pne_sym.review import diff_text
from pne_sym.review.difference import Verdict
from pne_sym.review.programs import SameText
from pne_sym.vector import Compose, Skew, TensorSymbol, Vector, VectorSymbol
from pne_sym.vector import nodes as n
from tests.models import bundle, catalogue
from tests.review.versions import change, compare, compiled, of, verdicts, version, with_rhs
from tests.sampling import sampled


def reordered(rhs: Any) -> Any:
    return rhs.func(*rhs.args[::-1])


def as_first_form(e: Equation) -> Equation:
    return replace(e, rhs=e.forms[0], forms=(e.rhs,))


def skewed(rhs: Any) -> Any:
    """a x (b x c) as a product of tensors."""

    def to_tensor(term: Any) -> Any:
        if isinstance(term, n.Cross) and isinstance(term.args[1], n.Cross):
            return Compose(Skew(term.args[0]), Skew(term.args[1].args[0])) @ term.args[1].args[1]
        return term

    return n.vector_sum(to_tensor(term) for term in rhs.args)


REWRITINGS = {
    "a reordered sum": {"ups_mu_2_o": with_rhs(reordered), "ups_S": with_rhs(reordered)},
    "the other form": {"ups_bias": as_first_form, "ups_phi_3": as_first_form},
    "tensors for cross products": {"ups_phi_3_o": with_rhs(skewed)},
    "a root taken apart": {
        "ups_q_3": with_rhs(
            lambda rhs: (
                rhs.args[0]
                * sp.sqrt(
                    sum(
                        n.Dot(n.VectorSymbol(f"ups_{axis}"), n.VectorSymbol("ups_S")) ** 2
                        for axis in ("ref_1", "across_1", "e_1")
                    )
                )
            )
        )
    },
    "another title": {"ups_U": lambda e: replace(e, title="another title")},
}


@pytest.mark.parametrize("case", sampled(REWRITINGS, 3))
def test_equal(case: str) -> None:
    found = change("stewart", REWRITINGS[case])
    assert found.equal
    assert not found.origins
    if case != "another title":
        assert verdicts(found) == dict.fromkeys(REWRITINGS[case], Verdict.EQUAL)
        assert all(of(found, name).before != of(found, name).after for name in REWRITINGS[case])


def with_temporary(derivation: Derivation, name: str, part: int) -> Derivation:
    """The derivation with one term of an equation named by an equation of its own."""
    chapters = []
    for chapter in derivation.chapters:
        equations: list[Equation] = []
        for e in chapter.equations:
            if e.name == name:
                symbol = VectorSymbol(f"{name}_part")
                term = e.rhs.args[part]
                equations.append(
                    replace(e, id=f"{e.id}a", title="a part", lhs=symbol, rhs=term, forms=())
                )
                others = [a if k != part else symbol for k, a in enumerate(e.rhs.args)]
                e = replace(e, rhs=n.vector_sum(others), forms=())  # noqa: PLW2901
            equations.append(e)
        chapters.append(replace(chapter, equations=tuple(equations)))
    old = derivation.notation[name]
    notation = {**derivation.notation, f"{name}_part": replace(old, name=f"{name}_part")}
    return replace(derivation, chapters=tuple(chapters), notation=notation)


def test_another_temporary_is_no_difference() -> None:
    manipulator = catalogue("stewart")
    derivation = bundle(manipulator).derivation
    after = compiled(manipulator, with_temporary(derivation, "ups_bias", 1))
    found = compare(version(manipulator), after)
    assert found.equal
    assert verdicts(found) == {"ups_bias_part": Verdict.ADDED, "ups_bias": Verdict.EQUAL}
    back = compare(after, version(manipulator))
    assert back.equal
    assert verdicts(back) == {"ups_bias_part": Verdict.REMOVED, "ups_bias": Verdict.EQUAL}


def renamed(derivation: Derivation, old: str, new: str) -> Derivation:
    """The derivation with a vector or tensor renamed wherever it stands."""
    lhs = derivation.definition(old).lhs
    symbol = VectorSymbol(new) if isinstance(lhs, Vector) else TensorSymbol(new, lhs.is_symmetric)

    def swap(x: Any) -> Any:
        return x.xreplace({lhs: symbol}) if hasattr(x, "xreplace") else x

    def equation(e: Equation) -> Equation:
        conditions = tuple(
            replace(c, value=swap(c.value), scale=swap(c.scale)) for c in e.conditions
        )
        return replace(
            e,
            lhs=swap(e.lhs),
            rhs=swap(e.rhs),
            forms=tuple(map(swap, e.forms)),
            conditions=conditions,
        )

    quantity: Quantity = derivation.notation[old]
    notation = {new if k == old else k: v for k, v in derivation.notation.items()}
    notation[new] = replace(quantity, name=new)
    return replace(
        derivation,
        chapters=tuple(
            replace(c, equations=tuple(map(equation, c.equations))) for c in derivation.chapters
        ),
        notation=notation,
        outputs=tuple(replace(o, value=swap(o.value)) for o in derivation.outputs),
    )


@pytest.mark.parametrize(
    ("old", "new"), sampled([("ups_bias", "beta"), ("ups_d_alpha_2", "C_2"), ("Z_p", "Z_own")], 3)
)
def test_a_renamed_quantity_is_matched_by_its_values(old: str, new: str) -> None:
    manipulator = catalogue("stewart")
    derivation = bundle(manipulator).derivation
    found = compare(version(manipulator), compiled(manipulator, renamed(derivation, old, new)))
    assert found.equal
    assert f"renamed: {old} -> {new}" in of(found, new).note
    assert Verdict.ADDED not in verdicts(found).values()
    assert Verdict.REMOVED not in verdicts(found).values()


@pytest.mark.parametrize(
    "name",
    sampled(["stewart", "planar_mixed", "stewart_sps", "tripod_3rps", "planar_redundant"], 5),
)
def test_a_model_is_equal_to_itself(name: str) -> None:
    manipulator = catalogue(name)
    found = compare(version(manipulator), version(manipulator))
    assert found.equal
    assert verdicts(found) == {}
    assert {b.verdict for b in found.blocks} == {Verdict.IDENTICAL}
    assert diff_text.verdict(found) == "equal: identical text"


def test_what_prepared_values_are_is_text_of_the_functions_that_read_them() -> None:
    program = bundle(catalogue("planar_3rpr")).program
    first, *others = program.prepare
    wrong = replace(first.assignments[0], expr=2 * first.assignments[0].expr)
    changed = replace(first, assignments=(wrong, *first.assignments[1:]))
    same = SameText(program, replace(program, prepare=(changed, *others)))
    assert same("pose")
    assert not all(same(f.name) for f in program.public)
    assert all(map(SameText(program, replace(program)), (f.name for f in program.public)))
