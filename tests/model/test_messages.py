"""Each class of bad input is refused with one message: file, field, value, what is allowed."""

from __future__ import annotations

from typing import Any

import pytest

from pne_sym.model.errors import SpecError, SpecWarning
from pne_sym.model.reader import from_mapping
from tests.model.examples import ABSENT, planar, spatial, spoilt

SPATIAL: list[tuple[str, Any, str]] = [
    # names
    ("name", ABSENT, "missing field 'name'; expected name = its name"),
    ("name", "", "name: value ''; expected a lower-case letter"),
    ("name", "Lift", "name: value 'Lift'; expected a lower-case letter"),
    ("name", "lift/../x", "name: value 'lift/../x'; expected a lower-case letter"),
    ("name", "l" * 41, "at most 40 characters"),
    ("name", 3, "name: value 3; expected a string"),
    ("name", "check", "expected another name: 'check' is a command of pne-gen"),
    ("name", "lambda", "is a Python keyword"),
    ("name", "volatile", "is a keyword of C or C++"),
    ("name", "tgmath", "is a standard header of C"),
    ("name", "numpy", "is a Python module"),
    ("name", "dataclasses", "is a Python module"),
    ("name", "lift__b", "digits, single underscores between them"),
    ("name", "lift_", "digits, single underscores between them"),
    ("name", "unistd", "is a header of POSIX"),
    ("name", "com1", "is a device name on Windows"),
    ("title", "two\nlines", "title: value 'two\\nlines'; expected one line"),
    ("title", "x" * 200, "expected one line of 1 to 120 printable characters"),
    # unknown and missing fields, words
    ("platfrom", {}, "unknown field 'platfrom' (did you mean platform?); expected one of name"),
    ("legs.0.base_pont", [0, 0, 0], "legs[0]: unknown field 'base_pont' (did you mean base_point"),
    ("platform.mas", 1, "platform: unknown field 'mas' (did you mean mass?)"),
    ("legs.0.joints.0.link.mass", ABSENT, "legs[0].joints[0].link: missing field 'mass'"),
    ("legs.0.base_point", ABSENT, "legs[0]: missing field 'base_point'; expected base_point = "),
    ("legs.0.platform_point", ABSENT, "legs[0]: missing field 'platform_point'"),
    ("legs.0.joints.0.axis", ABSENT, "legs[0].joints[0]: missing field 'axis'"),
    ("home", ABSENT, "missing field 'home'"),
    ("home.X", ABSENT, "home: missing field 'X'"),
    ("space", "spacial", "space: value 'spacial'; expected one of point, planar, spatial"),
    ("space", "spacial", "(did you mean spatial"),
    ("space", ["spatial"], "space: value ['spatial']; expected one of"),
    ("legs.0.joints.0.kind", "Q", "legs[0].joints[0].kind: value 'Q'; expected one of R, P, H"),
    # shapes and numbers
    ("platform", 3, "platform: value 3; expected a table"),
    ("legs", {}, "legs: value {}; expected a list"),
    ("legs", [], "legs: 0 legs; expected 1 to 128 legs"),
    ("legs", [{}] * 200, "legs: 200 legs; expected 1 to 128 legs"),
    ("legs", [{}] * 5000, "legs: 5000 elements; expected at most 4096"),
    ("legs.0.joints", [], "legs[0].joints: 0 joints; expected 1 to 12 joints"),
    ("legs.0.base_point", [0, 0], "expected a list of three numbers (x, y, z) (2 given)"),
    ("legs.0.base_point", "here", "value 'here'; expected a list of three numbers"),
    ("legs.0.base_point", [0, 0, "1"], "legs[0].base_point[2]: value '1'; expected a number"),
    ("legs.0.base_point", [0, 0, True], "legs[0].base_point[2]: value True; expected a number"),
    ("legs.0.base_point", [0, 0, float("nan")], "base_point[2]: value nan; expected a finite"),
    ("legs.0.base_point", [0, 0, float("inf")], "base_point[2]: value inf; expected a finite"),
    ("legs.0.base_point", [0, 0, 10**400], "expected a finite number, at most 1e+12 in size"),
    ("legs.0.base_point", [0, 0, 1 << 20000], "value a huge integer; expected a finite number"),
    ("gravity", [0, 0, [1]], "gravity[2]: value [1]; expected a number"),
    ("fixed_centre", [0, 0, 0], "expected no such field: the space 'spatial' has none"),
    # axes and frames
    ("legs.0.joints.0.axis", [0, 0, 0], "a unit vector (length 1 to 1e-06), got a zero vector"),
    ("legs.0.joints.0.axis", [0, 0, 2], "got a vector of length 2"),
    ("legs.0.joints.0.axis", [0, 0, 1.00001], "got a vector of length 1.00001"),
    ("legs.0.joints.0.axis", "up", 'a unit vector or one of "x", "y", "z", "-x", "-y", "-z"'),
    ("legs.0.base_frame", [[1, 0], [0, 1]], "a 3x3 matrix (three rows of three numbers)"),
    ("legs.0.base_frame", [[1, 0, 0], [0, 1, 0], [0, 0]], "legs[0].base_frame[2]: value [0, 0]"),
    ("legs.0.base_frame", [[1, 0, 0], [0, 1, 0], [0, 0, -1]], "determinant +1)"),
    ("legs.0.base_frame", [[1, 0, 0], [0, 1, 0], [0, 0.1, 1]], "a rotation matrix (orthonormal"),
    ("legs.0.base_frame", {"rpy": [0, 0, 0], "rpy_deg": [0, 0, 0]}, "either rpy (radians) or"),
    ("legs.0.base_frame", {"rpy": [0, 0]}, "base_frame.rpy: value [0, 0]; expected three angles"),
    ("legs.0.base_frame", {"rpz": [0, 0, 0]}, "unknown field 'rpz' (did you mean rpy"),
    # joints
    ("legs.0.joints.0.pitch", 0.1, "expected no pitch: the joint is of kind P, not H"),
    ("legs.0.joints.0.axes", ["x", "y"], "expected no such field: a joint of kind P has one axis"),
    ("legs.0.joints.0.actuated", "yes", "actuated: value 'yes'; expected true or false"),
    ("legs.0.joints.0.actuated", [True, True], "expected 1 values true or false"),
    ("legs.0.joints.0", {"kind": "H", "axis": "z"}, "missing field 'pitch'; expected pitch = the"),
    ("legs.0.joints.0", {"kind": "H", "axis": "z", "pitch": 0}, "the joint is of kind R"),
    ("legs.0.joints.0", {"kind": "U", "axis": "z"}, "a joint of kind U has axes = [...]"),
    ("legs.0.joints.0", {"kind": "U", "axes": ["z"]}, "2 unit vectors, from the base side (1"),
    ("legs.0.joints.0", {"kind": "U", "axes": ["z", "z"]}, "axes perpendicular to the next"),
    ("legs.0.joints.0", {"kind": "U", "axes": ["z", [0, 0.6, 0.8]]}, "axes perpendicular to the"),
    ("legs.0.joints.0", {"kind": "U", "axes": ["z", [0, 1, 1e-5]]}, "axes perpendicular to the"),
    (
        "legs.0.joints.0",
        {"kind": "U", "axes": ["z", "y"], "actuated": True},
        "a list of 2 values true or false, one for each degree of freedom",
    ),
    ("legs.0.joints", [{"kind": "P", "axis": "z"}] * 13, "13 joints; expected 1 to 12 joints"),
    # platform joints
    ("legs.0.platform_joint", "T", "platform_joint.kind: value 'T'; expected one of S, R, U"),
    ("legs.0.platform_joint", "R", "platform_joint: missing field 'axis_link'"),
    (
        "legs.0.platform_joint",
        {"kind": "U", "axis_link": "x"},
        "platform_joint: missing field 'axis_platform'",
    ),
    ("legs.0.platform_joint", "rigid", "platform_joint: missing field 'rotation'"),
    ("legs.0.platform_joint.axis_link", "x", "a platform joint of kind S has no axis"),
    ("legs.0.platform_joint.rotation", [], "only a rigid platform joint has it"),
    # bodies
    ("platform.mass", -1, "platform.mass: value -1; expected zero or a positive number"),
    ("platform.inertia", "big", "platform.inertia: value 'big'; expected a 3x3 tensor"),
    ("platform.inertia", [1, 2], "expected a 3x3 tensor, three principal values"),
    ("platform.inertia", 0.1, "platform.inertia: value 0.1; expected a 3x3 tensor"),
    ("platform.inertia", {"ixx": 1, "ixw": 2}, "unknown field 'ixw' (did you mean ix"),
    ("platform.inertia", [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]], "expected a symmetric tensor"),
    ("platform.inertia", [1, 1, -0.1], "principal moment -0.1 kg m^2; expected a tensor"),
    ("platform.inertia_about", "joint", "expected one of centre_of_mass, origin"),
    # home
    ("home.X", [0, 0, 0.5], "home.X: 3 numbers; expected 7 numbers (x, y, z, qx, qy, qz, qw)"),
    ("home.X", [0, 0, 0.5, 0, 0, 0, 0], "a quaternion (qx, qy, qz, qw) other than zero"),
    ("home.q", [0.5, 0.5], "home.q: 2 numbers; expected 1 numbers: one for each joint"),
    ("home.q", [[0.5], [0.5]], "home.q: 2 lists; expected 1 lists, one for each leg"),
    ("home.q", [[0.5, 0.5]], "home.q[0]: 2 numbers; expected 1 numbers, one for each joint"),
    (
        "home.q",
        [1.5],
        "home: the loops do not close at X: legs[0] has a loop-closure residual of 1 m; expected",
    ),
    # leg types
    ("legs.0.type", "Lift", "legs[0].type: leg type named 'Lift'; expected a lower-case letter"),
    ("leg_types", {"Bad Name": {}}, "leg type named 'Bad Name'; expected a lower-case letter"),
    ("leg_types", 1, "leg_types: value 1; expected a table"),
]

PLANAR: list[tuple[str, Any, str]] = [
    ("gravity", [0, 0, -9.81], "gravity: value [0, 0, -9.81]; expected z = 0"),
    ("legs.0.base_point", [0, 0, 0.1], "expected z = 0: the mechanism moves in the plane"),
    ("legs.0.base_point", [0], "expected a list of two numbers (x, y) (1 given)"),
    ("legs.0.platform_point", [0.1, 0], "in the space 'point' all legs meet at the output"),
    ("platform.centre_of_mass", [0.1, 0], "in the space 'point' the platform is the output point"),
    ("legs.0.base_frame", [[1, 0, 0], [0, -1, 0], [0, 0, -1]], "expected a rotation about z"),
    ("legs.0.platform_joint", "U", "expected R or S: in the plane the legs are pinned"),
    (
        "legs.0.platform_joint",
        {"kind": "R", "axis_link": "x"},
        "expected (0, 0, 1) or nothing: the axis is normal to the plane",
    ),
    ("leg_types.rpr.joints.0.kind", "H", "expected R or P: other joints leave the plane"),
    ("leg_types.rpr.joints.0.axis", "x", "expected (0, 0, 1): revolute axes are normal"),
    ("leg_types.rpr.joints.1.axis", "z", "leg_types.rpr.joints[1].axis: value 'z'; expected a dir"),
    ("leg_types.rpr.joints.0.link.inertia", -0.1, "izz -0.1 kg m^2; expected izz about the"),
    ("leg_types.rpr.joints.0.link.inertia", True, "inertia: value True; expected a number"),
    ("leg_types.rpr.joint", [], "leg_types.rpr: unknown field 'joint' (did you mean joints"),
    ("leg_types.rpr.joints", ABSENT, "leg_types.rpr: missing field 'joints'"),
    ("legs.0.type", "rrr", "expected the name of a leg type: rpr (did you mean rpr?)"),
    ("legs.0.type", ABSENT, "legs[0]: missing field 'joints'; expected joints = a list of joints"),
    ("legs.0.joints", {"2": {}}, "legs[0].joints: unknown joint '2'; expected a joint of the leg"),
    ("legs.0.joints", {"1": {"axs": 1}}, "legs[0].joints.1: unknown field 'axs' (did you mean ax"),
    ("legs.0.joints", {"1": {"axis": 1}}, "legs[0].joints.1.axis: value 1; expected a list of"),
    ("legs.0.joints", {"0": {"link": {"mass": -1}}}, "legs[0].joints.0.link.mass: value -1; expec"),
]


@pytest.mark.parametrize(("path", "value", "message"), SPATIAL)
def test_spatial_fault(path: str, value: Any, message: str) -> None:
    with pytest.raises(SpecError) as caught:
        from_mapping(spoilt(spatial(), path, value), "lift.toml")
    check_message(str(caught.value), "lift.toml", message)


@pytest.mark.parametrize(("path", "value", "message"), PLANAR)
def test_planar_fault(path: str, value: Any, message: str) -> None:
    with pytest.raises(SpecError) as caught:
        from_mapping(spoilt(planar(), path, value), "pair.toml")
    check_message(str(caught.value), "pair.toml", message)


def check_message(message: str, source: str, part: str) -> None:
    assert message.startswith(f"{source}: ")
    assert part in message
    assert message.isprintable()
    assert len(message) < 500


def test_the_errors_parts_are_at_hand() -> None:
    with pytest.raises(SpecError) as caught:
        from_mapping(spoilt(spatial(), "platform.mass", -1), "lift.toml")
    error = caught.value
    assert isinstance(error, ValueError)
    assert (error.source, error.where) == ("lift.toml", "platform.mass")
    assert (error.problem, error.expected) == ("value -1", "zero or a positive number")


def test_spherical_space_needs_its_centre() -> None:
    spec = spoilt(spatial(), "space", "spherical")
    with pytest.raises(SpecError, match="missing field 'fixed_centre'"):
        from_mapping(spec, "lift.toml")


def test_impossible_inertia_is_a_warning_in_space_only() -> None:
    with pytest.warns(SpecWarning, match=r"platform.inertia: principal moments 0.1, 0.1, 0.3"):
        from_mapping(spoilt(spatial(), "platform.inertia", [0.1, 0.1, 0.3]), "lift.toml")
    from_mapping(spoilt(planar(), "platform.inertia", [0.0, 0.0, 0.3]), "pair.toml")


def test_unused_leg_type_is_a_warning() -> None:
    spec = planar()
    spec["leg_types"]["spare"] = spec["leg_types"]["rpr"]
    with pytest.warns(SpecWarning, match=r"leg_types.spare: no leg is of this type"):
        from_mapping(spec, "pair.toml")
