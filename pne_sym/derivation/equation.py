"""Equations, laws, notation: the proof as data.

A derivation is a list of chapters; a chapter is a list of equations, each of
which defines one named vector, tensor or scalar by names that stand before it.
Nothing is expanded: every right-hand side is short.
"""

from __future__ import annotations

import enum
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import sympy as sp

from pne_sym.derivation.actuation import Actuation
from pne_sym.derivation.frames import BodyFrame
from pne_sym.derivation.parameters import ParameterTable
from pne_sym.vector import (
    LegSum,
    LinearForm,
    RuleApplication,
    TensorLegSum,
    TensorSymbol,
    VectorLegSum,
    VectorSymbol,
)


class Law(enum.StrEnum):
    """Why an equation holds."""

    DEFINITION = "definition"
    GEOMETRY = "geometry"
    LOOP_CLOSURE = "loop closure"
    RATE = "time derivative"
    RECIPROCITY = "reciprocal basis"
    NEWTON = "Newton"
    EULER = "Euler"
    FREEDOM = "component along the joint's axis"
    REDUCTION = "reduction to the connection point"
    RULES = "Rules I and II"
    ASSEMBLY = "equilibrium of the platform"
    FRICTION = "friction"
    SPRING = "spring"
    ROTOR = "rotor"
    COUPLING = "coupling"
    LIMIT = "limit"
    MOVING_FRAME = "moving frame"
    ENERGY = "energy"
    LUMPING = "lumped parameter"


class Role(enum.StrEnum):
    """What a quantity is in the mechanics, where other stages need to know it."""

    POSITION = "position of the platform origin"
    VELOCITY = "velocity of the platform origin"
    ACCELERATION = "acceleration of the platform origin"
    ROTATION = "rotation of the platform"
    ANGULAR_VELOCITY = "angular velocity of the platform"
    ANGULAR_ACCELERATION = "angular acceleration of the platform"
    GRAVITY = "acceleration of gravity"
    BASE_ROTATION = "rotation from base axes to world axes"
    BASE_ANGULAR_VELOCITY = "angular velocity of the base"
    BASE_ANGULAR_ACCELERATION = "angular acceleration of the base"
    BASE_ACCELERATION = "acceleration of the base origin, without gravity"
    POINT = "from the leg's base point to its connection point"
    POINT_VELOCITY = "velocity of the connection point"
    POINT_ACCELERATION = "acceleration of the connection point"
    COLLECTED_ACCELERATION = "that acceleration without its centripetal part"
    BIAS = "acceleration of the connection point without joint accelerations"
    DISPLACEMENT = "displacement of a joint"
    RATE = "rate of a joint"
    JOINT_ACCELERATION = "acceleration of a joint"
    RECIPROCAL = "reciprocal vector of a joint"
    RESOLVED = "vector beyond a joint, resolved along its link"
    LEG_INERTIA = "coefficient of the acceleration in a leg's force"
    LEG_BIAS = "remainder of a leg's force"


_JOINT_STATE = (Role.DISPLACEMENT, Role.RATE, Role.JOINT_ACCELERATION)


@dataclass(frozen=True)
class Quantity:
    """What a name stands for.

    Attributes:
        name: unique within the derivation; the stem of the names in the code.
        latex: how the report writes it.
        meaning: in words.
        unit: SI unit, or "-".
        body: name of the body in which the vector or tensor is naturally
            observed (a hint for the lowering, nothing else depends on it).
        parameter: the quantity is a parameter or made of parameters alone.
        role: what it is in the mechanics, where other stages ask for it.
        leg_type: the leg type that has it, or "" for the platform's.
        joint: the joint that it belongs to, from 1; 0 for none.
        remainder_of: the quantity whose remainder (Eq. 4) it is, or "".
    """

    name: str
    latex: str
    meaning: str
    unit: str = "-"
    body: str | None = None
    parameter: bool = False
    role: Role | None = None
    leg_type: str = ""
    joint: int = 0
    remainder_of: str = ""


@dataclass(frozen=True)
class Given:
    """A vector, tensor or scalar that is given: parameter, constant or state.

    Attributes:
        symbol: the symbol.
        frame: name of the frame in which the components are given ("" for scalars).
        components: SymPy symbols and numbers; 1, 3 or 9 (row by row).
    """

    symbol: Any
    frame: str
    components: tuple[Any, ...]


PLATFORM = "platform"
"""Name of the frame fixed in the platform."""


@dataclass(frozen=True)
class Frame:
    """A frame of axes, seen from its parent.

    Attributes:
        name: unique name.
        parent: name of the parent frame; None for the base.
        rotation: nine entries row by row, parent_R_child; numbers, symbols, or
            None where the entry is to be taken from `axes` or `rows`.
        axes: the child's x, y, z axes as vectors known in the parent frame.
        rows: the parent's x, y, z axes as vectors known in the child frame.
        angle: (cosine, sine) symbols of a turn about the common z axis, or None.
    """

    name: str
    parent: str | None
    rotation: tuple[Any, ...] | None = None
    axes: tuple[Any, ...] | None = None
    rows: tuple[Any, ...] | None = None
    angle: tuple[Any, Any] | None = None


class Trouble(enum.StrEnum):
    """Why a state is impossible."""

    UNREACHABLE = "unreachable"
    SINGULAR = "singular"


@dataclass(frozen=True)
class Condition:
    """What must hold for an equation to be usable.

    UNREACHABLE: value >= 0.  SINGULAR: |value| > tolerance^power * scale.

    Attributes:
        trouble: what it means when the condition fails.
        value: scalar expression.
        scale: scalar made of parameters alone, of the value's unit.
        power: 1 for a value, 2 for a squared value.
    """

    trouble: Trouble
    value: Any
    scale: Any = sp.S.Zero
    power: int = 1


@dataclass(frozen=True)
class Equation:
    """One named equation, lhs = rhs.

    Attributes:
        id: cited in report and code: the name that it defines, ups-q_3 of leg type ups.
        title: what the equation says, in words.
        lhs: the symbol that the equation defines.
        rhs: vector, tensor or scalar expression in earlier names.
        law: why it holds.
        reference: the paper's equation or section.
        forms: further expressions of the same value that may lower better.
        steps: uses of Rules I and II that lead to the right-hand side.
        expanded: what stood before Rules I and II were used.
        conditions: what must hold for the equation to be usable.
    """

    id: str
    title: str
    lhs: Any
    rhs: Any
    law: Law
    reference: str = ""
    forms: tuple[Any, ...] = ()
    steps: tuple[RuleApplication, ...] = ()
    expanded: Any = None
    conditions: tuple[Condition, ...] = ()

    @property
    def name(self) -> str:
        """Name of the quantity that is defined."""
        return str(self.lhs.name)

    @property
    def uses(self) -> tuple[str, ...]:
        """Names on the right-hand side, sorted."""
        return tuple(sorted(names_in(self.rhs)))


@dataclass(frozen=True)
class ReciprocalBasis:
    """Vectors w_j with w_j . v_k = delta_jk, solved for by the structure of the v_k.

    Attributes:
        id: the equations' id.
        vectors: names of the v_k; two in the plane, three in space.
        duals: names of the w_j; of the first few only, where no other is needed.
        scales: sizes of the v_k, made of parameters alone, by which a singular
            basis is recognised.
        frames: names of frames in which the basis may be solved.
        rows: further rows of scalars, one entry per vector: where the leg transmits
            moments, the parts of the joints' axes along the moment directions.
        moment_duals: per vector, the scalars that multiply the moment directions.
        length: a length of the leg, made of parameters alone, that makes moment rows
            comparable with the others.
    """

    id: str
    vectors: tuple[Any, ...]
    duals: tuple[Any, ...]
    scales: tuple[Any, ...]
    frames: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...] = ()
    moment_duals: tuple[tuple[Any, ...], ...] = ()
    length: Any = sp.S.One


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


@dataclass(frozen=True)
class Chapter:
    """A run of equations on one subject.

    Attributes:
        id: prefix of the equations' ids.
        title: for people.
        leg_type: name of the leg type the chapter is about, or None.
        text: an opening paragraph, Markdown.
        equations: in order.
    """

    id: str
    title: str
    leg_type: str | None
    text: str
    equations: tuple[Equation, ...]


@dataclass(frozen=True)
class Derivation:
    """The whole derivation of a manipulator.

    Attributes:
        chapters: in order; names are defined before they are used.
        notation: by name.
        bases: reciprocal bases.
        givens: components of what is given.
        frames: frames, parents first.
        body_frames: those of them that are the axes of a body.
        pose: components of what describes the platform's rotation; no program needs it.
        parameters: the live parameters.
        outputs: what the generated code returns.
        leg_types: the leg types, in order of first appearance.
        coordinates: names and order of what goes in and comes out.
        collected: name -> coefficients of the accelerations and remainder, by their names;
            None where only the remainder is wanted.
    """

    chapters: tuple[Chapter, ...]
    notation: dict[str, Quantity] = field(default_factory=dict)
    bases: tuple[ReciprocalBasis, ...] = ()
    givens: tuple[Given, ...] = ()
    frames: tuple[Frame, ...] = ()
    body_frames: tuple[BodyFrame, ...] = ()
    pose: tuple[Given, ...] = ()
    parameters: ParameterTable = field(default_factory=ParameterTable)
    outputs: tuple[Output, ...] = ()
    leg_types: tuple[LegTypeInfo, ...] = ()
    coordinates: Coordinates | None = None
    collected: dict[str, LinearForm | None] = field(default_factory=dict)

    def equations(self) -> Iterator[Equation]:
        """All equations in order."""
        for chapter in self.chapters:
            yield from chapter.equations

    def rotations(self) -> Iterator[Equation]:
        """How axes of bodies are turned: for readers, programs take components from the frames."""
        for body in self.body_frames:
            if body.equation is not None:
                yield body.equation

    def leg_state(self) -> Iterator[Quantity]:
        """Scalars of a leg that are given: extra coordinates, what is found by iteration."""
        defined = {e.name for e in self.equations()}
        for quantity in self.notation.values():
            if quantity.joint and quantity.role in _JOINT_STATE and quantity.name not in defined:
                yield quantity

    def with_role(self, role: Role) -> Quantity | None:
        """The platform's quantity with a role, or None."""
        found = (q for q in self.notation.values() if q.role is role and not q.leg_type)
        return next(found, None)

    def definition(self, name: str) -> Equation:
        """The equation that defines a name.

        Raises:
            KeyError: nothing defines it (it is given).
        """
        for equation in (*self.equations(), *self.rotations()):
            if equation.name == name:
                return equation
        raise KeyError(name)


@lru_cache(1 << 16)  # of whole equations, again and again
def names_in(expr: Any) -> frozenset[str]:
    """All names that occur in an expression."""
    if isinstance(expr, VectorSymbol | TensorSymbol | sp.Symbol):
        return frozenset((str(expr.name),))
    return frozenset().union(*map(names_in, getattr(expr, "args", ())))


def full_names(derivation: Derivation, name: str) -> list[str]:
    """A quantity's names with their leg types: a name without type is of all types that have it.

    q_2 is rpr_q_2 and prr_q_2, q_2_rpr is rpr_q_2; what is no such quantity is returned as it is.
    """
    if name in derivation.notation:
        return [name]
    types = [info.name for info in derivation.leg_types]
    found = (f"{of}_{text}" for of in types for text in (name, name.removesuffix(f"_{of}")))
    return [n for n in dict.fromkeys(found) if n in derivation.notation] or [name]


def full_name(derivation: Derivation, name: str) -> str:
    """The same where one type has it; what several have is returned as it is."""
    found = full_names(derivation, name)
    return found[0] if len(found) == 1 else name


def leg_sums(expr: Any) -> list[Any]:
    """The sums over legs in an expression."""
    if isinstance(expr, LegSum | VectorLegSum | TensorLegSum):
        return [expr]
    return [found for arg in getattr(expr, "args", ()) for found in leg_sums(arg)]
