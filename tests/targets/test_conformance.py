"""Every function of every catalogue entry, in every namespace, against the NumPy module."""

from __future__ import annotations

from typing import Any

import array_api_strict
import jax
import jax.numpy
import numpy as np
import pytest
import torch

from pne_sym import manipulators
from pne_sym.model.manipulator import Manipulator
from tests import models
from tests.infinite import finite_parts
from tests.targets.modules import call, condition, functions, vectors, xp_module
from tests.whole.test_bounds import limited
from tests.whole.test_coupling import coupled
from tests.whole.test_joint_forces import dressed
from tests.whole.test_moving_base import carried

jax.config.update("jax_enable_x64", True)
_SAMPLE = ("stewart", "stewart_7ups", "planar_redundant", "tripod_3prs", "hexapod_6x6r")
_EVERY = [(space, name) for space in (np, array_api_strict) for name in manipulators.names()]
_SAMPLED = [(space, name) for space in (torch, jax.numpy) for name in _SAMPLE]


@pytest.mark.parametrize(("space", "name"), [*_EVERY, *_SAMPLED])
def test_equal_to_the_numpy_module(space: Any, name: str) -> None:
    assert_alike(space, models.catalogue(name))


def test_with_all_that_a_joint_can_have() -> None:
    """Friction, springs, motors, limits; a payload; a base that moves; coupled motors."""
    assert_alike(np, dressed("planar_3rpr"))
    assert_alike(np, carried("tripod_3rps"))
    assert_alike(np, coupled("planar_3rpr"))


@pytest.mark.parametrize("space", [np, array_api_strict, torch, jax.numpy])
def test_within_limits_of_effort(space: Any) -> None:
    """With constraints, with redundant actuators and limits at some of them, with both."""
    for name, every in (("tripod_3rps", 1), ("planar_4rpr", 2), ("quadrupod", 1)):
        assert_alike(space, limited(name, every, 5e3))


def assert_alike(space: Any, manipulator: Manipulator) -> None:
    m, x = models.module(manipulator), xp_module(manipulator)
    given = vectors(m)
    assert len(functions(x)) >= 10
    for function in functions(x):
        mine, theirs = call(x, function, given, space.asarray), call(m, function, given)
        assert len(mine) == len(theirs), function
        for a, b in zip(mine, theirs, strict=True):
            found, wanted = np.from_dlpack(a), b
            if function == "null_space":
                found, wanted = (basis @ np.swapaxes(basis, -1, -2) for basis in (found, b))
            assert found.shape == wanted.shape, function
            found, wanted = finite_parts(found, wanted)
            np.testing.assert_array_equal(np.isnan(found), np.isnan(wanted), function)
            error = np.nanmax(np.abs(found - wanted), initial=0.0)
            scale = np.nanmax(np.abs(wanted), initial=0.0) or 1.0
            assert error <= 1e-13 * condition(m, function, given) * scale, function
