"""Straight-line Python: statements, tuples that are unpacked and returned, guards."""

from __future__ import annotations

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.scalar import PYTHON, ScalarPrinter, wrap
from pne_sym.backends.straight import StraightText

WIDTH = 98
_PRINTER = ScalarPrinter(PYTHON)


class PythonText(StraightText):
    """Writes the lines of function bodies, for places that are indented so far."""

    comment = "#"

    def __init__(
        self, bundle: Bundle, printer: ScalarPrinter | None = None, indent: int = 4
    ) -> None:
        super().__init__(bundle, printer or _PRINTER)
        self.width = WIDTH - indent

    def assign(self, target: str, value: str, sign: str = "=") -> list[str]:
        """An assignment, on several lines if it is long."""
        line = f"{target} {sign} {value}"
        if len(line) <= self.width:
            return [line]
        return [f"{target} {sign} (", *wrap(f"    {value}", self.width, "    "), ")"]

    def names(self, names: list[str], source: str) -> list[str]:
        """Unpack a tuple; nothing for an empty one."""
        return unpacked(names, source, self.width) if names else []


def unpacked(names: list[str], source: str, width: int) -> list[str]:
    """A tuple unpacked, on several lines if that is long."""
    line = f"{', '.join(names)}{',' if len(names) == 1 else ''} = {source}"
    if len(line) <= width:
        return [line]
    lines = ["(", *wrap("    " + ", ".join(names) + ",", width, "    ")]
    return [*lines, *wrap(f") = {source}", width, "    ")]
