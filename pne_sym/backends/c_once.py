"""Routines that several functions have alike in C stand once, under a name of their own."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from pne_sym.backends.c_text import Routine


class Once:
    """Knows which routines are alike but for their names.

    Args:
        routines: of all functions, each with the name that it has if it is shared.
    """

    def __init__(self, routines: Iterable[tuple[str, Routine]]) -> None:
        found = [(name, r) for name, r in routines if r.body]
        count = Counter(_key(r) for _, r in found)
        self.shared: dict[object, Routine] = {}
        issued = Counter[str]()
        for name, r in found:
            if count[_key(r)] > 1 and _key(r) not in self.shared:
                issued[name] += 1
                number = f"_{issued[name]}" if issued[name] > 1 else ""
                self.shared[_key(r)] = r._replace(name=f"{name}{number}")

    def of(self, routine: Routine) -> Routine:
        """What is called: the shared routine, or the routine itself."""
        return self.shared.get(_key(routine), routine)

    def is_shared(self, routine: Routine) -> bool:
        """Whether several functions have it."""
        return _key(routine) in self.shared

    def own(self, routine: Routine) -> list[str]:
        """The definition of a routine that is not shared, and an empty line."""
        if not routine.body or _key(routine) in self.shared:
            return []
        return [*routine.definition(), ""]

    def texts(self) -> list[str]:
        """Definitions of the shared routines."""
        return ["\n".join(r.definition()) for r in self.shared.values()]


def _key(routine: Routine) -> object:
    return routine.parameters, routine.body, routine.kind, routine.result
