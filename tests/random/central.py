"""Legs whose ends sit at the origins, or a residue of CAD away; platforms on a central guide."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pne_sym.model.manipulator import Manipulator
from tests.oracle.mechanisms import mechanism
from tests.whole.rewriting import MOVING_ORIGIN, Rewriting, no_shifts

RESIDUES = (0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-6)
"""How far an end that is meant to sit at an origin is off, m."""
GUIDES = ("Rz0 Ry Px | rigid", "Rz Ry Px | rigid", "Rz0 Ry Px Rx | rigid", "Rz0 Ry Px | U")
"""Central legs of Tricept and Quadrupod, and others that leave more degrees of freedom."""
_SHARE = 0.25


def with_ends_at_origins(manipulator: Manipulator, rng: np.random.Generator) -> Manipulator:
    """The mechanism, now and then told from where one of its legs begins and ends."""
    if rng.random() > _SHARE:
        return manipulator
    return central(manipulator, int(rng.integers(len(manipulator.legs))), rng)


def central(manipulator: Manipulator, number: int, rng: np.random.Generator) -> Manipulator:
    """The mechanism told from the ends of a leg, or from nearby."""
    leg, shifts = manipulator.legs[number], no_shifts(manipulator)
    flat = np.array([1.0, 1.0, 0.0 if manipulator.space.value in ("point", "planar") else 1.0])
    residue = float(rng.choice(RESIDUES)) * flat
    base = residue * rng.uniform(-1.0, 1.0, 3) - np.array(leg.base_point)
    platform = np.zeros(3)
    if manipulator.space in MOVING_ORIGIN:
        platform = np.array(leg.platform_point) - residue * rng.uniform(-1.0, 1.0, 3)
    return Rewriting(manipulator, replace(shifts, base=base, platform=platform)).after


def guided(rng: np.random.Generator) -> Manipulator:
    """Extensible legs, as many as degrees of freedom or one more, and a passive guide."""
    guide = str(rng.choice(GUIDES))
    joints, end = guide.split(" | ")
    dofs = len(joints.split()) + 2 * (end == "U")  # a cross has two of its own
    count = dofs + int(rng.random() < 0.4)
    drawn = mechanism("spatial", [*["Rz0 Ry Px* | S"] * count, guide], rng, plain=True)
    return central(replace(drawn, name="guided"), count, rng)
