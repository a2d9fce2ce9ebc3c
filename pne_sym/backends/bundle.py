"""What every back end prints: the manipulator, its derivation, its program."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

from pne_sym.backends.registry import default
from pne_sym.derivation import Coordinates, Derivation
from pne_sym.model.manipulator import Manipulator
from pne_sym.program.ir import Program


@dataclass(frozen=True)
class Bundle:
    """A compiled manipulator.

    Attributes:
        manipulator: the specification.
        derivation: named vector equations.
        program: scalar code.
        targets: names of those that are printed together; the manifest tells them.
    """

    manipulator: Manipulator
    derivation: Derivation
    program: Program
    targets: tuple[str, ...] = field(default_factory=default)

    @property
    def name(self) -> str:
        """Name of the model."""
        return self.manipulator.name

    @property
    def coordinates(self) -> Coordinates:
        """Names and order of what goes in and comes out."""
        assert self.derivation.coordinates is not None
        return self.derivation.coordinates

    @property
    def leg_counts(self) -> dict[str, int]:
        """Number of legs by leg type."""
        return {t.name: len(t.indices) for t in self.derivation.leg_types}


class Backend(Protocol):
    """A back end: compiled manipulator to files of its folder; what others know is its `Target`."""

    @property
    def operations(self) -> frozenset[str] | None:
        """Operations of public functions that it prints; None: it has functions of its own."""

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """Path below the model's folder, with slashes -> text."""
