"""What a derivation is for: outputs, types of legs, coordinates."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from pne_sym.derivation.actuation import Actuation


@dataclass(frozen=True)
class Output:
    """Where a quantity stands in an array that the generated code returns.

    Attributes:
        array: name of the array ("M", "Z", "H", "q", ...).
        value: vector, tensor (components in `frame`) or scalar symbol or expression.
        rows: (component, row) pairs; for a scalar ((0, row),).
        columns: likewise for the second index of a tensor, or of a vector that
            is laid along a row; empty where the array has one index.
        leg_type: set when there is one such quantity per leg of the type.
        leg_rows, leg_columns: offset added to the row or column, per leg.
        mirrored: the transposed entries are set too.
        symmetric: only the entries on and above the diagonal are computed.
        frame: in which the components are taken.
    """

    array: str
    value: Any
    rows: tuple[tuple[int, int], ...]
    columns: tuple[tuple[int, int], ...] = ()
    leg_type: str | None = None
    leg_rows: tuple[int, ...] = ()
    leg_columns: tuple[int, ...] = ()
    mirrored: bool = False
    symmetric: bool = False
    frame: str = "base"


@dataclass(frozen=True)
class LegTypeInfo:
    """What code generation needs to know of a leg type.

    Attributes:
        name: prefix of names.
        title: architecture notation.
        indices: positions of its legs in the manipulator.
        joints: number of chain joints.
        methods: per joint how inverse kinematics finds it.
        reasons: joint -> why there is no closed form.
        transmitted: number of moments that the platform joint transmits.
        orientation: rows of the Jacobian of an iterated closure whose determinant has home's
            sign on home's branch; none where the branch cannot be told so.
        orientation_sign: name of that sign among the branches.
        number: of the types of its architecture, from 1.
    """

    name: str
    title: str
    indices: tuple[int, ...]
    joints: int
    methods: tuple[str, ...]
    reasons: tuple[tuple[int, str], ...] = ()
    transmitted: int = 0
    orientation: tuple[int, ...] = ()
    orientation_sign: str = ""
    number: int = 1

    @property
    def is_closed(self) -> bool:
        """Whether every displacement has a closed form."""
        return "numeric" not in self.methods

    @property
    def unknowns(self) -> int:
        """Joints whose displacement is to be found (all but the extra ones)."""
        return sum(m != "given" for m in self.methods)


@dataclass(frozen=True)
class Coordinates:
    """Names and order of everything that goes in and comes out.

    Attributes:
        space: name of the task space.
        pose: names of the platform coordinates in X.
        rates: names of the platform's entries in V and A.
        wrench: names of the entries of a wrench.
        components: which of the six twist components the rates are.
        planar: everything happens in the plane z = 0.
        joints: (leg, joint) of every entry of q, counted from 0.
        actuators: (leg, joint) of every entry of tau, counted from 0.
        extras: (leg, joint) of the extra coordinates, counted from 0.
        constraints: leg of every entry of lambda.
        constraint_units: unit of every entry of lambda, N or N m.
        turning: for every entry of q whether whole turns change nothing (not so for a screw).
        home: X and q at home.
        actuation: what actuators and constraints determine, by generic rank.
        transmits_moments: some leg transmits a moment: leg reactions have six entries.
        names: of every entry of q, the leg's and the joint's: leg2_joint3 where they have none.
        limited: (leg, joint) of the entries of q that have limits.
        bounded: (leg, joint) of the entries of tau that have limits.
        overconstrained: how many constraints follow from the others.
        cases: numbers of the sections of the paper that apply, such as "3.1".
    """

    space: str
    pose: tuple[str, ...]
    rates: tuple[str, ...]
    wrench: tuple[str, ...]
    components: tuple[int, ...]
    planar: bool
    joints: tuple[tuple[int, int], ...]
    actuators: tuple[tuple[int, int], ...]
    extras: tuple[tuple[int, int], ...]
    constraints: tuple[int, ...]
    turning: tuple[bool, ...]
    home: tuple[tuple[float, ...], tuple[float, ...]]
    actuation: Actuation
    transmits_moments: bool = False
    constraint_units: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    limited: tuple[tuple[int, int], ...] = ()
    bounded: tuple[tuple[int, int], ...] = ()
    overconstrained: int = 0
    cases: tuple[str, ...] = ()

    @property
    def lengths(self) -> dict[str, int]:
        """Numbers of entries of what functions of a program take."""
        n = self.sizes
        return {"X": n["NQ"], "V": n["NV"], "A": n["NV"], "base": 18, "q": n["NJ"]}

    @property
    def position(self) -> int:
        """Number of the pose's entries that are its position; they come first."""
        return sum(k < 3 for k in self.components)

    @property
    def has_quaternion(self) -> bool:
        """Whether the orientation is given by a quaternion."""
        return len(self.pose) == self.position + 4

    @property
    def actuator_names(self) -> tuple[str, ...]:
        """Of the entries of tau."""
        return self.names_of(self.actuators)

    def names_of(self, joints: Iterable[tuple[int, int]]) -> tuple[str, ...]:
        """Names of joints, by leg and joint."""
        known = dict(zip(self.joints, self.names, strict=True))
        return tuple(known[joint] for joint in joints)

    @property
    def sizes(self) -> dict[str, int]:
        """NQ, NV, NU, NC, NW, NJ: sizes of X, V, tau, lambda, wrench, q; dependent constraints."""
        extra = len(self.extras)
        return {
            "NQ": len(self.pose) + extra,
            "NV": len(self.rates) + extra,
            "NU": len(self.actuators),
            "NC": len(self.constraints),
            "NW": len(self.wrench),
            "NJ": len(self.joints),
            "OVERCONSTRAINED": self.overconstrained,
        }
