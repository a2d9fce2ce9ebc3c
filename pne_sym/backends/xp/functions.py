"""Functions of a program on arrays: straight-line code, the legs as a leading dimension."""

from __future__ import annotations

import textwrap
from typing import Any

import sympy as sp

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.numpy_text import PythonText
from pne_sym.backends.scalar import Dialect, ScalarPrinter
from pne_sym.program.ir import Block, Check, Function
from pne_sym.program.slices import columns, flat_places, slices, symbols

_SIZES = {"X": "NQ", "V": "NV", "A": "NV", "q": "NJ"}
_NAMES = {"sqrt": "s.sqrt", "nonzero": "s.nonzero", "atan2": "s.atan2"}
_NAMES |= {"sin": "xp.sin", "cos": "xp.cos", "Abs": "abs", "Min": "xp.minimum"}
_nonzero = sp.Function("nonzero", real=True)


class Code(PythonText):
    """Writes functions of a state s; roots and divisors go through its guards."""

    def __init__(self, bundle: Bundle) -> None:
        super().__init__(bundle)
        self.bundle, self.printer = bundle, ScalarPrinter(Dialect(_NAMES, "{}"))

    def of(self, expr: Any) -> str:
        """A scalar expression."""
        guarded = sp.sympify(expr).replace(
            lambda e: e.is_Pow and e.exp.is_negative, lambda e: 1 / _nonzero(e.base**-e.exp)
        )
        return str(self.printer.doprint(guarded))

    def function(self, function: Function) -> str:
        """A function of the state and input vectors, to its arrays."""
        lines = self._inputs(function) + self.statements(function.unpack)
        lines += self._required(function.unpack_checks)
        for block in function.blocks:
            for entry in function.leg_inputs.get(block.leg_type, ()):
                lines.append(f"{entry.symbol} = s.take({entry.vector}, {entry.indices})")
            lines += self._block(block)
        arrays = [line for name in function.arrays for line in self._array(function, name)]
        lines += ["found = (", *arrays, ")", "s.settle()", "return found"]
        return self._define(f"_run_{function.name}", function.inputs, lines)

    def prepare(self) -> str:
        """The function that computes what depends on the parameters alone."""
        lines = self._parameters()
        for block in self.bundle.program.prepare:
            lines += self._block(block)
        names = [f'    "{name}": {name},' for name, _ in self.bundle.program.prepared]
        return self._define("_prepare", (), [*lines, "s.settle()", "return {", *names, "}"])

    def _define(self, name: str, inputs: tuple[str, ...], lines: list[str]) -> str:
        body = textwrap.indent("\n".join(["xp = s.xp", *lines]), "    ")
        return f"def {name}({', '.join(('s', *inputs))}):\n{body}"

    def _block(self, block: Block) -> list[str]:
        lines = self.statements(block.assignments) + self._required(block.checks)
        for target, value in block.sums:
            legs = self.bundle.leg_counts[block.leg_type]
            lines += self.assign(str(target), f"s.total({self.of(value)}, {legs})")
        return lines

    def _required(self, checks: tuple[Check, ...]) -> list[str]:
        """What guards demand; what is not finite is found where a function ends."""
        relations = {"unreachable": ">= 0.0", "invalid": "> 0.0"}
        found = []
        for c in checks:
            bound = f"> {'s.tolerance * ' * c.power}({self.of(c.scale)})"
            value = self.of(sp.Abs(c.value) if c.trouble == "singular" else c.value)
            found.append(f"s.require({value} {relations.get(c.trouble, bound)})")
        return list(dict.fromkeys(found))

    def _inputs(self, function: Function) -> list[str]:
        """Names for prepared values, and for the entries of the input vectors that are read."""
        parts = slices(function)
        read = set[str]().union(*map(symbols, function.blocks)) | parts.reads_before
        named = [n for n in function.shared if n in read]
        named += [n for names in function.per_leg.values() for n in names]
        lines = [f'{name} = s.prepared["{name}"]' for name in named]
        for vector in function.inputs:
            size = self.bundle.coordinates.sizes[_SIZES[vector]]
            entries = [(k, f"{vector}_{k}") for k in range(size)]
            lines += [
                f"{name} = {vector}[{k}, ...]" for k, name in entries if name in parts.entries
            ]
        return lines

    def _array(self, function: Function, name: str) -> list[str]:
        """An output array, put together from what the blocks store."""
        shape, lines = self.bundle.program.shapes[name], []
        for block in function.blocks:
            legs = self.bundle.leg_counts.get(block.leg_type, 1)
            for store in (s for s in block.stores if s.array == name):
                places = flat_places(store, columns(shape), legs)
                lines.append(f"        ({places}, {self.of(store.value)}),")
        return ["    s.array(", f"        {shape},", *lines, "    ),"]

    def _parameters(self) -> list[str]:
        """Names for the entries of parameters and the signs of branches that are used."""
        program, table = self.bundle.program, self.bundle.derivation.parameters
        used = set[str]().union(*map(symbols, program.prepare)) | {n for n, _ in program.prepared}
        lines = []
        for name, (field, index) in table.entries.items():
            place = {0: (), 1: (index,), 2: divmod(index, 3)}[len(field.shape)]
            entry = ", ".join((*map(str, place), "..."))
            lines += [f'{name} = s.field("{field.name}")[{entry}]'] if name in used else []
        signs = [(n, s) for n, (_, s) in table.branches.items() if n in used]
        return lines + [f"{name} = s.signs({tuple(map(float, values))})" for name, values in signs]
