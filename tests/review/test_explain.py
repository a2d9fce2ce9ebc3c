"""An equation explained: what it says, what it uses, what uses it, its statements."""

from __future__ import annotations

import re

import pytest

from pne_sym.backends import registry
from pne_sym.backends.target import Syntax
from pne_sym.derivation import names_in
from pne_sym.review.code import passages, program_passages, why_without
from pne_sym.review.explain import UnknownEquationError, explain, find_equation, find_equations
from pne_sym.review.explain_text import stage_lines
from tests.models import bundle, catalogue, derivation, source

STEWART = catalogue("stewart")


def syntax(target: str) -> Syntax:
    found = registry.target(target).syntax
    assert found is not None
    return found


def test_by_id_and_by_name_are_the_same() -> None:
    by_id, by_name = (explain(bundle(STEWART), wanted) for wanted in ("ups-S", "S"))
    assert by_id == by_name
    assert by_id.formula == "ups_S = t + ups_q - ups_b"
    assert by_id.equation.law.value == "geometry"
    assert "Sec. 2.5" in by_id.equation.reference


@pytest.mark.parametrize("wanted", ["UPS-ROOT_1", "ups_root_1", "root_1", "root_1_ups", "ups-K2"])
def test_other_ways_to_say_it_are_understood(wanted: str) -> None:
    """Another case, the name with or without its leg type, the place in the chapter."""
    assert find_equation(bundle(STEWART).derivation, wanted).id == "ups-root_1"


def test_a_name_without_its_leg_type_is_of_all_types_that_have_it() -> None:
    """As in the table of symbols."""
    mixed = derivation("planar_mixed")
    found = find_equations(mixed, "S")
    assert [e.name for e in found] == [f"{info.name}_S" for info in mixed.leg_types]
    assert [e.id for e in find_equations(mixed, "rpr-S")] == ["rpr-S"]
    with pytest.raises(UnknownEquationError):
        find_equation(mixed, "S")


def test_uses_and_users_are_each_others_inverse() -> None:
    compiled = bundle(STEWART)
    derivation = compiled.derivation
    for equation in (*derivation.equations(), *derivation.rotations()):
        told = explain(compiled, equation.id)
        assert {r.name for r in told.uses} == names_in(equation.rhs)
        for related in told.used_by:
            if related.id != "output":
                assert equation.name in names_in(derivation.definition(related.name).rhs)


def test_transitively_down_to_what_is_given_and_up_to_the_outputs() -> None:
    told = explain(bundle(STEWART), "bias", transitively=True)
    assert {"ups_q", "ups_S"} <= {r.name for r in told.uses}
    assert {"Z_t", "Z_a", "ups_mu_2_o"} <= {r.name for r in told.used_by}
    assert "Z" in {r.name for r in explain(bundle(STEWART), "Z_t").used_by if r.id == "output"}


@pytest.mark.parametrize(
    ("wanted", "parts"),
    [
        ("omga_2", ["omega_2"]),
        ("ups-rot_1", ["ups-root_1"]),
        ("e_3", ["given", "used by ups-r_2"]),
        ("", ["no equation"]),
        ("x" * 10000, ["no equation"]),
    ],
)
def test_an_unknown_equation_is_refused_with_the_nearest(wanted: str, parts: list[str]) -> None:
    with pytest.raises(UnknownEquationError) as caught:
        explain(bundle(STEWART), wanted)
    assert len(str(caught.value)) < 300
    for part in parts:
        assert part in str(caught.value)


def test_statements_in_the_numpy_code_stand_there_under_the_equation() -> None:
    wanted = find_equation(bundle(STEWART).derivation, "S").id
    found = passages({"": source(STEWART)}, wanted, syntax("numpy"))
    assert {"_run_M", "_run_inverse_kinematics"} <= {f for p in found for f in p.functions}
    for passage in found:
        assert {line.split(" = ")[0] for line in passage.lines} >= {"ups_S_x", "ups_S_y", "ups_S_z"}


def test_what_has_no_statement_says_why() -> None:
    """Every equation has statements in the program, or a reason that names where it went."""
    compiled = bundle(STEWART)
    reasons = {}
    for equation in compiled.derivation.equations():
        if not program_passages(compiled, equation.id):
            reasons[equation.name] = why_without(compiled, equation)
    assert len(reasons) < 40
    assert all(re.search(r"(used by|used, in) .", reason) for reason in reasons.values())
    assert "it is ups_q_3, 0, 0 in the frame ups.axes2" in reasons["ups_r_2"]
    assert "written where it is used, in ups-" in reasons["ups_d_G"]
    shown = list(stage_lines(compiled, "c", "qd_2"))
    assert any("ups_qd_2 = " in line for line in shown)
    assert not any("no statement" in line for line in shown)


def test_stores_and_sums_stand_under_their_equations() -> None:
    compiled = bundle(STEWART)
    for name, text in (
        ("M_tt", "M[0, 0] = M_tt_xx"),
        ("Z_t", "Z_t_ups_x += ups_U_x"),
        ("ups_q_3", "q["),
    ):
        wanted = compiled.derivation.definition(name).id
        lines = [line for p in program_passages(compiled, wanted) for line in p.lines]
        assert any(line.startswith(text) for line in lines), name
    in_c = "\n".join(stage_lines(compiled, "c", "M_tt"))
    assert "M[0*w + k] = M_tt_xx;" in in_c


def test_statements_of_c_code() -> None:
    text = (
        "static int model_M_ups(const double *X)\n{\n    /* (K1) the gap */\n"
        "    const double a = X[0];\n    const double b = a*a;\n    /* (K2) next */\n"
        "    const double c = b;\n    return 0;\n}\n"
    )
    found = passages({"model.c": text}, "K1", syntax("c"))
    assert [(p.functions, p.lines) for p in found] == [
        (("model_M_ups",), ("const double a = X[0];", "const double b = a*a;"))
    ]
