"""Public functions as steps, interpreted, against the generated NumPy module."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pne_sym.model.manipulator import Manipulator
from pne_sym.program.evaluate import Status, prepare
from pne_sym.program.interpret import Interpreter
from pne_sym.program.public import PublicFunction
from tests import models
from tests.backends.c_library import Array
from tests.bounds import bounded
from tests.infinite import finite_parts
from tests.sampling import entries

STATES = 3
TOLERANCE = 1e-10


def interpreter(manipulator: Manipulator) -> Interpreter:
    compiled = models.bundle(manipulator)
    prepared = prepare(compiled.program, compiled.derivation.parameters.values())
    return Interpreter(compiled.program, prepared, compiled.coordinates.home[1])


def states(manipulator: Manipulator, m: Any) -> dict[str, Array]:
    """States around home; extra entries for every argument."""
    rng, home = np.random.default_rng(5), manipulator.home
    X = np.array(home.X) + 2e-3 * rng.uniform(-1.0, 1.0, (STATES, m.NQ))
    q0 = np.tile(np.array(home.q), (STATES, 1))
    guess = {"q0": q0} if "q0" in m.M.__code__.co_varnames else {}
    q = m.inverse_kinematics(X, **guess)
    joints = list(m.ACTUATED)
    if hasattr(m, "rotation"):
        guess["R"] = m.rotation(X)
        guess["t"] = X[:, : {6: 3, 3: 0 if m.NQ > m.NV else 2}[m.NW]]
        guess["rpy"] = rng.uniform(-1.0, 1.0, (STATES, 3))
    return {
        "X": X,
        "X0": X + 1e-4 * rng.uniform(-1.0, 1.0, X.shape),
        "X1": X + 0.1 * rng.uniform(-1.0, 1.0, X.shape),
        "step": rng.uniform(-0.5, 0.5, (STATES, m.NV)),
        "s": rng.uniform(0.0, 1.0, STATES),
        "V": rng.uniform(-1.0, 1.0, (STATES, m.NV)),
        "A": rng.uniform(-5.0, 5.0, (STATES, m.NV)),
        "tau": rng.uniform(-5.0, 5.0, (STATES, m.NU)),
        "wrench": rng.uniform(-5.0, 5.0, (STATES, m.NW)),
        "weights": np.tile(rng.uniform(0.5, 2.0, m.NU), (STATES, 1)),
        "q_actuated": q[:, joints],
        **bounded(m, STATES),
        **guess,
    }


def spanned(basis: Array) -> Array:
    """The projection on what a basis spans: the basis itself is free."""
    return basis @ np.swapaxes(basis, -1, -2)


def of_module(m: Any, function: PublicFunction, given: dict[str, Array]) -> tuple[Array, ...]:
    arguments = {a.name: given[a.name] for a in function.inputs if a.name in given}
    if "weights" in arguments:
        arguments["weights"] = arguments["weights"][0]
    found = getattr(m, function.name)(**arguments)
    return found if isinstance(found, tuple) else (found,)


@pytest.mark.parametrize("name", entries(keep=["fivebar_revolute"]))
def test_every_public_function_is_the_module_s(name: str) -> None:
    manipulator = models.catalogue(name)
    m, run = models.module(manipulator), interpreter(manipulator)
    given = states(manipulator, m)
    for function in (f for f in run.functions.values() if f.is_exported):
        arguments = {a.name: given[a.name] for a in function.inputs if a.name in given}
        mine, theirs = run.call(function.name, **arguments), of_module(m, function, given)
        if function.gives_status:
            np.testing.assert_array_equal(mine.status, theirs[-1])
            theirs = theirs[:-1]
        assert len(mine.outputs) == len(theirs), function.name
        for answers in zip(mine.outputs, theirs, strict=True):
            found, wanted = (spanned(v) if function.name == "null_space" else v for v in answers)
            where = f"{name} {function.name}"
            assert found.shape == wanted.shape, where
            found, wanted = finite_parts(found, wanted)
            np.testing.assert_array_equal(np.isnan(found), np.isnan(wanted), where)
            scale = np.nanmax(np.abs(wanted), initial=0.0) or 1.0
            assert np.nanmax(np.abs(found - wanted), initial=0.0) <= TOLERANCE * scale, where


def test_where_no_state_is_left_to_iterate() -> None:
    run = interpreter(models.catalogue("hexapod_6x6r"))
    found = run.call("inverse_kinematics", X=np.full((2, 7), np.nan))
    assert np.isnan(found.outputs[0]).all()
    assert (found.status == Status.INVALID).all()
