"""The program: what is computed when, for which function."""

from __future__ import annotations

import enum
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from operator import add
from typing import Any, NamedTuple

import sympy as sp

from pne_sym.program.public import PublicFunction
from pne_sym.vector.arrays import Relation


class Kind(enum.IntEnum):
    """When a value can be computed, in order of execution."""

    PARAMETER = 0
    PARAMETER_LEG = 1
    PARAMETER_TOTAL = 2
    STATE = 3
    STATE_LEG = 4
    TOTAL = 5


class Stage(NamedTuple):
    """When a value can be computed, and over which legs.

    Attributes:
        kind: parameters alone (once, for a leg, after a sum over legs) or state
            (before the legs, for a leg, after a sum over legs).
        leg_type: the leg type of a value per leg; "" otherwise.
    """

    kind: Kind
    leg_type: str = ""

    @property
    def depends_on_state(self) -> bool:
        """Whether the value needs X, V or A."""
        return self.kind >= Kind.STATE

    @property
    def per_leg(self) -> bool:
        """Whether there is one value per leg."""
        return bool(self.leg_type)

    def after_sum(self) -> Stage:
        """Stage of the sum of such values over the legs."""
        return Stage(Kind.TOTAL if self.depends_on_state else Kind.PARAMETER_TOTAL)

    @staticmethod
    def join(stages: Iterable[Stage]) -> Stage:
        """Stage of an expression made of values of these stages.

        Raises:
            ValueError: values of two leg types, or of a leg and a sum over
                legs of the state, meet.
        """
        found = set(stages)
        legs = {stage.leg_type for stage in found} - {""}
        highest = max((stage.kind for stage in found), default=Kind.PARAMETER)
        if len(legs) > 1 or (legs and highest == Kind.TOTAL):
            raise ValueError(f"values that never stand together meet: {sorted(found)}")
        if not legs:
            return Stage(highest)
        alone = highest == Kind.PARAMETER_LEG
        return Stage(Kind.PARAMETER_LEG if alone else Kind.STATE_LEG, legs.pop())


_AT_STATE = Stage(Kind.STATE)


@dataclass(frozen=True)
class Component:
    """What a value is: a component of a quantity of the derivation, with its sign.

    Attributes:
        quantity: its name.
        frame: along whose axes; "" for a scalar.
        index: which component: none, one or two numbers.
        over: the leg type over whose legs the equation of the quantity sums, where that sum is
            meant; "" for the whole.
        axes: a frame; then entry index[0] of its axis index[1] is meant, of no quantity.
    """

    quantity: str
    frame: str = ""
    index: tuple[int, ...] = ()
    over: str = ""
    axes: str = ""

    @property
    def name(self) -> str:
        """The name of a value that is this; without a frame where the axes are the base's.

        >>> Component("S", "base", (0,)).name, Component("W_2", "ups.axes2", (0, 1)).name
        ('S_x', 'W_2_in_axes2_xy')
        """
        entries = "".join("xyz"[i] for i in self.index)
        if self.axes:
            return f"axis_{entries[1]}_{self.axes.replace('.', '_')}_{entries[0]}"
        frame = "" if self.frame in ("", "base") else f"in_{self.frame.rpartition('.')[2]}"
        return "_".join(part for part in (self.quantity, self.over, frame, entries) if part)


Means = Mapping[str, tuple[Component, ...]]
"""Name of a value -> what it is; of what has no entry the name says no more than what it is for."""


@dataclass(frozen=True)
class Assignment:
    """target = expr, tagged with the equation it belongs to."""

    target: sp.Symbol
    expr: Any
    equation: str

    @property
    def read(self) -> tuple[Any, ...]:
        """Expressions in it."""
        return (self.expr,)


VECTORS = ("X", "V", "A", "base", "q")
"""What functions take, in this order: pose, velocity, acceleration, motion of the base,
displacements."""


@dataclass(frozen=True)
class Check:
    """A guard: failing means the state is impossible.

    INVALID: value > 0 and finite.  UNREACHABLE: value >= 0.
    SINGULAR: |value| > tolerance^power * scale.  `stage`: at which its values are known.
    """

    status: str
    value: Any
    scale: Any
    power: int
    equation: str
    stage: Stage = _AT_STATE

    @property
    def read(self) -> tuple[Any, ...]:
        """Expressions in it."""
        return self.value, self.scale


@dataclass(frozen=True)
class Store:
    """An entry of an output array.

    For a value per leg, `row` and `column` are tables over the legs of the type.  `equation` is
    that of the quantity whose component is stored, `stage` that at which it is stored.
    """

    array: str
    value: Any
    row: int | tuple[int, ...]
    column: int | tuple[int, ...] | None = None
    equation: str = ""
    stage: Stage = _AT_STATE

    @property
    def read(self) -> tuple[Any, ...]:
        """Expressions in it."""
        return (self.value,)


@dataclass(frozen=True)
class Block:
    """A run of statements: before the legs, over the legs of a type, or after.

    Attributes:
        leg_type: name of the leg type looped over, or "".
        assignments: in order.
        checks: guards evaluated at the end of the block.
        sums: what is accumulated over the legs.
        stores: outputs written.
    """

    leg_type: str
    assignments: tuple[Assignment, ...]
    checks: tuple[Check, ...] = ()
    sums: tuple[Assignment, ...] = ()
    stores: tuple[Store, ...] = ()

    @property
    def ends(self) -> tuple[Check | Assignment | Store, ...]:
        """What is made of the values of its statements."""
        return *self.checks, *self.sums, *self.stores


@dataclass(frozen=True)
class Counts:
    """Operations; those of a leg loop count once per leg."""

    mul: int = 0
    add: int = 0
    div: int = 0
    sqrt: int = 0
    trig: int = 0

    @property
    def total(self) -> int:
        """Multiplications, additions, divisions and roots (no trigonometric calls)."""
        return self.mul + self.add + self.div + self.sqrt

    @property
    def text(self) -> str:
        """All with their names, for comments."""
        return ", ".join(f"{n} {kind}" for kind, n in vars(self).items())

    def __add__(self, other: Counts) -> Counts:
        return Counts(*map(add, vars(self).values(), vars(other).values()))

    def times(self, n: int) -> Counts:
        """n times these operations."""
        return Counts(*(n * own for own in vars(self).values()))


@dataclass(frozen=True)
class LegInput:
    """An entry of an input vector that belongs to a leg.

    Attributes:
        symbol: its name in the leg loop.
        vector: "X", "V" or "A".
        indices: index in the vector, per leg.
    """

    symbol: sp.Symbol
    vector: str
    indices: tuple[int, ...]


@dataclass(frozen=True)
class Function:
    """A generated computation: inputs to output arrays.

    Attributes:
        name: such as "dynamics".
        inputs: names of input vectors that are read, in order ("X", "V", "A").
        arrays: names of the output arrays, in order.
        unpack: names the entries of the inputs (rotation matrix from a
            quaternion and the like); counted apart.
        unpack_checks: what the inputs must satisfy.
        blocks: in order of execution.
        leg_inputs: inputs per leg, by leg type.
        shared: prepared values that it reads, not per leg.
        per_leg: prepared values that it reads per leg, by leg type.
        means: what its values are.
    """

    name: str
    inputs: tuple[str, ...]
    arrays: tuple[str, ...]
    unpack: tuple[Assignment, ...]
    unpack_checks: tuple[Check, ...]
    blocks: tuple[Block, ...]
    leg_inputs: dict[str, tuple[LegInput, ...]] = field(default_factory=dict)
    shared: tuple[str, ...] = ()
    per_leg: dict[str, tuple[str, ...]] = field(default_factory=dict)
    means: Means = field(default_factory=dict)


@dataclass(frozen=True)
class Closure:
    """Legs of a type whose displacements Newton's iteration on the loop closure finds.

    The function closure_TYPE gives the arrays residual_TYPE (legs, conditions) and jacobian_TYPE
    (legs, conditions x unknowns).

    Attributes:
        leg_type: name of the type.
        joints: positions in q of the displacements that are looked for, per leg.
        turning: those of all these positions that are angles.
        rows: of the Jacobian, as many as unknowns: on home's branch their determinant has the
            sign that it has at home; none where no sign tells the branch.
        signs: that sign, per leg.
        sign_name: its name among the branches.
    """

    leg_type: str
    joints: tuple[tuple[int, ...], ...]
    turning: tuple[int, ...]
    rows: tuple[int, ...] = ()
    signs: tuple[int, ...] = ()
    sign_name: str = ""

    @property
    def function(self) -> str:
        """Name of the function of the program that gives residual and Jacobian."""
        return f"closure_{self.leg_type}"

    @property
    def unknowns(self) -> int:
        """Displacements of a leg that are looked for."""
        return len(self.joints[0])

    @property
    def places(self) -> tuple[int, ...]:
        """The positions, leg after leg."""
        return tuple(j for leg in self.joints for j in leg)


@dataclass(frozen=True)
class Program:
    """All functions of a model and the preparation of its parameters.

    Attributes:
        prepare: blocks that compute the prepared values from the parameters.
        prepared: prepared values that functions read: (name, leg type or "").
        functions: by name.
        shapes: shape of each output array.
        leg_counts: number of legs by leg type.
        closures: leg types whose displacements are found by iteration.
        given: (position in q, position in X) of the extra coordinates.
        public: what users call, as steps over the functions.
        means: what the prepared values are, and those made on the way to them.
        lowered: quantity -> frame and components in which it was made first; of those alone
            that were made as such.
        relations: equations between whole arrays, of which steps of public functions are made.
    """

    prepare: tuple[Block, ...]
    prepared: tuple[tuple[str, str], ...]
    functions: dict[str, Function] = field(default_factory=dict)
    shapes: dict[str, tuple[int, ...]] = field(default_factory=dict)
    leg_counts: dict[str, int] = field(default_factory=dict)
    closures: tuple[Closure, ...] = ()
    given: tuple[tuple[int, int], ...] = ()
    public: tuple[PublicFunction, ...] = ()
    means: Means = field(default_factory=dict)
    lowered: Mapping[str, tuple[str, tuple[Any, ...]]] = field(default_factory=dict)
    relations: tuple[Relation, ...] = ()
