"""What ways to make components know of each other."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

from pne_sym.derivation import Given
from pne_sym.lowering.bases import Bases
from pne_sym.lowering.builder import Builder
from pne_sym.lowering.rotation import Rotation
from pne_sym.lowering.statements import Atom
from pne_sym.lowering.trials import Trials
from pne_sym.lowering.triples import Matrix, Triple


class Components(ABC):
    """Components of expressions: vectors, tensors and scalars are made of each other.

    Attributes:
        b: makes the statements.
        given: what is given, by symbol.
        trials: for ways of which the cheapest is taken.
        bases: reciprocal bases, and what is resolved in them.
        rotation: between frames.
    """

    b: Builder
    given: dict[Any, Given]
    trials: Trials
    bases: Bases
    rotation: Rotation

    @abstractmethod
    def vector(self, expr: Any, frame: str, hint: str = "") -> Triple:
        """Components of a vector expression in a frame."""

    @abstractmethod
    def tensor(self, expr: Any, frame: str, hint: str = "") -> Matrix:
        """Components of a tensor expression in a frame."""

    @abstractmethod
    def scalar(self, expr: Any, hint: str = "") -> Atom:
        """The atom of a scalar expression."""

    @abstractmethod
    def frames_of(self, expr: Any) -> list[str]:
        """Home frames of the vectors and tensors in an expression, most frequent first."""

    @abstractmethod
    def note_total(self, expr: Any, frame: str, value: Any) -> None:
        """Note what a sum over the legs of a type is."""
