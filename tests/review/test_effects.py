"""Effects in words that say the same wherever a figure is read: sizes, not signed shares."""

from __future__ import annotations

import numpy as np
import pytest

from pne_sym.review import effect
from pne_sym.review.difference import Effect
from pne_sym.review.effect_text import effect_lines

NAMES = [("required force of leg 1", "N"), ("required torque of leg 2", "N m")]


def forces(*rows: tuple[tuple[float, float], tuple[float, float]]) -> Effect:
    """Of two actuators, per state before and after."""
    old, new = (np.array([row[k] for row in rows]) for k in (0, 1))
    return effect._forces_around(old, new, NAMES)


def test_less_force_is_not_told_as_more() -> None:
    """Weaker gravity: forces that pull and that push get smaller alike."""
    found = forces(((-50.0, 40.0), (-10.0, 36.0)), ((-20.0, 30.0), (-4.0, 30.0)))
    assert found.note == "by 80 % of the largest before, leg 1: -50 -> -10 N"
    assert "+" not in found.note


def test_many_times_and_from_nothing() -> None:
    found = forces(((1.0, 0.0), (-29.0, 0.0)))
    assert found.note == "by 30 times the largest before, leg 1: 1 -> -29 N"
    found = forces(((50.0, 0.0), (80.0, 3.0)))
    assert found.note == "leg 2: 0 -> 3 N m"


def test_states_that_one_version_allows() -> None:
    nan = float("nan")
    found = forces(((1.0, 2.0), (1.0, 2.0)), ((nan, nan), (1.0, 2.0)))
    assert found.note == "1 of 2 states possible in one version only"
    assert found.changed
    assert not forces(((1.0, 2.0), (1.0, 2.0)), ((nan, nan), (nan, nan))).changed


@pytest.mark.parametrize(
    ("old", "new", "note"),
    [
        ([1.0, 2.0], [1.0, 2.0], ""),
        ([1.0, 20.0], [0.5, 19.0], "by up to -50 %, 1 -> 0.5"),
        ([1.0, 20.0], [33.0, 19.0], "by up to 33 times, 1 -> 33"),
        ([0.0, 1.0], [0.0, 1.1], "by up to +10 %, 1 -> 1.1"),
    ],
)
def test_a_figure_beside_itself(old: list[float], new: list[float], note: str) -> None:
    assert effect._figure_around("least eigenvalue of M", np.array(old), np.array(new)).note == note


def told(a: float, b: float) -> str:
    lines = list(effect_lines([Effect("a", "at home", a, b, True, "N")]))
    return lines[1].strip()


def test_at_home() -> None:
    assert told(10.0, 11.0) == "a  10 -> 11 N (+10 %)"
    assert told(-10.0, 11.0) == "a  -10 -> 11 N (+10 % in size)"
    assert told(2.0, -46.0) == "a  2 -> -46 N (23 times in size)"
    assert told(3.0, -3.0) == "a  3 -> -3 N (opposite sign)"
    assert told(0.0, 1.0) == "a  0 -> 1 N"
