"""What follows the sums over the legs in C: pieces, of which some are the same in other functions.

What gives M is the same alone and in dynamics.  What a piece reads is found from its own first
place on, so that its text is the same wherever that stands.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import groupby
from typing import NamedTuple

from pne_sym.backends.c_once import Once
from pne_sym.backends.c_parts import Parts
from pne_sym.backends.c_text import Routine
from pne_sym.program.ir import Block
from pne_sym.program.slices import read_in, symbols


class AfterPiece(NamedTuple):
    """Statements with what they give.

    Attributes:
        block: the statements and stores.
        routine: that they would be.
        first: places of the first of what is passed on, and of the sums, that they read.
    """

    block: Block
    routine: Routine
    first: tuple[int, int]

    def call(self, once: Once) -> str:
        """A call of the routine that functions share."""
        moved = {n: f"{n} + {k}*w" for n, k in zip(("s", "sums"), self.first, strict=True) if k}
        return once.of(self.routine).call_with(moved)


class After:
    """What a function does behind the sums over its legs."""

    def __init__(self, parts: Parts) -> None:
        self.p = parts
        self.pieces = [self._piece(block) for block in self._blocks()]

    def routine(self, once: Once) -> Routine:
        """All of it; what others do too is a call."""
        lines: list[str] = []
        alone: list[Block] = []
        for piece in self.pieces:
            if once.is_shared(piece.routine):
                lines.append(piece.call(once))
            else:
                alone.append(piece.block)
        return self.p.after(alone, lines)

    def _piece(self, block: Block) -> AfterPiece:
        read = symbols(block)
        passed, sums = (
            min((k for k, n in enumerate(names) if n in read), default=0)
            for names in (self.p.passed, self.p.sums)
        )
        return AfterPiece(block, self.p.after([block], first=(passed, sums)), (passed, sums))

    def _blocks(self) -> Iterator[Block]:
        """Parts whose results the same functions give; one alone where they have more in common."""
        last = self.p.last
        if last is None:
            return
        givers = self.p.stages.givers
        groups = [tuple(g) for _, g in groupby(last.stores, lambda s: givers("", s))]
        blocks = [_with_what_it_needs(replace(last, stores=stores)) for stores in groups]
        if last.checks or sum(len(b.assignments) for b in blocks) != len(last.assignments):
            blocks = [last]
        yield from blocks


def _with_what_it_needs(block: Block) -> Block:
    """The block without the assignments that its results do not need."""
    needed = symbols(replace(block, assignments=()))
    kept = []
    for a in reversed(block.assignments):
        if a.target.name in needed:
            kept.append(a)
            needed |= read_in(a.expr)
    return replace(block, assignments=tuple(reversed(kept)))
