"""The mechanisms that every run of the tests draws: small ones, in NumPy and C."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from pne_sym.model.manipulator import JointKind, PlatformJointKind, Space
from tests.random.tally import Outcome, Tally, outcome

# Seeds whose mechanisms are derived quickly; `make random` takes them as they come.
FIRST = (
    0,
    1,
    4,
    6,
    8,
    10,
    11,
    13,
    16,
    18,
    20,
    21,
    22,
    24,
    26,
    33,
    36,
    38,
    40,
    42,
    47,
    48,
    50,
    52,
    53,
    56,
    2,
    62,
    72,
    95,
)
SECOND = (
    63,
    5,
    7,
    9,
    15,
    17,
    19,
    23,
    25,
    27,
    31,
    35,
    37,
    39,
    41,
    43,
    45,
    49,
    55,
    57,
    59,
    61,
    64,
    66,
    67,
    68,
    70,
    71,
    90,
    99,
)

_EVERYWHERE = {
    *(f"space {space}" for space in Space),
    *(f"joint {kind}" for kind in JointKind),
    *(f"platform joint {kind}" for kind in PlatformJointKind),
    "actuated extra",
    "passive extra",
    "massless link",
    "friction",
    "spring",
    "motor",
    "payload",
    "platform friction",
    "moving base",
    "coupled motors",
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
    assert tally.overconstrained, tally
    assert tally.iterated, tally
    assert tally.compiled, tally
