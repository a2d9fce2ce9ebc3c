"""Live parameters of what acts in the joints of a leg."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from pne_sym.derivation import Book, ParameterField, Quantity, Rule
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.structure import LegType
from pne_sym.model.manipulator import Leg

_PARAMETERS: dict[str, tuple[str, str, str, Rule]] = {
    "viscous": ("b_{{{j}}}", "{effort} s/{q}", "viscous friction of {joint}", Rule.MASS),
    "coulomb": (r"\hat f_{{{j}}}", "{effort}", "Coulomb friction of {joint}", Rule.MASS),
    "velocity_scale": (
        r"\epsilon_{{{j}}}",
        "{q}/s",
        "rate of {joint} below which Coulomb friction grows linearly",
        Rule.POSITIVE,
    ),
    "stiffness": (
        r"k^s_{{{j}}}",
        "{effort}/{q}",
        "stiffness of the spring at {joint}",
        Rule.MASS,
    ),
    "rest": (
        "q^0_{{{j}}}",
        "{q}",
        "displacement of {joint} at which its spring is slack",
        Rule.FREE,
    ),
    "rotor_inertia": (
        "I^r_{{{j}}}",
        "kg m^2",
        "inertia of the rotor of {joint}, about its axis",
        Rule.MASS,
    ),
    "gear_ratio": (
        "n_{{{j}}}",
        "rad/{q}",
        "motor angle per displacement of {joint}",
        Rule.NONZERO,
    ),
}
"""Parameter -> symbol, unit, meaning, rule."""


@dataclass(frozen=True)
class Place:
    """A joint, and how its parameters are called.

    Attributes:
        stem: in names of parameters.
        path: in a leg of the full form.
        mark: index in formulas.
        word: in sentences.
        effort, unit: units of its force and of its displacement.
        pick: the joint of a leg.
    """

    stem: str
    path: str
    mark: str
    word: str
    effort: str
    unit: str
    pick: Callable[[Leg], Any]

    @staticmethod
    def of(g: LegGeometry, j: int) -> Place:
        """Joint j of a leg."""
        kind, stem = g.kind(j), g.leg_type.part("joint", j)
        path, pick = f"joints[{j - 1}]", lambda leg: leg.joints[j - 1]
        return Place(stem, path, str(j), f"joint {j}", kind.effort_unit, kind.unit, pick)


END = Place(
    "platform_joint",
    "platform_joint",
    "p",
    "the platform joint",
    "N m",
    "rad",
    lambda leg: leg.platform_joint,
)


class JointParameters:
    """Introduces the parameters of the joints of a leg type."""

    def __init__(self, book: Book, leg_type: LegType) -> None:
        self.book, self.leg_type = book, leg_type

    def add(self, at: Place, table: str, name: str) -> Any:
        """Symbol of an entry of a joint's table."""
        latex, unit, meaning, rule = _PARAMETERS[name]
        legs, meaning = self.leg_type, meaning.format(joint=at.word)
        values = legs.over_legs(lambda leg: float(getattr(getattr(at.pick(leg), table), name)))
        (symbol,) = self.book.parameters.add(
            ParameterField(
                f"{legs.name}_{at.stem}_{name}",
                legs.name,
                (),
                unit.format(effort=at.effort, q=at.unit),
                meaning,
                tuple(f"legs[{i}].{at.path}.{table}.{name}" for i in legs.indices),
                np.asarray(values),
                rule=rule,
            )
        )
        told = Quantity(symbol.name, latex.format(j=at.mark), meaning, parameter=True)
        self.book.note_quantity(told)
        return symbol
