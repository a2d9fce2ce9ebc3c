"""What the interpreter says of states that are impossible: it is the reference of all back ends."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pne_sym.program.algorithm import Algorithm
from pne_sym.program.evaluate import Status, prepare
from pne_sym.program.interpret import Interpreter
from pne_sym.program.iteration import close_loops
from pne_sym.program.linear import solve
from pne_sym.program.operations import OPERATIONS
from pne_sym.program.public import Argument, PublicFunction, Value
from tests import models
from tests.program.test_public import interpreter, states
from tests.whole.test_impossible import pose_of_singular_actuators

OK, UNREACHABLE, SINGULAR, INVALID, NOT_CONVERGED = Status


def at_home(name: str) -> tuple[Interpreter, dict[str, Any]]:
    """The interpreter, and the same ordinary state three times for every argument."""
    manipulator = models.catalogue(name)
    given = states(manipulator, models.module(manipulator))
    return interpreter(manipulator), {
        n: np.tile(v[:1], (3, *[1] * (v.ndim - 1))) for n, v in given.items()
    }


def call(run: Interpreter, name: str, given: dict[str, Any]) -> list[int]:
    """Statuses of a function; outputs are NaN as a whole, or finite, as these say."""
    own = {a.name: given[a.name] for a in run.functions[name].inputs if a.name in given}
    found = run.call(name, **own)
    for array in found.outputs:
        flat = array.reshape(len(array), -1)
        if flat.size:
            np.testing.assert_array_equal(np.isfinite(flat).all(axis=1), found.status == OK)
            np.testing.assert_array_equal(np.isnan(flat).all(axis=1), found.status != OK)
    return [int(s) for s in found.status]


@pytest.mark.parametrize("name", ["planar_3rpr", "fivebar_redundant", "tripod_3rps"])
def test_what_is_not_finite_spoils_what_depends_on_it(name: str) -> None:
    run, given = at_home(name)
    reads = {
        "M": "X",
        "Z": "X V",
        "inverse_dynamics": "X V A wrench",
        "forward_dynamics": "X V tau wrench",
        "joint_rates": "X V",
        "energy": "X V",
        "complete_acceleration": "A",
        "leg_reactions": "X V A wrench",
        "X_dot": "X V",
    }
    for vector in ("X", "V", "A", "tau", "wrench"):
        spoilt = {n: np.array(v) for n, v in given.items()}
        spoilt[vector][1, 0] = np.nan
        for function in (f for f in reads if f in run.functions):
            wanted = INVALID if vector in reads[function].split() else OK
            assert call(run, function, spoilt) == [OK, wanted, OK], (function, vector)


def test_the_first_cause_is_told() -> None:
    """Of singular actuators and an input not finite, the input; the leg before the actuators."""
    run, given = at_home("planar_3rpr")
    given["X"][1] = pose_of_singular_actuators(models.module(models.catalogue("planar_3rpr")))
    assert call(run, "inverse_dynamics", given) == [OK, SINGULAR, OK]
    assert call(run, "forward_dynamics", given) == [OK, OK, OK]
    given["V"][1] = np.inf
    assert call(run, "inverse_dynamics", given) == [OK, INVALID, OK]


def test_no_output_of_an_impossible_state_is_left() -> None:
    """Nor one that does not depend on what is impossible."""
    run, given = at_home("planar_3rpr")
    a, X = Algorithm(), run.functions["M"].inputs[0]
    outputs = tuple(
        Argument(value, ("NQ",), "an output")
        for value in (
            a.apply("same", X.value),
            a.apply("solve", Value("a", (2, 2)), Value("b", (2,))),
        )
    )
    matrix, right = (
        Argument(Value(n, s), ("2",), "given") for n, s in (("a", (2, 2)), ("b", (2,)))
    )
    made = PublicFunction("test", "Test.", (X, matrix, right), outputs, tuple(a.steps), "dynamics")
    own = Interpreter(run.program, run.prepared, run.home_q, made)
    given |= {"a": np.array([np.eye(2), np.ones((2, 2)), np.eye(2)]), "b": np.ones((3, 2))}
    assert call(own, "test", given) == [OK, SINGULAR, OK]


def test_legs_out_of_reach() -> None:
    run, given = at_home("fivebar_revolute")
    given["X"][1] += 100.0
    for function in (
        "M",
        "inverse_kinematics",
        "inverse_dynamics",
        "forward_dynamics",
        "condition",
    ):
        assert call(run, function, given) == [OK, UNREACHABLE, OK]


def test_arguments_that_are_none() -> None:
    run, given = at_home("fivebar_redundant")
    given["weights"][0, 0], given["weights"][1, 0] = -1.0, 0.0
    assert call(run, "inverse_dynamics", given) == [INVALID, INVALID, OK]
    run, given = at_home("tripod_3rps")
    given["R"][0] *= -1.0
    given["R"][1] *= 1.001
    assert call(run, "pose", given) == [INVALID, INVALID, OK]
    given["X"][0, 3:] = 0.0
    given["X"][1, 3:] *= 1e200
    assert call(run, "rotation", given) == [INVALID, INVALID, OK]
    assert call(run, "M", given) == [INVALID, INVALID, OK]


def test_poses_that_are_not_found() -> None:
    run, given = at_home("fivebar_revolute")
    given["q_actuated"] = np.array(given["q_actuated"])
    given["q_actuated"][1] += np.array([2.5, -2.5])
    found = run.call("forward_kinematics", q_actuated=given["q_actuated"], X0=given["X"])
    assert found.status[0] == found.status[2] == OK
    assert found.status[1] != OK
    assert np.isnan(found.outputs[0][1]).all()
    run, given = at_home("tripod_3rps")
    given["X"][1, :3] *= 50.0
    assert call(run, "project", given)[::2] == [OK, OK]


@pytest.mark.parametrize("name", ["stewart_sps", "planar_redundant", "planar_3rpr"])
def test_poses_are_moved_as_their_rates_say(name: str) -> None:
    """By a small displacement: the derivative of X, extra coordinates among it."""
    manipulator = models.catalogue(name)
    run, given = at_home(name)
    c = models.bundle(manipulator).coordinates
    if c.has_quaternion:
        given["X"][:, 3:7] /= np.linalg.norm(given["X"][:, 3:7], axis=1, keepdims=True)
    step, h = given["V"], 1e-6
    (rate,) = run.call("X_dot", X=given["X"], V=step).outputs
    ends = [run.call("retract", X=given["X"], step=s * step).outputs[0] for s in (h, -h)]
    np.testing.assert_allclose((ends[0] - ends[1]) / (2.0 * h), rate, rtol=0, atol=1e-8)


# ---- iteration --------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["planar_3rrr", "planar_3rrp_extra", "translational_pprhu_rr"])
def test_far_guesses_end_as_in_the_module(name: str) -> None:
    """Steps are shortened, other branches are none, extra coordinates are those of X."""
    manipulator = models.drawn(name)
    compiled, m = models.bundle(manipulator), models.module(manipulator)
    rng, home = np.random.default_rng(2), manipulator.home
    X = np.array(home.X) + 1e-2 * rng.uniform(-1.0, 1.0, (60, m.NQ))
    q0 = np.array(home.q) + 2.0 * rng.uniform(-1.0, 1.0, (60, m.NJ))
    values = prepare(compiled.program, compiled.derivation.parameters.values())
    q, converged = close_loops(compiled.program, values, X, q0)
    theirs = models.closed(m, X, q0)
    np.testing.assert_array_equal(converged, np.isfinite(theirs).all(axis=1))
    assert 5 < converged.sum() < 60
    np.testing.assert_allclose(q[converged], theirs[converged], rtol=0, atol=1e-9)
    for joint, place in compiled.program.given:
        np.testing.assert_array_equal(q[:, joint], X[:, place])


# ---- operations ------------------------------------------------------------------------------


def test_turns_end_at_pi() -> None:
    turns = np.array([[np.pi, -np.pi, 3.0 * np.pi, 0.0]])
    (wrapped,) = OPERATIONS["wrap_turns"]((turns,), (0, 1, 2))
    np.testing.assert_allclose(wrapped, [[np.pi, np.pi, np.pi, 0.0]], rtol=1e-15)


def test_rotations_are_no_reflections() -> None:
    flat, space = np.diag([1.0, -1.0])[None], np.diag([1.0, 1.0, -1.0])[None]
    assert np.isnan(OPERATIONS["angle_of_rotation"]((flat,), ())[0]).all()
    assert np.isnan(OPERATIONS["quaternion_of_rotation"]((space,), ())[0]).all()
    assert np.isfinite(OPERATIONS["angle_of_rotation"]((-np.eye(2)[None],), ())[0]).all()


def test_roots_are_of_what_is_positive() -> None:
    given = np.array([[4.0, 0.25], [0.0, 1.0], [-1.0, 1.0], [np.inf, 1.0]])
    (found,) = OPERATIONS["inverse_root"]((given,), ())
    np.testing.assert_array_equal(found[0], [0.5, 2.0])
    assert np.isnan(found[1:, 0]).all()


def test_rows_of_any_size_are_solved() -> None:
    """What is singular does not depend on the units of the rows."""
    a = np.random.default_rng(0).normal(size=(4, 4))
    sizes = np.array([1e-20, 1.0, 1e15, 1e-9])
    x = np.arange(1.0, 5.0)
    np.testing.assert_allclose(solve(sizes[:, None] * a, sizes * (a @ x)), x, rtol=1e-9)
    a[3] = a[0] + a[1] + 1e-13 * a[3]
    assert np.isnan(solve(sizes[:, None] * a, sizes * (a @ x))).all()
