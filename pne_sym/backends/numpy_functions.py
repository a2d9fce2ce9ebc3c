"""Functions of a program in NumPy: straight-line code, with the legs of a type in a loop.

It runs in a mode m: `Floats` compute a state after another; for many states it runs once on values
that record what is done, and the record is replayed on arrays.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from typing import Any

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.python_text import WIDTH, PythonText
from pne_sym.backends.scalar import wrap
from pne_sym.program.count import count_function
from pne_sym.program.ir import Block, Check, Function
from pne_sym.program.slices import columns, flat_places, slices

_MATH = ("sqrt", "sin", "cos", "atan2", "least")
_STATUSES = {"invalid": "valid", "unreachable": "reached", "singular": "clear"}


class Places:
    """Where the values of legs stand in arrays: tables over the legs, named once for a module."""

    def __init__(self) -> None:
        self.tables: dict[str, list[tuple[int, ...]]] = {}

    def named(self, array: str, leg_type: str, table: tuple[int, ...]) -> str:
        """The table, which is that of an array's entry, as code."""
        known = self.tables.setdefault(f"_{array}_{leg_type}", [])
        if table not in known:
            known.append(table)
        return f"_{array}_{leg_type}[{known.index(table)}]"

    def lines(self) -> tuple[str, ...]:
        """Definitions of the tables."""
        found = []
        for name, tables in self.tables.items():
            found += [f"{name} = (", *(f"    {list(table)}," for table in tables), ")"]
        return tuple(found)


class FunctionText:
    """Writes a function of a program.

    Args:
        bundle: of the model.
        function: what is written.
        places: of values of legs in the module's arrays.
        judged: it tells why a state is impossible, not only whether.
    """

    def __init__(self, bundle: Bundle, function: Function, places: Places, *, judged: bool) -> None:
        self.bundle, self.f, self.places, self.judged = bundle, function, places, judged
        parts = slices(function)
        self.reads, self.entries = parts.reads, parts.entries
        self.outside, self.inside = PythonText(bundle), PythonText(bundle, indent=8)

    def text(self) -> str:
        """The function, headed by its operation counts."""
        name, counts = self.f.name, count_function(self.f, self.bundle.leg_counts)
        body = self._inputs() + self.outside.statements(self.f.unpack)
        body += [f"{flag} = True" for flag in self._flags()]
        body += self._required(self.f.unpack_checks)
        body += [f'out_{array} = m.zeros("{array}")' for array in self.f.arrays]
        loops = [block for block in self.f.blocks if block.leg_type]
        for block in self.f.blocks:
            body += self._loop(block, loops.index(block)) if block.leg_type else self._once(block)
        used = " ".join(body)
        math = [f"{n} = m.{n}" for n in _MATH if f"{n}(" in used]
        body = math + body + [f"return {self._status()}, {self._tuple(self._outputs())}"]
        return (
            f"# {name}: {counts.text}\n"
            f"def _run_{name}({', '.join(('m', *self.f.inputs))}):\n"
            + textwrap.indent("\n".join(body), "    ")
        )

    def constants(self) -> list[str]:
        """The prepared values that it reads: shared ones, and those of the legs of each loop."""
        lines = [f'"{self.f.name}": (', *self._listed(self._shared()), "    ("]
        for block in (b for b in self.f.blocks if b.leg_type):
            values = self._listed(self.f.per_leg.get(block.leg_type, ()), "    ")
            lines += [f"        (_{block.leg_type},", *values, "        ),"]
        return [*lines, "    ),", "),"]

    def _listed(self, names: Sequence[str], indent: str = "") -> list[str]:
        inner = "    " + indent
        return wrap(f"{inner}({self._tuple(names)[1:-1]}),", WIDTH - 8, f"{inner}    ")

    # ---- parts -------------------------------------------------------------------------------

    def _shared(self) -> list[str]:
        return [name for name in self.f.shared if name in self.reads]

    def _inputs(self) -> list[str]:
        """Names for prepared values, and for the entries of the input vectors that are read."""
        lines = []
        if self._shared() or any(b.leg_type for b in self.f.blocks):
            lines.append(f'shared, legs = m.constants("{self.f.name}")')
        lines += self.outside.names(self._shared(), "shared")
        for vector in self.f.inputs:
            size = self.bundle.coordinates.lengths[vector]
            lines += [
                f"{vector}_{k} = {vector}[{k}]"
                for k in range(size)
                if f"{vector}_{k}" in self.entries
            ]
        return lines

    def _once(self, block: Block) -> list[str]:
        lines = self.outside.statements(block.assignments) + self._required(block.checks)
        rows = []
        for store in block.stores:
            (place,) = flat_places(store, self._columns(store.array))
            text = self.outside.assign(f"out_{store.array}[{place}]", self._of(store.value))
            rows.append((store.equation, text))
        return lines + self.outside.headed(rows)

    def _loop(self, block: Block, number: int) -> list[str]:
        """Statements of the legs of a type."""
        leg, text = block.leg_type, self.inside
        constants = list(self.f.per_leg.get(leg, ()))
        lines = text.names(constants, "k")
        for entry in self.f.leg_inputs.get(leg, ()):
            lines.append(f"{entry.symbol} = {entry.vector}[{list(entry.indices)}[leg]]")
        lines += text.statements(block.assignments) + self._required(block.checks)
        rows = []
        for s in block.sums:
            rows.append((s.equation, text.assign(str(s.target), self._of(s.expr), "+=")))
        for store in block.stores:
            table = flat_places(store, self._columns(store.array), self.bundle.leg_counts[leg])
            target = f"out_{store.array}[{self.places.named(store.array, leg, table)}[leg]]"
            rows.append((store.equation, text.assign(target, self._of(store.value))))
        lines += text.headed(rows)
        sums = [str(s.target) for s in block.sums]
        return [
            *self.outside.names(sums, f"[0.0] * {len(sums)}"),
            f"for leg, k in legs[{number}]:",
            *textwrap.indent("\n".join(lines), "    ").split("\n"),
        ]

    # ---- guards ------------------------------------------------------------------------------

    def _flags(self) -> list[str]:
        return list(_STATUSES.values()) if self.judged else ["ok"]

    def _status(self) -> str:
        return f"({', '.join(self._flags())})" if self.judged else "ok"

    def _required(self, checks: Iterable[Check]) -> list[str]:
        """What guards demand."""
        demands: dict[str, list[str]] = {}
        for check in checks:
            flag = _STATUSES[check.status] if self.judged else "ok"
            demands.setdefault(flag, []).append(self._demand(check))
        lines = []
        for flag, parts in demands.items():
            lines += self.inside.assign(flag, f"{flag} & {' & '.join(dict.fromkeys(parts))}")
        return lines

    def _demand(self, check: Check) -> str:
        value = self._of(check.value)
        if check.status == "unreachable":
            return f"({value} >= 0.0)"
        if check.status == "invalid":
            return f"({value} > 0.0) & ({value} < np.inf)"
        tolerance = "_TOLERANCE * _TOLERANCE" if check.power == 2 else "_TOLERANCE"
        return f"(abs({value}) > {tolerance} * {self._of(check.scale)})"

    # ---- texts -------------------------------------------------------------------------------

    def _of(self, value: Any) -> str:
        return self.outside.of(value)

    def _tuple(self, values: Sequence[str]) -> str:
        return f"({', '.join(values)}{',' if values else ''})"

    def _outputs(self) -> list[str]:
        return [f"out_{array}" for array in self.f.arrays]

    def _columns(self, array: str) -> int:
        return columns(self.bundle.program.shapes[array])
