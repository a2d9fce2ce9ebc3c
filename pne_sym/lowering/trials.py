"""Ways to make a value, tried and forgotten, so that the cheapest can be taken."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, TypeVar

from pne_sym.lowering.builder import Builder
from pne_sym.lowering.statements import Atom, Undone

_T = TypeVar("_T")
_MAX_DEPTH = 2


class NotYetError(Exception):
    """A value is asked for while it is being made: this way around does not lead there."""


class Trial(NamedTuple):
    """A value made on trial.

    Attributes:
        cost: run-time operations beyond what is live; infinite if it needs what is not known yet.
        value: its components.
        stored: entries of tables that were made with it.
        forgotten: statements that were.
        is_final: all that it is made of was made in the cheapest way, so that it comes out the
            same wherever it is made anew.
    """

    cost: float
    value: Any
    stored: list[tuple[dict[Any, Any], Any, Any]]
    forgotten: Undone
    is_final: bool


class Trials:
    """Keeps what is made, and forgets what was only tried."""

    def __init__(self, builder: Builder) -> None:
        self._b = builder
        self._undo: list[tuple[dict[Any, Any], Any]] = []
        self._depth = 0
        self._cut = 0  # choices that were not made: the first way that leads there was taken

    def store(self, table: dict[Any, Any], key: Any, value: _T) -> _T:
        """Keep a value in a table; it goes when the trial in which it is made is forgotten."""
        table[key] = value
        self._undo.append((table, key))
        return value

    def attempt(self, make: Callable[[], Any]) -> Trial:
        """Make a value and forget it."""
        mark, undo, equation = self._b.mark(), len(self._undo), self._b.equation
        depth, self._depth = self._depth, self._depth + 1
        cut = self._cut
        value: Any = None
        cost = float("inf")
        try:
            value = make()
            cost = self._b.cost(atoms(value))
        except NotYetError:
            pass
        self._depth = depth
        stored = [(table, key, table.get(key)) for table, key in self._undo[undo:]]
        for table, key, _ in stored:
            table.pop(key, None)
        del self._undo[undo:]
        forgotten = self._b.rollback(mark)
        self._b.equation = equation
        return Trial(cost, value, stored, forgotten, self._cut == cut)

    def cheapest(self, makers: Sequence[Callable[[], _T]]) -> _T:
        """The value of the cheapest way; ties go to the first."""
        if len(makers) == 1:
            return makers[0]()
        if self._depth < _MAX_DEPTH:
            trials: list[Trial] = []
            while len(trials) < len(makers) and all(trial.cost for trial in trials):
                trials.append(self.attempt(makers[len(trials)]))  # none is cheaper than nothing
            best = min(range(len(trials)), key=lambda k: trials[k].cost)
            if trials[best].is_final and trials[best].cost < float("inf"):
                return self._adopt(trials[best])  # type: ignore[no-any-return]
            # Made anew: its own choices are then tried as deep as this one.
            return makers[best]()
        self._cut += 1
        for make in makers:
            trial = self.attempt(make)
            if trial.cost < float("inf"):
                return self._adopt(trial)  # type: ignore[no-any-return]
        return makers[0]()

    def _adopt(self, trial: Trial) -> Any:
        """The value of a trial, made for good: nothing may have been made since."""
        self._b.redo(trial.forgotten)
        for table, key, value in trial.stored:
            self.store(table, key, value)
        return trial.value


def atoms(value: Any) -> list[Atom]:
    """All atoms of nested tuples."""
    if isinstance(value, tuple | list):
        return [atom for part in value for atom in atoms(part)]
    return [value]
