"""Forces of actuators within bounds, what they reach, and how near a pose is to singularities.

Compared with linear programs and optimality conditions that SciPy solves, made of M, Z, H, Hk and
the limits of the specification alone.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.optimize import linprog, nnls

from pne_sym.lowering.program import lower
from pne_sym.mechanics.derive import derive
from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import checked
from pne_sym.program.distribution import factors, nearest
from pne_sym.program.evaluate import Status
from tests.backends.c_library import CLibrary
from tests.models import bundle, catalogue, live_parameters, module
from tests.octave.conformance import conforms, octave
from tests.program.test_public import interpreter
from tests.program.test_public import states as arguments
from tests.random.drawing import draw
from tests.random.effects import with_efforts
from tests.robots.test_robots import robot
from tests.sampling import sampled

Array = Any
REDUNDANT = ("planar_4rpr", "fivebar_redundant", "quadrupod", "stewart_7ups", "planar_redundant")


@cache
def limited(name: str, every: int = 1, effort: float = 60.0) -> Manipulator:
    """An entry of the catalogue with limits of effort at one of so many actuators."""
    return checked(with_efforts(catalogue(name), every, effort))


def efforts(spec: Manipulator) -> Array:
    """Limits of all actuators, infinite where there is none."""
    joints = [joint for leg in spec.legs for joint in leg.joints if joint.actuated]
    return np.array([(j.limits.effort if j.limits else None) or np.inf for j in joints])


def near_home(m: Any, count: int, seed: int = 0) -> dict[str, Array]:
    rng = np.random.default_rng(seed)
    X = m.HOME_X + 5e-3 * rng.uniform(-1.0, 1.0, (count, m.NQ))
    X = m.project(X) if hasattr(m, "project") else X
    return {
        "X": X,
        "V": rng.uniform(-0.5, 0.5, (count, m.NV)),
        "A": rng.uniform(-1.0, 1.0, (count, m.NV)),
        "wrench": rng.uniform(-5.0, 5.0, (count, m.NW)),
    }


def equations(m: Any, given: dict[str, Array], k: int) -> tuple[Array, Array, Array]:
    """K [tau, lambda] = f at a state: K, f, M."""
    X, V, A, wrench = (given[n][k] for n in ("X", "V", "A", "wrench"))
    M, Z, H = m.dynamics(X, V)
    K = np.hstack((H, m.Hk(X))) if m.NC else H
    f = M @ A + Z
    f[: m.NW] -= wrench
    return K, f, M


# ---- forces within bounds ------------------------------------------------------------------------


@pytest.mark.parametrize("name", sampled(REDUNDANT, 3))
def test_forces_within_bounds(name: str) -> None:
    """They exist where a linear program says so, do what is asked, and no others are nearer."""
    m, found = module(catalogue(name)), {True: 0, False: 0}
    given, rng = near_home(m, 40), np.random.default_rng(1)
    middle = m.inverse_dynamics(**given)
    middle = middle[0] if m.NC else middle
    middle = middle + 20.0 * rng.normal(size=middle.shape)
    low, high = middle - rng.uniform(0, 40, middle.shape), middle + rng.uniform(0, 40, middle.shape)
    reference = middle + 60.0 * rng.normal(size=middle.shape)
    answers = m.force_distribution(
        *(given[n] for n in ("X", "V", "A")), low, high, wrench=given["wrench"], reference=reference
    )
    tau = answers[0] if m.NC else answers
    for k in range(len(tau)):
        K, f, _ = equations(m, given, k)
        bounds = [*zip(low[k], high[k], strict=True), *[(None, None)] * m.NC]
        is_possible = linprog(np.zeros(K.shape[1]), A_eq=K, b_eq=f, bounds=bounds).status == 0
        assert is_possible == np.isfinite(tau[k]).all(), k
        found[is_possible] += 1
        if is_possible:
            both = np.concatenate([tau[k], answers[1][k]]) if m.NC else tau[k]
            np.testing.assert_allclose(K @ both, f, atol=1e-9 * np.abs(f).max())
            assert (tau[k] >= low[k]).all()
            assert (tau[k] <= high[k]).all()
            assert_nearest(tau[k], reference[k], null_space(K)[: m.NU], low[k], high[k])
    assert min(found.values()) > 2, found


def assert_nearest(t: Array, reference: Array, free: Array, low: Array, high: Array) -> None:
    """The way to the reference is a sum of normals of bounds that are met, along what is free."""
    free = np.linalg.svd(free)[0][:, : free.shape[1]]
    wanted = free.T @ (t - reference)
    met = [np.eye(len(t))[t <= low + 1e-9], -np.eye(len(t))[t >= high - 1e-9]]
    normals = np.vstack(met) @ free
    left = nnls(normals.T, wanted)[1] if len(normals) else np.linalg.norm(wanted)
    assert left <= 1e-9 * np.linalg.norm(t - reference)


def test_least_norm_where_bounds_are_wide() -> None:
    m = module(catalogue("planar_4rpr"))
    given, wide = near_home(m, 3), np.full(4, 1e6)
    tau = m.force_distribution(*(given[n] for n in "XVA"), -wide, wide, wrench=given["wrench"])
    np.testing.assert_allclose(tau, m.inverse_dynamics(**given), atol=1e-9)


def test_bounds_that_leave_nothing() -> None:
    """Also lower ones above the upper; other states of a batch stay as they are."""
    m = module(catalogue("planar_4rpr"))
    given, high = near_home(m, 4), np.full((4, 4), 100.0)
    low = -high
    low[1], high[2] = 99.0, -101.0
    tau = m.force_distribution(*(given[n] for n in "XVA"), low, high)
    assert np.isnan(tau).all(axis=1).tolist() == [False, True, True, False]
    run = interpreter(catalogue("planar_4rpr"))
    told = run.call("force_distribution", X=given["X"], V=given["V"], A=given["A"], tau_min=low,
                    tau_max=high)  # fmt: skip
    assert told.status.tolist() == [Status.OK, Status.UNREACHABLE, Status.UNREACHABLE, Status.OK]


def test_cables_are_taut() -> None:
    """Eight cables, all pulled with 5 N at least, where a linear program finds such forces."""
    m = module(robot("cables"))
    rng = np.random.default_rng(2)
    X = m.HOME_X + rng.uniform(-1.0, 1.0, (20, 7)) * [1.2, 1.0, 0.7, 0.2, 0.2, 0.2, 0.0]
    still, low, high = np.zeros(6), np.full(8, -400.0), np.full(8, -5.0)
    tau = m.force_distribution(X, still, still, low, high)
    taut = np.isfinite(tau).all(axis=1)
    possible = [
        linprog(np.zeros(8), A_eq=m.H(x), b_eq=m.Z(x, still), bounds=(-400.0, -5.0)).status == 0
        for x in X
    ]
    assert taut.tolist() == possible
    assert 5 < taut.sum() < 20
    assert (tau[taut] <= -5.0).all()
    np.testing.assert_allclose(
        np.einsum("kij,kj->ki", m.H(X[taut]), tau[taut]), m.Z(X[taut], still), atol=1e-9
    )


def test_the_page_on_forces() -> None:
    """Its example of a robot on cables is true."""
    page = (Path(__file__).parents[2] / "docs/forces.md").read_text(encoding="utf-8")
    (text,) = re.findall(r"```python\n(import.*?)```", page, flags=re.DOTALL)
    lines = [
        line for line in text.splitlines() if "pne_sym" not in line and "import cables" not in line
    ]
    assert len(lines) > 8
    exec("\n".join(lines), {"cables": module(robot("cables"))})


def test_the_search_against_linear_programs() -> None:
    """Random bounds and spans of every dimension, also spans that leave forces alone."""
    seen = set()
    for seed in range(150):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(2, 10))
        r = int(rng.integers(1, n + 1))
        G = np.linalg.qr(rng.normal(size=(n, n)))[0][:, :r]
        G[rng.integers(n)] *= seed % 3 > 0
        p, d = 10.0 ** rng.integers(0, 3) * rng.normal(size=n), rng.normal(size=n)
        limit = rng.uniform(1.0, 100.0, n)
        kept = np.arange(n)[: n if seed % 4 else max(1, n - r)]
        A = np.hstack((G, d[:, None]))[kept]
        A, b = np.vstack((A, -A)), np.r_[(limit - p)[kept], (limit + p)[kept]]
        free, (gram, p, d, limit) = [(None, None)] * r, (
            (G @ G.T)[np.ix_(kept, kept)], p[kept], d[kept], limit[kept])  # fmt: skip
        t = nearest(np.column_stack((p, 0.0 * p)), gram, -limit, limit)
        assert (t is not None) == (linprog(np.zeros(r), A[:, :r], b, bounds=free).status == 0), seed
        between, ends = factors(p, d, gram, limit), []
        for sign in (1.0, -1.0):
            wanted = linprog([0.0] * r + [sign], A, b, bounds=[*free, (0.0, None)])
            ends.append(sign * wanted.fun if wanted.status == 0 else None)
        seen.add((t is None, between is None, ends[1] is None))
        if between is None:
            assert ends == [None, None], seed
        else:
            ends[1] = np.inf if ends[1] is None else ends[1]
            np.testing.assert_allclose(between, ends, rtol=1e-9, atol=1e-9, err_msg=str(seed))
    assert len(seen) >= 4, seen


# ---- what is reachable ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "every"),
    sampled([("planar_4rpr", 1), ("tripod_3rps", 1), ("quadrupod", 1), ("stewart", 1),
             ("planar_4rpr", 3), ("fivebar_redundant", 2), ("planar_3rpr", 2)], 0,
            [("planar_4rpr", 1), ("tripod_3rps", 1), ("planar_3rpr", 2)]),
)  # fmt: skip
def test_what_is_reachable(name: str, every: int) -> None:
    """Least and largest factor are those of linear programs; infinite, and none, included."""
    spec = limited(name, every, {"quadrupod": 600.0, "stewart": 2000.0}.get(name, 60.0))
    m, limits = module(spec), efforts(spec)
    given, rng = near_home(m, 25), np.random.default_rng(2)
    directions = rng.normal(size=(25, m.NV)), rng.normal(size=(25, m.NW))
    given["wrench"][5:] *= 10.0
    given["A"][12:] *= 10.0
    motion = (given[n] for n in "XVA")
    X, V, A = motion
    by_acceleration = m.reachable_acceleration(X, V, A, directions[0], wrench=given["wrench"])
    by_wrench = m.reachable_wrench(X, V, A, directions[1], wrench=given["wrench"])
    for k in range(len(X)):
        K, f, M = equations(m, given, k)
        forced = np.append(directions[1][k], np.zeros(m.NV - m.NW))
        for found, more in ((by_acceleration, M @ directions[0][k]), (by_wrench, -forced)):
            wanted = [program(K, f, more, limits, sign) for sign in (1.0, -1.0)]
            np.testing.assert_allclose(
                [v[k] for v in found], wanted, rtol=1e-8, atol=1e-8, err_msg=f"{name} {k}"
            )


def program(K: Array, f: Array, more: Array, limits: Array, sign: float) -> float:
    """The least (largest, where the sign is negative) s >= 0 with K [tau, lambda] = f + s more."""
    cost = np.append(np.zeros(K.shape[1]), sign)
    bounds = [(-e, e) for e in limits] + [(None, None)] * (K.shape[1] - len(limits)) + [(0, None)]
    found = linprog(cost, A_eq=np.hstack((K, -more[:, None])), b_eq=f, bounds=bounds)
    if found.status == 0:
        return sign * float(found.fun)
    feasible = linprog(0.0 * cost, A_eq=np.hstack((K, -more[:, None])), b_eq=f, bounds=bounds)
    return np.inf if feasible.status == 0 else np.nan


def test_limits_are_live_parameters() -> None:
    spec, wider = limited("planar_3rpr"), limited("planar_3rpr", effort=120.0)
    m, p = module(spec), live_parameters(spec, wider)
    X, still, way = m.HOME_X, np.zeros(3), np.array([1.0, 0.5, 0.1])
    assert p.rpr_joint2_effort.tolist() == [121.0, 122.0, 123.0]
    narrow, wide = (m.reachable_wrench(X, still, still, way, q)[1] for q in (m.Parameters(), p))
    assert wide > 1.5 * narrow
    assert wide == pytest.approx(module(wider).reachable_wrench(X, still, still, way)[1])
    with pytest.raises(ValueError, match="rpr_joint2_effort"):
        m.Parameters().replace(rpr_joint2_effort=[1.0, 0.0, 1.0])


def test_what_has_no_limits_costs_nothing() -> None:
    functions = {f.name for f in bundle(catalogue("planar_3rpr")).program.public}
    assert not functions & {"reachable_wrench", "reachable_acceleration", "force_distribution"}
    assert "effort_limits" not in bundle(catalogue("planar_4rpr")).program.functions


# ---- how near to singularities -------------------------------------------------------------------


@pytest.mark.parametrize("name", ["planar_3rpr", "tripod_3rps", "planar_4rpr", "planar_redundant"])
def test_manipulability(name: str) -> None:
    """Of forces on the motions that constraints leave, moments over a length."""
    m = module(catalogue(name))
    X = near_home(m, 3)["X"]
    measure, isotropy = m.manipulability(X)
    actuators, legs = m.singularity_distance(X)
    sigma, pivots, _ = (m.condition_constrained if m.NC else m.condition)(X)
    np.testing.assert_allclose(legs, pivots.min(axis=1))
    np.testing.assert_allclose(actuators, sigma[:, -1] / sigma[:, 0], rtol=1e-9)
    if m.NC:
        points = np.array([leg.platform_point for leg in catalogue(name).legs])
        length = np.sqrt(np.var(points, axis=0).sum())
        scale = np.array([1.0, 1.0, 1.0, *[1.0 / length] * 3])[:, None]
        held = [null_space((scale * m.Hk(x)).T).T @ (scale * m.H(x)) for x in X]
        sigma = np.linalg.svd(np.array(held), compute_uv=False)
    np.testing.assert_allclose(measure, sigma.prod(axis=1), rtol=1e-9)
    np.testing.assert_allclose(isotropy, sigma[:, -1] / sigma[:, 0], rtol=1e-9)


def test_of_actuators_that_move_nothing() -> None:
    """An actuated joint that the constraints hold: its number would be rounding, none is given."""
    derivation = derive(draw(50))
    c = derivation.coordinates
    assert c.actuation.rank == len(c.constraints) == 2
    assert c.actuators
    names = {f.name for f in lower(derivation).public}
    assert "singularity_distance" in names
    assert "manipulability" not in names


def test_at_singular_actuators() -> None:
    """The measure and the distance vanish with the least singular value; legs are as they were."""
    m = module(catalogue("planar_3rpr"))
    poses = m.HOME_X + np.array([0.0, 0.0, 1.0]) * np.linspace(-3.0, 3.0, 2001)[:, None]
    distance, _ = m.singularity_distance(poses)
    near = poses[np.nanargmin(distance)]
    assert m.singularity_distance(near)[0] < 2e-3 < m.singularity_distance(m.HOME_X)[0]
    assert m.manipulability(near)[0] < 1e-2 * m.manipulability(m.HOME_X)[0]
    assert m.singularity_distance(near)[1] > 0.1


# ---- all targets alike ---------------------------------------------------------------------------

ALIKE = (("planar_3rpr", 1), ("tripod_3rps", 1), ("planar_4rpr", 2), ("quadrupod", 1))


@pytest.mark.parametrize(("name", "every"), sampled(ALIKE, 0, ALIKE[::2]))
def test_c_is_the_interpreter(name: str, every: int, tmp_path: Path) -> None:
    """Values and statuses of states one by one and of batches, impossible ones among them."""
    spec = limited(name, every, 5e3)
    run, library = interpreter(spec), CLibrary(bundle(spec), tmp_path, flags=())
    given = {
        n: np.tile(v, (4, *[1] * (v.ndim - 1))) for n, v in arguments(spec, module(spec)).items()
    }
    given["X"][1], given["V"][2], given["A"][3:6] = np.nan, np.inf, 1e9
    given["tau_max"][7] = given["tau_min"][7] - 1.0
    seen = set()
    names = ("reachable_wrench", "reachable_acceleration", "force_distribution", "manipulability",
             "singularity_distance")  # fmt: skip
    for function in (f for f in library.api.values() if f.of.name in names):
        values = {i.name: given[i.name] for i in function.inputs}
        wanted = run.call(function.of.name, **values)
        found, status = library.batch(function.name, *values.values())
        np.testing.assert_array_equal(status, wanted.status, function.name)
        for array, output in zip(found, wanted.outputs, strict=True):
            np.testing.assert_allclose(array.reshape(output.shape), output, rtol=1e-9, atol=1e-8)
        seen |= set(status.tolist())
    assert seen == {Status.OK, Status.UNREACHABLE, Status.INVALID}


@pytest.mark.skipif(octave() is None, reason="octave-cli is not installed")
@pytest.mark.parametrize(("name", "every"), sampled(ALIKE, 0, ALIKE[2:3]))
def test_octave_is_numpy(name: str, every: int) -> None:
    conforms(limited(name, every, 5e3))
