"""Live parameters of what acts in the joints of a leg."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pne_sym.derivation import Book, Rule
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.live import note, of_legs

_PARAMETERS = {
    "viscous": ("b_{{{j}}}", "{effort} s/{q}", "viscous friction of {joint}", Rule.MASS),
    "coulomb": (r"\hat f_{{{j}}}", "{effort}", "Coulomb friction of {joint}", Rule.MASS),
    "velocity_scale": (
        r"\epsilon_{{{j}}}",
        "{q}/s",
        "rate of {joint} below which Coulomb friction grows linearly",
        Rule.POSITIVE,
    ),
    "stiffness": ("k^s_{{{j}}}", "{effort}/{q}", "stiffness of the spring at {joint}", Rule.MASS),
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
    "gear_ratio": ("n_{{{j}}}", "rad/{q}", "motor angle per displacement of {joint}", Rule.NONZERO),
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
    """

    stem: str
    path: str
    mark: str
    word: str
    effort: str
    unit: str

    @staticmethod
    def of(g: LegGeometry, j: int) -> Place:
        """Joint j of a leg."""
        kind, stem = g.kind(j), g.leg_type.part("joint", j)
        return Place(stem, f"joints[{j - 1}]", str(j), f"joint {j}", kind.effort_unit, kind.unit)


END = Place("platform_joint", "platform_joint", "p", "the platform joint", "N m", "rad")


def joint_parameter(book: Book, g: LegGeometry, at: Place, table: str, name: str) -> Any:
    """Introduce an entry of a joint's table; returns its symbol."""
    latex, unit, meaning, rule = _PARAMETERS[name]
    unit, meaning = unit.format(effort=at.effort, q=at.unit), meaning.format(joint=at.word)
    path = f"{at.path}.{table}.{name}"
    (symbol,) = of_legs(book, g.leg_type, f"{at.stem}_{name}", path, unit, meaning, rule=rule)
    return note(book, symbol, latex.format(j=at.mark), meaning)
