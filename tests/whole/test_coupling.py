"""Motors that turn with several joints: against the independent projection, by hand, in C."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pne_sym.model.effects import Actuator
from pne_sym.model.errors import SpecError
from pne_sym.model.full_form import to_full_form
from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import checked, from_mapping
from tests.backends.c_library import QUICK, CLibrary
from tests.models import bundle, catalogue, live_parameters, module, state_at
from tests.oracle.coordinates import displaced
from tests.oracle.projection import project
from tests.random.effects import with_coupling
from tests.sampling import sampled
from tests.whole.cases import Case, assert_right, guess_of, own
from tests.whole.test_joint_forces import dressed, other_values, with_all

NAMES = sampled(
    ["planar_3rpr", "hybrid_3rrrs_redundant", "tripod_3rps", "planar_redundant", "stewart"], 4
)


@cache
def coupled(name: str, seed: int = 1) -> Manipulator:
    """A catalogue entry with all that acts in joints, and couplings, drawn at random."""
    found = with_coupling(dressed(name, seed), np.random.default_rng(seed))
    assert found.coupling is not None
    return checked(found)


def both(name: str) -> tuple[Manipulator, Manipulator]:
    """All motors of an entry alike: each with its joint, and coupled."""
    plain = with_all(catalogue(name), actuator=Actuator(2e-3, -30.0))
    return plain, checked(with_coupling(plain, np.random.default_rng(2)))


@pytest.mark.parametrize("name", NAMES)
def test_every_answer(name: str) -> None:
    spec = coupled(name)
    assert_right(own(spec, state_at(spec, 3)))


@pytest.mark.parametrize("name", NAMES[:1])
def test_every_number_is_live(name: str) -> None:
    """Of a coupling too: a model with the parameters of another specification answers as that."""
    made = coupled(name)
    spec = with_coupling(other_values(made, np.random.default_rng(4)), np.random.default_rng(5))
    m, state = module(made), state_at(made, 4)
    p = live_parameters(made, spec)
    assert np.array_equal(p.coupling, np.array(spec.coupling))
    assert_right(Case(m, p, spec, state, project(spec, *state), guess_of(m, state.q)))


@pytest.mark.parametrize("name", ["planar_3rpr", "tripod_3rps"])
def test_each_with_its_own_joint(name: str) -> None:
    """The coupling 1 is none."""
    plain, _ = both(name)
    count = module(plain).NU
    rows = tuple(tuple(map(float, row)) for row in np.eye(count))
    alone, m = module(plain), module(checked(replace(plain, coupling=rows)))
    s = state_at(plain, 3)
    for function, given in (
        ("M", (s.X,)), ("Z", (s.X, s.V)), ("H", (s.X,)), ("energy", (s.X, s.V)),
        ("inverse_dynamics", (s.X, s.V, s.A)), ("leg_reactions", (s.X, s.V, s.A)),
        ("motor_rates", (s.X, s.V)), ("motor_torques", (s.X, s.V, s.A, np.arange(count))),
    ):  # fmt: skip
        found, wanted = (np.hstack(getattr(of, function)(*given)) for of in (m, alone))
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())


def test_motors_by_hand() -> None:
    """M, torques and rates of a coupled planar mechanism from those of the mechanism alone."""
    plain, spec = both("planar_3rpr")
    base, m, s = module(catalogue("planar_3rpr")), module(spec), state_at(plain, 3)
    C, H, n, inertia = np.array(spec.coupling), m.H(s.X), -30.0, 2e-3
    G = H @ C.T
    np.testing.assert_allclose(m.M(s.X) - base.M(s.X), n**2 * inertia * G @ G.T, atol=1e-11)
    np.testing.assert_array_equal(m.M(s.X), m.M(s.X).T)
    tau = m.inverse_dynamics(s.X, s.V, s.A)
    turning = n * C @ m.actuator_accelerations(s.X, s.V, s.A)
    rotors = C.T @ (n * inertia * turning)
    np.testing.assert_allclose(tau - base.inverse_dynamics(s.X, s.V, s.A), rotors, rtol=1e-9)
    rates, torques = m.motor_rates(s.X, s.V), m.motor_torques(s.X, s.V, s.A, tau)
    np.testing.assert_allclose(rates, n * C @ m.actuator_rates(s.X, s.V), rtol=1e-12)
    np.testing.assert_allclose(C.T @ (n * torques), tau, rtol=1e-12)
    # Motors give what the joints get, and what their rotors take.
    joints = base.inverse_dynamics(s.X, s.V, s.A) @ m.actuator_rates(s.X, s.V)
    taken = inertia * turning @ rates
    assert torques @ rates == pytest.approx(joints + taken, rel=1e-12)
    assert torques @ rates == pytest.approx(m.power(s.X, s.V, tau), rel=1e-12)


@pytest.mark.parametrize("name", NAMES[:2])
def test_power_balance(name: str) -> None:
    """What motors give is the rate of energy, with their rotors, and what friction takes."""
    _, spec = both(name)
    m, s = module(spec), state_at(spec, 5)

    def energy(h: float) -> float:
        X = displaced(spec, s.X, h * s.V + h**2 / 2 * s.A)
        return float(np.sum(m.energy(X, s.V + h * s.A)))

    tau = m.inverse_dynamics(s.X, s.V, s.A)
    tau = tau[0] if m.NC else tau
    given = m.motor_torques(s.X, s.V, s.A, tau) @ m.motor_rates(s.X, s.V)
    h = 1e-4
    slopes = [(energy(k * h) - energy(-k * h)) / (2 * k * h) for k in (1, 2)]
    assert given == pytest.approx((4 * slopes[0] - slopes[1]) / 3, rel=1e-7)


def test_couplings_without_motors() -> None:
    """They change no dynamics; torques and rates are those before any gear."""
    plain = catalogue("planar_3rpr")
    m, base = module(checked(with_coupling(plain, np.random.default_rng(1)))), module(plain)
    s = state_at(plain, 2)
    np.testing.assert_array_equal(m.M(s.X), base.M(s.X))
    C = m.Parameters().coupling
    tau = np.arange(3.0)
    torques = m.motor_torques(s.X, s.V, s.A, tau)
    np.testing.assert_allclose(C.T @ torques, tau, atol=1e-14)
    wanted = C @ m.actuator_rates(s.X, s.V)
    np.testing.assert_allclose(m.motor_rates(s.X, s.V), wanted, rtol=1e-13)
    assert not bundle(plain).program.shapes.keys() & {"coupling", "rotor_roots", "actuated_bias"}


@pytest.mark.parametrize("name", ["planar_3rpr", "tripod_3rps"])
def test_the_same_in_c(name: str, tmp_path: Path) -> None:
    spec = coupled(name)
    library, m, s = CLibrary(bundle(spec), tmp_path, flags=QUICK), module(spec), state_at(spec, 6)
    tau = np.linspace(-3.0, 5.0, m.NU)
    calls = {
        "dynamics": (s.X, s.V), "M": (s.X,), "Z": (s.X, s.V), "energy": (s.X, s.V),
        "inverse_dynamics": (s.X, s.V, s.A, s.wrench), "leg_reactions": (s.X, s.V, s.A, s.wrench),
        "forward_dynamics": (s.X, s.V, tau, s.wrench), "motor_rates": (s.X, s.V),
        "motor_torques": (s.X, s.V, s.A, tau), "momentum": (s.X, s.V),
    }  # fmt: skip
    for name_, given in calls.items():
        more = {"wrench": given[-1]} if given[-1] is s.wrench else {}
        wanted = getattr(m, name_)(*(given[:-1] if more else given), **more)
        wanted = wanted if isinstance(wanted, tuple) else (wanted,)
        found, status = library.single(name_, *given)
        many, codes = library.batch(name_, *(np.tile(v, (9, 1)) for v in given))
        assert status == 0
        assert not codes.any()
        for a, rows, b in zip(found, many, wanted, strict=True):
            close = {"rtol": 0, "atol": 1e-10 * np.abs(b).max()}
            np.testing.assert_allclose(np.reshape(a, np.shape(b)), b, **close)
            np.testing.assert_allclose(rows, np.tile(np.ravel(b), (9, 1)), **close)


def test_singular_parameters_are_refused() -> None:
    p = module(coupled("planar_3rpr")).Parameters()
    with pytest.raises(ValueError, match="coupling must have an inverse"):
        p.replace(coupling=np.ones((3, 3)))
    with pytest.raises(ValueError, match=r"coupling has shape \(2, 2\), expected \(3, 3\)"):
        p.replace(coupling=np.eye(2))


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ([[1.0, 0.0], [0.0, 1.0]], "coupling: 2 rows; expected 3 rows of 3 numbers"),
        ([[1.0, 0.0, 0.0]] * 3, "coupling: the matrix is singular"),
        ([[1.0, 0.0, 0.0], [0.0, 1.0], [0.0, 0.0, 1.0]], "coupling\\[1\\]: "),
        ([[1.0, 0.0, 0.0], [0.0, 1.0, "x"], [0.0, 0.0, 1.0]], "coupling\\[1\\]\\[2\\]: "),
        (1.0, "coupling: "),
        (np.zeros((3, 3)).tolist(), "the matrix is singular"),
    ],
)
def test_what_is_refused(value: Any, said: str) -> None:
    form = to_full_form(catalogue("planar_3rpr"))
    with pytest.raises(SpecError, match=said):
        from_mapping(form | {"coupling": value}, "spec")


def test_the_full_form_has_it() -> None:
    form = to_full_form(catalogue("planar_3rpr"))
    assert "coupling" not in form
    assert from_mapping(form | {"coupling": False}, "spec") == catalogue("planar_3rpr")
    rows = [[1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.0, 0.0, -2.0]]
    made = from_mapping(form | {"coupling": rows}, "spec")
    assert to_full_form(made)["coupling"] == rows
    passive = form | {"legs": [leg | {"joints": [j | {"actuated": False} for j in leg["joints"]]}
                               for leg in form["legs"]]}  # type: ignore[operator, attr-defined]  # fmt: skip
    with pytest.raises(SpecError, match=r"coupling: .* no joint is actuated"):
        from_mapping(passive | {"coupling": rows}, "spec")
