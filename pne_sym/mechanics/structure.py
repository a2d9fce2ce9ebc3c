"""Leg types: legs of equal structure are derived once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pne_sym.model.kinematics import Array
from pne_sym.model.leg_types import TOLERANCE, is_coordinate, named_structures
from pne_sym.model.manipulator import Joint, Leg, Manipulator

__all__ = ["TOLERANCE", "LegType", "architecture_of", "is_coordinate", "leg_types"]


@dataclass(frozen=True)
class LegType:
    """Legs of equal structure.

    Attributes:
        name: prefix of the names of this type, such as "ups".
        architecture: such as "UPS", actuated joints underlined as _P.
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

    def label(self, j: int) -> str:
        """What joint j (from 1) is called in names: its own name, else its number."""
        named = 1 <= j <= len(self.model.joints) and self.model.joints[j - 1].name
        return named or str(j)

    def part(self, word: str, j: int) -> str:
        """A word with the label of joint j: joint2, joint_knee."""
        label = self.label(j)
        return f"{word}{label}" if label.isdigit() else f"{word}_{label}"

    def over_legs(self, pick: object) -> Array:
        """Numbers picked from every leg, stacked."""
        assert callable(pick)
        return np.array([pick(leg) for leg in self.legs], dtype=float)


def leg_types(manipulator: Manipulator) -> tuple[LegType, ...]:
    """Group the legs by structure, in order of first appearance.

    A type has the name that the specification gives it, else one of its architecture.
    """
    groups = named_structures(manipulator.legs)
    taken = {group.name for group in groups}
    types: list[LegType] = []
    used: dict[str, int] = {}
    for group in groups:
        legs = tuple(manipulator.legs[i] for i in group.indices)
        architecture = architecture_of(legs[0])
        used[architecture] = used.get(architecture, 0) + 1
        name = group.name or _unused(architecture, taken)
        taken.add(name)
        types.append(LegType(name, architecture, group.indices, legs, used[architecture]))
    return tuple(types)


def _unused(architecture: str, taken: set[str]) -> str:
    """The letters of an architecture, with a number where a type has this name already."""
    stem = architecture.replace("_", "").replace("*", "").lower()
    names = (stem, *(f"{stem}{k}" for k in range(2, len(taken) + 2)))
    return next(name for name in names if name not in taken)


def architecture_of(leg: Leg) -> str:
    """Architecture notation: U for a massless cross, actuated joints as _P, extra as R*."""
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
