"""What all kinds of joints have in common: one object each, found by its letter."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterable, Iterator
from enum import StrEnum
from typing import Any, ClassVar, Self, TypeVar

_Kind = TypeVar("_Kind")


class Look(StrEnum):
    """What a joint looks like in drawings."""

    PIN = "R"
    """A short cylinder about the axis."""
    CROSS = "U"
    """A cross of two pins."""
    BALL = "S"
    """A ball."""
    BLOCK = "rigid"
    """A block."""
    SLIDER = "P"
    """A rod in a tube, or a carriage on a rail."""
    SCREW = "H"
    """A threaded rod in a tube."""


class Kinds(type):
    """Makes a class of kinds iterable, as an enumeration is: `list(JointKind)`."""

    def __iter__(cls: type[_Kind]) -> Iterator[_Kind]:
        """All kinds, in the order in which lists of them are."""
        known: dict[str, Any] = cls.known  # type: ignore[attr-defined]
        found = sorted(known.values(), key=lambda kind: int(kind.order))
        return (kind for kind in found if isinstance(kind, cls))


class Kind(metaclass=Kinds):
    """A kind of joint.  A subclass that has a letter is one, with one object: family.NAME.

    Attributes:
        letter: how specifications and architectures write it.
        word: how sentences do, before "joint".
        order: its place in lists of kinds.
        in_plane: it may occur in mechanisms of the plane.
    """

    known: ClassVar[dict[str, Any]]
    letter: ClassVar[str]
    word: ClassVar[str]
    order: ClassVar[int]
    in_plane: ClassVar[bool] = False

    def __new__(cls, letter: str) -> Self:
        """The kind of this letter.

        Raises:
            ValueError: there is none.
        """
        kind = cls.known.get(str(letter))
        if not isinstance(kind, cls):
            raise ValueError(f"{letter!r} is not a valid {cls.__name__}")
        return kind

    def __init_subclass__(cls) -> None:
        """Make the object of a kind that has a letter of its own."""
        if "letter" in cls.__dict__:
            kind = cls.known[cls.letter] = object.__new__(cls)
            for family in cls.__mro__[1:]:
                if issubclass(family, Kind) and family is not Kind:
                    setattr(family, kind.name, kind)

    @property
    def value(self) -> str:
        """The letter."""
        return self.letter

    @property
    def in_architecture(self) -> str:
        """How architectures such as 6-UPS write it: what has no letter is left out."""
        return self.letter if len(self.letter) == 1 else ""

    @property
    def name(self) -> str:
        """The attribute of its family that it is, such as REVOLUTE."""
        return type(self).__name__.upper()

    def __eq__(self, other: object) -> bool:
        return self.letter == other if isinstance(other, str) else self is other

    def __hash__(self) -> int:
        return hash(self.letter)

    def __str__(self) -> str:
        return self.letter

    def __repr__(self) -> str:
        return f"<{self.word} joint, {self.letter}>"

    def __reduce__(self) -> tuple[type, tuple[str]]:
        return type(self), (self.letter,)


def letters(kinds: Iterable[Kind]) -> str:
    """Letters in words: "R, P or H"."""
    *others, last = (kind.letter for kind in kinds)
    return f"{', '.join(others)} or {last}" if others else last


def import_all(package: str, path: Iterable[str]) -> None:
    """Import the modules of a package: every one defines a kind."""
    for module in pkgutil.iter_modules(path):
        importlib.import_module(f"{package}.{module.name}")
