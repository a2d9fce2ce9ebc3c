"""Manipulators built in Python: checked and normalised like a file, with the same errors."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pne_sym
from pne_sym import Joint, JointKind, Manipulator, SpecError, SpecWarning
from pne_sym.model.reader import checked
from tests.cli.program import tree

PAIR: Manipulator = replace(pne_sym.load("fivebar_prismatic"), symbols=())
JOINT = PAIR.legs[0].joints[0]


def with_joint(**fields: Any) -> Manipulator:
    joints = (replace(JOINT, **fields), *PAIR.legs[0].joints[1:])
    return replace(PAIR, legs=(replace(PAIR.legs[0], joints=joints), *PAIR.legs[1:]))


def test_the_same_files_as_from_the_specification(tmp_path: Path) -> None:
    pne_sym.generate("fivebar_revolute", tmp_path / "name")
    pne_sym.generate(pne_sym.load("fivebar_revolute"), tmp_path / "object")
    assert tree(tmp_path / "name") == tree(tmp_path / "object")


def test_lists_and_arrays_are_normalised() -> None:
    odd = replace(PAIR, gravity=np.array(PAIR.gravity))  # type: ignore[arg-type]
    assert checked(odd) == PAIR
    assert checked(with_joint(axis=[0, 0, 1])) == PAIR


@pytest.mark.parametrize(
    ("broken", "message"),
    [
        (replace(PAIR, name="../up"), "Manipulator('../up'): name: value '../up'; expected a"),
        (replace(PAIR, name=3), "Manipulator(3): name: value 3; expected a string"),
        (replace(PAIR, title="a\nb"), "title: value 'a\\nb'; expected one line"),
        (replace(PAIR, legs=()), "legs: 0 legs; expected 1 to 128 legs"),
        (replace(PAIR, space="flat"), "space: value 'flat'; expected one of point, planar"),
        (replace(PAIR, gravity=(0, 0)), ""),
        (replace(PAIR, gravity=(0, 0, "g")), "gravity[2]: value 'g'; expected a number"),
        (replace(PAIR, gravity=None), "not a manipulator: 'NoneType' object is not iterable"),
        (replace(PAIR, platform=None), "not a manipulator: 'NoneType' object has no attribute"),
        (replace(PAIR, home=replace(PAIR.home, q=(1.0,))), "home.q: 1 numbers; expected 4"),
        (with_joint(axis=(0, 0, 2)), "legs[0].joints[0].axis: value [0, 0, 2]; expected a unit"),
        (with_joint(axis=(1.0, 0.0, 0.0)), "revolute axes are normal to the plane"),
        (with_joint(kind="Q"), "legs[0].joints[0].kind: value 'Q'; expected one of"),
        (with_joint(kind=JointKind.HELICAL), "expected R or P: other joints leave the plane"),
        (with_joint(actuated=1), "legs[0].joints[0].actuated: expected"),
        (Joint, "not a manipulator"),
        (3, "3: not a manipulator"),
        (None, "None: not a manipulator"),
    ],
)
def test_errors_are_those_of_a_file(broken: Any, message: str, tmp_path: Path) -> None:
    if not message:
        assert checked(broken).gravity == (0.0, 0.0, 0.0)
        return
    with pytest.raises(SpecError) as caught:
        pne_sym.generate(broken, tmp_path / "out")
    assert message.replace("actuated: expected", "actuated") in str(caught.value)
    assert str(caught.value).isprintable()
    assert not (tmp_path / "out").exists()


def test_too_few_actuators_are_a_warning(tmp_path: Path) -> None:
    legs = tuple(
        replace(leg, joints=tuple(replace(joint, actuated=False) for joint in leg.joints))
        for leg in PAIR.legs[:1]
    )
    with pytest.warns(SpecWarning) as told:
        pne_sym.generate(replace(PAIR, legs=(*legs, *PAIR.legs[1:])), tmp_path)
    first, second = (str(each.message) for each in told)
    assert "fewer actuators than degrees of freedom: 1 for 2" in first
    assert "inverse_dynamics, leg_reactions: NaN at every state" in second
