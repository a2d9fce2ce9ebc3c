"""An author's symbols: in formulas only, followed by what is named after them, never twice."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from pne_sym import manipulators
from pne_sym.derivation import Derivation, full_name
from pne_sym.mechanics.derive import derive
from pne_sym.model.errors import SpecError


def derived(name: str, **symbols: str) -> Derivation:
    manipulator = replace(manipulators.load(name), symbols=tuple(sorted(symbols.items())))
    return derive(manipulator)


def latex(name: str, quantity: str, **symbols: str) -> str:
    found = derived(name, **symbols)
    return found.notation[full_name(found, quantity)].latex


@pytest.mark.parametrize(
    ("quantity", "text", "expected"),
    [
        ("q_2", "L", "L"),
        ("q_2", "L_2", "L_{2}"),
        ("q_2", "len", r"\mathrm{len}"),
        ("q_2", r"\lambda_s", r"\lambda_{s}"),
        ("q_2", "L_tip", r"L_{\mathrm{tip}}"),
        ("q_2", r"L_\theta", r"L_{\theta}"),
        ("e_2", "s", r"\mathbf{s}"),
        ("e_2", "axis", r"\mathbf{axis}"),
        ("e_2", r"\sigma_u", r"\boldsymbol\sigma_{u}"),
        ("I_2", "I_u", r"\mathbf{I}_{u}"),
        ("rpr_link2_mass", "m_u", "m_{u}"),
    ],
)
def test_scalars_are_plain_vectors_and_tensors_bold(
    quantity: str, text: str, expected: str
) -> None:
    assert latex("fivebar_prismatic", quantity, **{quantity: text}) == expected


def test_dots_and_circles_follow() -> None:
    notation = derived("hybrid_3prps", q_3="L_s", omega_2="W", mu_2="k").notation
    found = {
        name: notation[f"prps_{name}"].latex
        for name in ("qd_3", "qdd_3", "qdd_3_o", "omega_2", "mu_2_o")
    }
    assert found == {
        "qd_3": r"\dot{L}_{s}",
        "qdd_3": r"\ddot{L}_{s}",
        "qdd_3_o": r"\ddot{L}_{s}^{\circ}",
        "omega_2": r"\mathbf{W}",
        "mu_2_o": r"\mathbf{k}^{\circ}",
    }


def test_a_derivative_may_have_a_symbol_of_its_own() -> None:
    notation = derived("fivebar_prismatic", q_1=r"\theta", qd_1="W").notation
    assert (notation["rpr_qd_1"].latex, notation["rpr_qdd_1"].latex) == ("W", r"\ddot{\theta}")


def test_extra_coordinates() -> None:
    notation = derived("planar_redundant", prrr_y_1_extra="D").notation
    names = ("prrr_y_1_extra", "prrr_yd_1", "prrr_ydd_1")
    assert [notation[name].latex for name in names] == ["D", r"\dot{D}", r"\ddot{D}"]


def test_legs_of_different_types_may_share() -> None:
    """As they share the engine's symbols: they never meet in a chapter."""
    notation = derived("planar_mixed", rpr_q_2="L", prr_q_2="L").notation
    assert notation["rpr_q_2"].latex == notation["prr_q_2"].latex == "L"


def test_the_leg_type_may_stand_behind() -> None:
    notation = derived("planar_mixed", q_2_rpr="L").notation
    assert notation["rpr_q_2"].latex == "L"


def test_a_name_without_its_type_is_that_of_all_types() -> None:
    """With another leg type beside the first, the symbols of the file stay."""
    notation = derived("planar_mixed", q_2="L", q_2_prr="D").notation
    found = [notation[f"{leg}_q_2"].latex for leg in ("rpr", "rrr", "prr")]
    assert found == ["L", "L", "D"]
    with pytest.raises(SpecError, match="no quantity 'q_9'"):
        derived("planar_mixed", q_9="L")


def test_code_does_not_change() -> None:
    plain = replace(manipulators.load("tripod_3rps"), symbols=())
    named = manipulators.load("tripod_3rps")
    first, second = derive(plain), derive(named)
    assert first.chapters == second.chapters
    assert first.outputs == second.outputs
    assert first.notation.keys() == second.notation.keys()
    assert first.notation != second.notation


@pytest.mark.parametrize(
    ("symbols", "message"),
    [
        ({"q_7": "L"}, r"symbols\.q_7: no quantity 'q_7' \(did you mean q_\d"),
        ({"wn_1": "L"}, r"symbols\.wn_1: no quantity"),
        ({"q_2": "m_p"}, r"symbols\.q_2: m_\{p\} is the symbol of platform_mass"),
        (
            {"q_2": "q_1"},
            r"symbols\.q_2: q_\{1\} is the symbol of rps_q_1 as well; expected another",
        ),
        ({"q_1": "L", "q_2": "L"}, r"symbols\.q_1: L is the symbol of rps_q_2"),
        ({"e_1": "s", "e_2": "s"}, r"symbols\.e_1: .* is the symbol of rps_e_2"),
        ({"rho_1": "S"}, r"symbols\.rho_1: .* is the symbol of rps_S"),
        ({"Q": "E"}, r"symbols\.Q: .*E.* means something in every report"),
        ({"q_2": r"\tau"}, r"symbols\.q_2: .*tau means something"),
        ({"q_2": "i"}, r"symbols\.q_2: i means something"),
        ({"t": "x"}, r"symbols\.t: its symbol is the same in every report"),
        ({"S_dot": "x"}, r"symbols\.S_dot: its symbol is the same"),
        ({"a_p": "a"}, r"symbols\.a_p: its symbol is the same"),
    ],
)
def test_refused(symbols: dict[str, str], message: str) -> None:
    with pytest.raises(SpecError, match=message):
        derived("tripod_3rps", **symbols)


def test_a_symbol_is_free_when_its_holder_has_another() -> None:
    found: Any = derived("fivebar_revolute", link_x_1="c", c="F_c").notation
    assert found["rrr_link_x_1"].latex == r"\mathbf{c}"
    with pytest.raises(SpecError, match=r"symbols\.link_x_1: .* is the symbol of rrr_c as well"):
        derived("fivebar_revolute", link_x_1="c")


def test_axes_that_are_one_vector_may_share() -> None:
    notation = derived("hybrid_3prps", e_1="k", e_2="k").notation
    assert notation["prps_e_1"].latex == notation["prps_e_2"].latex == r"\mathbf{k}"
    with pytest.raises(SpecError, match="is the symbol of six_r_e_4"):  # parallel at home only
        derived("hexapod_6x6r", e_1="k", e_4="k")
