"""The optional table of symbols: its grammar, hostile text, the way through the full form."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from pne_sym.model.errors import SpecError
from pne_sym.model.reader import checked, from_mapping, from_text, to_full_form
from pne_sym.model.symbols import GREEK, split_symbol
from tests.model.examples import planar


def read(symbols: Any) -> tuple[tuple[str, str], ...]:
    return from_mapping(planar() | {"symbols": symbols}, "pair").symbols


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("L", ("L", "")),
        ("r_u", ("r", "u")),
        ("m_12", ("m", "12")),
        ("slide", ("slide", "")),
        ("m_tip", ("m", "tip")),
        (r"\theta", (r"\theta", "")),
        (r"\rho_u", (r"\rho", "u")),
        (r"\Omega_\alpha", (r"\Omega", r"\alpha")),
    ],
)
def test_what_a_symbol_is(text: str, parts: tuple[str, str]) -> None:
    assert split_symbol(text) == parts
    assert read({"q_2": text}) == (("q_2", text),)


def test_every_greek_letter() -> None:
    assert all(split_symbol(rf"\{letter}") == (rf"\{letter}", "") for letter in GREEK)


@pytest.mark.parametrize(
    "text",
    [
        "", " ", "L ", " L", "L\n", "1", "_u", "r_", "r__u", "r_u_v", "r_{u}", "r^2", "r'", "r u",
        "$r$", "`r`$", "r|s", "<b>", "r&s", "r%", "#", "~", "é", "θ", "x" * 13, "m_1234",
        "\\", "\\\\", r"\input", r"\input{x}", r"\mathbf r", r"\def\x{y}", r"\href{a}{b}",
        r"\theta_", r"\thetax", r"\theta\phi", r"\Alpha", r"\Beta", r"\omicron", "```", "-->",
        "L_\\theta\n", "\x00", "L\u202e", "L" * 100_000,
    ],
)  # fmt: skip
def test_what_none_is(text: str) -> None:
    assert split_symbol(text) is None
    with pytest.raises(
        SpecError, match=r"^pair: symbols\.q_2: value .*; expected a letter"
    ) as error:
        read({"q_2": text})
    assert len(str(error.value)) < 400
    assert str(error.value).isprintable()


@pytest.mark.parametrize("name", ["", "_", "1q", "q-1", "q 1", "q.1", "q\n", "é", "$", "x" * 81])
def test_names_outside_the_grammar(name: str) -> None:
    with pytest.raises(SpecError, match=r"symbols: name .*; expected names of quantities"):
        read({name: "L"})


@pytest.mark.parametrize("value", [1, True, ["L"], {"a": "L"}, 1.5])
def test_symbols_are_strings(value: Any) -> None:
    with pytest.raises(SpecError, match=r"symbols\.q_2: .*; expected a string"):
        read({"q_2": value})


@pytest.mark.parametrize("table", ["L", [], 3])
def test_the_table_is_a_table(table: Any) -> None:
    with pytest.raises(SpecError, match=r"symbols: .*; expected a table"):
        read(table)


def test_too_many() -> None:
    with pytest.raises(SpecError, match="symbols: 201 symbols; expected at most 200"):
        read({f"q_{k}": "L" for k in range(201)})


def test_left_out_or_empty() -> None:
    assert from_mapping(planar(), "pair").symbols == read({}) == ()
    assert "symbols" not in to_full_form(from_mapping(planar(), "pair"))
    assert read({"q_1": None}) == ()  # JSON null


def test_through_the_full_form() -> None:
    """In the order of names, whatever the order in the file."""
    manipulator = from_mapping(planar() | {"symbols": {"q_2": "L", "e_1": r"\kappa"}}, "pair")
    assert manipulator.symbols == (("e_1", r"\kappa"), ("q_2", "L"))
    form = to_full_form(manipulator)
    assert form["symbols"] == {"e_1": r"\kappa", "q_2": "L"}
    assert from_mapping(form, "again") == manipulator == checked(manipulator)


def test_one_built_in_python_is_checked_too() -> None:
    manipulator = from_mapping(planar(), "pair")
    with pytest.raises(SpecError, match=r"symbols\.q_1"):
        checked(replace(manipulator, symbols=(("q_1", r"\evil"),)))


def test_in_toml() -> None:
    text = """
name = "lift"
space = "translational"
platform.mass = 1
symbols = { q_1 = '\\theta_a' }
[[legs]]
base_point = [0, 0, 0]
platform_point = [0, 0, 0]
joints = [{ kind = "P", axis = "z", actuated = true }]
[home]
X = [0, 0, 0.5]
q = [0.5]
"""
    assert from_text(text, ".toml", "lift.toml").symbols == (("q_1", r"\theta_a"),)
