"""Units are those of right-hand sides; a derivation that contradicts itself is not written.

Whatever else derives a mechanism, of the catalogue or at random, repeats the check.
"""

from __future__ import annotations

import pytest
import sympy as sp

from pne_sym import manipulators
from pne_sym.derivation import Book, Condition, FailureStatus, Law, ParameterField, Quantity, Role
from pne_sym.derivation.dimensions import Dimensions
from pne_sym.vector import Cross, Dot, VectorSymbol, ZeroVector
from pne_sym.vector.dimensions import DimensionError, dimension, dimension_of_unit
from tests.models import catalogue, derivation

r, v, omega = (VectorSymbol(name) for name in ("r", "v", "omega"))
mass = sp.Symbol("mass", real=True)


@pytest.fixture
def book() -> Book:
    """r in m, v in m/s, omega in rad/s, a mass."""
    found = Book()
    found.chapter("A", "First", "")
    for symbol, unit in ((r, "m"), (v, "m/s"), (omega, "rad/s")):
        components = sp.symbols(f"{symbol.name}_x:z", real=True)
        found.give(symbol, "base", components, Quantity(symbol.name, "", "given", unit))
    field = ParameterField("mass", None, (), "kg", "mass", ("mass",), sp.Float(1.0))
    found.parameters.add(field)
    found.note_quantity(Quantity("mass", "m", "mass"))
    return found


def unit(book: Book, rhs: object, law: Law = Law.DEFINITION, **facts: object) -> str:
    book.define("x", rhs, "x", "x", law, **facts)  # type: ignore[arg-type]
    return book.notation["x"].unit


@pytest.mark.parametrize(
    ("rhs", "law", "facts", "expected"),
    [
        (mass * Cross(omega, v), Law.NEWTON, {}, "N"),
        (mass * Cross(r, Cross(omega, v)), Law.EULER, {}, "N m"),
        (mass * Dot(v, v) / 2, Law.ENERGY, {}, "J"),
        (mass * Dot(v, Cross(omega, v)), Law.FRICTION, {}, "W"),
        (mass * Dot(omega, omega), Law.SPRING, {}, "N/m"),
        (2 * omega, Law.RATE, {}, "rad/s"),
        (Dot(omega, omega), Law.LUMPING, {}, "1/s^2"),
        (sp.atan2(mass, mass), Law.LOOP_CLOSURE, {"role": Role.DISPLACEMENT}, "rad"),
        (sp.atan2(mass, mass), Law.LOOP_CLOSURE, {}, "-"),
        (Dot(r, r), Law.GEOMETRY, {}, "m^2"),
        (ZeroVector, Law.GEOMETRY, {}, ""),
        (ZeroVector, Law.GEOMETRY, {"like": mass}, "kg"),
    ],
)
def test_unit_of_an_equation(
    book: Book, rhs: object, law: Law, facts: dict[str, object], expected: str
) -> None:
    assert unit(book, rhs, law, **facts) == expected


@pytest.mark.parametrize(
    ("rhs", "facts"),
    [
        (r + v, {}),
        (Cross(omega, r) + v, {"forms": (r,)}),
        (v, {"like": r}),
        (mass, {"conditions": (Condition(FailureStatus.SINGULAR, mass, mass**2),)}),
        (mass, {"conditions": (Condition(FailureStatus.UNREACHABLE, mass + 1),)}),
    ],
)
def test_what_contradicts_itself(book: Book, rhs: object, facts: dict[str, object]) -> None:
    with pytest.raises(DimensionError, match=r"^x: "):
        unit(book, rhs, **facts)  # type: ignore[arg-type]
    assert "x" not in book.notation


def test_given_vectors_have_the_unit_of_their_components(book: Book) -> None:
    names = sp.symbols("a:c", real=True)
    for name, measure in zip("abc", ("m", "m", "kg"), strict=True):
        book.parameters.add(ParameterField(name, None, (), measure, "", (name,), sp.Float(0.0)))
    a, b, c = names
    book.give(VectorSymbol("p"), "base", (a, b, 0), Quantity("p", "p", "given", "kg"))
    assert book.notation["p"].unit == "m"
    book.give(VectorSymbol("e"), "base", (0, 0, 1), Quantity("e", "e", "given", "kg"))
    assert book.notation["e"].unit == "-"
    with pytest.raises(DimensionError, match="different dimension"):
        book.give(VectorSymbol("n"), "base", (a, b, c), Quantity("n", "n", "given"))
    assert book.notation["mass"].unit == "kg"


ROLES = {
    Role.POSITION: "m",
    Role.VELOCITY: "m/s",
    Role.ACCELERATION: "m/s^2",
    Role.ANGULAR_VELOCITY: "rad/s",
    Role.ANGULAR_ACCELERATION: "rad/s^2",
    Role.GRAVITY: "m/s^2",
    Role.POINT: "m",
    Role.POINT_VELOCITY: "m/s",
    Role.POINT_ACCELERATION: "m/s^2",
    Role.COLLECTED_ACCELERATION: "m/s^2",
    Role.BIAS: "m/s^2",
    Role.LEG_INERTIA: "kg",
    Role.LEG_BIAS: "N",
}
OF_JOINTS = {Role.DISPLACEMENT: "", Role.RATE: "/s", Role.JOINT_ACCELERATION: "/s^2"}


@pytest.mark.parametrize("name", manipulators.names())
def test_of_the_catalogue(name: str) -> None:
    """What is computed from the right-hand sides is what the quantities are known to be."""
    manipulator = catalogue(name)
    of = derivation(name)
    members = {info.name: info.indices[0] for info in of.leg_types}
    units = Dimensions(of.notation, of.parameters)
    for quantity in of.notation.values():
        if quantity.role in ROLES:
            assert quantity.unit == ROLES[quantity.role], quantity
        if quantity.role in OF_JOINTS:
            joint = manipulator.legs[members[quantity.leg_type]].joints[quantity.joint - 1]
            assert quantity.unit == joint.kind.unit + OF_JOINTS[quantity.role], quantity
    for equation in of.equations():
        found = dimension(equation.rhs, units)
        if found is not None and not isinstance(equation.rhs, sp.Float):
            shown = of.notation[equation.name].unit
            assert dimension_of_unit(shown) == found, equation.name
