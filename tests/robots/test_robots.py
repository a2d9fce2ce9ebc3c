"""The robots of docs/robots.md: they close, move as it says, and have their published properties.

Most of this is kinematics at home, without a derivation; `make robots` generates them all.
"""

from __future__ import annotations

import re
import warnings
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from pne_sym.cli.listing import architecture
from pne_sym.mechanics.derive import derive
from pne_sym.mechanics.mobility import actuation_quality, mobility, motions_at_home
from pne_sym.model.errors import SpecNote
from pne_sym.model.kinematics import TASK_SPACES, Array
from pne_sym.model.loops import Loops
from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import read_spec
from tests.models import module

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "robots.md").read_text(encoding="utf-8")
ROW = re.compile(
    r"^\| \[(?P<title>[^]]+)\]\((?P<path>\S+)\) \| (?P<legs>\S+) \| (?P<space>\w+) "
    r"\| (?P<dofs>\d) \| (?P<actuators>\d) \| (?P<constraints>\d) \|",
    re.MULTILINE,
)
ROWS = {Path(row["path"]).stem: row for row in ROW.finditer(PAGE)}
ROBOTS = sorted(path.stem for path in (DOCS / "robots").iterdir())
OVERCONSTRAINED = {"exechon": 2}


@cache
def robot(name: str) -> Manipulator:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", SpecNote)
        return read_spec(DOCS / ROWS[name]["path"])


def rates_by_twist(m: Manipulator) -> Array:
    """H^T at home: rates of the actuators per velocity of the platform."""
    motions = motions_at_home(m)
    size = len(TASK_SPACES[m.space].components)
    actuated = [joint.actuated for leg in m.legs for joint in leg.joints]
    return np.asarray(motions[size:][actuated] @ np.linalg.pinv(motions[:size]))


def test_the_page_has_them_all() -> None:
    assert set(ROBOTS) <= set(ROWS)
    assert len(ROWS) >= 20


@pytest.mark.parametrize("name", ROWS)
def test_what_the_page_says(name: str) -> None:
    m, row = robot(name), ROWS[name]
    found = mobility(m)
    assert architecture(m) == row["legs"]
    assert str(m.space) == row["space"]
    assert [found.dofs, found.actuators, found.constraints] == [
        int(row[part]) for part in ("dofs", "actuators", "constraints")
    ]
    assert found.overconstrained == OVERCONSTRAINED.get(name, 0)
    assert (found.unheld, found.singular_legs) == (0, ())
    assert actuation_quality(m) > 0.01


@pytest.mark.parametrize("name", ROBOTS)
def test_home_is_found_and_closed(name: str) -> None:
    m = robot(name)
    loops = Loops(m.space, m.legs, m.fixed_centre)
    assert max(loops.residuals(np.array(m.home.X), np.array(m.home.q))) < 1e-12


@pytest.mark.parametrize("name", ["orthoglide", "tripteron", "agile_eye"])
def test_actuators_move_as_the_platform(name: str) -> None:
    """Orthoglide in its isotropic position, Tripteron, Agile Eye: H = E, so cond(H) = 1."""
    np.testing.assert_allclose(rates_by_twist(robot(name)), np.eye(3), atol=1e-12)


def test_the_slides_of_the_tripteron_are_its_position() -> None:
    m = robot("tripteron")
    np.testing.assert_allclose(m.home.q[::3], m.home.X, atol=1e-12)


def test_cables_can_all_pull() -> None:
    forces = np.linalg.svd(rates_by_twist(robot("cables")).T)[2][6:]
    angles = np.linspace(0.0, 2.0 * np.pi, 361)
    pulls = np.outer(np.cos(angles), forces[0]) + np.outer(np.sin(angles), forces[1])
    assert pulls.min(axis=1).max() > 0.1


def test_rails_choose_the_closure() -> None:
    m = robot("linear_delta")
    assert all(slide > m.home.X[2] for slide in m.home.q[::3])


@pytest.mark.parametrize("name", ["dextar", "orthoglide"])
def test_derived_with_closed_inverse_kinematics(name: str) -> None:
    assert not any(leg_type.reasons for leg_type in derive(robot(name)).leg_types)


# ---- generated: make robots ----------------------------------------------------------------


@pytest.mark.only_in_all
@pytest.mark.parametrize("name", ROBOTS)
def test_generated(name: str) -> None:
    """Regular at home; H is what kinematics at home says; forward dynamics undoes inverse."""
    m = robot(name)
    made = module(m)
    X = np.array(m.home.X)
    V = motions_at_home(m)[: made.NV] @ np.ones(mobility(m).dofs)
    np.testing.assert_allclose(made.H(X).T @ V, rates_by_twist(m) @ V, atol=1e-9)
    tau = np.linspace(1.0, 2.0, made.NU)
    A, *_ = _parts(made.forward_dynamics(X, V, tau))
    found, *reactions = _parts(made.inverse_dynamics(X, V, A))
    B, *_ = _parts(made.forward_dynamics(X, V, found))
    np.testing.assert_allclose(B, A, atol=1e-7)
    if mobility(m).dofs == made.NU:
        np.testing.assert_allclose(found, tau, atol=1e-6)
    assert len(reactions) == (made.NC > 0)


def _parts(result: object) -> tuple[Array, ...]:
    return result if isinstance(result, tuple) else (np.asarray(result),)


@pytest.mark.only_in_all
def test_tripteron_generated() -> None:
    """q of the slides is X and H = E, everywhere."""
    made = module(robot("tripteron"))
    X = np.random.default_rng(1).uniform(0.0, 0.25, (20, 3))
    np.testing.assert_allclose(made.inverse_kinematics(X)[:, ::3], X, atol=1e-14)
    np.testing.assert_allclose(made.H(X), np.broadcast_to(np.eye(3), (20, 3, 3)), atol=1e-14)


@pytest.mark.only_in_all
@pytest.mark.parametrize("name", ["orthoglide", "agile_eye"])
def test_isotropic_generated(name: str) -> None:
    made = module(robot(name))
    np.testing.assert_allclose(made.H(made.HOME_X), np.eye(3), atol=1e-14)
