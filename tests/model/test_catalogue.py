"""The catalogue holds the reference data, digit by digit, and finds its files."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from pne_sym import manipulators
from pne_sym.model.errors import SpecError
from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import from_mapping, read_spec, to_full_form

REFERENCE = Path(__file__).parents[1] / "data" / "reference_specs"
NAMES = sorted(path.stem for path in REFERENCE.glob("*.json"))


def reference(name: str) -> Any:
    return json.loads((REFERENCE / f"{name}.json").read_text())


def unnamed(manipulator: Manipulator) -> Manipulator:
    """Without the names of leg types, which the full form of the references does not have."""
    return replace(manipulator, legs=tuple(replace(leg, type="") for leg in manipulator.legs))


def test_names() -> None:
    assert list(manipulators.names()) == NAMES
    assert len(NAMES) == 33


@pytest.mark.parametrize("name", NAMES)
def test_equals_the_reference(name: str) -> None:
    found = manipulators.load(name)
    expected = from_mapping(reference(name), "reference")
    assert replace(unnamed(found), title="", symbols=()) == replace(expected, title="")


@pytest.mark.parametrize("name", NAMES)
def test_reading_changes_no_digit(name: str) -> None:
    """Only structural zeros are snapped: all else stands as in the reference file."""
    found = replace(unnamed(manipulators.load(name)), symbols=())
    snapped = differences(to_full_form(found), reference(name))
    snapped.pop(".title")
    assert all(found == 0.0 and abs(given) < 1e-16 for found, given in snapped.values())
    assert all(".axis_platform" in place for place in snapped)


def test_the_worked_examples_of_the_paper_have_its_symbols() -> None:
    """So that report and paper can be read side by side."""
    expected = {
        "fivebar_prismatic": {"e_2": "s", "q_2": "L", "qd_1": "W"},
        "fivebar_revolute": {"q_1": r"\theta", "link_x_1": "c", "link_x_2": "d"},
        "hybrid_3prps": {"e_1": "k", "e_3": "s", "q_1": "D", "q_3": "L", "omega_2": "W"},
        "tripod_3rps": {"e_1": "k", "e_2": "s", "q_2": "L", "omega_1": "W"},
    }
    for name, symbols in expected.items():
        assert symbols.items() <= dict(manipulators.load(name).symbols).items()


def differences(a: Any, b: Any, place: str = "") -> dict[str, tuple[Any, Any]]:
    if isinstance(a, dict):
        pairs = [(f"{place}.{key}", a.get(key), b.get(key)) for key in a.keys() | b.keys()]
    elif isinstance(a, list):
        assert len(a) == len(b)
        pairs = [(f"{place}[{i}]", x, y) for i, (x, y) in enumerate(zip(a, b, strict=True))]
    else:
        return {} if a == b else {place: (a, b)}
    return {k: v for where, x, y in pairs for k, v in differences(x, y, where).items()}


@pytest.mark.parametrize("name", NAMES)
def test_files_are_short_and_explained(name: str) -> None:
    text = manipulators.path(name).read_text(encoding="utf-8")
    assert max(map(len, text.splitlines())) <= 100
    assert text.startswith("# ")
    table, _, symbols = text.partition("\n[symbols]\n")
    assert table.rstrip().endswith("]")
    assert symbols
    assert manipulators.load(name).symbols, "the field has customary ones for every entry"


def test_unknown_name_has_the_nearest() -> None:
    with pytest.raises(SpecError, match=r"no manipulator 'stewrt' \(did you mean stewart"):
        manipulators.load("stewrt")
    for name in ("", "../stewart", "stewart.toml", "x" * 5000, "\n"):
        with pytest.raises(SpecError, match=r"expected one of the \d+ that pne-gen list shows"):
            manipulators.load(name)


@pytest.mark.parametrize(
    ("name", "offered"),
    [
        ("stewrt", ["stewart", "stewart_sps", "stewart_7ups"]),
        ("3rrr", ["planar_3rrr", "hybrid_3rrrs", "hybrid_3rrrs_redundant"]),
        ("Delta", ["delta"]),
        ("zzzzzz", []),
    ],
)
def test_the_nearest_few_are_offered_not_all(name: str, offered: list[str]) -> None:
    with pytest.raises(SpecError) as caught:
        manipulators.load(name)
    words = set(re.findall(r"\w+", str(caught.value)))
    assert [each for each in offered if each in words] == offered
    assert words & set(manipulators.names()) == set(offered)


def test_path_is_a_specification_file() -> None:
    assert read_spec(Path(str(manipulators.path("delta")))) == manipulators.load("delta")
