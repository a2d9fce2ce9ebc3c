"""The home closes the loops to rounding, or is refused with the gap told."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pne_sym import manipulators
from pne_sym.model.closure import leg_gap
from pne_sym.model.errors import SpecError, SpecWarning
from pne_sym.model.kinematics import pose_at, rotation_about
from pne_sym.model.loops import Loops
from pne_sym.model.manipulator import (
    JointKind,
    Leg,
    Manipulator,
    PlatformJoint,
    PlatformJointKind,
    Space,
)
from pne_sym.model.reader import from_mapping, to_full_form
from tests.model.examples import planar, spoilt

NAMES = manipulators.names()
CONSTRAINED = ("fivebar_offset", "tripod_3prs", "tripod_3rps", "tripod_3upu")


def form_of(name: str) -> Any:
    return to_full_form(manipulators.load(name))


def gap(m: Manipulator) -> float:
    loops = Loops(m.space, m.legs, m.fixed_centre)
    return max(loops.gaps(np.array(m.home.X), np.array(m.home.q)))


def read_rough(form: Any) -> tuple[Manipulator, str]:
    with pytest.warns(SpecWarning) as caught:
        manipulator = from_mapping(form, "rough.json")
    return manipulator, str(caught[0].message)


@pytest.mark.parametrize("name", NAMES)
def test_catalogue_homes_are_closed(name: str) -> None:
    assert gap(manipulators.load(name)) < 1e-12


@pytest.mark.parametrize("name", NAMES)
def test_a_rounded_home_is_polished_silently(name: str) -> None:
    form = form_of(name)
    form["home"] = {key: [round(x, 7) for x in values] for key, values in form["home"].items()}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        polished = from_mapping(form, "rounded.json")
    assert gap(polished) < 1e-12
    assert from_mapping(to_full_form(polished), "again") == polished


@pytest.mark.parametrize("name", NAMES)
def test_a_rough_guess_is_solved_for(name: str) -> None:
    form = form_of(name)
    rng = np.random.default_rng(7)
    extra = [j["extra"] for leg in form["legs"] for j in leg["joints"]]
    for i, fixed in enumerate(extra):
        form["home"]["q"][i] += 0.0 if fixed else rng.uniform(-0.03, 0.03)
    solved, message = read_rough(form)
    assert "rough.json: home: taken as a rough guess (gap 0.0" in message
    assert gap(solved) < 1e-12
    np.testing.assert_allclose(solved.home.q, manipulators.load(name).home.q, atol=1e-9)


@pytest.mark.parametrize("name", CONSTRAINED)
def test_a_pose_off_the_constraints_gives_way(name: str) -> None:
    form = form_of(name)
    form["home"]["X"][0] += 0.01
    form["home"]["X"][-2] += 0.02
    solved, _ = read_rough(form)
    assert gap(solved) < 1e-12
    assert np.abs(np.array(solved.home.X) - form["home"]["X"]).max() < 0.1


def test_a_home_out_of_reach_is_refused() -> None:
    form = form_of("hexapod_6rus")
    form["home"]["X"][2] = 3.0
    with pytest.raises(SpecError, match=r"home: the loops do not close at X: legs\[\d\] has a gap"):
        from_mapping(form, "far.json")


def axis_turned(axis: Any, towards: Any, angle: float) -> Any:
    """A unit axis turned towards another by an angle."""
    aside = towards - (towards @ axis) * axis
    return math.cos(angle) * axis + math.sin(angle) * aside / np.linalg.norm(aside)


@pytest.mark.parametrize(
    ("kind", "failing"),
    [("U", "are not perpendicular"), ("R", "do not coincide"), ("rigid", "are not turned as")],
)
@pytest.mark.parametrize("angle", [1e-3, 0.3, 1.2])
def test_a_gap_between_axes_is_an_angle(kind: str, failing: str, angle: float) -> None:
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
    assert widest.startswith(f"legs[0] has a gap of {angle:.3g} rad: ")
    assert failing in widest


def test_a_home_whose_axes_are_not_perpendicular_is_refused_in_radians() -> None:
    form = form_of("hexapod_6ucu")
    leg = form["legs"][2]
    leg["platform_joint"]["axis_platform"] = [0.0, 0.0, 1.0]
    with pytest.raises(SpecError) as refused:
        from_mapping(form, "skew.json")
    assert "legs[2] has a gap of " in str(refused.value)
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
def test_jacobians_of_the_gap(leg: Leg) -> None:
    """Columns by q and by the platform's twist against central differences."""
    q, h = np.linspace(0.2, 0.9, len(leg.joints)), 1e-6
    X = np.array([0.1, -0.2, 0.6, 0.0, 0.0, 0.0, 1.0])
    pose = pose_at(Space.SPATIAL, X.tolist(), None)
    _, by_q, by_twist = leg_gap(leg, q, pose)
    for j, step in enumerate(np.eye(len(q)) * h):
        plus, minus = leg_gap(leg, q + step, pose)[0], leg_gap(leg, q - step, pose)[0]
        np.testing.assert_allclose((plus - minus) / (2 * h), by_q[:, j], atol=1e-8)
    for k in range(6):
        plus, minus = (_gap_of_moved(leg, q, X, k, s * h) for s in (1, -1))
        np.testing.assert_allclose((plus - minus) / (2 * h), by_twist[:, k], atol=1e-8)


def _gap_of_moved(leg: Leg, q: Any, X: Any, k: int, h: float) -> Any:
    moved = X.copy()
    if k < 3:
        moved[k] += h
    else:
        moved[k] = math.sin(h / 2)
        moved[6] = math.cos(h / 2)
    return leg_gap(leg, q, pose_at(Space.SPATIAL, moved.tolist(), None))[0]
