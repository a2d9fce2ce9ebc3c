"""Every guard compares quantities of one dimension: the same mechanism, larger or smaller.

Lengths are multiplied, masses and times stay. The ratio of a tested value to its scale may not
change, neither may a verdict; results are those of the original, times a power of the factor.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from pne_sym import manipulators
from pne_sym.backends.bundle import Bundle
from pne_sym.model.manipulator import Manipulator
from tests.mechanics.structures import drawn
from tests.models import bundle, catalogue, module, state_at
from tests.scaling import lengths
from tests.scaling.guards import checks_at
from tests.whole.cases import Array

FACTORS = (1e3, 1e-3)
DRAWN = ("one slide, universal at the platform", "cylindrical at the base", "three slides")
STATES = 3


def states(made: Bundle) -> dict[str, Array]:
    """Some closed states."""
    found = [state_at(made.manipulator, seed) for seed in range(STATES)]
    return {n: np.array([getattr(s, n) for s in found]) for n in ("X", "V", "A", "q")}


def changed_ratios(made: Bundle, factor: float) -> Iterator[str]:
    """Guards whose value over scale is not what it was."""
    vectors = states(made)
    small = checks_at(made, lengths.parameters(made, 1.0), vectors)
    large = checks_at(made, lengths.parameters(made, factor), lengths.scaled(made, vectors, factor))
    for one, other in zip(small, large, strict=True):
        if one.check.trouble == "singular":
            a, b = one.value * other.scale, other.value * one.scale
            if not np.all(np.abs(a - b) <= 1e-6 * np.abs(a)):
                yield f"{one.function}, {one.check.equation}: {one.check.value}"


@pytest.mark.parametrize("name", manipulators.names())
def test_guards_of_the_catalogue(name: str) -> None:
    made = bundle(catalogue(name))
    for factor in FACTORS:
        assert not list(changed_ratios(made, factor))


@pytest.mark.parametrize("name", DRAWN)
def test_guards_of_other_structures(name: str) -> None:
    made = bundle(drawn(name))
    for factor in FACTORS:
        assert not list(changed_ratios(made, factor))


def near(spec: Manipulator, X: Array, rng: np.random.Generator) -> Array:
    """Poses around those given, some of them where a leg is almost of no length."""
    poses = np.repeat(X, 8, axis=0)
    poses += 10.0 ** rng.uniform(-9.0, 0.0, (len(poses), 1)) * rng.uniform(-1.0, 1.0, poses.shape)
    if spec.space in ("spatial", "planar", "translational"):
        leg = spec.legs[0]
        apart = np.array(leg.base_point) - np.array(leg.platform_point)
        places = 2 if spec.space == "planar" else 3
        poses[::8] = 0.0
        poses[::8, :places] = apart[:places] + 10.0 ** rng.uniform(-9.0, -5.0, (len(X), 1))
        poses[::8, 6:7] = 1.0
    return poses


@pytest.mark.parametrize("factor", FACTORS)
@pytest.mark.parametrize("name", manipulators.names())
def test_verdicts_and_results(name: str, factor: float) -> None:
    """The condition, its status, M, Z and H at ordinary and at nearly singular poses."""
    made, model = bundle(catalogue(name)), module(catalogue(name))
    rng, drawn_states = np.random.default_rng(0), states(made)
    X = near(made.manipulator, drawn_states["X"], rng)
    q0 = {"q": np.repeat(drawn_states["q"], 8, axis=0)}
    V = rng.uniform(-1.0, 1.0, (len(X), model.NV))
    p, large = (model.Parameters(**lengths.parameters(made, f)) for f in (1.0, factor))
    other = lengths.scaled(made, {"X": X, "V": V, **q0}, factor)
    numeric = not all(t.is_closed for t in made.derivation.leg_types)
    guess, guess_large = ({"q0": s["q"]} if numeric else {} for s in (q0, other))
    if numeric:  # steps of the iteration are at most half a metre, and end at 1e-11 m
        guess["q0"] = model.inverse_kinematics(X, p, **guess)
        good = np.isfinite(guess["q0"]).all(axis=1)
        assert good.sum() > STATES
        X, V, guess = X[good], V[good], {"q0": guess["q0"][good]}
        other = lengths.scaled(made, {"X": X, "V": V, "q": guess["q0"]}, factor)
        guess_large = {"q0": other["q"]}
    sigma, legs, status = model.condition(X, p, **guess)
    sigma_large, legs_large, status_large = model.condition(other["X"], large, **guess_large)
    assert np.array_equal(status, status_large)
    assert (status == 0).sum() > STATES
    np.testing.assert_allclose(legs_large, legs, rtol=1e-5)
    rows, columns = lengths.force_powers(made), lengths.actuator_powers(made)
    if len(set(columns)) == 1:
        scale = factor ** (1.0 - columns[0])
        np.testing.assert_allclose(sigma_large, scale * sigma, rtol=1e-6, atol=1e-9 * scale)
    for name_, small, big, powers in (
        ("H", model.H(X, p, **guess), model.H(other["X"], large, **guess_large),
         rows[:, None] - columns),
        ("M", model.M(X, p, **guess), model.M(other["X"], large, **guess_large),
         rows[:, None] - lengths.rate_powers(made)),
        ("Z", model.Z(X, V, p, **guess), model.Z(other["X"], other["V"], large, **guess_large),
         rows),
    ):  # fmt: skip
        back = big / factor ** powers.astype(float)
        assert np.array_equal(np.isnan(back), np.isnan(small)), name_
        good = status == 0  # what M, Z, H and inverse dynamics all accept
        size = np.max(np.abs(small[good]).reshape(good.sum(), -1), axis=1)
        off = np.max(np.abs(back - small)[good].reshape(good.sum(), -1), axis=1)
        assert (off <= 1e-12 / legs[good].min(axis=1) ** 2 * size).all(), name_
