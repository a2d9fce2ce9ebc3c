"""Where components of quantities stand in the arrays of a model: M, Z, H and others."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from pne_sym.derivation import Book, Output
from pne_sym.mechanics.legs import Leg
from pne_sym.model.kinematics import TaskSpace
from pne_sym.vector import ZeroVector

Rows = tuple[int, ...]
"""Rows or columns of an array, one for each leg of a type."""
_ONE = ((0, 0),)


class Placer:
    """Puts quantities into arrays whose rows are V: platform first, extra coordinates after it."""

    def __init__(self, book: Book, space: TaskSpace, legs: Sequence[Leg]) -> None:
        self.book, self.space, self.legs = book, space, legs
        self.extras = self.numbered(legs, lambda leg: leg.motion.ydd, len(space.components))
        """Extra joints with the rows of their coordinates."""

    @staticmethod
    def numbered(
        legs: Sequence[Leg], of: Callable[[Leg], Iterable[int]], start: int = 0
    ) -> list[tuple[Leg, int, Rows]]:
        """What legs have, by numbers, with its places: in the order of legs, then of numbers."""
        keys = sorted((index, k) for leg in legs for index in indices(leg) for k in of(leg))
        at = {key: place for place, key in enumerate(keys, start)}
        return [(leg, k, tuple(at[i, k] for i in indices(leg))) for leg in legs for k in of(leg)]

    def extras_of(self, leg: Leg) -> list[tuple[int, Rows]]:
        """Extra joints of a leg type."""
        return [(j, rows) for other, j, rows in self.extras if other is leg]

    def _places(self, first: int) -> tuple[tuple[int, int], ...]:
        """(component, position) of the linear (0) or angular (3) components."""
        return tuple(
            (c - first, position)
            for position, c in enumerate(self.space.components)
            if first <= c < first + 3
        )

    def vector(self, array: str, value: Any, first: int) -> None:
        """Linear (first 0) or angular (3) rows."""
        self.book.outputs.append(Output(array, value, self._places(first)))

    def block(self, array: str, value: Any, row: int, column: int) -> None:
        """A block; one beside the diagonal is mirrored."""
        rows, columns, diagonal = self._places(row), self._places(column), row == column
        self.book.outputs.append(
            Output(array, value, rows, columns, mirrored=not diagonal, symmetric=diagonal)
        )

    def leg_row(self, array: str, leg: Leg, value: Any, first: int, rows: Rows) -> None:
        """Along rows of a symmetric array, and its mirror image."""
        self.book.outputs.append(
            Output(array, value, _ONE, self._places(first), leg.name, rows, (), mirrored=True)
        )

    def leg_column(self, array: str, leg: Leg, value: Any, first: int, columns: Rows) -> None:
        """Down columns."""
        self.book.outputs.append(
            Output(array, value, self._places(first), _ONE, leg.name, (), columns)
        )

    def leg_scalar(self, array: str, leg: Leg, value: Any, rows: Rows) -> None:
        """A number for each leg of a type, in a vector."""
        self.book.outputs.append(Output(array, value, _ONE, (), leg.name, rows))

    def leg_entry(
        self, array: str, leg: Leg, value: Any, rows: Rows, columns: Rows, *, mirrored: bool = False
    ) -> None:
        """The same, in a matrix."""
        self.book.outputs.append(
            Output(array, value, _ONE, _ONE, leg.name, rows, columns, mirrored=mirrored)
        )

    def wrench_rows(self, array: str, leg: Leg, wrench: tuple[Any, Any], rows: Rows) -> None:
        """Force, and moment where some leg transmits one, along rows of an array."""
        for first, part in zip((0, 3), wrench, strict=True):
            if part != ZeroVector:
                columns = tuple((c, first + c) for c in range(3))
                self.book.outputs.append(Output(array, part, _ONE, columns, leg.name, rows))


def indices(leg: Leg) -> tuple[int, ...]:
    """Numbers of the legs of a type."""
    return tuple(leg.g.leg_type.indices)


def actuated(leg: Leg) -> list[int]:
    """Actuated joints of a leg type."""
    return [j for j, joint in enumerate(leg.g.leg_type.model.joints, 1) if joint.actuated]
