"""What precedes the legs in C, in two halves: what the legs wait for, and what can follow them.

A processor looks only so far ahead.  What only the sums over the legs meet would fill its window
while the roots and divisions of the legs wait behind it.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from pne_sym.backends.c_stages import Stage, Stages
from pne_sym.program.ir import Assignment
from pne_sym.program.slices import Slices, read_by, read_in


class Half(NamedTuple):
    """A part of what precedes the legs.

    Attributes:
        stages: that it runs, in order.
        own: statements of the function's own, in order.
        stored: names whose values are put where later parts find them.
    """

    stages: tuple[Stage, ...]
    own: tuple[Assignment, ...]
    stored: tuple[str, ...]


def halves(parts: Slices, stages: Stages, read_at_once: Iterable[str]) -> tuple[Half, Half]:
    """What stands before the legs of a function, and what may stand behind them.

    Args:
        parts: of the function.
        stages: that functions share.
        read_at_once: names that what is looked at before the legs reads.
    """
    name = parts.function.name
    first = parts.before.assignments if parts.before else ()
    own = stages.own(name, (*parts.function.unpack, *first))
    used = stages.used(name, "")
    kept = stages.stored(name)
    stored = [n for n in stages.passed(name) if n in kept]
    if not parts.legs or not parts.after:
        return Half(tuple(used), tuple(own), tuple(stored)), Half((), (), ())
    needed = {*read_at_once, *stages.read_by_legs(name)}
    first_own, first_stages = _closure(needed, own, used, stages)
    made = {n for s in first_stages for n in s.exported} | {a.target.name for a in first_own}
    early = [n for n in stored if n in made or n in needed]
    return (
        Half(tuple(first_stages), tuple(first_own), tuple(early)),
        Half(
            tuple(s for s in used if s not in first_stages),
            tuple(a for a in own if a not in first_own),
            tuple(n for n in stored if n not in early),
        ),
    )


def _closure(
    needed: set[str], own: list[Assignment], used: list[Stage], stages: Stages
) -> tuple[list[Assignment], list[Stage]]:
    """Statements and stages that the names need, with what shares local values with these."""
    local = {a.target.name for a in own}
    first = set(needed)
    while True:
        found = read_by(tuple(a for a in own if a.target.name in first))
        met = {a.target.name for a in own if read_in(a.expr) & local & first}
        if first.issuperset(found | met):
            break
        first |= found | met
    read = (s for s in used if first.intersection(s.exported))
    return [a for a in own if a.target.name in first], stages.with_what_they_need(read)
