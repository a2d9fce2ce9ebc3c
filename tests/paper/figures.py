"""How far the formulas of sections 5.2 and 5.4 are off as printed.

    python -m tests.paper.figures

prints the tables of docs/paper-check.md.  The samples are the same at every call, hence the
figures too.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from tests.paper.printed import (
    ERRATA,
    PRINTED,
    Array,
    SpatialLeg,
    assemble_spatial,
    columns,
)
from tests.paper.sampling import platform, samples, spatial_legs

EXAMPLES = {"hybrid_3prps": "3-PRPS", "tripod_3rps": "3-RPS"}


class Spread(NamedTuple):
    """Median and maximum of a relative error."""

    median: float
    maximum: float

    def __str__(self) -> str:
        return f"{two_digits(self.median)} / {two_digits(self.maximum)}"


class Figures(NamedTuple):
    """Relative errors of an example, by what is left as printed ("all": every erratum).

    Attributes:
        U: of the legs' U.
        backwards, forwards: of the legs' U with E4 alone, where k.W < 0 and elsewhere.
        Z: of the platform's Z.
        free: of Z along the platform's degrees of freedom, its null space of Hk (3-RPS).
    """

    U: dict[str, Spread]
    backwards: Spread
    forwards: Spread
    Z: dict[str, Spread]
    free: dict[str, Spread]


def errata(name: str) -> tuple[str, ...]:
    """The errata that concern an example: without a slide there is no E3."""
    return tuple(kind for kind in ERRATA if name == "hybrid_3prps" or kind != "E3")


def relative(found: Array, right: Array) -> float:
    """Largest difference over largest value."""
    return float(np.max(np.abs(found - right)) / np.max(np.abs(right)))


@cache
def figures(name: str) -> Figures:
    """The figures of an example."""
    kinds = {kind: frozenset({kind}) for kind in errata(name)} | {"all": PRINTED}
    drawn = [(platform(sample), spatial_legs(sample)) for sample in samples(name)]
    legs = [leg for _, group in drawn for leg in group]
    right = [assemble_spatial(body, group)[1] for body, group in drawn]
    Z, free = {}, {}
    for kind, printed in kinds.items():
        wrong = [assemble_spatial(body, group, printed)[1] for body, group in drawn]
        Z[kind] = spread(map(relative, wrong, right))
        if name == "tripod_3rps":
            along = [dofs(group) for _, group in drawn]
            free[kind] = spread(
                relative(N @ a, N @ b) for N, a, b in zip(along, wrong, right, strict=True)
            )
    return Figures(
        U={kind: of_legs(legs, printed) for kind, printed in kinds.items()},
        backwards=of_legs([leg for leg in legs if leg.k @ leg.W < 0], kinds["E4"]),
        forwards=of_legs([leg for leg in legs if leg.k @ leg.W >= 0], kinds["E4"]),
        Z=Z,
        free=free,
    )


def of_legs(legs: Sequence[SpatialLeg], printed: frozenset[str]) -> Spread:
    """Errors of U."""
    return spread(relative(leg.U(printed), leg.U()) for leg in legs)


def dofs(legs: Sequence[SpatialLeg]) -> Array:
    """Orthonormal rows that span the velocities which the constraints allow."""
    return np.asarray(np.linalg.svd(columns(legs, [[leg.k] for leg in legs]).T)[2][len(legs) :])


def spread(errors: Iterable[float]) -> Spread:
    """Median and maximum."""
    values = list(errors)
    return Spread(float(np.median(values)), float(np.max(values)))


def two_digits(value: float) -> str:
    """Two digits, as people write them; 0 for rounding errors."""
    if value < 1e-12:
        return "0"
    rounded = float(f"{value:.1e}")
    return f"{rounded:.{max(0, 1 - int(np.floor(np.log10(rounded))))}f}"


# ---- as Markdown -----------------------------------------------------------------------------


def leg_table() -> str:
    """Errors of the legs' U."""
    prps, rps = (figures(name) for name in EXAMPLES)
    rows = [
        (f"{kind} alone", _cell(prps.U, kind), _cell(rps.U, kind)) for kind in ("E1", "E2", "E3")
    ]
    rows += [
        ("E4 alone, legs with k·W < 0", str(prps.backwards), str(rps.backwards)),
        ("E4 alone, the other legs", str(prps.forwards), str(rps.forwards)),
        ("all", _cell(prps.U, "all"), _cell(rps.U, "all")),
    ]
    return _table(("left as printed", "3-PRPS, U", "3-RPS, U"), rows)


def platform_table() -> str:
    """Errors of the platform's Z."""
    wanted = (figures("hybrid_3prps").Z, figures("tripod_3rps").Z, figures("tripod_3rps").free)
    rows = [
        (kind if kind == "all" else f"{kind} alone", *(_cell(spreads, kind) for spreads in wanted))
        for kind in (*ERRATA, "all")
    ]
    head = ("left as printed", "3-PRPS, Z", "3-RPS, Z", "3-RPS, Z along the degrees of freedom")
    return _table(head, rows)


def _cell(spreads: dict[str, Spread], kind: str) -> str:
    return str(spreads[kind]) if kind in spreads else "-"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


if __name__ == "__main__":
    print(leg_table(), platform_table(), sep="\n\n")
