"""Mechanisms beyond the catalogue, in the notation of `tests.oracle.mechanisms`."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import checked
from tests.oracle.mechanisms import mechanism
from tests.oracle.test_oracle import STRUCTURES as COMMON

_TWO = ["Rz* Ry Px* | S"] * 2  # legs that fill up the actuators

STRUCTURES: dict[str, tuple[str, list[str]]] = COMMON | {
    "extra slide between": ("spatial", ["Rz* Px*+ Ry Px* | S", *_TWO]),
    "extra slide last": ("spatial", ["Rz* Ry Px* Pz+* | S", *_TWO]),
    "tilted extra slide last": ("spatial", ["Rz* Ry Px* Pt+* | S", *_TWO]),
    "extra slide first": ("spatial", ["Px+* Rz* Ry Px* | S", *_TWO]),
    "extra slide before a revolute": ("spatial", ["Rz* Ry* Px+* Ry | S", *_TWO]),
    "extra revolute between": ("spatial", ["Rz* Rx+* Ry* Ry | S", *_TWO]),
    "extra revolute at one point": ("spatial", ["Rz0 Rx+* Ry* Ry* | S", *_TWO]),
    "extra helix": ("spatial", ["Rz* Hz+* Ry Px* | S", *_TWO]),
    "helix at the base": ("spatial", ["Hz* Ry Px* | S", *_TWO]),
    "three slides": ("spatial", ["Px* Py* Pz | S", *_TWO]),
    "tilted universal and slide": ("spatial", ["Rt* Rt Pt* | S", *_TWO]),
    "tilted revolutes": ("spatial", ["Rt* Rt* Rt | S", *_TWO]),
    "tilted slide at the base": ("spatial", ["Pt* Rt* Rt | S", *_TWO]),
    "offset universal, rotary actuators": ("spatial", ["Rz* Rx0* Ry | S", *_TWO]),
    "cylindrical at the base": ("spatial", ["Rz* Pz* Ry | S", *_TWO]),
    "slide last across": ("spatial", ["Ry* Rz* Py | S", *_TWO]),
    "planar, extra slides": (
        "planar",
        ["Px*+ Rz* Rz | R", "Rz Px*+ Px* | R", "Rz* Rz | R", "Rz* Px Py+* | R"],
    ),
    "planar, slides alone": ("planar", ["Px* Py | R", "Pt* Rz | R", "Rz* Pt | R"]),
    "planar, extra revolute last": (
        "planar",
        ["Px* Rz* Rz+ | R", "Px* Rz+* Py | R", "Rz Px* | R", "Rz* Rz | R"],
    ),
    "point, extra slide": ("point", ["Pt*+ Rz Px* | R", "Rz Pt* | R"]),
    "one slide": ("spatial", ["Pt | S", *_TWO]),
    "one helix": ("spatial", ["Ht | S", *_TWO]),
    "one revolute": ("spatial", ["Rt | S", *_TWO]),
    "one slide, universal at the platform": ("spatial", ["Pt | U", *_TWO, *_TWO]),
    "two revolutes, universal at the platform": ("spatial", ["Rt Rt | U", *_TWO, *_TWO]),
    "four joints, revolute at the platform": ("spatial", ["Rt Rt Pt Rt | R", *_TWO, *_TWO]),
    "two joints, revolute at the platform": ("spatial", ["Rt Pt | R", *_TWO, *_TWO]),
    "one helix, revolute at the platform": ("spatial", ["Ht | R", *_TWO, *_TWO]),
    "four revolutes, rigid at the platform": ("spatial", ["Rt Rt Rt Rt | rigid", *_TWO]),
    "spherical, three revolutes": (
        "spherical",
        ["Rz* Ry Rx | S", "Rz Ry Px* | S", "Px Ry* Rx | S"],
    ),
    "translational, three slides": (
        "translational",
        ["Px* Rx Ry | S", "Rz* Rx Ry | S", "Px* Ry Rz | S"],
    ),
}

REFUSED: dict[str, str] = {
    "planar, rigid at the platform": "platform_joint.kind: value 'rigid'; expected R or S",
    "planar, constrained": "platform_joint.kind: value 'rigid'; expected R or S",
}
"""Structures outside the method -> part of the message."""


@cache
def drawn(name: str, seed: int = 11) -> Manipulator:
    """A random mechanism of a structure, as the reader of specifications takes it."""
    space, legs = STRUCTURES[name]
    found = mechanism(space, legs, np.random.default_rng(seed))
    return checked(replace(found, name="drawn"))
