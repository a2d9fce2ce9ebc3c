"""What a function does before, over and after the legs, and what passes between these parts.

Everything here follows from the function; back ends ask for it instead of reading their own text.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from math import prod
from typing import Any

from pne_sym.program.ir import Assignment, Block, Check, Function, Store


@dataclass(frozen=True)
class Slices:
    """The parts of a function.

    Attributes:
        function: the function.
        before: what precedes the legs, or None.
        legs: a block per leg type, in order.
        after: what needs the sums over the legs, or None.
        passed: names made before the legs that later parts read, in order.
        sums: names of the sums over the legs, in order; leg types may add to the same.
    """

    function: Function
    before: Block | None
    legs: tuple[Block, ...]
    after: Block | None
    passed: tuple[str, ...]
    sums: tuple[str, ...]

    @property
    def made(self) -> set[str]:
        """Names that the function gives values itself."""
        blocks = self.function.blocks
        own = {a.target.name for block in blocks for a in block.assignments}
        return own | {a.target.name for a in self.function.unpack} | set(self.sums)

    @property
    def entries(self) -> set[str]:
        """Entries of input vectors that are read: where the inputs are named, and there alone."""
        return read_by(self.function.unpack)

    @property
    def reads_before(self) -> set[str]:
        """Names that are read where the inputs are named, and before the legs."""
        return symbols(self.before) | read_by(self.function.unpack)

    @property
    def reads(self) -> set[str]:
        """All names that are read."""
        return self.reads_before.union(*map(symbols, self.function.blocks))


def slices(function: Function) -> Slices:
    """A function in its parts."""
    blocks = function.blocks
    first = next((k for k, b in enumerate(blocks) if b.leg_type), len(blocks))
    before = next(iter(blocks[:first]), None)
    legs = tuple(b for b in blocks if b.leg_type)
    after = next((b for b in blocks[first:] if not b.leg_type), None)
    made = [a.target.name for a in (*function.unpack, *(before.assignments if before else ()))]
    later = set[str]().union(*(symbols(b) for b in (*legs, after)))
    return Slices(
        function,
        before,
        legs,
        after,
        tuple(n for n in dict.fromkeys(made) if n in later),
        tuple(dict.fromkeys(s.target.name for b in legs for s in b.sums)),
    )


@lru_cache(1 << 16)
def read_in(expr: Any) -> frozenset[str]:
    """Names that an expression reads."""
    if expr.is_Symbol:
        return frozenset((expr.name,))
    return frozenset[str]().union(*map(read_in, expr.args))


def read_by(items: Iterable[Assignment | Check | Store]) -> set[str]:
    """Names that assignments, checks and entries read."""
    return set[str]().union(*(read_in(e) for item in items for e in item.read))


def symbols(block: Block | None) -> set[str]:
    """Names that a block reads, those that it makes for itself included."""
    return read_by((*block.assignments, *block.ends)) if block else set()


def columns(shape: tuple[int, ...]) -> int:
    """Length of a row of an array."""
    return shape[1] if len(shape) == 2 else 1


def places_of(store: Store, legs: int = 1) -> tuple[tuple[int, int], ...]:
    """Row and column of a stored entry for every leg."""
    row, column = store.row, 0 if store.column is None else store.column
    rows = row if isinstance(row, tuple) else (row,) * legs
    across = column if isinstance(column, tuple) else (column,) * legs
    return tuple(zip(rows, across, strict=True))


def flat_places(store: Store, width: int, legs: int = 1) -> tuple[int, ...]:
    """Flat index of a stored entry for every leg; `width` is the length of the array's rows."""
    return tuple(row * width + column for row, column in places_of(store, legs))


def is_full(
    function: Function, array: str, shape: tuple[int, ...], legs: Mapping[str, int]
) -> bool:
    """Whether every entry of an output array is stored (what is not is zero)."""
    stored: set[int] = set()
    for block in function.blocks:
        for store in block.stores:
            if store.array == array:
                places = flat_places(store, columns(shape), legs.get(block.leg_type, 1))
                stored |= set(places)
    return len(stored) == prod(shape)
