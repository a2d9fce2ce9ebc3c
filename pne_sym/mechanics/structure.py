"""Leg types: legs of equal structure are derived once.

Structure is what contract-wise cannot change with a parameter's value: joint
kinds and order, driven and extra marks, axes along coordinate directions,
relations between neighbouring axes, zero offsets, massless links; which friction,
springs, motors and limits of displacement there are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pne_sym.model.effects import Actuator, Friction, Spring
from pne_sym.model.manipulator import Joint, Leg, Manipulator, Vector3

TOLERANCE = 1e-9
Array = NDArray[np.float64]


@dataclass(frozen=True)
class LegType:
    """Legs of equal structure.

    Attributes:
        name: prefix of the names of this type, such as "ups".
        architecture: such as "UPS", driven joints underlined as _P.
        indices: positions of the legs in the manipulator.
        legs: the legs themselves.
        number: of the types of its architecture, from 1.
    """

    name: str
    architecture: str
    indices: tuple[int, ...]
    legs: tuple[Leg, ...]
    number: int = 1

    @property
    def model(self) -> Leg:
        """A leg whose structure stands for all."""
        return self.legs[0]

    @property
    def count(self) -> int:
        """Number of legs of this type."""
        return len(self.legs)

    def over_legs(self, pick: object) -> Array:
        """Numbers picked from every leg, stacked."""
        assert callable(pick)
        return np.array([pick(leg) for leg in self.legs], dtype=float)


def is_coordinate(axis: Sequence[float]) -> bool:
    """Whether an axis lies along a coordinate direction of its frame."""
    return sorted(abs(a) for a in axis) == [0.0, 0.0, 1.0]


def leg_types(manipulator: Manipulator) -> tuple[LegType, ...]:
    """Group the legs by structure, in order of first appearance."""
    groups: dict[object, list[int]] = {}
    for index, leg in enumerate(manipulator.legs):
        groups.setdefault(structure_key(leg), []).append(index)
    types: list[LegType] = []
    used: dict[str, int] = {}
    for indices in groups.values():
        legs = tuple(manipulator.legs[i] for i in indices)
        architecture = architecture_of(legs[0])
        stem = architecture.replace("_", "").replace("*", "").lower()
        used[stem] = used.get(stem, 0) + 1
        name = stem if used[stem] == 1 else f"{stem}{used[stem]}"
        types.append(LegType(name, architecture, tuple(indices), legs, used[stem]))
    return tuple(types)


def structure_key(leg: Leg) -> tuple[object, ...]:
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
        )
        for joint in leg.joints
    )
    axes = np.array([joint.axis for joint in leg.joints])
    relations = np.rint(np.where(_near_integer(axes @ axes.T), axes @ axes.T, 2.0)).astype(int)
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


def _near_integer(values: Array) -> NDArray[np.bool_]:
    return np.asarray(np.abs(values - np.rint(values)) < TOLERANCE, dtype=np.bool_)


def architecture_of(leg: Leg) -> str:
    """Architecture notation: U for a massless cross, driven joints as _P, extra as R*."""
    letters: list[str] = []
    joints = leg.joints
    j = 0
    while j < len(joints):
        joint = joints[j]
        following = joints[j + 1] if j + 1 < len(joints) else None
        mark = "_" if joint.actuated else ""
        if following is not None and _is_cross(joint, following):
            letters.append("_U" if following.actuated else "U")
            j += 2
            continue
        letters.append(mark + joint.kind.in_architecture + ("*" if joint.extra else ""))
        j += 1
    return "".join(letters) + leg.platform_joint.kind.in_architecture


def _is_cross(joint: Joint, following: Joint) -> bool:
    """Whether two joints are the axes of a massless cross."""
    return (
        joint.kind.is_hinge
        and following.kind.is_hinge
        and joint.link.is_massless
        and not (joint.actuated or joint.extra or following.extra)
        and not any(following.offset)
        and abs(float(np.dot(joint.axis, following.axis))) < TOLERANCE
    )
