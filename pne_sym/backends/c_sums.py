"""Sums over the legs of all types in C: one accumulator where a value needs nothing but their sum.

So a leg type more adds its text and leaves that of the others, and of what is made of the sums.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from pne_sym.program.ir import Assignment, Block, Function
from pne_sym.program.slices import read_in


def with_common_sums(function: Function) -> Function:
    """The function with sums over all legs, where their parts by leg type are only added up."""
    return replace(function, blocks=common_sums(function.blocks))


def common_sums(blocks: Sequence[Block]) -> tuple[Block, ...]:
    """Blocks in which leg types add to common sums."""
    of = {s.target: block.leg_type for block in blocks for s in block.sums}
    items = [item for block in blocks for item in (*block.assignments, *block.ends)]
    read = Counter(name for item in items for e in item.read for name in read_in(e))
    alone = {t: leg for t, leg in of.items() if read[t.name] == 1}
    made = {a.target.name for block in blocks for a in block.assignments}
    common: dict[sp.Symbol, sp.Symbol] = {}
    kept: list[tuple[Assignment, ...]] = []
    for block in blocks:
        assignments = []
        for a in block.assignments:
            parts, rest, sign = _parts(a.expr, alone)
            total = sp.Symbol(f"{a.target}_of_legs")
            if not parts or total.name in made:
                assignments.append(a)
            elif rest or sign < 0:
                common |= dict.fromkeys(parts, total)
                assignments.append(replace(a, expr=sp.Add(*rest, sign * total)))
            else:
                common |= dict.fromkeys(parts, a.target)
        kept.append(tuple(assignments))
    return tuple(
        replace(
            block,
            assignments=own,
            sums=tuple(replace(s, target=common.get(s.target, s.target)) for s in block.sums),
        )
        for block, own in zip(blocks, kept, strict=True)
    )


def _parts(expr: Any, alone: dict[sp.Symbol, str]) -> tuple[list[sp.Symbol], list[Any], int]:
    """Sums by leg type that an expression adds up, no two of a type; the rest; their sign."""
    apart = not alone or alone.keys().isdisjoint(expr.free_symbols)
    terms = () if apart else sp.Add.make_args(expr)
    for sign in (1, -1):
        parts = [sign * t for t in terms if sign * t in alone]
        if parts and len({alone[p] for p in parts}) == len(parts):
            return parts, [t for t in terms if sign * t not in parts], sign
    return [], [], 1
