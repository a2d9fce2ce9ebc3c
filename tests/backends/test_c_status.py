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
    QUICK,
    SINGULAR,
    UNREACHABLE,
    Array,
    CLibrary,
)

STATES = 19


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


LENGTHS = (1e-324, 1e-161, 1e-155, 9e-155, 1.2e-154, 1e-100, 1e-30, 1e30, 1.2e154, 1.5e154, 1e200)
"""Of quaternions; their squares are numbers with all digits from 1.1e-154 to 1.3e154."""


def test_length_of_quaternions(stewart: Case) -> None:
    """The same lengths are INVALID in both codes, in all functions of the model."""
    direction = np.array([0.1, 0.05, -0.08, 0.99])
    direction /= np.linalg.norm(direction)
    X = np.resize(stewart.given["X"], (len(LENGTHS), 7))
    X[:, 3:] = np.array(LENGTHS)[:, None] * direction
    fine = (np.array(LENGTHS) > 1.1e-154) & (np.array(LENGTHS) < 1.34e154)
    for function in ("M", "H", "inverse_kinematics", "dynamics", "forward_dynamics"):
        arguments = [i.name for i in stewart.library.api[function].inputs]
        some = {**{n: np.resize(stewart.given[n], (len(LENGTHS), 6)) for n in arguments}, "X": X}
        found, status = stewart.library.batch(function, *(some[n] for n in arguments))
        assert status.tolist() == np.where(fine, OK, INVALID).tolist()
        unit = {**some, "X": np.where(np.arange(7) < 3, X, [0.0, 0.0, 0.0, *direction])}
        made = getattr(stewart.module, function)(**unit)
        own = getattr(stewart.module, function)(**some)
        single = [
            getattr(stewart.module, function)(**{n: some[n][k] for n in arguments})
            for k in range(len(LENGTHS))
        ]
        for n, array in enumerate(found):
            want = (made if isinstance(made, tuple) else (made,))[n].reshape(len(LENGTHS), -1)
            mine = (own if isinstance(own, tuple) else (own,))[n].reshape(len(LENGTHS), -1)
            one = np.array([np.ravel((s if isinstance(s, tuple) else (s,))[n]) for s in single])
            for got in (array, mine, one):
                np.testing.assert_array_equal(np.isnan(got).all(axis=1), ~fine)
                assert np.abs(got - want)[fine].max() < 1e-12 * np.abs(want).max()


@pytest.mark.parametrize("real", ["double", "float", "long double"])
def test_rotation_is_orthogonal(real: str, tmp_path: Path) -> None:
    """Quaternions are scaled before they are squared: in C as in NumPy, whatever the length."""
    manipulator = models.catalogue("spherical_3ups")
    library = CLibrary(models.bundle(manipulator), tmp_path, real, flags=QUICK)
    about = np.finfo(library.real)
    rng, most = np.random.default_rng(4), 0.49 * int(np.log10(about.max))
    q = rng.normal(size=(2000, 4)).astype(library.real)
    lengths = rng.uniform(float(np.log10(about.tiny)), most, (len(q), 1))
    q *= library.real.type(10.0) ** lengths.astype(library.real)
    R = library.batch("rotation", q)[0][0].reshape(-1, 3, 3)
    error = np.abs(R @ np.swapaxes(R, 1, 2) - np.eye(3)).max()
    assert error < 5 * about.eps
    tiny = np.zeros((2, 4), library.real)
    tiny[0, 1] = about.smallest_subnormal
    found, status = library.batch("rotation", tiny)
    assert status.tolist() == [OK, INVALID]
    np.testing.assert_array_equal(found[0][0], np.diag([-1.0, 1.0, -1.0]).reshape(-1))


@pytest.mark.parametrize("name", ["stewart", "planar_3rrr", "spherical_3ups"])
def test_poses_of_what_is_no_rotation(name: str, tmp_path: Path) -> None:
    """INVALID in C where the NumPy module raises ValueError: to 1e-6."""
    manipulator = models.catalogue(name)
    module = models.module(manipulator)
    library = CLibrary(models.bundle(manipulator), tmp_path, flags=QUICK)
    good = np.asarray(module.rotation(module.HOME_X))
    n, rng = len(good), np.random.default_rng(6)
    t = np.zeros(library.api["pose"].inputs[0].size)
    skewed = np.eye(n)
    skewed[1, 0] = 1.0
    flipped = np.diag([*[1.0] * (n - 1), -1.0])
    for off, fine in ((0.0, True), (0.999e-6, True), (1.001e-6, False)):
        for R in (good * np.sqrt(1.0 + off), (np.eye(n) + off * (skewed - np.eye(n))) @ good):
            assert refused(module, library, t, R) == (not fine, OK if fine else INVALID)
    swapped = good[[1, 0, *range(2, n)]]
    for R in (0.0 * good, swapped, flipped, 2.0 * good, skewed, rng.normal(size=(n, n))):
        assert refused(module, library, t, R) == (True, INVALID)
    R = good.copy()
    R[0, 1] = np.nan
    assert refused(module, library, t, R) == (False, INVALID)
    assert np.isnan(module.pose(t, R)).all()


def refused(module: Any, library: CLibrary, t: Array, R: Array) -> tuple[bool, int]:
    """Whether NumPy raises an error, and the status in C."""
    outputs, status = library.single("pose", t, R)
    assert np.isnan(outputs[0]).all() == np.isnan(outputs[0]).any() == (status != OK)
    try:
        module.pose(t, R)
    except ValueError as error:
        assert "pose: R is no rotation matrix" in str(error)  # noqa: PT017
        return True, status
    return False, status


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


def test_singular_actuators_concern_inverse_dynamics_only(planar: Case) -> None:
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
