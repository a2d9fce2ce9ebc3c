"""Displacements found by iteration: C agrees with NumPy, and tells what went wrong.

The mechanisms were drawn at random and kept, chosen for their structure.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pne_sym.model.manipulator import Manipulator
from tests import models
from tests.backends.c_agreement import assert_agree, vectors
from tests.backends.c_library import INVALID, NOT_CONVERGED, OK, QUICK, SINGULAR, Array, CLibrary
from tests.sampling import sampled

STATES = 11  # a lane of 8 states, and a remainder
STRUCTURES = {
    # file: legs; (rows, unknowns) of the closure, closed legs too?, constraints, redundant, extras
    "planar_3rrr": ("planar, 3 RRR", (2, 2), False, 0, False, 3),
    "point_4rrr_redundant": ("point, 4 RRR, redundant actuators", (2, 2), False, 0, True, 4),
    "spherical_2crp_redundant": (
        "spherical, 2 CRP, redundant actuators",
        (3, 3),
        False,
        0,
        True,
        2,
    ),
    "translational_pprhu_rr": ("translational, PPRH-U and RR", (4, 4), True, 1, True, 0),
    "spatial_2rr_2hr": (
        "2 RR and 2 HR, fewer unknowns than rows",
        (3, 2),
        True,
        4,
        False,
        0,
    ),
}

CLOSED_QUICKLY = ("planar_3rrr", "point_4rrr_redundant", "spherical_2crp_redundant")


def near_home(manipulator: Manipulator, count: int) -> dict[str, Array]:
    home = manipulator.home
    return vectors(
        models.module(manipulator), np.array(home.X), np.array(home.q), count,
        np.random.default_rng(1),
    )  # fmt: skip


@pytest.mark.parametrize("file", sampled(STRUCTURES, 0, keep=CLOSED_QUICKLY))
def test_agreement(file: str, tmp_path: Path) -> None:
    manipulator = models.drawn(file)
    bundle = models.bundle(manipulator)
    _, shape, mixed, constraints, redundant, extras = STRUCTURES[file]
    c, types = bundle.coordinates, bundle.derivation.leg_types
    iterated = next(t for t in types if not t.is_closed)
    assert (bundle.program.shapes[f"residual_{iterated.name}"][1], iterated.unknowns) == shape
    assert any(t.is_closed for t in types) == mixed
    unknowns = c.sizes["NU"] + c.sizes["NC"]
    is_redundant = unknowns > c.actuation.rank and c.actuation.is_determined
    found = (c.sizes["NC"], is_redundant, len(c.extras))
    assert found == (constraints, redundant, extras)
    library = CLibrary(bundle, tmp_path, flags=QUICK)
    given = near_home(manipulator, STATES)
    assert assert_agree(library, models.module(manipulator), given) >= 12


@pytest.fixture(scope="module")
def planar() -> Manipulator:
    return models.drawn("planar_3rrr")


@pytest.fixture(scope="module")
def library(planar: Manipulator, tmp_path_factory: pytest.TempPathFactory) -> CLibrary:
    return CLibrary(models.bundle(planar), tmp_path_factory.mktemp("c"), flags=QUICK)


def test_home_is_the_default_guess(planar: Manipulator, library: CLibrary) -> None:
    X = near_home(planar, STATES)["X"]
    home = np.tile(planar.home.q, (STATES, 1))
    (default,), status = library.batch("inverse_kinematics", X, None)
    (given,), _ = library.batch("inverse_kinematics", X, home)
    assert (status == OK).all()
    np.testing.assert_array_equal(default, given)
    (single,), code = library.single("inverse_kinematics", X[3], None)
    assert code == OK
    np.testing.assert_array_equal(single, default[3])


def test_far_guesses_find_home_s_closure_or_none(planar: Manipulator, library: CLibrary) -> None:
    module, X = models.module(planar), near_home(planar, 512)["X"]
    q0 = np.random.default_rng(3).uniform(-3.0, 3.0, (512, module.NJ))
    (q,), status = library.batch("inverse_kinematics", X, q0)
    want = module.inverse_kinematics(X, q0=q0)
    np.testing.assert_array_equal(status != OK, np.isnan(want).any(axis=1))
    both = status == OK
    assert both.sum() > 20
    turned = np.remainder(q - want + np.pi, 2.0 * np.pi) - np.pi
    np.testing.assert_allclose(turned[both], 0.0, atol=1e-9)
    assert (np.abs(q[both]) <= np.pi).all()
    (home,), at_home = library.batch("inverse_kinematics", X, None)
    assert (at_home == OK).all()
    turned = np.remainder(q - home + np.pi, 2.0 * np.pi) - np.pi
    np.testing.assert_allclose(turned[both], 0.0, atol=1e-9)  # the branch of home


@pytest.mark.parametrize("name", ["M", "dynamics", "inverse_dynamics", "leg_reactions", "energy"])
def test_failure_of_one_state(planar: Manipulator, library: CLibrary, name: str) -> None:
    given = near_home(planar, STATES)
    api = library.api[name]
    good, _ = library.batch(name, *(given[i.name] for i in api.inputs))
    bad = {key: array.copy() for key, array in given.items()}
    bad["X"][2, :2] = 1e3  # out of reach: no convergence
    bad["q0"][5, 0] = np.nan
    bad["X"][9, 0] = np.inf
    bad["X"][10, :2] = -1e3  # in the remainder
    want = np.full(STATES, OK)
    want[[2, 5, 9, 10]] = NOT_CONVERGED, INVALID, INVALID, NOT_CONVERGED
    found, status = library.batch(name, *(bad[i.name] for i in api.inputs))
    np.testing.assert_array_equal(status, want)
    for array, expected in zip(found, good, strict=True):
        assert np.isnan(array[want != OK]).all()
        np.testing.assert_array_equal(array[want == OK], expected[want == OK])
    for k in (2, 5, 9, 10):
        outputs, code = library.single(name, *(bad[i.name][k] for i in api.inputs))
        assert code == want[k]
        assert all(np.isnan(output).all() for output in outputs)


def test_precisions(planar: Manipulator, library: CLibrary, tmp_path: Path) -> None:
    given = near_home(planar, STATES)
    inputs = [given[name] for name in ("X", "q0", "V", "A", "wrench")]
    (want,), _ = library.batch("inverse_dynamics", *inputs)
    for real, tolerance in (("float", 2e-4), ("long double", 1e-12)):
        other = CLibrary(models.bundle(planar), tmp_path, real, flags=QUICK)
        (found,), status = other.batch("inverse_dynamics", *inputs)
        assert (status == OK).all()
        assert np.abs(found - want).max() < tolerance * np.abs(want).max()


@pytest.mark.parametrize("actuators", [3, 6])
def test_actuators_that_act_on_unactuated_extra_coordinates(actuators: int, tmp_path: Path) -> None:
    """Planar, 3 RRP with the last displacement a coordinate of its own, one or two actuators a leg.

    With two, the actuators hold these coordinates too: every acceleration has forces.
    """
    drawn = models.drawn("planar_3rrp_extra")
    legs = tuple(
        replace(leg, joints=(leg.joints[0], replace(leg.joints[1], actuated=False), leg.joints[2]))
        for leg in drawn.legs
    )
    manipulator = drawn if actuators == 6 else replace(drawn, legs=legs)
    found = models.bundle(manipulator).coordinates.actuation
    assert (found.is_coupled, found.passive, found.rank) == (True, (3, 4, 5), actuators)
    library = CLibrary(models.bundle(manipulator), tmp_path, flags=QUICK)
    given, module = near_home(manipulator, STATES), models.module(manipulator)
    if actuators == 6:
        X, q0, V, A, wrench = (given[name] for name in ("X", "q0", "V", "A", "wrench"))
        (completed,), status = library.batch("complete_acceleration", X, q0, V, A, wrench)
        assert (status == OK).all()
        np.testing.assert_array_equal(completed, A)
        found_A = module.complete_acceleration(X, V, A, wrench=wrench, q0=q0)
        np.testing.assert_array_equal(found_A, A)
    assert assert_agree(library, module, given) >= 12


def test_fewer_actuators_than_freedoms(tmp_path: Path) -> None:
    """No forces give any acceleration; everything else is as with more actuators."""
    manipulator = models.drawn("spherical_too_few_actuators")
    assert not models.bundle(manipulator).coordinates.actuation.is_determined
    library = CLibrary(models.bundle(manipulator), tmp_path, flags=QUICK)
    given, module = near_home(manipulator, STATES), models.module(manipulator)
    for name in ("inverse_dynamics", "leg_reactions"):
        inputs = [given[i.name] for i in library.api[name].inputs]
        (found,), status = library.batch(name, *inputs)
        assert np.isnan(found).all()
        assert (status == SINGULAR).all()
    del library.api["inverse_dynamics"], library.api["leg_reactions"]
    assert assert_agree(library, module, given) >= 10
