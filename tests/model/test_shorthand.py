"""Every shorthand expands to the full form that it stands for."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

from pne_sym.model.errors import SpecWarning
from pne_sym.model.manipulator import IDENTITY3, ZERO3, ZERO33, Joint, JointKind, Manipulator
from pne_sym.model.reader import checked, from_mapping, from_text, to_full_form
from pne_sym.model.rotation import rotation_from_rpy
from tests.model.examples import ABSENT, planar, spatial, spoilt

X, Y, Z = IDENTITY3


def read(spec: dict[str, Any]) -> Manipulator:
    return from_mapping(spec, "test")


def joints_of(*joints: dict[str, Any], q: list[float]) -> tuple[Joint, ...]:
    """The expanded joints of a chain before the lift's own P joint."""
    spec = spatial()
    spec["legs"][0]["joints"] = [*joints, *spec["legs"][0]["joints"]]
    spec["home"]["q"] = [*q, 0.5]
    return read(spec).legs[0].joints[: len(q)]


def test_full_form_round_trips() -> None:
    for spec in (planar(), spatial()):
        manipulator = read(spec)
        form = to_full_form(manipulator)
        assert from_mapping(form, "form") == manipulator
        assert from_text(json.dumps(form), ".json", "form") == manipulator
        assert checked(manipulator) == manipulator
    assert to_full_form(read(spatial())) == spatial()


def test_leg_types_and_planar_embedding() -> None:
    manipulator = read(planar())
    assert manipulator.title == "pair"
    assert manipulator.gravity == (0.0, -9.81, 0.0)
    first, second = manipulator.legs
    assert first.joints == second.joints
    assert first.joints[0].axis == Z
    assert first.joints[0].link.centre_of_mass == (0.1, 0.0, 0.0)
    assert first.joints[1] == Joint(JointKind.PRISMATIC, X, actuated=True)
    assert second.base_point == (2.0, 0.0, 0.0)
    assert second.base_frame == IDENTITY3
    assert second.platform_joint.kind == "R"
    assert second.platform_point == ZERO3


def test_overrides_merge_field_by_field() -> None:
    spec = planar()
    spec["leg_types"]["rpr"]["platform_joint"] = "R"
    spec["legs"][1]["joints"] = {"0": {"actuated": True, "link": {"mass": 3.0}}}
    spec["legs"][1]["platform_joint"] = {"offset": [0.0, 0.0]}
    first, second = read(spec).legs
    assert not first.joints[0].actuated
    assert second.joints[0].actuated
    assert second.joints[0].link.mass == 3.0
    assert second.joints[0].link.centre_of_mass == first.joints[0].link.centre_of_mass
    assert second.joints[1] == first.joints[1]
    assert second.platform_joint == first.platform_joint


def test_a_leg_may_replace_the_joints_of_its_type() -> None:
    spec = planar()
    spec["legs"][1]["joints"] = [{"kind": "R"}, {"kind": "P", "axis": [1.0, 0.0]}]
    first, second = read(spec).legs
    assert not second.joints[1].actuated
    assert second.joints[0].link.mass == 0.0
    assert first.joints[0].link.mass == 1.0


def test_universal_joint() -> None:
    body = {"mass": 2.0, "centre_of_mass": [0.1, 0.0, 0.0]}
    joint = {"kind": "U", "axes": ["z", "-y"], "offset": [0, 0, 0], "link": body}
    first, second = joints_of(joint, q=[0.0, 0.0])
    assert (first.kind, first.axis, first.link.is_massless) == ("R", Z, True)
    assert (second.kind, second.axis, second.link.mass) == ("R", (0.0, -1.0, 0.0), 2.0)
    assert not first.actuated
    assert second.offset == ZERO3


def test_cylindrical_joint() -> None:
    joint = {"kind": "C", "axis": "z", "actuated": [True, False], "extra": [False, True]}
    spec = spatial()
    spec["legs"][0]["joints"] = [joint]
    spec["home"] = {"X": [0, 0, 0.5, 0, 0, 0, 1, 0.5], "q": [0.3, 0.5]}
    first, second = read(spec).legs[0].joints
    assert (first.kind, first.axis, first.actuated, first.extra) == ("R", Z, True, False)
    assert (second.kind, second.axis, second.actuated, second.extra) == ("P", Z, False, True)


def test_spherical_joint() -> None:
    joint = {"kind": "S", "axes": ["x", "y", "z"], "actuated": False}
    assert [j.axis for j in joints_of(joint, q=[0.0, 0.0, 0.0])] == [X, Y, Z]


def test_helical_joint_advances_by_its_pitch() -> None:
    spec = spatial()
    spec["legs"][0]["joints"] = [{"kind": "H", "axis": "z", "pitch": 0.1}]
    spec["home"]["q"] = [5.0]
    (joint,) = read(spec).legs[0].joints
    assert (joint.kind, joint.pitch) == ("H", 0.1)
    assert to_full_form(read(spec))["legs"][0]["joints"][0]["pitch"] == 0.1  # type: ignore[index]


@pytest.mark.parametrize(
    ("inertia", "expected"),
    [
        (ABSENT, ZERO33),
        ([1, 2, 3], ((1, 0, 0), (0, 2, 0), (0, 0, 3))),
        ({"ixx": 2, "iyy": 2, "izz": 3, "ixy": 0.5}, ((2, 0.5, 0), (0.5, 2, 0), (0, 0, 3))),
        ([[2, 0.5, 0], [0.5, 2, 0], [0, 0, 3]], ((2, 0.5, 0), (0.5, 2, 0), (0, 0, 3))),
    ],
)
def test_inertia_forms(inertia: Any, expected: Any) -> None:
    assert read(spoilt(spatial(), "platform.inertia", inertia)).platform.inertia == expected


def test_inertia_about_the_origin_of_the_frame() -> None:
    spec = spoilt(spatial(), "platform.inertia_about", "origin")
    # Steiner: 2 kg at 0.1 m from the origin along z.
    expected = np.diag([0.2 - 0.02, 0.2 - 0.02, 0.3])
    np.testing.assert_allclose(read(spec).platform.inertia, expected, rtol=1e-15)


def test_planar_inertia_as_a_number() -> None:
    spec = spoilt(planar(), "leg_types.rpr.joints.0.link.inertia", 0.25)
    link = read(spec).legs[0].joints[0].link
    assert link.inertia == (ZERO3, ZERO3, (0.0, 0.0, 0.25))


def test_frames_by_angles() -> None:
    spec = spatial(platform_joint="S")
    quarter = read(spoilt(spec, "legs.0.base_frame", {"rpy_deg": [0, 0, 90]}))
    assert quarter.legs[0].base_frame == ((0, -1, 0), (1, 0, 0), (0, 0, 1))


@pytest.mark.parametrize("quarters", range(-3, 8))
def test_quarter_turns_are_exact(quarters: int) -> None:
    found = np.array(rotation_from_rpy((0.0, 0.0, 90.0 * quarters), degrees=True))
    np.testing.assert_array_equal(found, np.rint(_turn(2, 0.5 * math.pi * quarters)))


def test_rpy_is_about_fixed_axes() -> None:
    spec = spatial(base_frame={"rpy": [0.1, -0.2, 0.3]})
    rx, ry, rz = (_turn(k, angle) for k, angle in enumerate([0.1, -0.2, 0.3]))
    frame = rz @ ry @ rx
    spec["legs"][0]["joints"][0]["axis"] = (frame.T @ [0.0, 0.0, 1.0]).tolist()
    np.testing.assert_allclose(read(spec).legs[0].base_frame, frame, atol=1e-15)


def _turn(k: int, angle: float) -> Any:
    i, j = (k + 1) % 3, (k + 2) % 3
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = math.cos(angle)
    matrix[j, i], matrix[i, j] = math.sin(angle), -math.sin(angle)
    return matrix


def test_structure_is_snapped() -> None:
    tilt = 1e-4
    axis = [1e-10, 0.0, 1.0 - 1e-10]
    spec = spoilt(spatial(), "legs.0.joints.0.axis", axis)
    spec["legs"][0]["joints"][0]["offset"] = [1e-10, 0.0, -1e-12]
    joint = read(spec).legs[0].joints[0]
    assert (joint.axis, joint.offset) == (Z, ZERO3)
    # A small tilt is a tilt: its cosine alone would look like 1.
    spec["legs"][0]["joints"][0]["axis"] = [math.sin(tilt), 0.0, math.cos(tilt)]
    with pytest.warns(SpecWarning, match="rough guess"):
        assert read(spoilt(spec, "home.X.0", 4e-5)).legs[0].joints[0].axis[0] == math.sin(tilt)


def test_rounded_axes_and_frames_are_mended() -> None:
    c, s = 0.980067, 0.198669
    spec = spatial(base_frame=[[c, -s, 0], [s, c, 0], [0, 0, 1]])
    spec["legs"][0]["platform_joint"] = {"kind": "U", "axis_link": [c, s, 0], "axis_platform": "z"}
    leg = read(spec).legs[0]
    frame = np.array(leg.base_frame)
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-15)
    assert leg.platform_joint.axis_link is not None
    assert math.hypot(*leg.platform_joint.axis_link) == pytest.approx(1.0, abs=1e-15)


def test_json_null_counts_as_left_out() -> None:
    spec = spoilt(spatial(), "fixed_centre", None)
    assert read(spec).fixed_centre is None


def test_planar_platform_joint_may_state_its_axis() -> None:
    plain = read(planar())
    spec = planar()
    spec["legs"][0]["platform_joint"] = {"kind": "R", "axis_link": "z", "axis_platform": [0, 0, 1]}
    assert read(spec) == plain


def test_planar_frame_two_by_two() -> None:
    spec = planar()
    spec["legs"][0]["base_frame"] = [[0, -1], [1, 0]]
    spec["home"]["q"][0][0] -= math.pi / 2
    assert read(spec).legs[0].base_frame == ((0, -1, 0), (1, 0, 0), (0, 0, 1))


def test_inertia_is_made_symmetric() -> None:
    tensor = [[2.0, 0.5 + 1e-10, 0.0], [0.5, 2.0, 0.0], [0.0, 0.0, 3.0]]
    found = np.array(read(spoilt(spatial(), "platform.inertia", tensor)).platform.inertia)
    np.testing.assert_array_equal(found, found.T)
