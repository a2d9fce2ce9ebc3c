"""Which joints of the legs are actuated, where the notation does not mark them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

from pne_sym.mechanics.mobility import mobility
from pne_sym.model.manipulator import Manipulator
from pne_sym.starter.choose import Shape
from pne_sym.starter.notation import SOURCE, LegGroup, fault, is_guide, is_marked

Flags = tuple[bool, ...]

_MOST_CHOICES = 40
_MOST_NUMBERS = 20000
_FEW = 4


def check_actuators(manipulator: Manipulator, groups: tuple[LegGroup, ...]) -> str:
    """Refuse what has not as many actuators as degrees of freedom; tell redundant ones.

    Raises:
        SpecError: fewer actuators than degrees of freedom, or some that cannot hold all of
            them, or legs that hold the platform in this arrangement.
    """
    found = mobility(manipulator)
    if found.overconstrained or not found.dofs:
        raise fault(
            f"overconstrained: the legs put {found.constraints} constraints on the platform, of "
            f"which {found.overconstrained} follow from the others, and leave "
            f"{_count(found.dofs, 'degree')} of freedom",
            "legs with more joints, or a specification written by hand, see docs/robots.md",
        )
    dofs = found.dofs - found.passive
    told = f"{_count(found.actuators, 'actuator')} for {_count(dofs, 'degree')} of freedom"
    if found.actuators < dofs:
        raise fault(told, "more joints marked by _, or none to have them chosen")
    if found.unheld > found.passive:
        raise fault(
            f"{told}, which cannot hold the mechanism at home wherever the legs stand",
            "other actuated joints, or other legs",
        )
    if found.actuators == dofs:
        return ""
    if found.constraints and not is_marked(groups) and not any(is_guide(g, groups) for g in groups):
        raise fault(
            f"{told}: in general position the legs put {found.constraints} constraints on the "
            "platform, more than such machines have by their parallel and common axes",
            "a specification written by hand, see docs/robots.md",
        )
    return f"{SOURCE}: {told}: redundantly actuated, as legs that are alike have as many each"


def _count(number: int, thing: str) -> str:
    return f"{number} {thing}{'' if number == 1 else 's'}"


def choose_actuators(
    groups: tuple[LegGroup, ...], shapes: tuple[Shape, ...], free: Manipulator
) -> list[tuple[Flags, ...]]:
    """The marked actuators; else, for every way to give each leg a number, prismatic ones first.

    As many as the mechanism needs, where legs that are alike can have them; a guide has none.
    Where they cannot, the least number in each leg that is enough.
    """
    if is_marked(groups):
        marked = [[f for x in g.letters for f in x.kind.actuated_parts(x.actuated)] for g in groups]
        return [tuple(map(tuple, marked))]
    extra = sum(g.count * sum(s.extra) for g, s in zip(groups, shapes, strict=True))
    needed = max(mobility(free).dofs - extra, 1)
    return [
        tuple(_actuated(g, s, n) for g, s, n in zip(groups, shapes, numbers, strict=True))
        for numbers in _numbers(groups, shapes, needed)
    ]


def _numbers(
    groups: tuple[LegGroup, ...], shapes: tuple[Shape, ...], needed: int
) -> list[tuple[int, ...]]:
    """Actuators of a leg of each group: even numbers first."""
    guides = [is_guide(group, groups) for group in groups]
    least = [0 if g or any(s.extra) else 1 for g, s in zip(guides, shapes, strict=True)]
    own = [len(s.extra) - sum(s.extra) for s in shapes]
    most = [0 if guide else min(n, needed) for guide, n in zip(guides, own, strict=True)]
    choices = itertools.product(*(range(a, b + 1) for a, b in zip(least, most, strict=True)))
    exact = [
        numbers
        for numbers in itertools.islice(choices, _MOST_NUMBERS)
        if sum(g.count * n for g, n in zip(groups, numbers, strict=True)) == needed
    ]
    if exact:
        return sorted(exact, key=lambda numbers: (max(numbers) - min(numbers), numbers))[:_FEW]
    total = sum(g.count for g, guide in zip(groups, guides, strict=True) if not guide)
    each = math.ceil(needed / total)
    return [tuple(min(each, n) for n in most)]


def _actuated(group: LegGroup, shape: Shape, number: int) -> Flags:
    """Which degrees of freedom of a leg are actuated."""
    order = [k for k in _preferred(group) if not shape.extra[k]]
    chosen = set(order[:number])
    # Surplus degrees of freedom that move the leg are actuated; a spin about its line is not.
    moving = [k for k, is_extra in enumerate(shape.extra) if is_extra]
    chosen |= set(moving) if not shape.idle else set()
    return tuple(k in chosen for k in range(len(shape.extra)))


def other_actuators(
    poor: tuple[Flags, ...], shapes: tuple[Shape, ...]
) -> Iterator[tuple[Flags, ...]]:
    """Other choices of as many actuators in each leg."""
    per_group = []
    for actuated, shape in zip(poor, shapes, strict=True):
        extra = [k for k, flag in enumerate(actuated) if flag and shape.extra[k]]
        own = [k for k in range(len(actuated)) if not shape.extra[k]]
        sets = itertools.combinations(own, sum(actuated) - len(extra))
        per_group.append(
            [tuple(k in (*some, *extra) for k in range(len(actuated))) for some in sets]
        )
    return itertools.islice(itertools.product(*per_group), _MOST_CHOICES)


def _preferred(group: LegGroup) -> list[int]:
    """Degrees of freedom in the order in which actuators are put on them: prismatic ones first."""
    ranks = [
        0 if letter.kind.slides else len(letter.kind.parts)
        for letter in group.letters
        for _ in letter.kind.parts
    ]
    return sorted(range(len(ranks)), key=ranks.__getitem__)
