"""The cheapest way is taken, and the others leave no trace."""

from __future__ import annotations

from typing import Any

import pytest
import sympy as sp

from pne_sym.lowering.builder import Builder
from pne_sym.lowering.trials import NotYetError, Trials
from tests.lowering.numbers import inputs


class _Ways:
    """Ways to make the square of a sum, and a note of which were run."""

    def __init__(self) -> None:
        self.b = Builder()
        self.trials = Trials(self.b)
        self.x, self.y = inputs(self.b, {"x": 1.0, "y": 2.0})
        self.table: dict[Any, Any] = {}
        self.run: list[str] = []

    def dear(self) -> Any:
        self.run.append("dear")
        b, x, y = self.b, self.x, self.y
        parts = (b.mul(x, x), b.mul(b.mul(sp.Integer(2), x), y), b.mul(y, y))
        return self.trials.store(self.table, "way", b.add(parts, "dear"))

    def cheap(self) -> Any:
        self.run.append("cheap")
        total = self.b.add((self.x, self.y))
        return self.trials.store(self.table, "way", self.b.mul(total, total, "cheap"))

    def too_early(self) -> Any:
        self.run.append("too early")
        self.b.add((self.x, -self.y))
        self.trials.store(self.table, "early", 1)
        raise NotYetError("later")


def test_the_cheapest_is_made_and_nothing_else_is_left() -> None:
    ways = _Ways()
    found = ways.trials.cheapest([ways.dear, ways.too_early, ways.cheap])
    assert str(found) == "cheap"
    assert ways.table == {"way": found}
    assert len(ways.b.statements) == 2
    assert ways.b.given_names() == ["x", "y"]


def test_what_is_live_already_costs_nothing() -> None:
    ways = _Ways()
    ways.b.keep([ways.dear()])
    assert str(ways.trials.cheapest([ways.cheap, ways.dear])) == "dear"


def test_ties_go_to_the_first() -> None:
    ways = _Ways()
    assert str(ways.trials.cheapest([lambda: ways.x, lambda: ways.y])) == "x"


def test_a_single_way_is_not_tried_first() -> None:
    ways = _Ways()
    ways.trials.cheapest([ways.dear])
    assert ways.run == ["dear"]


def test_deep_down_the_first_way_that_leads_there_is_taken_as_it_was_tried() -> None:
    ways = _Ways()
    found: list[Any] = []

    def deep_down() -> Any:
        found.append(ways.trials.cheapest([ways.too_early, ways.dear, ways.cheap]))
        found.append((dict(ways.table), len(ways.b.statements)))
        return found[0]

    ways.trials.attempt(lambda: ways.trials.attempt(deep_down).value)
    assert str(found[0]) == "dear"
    assert found[1] == ({"way": found[0]}, 5)
    assert ways.run == ["too early", "dear"]
    assert ways.table == {}
    assert ways.b.statements == []


def test_no_way_at_all_is_the_first_ones_error() -> None:
    ways = _Ways()
    with pytest.raises(NotYetError, match="later"):
        ways.trials.cheapest([ways.too_early, ways.too_early])
    assert ways.trials.cheapest([ways.cheap, ways.dear]) == ways.table["way"]


def test_what_was_tried_with_all_its_own_ways_is_not_made_again() -> None:
    ways = _Ways()
    found = ways.trials.cheapest(
        [lambda: ways.trials.cheapest([ways.dear, ways.cheap]), ways.too_early]
    )
    assert str(found) == "cheap"
    assert ways.table == {"way": found}
    assert ways.run == ["dear", "cheap", "too early"]
