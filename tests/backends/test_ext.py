"""Extension modules: the same as the NumPy modules, but for their speed."""

from __future__ import annotations

import copy
import inspect
import pickle
import sys
import threading
from array import array
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.backends.ext_module import assert_alike, assert_all_alike, pair
from tests.targets.modules import functions, vectors

SAMPLE = ("planar_3rpr", "planar_redundant", "tripod_3prs")
"""Square, redundant (weights, null space), constrained and iterated (q0)."""


@pytest.mark.parametrize("name", SAMPLE)
def test_values_are_those_of_numpy(name: str) -> None:
    assert_all_alike(name)


@pytest.mark.parametrize("name", SAMPLE)
def test_names_signatures_and_docstrings_are_those_of_numpy(name: str) -> None:
    e, m = pair(name)
    assert e.__all__ == m.__all__
    assert len(functions(e)) >= 15
    for function in functions(e):
        mine, theirs = (getattr(x, function) for x in (e, m))
        assert inspect.signature(mine) == inspect.signature(theirs), function
        assert mine.__doc__ == theirs.__doc__
    for constant in ("NQ", "NV", "NU", "NC", "NW", "NJ"):
        assert getattr(e, constant) == getattr(m, constant)
    for vector in ("HOME_X", "HOME_Q"):
        np.testing.assert_array_equal(getattr(e, vector), getattr(m, vector))
        assert not getattr(e, vector).flags.writeable


@pytest.mark.parametrize("name", SAMPLE)
def test_impossible_states_are_nan_in_their_rows(name: str) -> None:
    e, m = pair(name)
    given = vectors(m, 6)
    for k, bad in enumerate((np.nan, np.inf, 1e200, 50.0)):
        for vector in ("X", "X0"):
            given[vector][k, 0] = bad
    given["V"][4, -1] = np.nan
    for function in functions(e):
        assert_alike(name, function, given)
        for k in range(6):
            one = {n: v if n == "weights" else v[k] for n, v in given.items()}
            assert_alike(name, function, one)


@pytest.mark.parametrize("name", SAMPLE[1:])
@pytest.mark.parametrize("length", [None, 0.25])
def test_statuses_are_those_of_numpy(name: str, length: float | None) -> None:
    e, m = pair(name)
    X = np.tile(m.HOME_X, (4, 2, 1))
    X[0, 0, 0], X[1, 1, 0], X[2, 0, 0] = np.nan, 50.0, 1e200
    for x in (X, X[0, 0], X[1, 1], X[3, 0]):
        found, wanted = (each.condition(x, length=length) for each in (e, m))
        np.testing.assert_array_equal(found[-1], wanted[-1])
        assert (type(found[-1]), found[-1].dtype) == (type(wanted[-1]), wanted[-1].dtype)
        for a, b in zip(found, wanted, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-12)
    assert set(np.ravel(e.condition(X)[-1])) >= {0, 1, 3}


def within(before: bytes, x: Any) -> Any:
    """The same numbers in memory that begins with other bytes."""
    return np.frombuffer(before + x.tobytes(), offset=len(before)).reshape(x.shape)


KINDS: dict[str, Callable[[Any], Any]] = {
    "as it is": lambda x: x,
    "by columns": np.asfortranarray,
    "lists": np.ndarray.tolist,
    "other byte order": lambda x: x.astype(x.dtype.newbyteorder()),
    "with gaps": lambda x: np.repeat(x, 2, axis=-1)[..., ::2],
    "read only": lambda x: within(b"", x),
    "not aligned": lambda x: within(b"1", x),
    "integers": lambda x: np.round(x).astype(int),
    "single": lambda x: x.astype(np.float32),
    "with one more dimension": lambda x: x[None],
}


@pytest.mark.parametrize("lead", [(), (0,), (2, 3), (1, 1, 1)])
@pytest.mark.parametrize("kind", KINDS)
def test_arrays_of_any_kind_are_taken(lead: tuple[int, ...], kind: str) -> None:
    e, m = pair("planar_3rpr")
    rng, make = np.random.default_rng(3), KINDS[kind]
    X, V = m.HOME_X + 0.01 * rng.random((*lead, 3)), rng.random((*lead, 3))
    if not X.size and kind == "lists":
        return  # they do not tell their shape
    found, wanted = (each.dynamics(make(X), make(V)) for each in (e, m))
    for a, b in zip(found, wanted, strict=True):
        assert a.shape == b.shape
        np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-14)
        assert a.flags.writeable
        assert a.flags.owndata


def test_a_buffer_that_is_no_array_is_taken_as_numpy_takes_it() -> None:
    e, m = pair("planar_3rpr")
    x = array("d", m.HOME_X)
    np.testing.assert_array_equal(e.H(x), e.H(m.HOME_X))


OK = np.zeros(4)
BAD: list[tuple[str, tuple[Any, ...], dict[str, Any]]] = [
    ("M", ([0.0, 0.0],), {}),
    ("M", (np.zeros((2, 5)),), {}),
    ("M", (None,), {}),
    ("M", ("text",), {}),
    ("M", (np.zeros(4, dtype=complex),), {}),
    ("M", (np.zeros(4, dtype=bool),), {}),
    ("M", (np.ma.masked_array(OK, [True, False, False, True]),), {}),
    ("M", ([[0.0], [0.0, 1.0]],), {}),
    ("M", (np.array([0.0, None, 1.0, 2.0]),), {}),
    ("M", (OK, OK), {}),
    ("M", (OK,), {"p": 3}),
    ("Z", (np.zeros((2, 4)), np.zeros((3, 4))), {}),
    ("inverse_dynamics", (OK, OK, OK), {"wrench": np.zeros(6)}),
    ("inverse_dynamics", (OK, OK, OK), {"weights": -np.ones(4)}),
    ("inverse_dynamics", (OK, OK, OK), {"weights": [1.0, 1.0, 1.0, np.nan]}),
    ("inverse_dynamics", (OK, OK, np.zeros((2, 4))), {"wrench": np.zeros((3, 3))}),
    ("condition", (OK,), {"length": -1.0}),
    ("condition", (OK,), {"length": [1.0, 2.0]}),
    ("null_space", ([1.0],), {}),
    ("pose", ([0.0, 0.0], np.ones((2, 2))), {}),
    ("pose", ([0.0, 0.0], np.zeros((2, 2))), {"nearest": True}),
    ("pose", ([0.0, 0.0], np.stack([np.eye(2), 2 * np.eye(2)])), {}),
    ("pose", ([0.0], np.eye(2)), {}),
    ("Parameters", (), {"platform_mass": -1.0}),
    ("Parameters", (), {"platform_mass": 1e13}),
    ("Parameters", (), {"platform_mass": [1.0]}),
    ("Parameters", (), {"what": 1.0}),
]


@pytest.mark.parametrize(("function", "given", "named"), BAD)
def test_errors_are_those_of_numpy(
    function: str, given: tuple[Any, ...], named: dict[str, Any]
) -> None:
    e, m = pair("planar_redundant")
    with pytest.raises((TypeError, ValueError)) as wanted:
        getattr(m, function)(*given, **named)
    with pytest.raises(wanted.type) as found:
        getattr(e, function)(*given, **named)
    assert str(found.value) == str(wanted.value)


def test_rotations_are_looked_at_as_in_numpy() -> None:
    e, m = pair("planar_3rpr")
    R = np.array([[1.0, 1e-3], [0.0, 1.0]])
    t = np.ones(2)
    np.testing.assert_allclose(e.pose(t, R, nearest=True), m.pose(t, R, nearest=True), atol=1e-12)
    np.testing.assert_array_equal(np.isnan(e.pose(t, R * np.nan)), [True] * 3)
    many = np.stack([np.eye(2), R * np.nan])
    np.testing.assert_array_equal(e.pose(t, many), m.pose(t, many))


# ---- parameters --------------------------------------------------------------------------------


def test_parameters_are_prepared_once_and_felt() -> None:
    e, m = pair("planar_3rpr")
    changes = {"platform_mass": 3.5, "gravity": [0.1, -9.0, 0.0]}
    p, of_numpy = e.Parameters(**changes), m.Parameters(**changes)
    assert p._cache == {}
    X, V = m.HOME_X + 0.01, np.array([0.3, -0.2, 0.5])
    for q in (p, copy.deepcopy(p), pickle.loads(pickle.dumps(p)), p.replace()):
        for x, v in ((X, V), (X.tolist(), V), (np.tile(X, (3, 1)), V)):
            np.testing.assert_allclose(e.Z(x, v, q), m.Z(x, v, of_numpy), rtol=1e-12, atol=1e-13)
    prepared = p._cache["model"]
    e.Z(X, V, p)
    assert p._cache["model"] is prepared
    assert not np.allclose(e.Z(X, V, p), e.Z(X, V))


def test_parameters_of_a_subclass_are_taken_and_of_another_module_refused() -> None:
    e, m = pair("planar_3rpr")

    class Mine(e.Parameters):  # type: ignore[misc]
        pass

    own, theirs = Mine(platform_mass=9.0), e.Parameters(platform_mass=9.0)
    np.testing.assert_array_equal(e.M(m.HOME_X, own), e.M(m.HOME_X, theirs))
    for of in (m, pair("planar_redundant")[0]):
        with pytest.raises(TypeError, match=r"p: expected Parameters, got Parameters of .*another"):
            e.M(m.HOME_X, of.Parameters())


def test_what_c_refuses_of_parameters_is_an_error() -> None:
    e, _ = pair("planar_3rpr")
    values = b"".join(np.asarray(getattr(e.Parameters(), n)).tobytes() for n in e._RULES)
    nan = np.full(len(values) // 8, np.nan).tobytes()
    for wrong in (nan, values[8:], b""):
        with pytest.raises(ValueError, match="Parameters: "):
            e._C.prepare(wrong)
    with pytest.raises(TypeError):
        e._C.prepare("text")


# ---- threads -----------------------------------------------------------------------------------


def test_other_threads_run_during_a_batch() -> None:
    """Threads change only where one lets go of the interpreter's lock: by its switch interval not
    before the test has ended.  So this thread sees the other one inside a batch only if that lets
    go of the lock.
    """
    e, m = pair("planar_3rpr")
    X, gate = np.tile(m.HOME_X, (20_000, 1)), threading.Semaphore(0)
    inside = seen = False

    def work() -> None:
        nonlocal inside
        for _ in range(100):
            if not seen:
                inside = True
                gate.release()
                e.M(X)
                inside = False
        gate.release()

    thread, before = threading.Thread(target=work), sys.getswitchinterval()
    sys.setswitchinterval(1000.0)
    try:
        thread.start()
        while thread.is_alive() and not seen:
            gate.acquire()
            seen = inside
        thread.join()
    finally:
        sys.setswitchinterval(before)
    assert seen


def test_threads_get_what_one_gets() -> None:
    e, m = pair("planar_3rpr")
    given = vectors(m, 500)
    wanted = e.inverse_dynamics(given["X"], given["V"], given["A"])
    found: list[Any] = [None] * 4

    def work(k: int) -> None:
        p = e.Parameters()
        for _ in range(20):
            found[k] = e.inverse_dynamics(given["X"], given["V"], given["A"], p)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for each in found:
        np.testing.assert_array_equal(each, wanted)


def test_nothing_is_kept_of_a_call() -> None:
    """Arguments and results are let go: as many references before and after."""
    e, m = pair("planar_3rpr")
    X, V, p = m.HOME_X.copy(), np.ones(3), e.Parameters()
    e.dynamics(X, V, p)
    objects = (X, V, p, p._cache, p._cache["model"], np.empty, None)
    before = [sys.getrefcount(o) for o in objects[:-1]]
    for bad in (X, X[:2], X.tolist(), np.tile(X, (3, 1)), X * np.nan):
        for _ in range(50):
            try:
                results = e.dynamics(bad, V, p), e.condition(bad, p), e.energy(bad, V, p)
            except ValueError:
                continue
    assert [sys.getrefcount(a) for pair_ in results for a in pair_] == [3] * 8
    assert [sys.getrefcount(o) for o in objects[:-1]] == before
    X.resize(6, refcheck=False)  # BufferError where a buffer is still held
