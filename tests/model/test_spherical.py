"""Axes of spherical joints that a specification leaves to the program."""

from __future__ import annotations

import itertools
import warnings
from typing import Any

import numpy as np
import pytest

from pne_sym.mechanics.derive import derive
from pne_sym.model.errors import SpecError, SpecNote, SpecWarning
from pne_sym.model.reader import from_mapping, to_full_form

LINK = {"mass": 1.0, "centre_of_mass": [0.1, 0.02, 0.03], "inertia": [0.01, 0.02, 0.02]}
SKEW = [0.6, 0.0, 0.8]
SPIN_LAST, SPIN_FIRST = [False, False, True], [True, False, False]


def ball(extra: list[bool], axes: Any = None, **fields: Any) -> dict[str, Any]:
    given = {} if axes is None else {"axes": list(axes)}
    return {"kind": "S", "extra": extra, "link": LINK, **given, **fields}


def slide(axis: Any) -> dict[str, Any]:
    return {"kind": "P", "axis": axis, "actuated": True, "link": LINK}


def knee(axis: Any) -> dict[str, Any]:
    turn = {"kind": "R", "axis": axis, "actuated": True, "link": LINK}
    return {**turn, "offset": [0.4, 0.4, 0.1]}


# joints of a leg for axes of its ball, and the end of its last link
LEGS: dict[str, tuple[Any, list[float]]] = {
    "slide along z": (lambda axes: [ball(SPIN_LAST, axes), slide("z")], [0, 0, 0]),
    "slide along x": (lambda axes: [ball(SPIN_LAST, axes), slide("x")], [0, 0, 0]),
    "slide askew": (lambda axes: [ball(SPIN_LAST, axes), slide(SKEW)], [0, 0, 0]),
    "slide, first axis extra": (lambda axes: [ball(SPIN_FIRST, axes), slide("y")], [0, 0, 0]),
    "hinge": (lambda axes: [ball(SPIN_FIRST, axes), knee("z")], [0.6, 0.3, 0.2]),
    "rod": (lambda axes: [slide("z"), ball(SPIN_FIRST, axes)], [0.0, 0.9, 0.0]),
}


def spec(name: str, axes: Any = None) -> dict[str, Any]:
    make, end = LEGS[name]
    leg = {"base_point": [0, 0, 0], "joints": make(axes), "platform_point": [0.1, 0.05, 0.02]}
    return {
        "name": "one_leg",
        "space": "spatial",
        "platform": {"mass": 1.0, "inertia": [1.0, 1.0, 1.0]},
        "legs": [{**leg, "platform_joint": {"kind": "S", "offset": end}}],
        "home": {"X": [0.3, 0.4, 0.6, 0.0, 0.0, 0.0, 1.0, 0.2]},
    }


def is_closed(form: dict[str, Any]) -> bool:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpecNote)
        warnings.simplefilter("ignore", SpecWarning)
        (leg_type,) = derive(from_mapping(form, "one_leg")).leg_types
    return not leg_type.reasons


@pytest.mark.parametrize("name", ["slide along z", "slide askew", "hinge"])
def test_the_inverse_kinematics_is_closed(name: str) -> None:
    assert is_closed(spec(name))


@pytest.mark.slow
@pytest.mark.parametrize("name", LEGS)
def test_closed_if_any_choice_makes_it_so(name: str) -> None:
    def closed(axes: str) -> bool:
        try:
            return is_closed(spec(name, axes))
        except SpecError:  # singular for these axes, or not reached with the extra coordinate
            return False

    assert is_closed(spec(name))
    assert not all(closed(axes) for axes in map("".join, itertools.permutations("xyz")))


@pytest.mark.parametrize("name", LEGS)
def test_axes_are_perpendicular_and_written_out(name: str) -> None:
    with pytest.warns(SpecNote):
        manipulator = from_mapping(spec(name), "one_leg")
    axes = [j.axis for j in manipulator.legs[0].joints if j.kind == "R"][:3]
    assert abs(np.dot(axes[0], axes[1])) < 1e-15
    assert abs(np.dot(axes[1], axes[2])) < 1e-15
    assert from_mapping(to_full_form(manipulator), "again") == manipulator


def test_what_is_given_stays() -> None:
    form = spec("slide along z", "zyx")
    with pytest.warns(SpecNote):
        joints = from_mapping(form, "one_leg").legs[0].joints
    assert [j.axis.index(1.0) for j in joints] == [2, 1, 0, 2]
