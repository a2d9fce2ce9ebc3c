"""Mobility at home: known values, and a count by the oracle's own loop closure."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

from pne_sym import manipulators
from pne_sym.mechanics.derive import derive
from pne_sym.mechanics.mobility import check_mobility, check_solvable, mobility
from pne_sym.model.errors import SpecError, SpecWarning
from pne_sym.model.manipulator import Leg, Manipulator
from tests.oracle.closure import leg_closure
from tests.oracle.coordinates import joint_slices, twist_basis
from tests.oracle.mechanisms import mechanism
from tests.whole.rewriting import Rewriting, drawn_shifts

# degrees of freedom, actuators, constraints, extra coordinates, passive ones, cases of section 3
KNOWN: dict[str, tuple[int, int, int, int, int, tuple[str, ...]]] = {
    "stewart": (6, 6, 0, 0, 0, ("3.1",)),
    "stewart_sps": (12, 6, 0, 6, 6, ("3.6",)),
    "stewart_7ups": (6, 7, 0, 0, 0, ("3.3",)),
    "stewart_7ups_free": (6, 6, 0, 0, 0, ("3.3",)),
    "hexapod_6ucu": (6, 6, 0, 0, 0, ("3.1",)),
    "hexapod_6x6r": (6, 6, 0, 0, 0, ("3.1",)),
    "hexapod_6rus": (6, 6, 0, 0, 0, ("3.1",)),
    "hexapod_6uhs": (6, 6, 0, 0, 0, ("3.1",)),
    "hexaglide": (6, 6, 0, 0, 0, ("3.1",)),
    "hybrid_3prps": (6, 6, 0, 0, 0, ("3.2",)),
    "hybrid_3crs": (6, 6, 0, 0, 0, ("3.2",)),
    "hybrid_3rrrs": (6, 6, 0, 0, 0, ("3.2",)),
    "hybrid_3rrrs_redundant": (7, 7, 0, 1, 0, ("3.5",)),
    "tripod_3rps": (3, 3, 3, 0, 0, ("3.7",)),
    "tripod_3prs": (3, 3, 3, 0, 0, ("3.7",)),
    "tripod_3upu": (3, 3, 3, 0, 0, ("3.7",)),
    "tricept": (3, 3, 3, 0, 0, ("3.7",)),
    "quadrupod": (3, 4, 3, 0, 0, ("3.3", "3.7")),
    "tripod_3ups": (3, 3, 0, 0, 0, ("3.1",)),
    "spherical_3ups": (3, 3, 0, 0, 0, ("3.1",)),
    "delta": (3, 3, 0, 0, 0, ("3.1",)),
    "planar_3rpr": (3, 3, 0, 0, 0, ("3.1",)),
    "planar_3rrr": (3, 3, 0, 0, 0, ("3.1",)),
    "planar_3prr": (3, 3, 0, 0, 0, ("3.1",)),
    "planar_4rpr": (3, 4, 0, 0, 0, ("3.3",)),
    "planar_4rpr_free": (3, 3, 0, 0, 0, ("3.3",)),
    "planar_mixed": (3, 3, 0, 0, 0, ("3.1",)),
    "planar_redundant": (4, 4, 0, 1, 0, ("3.5",)),
    "sixbar": (3, 3, 0, 0, 0, ("3.2",)),
    "fivebar_revolute": (2, 2, 0, 0, 0, ("3.1",)),
    "fivebar_prismatic": (2, 2, 0, 0, 0, ("3.1",)),
    "fivebar_redundant": (2, 3, 0, 0, 0, ("3.4",)),
    "fivebar_offset": (2, 2, 1, 0, 0, ("3.7",)),
}


def test_every_manipulator_of_the_catalogue_is_known() -> None:
    assert set(manipulators.names()) <= set(KNOWN)


@pytest.mark.parametrize("name", KNOWN)
def test_known_mobility(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", SpecWarning)
        found = check_mobility(manipulators.load(name))
    assert (
        found.dofs,
        found.actuators,
        found.constraints,
        found.extra,
        found.passive,
        found.cases,
    ) == KNOWN[name]
    assert found.singular_legs == ()
    assert found.overconstrained == 0
    assert found.unheld == found.passive


@pytest.mark.parametrize("name", KNOWN)
def test_freedoms_by_the_oracle(name: str) -> None:
    """The oracle's own closure, differentiated by jets, has as many motions."""
    manipulator = manipulators.load(name)
    X, q = np.array(manipulator.home.X), np.array(manipulator.home.q)
    basis = twist_basis(manipulator.space)
    rows = []
    for leg, where in zip(manipulator.legs, joint_slices(manipulator), strict=True):
        found = leg_closure(manipulator, leg, X, q[where])
        row = np.zeros((found.residual.size, basis.shape[1] + q.size))
        row[:, : basis.shape[1]] = found.platform @ basis
        row[:, basis.shape[1] :][:, where] = found.joints
        rows.append(row)
    values = np.linalg.svd(np.vstack(rows), compute_uv=False)
    dofs = basis.shape[1] + q.size - int(np.sum(values > 1e-6 * values[0]))
    assert mobility(manipulator).dofs == dofs


@pytest.mark.parametrize("name", ["tricept", "tripod_3upu", "stewart", "planar_mixed", "delta"])
def test_far_origins_change_nothing(name: str) -> None:
    """Ranks are told by lengths of the mechanism, wherever base and platform origins lie."""
    spec = manipulators.load(name)
    far = drawn_shifts(spec, np.random.default_rng(0), 300.0, seats=False)
    far = replace(far, slides=0.0 * far.slides, first_axis=0.0 * far.first_axis)
    assert mobility(Rewriting(spec, far).after) == mobility(spec)


def without_actuators(manipulator: Manipulator) -> Manipulator:
    legs = tuple(
        replace(leg, joints=tuple(replace(joint, actuated=False) for joint in leg.joints))
        for leg in manipulator.legs
    )
    return replace(manipulator, legs=legs)


def test_fewer_actuators_than_freedoms_are_a_warning() -> None:
    with pytest.warns(SpecWarning, match="fewer actuators than degrees of freedom: 0 for 3"):
        found = check_mobility(without_actuators(manipulators.load("planar_3rpr")))
    assert (found.actuators, found.unheld) == (0, 3)


def test_dependent_actuators_are_a_warning() -> None:
    """Three legs through one point cannot resist a turn about it."""
    manipulator = manipulators.load("planar_3rpr")
    legs = tuple(replace(leg, platform_point=(0.0, 0.0, 0.0)) for leg in manipulator.legs)
    same = replace(manipulator, legs=legs)
    with pytest.warns(SpecWarning, match="all actuators held, the mechanism can move at home"):
        check_mobility(same)


def test_a_stretched_leg_is_singular() -> None:
    manipulator = manipulators.load("fivebar_revolute")
    q = (manipulator.home.q[0], 0.0, *manipulator.home.q[2:])
    stretched = replace(manipulator, home=replace(manipulator.home, q=q))
    assert mobility(stretched).singular_legs == (0,)


def test_one_line_for_people() -> None:
    assert str(mobility(manipulators.load("tripod_3rps"))) == (
        "3 degrees of freedom at home, 3 actuators, 3 constraints, 0 extra coordinates; "
        "section 3 of the paper: constrained: legs that restrict the platform (3.7)"
    )
    assert "6 extra coordinates (6 passive)" in str(mobility(manipulators.load("stewart_sps")))


def test_passive_freedoms_do_not_hide_redundancy() -> None:
    """Four actuated legs for three degrees of freedom of the platform, each with a roller."""
    rollers = mechanism("planar", ["Rz Px* Rz+ | R"] * 4, np.random.default_rng(1))
    found = mobility(rollers)
    assert (found.dofs, found.actuators, found.passive) == (7, 4, 4)
    assert found.cases == ("3.3", "3.6")


def test_what_actuators_determine_is_not_passive() -> None:
    """An actuator at the base moves the middle joint of a leg that has one too many."""
    legs = ["Rz Px* | R", "Rz Px* | R", "Rz Px* | R", "Rz* Rz+ Rz | R"]
    found = mobility(mechanism("planar", legs, np.random.default_rng(1)))
    assert (found.dofs, found.actuators, found.passive, found.unheld) == (4, 4, 1, 0)
    assert found.cases == ("3.5",)


def one_guide() -> Manipulator:
    """A actuated slide that carries a platform without turning: two constraints."""
    return mechanism("translational", ["Px* | S"], np.random.default_rng(0))


def beside(manipulator: Manipulator, leg: Leg) -> Manipulator:
    """The manipulator with one more leg of the same displacements."""
    home = replace(manipulator.home, q=(*manipulator.home.q, *manipulator.home.q))
    return replace(manipulator, legs=(*manipulator.legs, leg), home=home)


def test_two_parallel_guides_are_overconstrained() -> None:
    """The second does nothing that the first does not: who bears the load stays open."""
    guide = one_guide()
    derive(guide)
    both = beside(guide, guide.legs[0])
    with pytest.warns(SpecWarning, match=r"of the 4 constraints .* 2 follow from the others"):
        assert check_mobility(both).overconstrained == 2
    found = derive(both).coordinates
    assert found is not None
    assert found.overconstrained == 2


def test_two_crossed_guides_do_not_move() -> None:
    spec = mechanism("point", ["Px* | R"], np.random.default_rng(0))
    joints = tuple(replace(joint, axis=(0.0, 1.0, 0.0)) for joint in spec.legs[0].joints)
    with pytest.raises(SpecError, match="nothing moves at home"):
        check_solvable(beside(spec, replace(spec.legs[0], joints=joints)))


def test_an_extra_joint_that_a_guided_platform_holds_is_refused() -> None:
    """The platform does not turn, so the leg's second hinge cannot either; unmarked, it is a
    constraint on the leg, and the mechanism has its two degrees of freedom.
    """
    held = mechanism("translational", ["Rz*0 Pz*0 Rt+ Pt* | R"], np.random.default_rng(0))
    with pytest.raises(SpecError, match=r"legs\[0\]: of the joints marked extra, 1 cannot move"):
        derive(held)
    ball = mechanism("translational", ["Rz*0 Pz*0 Rt+ Pt* | S"], np.random.default_rng(0))
    check_solvable(ball)
    assert mobility(ball).dofs == 4
    own = mechanism("translational", ["Rz*0 Pz*0 Rt Pt* | R"], np.random.default_rng(0))
    check_solvable(own)
    assert (mobility(own).dofs, mobility(own).constraints) == (2, 1)


@pytest.mark.parametrize("name", ["delta", "stewart"])
def test_a_mechanism_without_actuators_is_refused(name: str) -> None:
    with pytest.raises(SpecError, match="no joint is actuated; expected actuated = true"):
        derive(without_actuators(manipulators.load(name)))
