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
from pne_sym.model.manipulator import Home, JointKind, Manipulator, PlatformJointKind
from tests.models import catalogue, source, state_at
from tests.oracle.closure import OracleError, close_legs
from tests.oracle.coordinates import extra_indices, joint_slices, pose_size
from tests.oracle.projection import project
from tests.sampling import entries
from tests.whole.cases import Array, Case, assert_right

ITERATED = ("hexapod_6x6r",)
"""No branches: the closure next to the first guess."""
EXTRA = {"hybrid_3rrrs_redundant": -1.0}
"""Entry -> extra coordinate at home where its leg closes on the other branches too."""
TRIES = 40
_SPREAD = {JointKind.REVOLUTE: np.pi, JointKind.PRISMATIC: 1.5, JointKind.HELICAL: 30.0}
HOME = re.compile(r"^HOME_Q = .*$|^_BRANCHES = \{.*?^\}$", re.MULTILINE | re.DOTALL)


@cache
def turned(name: str) -> Manipulator:
    """A catalogue entry with each leg closed in another way at home, farthest first."""
    spec = catalogue(name)
    rng, X, q = np.random.default_rng(1), np.array(spec.home.X), np.array(spec.home.q)
    if name in EXTRA:
        X[-1] = q[extra_indices(spec)] = EXTRA[name]
    spec = replace(spec, home=Home(tuple(map(float, X)), tuple(map(float, q))))
    for number, where in enumerate(joint_slices(spec)):
        if spec.legs[number].platform_joint.kind is PlatformJointKind.RIGID:
            continue  # turned over, it would hold the platform the wrong way round
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
    turns = np.array([joint.kind is JointKind.REVOLUTE for joint in leg.joints])
    spread = [_SPREAD[joint.kind] for joint in leg.joints]
    found = [home]
    for _ in range(TRIES):
        try:
            q = close_legs(alone, X, rng.uniform(-1.0, 1.0, home.size) * spread)
        except OracleError:
            continue
        q[turns] = _wrapped(q[turns])
        gaps = [np.where(turns, _wrapped(q - other), q - other) for other in found]
        if min(np.abs(gap).max() for gap in gaps) > 1e-6:
            found.append(q)
        if len(found) == 2 ** _count_of_branches(spec, number):
            break
    return sorted(found[1:], key=lambda q: -float(np.abs(q - home).sum()))


def _wrapped(angles: Array) -> Array:
    return np.asarray(np.pi - np.remainder(np.pi - angles, 2.0 * np.pi))


@cache
def _count_of_branches(spec: Manipulator, number: int) -> int:
    derivation = derive(spec)
    (name,) = (t.name for t in derivation.leg_types if number in t.indices)
    return sum(leg_type == name for leg_type, _ in derivation.parameters.branches.values())


@pytest.mark.parametrize("name", entries(2, without=ITERATED))
def test_turned_legs(name: str) -> None:
    spec = turned(name)
    before, after = signs_of(catalogue(name)), signs_of(spec)
    assert before.keys() == after.keys()
    fixed = _held_by_a_rigid_end(spec)
    kept = {branch for branch in after if after[branch] == before[branch]}
    assert {branch for branch in kept if not branch.endswith(fixed)} == set()
    model, state = _with_branches(name, after), state_at(spec, 6)
    assert_right(Case(model, model.Parameters(), spec, state, project(spec, *state), {}))


def signs_of(spec: Manipulator) -> dict[str, tuple[int, ...]]:
    """Branch -> its sign in every leg of its type at home."""
    return {branch: signs for branch, (_, signs) in derive(spec).parameters.branches.items()}


def _held_by_a_rigid_end(spec: Manipulator) -> tuple[str, ...]:
    """Ends of the branches' names of legs that the platform's orientation lets close in one way."""
    return tuple(
        f"_{info.name}"
        for info in derive(spec).leg_types
        if spec.legs[info.indices[0]].platform_joint.kind is PlatformJointKind.RIGID
    )


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
    for branch, values in signs_of(spec).items():
        listed = ", ".join(str(float(value)) for value in values)
        assert f'"{branch}": np.array([{listed}]),' in new
