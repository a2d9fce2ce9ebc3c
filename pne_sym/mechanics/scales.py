"""Lengths by which a leg's singularities are told and its moments weighed against its forces.

They are those of lever arms: of links, and at home of slides.  Where the origins of the base, the
platform and the links lie does not enter, so a base point and a platform point at the origins, or
a residue of them, spoil nothing.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from pne_sym.derivation import Book, Law
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.structure import LegType
from pne_sym.model.kinematics import at_home, chain_pose
from pne_sym.model.manipulator import Manipulator
from pne_sym.vector import Cross, Dot, Vector, ZeroVector, vector_sum

SMALLEST = 1e-3
"""A leg's length is at least this fraction of the machine's: wrists have no lever arms."""
_DIGITS = 6  # more would differ between machines by rounding


class HomeLengths(NamedTuple):
    """Lengths of a leg type at home, in metres.

    Attributes:
        arm: the largest lever arm about a turning joint of one of its legs, at least `least`.
        least: the smallest length that a leg of this machine is given.
    """

    arm: float
    least: float


def home_lengths(manipulator: Manipulator, leg_type: LegType) -> HomeLengths:
    """Lengths at home of the legs of a type.

    A machine whose axes all pass through the connection points has no length: then 1 m.
    """
    arms = lever_arms(manipulator)
    machine = max(arms) or 1.0
    own = max(arms[index] for index in leg_type.indices)
    least = SMALLEST * machine
    return HomeLengths(_short(max(own, least)), _short(least))


def lever_arms(manipulator: Manipulator) -> list[float]:
    """Per leg the largest arm of its connection point at home about a joint that turns, in metres.

    With pitch, where the joint has one; zero for a leg that only slides.
    """
    found = []
    for leg, q in zip(manipulator.legs, at_home(manipulator)[1], strict=True):
        turns = [joint.turns for joint in leg.joints]
        rates = np.array([joint.turn for joint in leg.joints])[turns]
        arms = np.linalg.norm(chain_pose(leg, q).velocities[:, turns], axis=0) / rates
        found.append(float(arms.max(initial=0.0)))
    return found


def _short(length: float) -> float:
    return float(f"{length:.{_DIGITS - 1}e}")


def with_size(book: Book, g: LegGeometry, home: HomeLengths) -> LegGeometry:
    """The geometry with the length by which the leg's singularities are told.

    It is made of the offsets and pitches beyond the first joint that turns, which are live, and
    of a number fixed at generation: the lever arm that slides make at home, or what keeps the
    length from vanishing with the offsets.
    """
    turning = [j for j in range(1, g.count + 1) if g.turns(j)]
    slides = any(g.slides(j) for j in range(min(turning, default=1), g.count + 1))
    squares = [_across_square(g, group, turning[0]) for group in turning]
    squares += [pitch**2 for pitch in g.pitch.values()]
    number = sp.Float(home.arm if slides else home.least)
    live = sp.Add(*squares)
    name, latex, law = g.name("size"), r"\ell", Law.LUMPING
    title = "length of the leg's lever arms, the measure of what is near singular"
    if live == 0:
        size = book.measured(name, number, "m", latex, title, law)
        return replace(g, size=size, arm=home.arm)
    what = (
        "largest lever arm at home, which slides make"
        if slides
        else "a thousandth of the largest lever arm at home, so that no offset is needed"
    )
    fixed = book.measured(g.name("size_0"), number, "m", r"\ell_0", what, law)
    size = book.define(name, sp.sqrt(fixed**2 + live), latex, title, law, parameter=True)
    return replace(g, size=size, arm=home.arm)


def _across_square(g: LegGeometry, group: int, first: int) -> Any:
    """Squared length of the offsets fixed in a group, across what its joints slide along.

    Along slides and the first axis that turns, an offset only tells where an origin was put.
    """
    offsets = [g.offset[i] for i in range(group + 1, g.count + 2) if g.group[i - 1] == group]
    offset = vector_sum(offsets)
    if offset == ZeroVector:
        return sp.S.Zero
    along = [group] if group == first or g.slides(group) else []
    for j in range(group + 1, g.count + 1):
        own = g.group[j] == group
        if own and not any(g.parallel(j, k) for k in along):
            along.append(j)
    if not along:
        return Dot(offset, offset)
    if len(along) == 1:
        across: Vector = Cross(g.e[along[0]], offset)
        return Dot(across, across)
    if len(along) == 2:
        return Dot(Cross(g.e[along[0]], g.e[along[1]]), offset) ** 2
    return sp.S.Zero
