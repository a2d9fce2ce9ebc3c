"""Which values of parameters the reader, the NumPy module and the C module accept: the same."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pne_sym.derivation import Rule
from pne_sym.model.body import read_body
from pne_sym.model.coupling import read_coupling
from pne_sym.model.effects import Actuator, Friction
from pne_sym.model.entry import Entry
from pne_sym.model.errors import SpecError, SpecWarning
from pne_sym.model.manipulator import Manipulator
from pne_sym.model.read_effects import read_actuator, read_friction
from pne_sym.model.values import axis, not_negative, number, rotation, vector
from tests import models
from tests.backends.c_library import INVALID, OK, QUICK, Array, CLibrary
from tests.sampling import sampled

RUBBING = "planar_3rpr_rubbing"
PLACES: dict[Rule, tuple[str, str]] = {
    Rule.FREE: ("tripod_3upu", "gravity"),
    Rule.MASS: ("tripod_3upu", "upu_link2_mass"),
    Rule.INERTIA: ("tripod_3upu", "upu_link2_inertia"),
    Rule.PLANAR_INERTIA: ("planar_3rrr", "platform_inertia"),
    Rule.ROTATION: ("tripod_3upu", "upu_base_frame"),
    Rule.PLANAR_ROTATION: ("planar_3rrr", "rrr_base_frame"),
    Rule.UNIT: ("tripod_3upu", "upu_platform_joint_axis_platform"),
    Rule.POSITIVE: (RUBBING, "rpr_joint1_velocity_scale"),
    Rule.NONZERO: (RUBBING, "rpr_joint2_gear_ratio"),
    Rule.INVERTIBLE: (RUBBING, "coupling"),
}
"""A parameter of every kind."""


def manipulator_of(name: str) -> Manipulator:
    """An entry of the catalogue; one of them has friction and coupled motors besides."""
    if name != RUBBING:
        return models.catalogue(name)
    found = models.catalogue("planar_3rpr")
    legs = []
    for leg in found.legs:
        turn, slide = leg.joints
        turn = replace(turn, friction=Friction(1.0, 2.0, 0.1))
        slide = replace(slide, actuator=Actuator(1e-4, 40.0))
        legs.append(replace(leg, joints=(turn, slide)))
    rows = ((1.0, 0.5, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    return replace(found, name=RUBBING, legs=tuple(legs), coupling=rows)


def read(rule: Rule, value: Array) -> bool:
    """Whether the reader takes the value."""
    entry, planar = Entry("spec", "value", np.asarray(value).tolist()), "planar" in rule
    try:
        match rule:
            case Rule.FREE:
                vector(entry)
            case Rule.MASS:
                not_negative(entry)
            case Rule.INERTIA | Rule.PLANAR_INERTIA:
                body = {"mass": 1.0, "inertia": entry.value}
                read_body(Entry("spec", "body", body), plane=planar)
            case Rule.ROTATION | Rule.PLANAR_ROTATION:
                rotation(entry, plane=planar)
            case Rule.UNIT:
                axis(entry)
            case Rule.POSITIVE:
                read_friction(Entry("spec", "", {"coulomb": 1.0, "velocity_scale": entry.value}))
            case Rule.NONZERO:
                read_actuator(Entry("spec", "", {"rotor_inertia": 0.0, "gear_ratio": entry.value}))
            case Rule.INVERTIBLE:
                read_coupling(entry, manipulator_of(RUBBING).legs)
    except SpecError:
        return False
    return True


def drawn(rng: np.random.Generator) -> Array:
    """A random rotation."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return np.asarray(q * np.linalg.det(q))


def moments(*values: float, rng: np.random.Generator | None = None) -> Array:
    """A tensor of these principal moments, in random axes."""
    R = drawn(rng) if rng else np.eye(3)
    tensor = R @ np.diag(values) @ R.T
    return np.asarray((tensor + tensor.T) / 2)


def changed(value: Array, place: tuple[int, ...], by: float) -> Array:
    """The value with an entry changed."""
    value = np.array(value, dtype=float)
    value[place] += by
    return value


def turned(angle: float) -> Array:
    """A rotation about z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


E, Z = np.eye(3), np.zeros((3, 3))
FLIP = np.diag([1.0, -1.0, -1.0])
CASES: dict[Rule, list[tuple[Any, bool]]] = {
    Rule.FREE: [
        (np.zeros(3), True), (np.full(3, -0.999e12), True), (np.full(3, 1.001e12), False),
    ],
    Rule.MASS: [
        (0.0, True), (-0.0, True), (1e-30, True), (-1e-30, False), (0.999e12, True),
        (1.001e12, False), (-5.0, False),
    ],
    Rule.INERTIA: [
        (Z, True), (E, True), (-E, False), (-5.0 * E, False), (1e-30 * E, True),
        (-1e-30 * E, False), (1e-30 * moments(1, 1, -1e-4), False), (1e11 * E, True),
        (moments(0, 1, 1), True), (moments(0, 0, 3), True), (np.ones((3, 3)), True),
        (np.ones((3, 3)) - E, False), (changed(E, (0, 1), 1e-3), False),
        (changed(E, (2, 0), -1e-3), False), (changed(Z, (1, 2), 1e-3), False),
        (changed(E, (0, 0), 4.0), True), (changed(E, (2, 2), -1.1), False),
        (moments(1, 1, -1e-4), False), (moments(-1e-4, 1e-3, 1), False),
    ],
    Rule.PLANAR_INERTIA: [
        (Z, True), (-E, False), (np.diag([-3.0, -2.0, 0.0]), True), (changed(Z, (0, 1), 7.0), True),
        (changed(E, (2, 2), -1.001), False), (changed(Z, (2, 2), -1e-30), False),
    ],
    Rule.ROTATION: [
        (E, True), (FLIP, True), (-E, False), (Z, False), (2.0 * E, False),
        (np.diag([1.0, 1.0, -1.0]), False), (turned(0.7), True), (changed(E, (0, 1), 1e-3), False),
        (changed(E, (0, 0), -1e-3), False), (E[[1, 2, 0]], True), (E[[1, 0, 2]], False),
    ],
    Rule.PLANAR_ROTATION: [
        (E, True), (FLIP, False), (turned(-3.0), True), (E[[1, 2, 0]], False), (2.0 * E, False),
        (changed(E, (2, 2), 1e-4), False), (changed(turned(0.3), (0, 0), 1e-3), False),
    ],
    Rule.UNIT: [
        ((0.6, 0.0, 0.8), True), ((1.0, 0.0, 0.0), True), ((0.6, 0.0, 0.9), False),
        ((0.0, 0.0, 0.0), False), ((0.6001, 0.0, 0.8), False), ((1e11, 0.0, 0.0), False),
    ],
    Rule.POSITIVE: [
        (1.0, True), (0.0, False), (-1.0, False), (1.1e-9, True), (0.9e-9, False), (1e-30, False),
        (0.999e12, True), (1.001e12, False),
    ],
    Rule.NONZERO: [
        (1.0, True), (0.0, False), (-60.0, True), (1.1e-9, True), (-1.1e-9, True), (-0.9e-9, False),
        (1e-30, False), (-0.999e12, True), (1.001e12, False),
    ],
    Rule.INVERTIBLE: [
        (E, True), (FLIP[[1, 2, 0]], True), (Z, False), (np.ones((3, 3)), False),
        (np.arange(9.0).reshape(3, 3), False), (1e-30 * E, True), (E * (1e-9, 1.0, 1e9), True),
        (E * [[1e-9], [1.0], [1e9]], True), (changed(E, (1, 1), -1.0), False),
        (changed(E, (0, 2), 0.999e12), False), (changed(E, (0, 2), 1.001e12), False),
        (changed(np.ones((3, 3)), (0, 0), 1.0), False),
        (E + np.ones((3, 3)), True), (1.0 - 2.0 * E, True),
    ],
}  # fmt: skip
"""Values of every kind, and whether they are good; far enough from the limits for floats."""
NOT_NUMBERS = (np.nan, np.inf, -np.inf)


def near(rule: Rule, rng: np.random.Generator) -> Iterator[tuple[Array, bool]]:
    """Values on either side of a limit, by a part of ten thousand of it and more."""
    factor = 1.0 + rng.choice([-1, 1]) * 10.0 ** rng.uniform(-4, 0)
    good, off = bool(factor < 1.0), float(factor)
    place = tuple(int(k) for k in rng.permutation(3)[:2])
    match rule:
        case Rule.INERTIA:
            size, R = 10.0 ** rng.uniform(-12, 10), drawn(rng)
            tensor = moments(0.5, 1.0, 1.2, rng=rng)
            scale = 1e-9 * np.abs(tensor).max() * off
            skew = changed(tensor, place, -scale if tensor[place] > 0.0 else scale)
            yield size * skew, good
            tensor = R @ np.diag([0.0, *rng.uniform(0.0, 1.0, 2)]) @ R.T
            tensor -= 1e-9 * np.abs(tensor).max() * off * np.outer(R[:, 0], R[:, 0])
            yield size * (tensor + tensor.T) / 2, good
        case Rule.ROTATION:
            R = drawn(rng)
            yield R * np.sqrt(1.0 - 1e-6 * off), good
            axes = E.copy()
            axes[1] += 1e-6 * off * axes[0]
            yield axes @ R, good
        case Rule.PLANAR_ROTATION:
            yield turned(rng.uniform(-3, 3)) * np.sqrt(1.0 - 1e-6 * off * (1 - E[2])), good
            yield changed(turned(rng.uniform(-3, 3)), (2, 2), -1e-9 * off), good
        case Rule.UNIT:
            direction = rng.normal(size=3)
            yield direction / np.linalg.norm(direction) * (1.0 + 1e-6 * off), good
        case Rule.FREE | Rule.MASS:
            limit = np.full(3 if rule is Rule.FREE else (), 1e12)
            yield limit * off, good
        case Rule.POSITIVE | Rule.NONZERO:
            sign = rng.choice([-1.0, 1.0]) if rule is Rule.NONZERO else 1.0
            yield np.array(sign * 1e-9 * off), not good
        case Rule.INVERTIBLE:
            matrix = changed(E, (1, 2), 1.0) + changed(Z, (2, 1), 1.0)
            order, sizes = rng.permutation(3), 10.0 ** rng.uniform(-9, 9, 3)
            least = 1e-6 * off
            yield changed(matrix, (2, 2), least / (1.0 - least))[order] * sizes, not good


class Target:
    """A model in NumPy and C whose parameter of a kind takes values."""

    def __init__(self, rule: Rule, folder: Any, real: str) -> None:
        self.rule, (name, self.parameter) = rule, PLACES[rule]
        manipulator = manipulator_of(name)
        self.module = models.module(manipulator)
        self.library = CLibrary(models.bundle(manipulator), folder, real, flags=QUICK)
        starts = np.cumsum([0, *(int(np.prod(f.shape, dtype=int)) for f in self.library.fields)])
        index = [f.name for f in self.library.fields].index(self.parameter)
        self.field, self.start = self.library.fields[index], int(starts[index])
        self.rng = np.random.default_rng(5)

    def accepted(self, value: Any) -> tuple[bool, bool]:
        """Whether NumPy and C take the value, in one leg drawn at random."""
        whole = np.array(getattr(self.module.Parameters(), self.parameter))
        if self.field.per_leg:
            whole[self.rng.integers(len(whole))] = value
        else:
            whole = np.array(value, dtype=float)
        params = self.library.defaults.copy()
        params[self.start : self.start + whole.size] = whole.reshape(-1)
        status = self.library.prepare(params)
        assert status in (OK, INVALID)
        try:
            self.module.Parameters(**{self.parameter: whole})
        except ValueError:
            return False, status == OK
        return True, status == OK


@pytest.mark.filterwarnings("ignore:.*belong to no body")
@pytest.mark.parametrize("real", ["double", "float", "long double"])
@pytest.mark.parametrize("rule", sampled(Rule, 3))
def test_the_same_values_are_accepted(rule: Rule, real: str, tmp_path: Any) -> None:
    target = Target(rule, tmp_path, real)
    assert target.field.rule is rule
    for given, good in CASES[rule]:
        value = np.array(given, dtype=float)
        assert (read(rule, value), *target.accepted(value)) == (good,) * 3, value
    for wrong in NOT_NUMBERS:
        for place in np.ndindex(target.field.core):
            value = np.array(CASES[rule][0][0], dtype=float)
            value[place] = wrong
            assert (read(rule, value), *target.accepted(value)) == (False,) * 3, value


@pytest.mark.filterwarnings("ignore:.*belong to no body")
@pytest.mark.parametrize("rule", list(Rule))
def test_the_same_values_near_the_limits(rule: Rule, tmp_path: Any) -> None:
    target, rng = Target(rule, tmp_path, "double"), np.random.default_rng(11)
    seen = set()
    for _ in range(300):
        for value, good in near(rule, rng):
            assert (read(rule, value), *target.accepted(value)) == (good,) * 3, value
            seen.add(good)
    assert seen in ({True, False}, set())
    assert bool(seen) == (rule is not Rule.PLANAR_INERTIA)  # zero is its limit


@pytest.mark.parametrize("name", ["planar_3rrr", "stewart", "tripod_3upu", "hexapod_6uhs", RUBBING])
def test_every_parameter_has_its_rule(name: str) -> None:
    """By what it is, not by how it is called: from the specification's own fields."""
    planar = name.startswith("planar")
    wanted = {
        "mass": Rule.MASS,
        "inertia": Rule.PLANAR_INERTIA if planar else Rule.INERTIA,
        "base_frame": Rule.PLANAR_ROTATION if planar else Rule.ROTATION,
        "axis": Rule.UNIT,
        "axis_link": Rule.UNIT,
        "axis_platform": Rule.UNIT,
        "viscous": Rule.MASS,
        "coulomb": Rule.MASS,
        "rotor_inertia": Rule.MASS,
        "velocity_scale": Rule.POSITIVE,
        "gear_ratio": Rule.NONZERO,
        "coupling": Rule.INVERTIBLE,
    }
    for field in models.bundle(manipulator_of(name)).derivation.parameters.fields:
        last = field.paths[0].rsplit(".", maxsplit=1)[-1]
        assert field.rule is wanted.get(last, Rule.FREE), field.name


def test_reader_warns_where_the_module_does() -> None:
    tensor = np.diag([1.0, 1.0, 5.0])
    body = {"mass": 1.0, "inertia": tensor.tolist()}
    with pytest.warns(SpecWarning, match="belong to no body"):
        read_body(Entry("spec", "body", body), plane=False)
    with pytest.warns(UserWarning, match="belong to no body"):
        models.module(models.catalogue("stewart")).Parameters(platform_inertia=tensor)
    assert number(Entry("spec", "mass", 1)) == 1.0
