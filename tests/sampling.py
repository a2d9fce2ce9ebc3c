"""Which cases of a parametrised test run in `make test`; `make test-all` runs all of them."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

import pytest

from pne_sym import manipulators

SAMPLE = (
    "delta",
    "fivebar_redundant",
    "hexapod_6uhs",
    "planar_3rpr",
    "planar_3rrr",
    "planar_mixed",
    "planar_redundant",
    "spherical_3ups",
    "stewart",
    "stewart_sps",
    "tripod_3rps",
    "tripod_3upu",
)
"""Entries of the catalogue, each of a structure of its own: tests of a run share what they derive.

Space translational; more actuators than degrees of freedom; screws; planar, with slides and
with none; legs of several types; a redundant
leg and extra coordinates; spherical; the ordinary one; passive extra coordinates; constrained;
constrained, with two axes at the platform.
"""


def sampled(cases: Iterable[Any], every: int, keep: Collection[Any] = ()) -> list[Any]:
    """The cases of a test, of which one of `every` runs always, from the first on.

    Args:
        cases: values of a parameter, or tuples of several.
        every: how many cases a sampled one stands for; with 0 only those to keep run always.
        keep: cases that always run.
    """
    return [
        case if (every and k % every == 0) or case in keep else _only_in_all(case)
        for k, case in enumerate(cases)
    ]


def entries(every: int = 1, keep: Collection[str] = (), without: Collection[str] = ()) -> list[Any]:
    """The catalogue: one entry of `every` of `SAMPLE` and those to keep run always."""
    always = {*SAMPLE[::every], *keep}
    names = [name for name in manipulators.names() if name not in without]
    return [name if name in always else _only_in_all(name) for name in names]


def _only_in_all(case: Any) -> Any:
    values = case if isinstance(case, tuple) else (case,)
    return pytest.param(*values, marks=pytest.mark.only_in_all)
