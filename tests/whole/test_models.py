"""Generated models against the projection and Pinocchio, at random geometry and random states.

The modules are generated from the catalogue's numbers; all else enters through `Parameters`, by
the paths of the manifest.
"""

from __future__ import annotations

import json
from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pne_sym.mechanics.derive import derive
from pne_sym.model.manipulator import Home, PlatformJointKind
from pne_sym.model.reader import from_mapping
from tests.models import catalogue, state_at
from tests.oracle.comparison import relative_error
from tests.oracle.coordinates import extra_indices, joint_slices, platform_rotation
from tests.oracle.pinocchio_model import PinocchioModel
from tests.oracle.projection import moments_at_home
from tests.oracle.specs import State, randomise
from tests.sampling import entries, sampled
from tests.whole.cases import TOLERANCE, Case, answers, assert_right, at, case, own

REFERENCE_TOLERANCE = 1e-11
SEEDS = (1,)
DATA = Path(__file__).parents[1] / "data"
REFERENCES = {
    "dae_3RPS": "tripod_3rps",
    "delta_3RUS_translational": "delta",
    "fivebar_revolute": "fivebar_revolute",
    "hybrid_3PRPS": "hybrid_3prps",
    "kinredundant_RRRRS_2RRRS": "hybrid_3rrrs_redundant",
    "planar_3RPR": "planar_3rpr",
    "screw_6UHS": "hexapod_6uhs",
    "spherical_3UPS": "spherical_3ups",
    "stewart_6SPS_spin": "stewart_sps",
    "stewart_6UPS": "stewart",
    "ucu_6UCU": "hexapod_6ucu",
}
"""Reference file -> entry of the catalogue."""
LEGS_ALL_DIFFER = (
    "fivebar_offset",
    "fivebar_redundant",
    "fivebar_revolute",
    "planar_mixed",
    "sixbar",
)
"""No two legs are of the same structure and on the same branch."""
GENERAL = ("fivebar_offset", "hexapod_6uhs", "planar_mixed", "tripod_3prs")
"""A sample, constrained, mixed, with screws; other structures are in `test_generality`."""
RESTRICTED = ("quadrupod", "tricept", "tripod_3prs", "tripod_3rps", "tripod_3upu")
"""Legs in space that restrict the platform; unit forces come before moments."""


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", entries())
def test_random_geometry_through_live_parameters(name: str, seed: int) -> None:
    assert_right(case(name, seed))


@pytest.mark.parametrize("name", entries())
def test_own_numbers(name: str) -> None:
    spec = catalogue(name)
    assert_right(own(spec, state_at(spec, 4)))


@pytest.mark.parametrize("name", entries())
def test_pinocchio(name: str) -> None:
    """A second, independent engine: the tree of bodies with loop closures."""
    c = case(name, 1)
    s, tree = c.state, PinocchioModel(c.spec)
    theirs = tree.dynamics(*s)
    found = answers(c)
    kinds = {leg.platform_joint.kind for leg in c.spec.legs}
    names = ["qd", "qdd", "tau", "kinetic", "potential"]
    if not c.model.NC or kinds == {PlatformJointKind.SPHERICAL}:
        names += ["M", "Z", "H"]  # else the split between free and constrained is a choice
    for quantity in names:
        assert relative_error(found[quantity], getattr(theirs, quantity)) < TOLERANCE, quantity
    motion = tree.forward_dynamics(s.X, s.q, s.V, found["tau"], s.wrench)
    assert relative_error(found["A"], motion.A) < TOLERANCE
    width = found["reactions"].shape[-1]
    assert relative_error(found["reactions"], motion.reactions[:, :width]) < TOLERANCE


@pytest.mark.parametrize("name", sampled(RESTRICTED, 2))
def test_lambda_is_a_component_of_the_leg_s_force(name: str) -> None:
    """The rest of a leg's force has no part along the unit forces, no moment about the others."""
    c = case(name, 1)
    m, s = c.model, c.state
    _, lam = m.inverse_dynamics(s.X, s.V, s.A, c.p, wrench=s.wrench, **c.guess)
    found = answers(c)["reactions"]
    reactions = np.pad(found, ((0, 0), (0, 6 - found.shape[1])))
    moments, units = moments_at_home(catalogue(name)), m.Hk(s.X, c.p, **c.guess)[: m.NV].T
    first = 0
    for k, leg in enumerate(c.oracle.legs):
        count = len(leg.constraint_wrenches)
        arm = platform_rotation(c.spec, s.X) @ np.array(c.spec.legs[k].platform_point)
        force, moment = np.split(units[first : first + count], [3], axis=1)
        own = np.hstack([force, moment - np.cross(arm, force)])
        rest = reactions[k] - lam[first : first + count] @ own
        along = count - moments[k]
        parts = [*(own[:along, :3] @ rest[:3]), *(own[along:, 3:] @ rest[3:])]
        assert np.abs(parts).max(initial=0.0) < TOLERANCE * np.abs(reactions[k]).max()
        first += count
    assert first == m.NC > 0


@pytest.mark.parametrize("reference", REFERENCES)
def test_reference_states(reference: str) -> None:
    data = json.loads((DATA / f"{reference}.json").read_text())
    spec = catalogue(REFERENCES[reference])
    stored = from_mapping(data["spec"], reference)
    legs = tuple(replace(leg, type="") for leg in spec.legs)
    named = replace(spec, name=stored.name, title=stored.title, symbols=stored.symbols, legs=legs)
    assert stored == named
    for entry in data["states"]:
        state = State(*(np.array(entry[key], dtype=float) for key in State._fields))
        found, ref = answers(own(spec, state)), entry["ref"]
        for key in ("M", "Z", "H", "qd", "qdd", "tau", "kinetic", "potential"):
            assert relative_error(found[key], ref[key]) < REFERENCE_TOLERANCE, key
        reactions = np.array(ref["reaction_on_platform"])
        width = min(reactions.shape[1], found["reactions"].shape[1])
        assert (
            relative_error(found["reactions"][:, :width], reactions[:, :width])
            < REFERENCE_TOLERANCE
        )


def test_every_reference_file_is_used() -> None:
    assert sorted(REFERENCES) == sorted(path.stem for path in DATA.glob("*.json"))


@pytest.mark.parametrize("name", entries(2, without=LEGS_ALL_DIFFER))
def test_legs_in_another_order(name: str) -> None:
    """The data of legs of one type and branch, permuted: everything moves with its leg."""
    c = case(name, 1)
    order = _cycle_among_equals(c)
    assert order != sorted(order)
    slices, extra = joint_slices(c.spec), extra_indices(c.spec)
    flat = np.concatenate([np.arange(len(c.state.q))[slices[k]] for k in order])
    moved = [extra.index(k) for k in flat if k in extra]
    pose, task = len(c.state.X) - len(extra), len(c.state.V) - len(extra)
    places = [*range(pose), *(pose + k for k in moved)]
    rows = [*range(task), *(task + k for k in moved)]
    home = Home(tuple(np.array(c.spec.home.X)[places]), tuple(np.array(c.spec.home.q)[flat]))
    spec = replace(c.spec, legs=tuple(c.spec.legs[k] for k in order), home=home)
    X, q, V, A, wrench = c.state
    permuted = at(name, spec, State(X[places], q[flat], V[rows], A[rows], wrench))
    assert_right(permuted)
    before, after = answers(c), answers(permuted)
    assert relative_error(after["M"], before["M"][np.ix_(rows, rows)]) < 1e-12
    assert relative_error(after["Z"], before["Z"][rows]) < 1e-12
    for quantity in ("kinetic", "potential"):
        assert relative_error(after[quantity], before[quantity]) < 1e-12
    assert relative_error(after["reactions"], before["reactions"][order]) < 1e-9
    assert relative_error(after["q"], before["q"][flat]) < 1e-12


def _cycle_among_equals(c: Case) -> list[int]:
    """Legs in another order: those of equal structure and branch one on in a cycle."""
    derivation, order = derive(c.spec), list(range(len(c.spec.legs)))
    for leg_type in derivation.leg_types:
        table = derivation.parameters.branches.values()
        signs = [values for name, values in table if name == leg_type.name]
        groups = defaultdict(list)
        for row, leg in enumerate(leg_type.indices):
            groups[tuple(values[row] for values in signs)].append(leg)
        for legs in groups.values():
            for here, there in zip(legs, legs[1:] + legs[:1], strict=True):
                order[here] = there
    return order


@pytest.mark.parametrize("name", GENERAL)
def test_general_geometry(name: str) -> None:
    """Tilted axes, filled offsets, massive crosses: other structures, generated anew."""
    spec = randomise(catalogue(name), np.random.default_rng(5), structure_kept=False)
    assert_right(own(spec, state_at(spec, 5)))
