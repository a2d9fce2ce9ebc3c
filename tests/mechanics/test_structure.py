"""Which legs are of one type, and in which order what belongs to legs of several types stands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pne_sym.mechanics.derive import derive
from pne_sym.model.leg_types import structure_key
from pne_sym.model.manipulator import Leg, Vector3
from tests.models import catalogue
from tests.oracle.mechanisms import mechanism

TILTED: Vector3 = (0.6, 0.8, 0.0)


def leg_with(second: Vector3) -> Leg:
    """A leg whose first two axes, tilted in their frames, are these."""
    leg = catalogue("stewart").legs[0]
    first, other, *rest = leg.joints
    joints = (replace(first, axis=TILTED), replace(other, axis=second), *rest)
    return replace(leg, joints=joints)


def test_right_angles_and_common_directions_are_structure() -> None:
    across, along, skew, flat = (
        structure_key(leg_with(axis))
        for axis in ((-0.8, 0.6, 0.0), TILTED, (0.0, 0.6, 0.8), (0.0, 0.28, 0.96))
    )
    assert len({across, along, skew}) == 3
    assert skew == flat


def test_constraints_are_in_the_order_of_the_legs() -> None:
    """Not of their types, where these take turns."""
    legs = ["Rz Px* | S", "Ry* Rz | S", "Rz Px* | S", "Rz Ry Px* | S"]
    drawn = mechanism("spatial", legs, np.random.default_rng(7), plain=True)
    derivation = derive(replace(drawn, name="drawn"))
    coordinates = derivation.coordinates
    assert coordinates is not None
    assert derivation.leg_types[0].indices == (0, 2)
    assert coordinates.constraints == (0, 1, 2)
