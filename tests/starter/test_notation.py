"""Architecture notation: what is read, what is refused and how."""

from __future__ import annotations

import pytest

from pne_sym.model.errors import SpecError
from pne_sym.starter import parse_legs, starter_text


def test_counts_letters_and_platform_joint() -> None:
    (group,) = parse_legs("6-UPS")
    assert (group.count, group.plain, group.platform.letter, group.dofs) == (6, "UPS", "S", 3)
    assert parse_legs("6-ups") == parse_legs("6-UPS")


def test_equal_neighbours_become_one_group() -> None:
    assert parse_legs("1-RPR+2-RPR") == parse_legs("3-RPR")
    assert [group.count for group in parse_legs("RPR + 2-RRR")] == [1, 2]


def test_marks() -> None:
    first, second = parse_legs("3-_RP*S")[0].letters
    assert (first.actuated, first.extra, second.actuated, second.extra) == (
        True,
        False,
        False,
        True,
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "value ''; expected COUNT-LETTERS"),
        ("6UPS", "value '6UPS'; expected COUNT-LETTERS"),
        ("6-UPX", "joint 'X' in '6-UPX'; expected R revolute"),
        ("3-RRP", "platform joint 'P' in '3-RRP'; expected a leg that ends in S, U, R or W"),
        ("3-S", "leg '3-S'; expected at least one joint before the platform joint"),
        ("0-UPS", "0 legs 'UPS'; expected one leg or more"),
        ("129-UPS", "129 legs; expected 1 to 128 legs"),
        ("64-UPS+65-RUS", "129 legs; expected 1 to 128 legs"),
        ("99999-UPS", "value '99999-UPS'; expected COUNT-LETTERS"),
        ("6-UP_S", "a mark at the platform joint"),
        ("1-RRRRRRRRS", "8 degrees of freedom in '1-RRRRRRRRS'; expected at most 7"),
        ("6-UPS+", "value ''; expected COUNT-LETTERS"),
        ("6-U__PS", "expected COUNT-LETTERS"),
        ("6-UPS\n", "3-RPR"),
        ("R" * 2000, "2000 characters; expected COUNT-LETTERS"),
        ("6-\x1b[31mUPS", "expected COUNT-LETTERS"),
        ("3-ŔPR", "expected COUNT-LETTERS"),
        ("٣-RPR", "expected COUNT-LETTERS"),
    ],
)
def test_faults(text: str, message: str) -> None:
    if text.endswith("\n"):
        assert parse_legs(text) == parse_legs(text.strip())
        return
    with pytest.raises(SpecError) as caught:
        parse_legs(text)
    assert str(caught.value).startswith("--legs: ")
    assert message in str(caught.value)
    assert str(caught.value).isprintable()


@pytest.mark.parametrize(
    ("legs", "space", "message"),
    [
        ("6-UPS", "spacial", "--space: value 'spacial'; expected one of point, planar, spatial"),
        ("6-UPS", "planar", "joint 'U' of UPS leaves the plane"),
        ("3-RPS", "planar", ""),
        ("1-RRRR*S", "spatial", ""),
        ("3-RRRR*RS", "spatial", "4 degrees of freedom of an RRRRRS leg that are not marked extra"),
    ],
)
def test_space_faults(legs: str, space: str, message: str) -> None:
    if not message:
        assert starter_text("a", legs, space)
        return
    with pytest.raises(SpecError, match=message.replace("(", r"\(")):
        starter_text("a", legs, space)
