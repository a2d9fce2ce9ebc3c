"""Functions of a program: straight-line code over rows of states, legs in the first dimension."""

from __future__ import annotations

from math import prod

import numpy as np
import sympy as sp

from pne_sym.backends.octave.text import MatlabText, by_columns, column, define, indices, named
from pne_sym.derivation import ParameterField
from pne_sym.program.evaluate import TOLERANCE, Status
from pne_sym.program.ir import Block, Check, Function
from pne_sym.program.slices import slices, symbols

_SIZES = {"X": "NQ", "V": "NV", "A": "NV", "q": "NJ"}
_CAUSES = (Status.SINGULAR, Status.UNREACHABLE, Status.INVALID)
"""Guards, each stronger than those before."""


class Code(MatlabText):
    """Writes the functions that the public ones are made of."""

    def function(self, function: Function) -> str:
        """run_NAME(model, inputs): the arrays, and the status."""
        shapes = {name: self.bundle.program.shapes[name] for name in function.arrays}
        causes = {c.trouble for b in function.blocks for c in b.checks}
        causes |= {c.trouble for c in function.unpack_checks}
        lines = ["n = size(%s, 2);" % function.inputs[0]]  # noqa: UP031
        lines += [f"{c.name.lower()} = false(1, n);" for c in _CAUSES if c.name.lower() in causes]
        lines += [f"flat_{name} = zeros({prod(shape)}, n);" for name, shape in shapes.items()]
        lines += self._inputs(function) + self.statements(function.unpack)
        lines += self._checks(function.unpack_checks)
        for block in function.blocks:
            lines += [
                f"{named(e.symbol)} = {e.vector}({indices(e.indices)}, :);"
                for e in function.leg_inputs.get(block.leg_type, ())
            ]
            lines += self._block(block) + self._stores(block)
        lines += ["status = zeros(1, n);"]
        lines += [f"status(~all(isfinite(flat_{name}), 1)) = 3;" for name in shapes]
        found = [c for c in _CAUSES if c.name.lower() in causes]
        lines += [f"status({c.name.lower()}) = {c.value};" for c in found]
        lines += [f"status(~all(isfinite({v}), 1)) = 3;" for v in function.inputs]
        for name, shape in shapes.items():
            sizes = ", ".join(map(str, (*shape, "n")))
            lines += [
                f"flat_{name}(:, status ~= 0) = NaN;",
                f"array_{name} = reshape(flat_{name}, [{sizes}]);",
            ]
        outputs = ", ".join((*(f"array_{name}" for name in shapes), "status"))
        head = f"[{outputs}] = run_{function.name}({', '.join(('model', *function.inputs))})"
        return define(head, f"RUN_{function.name.upper()}  A part of the model.", lines)

    def prepare(self) -> str:
        """The function that gives a struct of what depends on the parameters alone."""
        name = self.bundle.name
        lines = ["if isempty(p)", f"    given = {name}.parameters();", "else", "    given = p;"]
        lines += ["end", *self._given()]
        for block in self.bundle.program.prepare:
            lines += self._block(block)
        lines += [f"model.{named(n)} = {named(n)};" for n, _ in self.bundle.program.prepared]
        return define("model = prepare(p)", "PREPARE  What depends on the parameters alone.", lines)

    def parameters(self) -> str:
        """The function that gives a struct of what the specification says."""
        fields = self.bundle.derivation.parameters.fields
        lines = ["%", f"%   p = {self.bundle.name}.parameters()", "%"]
        lines += [f"%   p.{f.name}: {f.meaning} [{f.unit}], {_sizes(f)}{_legs(f)}." for f in fields]
        lines += [
            f"p.{f.name} = {by_columns(f.default, legs=f.leg_type is not None)};" for f in fields
        ]
        summary = "PARAMETERS  The parameters of the specification, to be changed; SI units."
        return define("p = parameters()", summary, lines)

    def _block(self, block: Block) -> list[str]:
        lines = self.statements(block.assignments) + self._checks(block.checks)
        legs = self.bundle.leg_counts.get(block.leg_type, 1)
        for target, value in block.sums:
            lines.append(f"{named(target)} = sum(({self.of(value)}) + zeros({legs}, 1), 1);")
        return lines

    def _stores(self, block: Block) -> list[str]:
        """Entries of output arrays, which are flat, column by column."""
        lines, legs = [], self.bundle.leg_counts.get(block.leg_type, 1)
        for store in block.stores:
            shape = self.bundle.program.shapes[store.array]
            rows, across = (
                place if isinstance(place, tuple) else (place or 0,) * legs
                for place in (store.row, store.column)
            )
            places = [r + shape[0] * c for r, c in zip(rows, across, strict=True)]
            value = self.of(store.value)
            value = f"({value}) + zeros({legs}, n)" if block.leg_type else value
            lines.append(f"flat_{store.array}({indices(places)}, :) = {value};")
        return lines

    def _checks(self, checks: tuple[Check, ...]) -> list[str]:
        """Guards; a state fails where a leg fails."""
        found = []
        for c in checks:
            value = self.of(c.value)
            if c.trouble == "singular":
                bound = f"{TOLERANCE**c.power!r} * ({self.of(c.scale)})"
                good = f"{self.of(sp.Abs(c.value))} > {bound}"
            elif c.trouble == "invalid":
                good = f"{value} > 0 & isfinite({value})"
            else:
                good = f"{value} >= 0"
            found.append(f"{c.trouble} = {c.trouble} | any(~({good}), 1);")
        return list(dict.fromkeys(found))

    def _inputs(self, function: Function) -> list[str]:
        """Names for prepared values, and for the entries of the input vectors that are read."""
        parts = slices(function)
        read = set[str]().union(*map(symbols, function.blocks)) | parts.reads_before
        shared = [n for n in function.shared if n in read]
        shared += [n for names in function.per_leg.values() for n in names if n in read]
        lines = [f"{named(name)} = model.{named(name)};" for name in shared]
        for vector in function.inputs:
            size = self.bundle.coordinates.sizes[_SIZES[vector]]
            entries = [(k + 1, f"{vector}_{k}") for k in range(size)]
            lines += [f"{name} = {vector}({k}, :);" for k, name in entries if name in parts.entries]
        return lines

    def _given(self) -> list[str]:
        """Parameters of the right shape; names for the entries and branches that are used."""
        program, table = self.bundle.program, self.bundle.derivation.parameters
        used = set[str]().union(*map(symbols, program.prepare)) | {n for n, _ in program.prepared}
        lines = [
            f"{self.internal}check_parameter('{f.name}', given.{f.name}, {_shape(f)});"
            for f in table.fields
        ]
        for name, (f, index) in table.entries.items():
            if name in used:
                place = [str(int(k) + 1) for k in np.unravel_index(index, f.shape or (1,))]
                if f.leg_type is None:
                    lines.append(f"{named(name)} = given.{f.name}({', '.join(place)});")
                    continue
                entry = f"given.{f.name}({', '.join((*place, ':'))})"
                lines.append(f"{named(name)} = reshape({entry}, [{len(f.default)}, 1]);")
        signs = [(n, values) for n, (_, values) in table.branches.items() if n in used]
        return lines + [f"{named(name)} = {column(values)};" for name, values in signs]


def _dimensions(f: ParameterField) -> tuple[int, ...]:
    """As MATLAB has it: legs last, at least two dimensions."""
    if f.leg_type is None:
        return (*f.shape, 1, 1)[: max(len(f.shape), 2)]
    return (*(f.shape or (1,)), len(f.default))


def _shape(f: ParameterField) -> str:
    return f"[{', '.join(map(str, _dimensions(f)))}]"


def _sizes(f: ParameterField) -> str:
    return " x ".join(map(str, _dimensions(f)))


def _legs(f: ParameterField) -> str:
    return ", a leg in each column" if f.leg_type and len(f.shape) < 2 else ""
