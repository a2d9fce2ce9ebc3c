"""Geometry of a leg type: its parameters, constant vectors and canonical frames, as they are used.

`leg_frames` makes it.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp

from pne_sym.mechanics.directions import pattern_of
from pne_sym.mechanics.structure import TOLERANCE, LegType
from pne_sym.model.joint_kinds import JointKind
from pne_sym.model.kinematics import Array
from pne_sym.vector import Vector, VectorSymbol, ZeroVector
from pne_sym.vector.nodes import scale

_NUMBER = re.compile(r"(?<=_)\d+(?=_|$)")


@dataclass(frozen=True)
class LegGeometry:
    """Symbols and frames of a leg type.

    Attributes:
        leg_type: the leg type.
        e: axis vectors by joint number 1..m.
        offset: offset vectors a_1..a_{m+1} by joint number (m+1: the tip).
        group: group of link j by joint number (link 0: the base).
        zero_turn: (cos, sin) of the angle from turn frame to canonical frame at
            zero displacement, by joint number.
        turn_axes: axes of the turn frame as columns in the canonical axes before it, 0, 1, -1
            by rows; by joint number, where the structure fixes them.
        base_point, platform_point: b and q.
        pitch: pitch symbols of helical joints, by joint number.
        pairs: where the leg transmits moments, directions (fixed in the last link,
            fixed in the platform) that the platform joint keeps perpendicular.
        end_pattern: canonical components of the platform joint's axis in the last link:
            0, 1, -1 by structure, else None.
        size: length of the leg's lever arms (scalar parameter), see `scales`.
        arm: the same at home, in numbers.
        axes_at: axis directions (legs, joints, 3) in leg axes with all joints at
            zero, and with extra joints at arbitrary displacements.
        canonical: canonical axes as columns in spec axes (legs, 3, 3), by group.
        zero_angle: (legs, 2) numeric (cos, sin) of zero_turn, by joint.
        bent_helices: helical joints that turn the connection point about their axes.
        unseen: revolute joints whose axes pass through the connection point.
        pure_moment: the wrench that the leg leaves out is a pure moment at home.
        completion: basis completion of a leg that lacks degrees of freedom, in space.
        composite: the leg's inertia is written in the accelerations of its joints.
        exact_frames: groups whose canonical axes are coordinate directions.
    """

    leg_type: LegType
    e: dict[int, VectorSymbol] = field(default_factory=dict)
    offset: dict[int, Vector] = field(default_factory=dict)
    group: dict[int, int] = field(default_factory=dict)
    zero_turn: dict[int, tuple[Any, Any]] = field(default_factory=dict)
    turn_axes: dict[int, tuple[Any, ...]] = field(default_factory=dict)
    pitch: dict[int, Any] = field(default_factory=dict)
    base_point: Any = None
    platform_point: Any = None
    size: Any = None
    arm: float = 1.0
    pairs: list[tuple[VectorSymbol, VectorSymbol]] = field(default_factory=list)
    end_pattern: tuple[Any, ...] = ()
    axes_at: list[Array] = field(default_factory=list)
    canonical: dict[int, Array] = field(default_factory=dict)
    exact_frames: set[int] = field(default_factory=set)
    zero_angle: dict[int, Array] = field(default_factory=dict)
    bent_helices: set[int] = field(default_factory=set)
    unseen: set[int] = field(default_factory=set)
    pure_moment: bool = False
    completion: tuple[Any, ...] = ()
    composite: bool = False

    @property
    def count(self) -> int:
        """Number of joints."""
        return len(self.leg_type.model.joints)

    def name(self, stem: str) -> str:
        """The stem under the leg type's name, whatever other types there are.

        A number after an underscore is that of a joint: the joint's own name stands in its
        place where it has one.
        """
        named = _NUMBER.sub(lambda number: self.leg_type.label(int(number[0])), stem)
        return f"{self.leg_type.name}_{named}"

    def kind(self, j: int) -> JointKind:
        """Kind of joint j."""
        return self.leg_type.model.joints[j - 1].kind

    def turns(self, j: int) -> bool:
        """Whether joint j turns its link (opens a group)."""
        return self.kind(j).turns

    def slides(self, j: int) -> bool:
        """Whether joint j moves its link along the axis."""
        return self.kind(j).slides

    def turn(self, j: int) -> Any:
        """Angle of joint j per unit of its displacement."""
        return sp.sympify(self.kind(j).turn(self.pitch.get(j)))

    def advance(self, j: int) -> Any:
        """Motion along axis j per unit of its displacement."""
        return sp.sympify(self.kind(j).advance(self.pitch.get(j)))

    def spin(self, j: int) -> Vector:
        """Angular velocity of link j against the link before it, per unit rate."""
        return scale(self.turn(j), self.e[j])

    def slide(self, j: int) -> Vector:
        """Velocity of link j along its axis, per unit rate."""
        return scale(self.advance(j), self.e[j])

    def is_unseen(self, j: int) -> bool:
        """Whether turning joint j leaves the connection point where it is."""
        return j in self.unseen

    def acts_as_slide(self, j: int) -> bool:
        """Whether joint j moves the connection point along its axis only.

        So does a slide, and a helical joint beyond which all offsets lie along its axis.
        """
        return self.slides(j) and j not in self.bent_helices

    def is_extra(self, j: int) -> bool:
        """Whether joint j's displacement is a coordinate of its own."""
        return self.leg_type.model.joints[j - 1].extra

    def frame(self, kind: str, group: int) -> str:
        """Frame name: kind is "spec", "turn" or "axes"."""
        return f"{self.leg_type.name}.{self.leg_type.part(kind, group)}"

    def parallel(self, j: int, k: int) -> int:
        """+1 or -1 when axes j and k are parallel by structure, else 0."""
        dots = np.concatenate([np.sum(a[:, j - 1] * a[:, k - 1], axis=1) for a in self.axes_at])
        if np.all(dots > 1 - TOLERANCE):
            return 1
        return -1 if np.all(dots < -1 + TOLERANCE) else 0

    def same_freedom(self, extra: int) -> tuple[int, int]:
        """The joint next to an extra one that moves all beyond both as it does, and +1 or -1.

        Two slides along one direction, or two revolute joints about one line; (0, 0) if none.
        """
        for k in (extra - 1, extra + 1):
            if not 1 <= k <= self.count or self.is_extra(k) or self.pitch.keys() & {k, extra}:
                continue
            sign = self.parallel(extra, k)
            on_line = not self.turns(k) or self.offset[max(k, extra)] == ZeroVector
            if sign and on_line and self.turns(k) == self.turns(extra):
                return k, sign
        return 0, 0

    def same_axes(self) -> Iterator[tuple[str, str]]:
        """Names of the axes of joints that point the same way by structure, in pairs."""
        for j, k in itertools.combinations(self.e, 2):
            between = (i for i in range(j + 1, k) if self.turns(i))
            if self.parallel(j, k) == 1 and all(self.parallel(j, i) for i in between):
                yield self.e[j].name, self.e[k].name

    def axis_pattern(self, group: int, j: int) -> tuple[Any, ...]:
        """Axis j in the canonical axes of a group: 0, 1, -1 by structure, else None."""
        values = np.einsum("lji,lj->li", self.canonical[group], self.axes_at[0][:, j - 1])
        return pattern_of(values)

    def offset_is_zero(self, group: int, j: int) -> tuple[bool, bool, bool]:
        """Which canonical components of offset j vanish by structure."""
        if group not in self.exact_frames:
            return (False, False, False)
        local = self.canonical[group][0].T @ np.array(self.leg_type.model.offsets[j - 1])
        return tuple(bool(v == 0.0) for v in local)  # type: ignore[return-value]

    def perpendicular(self, j: int, k: int) -> bool:
        """Whether axes j and k are perpendicular by structure."""
        dots = [np.sum(a[:, j - 1] * a[:, k - 1], axis=1) for a in self.axes_at]
        return bool(np.max(np.abs(dots)) < TOLERANCE)
