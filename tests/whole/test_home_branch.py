"""Iterated displacements: the closure reached from q0, on home's assembly branch or none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pne_sym.mechanics.derive import derive
from pne_sym.model.closure import leg_residual
from pne_sym.model.kinematics import TASK_SPACES, base_of, chain_pose, displaced, pose_at
from pne_sym.model.manipulator import Manipulator
from pne_sym.program.evaluate import prepare
from pne_sym.program.iteration import close_loops, on_home_s_branch, residual_and_jacobian
from tests import models
from tests.backends.c_library import NOT_CONVERGED, OK, QUICK, Array, CLibrary
from tests.oracle.coordinates import joint_slices
from tests.sampling import sampled

ROWS = {
    "planar_3rrp_extra": (0, 1),
    "planar_3rrr": (0, 1),
    "point_4rrr_redundant": (0, 1),
    "spatial_2rr_2hr": (),  # fewer unknowns than conditions: no sign tells branches apart
    "spherical_2crp_redundant": (0, 1, 2),
    "spherical_too_few_actuators": (0, 1, 2),
    "translational_pprhu_rr": (0, 1, 2, 3),
    "hexapod_6x6r": (0, 1, 2, 3, 4),
}
ELBOWS = ("planar_3rrr", "point_4rrr_redundant")
"""Two unknown angles a leg: at a pose there are two closures, of opposite signs."""
REACH = {"point_4rrr_redundant": 0.008}
"""How far paths go [m, rad], where it is not 0.15 but less: these legs are near their limits."""
PATH, STATES = 60, 96


def model_of(name: str) -> Manipulator:
    return models.catalogue(name) if name == "hexapod_6x6r" else models.drawn(name)


def path_from_home(name: str, seed: int, reach: float) -> Array:
    """Poses X (PATH, NQ) in even steps along a straight motion, extra joints along with it."""
    spec, rng = model_of(name), np.random.default_rng(seed)
    home, own = np.array(spec.home.X), len(TASK_SPACES[spec.space].pose_names)
    n = len(TASK_SPACES[spec.space].components)
    motion = rng.uniform(-reach, reach, n), rng.uniform(-reach, reach, len(home))
    poses = []
    for share in np.linspace(0.0, 1.0, PATH):
        platform = displaced(spec.space, home[:own], share * motion[0])
        poses.append(np.concatenate((platform, home[own:] + share * motion[1][own:])))
    return np.array(poses)


def followed(name: str, path: Array) -> Array:
    """Displacements (PATH, NJ) along a path, each from the last; closed ones stay at home's."""
    m = models.module(model_of(name))
    q, found = m.HOME_Q, []
    for X in path:
        q = models.closed(m, X, q)
        found.append(q)
    return np.array(found)


def determinants(name: str, X: Array, q: Array) -> float:
    """The smallest determinant of a leg, as a fraction of home's."""
    bundle = models.bundle(model_of(name))
    values, sizes = prepare(bundle.program, bundle.derivation.parameters.values()), []
    for closure in bundle.program.closures:
        at, rows = (np.array([X, bundle.coordinates.home[0]]), [q, bundle.coordinates.home[1]])
        _, jacobian = residual_and_jacobian(bundle.program, closure, values, at, np.array(rows))
        now, home = np.linalg.det(jacobian[:, :, list(closure.rows)])
        sizes.append(float((now / home).min()))
    return min(sizes)


def turns_apart(a: Array, b: Array) -> Array:
    return np.asarray(np.abs(np.remainder(a - b + np.pi, 2.0 * np.pi) - np.pi))


@pytest.mark.parametrize("name", ROWS)
def test_the_sign_of_home(name: str) -> None:
    """That of the Jacobian which the program gives at home, of these rows."""
    bundle = models.bundle(model_of(name))
    values = prepare(bundle.program, bundle.derivation.parameters.values())
    X, q = (np.array([v]) for v in bundle.coordinates.home)
    for closure in bundle.program.closures:
        assert closure.rows == ROWS[name]
        residual, jacobian = residual_and_jacobian(bundle.program, closure, values, X, q)
        assert np.abs(residual).max() < 1e-11
        assert on_home_s_branch(closure, jacobian).all()
        if closure.rows:
            found = np.linalg.det(jacobian[0][:, list(closure.rows)])
            np.testing.assert_array_equal(np.sign(found), closure.signs)
    _, converged = close_loops(bundle.program, values, X, q)
    assert converged.all()


def test_rows_of_a_leg_with_fewer_displacements_than_conditions() -> None:
    """Auxiliary directions leave rows: their determinant vanishes where the model is singular."""
    spec = models.drawn("translational_pprhu_rr")
    for t in derive(spec).leg_types:
        assert len(t.orientation) in ({t.unknowns} if not t.is_closed else {0})


@pytest.mark.parametrize("name", [n for n in ROWS if ROWS[n]])
def test_along_a_path_in_small_steps(name: str) -> None:
    """No jump: displacements move evenly, and end only where a leg becomes singular."""
    lengths = []
    for seed in range(4):
        path = path_from_home(name, seed, REACH.get(name, 0.15))
        q = followed(name, path)
        good = np.isfinite(q).all(axis=1)
        end = int(np.argmin(good)) if not good.all() else PATH
        lengths.append(end)
        if end < PATH:
            assert determinants(name, path[end - 1], q[end - 1]) < 0.4
        turning = list(models.bundle(model_of(name)).coordinates.turning)
        steps = np.diff(q[:end], axis=0)
        steps[:, turning] = turns_apart(q[1:end], q[: end - 1])[:, turning]
        assert np.abs(steps).max(initial=0.0) < 0.2
    assert max(lengths) == PATH


@pytest.mark.parametrize("name", ELBOWS)
def test_hostile_guesses_find_home_s_closure_or_none(name: str) -> None:
    """Where legs have two closures the sign decides: it is the one reached along a path."""
    m = models.module(model_of(name))
    path = path_from_home(name, 1, REACH.get(name, 0.1))
    wanted = followed(name, path)
    assert np.isfinite(wanted).all()
    rng = np.random.default_rng(5)
    at = rng.integers(0, PATH, 4 * STATES)
    q0 = wanted[at] + rng.uniform(-2.5, 2.5, (len(at), m.NJ))
    found = m.inverse_kinematics(path[at], q0=q0)
    some = np.isfinite(found).all(axis=1)
    np.testing.assert_array_equal(np.isnan(found).any(axis=1), np.isnan(found).all(axis=1))
    assert 20 < some.sum() < len(at) - 20
    assert turns_apart(found[some], wanted[at][some]).max() < 1e-9


@pytest.mark.parametrize("name", ELBOWS)
def test_the_other_closure_is_refused(name: str) -> None:
    """A guess next to the closure with one elbow turned over; the loops do close there."""
    spec, m = model_of(name), models.module(model_of(name))
    X, q = np.array(spec.home.X), np.array(spec.home.q)
    pose = pose_at(spec.space, spec.home.X, spec.fixed_centre)
    for leg, where in zip(spec.legs, joint_slices(spec), strict=True):
        unknown = [k for k, joint in enumerate(leg.joints) if not joint.extra]
        other = q.copy()
        other[where] = _elbow_over(leg, q[where], unknown)
        assert np.abs(leg_residual(leg, other[where], pose)[0]).max() < 1e-9
        assert turns_apart(other, q).max() > 0.1
        assert np.isnan(m.inverse_kinematics(X, q0=other)).all()
        assert np.isnan(m.M(X, q0=other)).all()
    np.testing.assert_allclose(m.inverse_kinematics(X, q0=q), q, atol=1e-9)


def _elbow_over(leg, q: Array, unknown: list[int]) -> Array:  # type: ignore[no-untyped-def]
    """The other closure by two angles, found from many guesses."""
    chain = chain_pose(leg, q, base_of(leg))
    rng = np.random.default_rng(0)
    for _ in range(200):
        trial = q.copy()
        trial[unknown] = rng.uniform(-np.pi, np.pi, 2)
        for _ in range(30):
            now = chain_pose(leg, trial, base_of(leg))
            residual = (chain.tip - now.tip)[:2]
            step = np.linalg.lstsq(now.velocities[:2][:, unknown], residual, rcond=None)[0]
            trial[unknown] += step * min(1.0, 0.5 / max(np.abs(step).max(), 1e-9))
        if np.abs(residual).max() < 1e-12 and turns_apart(trial, q).max() > 0.1:
            return trial
    raise AssertionError("no other closure")


@pytest.mark.parametrize("name", sampled(["planar_3rrr", "translational_pprhu_rr"], 2))
@pytest.mark.parametrize("real", ["double", "float"])
def test_c_refuses_the_same(name: str, real: str, tmp_path: Path) -> None:
    """Single and batch, in both precisions: the statuses are those of the NumPy module."""
    spec = model_of(name)
    m, library = models.module(spec), CLibrary(models.bundle(spec), tmp_path, real, flags=QUICK)
    path = path_from_home(name, 1, 0.05)
    rng = np.random.default_rng(7)
    at = rng.integers(0, PATH, STATES)
    q0 = np.array(spec.home.q) + rng.uniform(-2.5, 2.5, (STATES, m.NJ))
    q0[:8] = spec.home.q
    wanted = np.isfinite(m.inverse_kinematics(path[at], q0=q0)).all(axis=1)
    (found,), status = library.batch("inverse_kinematics", path[at], q0)
    assert set(np.unique(status)) == {OK, NOT_CONVERGED}
    assert 8 <= wanted.sum() < STATES
    differ = (status == OK) != wanted
    assert differ.sum() <= (0 if real == "double" else 3)  # Newton's way from afar, in few digits
    np.testing.assert_array_equal(np.isfinite(found).all(axis=1), status == OK)
    for k in range(0, STATES, 7):
        (one,), code = library.single("inverse_kinematics", path[at][k], q0[k])
        assert code == status[k]
        np.testing.assert_array_equal(one, found[k])
