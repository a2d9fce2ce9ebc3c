"""What users call, as data: public functions as short lists of steps over the program's functions.

A step runs a function of the program, or applies an operation (a product, a solution of linear
equations ...) to arrays of one state.  Every operation has one definition, in
`pne_sym.program.operations`; a back end prints steps and provides the operations.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass, replace
from keyword import iskeyword


class Default(enum.StrEnum):
    """What stands for an optional argument that is not given."""

    ZEROS = "zeros"
    ONES = "ones"
    HOME_Q = "displacements at home"
    REST = "a base at rest"


@dataclass(frozen=True)
class Value:
    """An array of one state, known by name.

    Attributes:
        name: of the array.
        shape: of one state; () for a number.
    """

    name: str
    shape: tuple[int, ...]

    @property
    def size(self) -> int:
        """Number of entries."""
        product = 1
        for n in self.shape:
            product *= n
        return product


@dataclass(frozen=True)
class Argument:
    """An input or output of a public function.

    Attributes:
        value: name and shape.
        dimensions: names of the sizes in the shape, such as ("NV", "NU"), or digits.
        meaning: in words, with the unit where there is one.
        default: what stands for it where it is not given; None where it is required.
        positive: where it is given, its entries must be positive and finite, whatever the state.
        label: of an output, what users call it; its array may have to have another name.
    """

    value: Value
    dimensions: tuple[str, ...]
    meaning: str
    default: Default | None = None
    positive: bool = False
    label: str = ""

    @property
    def name(self) -> str:
        """The argument's name."""
        return self.value.name


@dataclass(frozen=True)
class Run:
    """A function of the program at input vectors; the vector q is closed from q0 before.

    Attributes:
        function: its name.
        targets: its arrays, in its order.
        operands: arrays of the state besides the input vectors: none.
    """

    function: str
    targets: tuple[Value, ...]
    operands: tuple[Value, ...] = ()


@dataclass(frozen=True)
class Apply:
    """Operation of arrays.

    Attributes:
        operation: its name in `pne_sym.program.operations`.
        operands: arrays of the state.
        numbers: what is fixed at generation: rows, ranks, sizes.
        targets: what it gives.
        equation: the relation between arrays whose step it is, or "".
    """

    operation: str
    operands: tuple[Value, ...]
    targets: tuple[Value, ...]
    numbers: tuple[int, ...] = ()
    equation: str = ""


@dataclass(frozen=True)
class Search:
    """Gauss-Newton with step halving: the pose at which a residual vanishes.

    Attributes:
        residual, slope: internal public functions of the pose: the residual (n,) and its
            derivative by a small displacement of the pose, (NV, n).
        operands: the first guess.
        targets: the pose.
        halving: steps are halved until the residual is smaller; otherwise they are taken as they
            are.
    """

    residual: str
    slope: str
    operands: tuple[Value, ...]
    targets: tuple[Value, ...]
    halving: bool


Step = Run | Apply | Search


@dataclass(frozen=True)
class PublicFunction:
    """A function that users call, or a part of one that is not exported.

    Attributes:
        name: of the function.
        meaning: a sentence for docstrings and headers.
        notes: what else must be known of it, in paragraphs.
        inputs, outputs: arguments in order; optional inputs last.
        steps: in order.
        group: what it is about: "dynamics", "kinematics", "constraints", "pose" ...
        needs_model: it depends on the parameters.
        is_exported: users call it.
        counted: function of the program whose operation counts are stated, or "".
        also: what these counts leave out.
        gives_status: the status of every state is returned where a back end has no other place
            for it.
        unbounded: entries of what it gives may be infinite; of others that is INVALID.
    """

    name: str
    meaning: str
    inputs: tuple[Argument, ...]
    outputs: tuple[Argument, ...]
    steps: tuple[Step, ...]
    group: str
    needs_model: bool = True
    is_exported: bool = True
    counted: str = ""
    also: str = ""
    gives_status: bool = False
    unbounded: bool = False
    notes: tuple[str, ...] = ()

    @property
    def required(self) -> tuple[Argument, ...]:
        """Inputs without a default."""
        return tuple(a for a in self.inputs if a.default is None)

    @property
    def optional(self) -> tuple[Argument, ...]:
        """Inputs with a default."""
        return tuple(a for a in self.inputs if a.default is not None)

    @property
    def functions(self) -> tuple[str, ...]:
        """Functions of the program that it runs."""
        return tuple(dict.fromkeys(s.function for s in self.steps if isinstance(s, Run)))

    @property
    def operations(self) -> frozenset[str]:
        """What a back end must provide to print it: operations by name, "search" for searches."""
        applied = {s.operation for s in self.steps if isinstance(s, Apply)}
        return frozenset(applied | {"search" for s in self.steps if isinstance(s, Search)})


def with_readable_names(
    function: PublicFunction, arrays: Mapping[str, tuple[str, ...]]
) -> PublicFunction:
    """The same steps, with arrays called as users and the program call them where that is free.

    Args:
        function: with names of its own.
        arrays: of every function of the program, by name.
    """
    taken = {argument.name for argument in function.inputs}
    names = {name: name for name in taken}
    wanted = [(output.name, output.label) for output in function.outputs]
    for step in function.steps:
        if isinstance(step, Run):
            names_of = arrays[step.function]
            wanted += [(t.name, a) for t, a in zip(step.targets, names_of, strict=True)]
    for name, wish in wanted:
        label = f"{wish}_" if iskeyword(wish) else wish
        if name not in names and label not in taken:
            names[name] = label
            taken.add(label)

    return renamed(function, names)


def renamed(function: PublicFunction, names: Mapping[str, str]) -> PublicFunction:
    """The same steps with other names of arrays, those of arguments included."""

    def named(value: Value) -> Value:
        return replace(value, name=names.get(value.name, value.name))

    def again(step: Step) -> Step:
        operands, targets = (tuple(map(named, own)) for own in (step.operands, step.targets))
        return replace(step, operands=operands, targets=targets)

    return replace(
        function,
        inputs=tuple(replace(i, value=named(i.value)) for i in function.inputs),
        outputs=tuple(replace(o, value=named(o.value)) for o in function.outputs),
        steps=tuple(map(again, function.steps)),
    )


class StepError(Exception):
    """A public function that must not be printed."""


def verify_steps(function: PublicFunction) -> None:
    """Every array is made once and before it is used; outputs are made.

    Raises:
        StepError: what is wrong, in which function.
    """
    known: dict[str, tuple[int, ...]] = {a.name: a.value.shape for a in function.inputs}

    def use(value: Value) -> None:
        if known.get(value.name) != value.shape:
            raise StepError(f"{function.name}: {value.name} {value.shape} is not known")

    for step in function.steps:
        for operand in step.operands:
            use(operand)
        for target in step.targets:
            if target.name in known:
                raise StepError(f"{function.name}: {target.name} is made twice")
            known[target.name] = target.shape
    for output in function.outputs:
        use(output.value)
