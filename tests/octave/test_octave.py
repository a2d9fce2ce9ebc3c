"""MATLAB / Octave packages: a sample of what `make targets` runs, and how they are called."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pne_sym.backends.octave import OctaveBackend
from pne_sym.backends.target import TargetError
from pne_sym.program.evaluate import Status
from pne_sym.program.interpret import Interpreter
from tests import models
from tests.backends.c_library import Array
from tests.cli.program import pne_gen
from tests.octave.conformance import Call, answers, conforms, octave, run, write
from tests.program.test_public import interpreter

in_octave = pytest.mark.skipif(octave() is None, reason="octave-cli is not installed")


@in_octave
@pytest.mark.parametrize("name", ["planar_3rpr", "fivebar_redundant", "tripod_3rps"])
def test_equal_to_the_numpy_module(name: str) -> None:
    conforms(models.catalogue(name))


@in_octave
def test_how_functions_are_called(tmp_path: Path) -> None:
    """One column for all states, [] and nothing for defaults, parameters that are changed."""
    path = write(models.catalogue("planar_3rpr"), tmp_path)
    run(
        """
        X = planar_3rpr.home_pose(); Y = [X, X + 0.01, X - 0.01];
        V = 0.1 * ones(3, 1); A = ones(3, 3); w = [1; 2; 3];
        p = planar_3rpr.parameters();
        [M, status] = planar_3rpr.M(X); assert(size(M), [3, 3]); assert(status, 0);
        [M, status] = planar_3rpr.M(Y); assert(size(M), [3, 3, 3]); assert(status, [0, 0, 0]);
        assert(planar_3rpr.M(X, p), M(:, :, 1)); assert(planar_3rpr.M(X, []), M(:, :, 1));
        [M, status] = planar_3rpr.M(zeros(3, 0));
        assert(size(M), [3, 3, 0]); assert(size(status), [1, 0]);
        tau = planar_3rpr.inverse_dynamics(Y, V, A, [], w);
        assert(tau(:, 2), planar_3rpr.inverse_dynamics(Y(:, 2), V, A(:, 2), p, w), 1e-13);
        assert(tau(:, 1), planar_3rpr.inverse_dynamics(X, V, A(:, 1), p) ...
            - planar_3rpr.H(X) \\ w, 1e-10);
        [M, Z, H, status] = planar_3rpr.dynamics(Y, V);
        assert(size(Z), [3, 3]); assert(status, [0, 0, 0]);
        assert(M(:, :, 3) * A(:, 3) + Z(:, 3) - w, H(:, :, 3) * tau(:, 3), 1e-10);
        p.platform_mass = p.platform_mass + 1;
        heavier = planar_3rpr.M(X, p); assert(heavier(1, 1) - M(1, 1, 1), 1, 1e-12);
        """,
        path,
    )


@in_octave
@pytest.mark.parametrize(
    ("call", "told"),
    [
        ("M([1; 2])", "X: expected real numbers, 3 x n, n = 1 or 1"),
        ("Z(zeros(3, 4), zeros(3, 2))", "V: expected real numbers, 3 x n, n = 4 or 1"),
        ("M([1; 2; 1i])", "X: expected real numbers"),
        ("M(true(3, 1))", "X: expected real numbers"),
        ("M(zeros(3, 1), setfield(planar_3rpr.parameters(), 'gravity', 1))", "p.gravity: "),
        (
            "forward_dynamics(ones(3, 1), ones(3, 1), ones(3, 1), [], 1)",
            "wrench: expected real numbers, 3 x n",
        ),
    ],
)
def test_what_does_not_fit_is_named(call: str, told: str, tmp_path: Path) -> None:
    path = write(models.catalogue("planar_3rpr"), tmp_path)
    script = f"try, planar_3rpr.{call}; catch e, printf('%s', e.message); end"
    assert told in run(script, path)


@in_octave
def test_statuses_that_the_numpy_module_has_no_word_for() -> None:
    """Weights that are not positive, matrices that are no rotations: INVALID."""
    manipulator = models.catalogue("planar_4rpr")
    reference = interpreter(manipulator)
    X = np.tile(manipulator.home.X, (4, 1))
    weights = np.ones((4, reference.functions["inverse_dynamics"].inputs[-1].value.size))
    weights[0, 0], weights[1, 0] = -1.0, np.nan
    R = np.stack([np.diag([1.0, -1.0]), 1.001 * np.eye(2), np.eye(2), [[0, -1], [1, 0]]])
    zero = np.zeros((4, len(manipulator.home.X)))
    calls = [
        Call(
            reference.functions["inverse_dynamics"],
            {"X": X, "V": zero, "A": zero, "weights": weights},
        ),
        Call(reference.functions["pose"], {"t": zero[:, :2], "R": R}),
    ]
    for call, (_, status) in zip(calls, answers(manipulator, calls), strict=True):
        assert status.tolist() == [3, 3, 0, 0]
        np.testing.assert_array_equal(
            status, reference.call(call.function.name, **call.given).status
        )


@in_octave
def test_help(tmp_path: Path) -> None:
    path = write(models.catalogue("planar_3rpr"), tmp_path)
    told = run("help('planar_3rpr.inverse_dynamics');", path)
    for line in (
        "tau: actuator forces [N or N m] (3 x n).",
        "status (1 x n): 0 OK",
        "X: pose, and extra coordinates (3 x n).",
    ):
        assert line in told
    assert "Generated" not in told


def test_explain_finds_the_statements() -> None:
    done = pne_gen("explain", "planar_3rpr", "rpr-K1", "--stage", "octave", real=True)
    assert done.returncode == 0, done.stderr
    assert re.search(r"^\s+\w+ = .*\.\*", done.stdout, re.MULTILINE), done.stdout


@pytest.mark.parametrize("name", ["planar_3rpr", "stewart"])
def test_the_language_is_matlab_s_too(name: str) -> None:
    """No syntax of Octave alone; names that MATLAB takes; one function per file, of its name."""
    for path, text in OctaveBackend().emit(models.bundle(models.catalogue(name))).items():
        code = re.sub(r"'[^'\n]*'(?=[,)])", "", re.sub(r"%.*", "", text))
        assert not re.search(r'["#!]|\+\+|\+=|\bend\w|\b_|\*\*|\bprintf\b', code), path
        assert not re.search(r"\w{64}", code), path
        # what MATLAB Coder refuses, or what would let arrays grow
        cells = path.endswith("actuators.m")  # names
        assert cells or not re.search(
            r"[{}@]|\b(global|persistent|f?eval|str2func|\w+fun|struct)\b", code
        ), path
        assert not re.search(r"\bend *\+|(\b\w+) = \[\1[ ,;]", code), path
        assert not re.search(r"\bend ?\+ ?1", code), path
        heads = re.findall(r"^function (?:[^=(]*= )?(\w+)\(", text, re.MULTILINE)
        assert heads == ([] if path.endswith("Contents.m") else [Path(path).stem])


def called(name: str) -> dict[str, str]:
    """The files of a model of that name."""
    compiled = models.bundle(models.catalogue("planar_3rpr"))
    named = replace(compiled.manipulator, name=name)
    return OctaveBackend().emit(replace(compiled, manipulator=named))


@pytest.mark.parametrize("name", ["otherwise", "size", "status", "p", "nargin"])
def test_a_name_that_matlab_or_the_functions_have_for_something_else(name: str) -> None:
    with pytest.raises(TargetError, match=f"{name}: the target octave: MATLAB or its code has"):
        called(name)


@in_octave
def test_a_name_that_stands_behind_dots_and_in_messages_alone(tmp_path: Path) -> None:
    for name in ("internal", "expected"):
        for place, text in called(name).items():
            file = tmp_path / place
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
        run(f"[M, status] = {name}.M({name}.home_pose()); assert(status, 0);", tmp_path / "octave")


# --- what only impossible states, or states side by side, tell ----------------------------


@in_octave
def test_what_the_language_would_make_complex_or_skip_is_nan(tmp_path: Path) -> None:
    """Guards hide it from statuses: functions of the package are called as they are."""
    path = write(models.catalogue("planar_3rrr"), tmp_path)
    run(
        """
        of = @(name) str2func(['planar_3rrr.internal.' name]);
        f = of('root'); found = f([4, -4, 0, NaN, -0]);
        assert(isreal(found)); assert(found, [2, NaN, 0, NaN, 0]);
        f = of('least');
        assert(f([1, 2, NaN, 3, NaN], [2, 1, 0, NaN, NaN]), [1, 1, NaN, NaN, NaN]);
        f = of('largest'); assert(f([1, -2, NaN; -3, 0, 9]), [3, 2, NaN]);
        f = of('solve'); a = cat(3, [1, 0; 0, 1], [1, 1; 1, 1 + 1e-13], [2, 0; 0, 4]);
        assert(f(a, [1, 1, 2; 2, 2, 4]), [1, NaN, 1; 2, NaN, 1]);
        """,
        path,
    )


def last_reachable(reference: Interpreter, X: Array, ways: Array) -> Array:
    """The last poses on some ways, to rounding, that legs reach: there one is stretched."""
    near, far = np.zeros((len(ways), 1)), np.ones((len(ways), 1))
    for _ in range(60):
        middle = 0.5 * (near + far)
        status = reference.call("inverse_kinematics", X=X + middle * ways).status[:, None]
        near, far = np.where(status == 0, middle, near), np.where(status == 0, far, middle)
    return X + near * ways


@in_octave
def test_a_search_that_begins_where_a_leg_is_singular_says_so() -> None:
    manipulator = models.catalogue("fivebar_revolute")
    m, reference = models.module(manipulator), interpreter(manipulator)
    home = np.array(manipulator.home.X)
    ways = 5.0 * np.random.default_rng(0).uniform(-1.0, 1.0, (40, len(home)))
    X0 = np.concatenate((last_reachable(reference, home, ways), [home, home + 100.0]))
    q = np.tile(m.inverse_kinematics(home)[list(m.ACTUATED)], (len(X0), 1))
    call = Call(reference.functions["forward_kinematics"], {"q_actuated": q, "X0": X0})
    wanted = reference.call("forward_kinematics", **call.given).status
    assert {Status.OK, Status.UNREACHABLE, Status.SINGULAR} <= set(wanted.tolist())
    ((_, status),) = answers(manipulator, [call])
    np.testing.assert_array_equal(status, wanted)


@in_octave
@pytest.mark.parametrize(
    ("name", "function"), [("fivebar_revolute", "forward_kinematics"), ("tripod_3rps", "project")]
)
def test_a_state_that_is_found_stays_as_it_is(name: str, function: str) -> None:
    """Alone or beside states that take longer: the same digits."""
    manipulator = models.catalogue(name)
    m, reference = models.module(manipulator), interpreter(manipulator)
    rng = np.random.default_rng(2)
    sizes = np.array([1e-9, 1e-6, 1e-3, 3e-2, 1e-8, 1e-4])[:, None]
    X = m.HOME_X + sizes * rng.uniform(-1.0, 1.0, (len(sizes), m.NQ))
    q = np.tile(m.inverse_kinematics(m.HOME_X)[list(m.ACTUATED)], (len(X), 1))
    given = {"X": X} if function == "project" else {"q_actuated": q, "X0": X}
    taken = reference.functions[function]
    calls = [Call(taken, given)]
    calls += [Call(taken, {n: a[k : k + 1] for n, a in given.items()}) for k in range(len(X))]
    ((together,), status), *alone = answers(manipulator, calls)
    assert not status.any()
    for k, ((found,), _) in enumerate(alone):
        np.testing.assert_array_equal(together[k], found[0])
