"""Straight-line code as text: what printers of it ask of a function, in the forms of a language.

Values of legs are arrays with the legs as a dimension of their own: nothing runs over legs.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, ClassVar, NamedTuple

import numpy as np
import sympy as sp

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import equation_titles
from pne_sym.backends.scalar import ScalarPrinter
from pne_sym.derivation import ParameterField
from pne_sym.program.ir import Assignment, Block, Check, Function
from pne_sym.program.slices import places_of, slices, symbols


def places(numbers: Iterable[int], first: int = 0) -> str:
    """Places in an array, of a language that counts from the first."""
    return f"[{', '.join(str(n + first) for n in numbers)}]"


class Forms(NamedTuple):
    """How a language writes statements, with the parts in braces.

    Attributes:
        prepared: the prepared value {name}.
        entry: entry {k} of {vector}.
        legs: its entries at {places}, which belong to legs.
        field: entry {place} of the parameter {field}, {at} as its subscript where it has one;
            leg_field: that of each of {legs} legs, where it is another.
        signs: the branch {name}, a sign per leg, {values}.
        total: the sum of {value} over {legs} legs of a {leg_type}.
        demand: a guard against a {status}: {good} must hold.
        good: what must hold, by the status: of {value}, its {size}, {tolerance} and {scale}.
        tolerance: by the guard's power.
        store: {value} at {places} of the flat {array}; leg_store: one value for each of {legs}
            legs; none where arrays are not filled block by block.
        first: where arrays begin to count.
        assign: {value} gets a {name}.
    """

    prepared: str
    entry: str
    legs: str
    field: str
    signs: str
    total: str
    demand: str
    good: Mapping[str, str]
    tolerance: Mapping[int, str]
    leg_field: str = ""
    store: str = ""
    leg_store: str = ""
    first: int = 0
    assign: str = "{name} = {value}"


class StraightText:
    """Writes statements; a language says how expressions and assignments look.

    Attributes:
        comment: what begins one.
        forms: of the language.
    """

    comment: ClassVar[str]
    forms: Forms

    def __init__(self, bundle: Bundle, printer: ScalarPrinter) -> None:
        self.bundle, self.printer = bundle, printer
        self.titles = equation_titles(bundle.derivation)

    def of(self, expr: Any) -> str:
        """A scalar expression."""
        return str(self.printer.doprint(sp.sympify(expr)))

    def assign(self, target: str, value: str) -> list[str]:
        """An assignment."""
        return [self.forms.assign.format(name=target, value=value)]

    def statements(self, assignments: Iterable[Assignment]) -> list[str]:
        """Assignments, headed by the equations they belong to."""
        return self.headed(
            (a.equation, self.assign(self.of(a.target), self.of(a.expr))) for a in assignments
        )

    def headed(self, rows: Iterable[tuple[str, list[str]]]) -> list[str]:
        """Lines with the equations they belong to, under these."""
        lines: list[str] = []
        known = ""
        for equation, own in rows:
            if equation != known:
                known, title = equation, self.titles.get(equation, "")
                told = f"({equation}) {title}" if title else f"{equation}: named entries"
                lines.append(f"{self.comment} {told}")
            lines += own
        return lines

    # ---- functions -------------------------------------------------------------------------------

    def body(self, function: Function) -> list[str]:
        """Statements of a function: inputs, guards, values, what is stored."""
        lines = self._inputs(function) + self.statements(function.unpack)
        lines += self.required(function.unpack_checks)
        for block in function.blocks:
            lines += self.leg_inputs(function, block.leg_type) + self.block(block)
            lines += self._stores(block) if self.forms.store else []
        return lines

    def prepared(self) -> list[str]:
        """Statements that compute what depends on the parameters alone."""
        program, table = self.bundle.program, self.bundle.derivation.parameters
        used = set[str]().union(*map(symbols, program.prepare)) | {n for n, _ in program.prepared}
        values = {name: self._field(field, index) for name, (field, index) in table.entries.items()}
        for name, (_, signs) in table.branches.items():
            text = ", ".join(f"{s}.0" for s in signs)
            values[name] = self.forms.signs.format(name=name, values=text)
        given = (self.assign(self.named(name), values[name]) for name in values if name in used)
        lines = [line for parts in given for line in parts]
        return lines + [line for block in program.prepare for line in self.block(block)]

    def named(self, name: str) -> str:
        """The name of a value."""
        return self.of(sp.Symbol(name, real=True))

    def _field(self, field: ParameterField, index: int) -> str:
        """An entry of a parameter, of all legs where there is one per leg."""
        form = (field.leg_type and self.forms.leg_field) or self.forms.field
        place = places(map(int, np.unravel_index(index, field.shape or (1,))), self.forms.first)
        legs = self.bundle.leg_counts.get(field.leg_type or "", 1)
        at = f"[{':, ' * bool(field.leg_type)}{place[1:]}" * bool(field.shape)
        return form.format(field=field.name, place=place[1:-1], at=at, legs=legs)

    def _inputs(self, function: Function) -> list[str]:
        """Names for prepared values, and for the entries of the input vectors that are read."""
        read = slices(function).reads
        own = (n for names in (function.shared, *function.per_leg.values()) for n in names)
        values = ((n, self.forms.prepared.format(name=self.named(n))) for n in own if n in read)
        given = (self.assign(self.named(name), value) for name, value in values)
        return [line for parts in given for line in parts] + self.entries(function)

    def entries(self, function: Function) -> list[str]:
        """Names for the entries of the input vectors that are read."""
        read, lines = slices(function).entries, list[str]()
        for vector in function.inputs:
            for k in range(self.bundle.coordinates.lengths[vector]):
                if (name := f"{vector}_{k}") in read:
                    entry = self.forms.entry.format(vector=vector, k=k + self.forms.first)
                    lines += self.assign(self.named(name), entry)
        return lines

    def leg_inputs(self, function: Function, leg_type: str) -> list[str]:
        """Names for entries of the input vectors that belong to legs."""
        lines = []
        for entry in function.leg_inputs.get(leg_type, ()):
            where = places(entry.indices, self.forms.first)
            value = self.forms.legs.format(vector=entry.vector, places=where)
            lines += self.assign(self.of(entry.symbol), value)
        return lines

    def block(self, block: Block) -> list[str]:
        """Statements of a block, what they demand, sums over legs."""
        lines = self.statements(block.assignments) + self.required(block.checks)
        rows = []
        for s in block.sums:
            legs = self.bundle.leg_counts[block.leg_type]
            facts = {"value": self.of(s.expr), "legs": legs, "leg_type": block.leg_type}
            total = self.forms.total.format(**facts)
            rows.append((s.equation, self.assign(self.of(s.target), total)))
        return lines + self.headed(rows)

    def required(self, checks: Iterable[Check]) -> list[str]:
        """What guards demand, each once."""
        found = []
        for c in checks:
            good = self.forms.good[c.status].format(
                value=self.of(c.value),
                size=self.of(sp.Abs(c.value)),
                tolerance=self.forms.tolerance[c.power],
                scale=self.of(c.scale),
            )
            found.append(self.forms.demand.format(status=c.status, good=good))
        return list(dict.fromkeys(found))

    def _stores(self, block: Block) -> list[str]:
        """Entries of output arrays, which are flat, column by column."""
        rows, legs = [], self.bundle.leg_counts.get(block.leg_type, 1)
        form = self.forms.leg_store if block.leg_type else self.forms.store
        for store in block.stores:
            height = self.bundle.program.shapes[store.array][0]
            flat = places((r + height * c for r, c in places_of(store, legs)), self.forms.first)
            value = self.of(store.value)
            line = form.format(array=store.array, places=flat, value=value, legs=legs)
            rows.append((store.equation, [line]))
        return self.headed(rows)
