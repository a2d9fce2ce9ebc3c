"""Faults of a specification, told as what is wrong, where, and what is allowed."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import islice
from reprlib import Repr


class _ShortRepr(Repr):
    def repr_int(self, x: int, level: int) -> str:
        """An integer; Python refuses to print one of thousands of digits."""
        return super().repr_int(x, level) if x.bit_length() < 1000 else "a huge integer"


_SHORT = _ShortRepr()
_SHORT.maxlist = _SHORT.maxtuple = 6
_SHORT.maxstring = _SHORT.maxlong = _SHORT.maxother = 60
_SHORT.maxlevel = 3


class SpecError(ValueError):
    """A specification that cannot be used.

    The message reads `source: where: problem; expected ...`, for instance
    `robot.toml: legs[0].joints[1].axis: value [0, 0, 0]; expected a unit vector`.

    Attributes:
        source: the file, or what stands for it.
        where: path of the field in the specification; empty for the whole.
        problem: what is wrong, usually the value found.
        expected: what is allowed; empty where the problem says it all.
    """

    def __init__(self, source: str, where: str, problem: str, expected: str = "") -> None:
        """Compose the one-line message."""
        self.source = printable(source)
        self.where = where
        self.problem = problem
        self.expected = expected
        place = f"{self.source}: {where}: " if where else f"{self.source}: "
        super().__init__(place + problem + (f"; expected {expected}" if expected else ""))


class SpecWarning(UserWarning):
    """A specification that can be used, though probably not as it was meant."""


class SpecNote(UserWarning):
    """What a specification leaves to the program, and what the program chose."""


def printable(text: str, limit: int = 200) -> str:
    """The text on one line, without control characters, shortened to `limit`."""
    clean = "".join(c if c.isprintable() else "?" for c in text[:limit])
    return clean + ("..." if len(text) > limit else "")


def show(value: object) -> str:
    """A value as a short, printable piece of a message; of a table only the field names."""
    if isinstance(value, Mapping):
        fields = [printable(str(key), 20) for key in islice(value, 5)]
        return "{" + ", ".join(fields) + (", ..." if len(value) > len(fields) else "") + "}"
    return printable(_SHORT.repr(value))
