"""The home closes the loops to rounding, or is refused with the residual told."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pne_sym import manipulators
from pne_sym.model.assembly import all_closures, distance
from pne_sym.model.closure import leg_residual
from pne_sym.model.errors import SpecError, SpecNote, SpecWarning
from pne_sym.model.kinematics import pose_at, rotation_about
from pne_sym.model.loops import Loops
from pne_sym.model.manipulator import (
    Home,
    JointKind,
    Leg,
    Manipulator,
    PlatformJoint,
    PlatformJointKind,
    Space,
)
from pne_sym.model.reader import checked, from_mapping, to_full_form
from tests.model.examples import planar, spoilt

NAMES = manipulators.names()
CONSTRAINED = ("fivebar_offset", "tripod_3prs", "tripod_3rps", "tripod_3upu")


def form_of(name: str) -> Any:
    return to_full_form(manipulators.load(name))


def closure_residual(m: Manipulator) -> float:
    loops = Loops(m.space, m.legs, m.fixed_centre)
    return max(loops.residuals(np.array(m.home.X), np.array(m.home.q)))


def read_rough(form: Any) -> tuple[Manipulator, str]:
    with pytest.warns(SpecWarning) as caught:
        manipulator = from_mapping(form, "rough.json")
    return manipulator, str(caught[0].message)


@pytest.mark.parametrize("name", NAMES)
def test_catalogue_homes_are_closed(name: str) -> None:
    assert closure_residual(manipulators.load(name)) < 1e-12


@pytest.mark.parametrize("name", NAMES)
def test_a_rounded_home_is_polished_silently(name: str) -> None:
    form = form_of(name)
    form["home"] = {key: [round(x, 7) for x in values] for key, values in form["home"].items()}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        polished = from_mapping(form, "rounded.json")
    assert closure_residual(polished) < 1e-12
    assert from_mapping(to_full_form(polished), "again") == polished


@pytest.mark.parametrize("name", NAMES)
def test_a_rough_guess_is_solved_for(name: str) -> None:
    form = form_of(name)
    rng = np.random.default_rng(7)
    extra = [j["extra"] for leg in form["legs"] for j in leg["joints"]]
    for i, fixed in enumerate(extra):
        form["home"]["q"][i] += 0.0 if fixed else rng.uniform(-0.03, 0.03)
    solved, message = read_rough(form)
    assert "rough.json: home: taken as a rough guess (loop-closure residual 0.0" in message
    assert closure_residual(solved) < 1e-12
    np.testing.assert_allclose(solved.home.q, manipulators.load(name).home.q, atol=1e-9)


@pytest.mark.parametrize("name", CONSTRAINED)
def test_a_pose_off_the_constraints_gives_way(name: str) -> None:
    form = form_of(name)
    form["home"]["X"][0] += 0.01
    form["home"]["X"][-2] += 0.02
    solved, _ = read_rough(form)
    assert closure_residual(solved) < 1e-12
    assert np.abs(np.array(solved.home.X) - form["home"]["X"]).max() < 0.1


def test_a_home_out_of_reach_is_refused() -> None:
    form = form_of("hexapod_6rus")
    form["home"]["X"][2] = 3.0
    with pytest.raises(
        SpecError,
        match=r"home: the loops do not close at X: legs\[\d\] has a loop-closure residual",
    ):
        from_mapping(form, "far.json")


# What these have: slides out, elbows outwards.
USUAL = ("stewart_sps", "hexapod_6ucu", "hexapod_6uhs", "planar_3rrr", "tripod_3rps", "tricept")
MILLI = 1000.0


def read_found(form: Any) -> tuple[Manipulator, str]:
    form["home"].pop("q")
    with pytest.warns(SpecNote) as caught:
        manipulator = from_mapping(form, "found.json")
    return manipulator, str(caught[0].message)


@pytest.mark.parametrize("name", USUAL)
def test_a_home_without_q_is_found(name: str) -> None:
    wanted = manipulators.load(name)
    found, message = read_found(form_of(name))
    assert closure_residual(found) < 1e-12
    np.testing.assert_allclose(found.home.q, wanted.home.q, atol=1e-9)
    assert message.startswith("found.json: home: q found from X: q = [[")
    assert "closures the usual ones (pne-gen home lists all)" in message


@pytest.mark.parametrize(
    "wrong", [{"coupling": [[1.0]]}, {"moving_base": 1}, {"platform": {"mass": -1.0}}]
)
def test_of_a_specification_that_is_refused_nothing_else_is_told(wrong: Any) -> None:
    form = form_of("planar_3rpr")
    form["home"].pop("q")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(SpecError, match=next(iter(wrong))):
            from_mapping(form | wrong, "found.json")


def test_a_home_without_q_in_python() -> None:
    m = manipulators.load("planar_3rpr")
    with pytest.warns(SpecNote, match="q found from X"):
        found = checked(replace(m, home=Home(m.home.X)))
    np.testing.assert_allclose(found.home.q, m.home.q, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "count"), [("planar_3rrr", 2), ("stewart", 4), ("hexapod_6rus", 4), ("delta", 4)]
)
def test_all_closures_of_a_leg(name: str, count: int) -> None:
    """Elbows, crosses and slides have two closures each, which multiply."""
    m = manipulators.load(name)
    loops = Loops(m.space, m.legs, m.fixed_centre)
    X = np.array(m.home.X)
    pose = pose_at(m.space, m.home.X, m.fixed_centre)
    for leg, s, found in zip(m.legs, loops.slices(), all_closures(loops, X), strict=True):
        assert len(found) == count
        assert min(distance(leg, np.array(m.home.q[s]), q) for q in found) < 1e-9
        for k, q in enumerate(found):
            assert np.abs(leg_residual(leg, q, pose)[0]).max() < 1e-12
            assert all(distance(leg, q, other) > 0.01 for other in found[:k])


def test_limits_choose_the_closure() -> None:
    form = form_of("planar_3rrr")
    usual = manipulators.load("planar_3rrr").home.q[1]
    form["legs"][0]["joints"][1]["limits"] = {"displacement": [-0.1 * usual, -2.0 * usual]}
    found, _ = read_found(form)
    assert found.home.q[1] == pytest.approx(-usual)
    assert found.home.q[3] == pytest.approx(usual)


def test_a_home_without_q_moves_a_constrained_platform() -> None:
    form = form_of("tripod_3rps")
    form["home"]["X"][0] += 0.01
    form["home"].pop("q")
    with pytest.warns() as caught:
        found = from_mapping(form, "found.json")
    assert closure_residual(found) < 1e-12
    assert {w.category for w in caught} == {SpecWarning, SpecNote}
    assert "home.X: the legs restrict the platform; closed by a change of" in str(caught[0].message)


def in_other_units(name: str, what: str) -> Any:
    """A specification with some numbers in mm or degrees."""
    form = form_of(name)
    joints = [joint for leg in form["legs"] for joint in leg["joints"]]
    pairs = list(zip(joints, form["home"]["q"], strict=True))
    if what == "angles":
        form["home"]["q"] = [x if j["kind"] == "P" else math.degrees(x) for j, x in pairs]
    if what == "ways":
        form["home"]["q"] = [x * MILLI if j["kind"] == "P" else x for j, x in pairs]
    for leg in form["legs"] if what in {"points", "base_point"} else ():
        leg["base_point"] = [MILLI * x for x in leg["base_point"]]
        if what == "points":
            leg["platform_point"] = [MILLI * x for x in leg["platform_point"]]
    if what == "position":
        form["home"]["X"][:2] = [MILLI * x for x in form["home"]["X"][:2]]
    return form


@pytest.mark.parametrize(
    ("name", "what", "told"),
    [
        ("stewart", "angles", "angles in home.q in degrees"),
        ("stewart", "ways", "ways in home.q in mm"),
        ("stewart", "points", "base_point, platform_point in mm"),
        ("planar_3rrr", "angles", "angles in home.q in degrees"),
        ("planar_3rrr", "base_point", "base_point in mm"),
        ("planar_3rrr", "position", "the position in home.X in mm"),
    ],
)
def test_a_wrong_unit_is_named(name: str, what: str, told: str) -> None:
    with pytest.raises(SpecError) as refused:
        from_mapping(in_other_units(name, what), "mm.json")
    assert f"; with {told} they would close, but units are m and rad" in str(refused.value)


@pytest.mark.parametrize(
    ("what", "told"),
    [("base_point", "base_point in mm"), ("position", "the position in home.X in mm")],
)
def test_a_wrong_unit_is_named_without_q(what: str, told: str) -> None:
    form = in_other_units("planar_3rrr", what)
    form["home"].pop("q")
    with pytest.raises(SpecError, match="home: no displacements close the loops at X") as refused:
        from_mapping(form, "mm.json")
    assert f"; with {told} they would close, but units are m and rad" in str(refused.value)


def test_degrees_in_rpy_are_told() -> None:
    form = form_of("stewart")
    form["legs"][0]["base_frame"] = {"rpy": [0.0, 0.0, 90.0]}
    form["home"].pop("q")
    told = r"legs\[0\].base_frame.rpy: more than a turn; rpy_deg is in degrees"
    with pytest.warns(SpecWarning, match=told), pytest.warns(SpecNote):
        from_mapping(form, "degrees.json")


def test_huge_lengths_are_asked_about() -> None:
    form = in_other_units("stewart", "points")
    form["home"]["X"][2] *= MILLI
    assert "; lengths are in m: is 750 in mm?" in read_found(form)[1]


def axis_turned(axis: Any, towards: Any, angle: float) -> Any:
    """A unit axis turned towards another by an angle."""
    aside = towards - (towards @ axis) * axis
    return math.cos(angle) * axis + math.sin(angle) * aside / np.linalg.norm(aside)


@pytest.mark.parametrize(
    ("kind", "failing"),
    [("U", "are not perpendicular"), ("R", "do not coincide"), ("rigid", "are not turned as")],
)
@pytest.mark.parametrize("angle", [1e-3, 0.3, 1.2])
def test_a_residual_of_axes_is_an_angle(kind: str, failing: str, angle: float) -> None:
    """The points coincide: the condition that fails is named, and told in its unit."""
    m = manipulators.load("hexapod_6ucu" if kind == "U" else "hexapod_6x6r")
    leg, q = m.legs[0], np.array(m.home.q[: len(m.legs[0].joints)])
    pose = pose_at(m.space, m.home.X, None)
    frame = np.array(leg.base_frame)
    for joint, displacement in zip(leg.joints, q, strict=True):
        if joint.kind is not JointKind.PRISMATIC:
            frame = frame @ rotation_about(joint.axis, displacement)
    link_to_platform = frame.T @ pose.R
    given = leg.platform_joint
    if kind == "rigid":
        rotation = link_to_platform @ rotation_about((0.0, 0.0, 1.0), angle)
        joint = replace(given, kind=PlatformJointKind.RIGID, rotation=rotation.tolist())
        joint = replace(joint, axis_link=None, axis_platform=None)
    else:
        towards = link_to_platform.T @ np.array(given.axis_link)
        towards = towards if kind == "U" else np.array([0.36, 0.48, 0.8])
        axis = axis_turned(np.array(given.axis_platform), towards, angle)
        joint = replace(given, axis_platform=tuple(axis.tolist()))
    loops = Loops(m.space, (replace(leg, platform_joint=joint),), None)
    widest = str(loops.widest(np.array(m.home.X), q))
    assert widest.startswith(f"legs[0] has a loop-closure residual of {angle:.3g} rad: ")
    assert failing in widest


def test_a_home_whose_axes_are_not_perpendicular_is_refused_in_radians() -> None:
    form = form_of("hexapod_6ucu")
    leg = form["legs"][2]
    leg["platform_joint"]["axis_platform"] = [0.0, 0.0, 1.0]
    with pytest.raises(SpecError) as refused:
        from_mapping(form, "skew.json")
    assert "legs[2] has a loop-closure residual of " in str(refused.value)
    assert " rad: the axes of its platform joint are not perpendicular" in str(refused.value)


def test_the_quaternion_is_normalised() -> None:
    form = form_of("stewart")
    form["home"]["X"][6] = 2.0
    assert from_mapping(form, "test").home == manipulators.load("stewart").home


def test_revolute_displacements_are_wrapped() -> None:
    spec = planar()
    spec["home"]["q"][0][0] += 4 * math.pi
    spec["legs"][0]["base_frame"] = [[-1, 0], [0, -1]]
    spec["home"]["q"][0][0] += math.pi
    assert from_mapping(spec, "test").home.q[0] == pytest.approx(-0.75 * math.pi, abs=1e-14)


def test_half_a_turn_is_positive() -> None:
    spec = planar()
    h = math.sqrt(0.5)
    spec["legs"][0]["base_frame"] = [[-h, h], [-h, -h]]
    spec["home"]["q"][0][0] = -math.pi
    assert from_mapping(spec, "test").home.q[0] == math.pi


def test_an_extra_coordinate_agrees_with_its_displacement() -> None:
    form = spoilt(form_of("planar_redundant"), "home.X.3", 0.2)
    with pytest.raises(SpecError, match=r"home.X: extra coordinate 0.2; expected the displacement"):
        from_mapping(form, "test")


def legs_to_differentiate() -> dict[str, Leg]:
    """A leg with each kind of platform joint, and one with a screw."""
    quarter_turn = ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    rigid = PlatformJoint(PlatformJointKind.RIGID, rotation=quarter_turn)
    legs = {
        name: manipulators.load(name).legs[0]
        for name in ("hexapod_6uhs", "hexapod_6ucu", "hexapod_6x6r")
    }
    return legs | {"rigid": replace(legs["hexapod_6x6r"], platform_joint=rigid)}


@pytest.mark.parametrize("leg", legs_to_differentiate().values(), ids=legs_to_differentiate())
def test_jacobians_of_the_residual(leg: Leg) -> None:
    """Columns by q and by the platform's twist against central differences."""
    q, h = np.linspace(0.2, 0.9, len(leg.joints)), 1e-6
    X = np.array([0.1, -0.2, 0.6, 0.0, 0.0, 0.0, 1.0])
    pose = pose_at(Space.SPATIAL, X.tolist(), None)
    _, by_q, by_twist = leg_residual(leg, q, pose)
    for j, step in enumerate(np.eye(len(q)) * h):
        plus, minus = leg_residual(leg, q + step, pose)[0], leg_residual(leg, q - step, pose)[0]
        np.testing.assert_allclose((plus - minus) / (2 * h), by_q[:, j], atol=1e-8)
    for k in range(6):
        plus, minus = (_residual_of_moved(leg, q, X, k, s * h) for s in (1, -1))
        np.testing.assert_allclose((plus - minus) / (2 * h), by_twist[:, k], atol=1e-8)


def _residual_of_moved(leg: Leg, q: Any, X: Any, k: int, h: float) -> Any:
    moved = X.copy()
    if k < 3:
        moved[k] += h
    else:
        moved[k] = math.sin(h / 2)
        moved[6] = math.cos(h / 2)
    return leg_residual(leg, q, pose_at(Space.SPATIAL, moved.tolist(), None))[0]
