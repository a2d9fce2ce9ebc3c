"""`pne-gen explain` through the program itself."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from pne_sym import manipulators
from pne_sym.model.full_form import to_full_form
from tests.cli.program import pne_gen
from tests.cli.test_faults import assert_refused
from tests.cli.test_generate import own_spec


def explain(*arguments: str | Path):
    return pne_gen("explain", *arguments, real=True)


def test_an_equation_with_law_uses_users_and_statements() -> None:
    done = explain("stewart", "ups-root_1")
    assert (done.returncode, done.stderr) == (0, "")
    for part in (
        "(ups-root_1)",
        "ups_root_1 = ups_branch_1 * sqrt((ups_across_1 . ups_S)^2 + (ups_ref_1 . ups_S)^2)",
        "law:   loop closure",
        "LaTeX:",
        "uses\n",
        "ups-S ",
        "used by\n",
        "statements of the scalar program",
    ):
        assert part in done.stdout


@pytest.mark.parametrize("stage", ["derivation", "program", "numpy"])
def test_stages_of_an_equation(stage: str) -> None:
    done = explain("stewart", "root_1", "--stage", stage)
    assert (done.returncode, done.stderr) == (0, "")
    assert ("law:" in done.stdout) == (stage == "derivation")
    assert "root_1 = " in done.stdout


def test_without_an_equation_all_are_listed() -> None:
    done = explain("planar_3rpr")
    assert done.returncode == 0
    assert (
        "rpr-K  Inverse kinematics of an R_PR leg\n  rpr-S    rpr_S = t + rpr_q - rpr_b\n"
        in done.stdout
    )


def test_the_full_form_is_a_specification_of_the_same_manipulator(tmp_path: Path) -> None:
    done = explain("stewart", "--stage", "spec")
    assert json.loads(done.stdout) == to_full_form(manipulators.load("stewart"))
    path = tmp_path / "full.json"
    path.write_text(done.stdout)
    assert explain(path, "--stage", "spec").stdout == done.stdout


def test_a_spec_file_and_options_first(tmp_path: Path) -> None:
    path = own_spec(tmp_path)
    done = pne_gen("--stage", "derivation", "explain", path, "M_tt", real=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert "M_tt" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("stewart", "omga_2"), ("no equation 'omga_2'", "omega_2")),
        (("stewart", "e_3"), ("'e_3' is given", "ups-r_2")),
        (("stewrt", "S"), ("did you mean stewart",)),
        (("stewart", "S", "--stage", "spec"), ("leave EQUATION out",)),
    ],
)
def test_refusals(arguments: tuple[str, ...], parts: tuple[str, ...]) -> None:
    assert_refused(explain(*arguments), *parts)
