"""Whether two compiled manipulators compute by the same text, and where they begin not to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import zip_longest
from typing import Any

from pne_sym.backends.bundle import Bundle
from pne_sym.review.code import statements_of
from pne_sym.review.difference import StatementDifference


def same_derivation(before: Bundle, after: Bundle) -> bool:
    """Whether two derivations are the same but for the numbers of their specifications."""
    return _facts(before) == _facts(after)


def same_program(before: Bundle, after: Bundle) -> bool:
    """Whether two derivations and their programs are the same but for numbers that are defaults."""
    return before.program == after.program and same_derivation(before, after)


def _facts(bundle: Bundle) -> tuple[Any, ...]:
    """All that text is printed from but names, titles and default values."""
    d = bundle.derivation
    assert d.coordinates is not None
    table = d.parameters
    fields = [replace(f, default=()) for f in table.fields]  # type: ignore[arg-type]
    return (
        d.chapters, d.notation, d.bases, d.givens, d.frames, d.outputs, d.leg_types,
        replace(d.coordinates, home=((), ())), d.collected, fields, table.branches,
        table.relations, bundle.targets,
    )  # fmt: skip


def first_statement(before: Bundle, after: Bundle) -> StatementDifference | None:
    """The first statement of the programs that differs, in order of computation."""
    found = [
        StatementDifference(*place, old, new, 0)
        for place, old, new in _differences(before, after)
        if old != new
    ]
    return replace(found[0], count=len(found)) if found else None


def _differences(before: Bundle, after: Bundle) -> Iterator[tuple[tuple[str, str, str], str, str]]:
    """(equation, target, function) and both statements, pair by pair."""
    old, new = before.program, after.program
    places = [("prepare", [old.prepare, new.prepare])]
    for name in dict.fromkeys((*old.functions, *new.functions)):
        blocks = [p.functions[name].blocks if name in p.functions else () for p in (old, new)]
        places.append((name, blocks))
    for name, sides in places:
        rows = [[s for block in blocks for s in statements_of(block)] for blocks in sides]
        known = [{(e, t): text for e, t, text in side} for side in rows]
        for a, b in zip_longest(*rows):
            for row in (r for r in (a, b) if r is not None):
                key = row[:2]
                yield (*key, name), known[0].get(key, ""), known[1].get(key, "")
                break
