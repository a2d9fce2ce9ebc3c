"""Mass, centre of mass and inertia of a link or the platform."""

from __future__ import annotations

from functools import partial

import numpy as np

from pne_sym.model.entry import Entry
from pne_sym.model.manipulator import ZERO3, ZERO33, Body, Matrix3, Vector3
from pne_sym.model.rotation import matrix3
from pne_sym.model.values import matrix, not_negative, number, numbers, vector

FIELDS = ("mass", "centre_of_mass", "inertia", "inertia_about")
COMPONENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_FORMS = (
    "a 3x3 tensor, three principal values [ixx, iyy, izz], "
    "or a table of ixx, iyy, izz, ixy, ixz, iyz (kg m^2)"
)
RELATIVE = 1e-9
"""Rounding allowed in symmetry, sign and triangle inequality, of the largest entry."""


def read_body(entry: Entry, *, plane: bool, also: tuple[str, ...] = ()) -> Body:
    """The inertia of a body.

    Args:
        entry: a table with mass (kg), centre_of_mass (m, body frame), inertia
            (kg m^2, body axes) and inertia_about ("centre_of_mass" or "origin").
        also: other fields of the table, which are not looked at.
        plane: motion in the plane: two-component centre of mass, izz alone counts.

    Raises:
        SpecError: a negative mass, or an inertia that no body can have.
    """
    table = entry.table((*FIELDS, *also))
    mass = not_negative(table.require("mass", "a number (kg)"))
    centre = table.read("centre_of_mass", partial(vector, plane=plane), ZERO3)
    inertia = table.get("inertia")
    about = table.get("inertia_about")
    if inertia is None:
        table.refuse(("inertia_about",), "there is no inertia here")
        return Body(mass, centre)
    tensor = _tensor(inertia, plane=plane)
    if about and about.choice(("centre_of_mass", "origin")) == "origin":
        tensor = _moved_to_centre(tensor, mass, centre)
    if plane:
        if (izz := tensor[2][2]) < 0.0:
            raise inertia.fault("izz about the centre of mass not negative", _told(izz, "izz"))
        return Body(mass, centre, tensor)
    return Body(mass, centre, _checked_spatial(inertia, tensor))


def _tensor(entry: Entry, *, plane: bool) -> Matrix3:
    value = entry.value
    if isinstance(value, dict):
        table = entry.table(COMPONENTS)
        found = {name: number(field) for name, field in table.fields.items()}
        ixx, iyy, izz, ixy, ixz, iyz = (found.get(name, 0.0) for name in COMPONENTS)
        return ((ixx, ixy, ixz), (ixy, iyy, iyz), (ixz, iyz, izz))
    if plane and isinstance(value, int | float):
        return (ZERO3, ZERO3, (0.0, 0.0, number(entry)))
    if not isinstance(value, list | tuple):
        raise entry.fault(("the number izz, " if plane else "") + _FORMS)
    if value and not isinstance(value[0], list | tuple):
        ixx, iyy, izz = numbers(entry, 3, _FORMS)
        return ((ixx, 0.0, 0.0), (0.0, iyy, 0.0), (0.0, 0.0, izz))
    return matrix(entry)


def _moved_to_centre(tensor: Matrix3, mass: float, centre: Vector3) -> Matrix3:
    """The tensor about the centre of mass from the one about the body's origin (Steiner)."""
    c = np.array(centre)
    return matrix3(np.array(tensor) - mass * (c @ c * np.eye(3) - np.outer(c, c)))


def _checked_spatial(entry: Entry, tensor: Matrix3) -> Matrix3:
    """The tensor, made exactly symmetric where it is so up to rounding."""
    array = np.array(tensor)
    rounding = RELATIVE * float(np.abs(array).max())
    if np.abs(array - array.T).max() > rounding:
        raise entry.fault("a symmetric tensor")
    smallest, middle, largest = np.linalg.eigvalsh(array)
    if smallest < -rounding:
        raise entry.fault(
            "a tensor about the centre of mass without negative principal moments",
            _told(smallest, "principal moment"),
        )
    if largest > smallest + middle + rounding:
        entry.warn(
            f": principal moments {smallest:.6g}, {middle:.6g}, {largest:.6g} kg m^2 belong to no "
            "body: the largest exceeds the sum of the others"
        )
    return matrix3(0.5 * (array + array.T))


def _told(value: float, what: str) -> str:
    return f"{what} {value:.6g} kg m^2"


MASSLESS = Body(0.0, ZERO3, ZERO33)
