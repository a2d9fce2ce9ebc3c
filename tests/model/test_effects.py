"""Friction, springs, motors and limits of joints: what the reader takes, and how it is written."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import jsonschema
import numpy as np
import pytest

from pne_sym.model.effects import Actuator, Friction, Limits, Spring
from pne_sym.model.errors import SpecError
from pne_sym.model.limits import margin
from pne_sym.model.manipulator import Body, Joint, JointKind
from pne_sym.model.reader import from_mapping, to_full_form
from pne_sym.model.schema import json_schema
from tests.model.examples import spatial

VALIDATOR = jsonschema.Draft202012Validator(json_schema())
UNIVERSAL: dict[str, Any] = {"kind": "U", "axes": ["z", "y"]}
CYLINDER: dict[str, Any] = {"kind": "C", "axis": "z"}
ALL: dict[str, Any] = {
    "friction": {"viscous": 3.0, "coulomb": 4.0, "velocity_scale": 0.01},
    "spring": {"stiffness": 100.0, "rest": 0.2},
    "actuator": {"rotor_inertia": 1e-4, "gear_ratio": -600.0},
    "limits": {"displacement": [-0.1, 0.9], "rate": 2.0, "effort": 500.0},
}


def spec(**fields: Any) -> Any:
    """The lift, whose actuated slide stands at 0.5 m, with fields of its joint."""
    found = spatial()
    found["legs"][0]["joints"][0] |= fields
    return found


def compound(joint: dict[str, Any], **fields: Any) -> list[Joint]:
    """The degrees of freedom of a joint before the lift's own."""
    found = spatial()
    found["legs"][0]["joints"].insert(0, {**joint, **fields})
    count = 2
    found["home"]["q"] = [0.0] * count + found["home"]["q"]
    assert not list(VALIDATOR.iter_errors(found))
    return list(from_mapping(found, "spec").legs[0].joints[:count])


def test_all_of_them() -> None:
    form = spec(**ALL)
    assert not list(VALIDATOR.iter_errors(form))
    manipulator = from_mapping(form, "spec")
    joint = manipulator.legs[0].joints[0]
    assert joint.friction == Friction(3.0, 4.0, 0.01)
    assert joint.spring == Spring(100.0, 0.2)
    assert joint.actuator == Actuator(1e-4, -600.0)
    assert joint.limits == Limits((-0.1, 0.9), 2.0, 500.0)
    full: Any = to_full_form(manipulator)
    assert {name: full["legs"][0]["joints"][0][name] for name in ALL} == ALL
    assert not list(VALIDATOR.iter_errors(full))
    assert from_mapping(full, "again") == manipulator


def test_what_is_left_out_is_absent() -> None:
    (joint,) = from_mapping(spec(friction={"viscous": 0.0}), "spec").legs[0].joints
    assert joint.friction == Friction(viscous=0.0)
    assert (joint.spring, joint.actuator, joint.limits) == (None, None, None)
    full: Any = to_full_form(from_mapping(spec(), "spec"))
    assert not ALL.keys() & full["legs"][0]["joints"][0].keys()
    (joint,) = from_mapping(spec(spring={"stiffness": 5}, friction=False), "spec").legs[0].joints
    assert (joint.spring, joint.friction) == (Spring(5.0, 0.0), None)


def test_of_several_freedoms() -> None:
    """One table is for each degree of freedom, motors for actuated ones; a list is exact."""
    both = compound(UNIVERSAL, friction={"viscous": 2.0})
    assert [joint.friction for joint in both] == [Friction(2.0), Friction(2.0)]
    one = compound(UNIVERSAL, friction=[False, {"viscous": 2.0}])
    assert [joint.friction for joint in one] == [None, Friction(2.0)]
    motor = {"rotor_inertia": 1e-3, "gear_ratio": 9.0}
    actuated = compound(UNIVERSAL, actuated=[False, True], actuator=motor)
    assert [joint.actuator for joint in actuated] == [None, Actuator(1e-3, 9.0)]
    pushed = compound(UNIVERSAL, actuated=[False, True], limits={"rate": 2.0, "effort": 9.0})
    assert [joint.limits for joint in pushed] == [Limits(rate=2.0), Limits(rate=2.0, effort=9.0)]
    pushed = compound(UNIVERSAL, actuated=[False, True], limits={"effort": 9.0})
    assert [joint.limits for joint in pushed] == [None, Limits(effort=9.0)]
    slide = compound(CYLINDER, spring=[False, {"stiffness": 7.0}])
    assert [joint.spring for joint in slide] == [None, Spring(7.0)]
    slide = compound(CYLINDER, actuated=[False, True], actuator=motor)
    assert [joint.actuator for joint in slide] == [None, Actuator(1e-3, 9.0)]


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"friction": {}}, "viscous, coulomb with velocity_scale"),
        ({"friction": {"viscous": -1.0}}, "zero or a positive number"),
        ({"friction": {"coulomb": 1.0}}, "missing field 'velocity_scale'"),
        ({"friction": {"viscous": 1.0, "velocity_scale": 1.0}}, "it belongs to coulomb"),
        ({"friction": {"coulomb": 1.0, "velocity_scale": 0.0}}, "a positive number"),
        ({"friction": {"viscous": 1.0, "static": 1.0}}, "unknown field 'static'"),
        ({"friction": [{"viscous": 1.0}, False]}, "2 entries"),
        ({"spring": {"rest": 1.0}}, "missing field 'stiffness'"),
        ({"spring": {"stiffness": -1.0}}, "zero or a positive number"),
        ({"actuator": {"rotor_inertia": 1.0}}, "missing field 'gear_ratio'"),
        ({"actuator": {"rotor_inertia": 1.0, "gear_ratio": 0.0}}, "other than zero"),
        ({"actuator": {"rotor_inertia": -1.0, "gear_ratio": 1.0}}, "zero or a positive number"),
        ({"actuated": False, "actuator": ALL["actuator"]}, "no motor where the joint is not"),
        ({"limits": {}}, "displacement = "),
        ({"limits": {"displacement": [1.0, -1.0]}}, "below the largest"),
        ({"limits": {"displacement": [0.0]}}, "list of two numbers"),
        ({"limits": {"rate": 0.0}}, "a positive number"),
        ({"limits": {"effort": True}}, "a number"),
        ({"actuated": False, "limits": {"effort": 5.0}}, "no effort where the joint is not"),
        (
            {**UNIVERSAL, "axis": None, "actuated": [True, False], "limits": [{"effort": 5.0}] * 2},
            "no effort where the joint is not actuated",
        ),
        ({**CYLINDER, "friction": {"viscous": 1.0}, "actuated": False}, "a list of 2"),
        (
            {**UNIVERSAL, "axis": None, "actuated": [True, False],
             "actuator": [False, ALL["actuator"]]},
            "no motor where the joint is not actuated",
        ),
    ],
)  # fmt: skip
def test_what_is_refused(fields: dict[str, Any], said: str) -> None:
    with pytest.raises(SpecError, match="joints") as caught:
        from_mapping(spec(**fields), "spec")
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("between", "fits"),
    [((0.4, 0.6), True), ((0.5, 0.9), True), ((0.51, 0.9), False), ((-2.0, 0.49), False)],
)
def test_home_within_limits(between: tuple[float, float], fits: bool) -> None:
    form = spec(limits={"displacement": list(between)})
    if fits:
        from_mapping(form, "spec")
        return
    with pytest.raises(
        SpecError, match=r"home: home.q has 0.5 m at degree of freedom 0 of legs\[0\]"
    ):
        from_mapping(form, "spec")


def test_full_turns_of_hinges_do_not_count() -> None:
    hinge = Joint(JointKind.REVOLUTE, (0.0, 0.0, 1.0), limits=Limits((3.0, 4.0)))
    assert margin(hinge, -3.0) == pytest.approx(2 * np.pi - 3.0 - 3.0)
    assert margin(hinge, 2.9) == pytest.approx(-0.1)
    assert margin(replace(hinge, extra=True), -3.0) == pytest.approx(-6.0)
    assert margin(Joint(JointKind.REVOLUTE, (0.0, 0.0, 1.0)), 9.0) == np.inf


def test_payload() -> None:
    form = spatial()
    form["platform"]["payload"] = {"mass": 3.0, "centre_of_mass": [0.0, 0.1, 0.2]}
    assert not list(VALIDATOR.iter_errors(form))
    manipulator = from_mapping(form, "spec")
    assert manipulator.payload == Body(3.0, (0.0, 0.1, 0.2))
    assert from_mapping(to_full_form(manipulator), "again") == manipulator
    assert not list(VALIDATOR.iter_errors(to_full_form(manipulator)))
    form["platform"]["payload"]["mass"] = -1.0
    with pytest.raises(SpecError, match=r"platform.payload.mass: value -1.0"):
        from_mapping(form, "spec")
    form["platform"]["payload"] = {"weight": 3.0}
    with pytest.raises(SpecError, match=r"platform.payload: unknown field 'weight'"):
        from_mapping(form, "spec")


def test_a_leg_overrides_its_type() -> None:
    leg = spatial()["legs"][0]
    joint = leg["joints"][0] | {"friction": {"viscous": 3.0}}
    form = spatial()
    form["leg_types"] = {"p": {"joints": [joint], "platform_joint": "S"}}
    own = {"base_point": leg["base_point"], "platform_point": leg["platform_point"], "type": "p"}
    form["legs"] = [own | {"joints": {"0": {"friction": {"viscous": 5.0}}}}]
    assert not list(VALIDATOR.iter_errors(form))
    assert from_mapping(form, "spec").legs[0].joints[0].friction == Friction(5.0)
    form["legs"] = [own | {"joints": {"0": {"friction": False}}}]
    assert not list(VALIDATOR.iter_errors(form))
    assert from_mapping(form, "spec").legs[0].joints[0].friction is None


def test_friction_of_the_platform_joint() -> None:
    form = spatial()
    form["legs"][0]["platform_joint"] = {"kind": "S", "friction": {"viscous": 2.0}}
    assert not list(VALIDATOR.iter_errors(form))
    manipulator = from_mapping(form, "spec")
    assert manipulator.legs[0].platform_joint.friction == Friction(2.0)
    assert from_mapping(to_full_form(manipulator), "again") == manipulator
    form["legs"][0]["platform_joint"]["friction"] = False
    assert from_mapping(form, "spec").legs[0].platform_joint.friction is None
    form["legs"][0]["platform_joint"] = {"kind": "rigid", "friction": {"viscous": 2.0}}
    with pytest.raises(SpecError, match=r"platform_joint.friction: .* of kind rigid does not turn"):
        from_mapping(form, "spec")
