"""Beyond the catalogue: a mechanism per task space and platform joint, and what is refused.

Structures are written by hand in the notation of `tests.oracle.mechanisms`; their geometry and
inertia are drawn at random.  All functions are compared with the oracle, constrained platforms by
what does not depend on how a leg's inertia is split.
"""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from pne_sym.model.errors import SpecError
from pne_sym.model.manipulator import Home, Manipulator
from pne_sym.model.reader import checked
from pne_sym.pipeline import compile_bundle
from tests.oracle.coordinates import pose_size
from tests.oracle.mechanisms import mechanism
from tests.random.judging import judge
from tests.sampling import sampled

_UPS = "Rz0 Ry Px* | S"

ACCEPTED: dict[str, tuple[str, list[str]]] = {
    "point R": ("point", ["Rz* Pt | R", "Rz Rz* | R"]),
    "point S": ("point", ["Pt* Rz | S", "Rz Px* | S"]),
    "planar R": ("planar", ["Rz* Rz | R", "Pt* Rz | R", "Rz Pt* | R"]),
    "planar S": ("planar", ["Rz* Px Rz+* | S", "Rz* Rz | S", "Px* Py | S"]),
    "spatial S": ("spatial", ["Rz* Ry Px* | S", "Rz* Ry Px* | S", "Rt0* Rt Pt* | S"]),
    "spatial U": ("spatial", ["Rz0* Ry Px* Rx | U", *[_UPS] * 4]),
    "spatial R": ("spatial", ["Rz0* Ry Px* Ry0 Rx | R", *[_UPS] * 4]),
    "spatial rigid": ("spatial", ["Px* Py* Pz Rz0* Ry0 Rx | rigid", *[_UPS] * 3]),
    "spatial, two joints at S": ("spatial", ["Rz Px* | S", "Ry* Rz | S", _UPS, _UPS]),
    "spatial, three joints at U": ("spatial", ["Rz0* Ry Px* | U", _UPS, _UPS, _UPS]),
    "translational S": ("translational", ["Px* Py Pz | S", _UPS, _UPS]),
    "translational U": ("translational", ["Rz0* Ry Px Rx | U", _UPS, _UPS]),
    "translational R": ("translational", ["Rz0* Ry Px Rx0 Ry | R", _UPS, _UPS]),
    "translational rigid": ("translational", ["Px* Py Pz Rz0 Ry0 Rx | rigid", _UPS, _UPS]),
    "spherical S": ("spherical", ["Px* Py Pz | S", _UPS, _UPS]),
    "spherical U": ("spherical", ["Rz0* Ry Px Rx | U", _UPS, _UPS]),
    "spherical R": ("spherical", ["Px* Py Pz Ry0 Rx | R", _UPS, _UPS]),
    "spherical rigid": ("spherical", ["Px* Py Pz Rz0 Ry0 Rx | rigid", _UPS, _UPS]),
    "spatial, one joint at U": ("spatial", ["Rz* Ry | U", *[_UPS] * 4]),
    "spatial, four joints at R": ("spatial", ["Rz* Ry Px* Rx | R", *[_UPS] * 3]),
    "spatial, five joints at rigid": ("spatial", ["Rz* Ry Px* Rx Ry | rigid", *[_UPS] * 3]),
    "translational U, degrees of freedom left out": ("translational", ["Rz* Ry | U", _UPS, _UPS]),
    "translational R, degrees of freedom left out": ("translational", ["Px* Py* Pz* | R"]),
    "translational rigid, degrees of freedom left out": (
        "translational",
        ["Px* Py* Pz | rigid", "Px Py Pz* | rigid"],
    ),
    "spherical U, degrees of freedom left out": ("spherical", ["Rz* Ry | U", _UPS, _UPS]),
    "spherical R, degrees of freedom left out": ("spherical", ["Rz* Ry Px | R", _UPS, _UPS]),
    "spherical rigid, degrees of freedom left out": ("spherical", ["Rz0* Ry0* Rx* | rigid"]),
}
"""Space and platform joint -> legs."""

_TOO_MANY = "{} degrees of freedom where the platform joint leaves {} to be determined"
_PINNED = r"platform_joint.kind: value '{}'; expected R or S: in the plane the legs are pinned"

REFUSED: dict[str, tuple[str, list[str], str]] = {
    "point R": ("point", ["Rz* Rz+ Rz | R", "Rz Px* | R"], _TOO_MANY.format(3, 2)),
    "point S": ("point", ["Pt* Rz Px+ | S", "Rz Px* | S"], _TOO_MANY.format(3, 2)),
    "point rigid": ("point", ["Rz* Px Rz | rigid", "Rz Px* | R"], _PINNED.format("rigid")),
    "point U": ("point", ["Rz* Px | U", "Rz Px* | R"], _PINNED.format("U")),
    "planar R": ("planar", ["Rz* Rz Rz+ | R", *["Rz Px* | R"] * 2], _TOO_MANY.format(3, 2)),
    "planar S": ("planar", ["Rz* Px Rz+ | S", *["Rz Px* | R"] * 2], _TOO_MANY.format(3, 2)),
    "planar rigid": (
        "planar",
        ["Rz* Px Rz | rigid", *["Rz Px* | R"] * 2],
        _PINNED.format("rigid"),
    ),
    "planar U": ("planar", ["Rz* Px | U", *["Rz Px* | R"] * 2], _PINNED.format("U")),
    "spatial S": ("spatial", ["Rz* Ry Rx+ Px* | S", *[_UPS] * 4], _TOO_MANY.format(4, 3)),
    "spatial U": ("spatial", ["Rz* Ry Rx+ Px* Rx | U", *[_UPS] * 4], _TOO_MANY.format(5, 4)),
    "spatial R": ("spatial", ["Rz Ry Px* Rx+ Ry Rx* | R", *[_UPS] * 4], _TOO_MANY.format(6, 5)),
    "spatial rigid": (
        "spatial",
        ["Rz* Ry Px* Rz+ Rx Ry Rz | rigid", *[_UPS] * 4],
        _TOO_MANY.format(7, 6),
    ),
    "translational S": ("translational", ["Rz* Ry Rx+ Px | S", _UPS, _UPS], _TOO_MANY.format(4, 3)),
    "spherical S": ("spherical", ["Rz* Ry Rx+ Px | S", _UPS, _UPS], _TOO_MANY.format(4, 3)),
}
"""Space and platform joint -> legs and the mechanical reason; joints marked + lose the mark."""

RUN = (
    "point R",
    "planar S",
    "translational R, degrees of freedom left out",
)
"""In every run: what is derived quickly; functions of the last one take no vector."""


@pytest.mark.parametrize("name", sampled(ACCEPTED, 0, keep=RUN))
def test_right(name: str) -> None:
    rng = np.random.default_rng(7)
    space, legs = ACCEPTED[name]
    drawn = replace(mechanism(space, legs, rng, plain=True), name="drawn")
    verdict = judge(drawn, rng, states=1)
    assert verdict.refused == ""
    assert not verdict.stateless
    assert verdict.wrong == {}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name: str) -> None:
    space, legs, reason = REFUSED[name]
    drawn = mechanism(space, legs, np.random.default_rng(7), plain=True)
    with pytest.raises(SpecError, match=re.escape(reason)):
        compile_bundle(checked(without_extra_marks(replace(drawn, name="drawn"))))


def without_extra_marks(manipulator: Manipulator) -> Manipulator:
    """The same legs with all displacements to be found from the pose."""
    legs = tuple(
        replace(leg, joints=tuple(replace(joint, extra=False) for joint in leg.joints))
        for leg in manipulator.legs
    )
    X = manipulator.home.X[: pose_size(manipulator.space)]
    return replace(manipulator, legs=legs, home=Home(X, manipulator.home.q))
