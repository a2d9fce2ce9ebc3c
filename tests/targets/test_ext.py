"""Every function of every catalogue entry: the extension module against the NumPy module."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pne_sym import manipulators
from pne_sym.model.manipulator import Body
from pne_sym.model.reader import checked
from tests.backends.ext_module import assert_all_alike, pair
from tests.random.effects import with_efforts
from tests.targets.modules import functions
from tests.whole.test_coupling import coupled


@pytest.mark.parametrize("name", manipulators.names())
def test_equal_to_the_numpy_module(name: str) -> None:
    assert_all_alike(name)


@pytest.mark.parametrize("name", ["planar_4rpr", "tripod_3rps"])
def test_with_all_that_a_machine_can_have(name: str) -> None:
    """Friction, springs, coupled motors, a payload, limits of displacement and effort, a base that
    moves; with redundant actuators, with constraints.
    """
    payload = Body(2.0, (0.1, -0.05, 0.0), ((0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.2)))
    spec = with_efforts(coupled(name), 2, 5e3)
    spec = checked(replace(spec, name=f"{name}_all", payload=payload, moving_base=True))
    wanted = {"reachable_wrench", "motor_torques", "joint_margins", "within_limits", "dissipation"}
    wanted |= {"force_distribution"} if name == "planar_4rpr" else {"Hk"}
    assert wanted <= set(functions(pair(spec)[0]))
    assert_all_alike(spec)
