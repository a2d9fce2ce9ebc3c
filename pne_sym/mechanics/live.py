"""Live parameters: fields of the model, from where they stand in a specification."""

from __future__ import annotations

from typing import Any, NamedTuple, TypedDict, Unpack

import numpy as np
import sympy as sp

from pne_sym.derivation import Book, ParameterField, Quantity, Rule
from pne_sym.mechanics.structure import LegType
from pne_sym.mechanics.terms import rows_of
from pne_sym.model.manipulator import Leg

_ROWS = rows_of(r"""
base_point     | m        |                 | FREE     | base_point
    base point, base frame
base_frame     | -        |                 | ROTATION | base_frame
    rotation from leg axes to base axes
platform_point | m        |                 | FREE     | platform_point
    platform joint, platform frame
axis           | -        |                 | UNIT     | axis
    axis of @, preceding link's frame
pitch          | m/rad    |                 | FREE     | pitch
    pitch of @
offset         | m        |                 | FREE     | offset
    offset of @, preceding link's frame
axis_link      | -        |                 | UNIT     | axis_link
    axis_link of @
axis_platform  | -        |                 | UNIT     | axis_platform
    axis_platform of @
rotation       | -        |                 | ROTATION | rotation
    platform axes in the last link's frame
mass           | kg       | m_{#}           | MASS     | mass
    mass of @
centre_of_mass | m        |                 | FREE     | centre_of_mass
    centre of mass of @, link frame
inertia        | kg m^2   |                 | INERTIA  | inertia
    inertia tensor of @ about its centre of mass, link axes
viscous        | E s/U    | b_{#}           | MASS     | friction.viscous
    viscous friction of @
coulomb        | E        | \hat f_{#}      | MASS     | friction.coulomb
    Coulomb friction of @
velocity_scale | U/s      | \epsilon_{#}    | POSITIVE | friction.velocity_scale
    rate of @ below which Coulomb friction grows linearly
stiffness      | E/U      | k^s_{#}         | MASS     | spring.stiffness
    stiffness of the spring at @
rest           | U        | q^0_{#}         | FREE     | spring.rest
    displacement of @ at which its spring is slack
rotor_inertia  | kg m^2   | I^r_{#}         | MASS     | actuator.rotor_inertia
    inertia of the rotor of @, about its axis
gear_ratio     | rad/U    | n_{#}           | NONZERO  | actuator.gear_ratio
    motor angle per displacement of @
limits         | U        |                 | FREE     | limits.displacement
    least and largest displacement of @
effort         | E        | \bar\tau_{#}    | POSITIVE | limits.effort
    largest size of the force of actuator #
""")
"""Parameters of a leg and its parts: unit, where E is that of the part's force and U that of its
displacement; symbol, if it is told here; rule; path in the part.  In the meaning @ stands for the
part, # for its number."""


class Demands(TypedDict, total=False):
    """Which entries are zero by structure, and what values must be: see `ParameterField`."""

    zeros: tuple[int, ...]
    rule: Rule


class Place(NamedTuple):
    """A part of a leg that has parameters.

    Attributes:
        stem: in names of parameters.
        path: in a leg of the full form.
        word: in sentences.
        mark: index in formulas.
        effort, unit: units of its force and of its displacement.
    """

    stem: str = ""
    path: str = ""
    word: str = ""
    mark: str = ""
    effort: str = ""
    unit: str = ""

    @staticmethod
    def joint(legs: LegType, j: int) -> Place:
        """Joint j."""
        kind, stem = legs.model.joints[j - 1].kind, legs.part("joint", j)
        return Place(stem, f"joints[{j - 1}]", f"joint {j}", str(j), kind.effort_unit, kind.unit)

    @staticmethod
    def link(legs: LegType, j: int) -> Place:
        """Link j."""
        return Place(legs.part("link", j), f"joints[{j - 1}].link", f"link {j}", str(j))


LEG = Place()
END = Place("platform_joint", "platform_joint", "the platform joint", "p", "N m", "rad")


def of_all(
    book: Book,
    name: str,
    path: str,
    values: Any,
    unit: str,
    meaning: str,
    **demands: Unpack[Demands],
) -> tuple[sp.Expr, ...]:
    """A parameter of the whole machine: symbols of its entries."""
    default = np.array(values, dtype=float)
    return book.parameters.add(
        ParameterField(name, None, default.shape, unit, meaning, (path,), default, **demands)
    )


def of_legs(
    book: Book, legs: LegType, at: Place, name: str, **demands: Unpack[Demands]
) -> tuple[sp.Expr, ...]:
    """A parameter over the legs of a type: symbols of its entries.

    Args:
        book: of the derivation.
        legs: of the type.
        at: the part that has it.
        name: of its row in the table.
        demands: on its values, instead of the table's too.
    """
    (unit, latex, rule, path), meaning = _ROWS[name]
    unit = unit.replace("E", at.effort).replace("U", at.unit)
    meaning = meaning.replace("@", at.word).replace("#", at.mark)
    name = "_".join(filter(None, (legs.name, at.stem, name)))
    path = ".".join(filter(None, (at.path, path)))
    values = legs.over_legs(lambda leg: value_at(leg, path))
    paths = tuple(f"legs[{i}].{path}" for i in legs.indices)
    told: Demands = {"rule": Rule[rule], **demands}
    symbols = book.parameters.add(
        ParameterField(name, legs.name, values.shape[1:], unit, meaning, paths, values, **told)
    )
    if latex:
        note(book, symbols[0], latex.replace("#", at.mark), meaning)
    return symbols


def note(book: Book, symbol: Any, latex: str, meaning: str) -> Any:
    """Tell what an entry of a parameter is; returns its symbol."""
    book.note_quantity(Quantity(symbol.name, latex, meaning, parameter=True))
    return symbol


def value_at(leg: Leg, path: str) -> Any:
    """A value of a leg by its path, such as `joints[2].axis`."""
    value: Any = leg
    for part in path.split("."):
        name, _, index = part.partition("[")
        value = getattr(value, name)
        value = value[int(index[:-1])] if index else value
    return value
