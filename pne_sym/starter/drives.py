"""Which joints of the legs are driven, where the notation does not mark them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

from pne_sym.mechanics.mobility import mobility
from pne_sym.model.manipulator import Manipulator
from pne_sym.starter.choose import Shape
from pne_sym.starter.notation import LegGroup, is_marked

Flags = tuple[bool, ...]

_MOST_DRIVES = 40


def choose_drives(
    groups: tuple[LegGroup, ...], shapes: tuple[Shape, ...], free: Manipulator
) -> tuple[Flags, ...]:
    """The marked drives; else as many in each leg as the mechanism needs, slides first."""
    if is_marked(groups):
        return tuple(
            tuple(
                flag for letter in group.letters for flag in letter.kind.driven_parts(letter.driven)
            )
            for group in groups
        )
    total = sum(group.count for group in groups)
    extra = sum(g.count * sum(s.extra) for g, s in zip(groups, shapes, strict=True))
    each = math.ceil(max(mobility(free).freedoms - extra, 1) / total)
    result = []
    for group, shape in zip(groups, shapes, strict=True):
        order = [k for k in _preferred(group) if not shape.extra[k]]
        chosen = set(order[:each])
        # Surplus freedoms that move the leg are driven; a spin about its line stays passive.
        moving = [k for k, is_extra in enumerate(shape.extra) if is_extra]
        chosen |= set(moving) if not shape.idle else set()
        result.append(tuple(k in chosen for k in range(len(shape.extra))))
    return tuple(result)


def other_drives(poor: tuple[Flags, ...], shapes: tuple[Shape, ...]) -> Iterator[tuple[Flags, ...]]:
    """Other choices of as many drives in each leg."""
    per_group = []
    for driven, shape in zip(poor, shapes, strict=True):
        extra = [k for k, flag in enumerate(driven) if flag and shape.extra[k]]
        own = [k for k in range(len(driven)) if not shape.extra[k]]
        sets = itertools.combinations(own, sum(driven) - len(extra))
        per_group.append([tuple(k in (*some, *extra) for k in range(len(driven))) for some in sets])
    return itertools.islice(itertools.product(*per_group), _MOST_DRIVES)


def _preferred(group: LegGroup) -> list[int]:
    """Freedoms in the order in which drives are put on them: slides, then what turns simply."""
    ranks = [
        0 if letter.kind.slides else len(letter.kind.parts)
        for letter in group.letters
        for _ in letter.kind.parts
    ]
    return sorted(range(len(ranks)), key=ranks.__getitem__)
