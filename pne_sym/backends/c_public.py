"""The functions that C users call: the public functions of the program, as C takes them."""

from __future__ import annotations

import re
from typing import NamedTuple

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_operations import WITHOUT, c_order, runs_in_lanes
from pne_sym.backends.c_sizes import extent, sizes_of, times
from pne_sym.backends.c_text import Routine, comment, indented, listing
from pne_sym.model.values import ROUNDING
from pne_sym.program.count import count_function
from pne_sym.program.interpret import inputs_read
from pne_sym.program.public import Argument, Default, PublicFunction

_OUTPUTS = {
    "constraints": "residual",
    "constraint_bias": "bias",
    "qd": "rates",
    "qdd": "accelerations",
}
_LEAST = {False: "  tau has the least norm.", True: "  tau has the least sum of weights tau^2."}
_ALSO = {
    "pose": f"  INVALID where R has not orthonormal rows, to {ROUNDING:g} (float: 1e-5), and "
    "determinant +1."
}
"""What C says of its own: names of outputs, tolerances."""


class CArray(NamedTuple):
    """An input or output array of a function.

    Attributes:
        name: of the argument.
        size: number of entries of one state.
        extent: the same as a text.
        shape: for people.
        optional: NULL stands for what the function has by default.
        positive: entries must be positive.
    """

    name: str
    size: int
    extent: str
    shape: str
    optional: bool = False
    positive: bool = False

    @property
    def text(self) -> str:
        """The argument with its shape."""
        null, positive = ", or NULL" * self.optional, ", positive" * self.positive
        return f"{self.name} ({self.shape}{null}{positive})"


class CFunction(NamedTuple):
    """A function that C users call; there is one for a state and one for a batch.

    Attributes:
        name: without prefix.
        of: the public function.
        meaning: a text for the header.
        inputs, outputs: arrays, one state after another in a batch.
        lanes: whether the batch runs several states side by side.
    """

    name: str
    of: PublicFunction
    meaning: str
    inputs: tuple[CArray, ...]
    outputs: tuple[CArray, ...]
    lanes: bool

    @property
    def has_model(self) -> bool:
        """Whether the prepared model is the first argument."""
        return self.of.needs_model


def c_functions(bundle: Bundle) -> tuple[CFunction, ...]:
    """All functions that users call, in the order of the header."""
    found = []
    for function in bundle.program.public:
        if not function.is_exported or not any(o.value.size for o in function.outputs):
            continue
        reads_weights = "weights" in inputs_read(bundle.program, function)
        found.append(_function(bundle, function, least=reads_weights))
        if reads_weights:
            found.append(_function(bundle, function, least=True, weighted=True))
    return tuple(found)


def _function(
    bundle: Bundle, f: PublicFunction, *, least: bool, weighted: bool = False
) -> CFunction:
    given = {a.name: a for a in f.inputs if a.name not in WITHOUT or weighted}
    sizes = sizes_of(bundle)
    inputs = tuple(_input(given[name], sizes) for name in c_order(list(given)))
    outputs = tuple(
        CArray(_OUTPUTS.get(o.label, o.label), o.value.size, extent(o, sizes), _shape(o))
        for o in f.outputs
    )
    meaning = f.meaning + _LEAST[weighted] * least + _ALSO.get(f.name, "")
    missing = [a for a in f.inputs if a.name not in given]
    words = " ".join(a.name for a in missing)
    notes = [
        n for n in f.notes if not (words and re.search(rf"\b({'|'.join(words.split())})\b", n))
    ]
    notes += [
        f"The {a.name} is {a.meaning.split(' by default ')[1]}."
        for a in missing
        if " by default " in a.meaning
    ]
    text = "  ".join((meaning, *notes)).replace("`", "") + _counted(bundle, f)
    name = f"{f.name}_weighted" if weighted else f.name
    return CFunction(name, f, text, inputs, outputs, runs_in_lanes(f))


def _input(a: Argument, sizes: dict[str, int]) -> CArray:
    optional = a.default not in (None, Default.ONES) or not a.value.size
    return CArray(a.name, a.value.size, extent(a, sizes), _shape(a), optional, a.positive)


def _shape(a: Argument) -> str:
    return " x ".join(a.dimensions) or "1"


def _counted(bundle: Bundle, f: PublicFunction) -> str:
    """The operation counts."""
    if not f.counted:
        return ""
    counts = count_function(bundle.program.functions[f.counted], bundle.leg_counts).text
    apart = [f.also] if f.also else []
    apart += ["the iteration of q"] if any(a.name == "q0" for a in f.inputs) else []
    return f"  {'; '.join((counts, *(f'{a} apart' for a in apart)))}."


class Caller:
    """Prints a function that users call: its prototypes, the call for a state and for a batch."""

    def __init__(
        self, prefix: str, function: CFunction, one: Routine, lanes: Routine | None
    ) -> None:
        self.prefix, self.f, self.one, self.lanes = prefix, function, one, lanes

    def prototypes(self) -> list[str]:
        """Comment and both prototypes."""
        f = self.f
        shapes = (", ".join(i.text for i in f.inputs), ", ".join(o.text for o in f.outputs))
        lines = comment(f"{f.meaning}  In: {shapes[0]}.  Out: {shapes[1]}.")
        for batch in (False, True):
            *head, last = self._head(f"{self.prefix}_", batch=batch)
            lines += [*head, f"{last};"]
        return lines

    def definitions(self) -> list[str]:
        """One state, where that is a call of what others call too, and a batch."""
        arrays = [self._at(a, "j") for a in (*self.f.inputs, *self.f.outputs)]
        own = f"{self.prefix}_{self.f.name}"
        one = f"{own}({', '.join([*['m'] * self.f.has_model, *arrays])})"
        if self.lanes:
            body = listing("SIDE_BY_SIDE(", [self._call(self.lanes, "i"), one], ");")
        else:
            body = listing("ONE_BY_ONE(", [one], ");")
        batch = [*self._head("", batch=True), "{", *indented(body), "}"]
        if self.one.name == own:
            return batch
        call = listing("return ", [self._call(self.one, "")], ";")
        return [*self._head("", batch=False), "{", *indented(call), "}", "", *batch]

    def _head(self, types: str, *, batch: bool) -> list[str]:
        """Return type, name, parameters; `types` is put before the names of types."""
        f, p = self.f, self.prefix
        model = f"{types}model *model" if types else "prepared *m"
        parameters = [f"const {model}"] * f.has_model + ["size_t n"] * batch
        parameters += [f"const {types}real *{i.name}" for i in f.inputs]
        parameters += [f"{types}real *{o.name}" for o in f.outputs]
        parameters += ["int *status"] * batch
        kind = "size_t" if batch else "int"
        return listing(f"{kind} {p}_{f.name}{'_batch' if batch else ''}(", parameters, ")")

    def _at(self, argument: CArray, count: str) -> str:
        """An argument at the state with number `count`."""
        at = f"{argument.name} + {times(argument.extent, count)}" if count else argument.name
        return f"{argument.name} ? {at} : NULL" if argument.optional and count else at

    def _call(self, steps: Routine, count: str) -> str:
        """A call of the steps; NULL stands for what C has no argument for."""
        f = self.f
        given = dict.fromkeys((a.name for a in f.of.inputs), "NULL")
        given |= {i.name: self._at(i, count) for i in f.inputs}
        given |= {
            f"{of.label}_out": self._at(o, count)
            for of, o in zip(f.of.outputs, f.outputs, strict=True)
        }
        return steps.call_with(given | {"code": "codes"}).rstrip(";")
