"""Before anything is written, the model is evaluated at home and around it."""

from __future__ import annotations

import json
import time
import warnings
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import pne_sym
from pne_sym.backends.bundle import Bundle
from pne_sym.derivation.parameters import ParameterTable
from pne_sym.generation import InputError, compile_many
from pne_sym.home_check import STEP, check_home, poses_around_home
from pne_sym.model.errors import SpecError, SpecWarning
from pne_sym.model.full_form import to_full_form
from pne_sym.model.kinematics import pose_at
from pne_sym.model.manipulator import Body, Manipulator
from pne_sym.model.reader import from_text
from pne_sym.program.evaluate import Array
from tests import models
from tests.cli.program import pne_gen
from tests.sampling import entries


def stretched(angle: float) -> Manipulator:
    """Planar 3-RRR with the elbow of leg 2 bent by an angle alone at home, rad."""
    spec = models.catalogue("planar_3rrr")
    leg, crank = spec.legs[1], 0.3
    frame = np.array(leg.base_frame)
    reach = np.zeros(3)
    for length, turned in ((leg.joints[1].offset[0], crank), (0.4, crank + angle)):
        reach += length * frame @ np.array([np.cos(turned), np.sin(turned), 0.0])
    pose = pose_at(spec.space, spec.home.X, None)
    base = pose.t + pose.R @ np.array(leg.platform_point) - reach
    q = (*spec.home.q[:2], crank, angle, *spec.home.q[4:])
    legs = (spec.legs[0], replace(leg, base_point=tuple(base.tolist())), spec.legs[2])
    return replace(spec, legs=legs, home=replace(spec.home, q=q), symbols=())


def short(length: float) -> Manipulator:
    """Planar 3-RPR with leg 2 of this length at home, m."""
    spec = models.catalogue("planar_3rpr")
    leg, q = spec.legs[1], list(spec.home.q)
    turn, slide = (i for i, (k, _) in enumerate(_joints(spec)) if k == 1)
    pose = pose_at(spec.space, spec.home.X, None)
    end = pose.t + pose.R @ np.array(leg.platform_point)
    drawn_in = (end - np.array(leg.base_point)) * (1.0 - length / q[slide])
    base = np.array(leg.base_point) + drawn_in
    assert (turn, leg.joints[1].offset, leg.platform_joint.offset) == (slide - 1, *[(0.0,) * 3] * 2)
    q[slide] = length
    legs = (spec.legs[0], replace(leg, base_point=tuple(base.tolist())), spec.legs[2])
    return replace(spec, legs=legs, home=replace(spec.home, q=tuple(q)), symbols=())


def _joints(spec: Manipulator) -> list[tuple[int, Any]]:
    return [(k, joint) for k, leg in enumerate(spec.legs) for joint in leg.joints]


def warned(bundle: Bundle) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        check_home(bundle)
    assert all(each.category is SpecWarning for each in caught)
    return [str(each.message) for each in caught]


def with_parameters(bundle: Bundle, monkeypatch: pytest.MonkeyPatch, **values: Any) -> None:
    """Let entries of the parameters have other values by default."""
    made = ParameterTable.values

    def changed(table: ParameterTable) -> dict[str, Array]:
        found = made(table)
        assert set(values) <= set(found)
        return found | {n: np.broadcast_to(v, found[n].shape) for n, v in values.items()}

    monkeypatch.setattr(ParameterTable, "values", changed)


@pytest.mark.filterwarnings("ignore:planar_3rpr. legs. all actuators held")
def test_a_leg_that_is_singular_at_home_is_refused(tmp_path: Path) -> None:
    """Its degrees of freedom are independent, its guards fail all the same: NaN before."""
    with pytest.raises(SpecError) as told:
        pne_sym.generate(short(1e-9), tmp_path / "out")
    message = str(told.value)
    assert message.startswith("planar_3rpr: home: inverse_kinematics, joint_rates, M, Z, H, ")
    assert "would be NaN there: legs[1] is singular, by equation rpr-" in message
    assert message.isprintable()
    assert not (tmp_path / "out").exists()


TRICEPT = """
name = "tricept"
space = "spatial"
platform.mass = 4.0
platform.centre_of_mass = [0.0, 0.0, 0.05]
platform.inertia = [0.05, 0.05, 0.08]
home.X = [0.0, 0.0, 0.7, 0.0, 0.0, 0.0, 1.0]
home.q = [{slides}, [0.0, 0.0, 0.7]]

[leg_types.ups]
platform_joint = "S"
joints = [
    {{ kind = "U", axes = ["z", "y"], link = {{ mass = 1.0, inertia = [0.01, 0.02, 0.02] }} }},
    {{ kind = "P", axis = "x", actuated = true, link = {{ mass = 0.5 }} }},
]

[leg_types.up]
platform_joint = {{ kind = "rigid", rotation = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }}
joints = [
    {{ kind = "U", axes = ["x", "y"], link = {{ mass = 1.0, inertia = [0.02, 0.02, 0.01] }} }},
    {{ kind = "P", axis = "z", link = {{ mass = 0.5 }} }},
]
{legs}
[[legs]]
type = "up"
base_point = [0, 0, 0]
platform_point = [0, 0, 0]
"""


def tricept() -> Manipulator:
    """Three UPS legs and a passive central UP leg that begins and ends at the origins."""
    legs, slides = "", []
    for angle in (0.3, 2.4, 4.5):
        away = np.array([np.cos(angle), np.sin(angle), 0.0])
        rod = np.array([0.0, 0.0, 0.7]) - 0.3 * away
        length = float(np.linalg.norm(rod))
        x, y = rod / length, np.array([-away[1], away[0], 0.0])
        frame = np.column_stack([x, y, np.cross(x, y)])
        legs += (
            f'[[legs]]\ntype = "ups"\nbase_point = {(0.4 * away).tolist()}\n'
            f"base_frame = {frame.tolist()}\nplatform_point = {(0.1 * away).tolist()}\n"
        )
        slides.append([0.0, 0.0, length])
    text = TRICEPT.format(legs=legs, slides=str(slides)[1:-1])
    return from_text(text, ".toml", "tricept")


@pytest.mark.only_in_all
def test_a_central_leg_at_both_origins() -> None:
    """Never a model that is NaN at home: it is refused, or finite there."""
    try:
        files = pne_sym.compile_model(tricept())
    except SpecError as told:
        assert str(told).startswith("tricept: home: ")  # noqa: PT017
        return
    made = ModuleType("tricept")
    exec(files["tricept.py"], made.__dict__)
    for array in made.dynamics(made.HOME_X, np.zeros(made.NV)):
        assert np.isfinite(array).all()
    assert np.isfinite(made.inverse_kinematics(made.HOME_X)).all()


def test_on_the_command_line(tmp_path: Path) -> None:
    form = to_full_form(short(1e-9))
    (tmp_path / "short.json").write_text(json.dumps(form))
    done = pne_gen("short.json", "--out", "out", cwd=tmp_path, real=True)
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert line.startswith("pne-gen: error: planar_3rpr: home: inverse_kinematics, ")
    assert not (tmp_path / "out").exists()


def test_refused_from_worker_processes_too() -> None:
    good = replace(models.catalogue("fivebar_prismatic"), name="good")
    with pytest.raises(InputError, match=r"planar_3rpr: home: .*legs\[1\] is singular"):
        list(compile_many([good, short(1e-9)], jobs=2))


def test_a_home_at_the_edge_of_reach_is_a_warning() -> None:
    (message,) = warned(models.bundle(stretched(1e-3)))
    assert message.startswith("planar_3rrr: home: inverse_kinematics, joint_rates, M, Z, H, ")
    assert f" of 6 poses around it, {STEP:g} rad or 1% of the size away: " in message
    assert "legs[1] does not reach the platform, by equation rrr-" in message


def test_ordinary_homes_are_no_matter() -> None:
    assert warned(models.bundle(stretched(0.3))) == []
    assert warned(models.bundle(short(0.3))) == []


@pytest.mark.parametrize("name", entries())
def test_the_catalogue_has_no_faults(name: str) -> None:
    assert warned(models.bundle(models.catalogue(name))) == []


def test_values_that_no_guard_holds_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """A value of the preparation that is not finite is named with its leg and equation."""
    bundle = models.bundle(models.catalogue("stewart"))
    masses = np.ones(6)
    masses[4] = np.inf
    with_parameters(bundle, monkeypatch, ups_link3_mass=masses)
    with pytest.raises(SpecError, match=r"M, Z, H, .* would be NaN there: .*is not finite"):
        check_home(bundle)


def test_no_size(monkeypatch: pytest.MonkeyPatch) -> None:
    """Everything at one point: no leg has a direction."""
    bundle = models.bundle(models.catalogue("planar_3rpr"))
    home = bundle.manipulator.home.X
    nothing = {n: 0.0 for n in bundle.derivation.parameters.entries if "_point_" in n}
    with_parameters(bundle, monkeypatch, **nothing)
    centred = replace(bundle.coordinates, home=((0.0, 0.0, home[2]), bundle.coordinates.home[1]))
    derivation = replace(bundle.derivation, coordinates=centred)
    with pytest.raises(SpecError, match=r"inverse_kinematics.*: legs\[0\] is singular"):
        check_home(replace(bundle, derivation=derivation))


def test_iteration_that_does_not_converge(monkeypatch: pytest.MonkeyPatch) -> None:
    bundle = models.bundle(models.drawn("planar_3rrr"))
    with_parameters(bundle, monkeypatch, **{
        n: 30.0 for n in bundle.derivation.parameters.entries if n.endswith("base_point_x")
    })  # fmt: skip
    with pytest.raises(SpecError, match=r"inverse_kinematics .*Newton's iteration"):
        check_home(bundle)


def test_too_few_actuators_are_named_once() -> None:
    (message,) = warned(models.bundle(models.drawn("spherical_too_few_actuators")))
    assert message == (
        "spherical_too_few_actuators: inverse_dynamics, leg_reactions: NaN at every state: fewer "
        "actuators than degrees of freedom, so that no forces give any acceleration"
    )


def test_singular_actuators_are_told_with_the_reason() -> None:
    """Two legs actuated along one line, the third not at all."""
    spec = models.catalogue("planar_4rpr")
    actuated = (True, True, False, True)
    legs = tuple(
        replace(leg, joints=tuple(replace(j, actuated=j.actuated and on) for j in leg.joints))
        for leg, on in zip(spec.legs, actuated, strict=True)
    )
    legs = (legs[0], replace(legs[0]), *legs[2:])  # leg 2 is leg 1 again
    twice = (*spec.home.q[:2], *spec.home.q[:2], *spec.home.q[4:])
    spec = replace(spec, legs=legs, home=replace(spec.home, q=twice), symbols=())
    (message,) = warned(models.bundle(spec))
    assert message == (
        "planar_4rpr: home: inverse_dynamics, leg_reactions NaN there: H is singular"
    )


def test_a_motion_without_inertia_is_told() -> None:
    spec = models.catalogue("fivebar_prismatic")
    bare = tuple(
        replace(leg, joints=tuple(replace(j, link=Body()) for j in leg.joints)) for leg in spec.legs
    )
    spec = replace(spec, legs=bare, platform=Body(), symbols=())
    (message,) = warned(models.bundle(spec))
    assert message == (
        "fivebar_prismatic: home: forward_dynamics NaN there: M is singular: a motion without "
        "inertia"
    )


@pytest.mark.parametrize("name", ["stewart", "tripod_3rps", "hybrid_3rrrs", "spherical_3ups"])
def test_poses_around_home(name: str) -> None:
    """Two for every degree of freedom or coordinate, near home, with the constraints kept."""
    spec = models.catalogue(name)
    m, home = models.module(spec), np.array(spec.home.X)
    poses = np.array(poses_around_home(spec))
    assert len(poses) >= 2 * (m.NV - m.NC)
    moved = np.abs(poses - home).max(axis=1)
    assert (moved > 1e-4).all()
    assert (moved < 0.03).all()
    if m.NC:
        assert np.abs(m.constraints(poses)).max() < 10 * STEP**2


def test_it_takes_no_time() -> None:
    """0.2 s for Stewart, measured in processor time so that other processes do not matter."""
    bundle = models.bundle(models.catalogue("stewart"))
    times = []
    for _ in range(3):
        start = time.process_time()
        check_home(bundle)
        times.append(time.process_time() - start)
    assert min(times) < 0.2
