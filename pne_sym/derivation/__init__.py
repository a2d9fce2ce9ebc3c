"""A derivation as data: named equations, the laws behind them, the notation."""

from pne_sym.derivation.actuation import Actuation
from pne_sym.derivation.book import Book
from pne_sym.derivation.coordinates import Coordinates, LegTypeInfo, Output
from pne_sym.derivation.derivation import Chapter, Derivation, full_name, full_names
from pne_sym.derivation.equation import (
    Condition,
    Equation,
    FailureStatus,
    Law,
    ReciprocalBasis,
    leg_sums,
    names_in,
)
from pne_sym.derivation.frames import BodyAxes, BodyFrame, rotations_by_place
from pne_sym.derivation.parameters import (
    AxisRelation,
    NameTakenError,
    ParameterField,
    ParameterTable,
    Rule,
)
from pne_sym.derivation.quantity import PLATFORM, Frame, Given, Quantity, Role

__all__ = [
    "PLATFORM",
    "Actuation",
    "AxisRelation",
    "BodyAxes",
    "BodyFrame",
    "Book",
    "Chapter",
    "Condition",
    "Coordinates",
    "Derivation",
    "Equation",
    "FailureStatus",
    "Frame",
    "Given",
    "Law",
    "LegTypeInfo",
    "NameTakenError",
    "Output",
    "ParameterField",
    "ParameterTable",
    "Quantity",
    "ReciprocalBasis",
    "Role",
    "Rule",
    "full_name",
    "full_names",
    "leg_sums",
    "names_in",
    "rotations_by_place",
]
