"""Constraints that follow from others: cranks in parallel, a Tripteron; motion is determined."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pne_sym.mechanics.derive import derive
from pne_sym.mechanics.mobility import check_mobility
from pne_sym.model.errors import SpecError, SpecWarning
from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import from_mapping
from tests.backends.c_agreement import assert_agree, vectors
from tests.backends.c_library import CLibrary
from tests.models import bundle, module
from tests.oracle.specs import State
from tests.whole.cases import assert_right, own

ANGLE, LENGTH = 1.1, 0.5


def cranks(count: int = 3, last: float = LENGTH) -> Manipulator:
    """A platform on parallel cranks, the third without weight; `last`: its length."""
    legs: list[Any] = []
    tip = np.array([np.cos(ANGLE), np.sin(ANGLE)])
    for k, x in enumerate((0.0, 0.4, 1.0)[:count]):
        length = last if k == 2 else LENGTH
        link = {"mass": 1.2, "centre_of_mass": [0.2, 0.01, 0], "inertia": [0, 0, 0.03]}
        joint = {"kind": "R", "axis": "z", "actuated": k == 0, "link": link}
        if k == 2:
            del joint["link"]
        seat = np.array([x - 0.3, 0.1]) + (length - LENGTH) * tip
        legs.append({
            "base_point": [x, 0, 0], "joints": [joint], "platform_point": [*seat, 0.0],
            "platform_joint": {"kind": "R", "offset": [length, 0, 0]},
        })  # fmt: skip
    body = {"mass": 3.0, "centre_of_mass": [0.1, 0.05, 0], "inertia": [0, 0, 0.2]}
    X = [0.3 + LENGTH * tip[0], LENGTH * tip[1] - 0.1, 0.0]
    form = {
        "name": "cranks", "space": "planar", "platform": body, "legs": legs,
        "home": {"X": X, "q": [ANGLE] * count},
    }  # fmt: skip
    return from_mapping(form, "cranks")


def motion() -> tuple[Any, Any, Any]:
    """Pose, velocity and acceleration on the circle of the cranks."""
    across, along = (
        np.array([-np.sin(ANGLE), np.cos(ANGLE), 0]),
        np.array([np.cos(ANGLE), np.sin(ANGLE), 0]),
    )
    X = np.array(cranks().home.X)
    return X, 0.7 * LENGTH * across, -1.3 * LENGTH * across - 0.7**2 * LENGTH * along


def test_forces_are_those_of_the_relaxed_mechanism() -> None:
    m, two = module(cranks()), module(cranks(2))
    assert (m.NC, m.OVERCONSTRAINED, two.NC, two.OVERCONSTRAINED) == (3, 1, 2, 0)
    X, V, A = motion()
    (tau, lam), (wanted, _) = m.inverse_dynamics(X, V, A), two.inverse_dynamics(X, V, A)
    np.testing.assert_allclose(tau, wanted, rtol=1e-13)
    Hk = m.Hk(X)
    np.testing.assert_allclose(Hk @ lam, m.M(X) @ A + m.Z(X, V) - m.H(X) @ tau, atol=1e-12)
    np.testing.assert_allclose(lam, np.linalg.pinv(Hk) @ (Hk @ lam), rtol=1e-12)
    found, again = m.forward_dynamics(X, V, tau)
    np.testing.assert_allclose(found, A, atol=1e-12)
    np.testing.assert_allclose(again, lam, atol=1e-12)
    assert_right(own(cranks(), State(X, np.full(3, ANGLE), V, A, np.array([1.0, -2.0, 0.5]))))


def test_poses_are_found() -> None:
    m = module(cranks())
    X = np.array(m.HOME_X)
    projected = m.project(X + np.array([0.02, -0.01, 0.03]))
    assert np.abs(m.constraints(projected)).max() < 1e-9
    moved = m.forward_kinematics([ANGLE + 0.1], X)
    np.testing.assert_allclose(m.inverse_kinematics(moved), ANGLE + 0.1, atol=1e-9)


def test_what_moves_at_home_only_is_refused() -> None:
    with pytest.raises(SpecError, match=r"of the 3 constraints .* 1 follow .* at home only"):
        derive(cranks(last=0.4))


def test_the_same_in_c(tmp_path: Path) -> None:
    spec = cranks()
    m, library = module(spec), CLibrary(bundle(spec), tmp_path, flags=("-O0",))
    X, q = np.array([m.HOME_X]), np.array([m.HOME_Q])
    given = vectors(m, X, q, 9, np.random.default_rng(0))
    closed = np.array(
        [m.forward_kinematics([ANGLE + turn], m.HOME_X) for turn in np.linspace(-0.2, 0.2, 9)]
    )
    assert_agree(library, m, given | {"X": closed, "X0": closed})


def tripteron() -> Manipulator:
    """Three PRRR legs along x, y, z, whose revolute axes are parallel to their slides."""
    legs, q = [], []
    bend, lengths = (0.6, 1.2), (0.5, 0.6)
    for k in range(3):
        frame = np.roll(np.eye(3), k, axis=0)
        angles = (*bend, -sum(bend))
        arm = lengths[0] * np.array([np.cos(bend[0]), np.sin(bend[0]), 0.0])
        arm += lengths[1] * np.array([np.cos(sum(bend)), np.sin(sum(bend)), 0.0])
        joints: list[Any] = [{"kind": "P", "axis": "z", "actuated": True, "link": {"mass": 1.0}}]
        for j in range(3):
            offset = [lengths[j - 1] if j else 0.0, 0, 0]
            joints.append({"kind": "R", "axis": "z", "offset": offset})
        seat = 0.1 * frame[:, 0]
        base = seat - frame @ (arm + np.array([0.0, 0.0, 0.3]))
        legs.append({
            "base_point": base.tolist(), "base_frame": frame.tolist(), "joints": joints,
            "platform_point": seat.tolist(),
            "platform_joint": {"kind": "rigid", "rotation": frame.T.tolist()},
        })  # fmt: skip
        q += [0.3, *angles]
    form = {
        "name": "tripteron", "space": "spatial", "legs": legs,
        "platform": {"mass": 2.0, "inertia": [0.1, 0.1, 0.1]},
        "home": {"X": [0, 0, 0, 0, 0, 0, 1], "q": q},
    }  # fmt: skip
    return from_mapping(form, "tripteron")


def test_tripteron_in_space() -> None:
    """Each slide follows a coordinate of the platform, and bears what acts along it."""
    with pytest.warns(SpecWarning, match=r"of the 6 constraints .* 3 follow from the others"):
        check_mobility(tripteron())
    m = module(tripteron())
    assert (m.NC, m.OVERCONSTRAINED) == (6, 3)
    X = np.array([0.05, -0.03, 0.04, 0, 0, 0, 1])
    V, A = np.zeros((2, 6))
    V[:3], A[:3] = (0.3, 0.1, -0.2), (1.0, -2.0, 0.5)
    np.testing.assert_allclose(m.actuator_positions(X), X[[2, 0, 1]] + 0.3, atol=1e-12)
    tau, _ = m.inverse_dynamics(X, V, A)
    felt = A[:3] + np.array([0.0, 0.0, 9.81])
    np.testing.assert_allclose(tau, 3.0 * felt[[2, 0, 1]], rtol=1e-12)
    found, _ = m.forward_dynamics(X, V, tau)
    np.testing.assert_allclose(found, A, atol=1e-10)
