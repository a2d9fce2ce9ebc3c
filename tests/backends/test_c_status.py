"""What the generated C says of impossible states and parameters; other precisions; sanitizers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pne_sym.model.manipulator import Manipulator
from tests import models
from tests.backends.c_agreement import vectors
from tests.backends.c_library import (
    INVALID,
    NOT_CONVERGED,
    OK,
    SINGULAR,
    UNREACHABLE,
    Array,
    CLibrary,
)

STATES = 19
QUICK = ("-O0",)


def near_home(manipulator: Manipulator) -> dict[str, Array]:
    home = manipulator.home
    X, q = np.array(home.X), np.array(home.q)
    return vectors(models.module(manipulator), X, q, STATES, np.random.default_rng(2))


class Case:
    """A model of the catalogue, compiled, with inputs near home."""

    def __init__(self, name: str, folder: Path) -> None:
        self.manipulator = models.catalogue(name)
        self.module = models.module(self.manipulator)
        self.library = CLibrary(models.bundle(self.manipulator), folder, flags=QUICK)
        self.given = near_home(self.manipulator)

    def batch(self, function: str, **changed: Array | None) -> tuple[list[Array], Array]:
        api = self.library.api[function]
        given: dict[str, Any] = {**self.given, **changed}
        return self.library.batch(function, *(given[i.name] for i in api.inputs))

    def statuses(self, function: str, **changed: Array | None) -> list[int]:
        """Of a batch; those of single states are the same, and NaN stands where one failed."""
        api = self.library.api[function]
        given: dict[str, Any] = {**self.given, **changed}
        outputs, status = self.batch(function, **changed)
        for output in outputs:
            np.testing.assert_array_equal(np.isnan(output).all(axis=1), status != OK)
            np.testing.assert_array_equal(np.isnan(output).any(axis=1), status != OK)
        for k in range(STATES):
            inputs = [None if given[i.name] is None else given[i.name][k] for i in api.inputs]
            assert self.library.single(function, *inputs)[1] == status[k]
        return [int(code) for code in status]


@pytest.fixture(scope="module")
def stewart(tmp_path_factory: pytest.TempPathFactory) -> Case:
    return Case("stewart", tmp_path_factory.mktemp("stewart"))


@pytest.fixture(scope="module")
def planar(tmp_path_factory: pytest.TempPathFactory) -> Case:
    return Case("planar_3rrr", tmp_path_factory.mktemp("planar"))


def expected(**codes: int) -> list[int]:
    """OK but for some states, such as s3=INVALID."""
    return [codes.get(f"s{k}", OK) for k in range(STATES)]


@pytest.mark.parametrize("function", ["M", "dynamics", "inverse_dynamics", "leg_reactions"])
def test_input_that_is_not_finite(stewart: Case, function: str) -> None:
    good, _ = stewart.batch(function)
    X = stewart.given["X"].copy()
    X[3, 0], X[7, 4], X[8, 2], X[18, 1] = np.nan, np.inf, -np.inf, np.nan
    X[12, 3:7] = 0.0  # no quaternion
    X[13, 3:7] *= 1e160  # its squared length overflows
    X[14, 3:7] *= 1e150
    bad = {f"s{k}": INVALID for k in (3, 7, 8, 12, 13, 18)}
    assert stewart.statuses(function, X=X) == expected(**bad)
    found, status = stewart.batch(function, X=X)
    for array, whole in zip(found, good, strict=True):
        same = (status == OK) & (np.arange(STATES) != 14)
        np.testing.assert_array_equal(array[same], whole[same])
        np.testing.assert_allclose(array[14], whole[14], rtol=1e-9, atol=1e-9 * np.abs(whole).max())


@pytest.mark.parametrize("name", ["V", "A", "wrench"])
def test_other_input_that_is_not_finite(stewart: Case, name: str) -> None:
    value = stewart.given[name].copy()
    value[11, 2] = np.nan
    assert stewart.statuses("inverse_dynamics", **{name: value}) == expected(s11=INVALID)


def test_no_wrench(stewart: Case) -> None:
    none, status = stewart.batch("inverse_dynamics", wrench=None)
    zero, _ = stewart.batch("inverse_dynamics", wrench=np.zeros((STATES, 6)))
    assert (status == OK).all()
    np.testing.assert_array_equal(none[0], zero[0])


def test_overflow(stewart: Case) -> None:
    V = stewart.given["V"].copy()
    V[4] = 1e200
    assert stewart.statuses("Z", V=V) == expected(s4=INVALID)


def test_unreachable(planar: Case) -> None:
    X = planar.given["X"].copy()
    X[[2, 17], 0] += 50.0
    for function in ("M", "inverse_kinematics", "inverse_dynamics", "energy"):
        found = planar.statuses(function, X=X)
        assert found == expected(s2=UNREACHABLE, s17=UNREACHABLE)


def test_singular_leg(stewart: Case) -> None:
    p = stewart.module.Parameters()
    X = stewart.given["X"].copy()
    X[5] = [*(p.ups_base_point[0] - p.ups_platform_point[0]), 0.0, 0.0, 0.0, 1.0]  # length zero
    assert stewart.statuses("H", X=X) == expected(s5=SINGULAR)


def test_singular_drives_concern_inverse_dynamics_only(planar: Case) -> None:
    """Connection points that coincide: three forces through a point hold no moment."""
    p = planar.module.Parameters()
    name = next(f.name for f in planar.library.fields if f.name.endswith("platform_point"))
    points = np.tile(getattr(p, name)[0], (3, 1))
    base = next(f.name for f in planar.library.fields if f.name.endswith("base_point"))
    q = p.replace(**{name: points, base: getattr(p, base) - getattr(p, name) + points})
    assert planar.library.prepare(planar.library.parameters(q)) == OK
    try:
        for function in ("M", "Z", "H", "dynamics", "forward_dynamics", "inverse_kinematics"):
            assert planar.statuses(function) == [OK] * STATES
        for function in ("inverse_dynamics", "leg_reactions"):
            assert planar.statuses(function) == [SINGULAR] * STATES
    finally:
        assert planar.library.prepare(planar.library.defaults) == OK


def test_no_convergence_of_the_pose(planar: Case) -> None:
    """Driven cranks folded inward: no pose connects their ends."""
    q = planar.given["q_actuated"].copy()
    q[1] += [2.0, -2.0, 2.5]
    want = planar.module.forward_kinematics(q, planar.given["X0"])
    found = planar.statuses("forward_kinematics", q_actuated=q)
    np.testing.assert_array_equal(np.array(found) != OK, np.isnan(want).any(axis=1))
    assert found == expected(s1=NOT_CONVERGED)


def test_parameters_that_are_refused(stewart: Case) -> None:
    """Then the model is all NaN, so that later calls fail as well."""
    library, p = stewart.library, stewart.module.Parameters()
    good = library.parameters(p)
    starts = np.cumsum([0] + [int(np.prod(f.shape, dtype=int)) for f in library.fields])
    where = {f.name: int(start) for f, start in zip(library.fields, starts, strict=False)}
    skewed = where["platform_inertia"] + 1
    for index, value in (
        (where["platform_mass"], -1.0),
        (where["platform_mass"], np.nan),
        (where["gravity"] + 2, np.inf),
        (skewed, good[skewed] + 0.5),
        (where["ups_base_frame"] + 4, -1.0),
    ):
        bad = good.copy()
        bad[index] = value
        assert library.prepare(bad) == INVALID
        for function in ("M", "inverse_dynamics", "energy"):
            assert OK not in stewart.statuses(function)
    assert library.prepare(good) == OK
    assert stewart.statuses("inverse_dynamics") == [OK] * STATES


def test_zeros_of_the_structure(planar: Case) -> None:
    case = planar
    good, start = case.library.defaults, 0
    zeros = 0
    for field in case.library.fields:
        for zero in field.zeros:
            bad = good.copy()
            bad[start + zero] = 0.25
            assert case.library.prepare(bad) == INVALID, field.name
            zeros += 1
        start += int(np.prod(field.shape, dtype=int))
    assert zeros > 0
    assert case.library.prepare(good) == OK


@pytest.mark.parametrize("name", ["stewart", "tripod_3rps", "fivebar_redundant"])
def test_float_and_long_double(name: str, tmp_path: Path) -> None:
    manipulator = models.catalogue(name)
    module, given = models.module(manipulator), near_home(manipulator)
    bundle = models.bundle(manipulator)
    for real, tolerance in (("float", 2e-4), ("long double", 1e-12)):
        library = CLibrary(bundle, tmp_path, real, flags=QUICK)
        assert library.status == OK
        for function in ("M", "Z", "H", "inverse_dynamics", "forward_dynamics", "leg_reactions"):
            inputs = {i.name: given[i.name] for i in library.api[function].inputs}
            found, status = library.batch(function, *inputs.values())
            assert (status == OK).all()
            made = getattr(module, function)(**inputs)
            for got, want in zip(found, made if isinstance(made, tuple) else (made,), strict=True):
                flat = want.reshape(STATES, -1)
                assert np.abs(got - flat).max() < tolerance * np.abs(flat).max(), function
