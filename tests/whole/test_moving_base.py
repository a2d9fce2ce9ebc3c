"""A base that moves: against an accelerated frame, gravity, and a pendulum by hand; in C too."""

from __future__ import annotations

import inspect
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import checked, from_mapping, to_full_form
from tests.backends.c_library import CLibrary
from tests.models import bundle, catalogue, module, state_at
from tests.oracle.base import Base, base_of, rotation_of
from tests.oracle.comparison import relative_error
from tests.oracle.projection import project
from tests.sampling import sampled
from tests.whole.cases import assert_right, own
from tests.whole.test_joint_forces import dressed

NAMES = ["planar_3rpr", "tripod_3rps", "delta", "hybrid_3rrrs", "spherical_3ups", "hexapod_6x6r"]
TAKING = {
    "Z", "dynamics", "inverse_dynamics", "forward_dynamics", "leg_reactions", "energy",
    "complete_acceleration",
}  # fmt: skip


@cache
def carried(name: str, *, plain: bool = False) -> Manipulator:
    """A catalogue entry on a base that moves, with friction, springs and motors or without."""
    return checked(replace(catalogue(name) if plain else dressed(name), moving_base=True))


@pytest.mark.parametrize("name", sampled(NAMES, 3))
def test_every_answer(name: str) -> None:
    spec = carried(name)
    assert_right(own(spec, state_at(spec, 3)))


@pytest.mark.parametrize("name", ["planar_3rpr", "tripod_3rps"])
def test_at_rest_and_accelerated(name: str) -> None:
    """At rest nothing changes; a constant acceleration is gravity, shifted and turned."""
    spec, plain = carried(name, plain=True), catalogue(name)
    m, fixed, s = module(spec), module(plain), state_at(plain, 2)
    base = base_of(spec)
    still = replace(base, spin=np.zeros(3), spin_rate=np.zeros(3))
    gravity = base.rotation.T @ np.array(plain.gravity) - base.acceleration
    shifted = fixed.Parameters().replace(gravity=gravity)
    for taken, p in (({}, None), ({"base": still.given}, shifted)):
        for function, given in (("Z", (s.X, s.V)), ("inverse_dynamics", (s.X, s.V, s.A))):
            found = np.hstack(getattr(m, function)(*given, **taken))
            wanted = np.hstack(getattr(fixed, function)(*given, p))
            np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-12 * np.abs(wanted).max())


@pytest.mark.parametrize("name", ["planar_3rpr", "tripod_3rps"])
def test_each_part_of_the_motion_alone(name: str) -> None:
    """R, omega, alpha, a: each as the projection has it, and each by its own law."""
    spec = carried(name, plain=True)
    m, s, base = module(spec), state_at(spec, 2), base_of(spec)
    still = Base(np.eye(3), np.zeros(3), np.zeros(3), np.zeros(3))

    def tau(V: Any, **part: Any) -> Any:
        return np.hstack(m.inverse_dynamics(s.X, V, s.A, base=replace(still, **part).given))[: m.NU]

    def adds(V: Any, **part: Any) -> Any:
        return tau(V, **part) - tau(V)

    parts = {n: getattr(base, n) for n in ("rotation", "spin", "spin_rate", "acceleration")}
    rest = 0.0 * s.V
    for field, value in parts.items():
        moved = replace(still, **{field: value})
        wanted = project(spec, s.X, s.q, s.V, s.A, base=moved).tau
        assert relative_error(tau(s.V, **{field: value}), wanted) < 1e-9, field
        assert np.abs(adds(s.V, **{field: value})).max() > 1e-3, field
        # What the platform's velocity changes is Coriolis's acceleration alone.
        of_velocity = adds(s.V, **{field: value}) - adds(rest, **{field: value})
        size = 1e-10 * np.abs(wanted).max()
        assert (np.abs(of_velocity).max() > size) == (field == "spin"), field
        if field in ("spin_rate", "acceleration"):
            twice = adds(s.V, **{field: 2.0 * value})
            np.testing.assert_allclose(twice, 2.0 * adds(s.V, **{field: value}), atol=size)
    twice = adds(rest, spin=2.0 * base.spin)
    np.testing.assert_allclose(twice, 4.0 * adds(rest, spin=base.spin), atol=1e-9)
    turned = base.rotation.T @ np.array(spec.gravity) - np.array(spec.gravity)
    as_gravity = adds(s.V, acceleration=-turned)
    np.testing.assert_allclose(adds(s.V, rotation=base.rotation), as_gravity, atol=1e-10)


def pendulum() -> Manipulator:
    """A point mass m at the length l of an arm that turns about y; the platform weighs nothing."""
    joint = {
        "kind": "R", "axis": "y", "actuated": True,
        "link": {"mass": 1.3, "centre_of_mass": [0, 0, -0.7]},
    }  # fmt: skip
    leg = {
        "base_point": [0, 0, 0], "platform_point": [0, 0, 0], "joints": [joint],
        "platform_joint": {"kind": "rigid", "offset": [0, 0, -0.7], "rotation": np.eye(3).tolist()},
    }  # fmt: skip
    form = {
        "name": "pendulum", "space": "spatial", "moving_base": True, "platform": {"mass": 0.0},
        "legs": [leg], "home": {"X": [0, 0, -0.7, 0, 0, 0, 1], "q": [0.0]},
    }  # fmt: skip
    return from_mapping(form, "pendulum")


def test_a_pendulum_on_a_turntable() -> None:
    """m l^2 (theta'' - W^2 sin theta cos theta) + m g l sin theta, the plane turning at W."""
    m, length, mass, turning = module(pendulum()), 0.7, 1.3, 2.5
    base = (rotation_of(np.array([0.0, 0.0, 0.4])), [0, 0, turning], [0, 0, 0], [0, 0, 0])
    rate, rise = 0.9, -1.4
    for angle in (-2.0, 0.3, 1.1):
        s, c = np.sin(angle), np.cos(angle)
        X = np.array([-length * s, 0, -length * c, 0, np.sin(angle / 2), 0, np.cos(angle / 2)])
        V = np.array([-length * c * rate, 0, length * s * rate, 0, rate, 0])
        A = np.array([-length * c * rise, 0, length * s * rise, 0, rise, 0])
        A[[0, 2]] += length * rate**2 * np.array([s, c])
        tau, _ = m.inverse_dynamics(X, V, A, base=base)
        wanted = mass * length**2 * (rise - turning**2 * s * c) + mass * 9.81 * length * s
        assert tau[0] == pytest.approx(wanted, rel=1e-12)


def test_states_and_motions_of_the_base_broadcast() -> None:
    spec = carried("planar_3rpr", plain=True)
    m, s = module(spec), state_at(spec, 1)
    base = base_of(spec)
    spins = np.linspace(-1.0, 1.0, 12)[:, None] * base.spin
    many = m.Z(s.X, s.V, base=(base.rotation, spins, base.spin_rate, base.acceleration))
    for spin, found in zip(spins, many, strict=True):
        alone = m.Z(s.X, s.V, base=replace(base, spin=spin).given)
        np.testing.assert_allclose(found, alone, rtol=1e-14, atol=1e-13)
    np.testing.assert_array_equal(m.Z(s.X, s.V, base=base.flat), m.Z(s.X, s.V, base=base.given))
    crooked = 1.001 * base.rotation, *base.given[1:]
    assert np.isnan(m.Z(s.X, s.V, base=crooked)).all()
    assert np.isnan(m.Z(s.X, s.V, base=(np.diag([1.0, -1.0, 1.0]), *base.given[1:]))).all()
    with pytest.raises(ValueError, match=r"base: expected \(R, omega, alpha, a\)"):
        m.Z(s.X, s.V, base=base.given[:3])
    with pytest.raises(ValueError, match=r"omega has shape \(2,\), expected"):
        m.Z(s.X, s.V, base=(base.rotation, [0, 0], base.spin_rate, base.acceleration))


@pytest.mark.parametrize("name", sampled(["planar_3rpr", "tripod_3rps"], 2))
def test_the_same_in_c(name: str, tmp_path: Path) -> None:
    spec = carried(name, plain=True)
    m, s, flat = module(spec), state_at(spec, 1), base_of(spec).flat
    library = CLibrary(bundle(spec), tmp_path, flags=("-O0",))
    bases = np.tile(flat, (11, 1))
    bases[:, 11] *= np.linspace(-1.0, 1.0, 11)
    bases[4, 0] *= 1.01
    X, V = (np.tile(v, (11, 1)) for v in (s.X, s.V))
    (found,), status = library.batch("Z", X, V, bases)
    wanted = m.Z(X, V, base=bases)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-11 * np.nanmax(np.abs(wanted)))
    np.testing.assert_array_equal(status, [0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0])
    (found,), status = library.batch("Z", X, V, None)  # at rest: side by side, and one by one
    np.testing.assert_allclose(found, m.Z(X, V), rtol=0, atol=1e-11 * np.abs(found).max())
    np.testing.assert_array_equal(status, 0)
    assert [i.name for i in library.api["inverse_dynamics"].inputs][-1] == "base"


def functions_with_base(m: Any) -> set[str]:
    members = {n: getattr(m, n) for n in m.__all__}
    return {
        n
        for n, f in members.items()
        if inspect.isfunction(f) and "base" in inspect.signature(f).parameters
    }


def test_who_takes_it() -> None:
    assert functions_with_base(module(carried("planar_3rpr", plain=True))) <= TAKING
    assert functions_with_base(module(carried("planar_3rpr", plain=True))) > {"Z", "energy"}
    assert not functions_with_base(module(catalogue("planar_3rpr")))
    form = to_full_form(catalogue("planar_3rpr"))
    assert "moving_base" not in form
    assert from_mapping(form | {"moving_base": False}, "spec") == catalogue("planar_3rpr")
    moving = from_mapping(form | {"moving_base": True}, "spec")
    assert to_full_form(moving)["moving_base"] is True
