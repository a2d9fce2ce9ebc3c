"""Limits of joints at a pose: how far displacements are from them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pne_sym.model.closure import CLOSED
from pne_sym.model.entry import Entry
from pne_sym.model.manipulator import Home, Joint, Leg


def margin(joint: Joint, displacement: float) -> float:
    """Distance to the nearer limit of displacement, negative beyond it; infinite where none is.

    Of a hinge that is no extra coordinate a full turn changes nothing: the displacement counts
    that is nearest to the middle of the range.

    >>> from pne_sym.model.effects import Limits
    >>> from pne_sym.model.manipulator import JointKind
    >>> slide = Joint(JointKind("P"), (1.0, 0.0, 0.0), limits=Limits((0.25, 1.0)))
    >>> margin(slide, 0.5), margin(slide, 1.5)
    (0.25, -0.5)
    """
    if joint.limits is None or joint.limits.displacement is None:
        return math.inf
    least, largest = joint.limits.displacement
    middle, half = (least + largest) / 2, (largest - least) / 2
    off = displacement - middle
    if joint.kind.is_hinge and not joint.extra:
        off = math.remainder(off, math.tau)
    return half - abs(off)


def check_limits(entry: Entry, home: Home, legs: Sequence[Leg]) -> None:
    """Refuse a home outside the limits of its joints.

    Raises:
        SpecError: the first joint that is beyond one.
    """
    displacements = iter(home.q)
    for i, leg in enumerate(legs):
        for j, joint in enumerate(leg.joints):
            value = next(displacements)
            if margin(joint, value) < -CLOSED and joint.limits and joint.limits.displacement:
                least, largest = joint.limits.displacement
                raise entry.fault(
                    f"a displacement from {least:g} to {largest:g} {joint.kind.unit} there, the "
                    f"limits of legs[{i}].joints[{j}], or wider limits",
                    problem=f"home.q has {value:.6g} {joint.kind.unit} at degree of freedom {j} of "
                    f"legs[{i}]",
                )
