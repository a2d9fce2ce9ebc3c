"""Friction, springs and motors in joints against the independent projection, in NumPy and C."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from pne_sym.mechanics.derive import derive
from pne_sym.model.effects import Actuator, Friction, Spring
from pne_sym.model.manipulator import Body, Joint, Manipulator
from pne_sym.model.reader import checked
from pne_sym.program.count import count_function
from tests.backends.c_library import QUICK, CLibrary
from tests.models import bundle, catalogue, live_parameters, module, state_at
from tests.oracle.coordinates import actuated_indices, displaced
from tests.oracle.effects import rotors, springs
from tests.oracle.projection import project
from tests.random.effects import with_effects
from tests.sampling import sampled
from tests.whole.cases import Case, assert_right, guess_of, own

NAMES = [
    "planar_3rpr",
    "tripod_3rps",
    "hybrid_3rrrs_redundant",
    "spherical_3ups",
    "delta",
    "hexapod_6uhs",
    "planar_redundant",
]
STEP = 1e-4


@cache
def dressed(name: str, seed: int = 1) -> Manipulator:
    """A catalogue entry with friction, springs and motors in joints drawn at random."""
    return checked(with_effects(catalogue(name), np.random.default_rng(seed), 1.0, 0.7))


def other_values(manipulator: Manipulator, rng: np.random.Generator) -> Manipulator:
    """The same structure with other numbers of what acts in the joints."""

    def changed(of: Any) -> Any:
        values = {n: v * rng.uniform(0.5, 2.0) for n, v in vars(of).items() if v is not None}
        return replace(of, **{n: float(v) for n, v in values.items()})

    def joint(old: Joint) -> Joint:
        found = {n: getattr(old, n) for n in ("friction", "spring", "actuator")}
        return replace(old, **{n: changed(of) for n, of in found.items() if of})

    legs = (replace(leg, joints=tuple(map(joint, leg.joints))) for leg in manipulator.legs)
    return replace(manipulator, legs=tuple(legs))


@pytest.mark.parametrize("name", sampled(NAMES, 4))
def test_every_answer(name: str) -> None:
    spec = dressed(name)
    assert_right(own(spec, state_at(spec, 3)))


@pytest.mark.parametrize("name", ["planar_3rpr", "tripod_3rps"])
def test_friction_of_platform_joints(name: str) -> None:
    """A moment against the relative turning, in leg reactions too."""
    plain, law = catalogue(name), Friction(2.0, 3.0, 0.1)
    legs = [
        replace(leg, platform_joint=replace(leg.platform_joint, friction=law)) for leg in plain.legs
    ]
    spec = checked(replace(plain, legs=tuple(legs)))
    c = own(spec, state_at(spec, 3))
    assert_right(c)
    m, base, s = c.model, module(plain), c.state
    taken = (m.Z(s.X, s.V) - base.Z(s.X, s.V)) @ s.V
    assert m.dissipation(s.X, s.V) == pytest.approx(taken, rel=1e-9)
    assert taken == pytest.approx(c.oracle.dissipation, rel=1e-9)


@pytest.mark.parametrize("name", sampled(NAMES[:4], 0, keep=NAMES[:2]))
def test_every_number_is_live(name: str) -> None:
    """A model with the parameters of another specification answers as that one."""
    made, spec = dressed(name), other_values(dressed(name), np.random.default_rng(4))
    m, state = module(made), state_at(made, 4)
    assert len(live_names(made)) > 2
    c = Case(m, live_parameters(made, spec), spec, state, project(spec, *state),
             guess_of(m, state.q))  # fmt: skip
    assert_right(c)


def live_names(manipulator: Manipulator) -> list[str]:
    return [f.name for f in derive(manipulator).parameters.fields if "_joint" in f.name]


@pytest.mark.parametrize("name", sampled(NAMES, 4))
def test_power_balance(name: str) -> None:
    """d/dt (kinetic + potential) = tau . qd + wrench . V - dissipation, to 1e-8."""
    spec = dressed(name)
    c = own(spec, state_at(spec, 5))
    m, s = c.model, c.state

    def energy(h: float) -> Any:
        X = displaced(spec, s.X, h * s.V + h**2 / 2 * s.A)
        return np.sum(m.energy(X, s.V + h * s.A, **c.guess))

    tau = m.inverse_dynamics(s.X, s.V, s.A, wrench=s.wrench, **c.guess)
    tau = tau[0] if m.NC else tau
    actuated = m.joint_rates(s.X, s.V, **c.guess)[actuated_indices(spec)]
    terms = [tau @ actuated, s.wrench @ s.V[: m.NW], -c.oracle.dissipation]
    # Central differences at three steps, extrapolated twice.
    rows = [[(energy(h) - energy(-h)) / (2 * h) for h in (STEP, STEP / 2, STEP / 4)]]
    for k in (4, 16):
        last = rows[-1]
        rows.append([(k * b - a) / (k - 1) for a, b in pairwise(last)])
    assert c.oracle.dissipation > 0.0
    assert abs(sum(terms) - rows[-1][0]) < 1e-8 * np.abs(terms).max()


@pytest.mark.parametrize("name", ["planar_3rpr", "tripod_3rps"])
def test_the_same_in_c(name: str, tmp_path: Any) -> None:
    spec = dressed(name)
    c = own(spec, state_at(spec, 6))
    library, m, s = CLibrary(bundle(spec), tmp_path, flags=QUICK), c.model, c.state
    wanted = m.inverse_dynamics(s.X, s.V, s.A, wrench=s.wrench)
    found, _ = library.single("inverse_dynamics", s.X, s.V, s.A, s.wrench)
    for mine, theirs in zip(found, wanted if m.NC else (wanted,), strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-11, atol=1e-11 * np.abs(theirs).max())


def test_at_rest_coulomb_friction_is_zero() -> None:
    spec = with_all(catalogue("planar_3rpr"), friction=Friction(None, 5.0, 1e-9))
    m = module(spec)
    X, rest = np.array(spec.home.X), np.zeros(3)
    plain = module(catalogue("planar_3rpr"))
    np.testing.assert_allclose(m.Z(X, rest), plain.Z(X, rest), rtol=1e-13, atol=1e-12)
    fast = m.Z(X, [0.1, -0.2, 0.3]) - plain.Z(X, [0.1, -0.2, 0.3])
    rates = m.joint_rates(X, [0.1, -0.2, 0.3])
    wanted = columns(m, X).T @ (5.0 * np.sign(rates))
    np.testing.assert_allclose(fast, wanted, rtol=1e-6)


def test_springs_and_rotors_on_all_joints() -> None:
    """A stiff check by hand: columns of joint rates by V, one joint after another."""
    plain = catalogue("planar_3rpr")
    joints = [joint for leg in plain.legs for joint in leg.joints]
    spec = with_all(plain, spring=Spring(30.0, 0.4), actuator=Actuator(2e-3, 30.0))
    dressed_joints = [joint for leg in spec.legs for joint in leg.joints]
    m, base = module(spec), module(plain)
    X = np.array(spec.home.X) + np.array([0.03, 0.05, 0.2])
    V = np.array([0.2, 0.1, -0.4])
    J, q = columns(m, X), m.inverse_kinematics(X)
    assert len(joints) == len(q)
    inertia = np.diag(rotors(dressed_joints))
    np.testing.assert_allclose(m.M(X) - base.M(X), J.T @ inertia @ J, atol=1e-12)
    bias = m.joint_accelerations(X, V, np.zeros(3))
    wanted = J.T @ (springs(dressed_joints, q) + inertia @ bias)
    np.testing.assert_allclose(m.Z(X, V) - base.Z(X, V), wanted, atol=1e-11)
    np.testing.assert_allclose(m.H(X), base.H(X), atol=0)


def columns(m: Any, X: Any) -> Any:
    """(NJ, NV) rates of all joints by V."""
    return m.joint_rates(X, np.eye(m.NV)).T


def with_all(manipulator: Manipulator, **effects: Any) -> Manipulator:
    """The same in every joint; motors where joints are actuated."""

    def joint(old: Joint) -> Joint:
        kept = {n: of for n, of in effects.items() if n != "actuator" or old.actuated}
        return replace(old, **kept)

    legs = (replace(leg, joints=tuple(map(joint, leg.joints))) for leg in manipulator.legs)
    return checked(replace(manipulator, legs=tuple(legs)))


def test_what_it_costs() -> None:
    """Inverse dynamics of Stewart with friction and motors at all actuators: at most 8 % more."""
    plain = catalogue("stewart")

    def joint(old: Joint) -> Joint:
        if not old.actuated:
            return old
        return replace(old, friction=Friction(200.0, 50.0, 1e-3), actuator=Actuator(1e-4, 600.0))

    legs = (replace(leg, joints=tuple(map(joint, leg.joints))) for leg in plain.legs)
    moved = checked(replace(plain, legs=tuple(legs)))
    before, after = (count(spec) for spec in (plain, moved))
    assert before < after <= 1.08 * before


def count(spec: Manipulator) -> int:
    """Operations of the force that actuators and wrench must give."""
    found = bundle(spec)
    n = count_function(found.program.functions["required"], found.leg_counts)
    return n.mul + n.add + n.div + n.sqrt + n.trig


def test_legs_of_one_type_have_the_same() -> None:
    """Presence is structure, values are not."""
    plain = catalogue("planar_3rpr")
    first, *others = plain.legs
    turn, slide = first.joints
    one = replace(first, joints=(replace(turn, friction=Friction(1.0)), slide))
    mixed = derive(replace(plain, legs=(one, *others)))
    assert [len(t.indices) for t in mixed.leg_types] == [1, 2]
    same = with_all(plain, friction=Friction(1.0))
    changed = other_values(same, np.random.default_rng(1))
    assert [len(t.indices) for t in derive(changed).leg_types] == [3]


def test_symbols_tell_quantities_apart() -> None:
    """In the report of a leg with all of it, no two quantities look the same."""
    full = with_all(
        catalogue("stewart"),
        friction=Friction(1.0, 1.0, 0.1),
        spring=Spring(1.0, 0.1),
        actuator=Actuator(1e-4, 30.0),
    )
    used: dict[str, str] = {}
    derivation = derive(full)
    for equation in derivation.equations():
        for name in (equation.name, *equation.uses):
            latex = derivation.notation[name].latex
            assert used.setdefault(latex, name) == name or "ups_joint" not in name, latex
    assert sum(name.startswith("ups_joint") for name in used.values()) == 3 * 5 + 2


def test_payload() -> None:
    """A second body on the platform: in every answer, live, and gone with its mass."""
    payload = Body(4.0, (0.1, -0.05, 0.0), ((0.1, 0, 0), (0, 0.2, 0), (0, 0, 0.3)))
    plain = catalogue("planar_3rpr")
    spec = checked(replace(plain, payload=payload))
    assert_right(own(spec, state_at(spec, 3)))
    m, base = module(spec), module(plain)
    X = np.array(m.HOME_X)
    np.testing.assert_allclose(m.M(X, m.Parameters().with_payload(0.0)), base.M(X), rtol=1e-14)
    other = m.Parameters().with_payload(2.0, [0.0, 0.2, 0.0], np.diag([0, 0, 0.5]))
    moved = checked(
        replace(plain, payload=Body(2.0, (0.0, 0.2, 0.0), np.diag([0, 0, 0.5]).tolist()))
    )
    V = np.array([0.3, 0.1, -0.7])
    np.testing.assert_allclose(m.Z(X, V, other), module(moved).Z(X, V), rtol=1e-13)
    assert not hasattr(base.Parameters(), "with_payload")
    with pytest.raises(ValueError, match="payload_mass must not be negative"):
        m.Parameters().with_payload(-1.0)
