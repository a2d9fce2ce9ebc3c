"""Every quantity can be computed from a report's text and what is given."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from pne_sym import manipulators
from pne_sym.backends.bundle import Bundle
from pne_sym.backends.glyphs import Glyph
from pne_sym.backends.report import ReportBackend
from pne_sym.model.manipulator import Manipulator
from tests import models
from tests.printed.interpreter import Interpreter
from tests.whole.test_coupling import both
from tests.whole.test_joint_forces import dressed

SAMPLE = ("planar_3rpr", "tripod_3rps")
CASES = [
    pytest.param(name, seed, marks=[] if name in SAMPLE and not seed else pytest.mark.only_in_all)
    for name in manipulators.names()
    for seed in (0, 1, 2)
]
CLOSE = 1e-11


def manipulator_of(name: str, seed: int) -> Manipulator:
    """An entry of the catalogue, or with a seed its structure with random numbers."""
    return models.random_spec(name, seed) if seed else models.catalogue(name)


def numbers_of(bundle: Bundle, state: Any) -> dict[str, Any]:
    """What is given: parameters, X, V, A, and the displacements that are iterated."""
    fields = bundle.derivation.parameters.fields
    values = {f.name: f.default for f in fields}
    return values | {"X": state.X, "V": state.V, "A": state.A, "q": state.q}


def least(found: Interpreter, wrench: Any) -> Any:
    """Actuator forces of least norm that give what is required, beside those of constraints."""
    H, needed = found.array("H"), found.array("required")
    needed[: len(wrench)] -= wrench
    if any(b.id == "Hk" for b in found.text.blocks):
        Hk = found.array("Hk")
        across = np.linalg.svd(Hk.T)[2][Hk.shape[1] :]
        H, needed = across @ H, across @ needed
    return np.linalg.lstsq(H, needed, rcond=1e-12)[0]


@pytest.mark.parametrize(("name", "seed"), CASES)
def test_report_computes(name: str, seed: int) -> None:
    """M, Z, H, Hk, q and tau, as the module has them."""
    computes(manipulator_of(name, seed), seed)


def test_margins() -> None:
    """Which entry of the limits is the least is told."""
    manipulator = dressed("planar_3rpr", 1)
    bundle, state = models.bundle(manipulator), models.state_at(manipulator, 1)
    text = ReportBackend().emit(bundle)["planar_3rpr.md"]
    found = Interpreter(text, numbers_of(bundle, state))
    margins = [found.legs[i + 1].base[rf"\bar\chi_{j + 1}"] for i, j in bundle.coordinates.joints]
    close(np.array(margins), models.module(manipulator).joint_margins(state.X), "margins")


def test_coupled_motors() -> None:
    """What is no sum over legs is printed beside the blocks."""
    computes(both("planar_3rpr")[1], 1)


def computes(manipulator: Manipulator, seed: int) -> None:
    """All of these, from the report's text."""
    bundle, module = models.bundle(manipulator), models.module(manipulator)
    state = models.state_at(manipulator, seed)
    text = ReportBackend().emit(bundle)[f"{bundle.name}.md"]
    found = Interpreter(text, numbers_of(bundle, state))
    closed = all(t.is_closed for t in bundle.derivation.leg_types)
    first = {} if closed else {"q0": state.q}
    arrays = [b.id for b in found.text.blocks if b.id in ("M", "Z", "H", "Hk")]
    assert arrays[:3] == ["M", "Z", "H"]
    for array in arrays:
        given = (state.X, state.V) if array == "Z" else (state.X,)
        close(found.array(array), getattr(module, array)(*given, **first), array)
    close(found.joint_displacements(), module.inverse_kinematics(state.X, **first), "q")
    tau = module.inverse_dynamics(state.X, state.V, state.A, wrench=state.wrench, **first)
    close(least(found, state.wrench), tau[0] if isinstance(tau, tuple) else tau, "tau")


@pytest.mark.parametrize("name", ["planar_3rpr"])
def test_the_unit_vector_along_the_leg(name: str) -> None:
    """What is said to be the axis of a slide has its components."""
    manipulator = models.catalogue(name)
    bundle = models.bundle(manipulator)
    text = ReportBackend().emit(bundle)[f"{name}.md"]
    said = re.findall(r"\(\$`(.+?)`\$ is \$`(.+?)`\$, the unit vector", text)
    assert said
    found = Interpreter(text, numbers_of(bundle, models.state_at(manipulator, 1)))
    for leg in found.legs.values():
        for reciprocal, axis in said:
            w, e = (leg.base[str(Glyph.of(s))] for s in (reciprocal, axis))
            np.testing.assert_allclose(w, e, rtol=0, atol=CLOSE)


def close(found: Any, wanted: Any, what: str) -> None:
    """Equal to the last digits, against the largest entry."""
    size = max(1.0, np.abs(wanted).max(initial=0.0))
    np.testing.assert_allclose(found / size, wanted / size, rtol=0, atol=CLOSE, err_msg=what)


def test_a_changed_report_computes_otherwise() -> None:
    """What is printed counts: a sign turned in the text is seen, a symbol not known is refused."""
    manipulator = models.catalogue("planar_3rpr")
    bundle = models.bundle(manipulator)
    text = ReportBackend().emit(bundle)["planar_3rpr.md"]
    numbers = numbers_of(bundle, models.state_at(manipulator, 0))
    right = Interpreter(text, numbers).array("M")
    turned = text.replace(r"+ \sin(\theta)\,", r"- \sin(\theta)\,")
    assert turned != text
    with pytest.raises(AssertionError, match="Not equal"):
        close(Interpreter(turned, numbers).array("M"), right, "M")
    with pytest.raises(AssertionError, match="not understood"):
        Interpreter(text.replace(r"| $`\mathbf T_0`$ |", r"| $`\mathbf T_9`$ |"), numbers)
