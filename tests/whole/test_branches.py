"""Every branch of the inverse kinematics: legs turned over in the specification's home.

A branch is a sign per leg in the generated text, and nothing else there depends on it.  So the
text is compared for a sample, generated anew with the legs turned; and the values for every entry
of the catalogue, with the signs of the turned legs put into its module.
"""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from pne_sym.mechanics.derive import derive
from pne_sym.model.manipulator import Home, JointKind, Manipulator
from tests.models import catalogue, source, state_at
from tests.oracle.closure import OracleError, close_legs
from tests.oracle.coordinates import extra_indices, joint_slices, pose_size
from tests.oracle.projection import project
from tests.whole.cases import Array, Case, assert_right
from tests.whole.supported import SUPPORTED

ITERATED = ("hexapod_6x6r",)
"""No branches: the closure next to the first guess."""
TURNABLE = [name for name in SUPPORTED if name not in ITERATED]
TRIES = 60
HOME = re.compile(r"^HOME_Q = .*$|^_BRANCHES = \{.*?^\}$", re.MULTILINE | re.DOTALL)


@cache
def turned(name: str) -> Manipulator:
    """A catalogue entry with each leg closed in another way at home, farthest first."""
    spec = catalogue(name)
    rng, q = np.random.default_rng(1), np.array(spec.home.q)
    for number, where in enumerate(joint_slices(spec)):
        others = _other_closures(spec, number, rng)
        if others:
            q[where] = others[number % len(others)]
    return replace(spec, home=Home(spec.home.X, tuple(map(float, q))))


def _other_closures(spec: Manipulator, number: int, rng: np.random.Generator) -> list[Array]:
    """Displacements that close a leg at home, found from many first guesses; not home's own."""
    where, leg = joint_slices(spec)[number], spec.legs[number]
    home, pose = np.array(spec.home.q[where]), np.array(spec.home.X[: pose_size(spec.space)])
    alone = replace(spec, legs=(leg,))
    X = np.concatenate([pose, home[extra_indices(alone)]])
    slides = np.array([joint.kind is not JointKind.REVOLUTE for joint in leg.joints])
    found = [home]
    for _ in range(TRIES):
        guess = rng.uniform(-np.pi, np.pi, home.size)
        guess[slides] = rng.uniform(-2.0, 2.0, home.size)[slides] * (np.abs(home[slides]) + 0.1)
        try:
            q = close_legs(alone, X, guess)
        except OracleError:
            continue
        q[~slides] = np.remainder(q[~slides] + np.pi, 2.0 * np.pi) - np.pi
        if min(np.abs(q - other).max() for other in found) > 1e-6:
            found.append(q)
    return sorted(found[1:], key=lambda q: -float(np.abs(q - home).sum()))


@pytest.mark.parametrize("name", TURNABLE)
def test_turned_legs(name: str) -> None:
    spec = turned(name)
    before, after = (derive(m).parameters.branches for m in (catalogue(name), spec))
    assert before.keys() == after.keys()
    for branch, (leg_type, signs) in after.items():
        assert (leg_type, signs) != before[branch], f"{branch} is not turned"
    model = _with_branches(name, {branch: signs for branch, (_, signs) in after.items()})
    state = state_at(spec, 6)
    assert_right(Case(model, model.Parameters(), spec, state, project(spec, *state), {}))


def _with_branches(name: str, signs: dict[str, tuple[int, ...]]) -> Any:
    model = ModuleType(name)
    exec(source(catalogue(name)), model.__dict__)
    model.__dict__["_BRANCHES"] = {n: np.array(values, dtype=float) for n, values in signs.items()}
    return model


@pytest.mark.parametrize("name", ["fivebar_redundant", "planar_3prr", "stewart", "tripod_3prs"])
def test_branches_are_signs_in_the_text(name: str) -> None:
    spec = turned(name)
    old, new = source(catalogue(name)), source(spec)
    assert HOME.sub("", new) == HOME.sub("", old)
    signs = derive(spec).parameters.branches
    assert signs
    for branch, (_, values) in signs.items():
        listed = ", ".join(str(float(value)) for value in values)
        assert f'"{branch}": np.array([{listed}]),' in new
