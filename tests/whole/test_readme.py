"""The code in README.md, run as it stands there."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from generated import hexapod_6x6r, stewart

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Names after all blocks, one after the other as a reader would type them."""
    home = hexapod_6x6r.HOME_X, np.zeros(6), np.zeros(6)
    namespace: dict[str, Any] = {"hexapod": hexapod_6x6r, "trajectory": [home] * 2}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("readme"))
        for block in BLOCKS:
            exec(compile(block, "README.md", "exec"), namespace)
            namespace.setdefault("blocks", []).append(dict(namespace))
    return namespace


def test_every_block_ran_and_gave_numbers(ran: dict[str, Any]) -> None:
    assert len(BLOCKS) == len(ran["blocks"]) == 4
    for names in ran["blocks"]:
        assert np.isfinite(names["tau"]).all()


def test_the_motion_keeps_the_balance_of_energy(ran: dict[str, Any]) -> None:
    """What the constant forces did is their scalar product with the change of the strokes."""
    motion, tau = ran["motion"], ran["hold"] + ran["push"]
    strokes = stewart.actuator_positions(motion.y[:7].T)
    gained = (ran["kinetic"] + ran["potential"]) - (ran["kinetic"] + ran["potential"])[0]
    np.testing.assert_allclose(gained, (strokes - strokes[0]) @ tau, atol=1e-6)
    assert ran["kinetic"][-1] > 0.05


def test_the_control_loop_reaches_the_pose(ran: dict[str, Any]) -> None:
    """It starts from measured strokes alone, and the pose it finds is that of the machine."""
    wanted = stewart.pose_from_rpy([0.03, 0.0, 0.78], [0.0, 0.1, 0.2])
    np.testing.assert_allclose(ran["state"][:3], wanted[:3], atol=1e-4)
    np.testing.assert_allclose(abs(ran["state"][3:7] @ wanted[3:]), 1.0, atol=1e-6)
    np.testing.assert_allclose(ran["pose"][:3], wanted[:3], atol=1e-4)


def test_what_is_not_modelled_is_said() -> None:
    section = README.partition("**Not modelled**")[2].partition("\n\n")[0]
    for word in ("elasticity", "clearance", "Coulomb", "rotors", "stops", "slack"):
        assert word in section
