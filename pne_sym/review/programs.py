"""Whether two compiled manipulators compute by the same text, and where they begin not to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import zip_longest
from typing import Any

import sympy as sp

from pne_sym.backends.bundle import Bundle
from pne_sym.program.ir import Block, Program
from pne_sym.program.public import Search
from pne_sym.review.code import places, statements_of
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
        replace(d.coordinates, home=((), ())), d.collected, d.relations, fields, table.branches,
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
    old, new = (dict(places(bundle.program)) for bundle in (before, after))
    for name in old | new:
        rows = [[s for b in side.get(name, ()) for s in statements_of(b)] for side in (old, new)]
        known = [{(e, t): text for e, t, text in side} for side in rows]
        for a, b in zip_longest(*rows):
            for row in (r for r in (a, b) if r is not None):
                key = row[:2]
                yield (*key, name), known[0].get(key, ""), known[1].get(key, "")
                break


class SameText:
    """Whether two programs compute a public function by the same text."""

    def __init__(self, before: Program, after: Program) -> None:
        self.programs = (before, after)
        self.prepared = [_definitions(p.prepare) for p in self.programs]

    def __call__(self, name: str) -> bool:
        """Whether steps, statements and prepared values are the same."""
        old, new = self.programs
        if (old.closures, old.given) != (new.closures, new.given):
            return False
        public = [{f.name: f for f in p.public} for p in self.programs]
        names, done = [name], set[str]()
        while names:
            if (name := names.pop()) in done:
                continue
            done.add(name)
            one, other = (of.get(name) for of in public)
            if one is None or one != other or not all(map(self._computes_alike, one.functions)):
                return False
            searches = (step for step in one.steps if isinstance(step, Search))
            names += [part for s in searches for part in (s.residual, s.slope)]
        return True

    def _computes_alike(self, name: str) -> bool:
        one, other = (p.functions.get(name) for p in self.programs)
        if one is None or one != other:
            return False
        shapes = [[p.shapes[array] for array in one.arrays] for p in self.programs]
        counts = [
            [p.leg_counts[b.leg_type] for b in one.blocks if b.leg_type] for p in self.programs
        ]
        names = (*one.shared, *(n for of in one.per_leg.values() for n in of))
        return shapes[0] == shapes[1] and counts[0] == counts[1] and self._prepared_alike(names)

    def _prepared_alike(self, names: Iterable[str]) -> bool:
        """Whether prepared values, and all that is computed on the way to them, are the same."""
        left, done = list(names), set[str]()
        while left:
            if (name := left.pop()) not in done:
                done.add(name)
                one, other = (of.get(name, []) for of in self.prepared)
                if one != other:
                    return False
                left += [str(s) for _, expr in one for s in sp.sympify(expr).free_symbols]
        return True


def _definitions(blocks: Iterable[Block]) -> dict[str, list[tuple[str, Any]]]:
    """What defines each value: leg type and expression of its statements."""
    found: dict[str, list[tuple[str, Any]]] = {}
    for block in blocks:
        for a in (*block.assignments, *block.sums):
            found.setdefault(str(a.target), []).append((block.leg_type, a.expr))
    return found
