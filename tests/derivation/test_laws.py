"""Laws and references: a ledger of all quantities, and what laws say of units and of constants."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import sympy as sp

from pne_sym import manipulators
from pne_sym.derivation import Book, Derivation, Law, names_in
from pne_sym.derivation.paper import EQUATIONS, check_reference, passages
from pne_sym.mechanics.derive import derive
from pne_sym.model.reader import checked
from tests.mechanics.structures import drawn
from tests.models import derivation
from tests.random.effects import with_effects

LEDGER = """
ASSEMBLY     | Eq. 32                | R_t
ASSEMBLY     | Eq. 33                | R_a
ASSEMBLY     | Eq. 34                | H_a_# Hk_a_#
DEFINITION   |                       | B_# B_#_o B_p Jc_# W_# W_p hc_#
ENERGY       |                       | potential
ENERGY       | beyond the paper      | stored_#
EULER        | Eq. 2                 | mu_#
EULER        | Eq. 33                | mu_p
EULER        | Sec. 2.5, step 1.3    | N_#
EULER        |                       | L_c_# L_c_#_#
FREEDOM      | Eqs. 6, 7             | P_#
FREEDOM      | Sec. 2.2, joint table | D_#_# Gamma_#
FRICTION     |                       | dissipation
FRICTION     | beyond the paper      | friction_# friction_end
GEOMETRY     |                       | c_# c#_# from_centre_# r_# s_# s#_# size_c# volume_c x_#
GEOMETRY     |                       | f_c_part f_c_size n_# n#_# n_#_part n#_#_part aside_#
GEOMETRY     |                       | reference_#
GEOMETRY     | Eq. 35                | mu#_c# mu_c mu_c# n_c n_c#
GEOMETRY     | Sec. 2.2, joint table | n_m#
GEOMETRY     | Sec. 2.5, step 1.1    | S
LOOP_CLOSURE |                       | Kc_# Kd_# Kr_# Ks_# c_# disc_# residual px_# py_# q_# rho#_#
LOOP_CLOSURE |                       | root_# s_# xi_#
LOOP_CLOSURE | Eq. 37                | gamma_c# phi_c#
LUMPING      |                       | J_# J_group_# J_star Sigma_# b_c h_# h_group_# h_star
LIMIT        | beyond the paper      | margin_# off_# off#_#
LUMPING      |                       | half_# legs_size m_star middle_# per_turn_# rho_tip_# size
LUMPING      |                       | size_# spread vs#_end_p
LUMPING      |                       | un_# um_# uu_# vs#_# end_l#
MOVING_FRAME | beyond the paper      | B_b S_ddot_b a_b# a_m f_b g_b g_f mu_b omega_b_# zeta_b_#
DEFINITION   |                       | W_b_#
NEWTON       |                       | P_c_# T_#
NEWTON       | Eq. 1                 | f_# phi_#
NEWTON       | Eq. 3                 | c_true
NEWTON       | Eq. 32                | f_p
RATE         |                       | S_dot_rest a_o_# alpha_# beta_# eta_# etad_# nd_m# omega_#
RATE         |                       | rel zeta_#
RATE         | beyond the paper      | omega_end
RATE         | Eq. 23                | S_ddot a_p u_#
RATE         | Eq. 32                | a_t
RATE         | Eqs. 10, 11, 17, 18   | acc_#
RATE         | Sec. 2.2              | bias
RATE         | Sec. 2.2, joint table | nu_# v_#
RATE         | Sec. 2.5, step 1.1    | S_dot
RECIPROCITY  |                       | qd_#
RECIPROCITY  | Eq. 35                | f_c# m#_c#
RECIPROCITY  | Eqs. 8, 9, 16         | qdd_#
RECIPROCITY  | Sec. 2.2, joint table | G_m G_m# m#_w_# o_# w_#
RECIPROCITY  | Sec. 2.3              | G w_#
REDUCTION    | Eq. 3                 | c c_m
ROTOR        | beyond the paper      | rotor_# motor_#
RULES        | Eq. 34                | M_tt M_ta M_aa Z_p Z_t Z_q Z_a
RULES        | Eq. 4                 | Q U
RULES        | Eqs. 6, 7             | M_ya_#
SPRING       | beyond the paper      | spring_#
"""
"""Law, reference and quantities; those that end with _o, and d_..., are of Eq. 4."""
COLLECTED = "Sec. 2.3, Eq. 4"
MEASURES = {
    Law.RATE: {"m", "m/s", "m/s^2", "rad/s", "rad/s^2", ""},  # of v_#, per rate: m
    Law.NEWTON: {"N", "kg", "kg m"},  # per acceleration of a joint: kg, kg m
    Law.EULER: {"N m", "kg m", "kg m^2"},
    Law.FREEDOM: {"N", "N m", "kg", "kg m", "kg m^2"},
    Law.REDUCTION: {"N", "N m"},
    Law.GEOMETRY: {"-", "m", "m^2", "m^3", "1/m"},
    Law.LOOP_CLOSURE: {"-", "rad", "m", "m^2", "m^4", "m/s^2", "1/s^2", ""},
    Law.ENERGY: {"J"},
    Law.FRICTION: {"N", "N m", "W"},
    Law.SPRING: {"N", "N m"},
    Law.ROTOR: {"kg", "kg m^2", "rad/s"},
    Law.LIMIT: {"-", "m", "m^2"},
    Law.MOVING_FRAME: {"m/s^2", "rad/s", "rad/s^2", "1/s^2", "N", "N m"},
}


@cache
def ledger() -> dict[str, set[tuple[Law, str]]]:
    found: dict[str, set[tuple[Law, str]]] = {}
    for line in LEDGER.strip().splitlines():
        law, reference, names = (cell.strip() for cell in line.split("|"))
        for name in names.split():
            found.setdefault(name, set()).add((Law[law], reference))
    return found


def stem(id_: str) -> str:
    """The name that an equation defines, without leg type and numbers."""
    return re.sub(r"\d+", "#", id_.rpartition("-")[2])


def examine(of: Derivation) -> None:
    constant = set(of.parameters.entries)
    constant |= {q.name for q in of.notation.values() if q.parameter}
    for equation in of.equations():
        name, law = stem(equation.id), equation.law
        quantity = of.notation[equation.name]
        if law is Law.RULES and equation.reference == COLLECTED:
            assert quantity.remainder_of or re.match(r"d(alpha|y_#)?_", name), name
            assert equation.expanded is not None, name
        else:
            assert (law, equation.reference) in ledger().get(name, set()), (name, equation)
        assert quantity.unit in MEASURES.get(law, {quantity.unit}), (name, law, quantity.unit)
        if law is Law.LUMPING and "un_" not in name and "um_" not in name and "uu_" not in name:
            assert quantity.parameter, name
            assert names_in(equation.rhs) <= constant, name


@pytest.mark.parametrize("name", manipulators.names())
def test_of_the_catalogue(name: str) -> None:
    examine(derivation(name))


@pytest.mark.parametrize("name", ["helix at the base", "one slide, universal at the platform"])
def test_with_friction_springs_and_motors(name: str) -> None:
    random = np.random.default_rng(3)
    spec = replace(with_effects(drawn(name), random, share=1.0), moving_base=True)
    examine(derive(checked(spec)))


def test_every_row_of_the_ledger_is_a_matter_of_the_paper() -> None:
    for found in ledger().values():
        for law, reference in found:
            check_reference(reference, law)


@pytest.mark.parametrize(
    ("reference", "law", "fault"),
    [
        ("Eq. 38", Law.NEWTON, "has no '38'"),
        ("Sec. 2.9", Law.RULES, "has no '2.9'"),
        ("Sec. 2.3, Eq. 32", Law.RULES, "another section"),
        ("Eq. 1", Law.EULER, "no matter of EULER"),
        ("Eq 1", Law.NEWTON, "no reference"),
        ("Newton", Law.NEWTON, "no reference"),
    ],
)
def test_references_that_are_none(reference: str, law: Law, fault: str) -> None:
    book = Book()
    book.chapter("A", "First", "")
    with pytest.raises(ValueError, match=fault):
        book.define("x", sp.Integer(1), "x", "x", law, reference=reference)
    assert not book.notation


def test_passages() -> None:
    assert [p.section for p in passages("Sec. 2.3, Eq. 4")] == ["2.3", "2.3"]
    assert list(EQUATIONS) == [str(k) for k in range(1, 38)]
    sections = [float(p.section) for p in EQUATIONS.values()]
    assert sections == sorted(sections)
