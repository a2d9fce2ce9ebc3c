"""The oracles against each other, against stored reference values, and against energy."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pne_sym.model.manipulator import Manipulator, PlatformJointKind, Space
from tests.oracle.closure import OracleError, close_legs, closure_error
from tests.oracle.comparison import relative_error
from tests.oracle.coordinates import displaced, task_size
from tests.oracle.mechanisms import mechanism
from tests.oracle.pinocchio_model import PinocchioModel
from tests.oracle.projection import admissible, project
from tests.oracle.specs import State, from_dict, random_state, randomise
from tests.sampling import sampled

DATA = Path(__file__).parent.parent / "data"
REFERENCES = sorted(path.stem for path in DATA.glob("*.json"))

# Structures that the reference files do not have; see `mechanisms` for the notation.
STRUCTURES: dict[str, tuple[str, list[str]]] = {
    "all platform joints": (
        "spatial",
        [
            "Rz* Ry Px* | S",
            "Hz* Ry Rx | S",
            "Rz Ry Rx* Rt Rz | R",
            "Rz* Py* Rx Ry | U",
            "Px Ry Rz* Rx Ry Rz | rigid",
        ],
    ),
    "tilted slides": ("spatial", ["Px* Py* Pz* | S", "Pt Pt Pt* | S", *["Rz Ht* Ry | S"] * 2]),
    "legs of one and two joints": (
        "spatial",
        ["Rz* | S", "Rz Ry Px* | S", "Rz* Ry Rx | S", "Rz Rx* Py | S"],
    ),
    "constraint moments": ("spatial", ["Rz0 Ry Px* | U"] * 3),
    "constrained, revolute at the platform": (
        "spatial",
        ["Rz* Ry Px Rt | R", "Rz* Ry Px* | S", "Rz Ry* Px* | S"],
    ),
    "constrained, rigid at the platform": ("spatial", ["Rz* Ry* Px* Rz | rigid", "Rz Ry Px* | S"]),
    "constrained with an extra coordinate": (
        "spatial",
        ["Rz Px* Ry*+ | S", "Rz Px* | S", "Rz Ry* Px* | S"],
    ),
    "constrained, more actuators than degrees of freedom": (
        "spatial",
        ["Rz* Px* | S", "Rz Px* | S", "Rz* Px* | S"],
    ),
    "passive extra coordinates": (
        "spatial",
        ["Rz Ry Rx+ Px* | S", "Rz Ry* Rt+ Px | S", *["Rz Ry Px* | S"] * 4],
    ),
    "translational, moments from legs": (
        "translational",
        ["Rz* Ry Px Rx Ry | R", "Rz* Ry Px Rx | U", "Rz Ry* Px | S"],
    ),
    "translational, constrained": (
        "translational",
        ["Rz* Ry | S", "Rz Ry Px* | S", "Rz Ry* Px | S"],
    ),
    "spherical, moments from legs": (
        "spherical",
        ["Rz* Ry Px Rx Ry | R", "Rz Ry Px* | S", "Rz Ry* Px | S"],
    ),
    "spherical, constrained": ("spherical", ["Rz* Ry | S", "Rz Ry Px* | S", "Rz Ry* Px | S"]),
    "planar, rigid at the platform": ("planar", ["Rz* Px Rz | rigid", "Rz Px* | R", "Rz* Rz | S"]),
    "planar, constrained": ("planar", ["Rz* Px | rigid", "Rz Px* | R", "Rz Rz | R"]),
    "planar, actuated extra": ("planar", ["Rz* Rz+* Px | R", "Rz Px* | R", "Rz* Rz | R"]),
    "passive extra coordinate held by a surplus actuator": (
        "spatial",
        ["Rz* Ry* Ry* Ry+ | S", "Rz* Ry* Ry | S", "Rz* Ry* Ry | S"],
    ),
    "planar, two passive extra, one surplus actuator": (
        "planar",
        ["Rz* Rz* Rz+ Rz+ | R", "Rz* Px* | R"],
    ),
    "planar, passive extra": ("planar", ["Rz* Rz+ Px | R", "Rz Px* | R", "Rz* Rz | R"]),
    "point": ("point", ["Rz* Px | R", "Rz Pt* | R", "Rz* Rz | S"]),
    "point, actuated extra": ("point", ["Rz* Px*+ Rz | R", "Rz Pt* | R"]),
}


def reference(name: str) -> dict[str, Any]:
    """A stored reference file."""
    data: dict[str, Any] = json.loads((DATA / f"{name}.json").read_text())
    return data


def state_of(stored: dict[str, Any]) -> State:
    """A stored state."""
    return State(*(np.array(stored[key], dtype=float) for key in State._fields))


def assert_oracles_agree(manipulator: Manipulator, state: State, tolerance: float) -> None:
    """Both oracles, in every quantity that they share, and each in itself."""
    ours = project(manipulator, *state)
    tree = PinocchioModel(manipulator)
    theirs = tree.dynamics(*state)
    motion = tree.forward_dynamics(state.X, state.q, state.V, ours.tau, state.wrench)
    assert ours.closure < 1e-12
    for name in ("qd", "qdd", "tau", "kinetic", "potential"):
        assert relative_error(getattr(ours, name), getattr(theirs, name)) < tolerance, name
    N, c = admissible(ours)
    joints = {leg.platform_joint.kind for leg in manipulator.legs}
    if N.shape[0] == N.shape[1] or joints == {PlatformJointKind.SPHERICAL}:
        # Here the split between free and constrained directions is fixed.
        for name in ("M", "Z", "H"):
            assert relative_error(getattr(ours, name), getattr(theirs, name)) < tolerance, name
    pairs = {
        "M": (N.T @ ours.M @ N, N.T @ theirs.M @ N),
        "Z": (N.T @ (ours.M @ c + ours.Z), N.T @ (theirs.M @ c + theirs.Z)),
        "H": (N.T @ ours.H, N.T @ theirs.H),
        "A": (motion.A, state.A),
        "reactions": (motion.reactions, np.array([leg.reaction for leg in ours.legs])),
        "d'Alembert": (ours.inertia_forces, ours.M @ state.A + ours.Z),
    }
    for name, (left, right) in pairs.items():
        assert relative_error(left, right) < tolerance, name
    scale = np.abs(ours.inertia_forces).max() + np.abs(ours.H).max() * np.abs(ours.tau).max()
    assert np.abs(ours.tau_residual).max() < tolerance * scale


@pytest.mark.parametrize("name", REFERENCES)
@pytest.mark.parametrize("number", [0, 1])
def test_stored_reference_values(name: str, number: int) -> None:
    data = reference(name)
    stored = data["states"][number]
    result = project(from_dict(data["spec"]), *state_of(stored))
    expected = stored["ref"]
    for key in ("M", "Z", "H", "qd", "qdd", "tau", "kinetic", "potential"):
        assert relative_error(getattr(result, key), expected[key]) < 1e-12, key
    reactions = np.array(expected["reaction_on_platform"])
    ours = np.array([leg.reaction for leg in result.legs])
    assert relative_error(ours[:, : reactions.shape[1]], reactions) < 1e-12
    assert np.abs(ours[:, reactions.shape[1] :]).max(initial=0.0) < 1e-12


@pytest.mark.parametrize("name", REFERENCES)
@pytest.mark.parametrize("structure_kept", sampled([True, False], 2))
def test_oracles_agree_at_random_geometry(name: str, structure_kept: bool) -> None:
    rng = np.random.default_rng(7)
    manipulator = randomise(from_dict(reference(name)["spec"]), rng, structure_kept)
    for _ in range(2):
        assert_oracles_agree(manipulator, random_state(manipulator, rng), 1e-9)


@pytest.mark.parametrize("name", sampled(STRUCTURES, 4))
def test_oracles_agree_for_other_structures(name: str) -> None:
    rng = np.random.default_rng(11)
    space, legs = STRUCTURES[name]
    manipulator = mechanism(space, legs, rng)
    assert_oracles_agree(manipulator, random_state(manipulator, rng), 1e-9)
    other = randomise(manipulator, rng)
    assert_oracles_agree(other, random_state(other, rng), 1e-9)


@pytest.mark.parametrize("name", REFERENCES)
def test_random_geometry_keeps_the_structure(name: str) -> None:
    nominal = from_dict(reference(name)["spec"])
    drawn = randomise(nominal, np.random.default_rng(3))
    assert closure_error(drawn, np.array(drawn.home.X), np.array(drawn.home.q)) < 1e-12
    for old_leg, new_leg in zip(nominal.legs, drawn.legs, strict=True):
        assert old_leg.platform_joint.kind is new_leg.platform_joint.kind
        for old, new in zip(old_leg.joints, new_leg.joints, strict=True):
            assert (old.kind, old.actuated, old.extra) == (new.kind, new.actuated, new.extra)
            assert old.link.is_massless == new.link.is_massless
            assert [x == 0.0 for x in old.offset] == [x == 0.0 for x in new.offset]
            if max(map(abs, old.axis)) == 1.0:
                assert old.axis == new.axis


@pytest.mark.parametrize("name", REFERENCES)
def test_random_states_are_admissible(name: str) -> None:
    rng = np.random.default_rng(5)
    manipulator = from_dict(reference(name)["spec"])
    state = random_state(manipulator, rng)
    result = project(manipulator, *state)
    assert np.abs(result.Hk.T @ state.V).max(initial=0.0) < 1e-12
    assert np.abs(result.Hk.T @ state.A + result.constraint_bias).max(initial=0.0) < 1e-11
    assert state.wrench.size == task_size(manipulator.space)


@pytest.mark.parametrize(
    "name", ["stewart_6UPS", "stewart_6SPS_spin", "ucu_6UCU", "screw_6UHS", "planar_3RPR"]
)
def test_power_of_the_inertia_forces_is_the_rate_of_energy(name: str) -> None:
    rng = np.random.default_rng(2)
    manipulator = randomise(from_dict(reference(name)["spec"]), rng)
    state = random_state(manipulator, rng)
    power = state.V @ project(manipulator, *state).inertia_forces
    h = 1e-4
    rate = (_energy_at(manipulator, state, h) - _energy_at(manipulator, state, -h)) / (2.0 * h)
    assert rate == pytest.approx(power, rel=1e-5)


def _energy_at(manipulator: Manipulator, state: State, time: float) -> float:
    """Energy a moment later, on the motion with constant A."""
    X = displaced(manipulator, state.X, time * state.V + 0.5 * time**2 * state.A)
    q = close_legs(manipulator, X, state.q)
    result = project(manipulator, X, q, state.V + time * state.A)
    return result.kinetic + result.potential


def test_reaction_along_constraints_is_lambda() -> None:
    """For an RPS leg, lambda is the reaction along the axis of the revolute joint."""
    data = reference("dae_3RPS")
    manipulator = from_dict(data["spec"])
    result = project(manipulator, *state_of(data["states"][1]))
    for leg, solved, multiplier in zip(manipulator.legs, result.legs, result.lam, strict=True):
        axis = np.array(leg.base_frame) @ np.array(leg.joints[0].axis)
        direction = solved.constraint_wrenches[0, :3]
        assert abs(direction @ axis) == pytest.approx(1.0, abs=1e-12)
        assert direction @ solved.reaction[:3] == pytest.approx(multiplier, rel=1e-10)


def test_two_components_are_embedded_in_the_plane() -> None:
    full = reference("planar_3RPR")["spec"]
    flat = json.loads(json.dumps(full))
    flat["gravity"] = flat["gravity"][:2]
    for leg in flat["legs"]:
        leg["base_point"], leg["platform_point"] = leg["base_point"][:2], leg["platform_point"][:2]
        for joint in leg["joints"]:
            joint["offset"] = joint["offset"][:2]
    assert from_dict(flat) == from_dict(full)


def test_left_out_fields_take_the_defaults() -> None:
    manipulator = from_dict(
        {
            "name": "pair",
            "space": "point",
            "legs": [
                {
                    "joints": [
                        {"kind": "P", "axis": [1, 0], "actuated": True},
                        {"kind": "P", "axis": [0, 1]},
                    ],
                    "platform_joint": {"kind": "R"},
                }
            ],
            "home": {"X": [1, 2], "q": [1, 2]},
        }
    )
    assert manipulator.space is Space.POINT
    assert manipulator.gravity == (0.0, -9.81, 0.0)
    assert manipulator.legs[0].joints[0].link.is_massless


def test_singular_legs_are_refused() -> None:
    manipulator = from_dict(
        {
            "name": "stretched",
            "space": "point",
            "legs": [
                {
                    "joints": [
                        {"kind": "R", "axis": [0, 0, 1]},
                        {"kind": "R", "axis": [0, 0, 1], "offset": [1, 0, 0]},
                    ],
                    "platform_joint": {"kind": "R", "offset": [1, 0, 0]},
                }
            ],
            "home": {"X": [2, 0], "q": [0, 0]},
        }
    )
    with pytest.raises(OracleError, match="leg 0 is singular"):
        project(manipulator, np.array([2.0, 0.0]), np.zeros(2), np.zeros(2))
