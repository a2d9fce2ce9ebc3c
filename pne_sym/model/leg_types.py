"""Which legs are of equal structure, and what their types are called.

Structure is what contract-wise cannot change with a parameter's value: joint
kinds and order, actuated and extra marks, axes along coordinate directions,
relations between neighbouring axes, zero offsets, massless links; which friction,
springs and motors there are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pne_sym.model.effects import Actuator, Friction, Spring
from pne_sym.model.manipulator import Leg, Vector3

TOLERANCE = 1e-9
Key = tuple[object, ...]


@dataclass(frozen=True)
class Structure:
    """Legs of equal structure.

    Attributes:
        name: of their leg type; "" where none of them has one.
        indices: positions of the legs in the manipulator.
    """

    name: str
    indices: tuple[int, ...]


def a_leg(architecture: str) -> str:
    """A leg by its architecture, whose letters are spelled.

    >>> a_leg("UPS"), a_leg("_RRR"), a_leg("SPS")
    ('a UPS leg', 'an _RRR leg', 'an SPS leg')
    """
    return f"a{'n' * (architecture.lstrip('_')[:1] in 'FHLMNRSX')} {architecture} leg"


def named_structures(
    legs: Sequence[Leg], written: Mapping[str, Key | None] | None = None
) -> tuple[Structure, ...]:
    """Legs grouped by structure, in order of first appearance, with names.

    The structure of a leg type as it is written has the type's name. Where overrides split a
    type, each other structure is called TYPE_NAME by the name of its first leg, else TYPE_legN.
    Of several names the first in the file is taken.

    Args:
        legs: with the names of their types.
        written: the structures of leg types as they are written, in the order of the file; None
            where that is not known: then it is that of the type's first leg.
    """
    keys = [structure_key(leg) for leg in legs]
    own = dict(written or {})
    for leg, key in zip(legs, keys, strict=True):
        if leg.type and own.get(leg.type) is None:
            own[leg.type] = key
    groups: dict[Key, list[int]] = {}
    for index, key in enumerate(keys):
        groups.setdefault(key, []).append(index)
    split = {t: {k for leg, k in zip(legs, keys, strict=True) if leg.type == t} for t in own}
    return tuple(
        Structure(_name(legs, key, indices, own, split), tuple(indices))
        for key, indices in groups.items()
    )


def _name(
    legs: Sequence[Leg],
    key: Key,
    indices: Sequence[int],
    own: Mapping[str, Key | None],
    split: Mapping[str, set[Key]],
) -> str:
    used = {legs[i].type for i in indices}
    types = [t for t in own if t in used]
    for name in types:
        if own[name] == key:
            return name
    for name in types:
        if len(split[name]) == 1:
            return name
    first = next((i for i in indices if legs[i].type), None)
    return "" if first is None else f"{legs[first].type}_{legs[first].name or f'leg{first + 1}'}"


def is_coordinate(axis: Sequence[float]) -> bool:
    """Whether an axis lies along a coordinate direction of its frame."""
    return sorted(abs(a) for a in axis) == [0.0, 0.0, 1.0]


def structure_key(leg: Leg) -> Key:
    """What two legs must share to be of one type."""
    joints = tuple(
        (
            joint.kind,
            joint.actuated,
            joint.extra,
            joint.link.is_massless,
            _axis_key(joint.axis),
            tuple(component == 0.0 for component in joint.offset),
            _present(joint.friction, joint.spring, joint.actuator),
            joint.has_stroke,
            joint.has_effort,
        )
        for joint in leg.joints
    )
    axes = np.array([joint.axis for joint in leg.joints])
    cosines, rounded = axes @ axes.T, np.rint(axes @ axes.T)
    relations = np.where(np.abs(cosines - rounded) < TOLERANCE, rounded, 2.0).astype(int)
    end = leg.platform_joint
    return (
        joints,
        tuple(relations.ravel()),
        end.kind,
        tuple(component == 0.0 for component in end.offset),
        _axis_key(end.axis_link),
        _axis_key(end.axis_platform),
        _present(end.friction),
    )


def _present(*effects: Friction | Spring | Actuator | None) -> tuple[object, ...]:
    """Which parameters there are of friction, springs and motors; their values are live."""
    return tuple(
        effect and tuple(name for name, value in vars(effect).items() if value is not None)
        for effect in effects
    )


def _axis_key(axis: Vector3 | None) -> object:
    if axis is None:
        return None
    return tuple(int(a) for a in axis) if is_coordinate(axis) else "general"
