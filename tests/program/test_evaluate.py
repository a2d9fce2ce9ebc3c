"""The interpreter against the generated NumPy module, function by function, and C's statuses."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy as sp

from pne_sym.model.manipulator import Manipulator
from pne_sym.program.evaluate import Status, evaluate, prepare, value_of
from pne_sym.program.iteration import close_loops
from pne_sym.program.linear import PIVOT, least_pivot, solve
from tests import models
from tests.backends.c_library import QUICK, Array, CLibrary

STATES = 13
TOLERANCE = 1e-13
ENTRIES = (
    "stewart",
    "hexapod_6x6r",  # iterated
    "stewart_sps",  # extra coordinates
    "hybrid_3rrrs_redundant",
    "tripod_3rps",  # constrained
    "hexapod_6ucu",  # moments
    "hexapod_6uhs",
    "planar_mixed",
    "fivebar_revolute",
    "spherical_3ups",
    "delta",
)
DRAWN = ("planar_3rrr", "translational_pprhu_rr", "spatial_2rr_2hr")
"""Iterated as well: other numbers of conditions and unknowns, closed legs beside."""


def model_of(name: str) -> Manipulator:
    return models.drawn(name) if name in DRAWN else models.catalogue(name)


def states_near_home(name: str) -> dict[str, Array]:
    """States around home; as many go into a batch of the module."""
    manipulator, rng = model_of(name), np.random.default_rng(3)
    m, home = models.module(manipulator), manipulator.home
    return {
        "X": np.array(home.X) + 2e-3 * rng.uniform(-1.0, 1.0, (STATES, m.NQ)),
        "V": rng.uniform(-1.0, 1.0, (STATES, m.NV)),
        "A": rng.uniform(-5.0, 5.0, (STATES, m.NV)),
        "q": np.array(home.q) + 2e-3 * rng.uniform(-1.0, 1.0, (STATES, m.NJ)),
    }


def prepared(name: str) -> dict[str, Array]:
    compiled = models.bundle(model_of(name))
    return prepare(compiled.program, compiled.derivation.parameters.values())


def of_module(name: str, function: str, vectors: dict[str, Array]) -> list[Array]:
    m, program = models.module(model_of(name)), models.bundle(model_of(name)).program
    of_program = program.functions[function]
    if function == "condition":  # it is judged: values are there in impossible states too
        given = [vectors[v].T for v in of_program.inputs]
        mode = m._Judged(m._DEFAULT, given[0].shape[1])
        return [
            np.moveaxis(a, -1, 0) for a in mode.run(m._run_condition, of_program.arrays, *given)
        ]
    return models.run(m, function, of_program.arrays, *(vectors[v] for v in of_program.inputs))


@pytest.mark.parametrize("name", [*ENTRIES, *DRAWN])
def test_every_function_is_the_module_s(name: str) -> None:
    program, vectors = models.bundle(model_of(name)).program, states_near_home(name)
    values, few = prepared(name), {n: v[:2] for n, v in vectors.items()}
    for function in program.functions:
        for given in (vectors, few):  # arrays in the module, and floats
            mine = evaluate(program, function, values, given)
            assert (mine.status == Status.OK).all(), (function, mine.failures)
            theirs = of_module(name, function, given)
            for found, wanted in zip(mine.outputs.values(), theirs, strict=True):
                assert found.shape == wanted.shape
                scale = np.abs(wanted).max(initial=0.0) or 1.0
                assert np.abs(found - wanted).max(initial=0.0) <= TOLERANCE * scale, function


@pytest.mark.parametrize("name", ["hexapod_6x6r", *DRAWN])
def test_closures_are_the_module_s(name: str) -> None:
    manipulator, vectors = model_of(name), states_near_home(name)
    vectors["X"][3] = 1e3  # out of reach
    vectors["X"][5, 0] = np.nan
    vectors["q"][7, 1] = np.inf
    program, values = models.bundle(manipulator).program, prepared(name)
    found, converged = close_loops(program, values, vectors["X"], vectors["q"])
    m = models.module(manipulator)
    wanted = models.closed(m, vectors["X"], vectors["q"])
    iterated = [j for closure in program.closures for j in closure.places]
    np.testing.assert_array_equal(converged, np.isfinite(wanted).all(axis=1))
    assert converged.sum() == STATES - 3
    np.testing.assert_allclose(
        found[converged][:, iterated], wanted[converged][:, iterated], rtol=0, atol=1e-11
    )


def hostile(name: str) -> dict[str, Array]:
    """Ordinary states, then all kinds of impossible ones."""
    vectors = states_near_home(name)
    X, home = vectors["X"], np.array(model_of(name).home.X)
    X[1, 0] = np.nan
    X[2, -1] = -np.inf
    X[3] *= 1e155
    X[4] = 0.0
    X[5, :2] += 50.0
    X[6, :2] += 1e5
    X[7] *= 1e-170
    X[8] = home
    X[9, 0] += 1e200
    vectors["V"][10] = 1e200
    vectors["V"][11, 0] = np.inf
    leg, platform = model_of(name).legs[0], models.module(model_of(name))
    turn = platform.rotation(home) if hasattr(platform, "rotation") else np.eye(2)
    X[12] = home
    meet = leg.base_point[: len(turn)] - turn @ np.array(leg.platform_point[: len(turn)])
    X[12, : len(turn)] = meet
    return vectors


STATUSES = {
    "stewart": {Status.OK, Status.SINGULAR, Status.INVALID},
    "tripod_3rps": {Status.OK, Status.SINGULAR, Status.INVALID},
    "planar_3rpr": {Status.OK, Status.SINGULAR, Status.INVALID},
    "fivebar_revolute": {Status.OK, Status.UNREACHABLE, Status.INVALID},
}


@pytest.mark.parametrize("name", STATUSES)
def test_statuses_are_those_of_c(name: str, tmp_path: Path) -> None:
    compiled = models.bundle(models.catalogue(name))
    library = CLibrary(compiled, tmp_path, flags=QUICK)
    vectors, values, seen = hostile(name), prepared(name), set[int]()
    for function, of_program in compiled.program.functions.items():
        if function not in library.api:
            continue
        given = [vectors[i.name] for i in library.api[function].inputs]
        outputs, status = library.batch(function, *given)
        mine = evaluate(compiled.program, function, values, vectors)
        np.testing.assert_array_equal(mine.status, status, function)
        for array, found in zip(of_program.arrays, outputs, strict=False):
            known = np.isfinite(mine.outputs[array]).reshape(STATES, -1).all(axis=1)
            np.testing.assert_array_equal(known, status == Status.OK)
            np.testing.assert_array_equal(np.isfinite(found).all(axis=1), known)
        seen |= set(status.tolist())
    assert seen == STATUSES[name]


def test_guards_that_fail_are_named() -> None:
    """By equation, by leg: platform joint 3 on its base joint."""
    name = "planar_3rpr"
    manipulator, values = models.catalogue(name), prepared(name)
    X = np.tile(manipulator.home.X, (2, 1))
    turn = np.array([[np.cos(X[0, 2]), -np.sin(X[0, 2])], [np.sin(X[0, 2]), np.cos(X[0, 2])]])
    leg = manipulator.legs[2]
    X[1, :2] = np.array(leg.base_point[:2]) - turn @ np.array(leg.platform_point[:2])
    found = evaluate(models.bundle(manipulator).program, "M", values, {"X": X})
    assert found.status.tolist() == [Status.OK, Status.SINGULAR]
    assert np.isnan(found.outputs["M"][1]).all()
    assert np.isfinite(found.outputs["M"][0]).all()
    (failure, *_) = found.failures
    assert failure.check.equation.startswith(failure.leg_type)
    np.testing.assert_array_equal(failure.failed, [[False, False], [False, False], [False, True]])


@pytest.mark.parametrize("gap", [1e-10, 1e-6, 1e-3])
def test_legs_are_measured_by_their_length(gap: float) -> None:
    """The guard is on the square of a distance, and so is its tolerance."""
    name = "planar_3rpr"
    manipulator, values = models.catalogue(name), prepared(name)
    X, leg = np.array([manipulator.home.X]), manipulator.legs[0]
    c, s = np.cos(X[0, 2]), np.sin(X[0, 2])
    turn = np.array([[c, -s], [s, c]])
    X[0, :2] = np.array(leg.base_point[:2]) - turn @ np.array(leg.platform_point[:2])
    X[0, 0] += gap
    found = evaluate(models.bundle(manipulator).program, "M", values, {"X": X})
    assert found.status.tolist() == [Status.SINGULAR if gap < 1e-9 else Status.OK]
    m = models.module(manipulator)
    for M in (m.M(X[0]), m.M(np.tile(X, (20, 1)))):  # in floats, in arrays
        assert np.isfinite(M).all() == (gap > 1e-9)


def test_expressions() -> None:
    x, y = sp.symbols("x y", real=True)
    at: dict[str, Any] = {"x": np.array([0.3, 4.0]), "y": np.array([2.0, -0.5])}
    for expr in (
        sp.Integer(3),
        sp.Rational(1, 3),
        sp.Float(0.1),
        -x,
        x / y,
        1 / (x + y),
        x**3 * y / 3,
        sp.sqrt(x) * y,
        1 / sp.sqrt(x),
        x**-2,
        sp.sin(x) - sp.cos(y) + sp.atan2(y, x),
    ):
        wanted = [float(expr.subs({x: a, y: b})) for a, b in zip(at["x"], at["y"], strict=True)]
        np.testing.assert_allclose(np.broadcast_to(value_of(expr, at), 2), wanted, rtol=1e-15)
    for outside in (sp.exp(x), x**y, sp.cbrt(x)):
        with pytest.raises(TypeError):
            value_of(outside, at)


def test_linear_equations() -> None:
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=(5, 4, 4)), rng.normal(size=(5, 4))
    np.testing.assert_allclose(np.einsum("kij,kj->ki", a, solve(a, b)), b, atol=1e-12)
    a[2, 3] = a[2, 0] - 2.0 * a[2, 1]
    a[3] = 0.0
    assert np.isnan(solve(a, b)).any(axis=1).tolist() == [False, False, True, True, False]
    np.testing.assert_array_equal(least_pivot(a) > PIVOT, [True, True, False, False, True])
    np.testing.assert_allclose(solve(1e200 * a[:1], 1e200 * b[:1]), solve(a[:1], b[:1]))
