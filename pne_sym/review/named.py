"""Whether the values of a program are what the derivation says that they are.

Every value that bears the name of a quantity's component, every sum over legs and every stored
entry is compared with the equation of that quantity, evaluated on its own at a state: with vectors
and tensors in base axes, by nothing but the derivation.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pne_sym.derivation import Derivation, leg_sums
from pne_sym.program.evaluate import Array, Status, evaluate, prepare
from pne_sym.program.ir import Block, Component, Means, Program
from pne_sym.program.slices import places_of
from pne_sym.review.difference import Contradiction
from pne_sym.review.equations import Sample
from pne_sym.review.evaluation import Situation, State, Structure, assembled, by_array, turned
from pne_sym.review.model import Model

_SITUATIONS = 2
"""At random, a statement that is wrong is so at each of them; the second is for what is zero."""
TOLERANCE = 1e-8
"""Of a component's error, over the largest entry of its quantity."""
_SMALL = 1e-9  # what rounding leaves of a quantity that is zero


@dataclass(frozen=True)
class Statement:
    """A statement of a program that says what its value is.

    Attributes:
        function: of the program, or "prepare".
        equation: its id.
        name: of the value, or the place of a stored entry.
        means: what it is.
        leg: position of the leg, or None.
        found: its value.
        expected: what the equations say.
        size: of the quantity, by its largest entry.
    """

    function: str
    equation: str
    name: str
    means: str
    leg: int | None
    found: float
    expected: float
    size: float

    @property
    def is_right(self) -> bool:
        """Whether the two agree."""
        if not np.isfinite(self.expected):  # a state at which the model has no values
            return not np.isfinite(self.found)
        return bool(abs(self.found - self.expected) <= TOLERANCE * self.size + _SMALL)


def first_contradiction(
    derivation: Derivation, program: Program, situations: Iterable[Situation]
) -> Statement | None:
    """The first statement, in order of computation, that contradicts its derivation."""
    structure = Structure(derivation)
    found = (s for at in situations for s in statements(structure, program, at) if not s.is_right)
    return next(found, None)


def statements(structure: Structure, program: Program, at: Situation) -> Iterator[Statement]:
    """Everything that says what it is, in order of computation, with its value at a state."""
    table = structure.derivation.parameters
    prepared = prepare(program, table.values(at.parameters))
    state = State(structure, at)
    said = _Said(state)
    yield from _Values(said, "prepare", program.means, prepared).of(program.prepare)
    vectors = {name: np.asarray(v, dtype=float)[None] for name, v in at.vectors.items()}
    outputs = by_array(structure.derivation)
    for name, function in program.functions.items():
        found = evaluate(program, name, prepared, vectors)
        values = _Values(said, name, function.means, found.values)
        yield from values.of(function.blocks)
        for array in function.arrays:
            if array in outputs and found.status[0] == Status.OK:
                entries = assembled(state, outputs[array])
                yield from values.stored(function.blocks, array, entries, found.outputs[array][0])


class _Said:
    """What the equations say at a state, computed once for all functions."""

    def __init__(self, state: State) -> None:
        self.state, self.structure = state, state.structure
        self.ids = {e.name: e.id for e in self.structure.derivation.equations()}
        self._known: dict[tuple[str, str, str, str, int | None], Array] = {}

    def whole(self, of: Component, leg: int | None) -> Array:
        """The quantity of a component in its frame."""
        key = (of.quantity, of.over, of.frame, of.axes, leg)
        if key not in self._known:
            self._known[key] = self._in_frame(of, leg)
        return self._known[key]

    def _in_frame(self, component: Component, leg: int | None) -> Array:
        state = self.state
        if component.axes:
            inverse = state.rotation(component.frame, leg).T
            return np.asarray(inverse @ state.rotation(component.axes, leg))
        value = np.asarray(self._value(component, leg), dtype=float)
        if not component.frame or value.ndim == 0:
            return value
        return np.asarray(turned(state.rotation(component.frame, leg).T, value))

    def _value(self, component: Component, leg: int | None) -> Any:
        if not component.over:
            return self.state.value(component.quantity, leg)
        equation = self.structure.equations[component.quantity]
        (total,) = (s for s in leg_sums(equation.rhs) if str(s.args[1]) == component.over)
        return self.state.of(total, None)


class _Values:
    """The values of a function at a state, beside what the equations say."""

    def __init__(
        self, said: _Said, function: str, means: Means, values: Mapping[str, Array]
    ) -> None:
        self.said, self.structure = said, said.structure
        self.function, self.means, self.values = function, means, values

    def of(self, blocks: Iterable[Block]) -> Iterator[Statement]:
        """Assignments and sums."""
        for block in blocks:
            legs = self.structure.legs.get(block.leg_type, (None,))
            for a in block.assignments:
                yield from self._named(str(a.target), a.equation, legs)
            for s in block.sums:
                yield from self._named(str(s.target), s.equation, (None,))

    def _named(self, name: str, equation: str, legs: Sequence[int | None]) -> Iterator[Statement]:
        for component in self.means.get(name, ()):
            # of what else a value is it is that equation which the value would contradict
            of = self.said.ids.get(component.quantity, equation)
            owner = component.frame.partition(".")[0]
            # one value for all legs, along whose own axes it may be the same too
            own = self.structure.legs.get(owner, legs) if tuple(legs) == (None,) else legs
            for k, leg in enumerate(own):
                whole = self.said.whole(component, leg)
                value = np.atleast_1d(self.values[name])
                found = value.reshape(value.shape[0], -1)[min(k, len(value) - 1), 0]
                numbers = map(float, (found, whole[component.index], np.abs(whole).max()))
                yield Statement(self.function, of, name, component.name, leg, *numbers)

    def stored(
        self,
        blocks: Iterable[Block],
        array: str,
        expected: Mapping[tuple[int, int], float],
        found: Array,
    ) -> Iterator[Statement]:
        """Entries of an output array, at the statements that store them."""
        size = max(map(abs, expected.values()), default=0.0)
        flat = found.reshape(found.shape[0], -1)
        for block in blocks:
            legs = self.structure.legs.get(block.leg_type, (None,))
            for store in (s for s in block.stores if s.array == array):
                for leg, place in zip(legs, places_of(store, len(legs)), strict=True):
                    row, column = place
                    of = f"{array}[{row}, {column}]" if found.ndim == 2 else f"{array}[{row}]"
                    value = expected.get(place, 0.0)
                    entry = float(flat[place])
                    yield Statement(self.function, store.equation, of, of, leg, entry, value, size)


def contradictions(
    models: tuple[Model, Model], samples: Sequence[Sample]
) -> Iterator[Contradiction]:
    """Of each version whose derivation is known, the first statement that contradicts it."""
    for k, model in enumerate(models):
        if model.bundle is None:
            continue
        at = [sample[k] for sample in samples[:_SITUATIONS]]
        s = first_contradiction(model.bundle.derivation, model.bundle.program, at)
        if s is not None:
            line = line_of(model, s)
            yield Contradiction(
                model.label, s.equation, s.name, s.function, s.means, line, s.found, s.expected
            )


def line_of(model: Model, statement: Statement) -> str:
    """The line of C, else of Python, that computes a value; empty for stored entries."""
    name = re.escape(statement.name)
    forms = (
        (
            "c",
            model.c,
            rf"/\* ---- {statement.function} ",
            rf"\s*((const real |v->){name} =|KEEP(_OF_LEG)?\({name},)",
        ),
        ("py", model.python, rf"def _run_{statement.function}\(", rf"\s*{name} ="),
    )
    for suffix, files, head, form in forms:
        path = f"{model.name}.{suffix}"
        lines = files.get(path, b"").decode(errors="replace").split("\n")
        start = next((k for k, line in enumerate(lines) if re.match(head, line)), len(lines))
        for k in (*range(start, len(lines)), *range(start)):  # what functions share stands before
            if re.match(form, lines[k]):
                return f"{path}:{k + 1}"
    return ""
