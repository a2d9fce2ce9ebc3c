"""Right angles and common directions between the axes of a leg, which live axes must keep."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pne_sym.derivation import AxisRelation
from pne_sym.mechanics.structure import TOLERANCE, LegType, is_coordinate
from pne_sym.model.kinematics import Array


def axis_relations(leg_type: LegType) -> Iterator[AxisRelation]:
    """What holds between axes of a leg type whatever its displacements, where one is live.

    That is between axes with no joint between them that turns.
    """
    axes = list(_axes(leg_type))
    for k, (name, values) in enumerate(axes):
        for j in reversed(range(k)):
            yield from _relation(leg_type, axes[j], (name, values))
            if leg_type.model.joints[j].turns:
                break


def _axes(leg_type: LegType) -> Iterator[tuple[str, Array]]:
    """Name of the field and directions (legs, 3) of every axis of the chain."""
    for j in range(len(leg_type.model.joints)):
        name = f"{leg_type.name}_{leg_type.part('joint', j + 1)}_axis"
        yield name, leg_type.over_legs(lambda leg, j=j: leg.joints[j].axis)
    if leg_type.model.platform_joint.axis_link is not None:
        name = f"{leg_type.name}_platform_joint_axis_link"
        yield name, leg_type.over_legs(lambda leg: leg.platform_joint.axis_link)


def _relation(
    leg_type: LegType, first: tuple[str, Array], second: tuple[str, Array]
) -> Iterator[AxisRelation]:
    fixed = [is_coordinate(values[0]) for _, values in (first, second)]
    cosines = np.sum(first[1] * second[1], axis=1)
    rounded = round(float(cosines[0]))
    if all(fixed) or np.any(np.abs(cosines - rounded) >= TOLERANCE):
        return
    if fixed[0]:
        first, second = second, first
    along = tuple(int(v) for v in second[1][0])
    yield AxisRelation(leg_type.name, first[0], along if any(fixed) else second[0], rounded)
