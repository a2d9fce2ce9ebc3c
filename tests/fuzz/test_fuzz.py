"""A share of the fuzz target, and properties that hold for anything an author may write."""

from __future__ import annotations

import json
import warnings
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pne_sym import manipulators
from pne_sym.model.errors import SpecError, SpecWarning
from pne_sym.model.names import LONGEST
from pne_sym.model.reader import from_mapping, from_text, to_full_form
from pne_sym.starter import parse_legs
from tests.fuzz.fuzz import run_cases
from tests.fuzz.mutate import trees

RELAXED = settings(
    max_examples=150, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
)
PLAIN: Any = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner),
    max_leaves=12,
)


@pytest.mark.parametrize("seed", range(3))
def test_broken_specifications_through_the_entry_point(seed: int) -> None:
    tally = run_cases(seed, 0, 150)
    assert tally.failures == ()
    assert tally.refused > 50
    assert tally.accepted > 0


def test_a_case_depends_on_seed_and_number_alone() -> None:
    assert run_cases(7, 20, 3).accepted == run_cases(7, 20, 3).accepted


def told_in_one_line(message: str, source: str) -> bool:
    assert message.startswith(f"{source}: ")
    assert message.isprintable()
    return True


def accepted(data: object, source: str = "any") -> bool:
    """Whether the reader accepts it; a refusal is one printable line."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpecWarning)
        try:
            manipulator = from_mapping(data, source)  # type: ignore[arg-type]
        except SpecError as error:
            return not told_in_one_line(str(error), source)
        assert from_mapping(to_full_form(manipulator), source) == manipulator
        return True


@RELAXED
@given(PLAIN)
def test_anything_at_all(data: object) -> None:
    assert not accepted(data)


@RELAXED
@given(st.integers(0, len(trees()) - 1), st.integers(0, 10**6), PLAIN)
def test_anything_in_one_place(which: int, place: int, value: object) -> None:
    tree = json.loads(json.dumps(trees()[which]))
    spots = list(places(tree))
    holder, key = spots[place % len(spots)]
    holder[key] = value
    accepted(tree)


def places(tree: Any) -> Any:
    """Every element of a tree, as its holder and key."""
    items = list(tree.items()) if isinstance(tree, dict) else list(enumerate(tree))
    for key, value in items:
        yield tree, key
        if isinstance(value, dict | list):
            yield from places(value)


@RELAXED
@given(st.text(max_size=60))
def test_any_text_as_toml_or_json(text: str) -> None:
    for suffix in (".toml", ".json"):
        with pytest.raises(SpecError) as caught:
            from_text(text, suffix, "any")
        assert str(caught.value).isprintable()


@RELAXED
@given(st.text(max_size=60) | st.from_regex(r"[a-z][a-z0-9_]{0,50}", fullmatch=True))
def test_names_are_identifiers_or_refused(name: str) -> None:
    form = to_full_form(manipulators.load("fivebar_revolute")) | {"name": name}
    if accepted(form):
        assert name.isidentifier()
        assert name.isascii()
        assert name == name.lower()
        assert len(name) <= LONGEST
        assert "__" not in name


@RELAXED
@given(st.text(max_size=30) | st.from_regex(r"[0-9]{0,2}-?[_RPHUCS*+0-9-]{0,12}", fullmatch=True))
def test_any_architecture_is_read_or_refused(text: str) -> None:
    try:
        groups = parse_legs(text)
    except SpecError as error:
        told_in_one_line(str(error), "--legs")
        return
    assert 1 <= sum(group.count for group in groups) <= 128
