"""The mechanisms that every run of the tests draws: small ones, in NumPy and C."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from pne_sym.model.manipulator import JointKind, PlatformJointKind, Space
from tests.random.tally import Outcome, Tally, outcome

EVEN = range(0, 64, 2)
ODD = range(1, 64, 2)

_EVERYWHERE = {
    *(f"space {space}" for space in Space),
    *(f"joint {kind}" for kind in JointKind),
    *(f"platform joint {kind}" for kind in PlatformJointKind),
    "driven extra",
    "passive extra",
    "massless link",
}


@cache
def judged(seed: int) -> Outcome:
    """The outcome of a seed, found once."""
    return outcome(seed, light=True)


def check_breadth(seeds: Sequence[int]) -> None:
    """Most of what was drawn was derived, and everything occurs among it."""
    tally = Tally()
    for seed in seeds:
        tally.add(judged(seed))
    assert tally.derived >= 0.9 * len(seeds), tally
    assert not _EVERYWHERE - tally.features.keys(), tally
    assert tally.constrained, tally
    assert tally.iterated, tally
    assert tally.compiled, tally
