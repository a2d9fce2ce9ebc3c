"""Live parameters: another value is the same as generating anew with it; what is refused."""

from __future__ import annotations

import pickle
import re
import sys
from copy import copy, deepcopy
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pne_sym.model.full_form import to_full_form
from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import checked
from tests.models import catalogue, live_parameters, manifest, module, same_branch_spec, state_at
from tests.oracle.closure import assemble
from tests.oracle.comparison import relative_error
from tests.oracle.mechanisms import mechanism
from tests.oracle.projection import moments_at_home, project
from tests.oracle.specs import from_dict
from tests.whole.cases import Array

NAMES = ("fivebar_offset", "hexapod_6uhs", "planar_redundant", "spherical_3ups", "tripod_3upu")
"""Each kind of parameter: pitches, offsets, axes on the platform, a fixed centre."""
IDLE = (("planar_redundant", "prrr_link1_inertia"),)
"""Of a link that slides without turning."""
STEP = re.compile(r"([a-z_]+)|\[(\d+)\]")


def leaves() -> list[tuple[str, str]]:
    """Every parameter of the entries above, as (entry, parameter)."""
    return [(name, p["name"]) for name in NAMES for p in manifest(catalogue(name))["parameters"]]


def changed(name: str, parameter: str) -> Manipulator:
    """The entry with this parameter changed a little, in a way of its own in every leg."""
    form: dict[str, Any] = deepcopy(to_full_form(catalogue(name)))
    (entry,) = (p for p in manifest(catalogue(name))["parameters"] if p["name"] == parameter)
    rng = np.random.default_rng(2)
    for leg in entry.get("legs", [0]):
        *steps, last = STEP.findall(entry["path"].replace("[i]", f"[{leg}]"))
        place: Any = form
        for field, index in steps:
            place = place[field] if field else place[int(index)]
        field, index = last
        key: Any = field or int(index)
        place[key] = np.asarray(_nearby(place[key], parameter, form["space"], rng)).tolist()
    return from_dict(form)


def _nearby(value: Any, parameter: str, space: str, rng: np.random.Generator) -> Any:
    old = np.array(value, dtype=float)
    planar = space in ("planar", "point")
    if parameter.endswith(("frame", "rotation")):
        angle = rng.uniform(0.02, 0.06)
        c, s = np.cos(angle), np.sin(angle)
        return old @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    if parameter.endswith("inertia"):
        root = rng.uniform(-0.1, 0.1, (3, 3))
        second = 0.1 * root @ root.T  # second moments of a mass, so that a body has the sum
        return old + np.trace(second) * np.eye(3) - second
    if parameter.endswith(("gravity", "centre", "point", "centre_of_mass")):
        shift = rng.uniform(-0.02, 0.02, 3)
        return old + (shift * (1.0, 1.0, 0.0) if planar else shift)
    if "axis" in parameter:
        tilted = old + rng.uniform(-0.05, 0.05, 3) * (old != 0.0)
        return tilted / np.linalg.norm(tilted)
    return old * rng.uniform(1.02, 1.06, old.shape)  # masses, pitches, offsets: zeros stay


@pytest.mark.parametrize(("name", "parameter"), leaves())
def test_every_parameter_is_live(name: str, parameter: str) -> None:
    """One parameter replaced: the values are those of the manipulator that has it, and new."""
    nominal, spec, model = catalogue(name), changed(name, parameter), module(catalogue(name))
    value = getattr(live_parameters(nominal, spec), parameter)
    p = model.Parameters().replace(**{parameter: value})
    X, q = assemble(spec, np.array(nominal.home.X), np.array(nominal.home.q))
    V = np.linspace(-1.0, 1.2, model.NV)
    Hk = project(spec, X, q, V).Hk
    V = V - np.linalg.pinv(Hk.T) @ (Hk.T @ V)
    oracle = project(spec, X, q, V, moments=moments_at_home(nominal))
    expected = [oracle.M, oracle.Z, oracle.H, q, oracle.qd, oracle.kinetic, oracle.potential]
    expected += [_span(oracle.Hk)] * (model.NC > 0)
    found = _values(model, X, V, p)
    assert _distance(found, expected) < 1e-9
    before = _values(model, X, V, model.Parameters())
    assert (_distance(before, expected) > 1e-5) != ((name, parameter) in IDLE)


def _distance(found: list[Any], expected: list[Any]) -> float:
    return max(relative_error(a, b) for a, b in zip(found, expected, strict=True))


def _values(model: Any, X: Array, V: Array, p: Any) -> list[Any]:
    q, qd = model.inverse_kinematics(X, p), model.joint_rates(X, V, p)
    constraints = [_span(model.Hk(X, p))] if model.NC else []
    return [*model.dynamics(X, V, p), q, qd, *model.energy(X, V, p), *constraints]


def _span(Hk: Array) -> Array:
    """Projection on what the columns span, whatever their units."""
    return np.asarray(Hk @ np.linalg.pinv(Hk))


@pytest.mark.parametrize("name", ["fivebar_offset", "planar_3prr", "stewart", "tripod_3rps"])
def test_all_at_once_is_generating_anew(name: str) -> None:
    spec = same_branch_spec(name, 3)
    state, p = state_at(spec, 3), live_parameters(catalogue(name), spec)
    anew, live = module(spec), module(catalogue(name))
    for mine, theirs in zip(
        _values(live, state.X, state.V, p),
        _values(anew, state.X, state.V, anew.Parameters()),
        strict=True,
    ):
        assert relative_error(mine, theirs) < 1e-13


@pytest.mark.parametrize("name", NAMES)
def test_shapes(name: str) -> None:
    model = module(catalogue(name))
    for entry in manifest(catalogue(name))["parameters"]:
        parameter, shape = entry["name"], tuple(entry["shape"])
        assert np.shape(getattr(model.Parameters(), parameter)) == shape
        for wrong in ((*shape, 2), (7,)):
            message = rf"Parameters: {parameter} has shape {wrong}, expected {shape}"
            with pytest.raises(ValueError, match=re.escape(message)):
                model.Parameters(**{parameter: np.ones(wrong)})
        with pytest.raises(ValueError, match=f"{parameter} has entries that are not finite"):
            model.Parameters(**{parameter: np.full(shape, np.nan)})
        with pytest.raises(ValueError, match=rf"{parameter} has entries beyond 1e\+12 in size"):
            model.Parameters(**{parameter: np.full(shape, -1.001e12)})


SKEWED = [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]
IMPOSSIBLE: tuple[tuple[str, str, Any, str], ...] = (
    ("stewart", "platform_mass", -1.0, "must not be negative"),
    ("stewart", "platform_inertia", SKEWED, "must be symmetric"),
    ("stewart", "platform_inertia", -5.0 * np.eye(3), "must have no negative principal"),
    ("stewart", "platform_inertia", np.ones((3, 3)) - np.eye(3), "must have no negative principal"),
    ("stewart", "ups_base_frame", np.tile(np.diag([1, 1, -1]), (6, 1, 1)), "must be rotation"),
    (
        "planar_3rrr",
        "rrr_base_frame",
        np.tile(np.diag([1, -1, -1]), (3, 1, 1)),
        "must turn about the normal",
    ),
    ("planar_3rrr", "rrr_joint2_offset", np.full((3, 3), 0.4), "must be zero in entries"),
    ("planar_3rrr", "platform_inertia", -np.eye(3), "must have an izz that is not negative"),
    ("tripod_3upu", "upu_platform_joint_axis_platform", np.ones((3, 3)), "must be of length 1"),
)


@pytest.mark.parametrize(("name", "parameter", "value", "message"), IMPOSSIBLE)
def test_impossible_values(name: str, parameter: str, value: Any, message: str) -> None:
    model = module(catalogue(name))
    for make in (model.Parameters, model.Parameters().replace):
        with pytest.raises(ValueError, match=rf"Parameters: {parameter} {message}"):
            make(**{parameter: value})


def test_what_is_zero_by_structure_is_made_so() -> None:
    """Rounding there is accepted, and has no effect."""
    model = module(catalogue("planar_3rpr"))
    p = model.Parameters()
    rounded = p.replace(gravity=p.gravity + 1e-10)
    np.testing.assert_array_equal(rounded.gravity - p.gravity > 0.0, [True, True, False])
    assert rounded.gravity[2] == 0.0


def test_tensors_are_judged_by_themselves() -> None:
    """A large inertia of one leg excuses no other."""
    model = module(catalogue("stewart"))
    name = next(n for n in vars(model.Parameters()) if n.endswith("link2_inertia"))
    good = np.array(getattr(model.Parameters(), name))
    good[0] = 1e10 * np.eye(3)
    model.Parameters(**{name: good})
    for wrong in ((0, 1), (2, 2)):
        bad = good.copy()
        bad[(3, *wrong)] = -1.0
        with pytest.raises(ValueError, match=f"{name} must"):
            model.Parameters(**{name: bad})


def test_zero_inertia_and_in_the_plane_izz_alone() -> None:
    module(catalogue("stewart")).Parameters(platform_inertia=np.zeros((3, 3)))
    module(catalogue("planar_3rrr")).Parameters(
        platform_inertia=[[-3, 2, 1], [0, -1, 5], [7, 0, 0]]
    )


def test_the_rotation_of_a_rigid_platform_joint_is_one() -> None:
    rng = np.random.default_rng(7)
    legs = ["Px* Py* Pz* Rz0 Ry0 Rx | rigid"]
    drawn = mechanism("translational", legs, rng, plain=True)
    model = module(checked(replace(drawn, name="drawn")))
    (name,) = (name for name in vars(model.Parameters()) if name.endswith("joint_rotation"))
    turned = -getattr(model.Parameters(), name)
    with pytest.raises(ValueError, match=f"Parameters: {name} must be rotation matrices"):
        model.Parameters(**{name: turned})


def test_unknown_names() -> None:
    model = module(catalogue("stewart"))
    for make in (model.Parameters, model.Parameters().replace):
        with pytest.raises(ValueError, match=r"unknown \['platform_maas'\]; expected among"):
            make(platform_maas=1.0)


def test_frozen_copies() -> None:
    """What was given may change afterwards; what is held may not."""
    model = module(catalogue("stewart"))
    given = np.array([0.0, 0.0, -1.6])
    p = model.Parameters(gravity=given)
    given[2] = 5.0
    assert p.gravity[2] == -1.6
    with pytest.raises(ValueError, match="read-only"):
        p.gravity[2] = 5.0
    with pytest.raises(AttributeError, match="frozen"):
        p.gravity = given
    with pytest.raises(AttributeError, match="frozen"):
        del p.gravity
    for array in (p.gravity, p.ups_base_frame, model.HOME_X, model.HOME_Q):
        with pytest.raises(ValueError, match="WRITEABLE"):
            array.setflags(write=True)
    other = p.replace(platform_mass=3.0)
    assert (other.platform_mass, other.gravity[2]) == (3.0, -1.6)
    assert p.platform_mass == model.Parameters().platform_mass


COPIES = {
    "copy": copy,
    "deepcopy": deepcopy,
    "pickle": lambda p: pickle.loads(pickle.dumps(p)),
    "replace": lambda p: p.replace(),
}


@pytest.mark.parametrize("made", COPIES)
def test_copies_are_made_anew(made: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Read-only as the first, equal to it, and without what was computed from its values."""
    model = module(catalogue("stewart"))
    monkeypatch.setitem(sys.modules, model.__name__, model)  # where pickle looks for the class
    p = model.Parameters(platform_mass=7.5, gravity=[0.0, -0.0, -1.6])
    X = np.array(model.HOME_X)
    expected = model.inverse_dynamics(X, np.zeros(6), np.zeros(6), p)
    assert p._cache
    other = COPIES[made](p)
    assert other == p
    assert other is not p
    assert hash(other) == hash(p)
    assert not other._cache
    assert np.array_equal(model.inverse_dynamics(X, np.zeros(6), np.zeros(6), other), expected)
    with pytest.raises(ValueError, match="read-only"):
        other.platform_centre_of_mass[0] = 0.2
    with pytest.raises(ValueError, match="WRITEABLE"):
        other.platform_centre_of_mass.setflags(write=True)


def test_what_is_unpickled_is_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    model = module(catalogue("stewart"))
    monkeypatch.setitem(sys.modules, model.__name__, model)
    text = pickle.dumps(model.Parameters(platform_mass=7.5), protocol=0)
    with pytest.raises(ValueError, match="platform_mass must not be negative"):
        pickle.loads(text.replace(b"F7.5", b"F-7.5"))


def test_equal_parameters_have_equal_hashes() -> None:
    model = module(catalogue("stewart"))
    p, q = (model.Parameters(gravity=[zero, 0.0, -1.6]) for zero in (0.0, -0.0))
    assert p == q
    assert hash(p) == hash(q)


NO_BODY = np.diag([1.0, 1.0, 5.0])


def test_principal_moments_of_no_body() -> None:
    """A warning, as in the reader; once, where such an inertia is given."""
    model = module(catalogue("stewart"))
    for make in (model.Parameters, model.Parameters().replace):
        with pytest.warns(UserWarning, match="platform_inertia: principal moments 1, 1, 5") as told:
            p = make(platform_inertia=NO_BODY)
        assert told[0].filename == __file__
    deepcopy(p).replace(platform_mass=3.0)
    flat = module(catalogue("planar_3rrr"))
    flat.Parameters(platform_inertia=NO_BODY)
