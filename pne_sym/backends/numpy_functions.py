"""Functions of a program in NumPy: straight-line code, with the legs of a type in a loop.

It runs in a mode m: `Floats` compute a state after another; for many states it runs once on values
that record what is done, and the record is replayed on arrays.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.python_text import WIDTH, PythonText
from pne_sym.backends.scalar import wrap
from pne_sym.backends.straight import Forms
from pne_sym.program.count import count_function
from pne_sym.program.ir import Block, Check, Function
from pne_sym.program.slices import columns, flat_places, slices

_MATH = ("sqrt", "sin", "cos", "atan2", "least")
_STATUSES = {"invalid": "valid", "unreachable": "reached", "singular": "clear"}
_GOOD = {
    "invalid": "({value} > 0.0) & ({value} < np.inf)",
    "unreachable": "({value} >= 0.0)",
    "singular": "(abs({value}) > {tolerance} * {scale})",
}


class Code(PythonText):
    """Writes statements in a mode.

    Args:
        bundle: of the model.
        judged: they tell why a state is impossible, not only whether.
        indent: of the lines.
    """

    def __init__(self, bundle: Bundle, *, judged: bool = False, indent: int = 4) -> None:
        super().__init__(bundle, indent=indent)
        flags = {status: _STATUSES[status] if judged else "ok" for status in _STATUSES}
        self.flags = tuple(dict.fromkeys(flags.values()))
        self.forms = Forms(
            prepared="",
            entry="{vector}[{k}]",
            legs="{vector}[{places}[leg]]",
            field="p.{field}{at}",
            signs='_BRANCHES["{name}"]',
            total="np.sum(np.broadcast_to({value}, _{leg_type}))",
            demand="{good}",
            good={status: f"{flag} = {flag} & {_GOOD[status]}" for status, flag in flags.items()},
            tolerance={1: "_TOLERANCE", 2: "_TOLERANCE * _TOLERANCE"},
        )

    def required(self, checks: Iterable[Check]) -> list[str]:
        """What guards demand, each once."""
        rows = (line.split(" = ", 1) for line in super().required(checks))
        return [line for flag, value in rows for line in self.assign(flag, value)]


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
        tables: of places of values of legs in the module's arrays.
        judged: it tells why a state is impossible, not only whether.
    """

    def __init__(self, bundle: Bundle, function: Function, tables: Places, *, judged: bool) -> None:
        self.bundle, self.f, self.tables, self.judged = bundle, function, tables, judged
        self.outside = Code(bundle, judged=judged)
        self.inside = Code(bundle, judged=judged, indent=8)
        reads = slices(function).reads
        self.shared = [name for name in function.shared if name in reads]
        self.loops = [block for block in function.blocks if block.leg_type]

    def text(self) -> str:
        """The function, headed by its operation counts."""
        name, counts = self.f.name, count_function(self.f, self.bundle.leg_counts)
        body, flags = self._prepared() + self.outside.entries(self.f), self.outside.flags
        body += self.outside.statements(self.f.unpack)
        body += [f"{flag} = True" for flag in flags]
        body += self.outside.required(self.f.unpack_checks)
        body += [f'out_{array} = m.zeros("{array}")' for array in self.f.arrays]
        for block in self.f.blocks:
            body += self._loop(block) if block.leg_type else self._once(block)
        used = " ".join(body)
        math = [f"{n} = m.{n}" for n in _MATH if f"{n}(" in used]
        status = f"({', '.join(flags)})" if self.judged else "ok"
        outputs = _tuple([f"out_{array}" for array in self.f.arrays])
        lines = "\n".join([*math, *body, f"return {status}, {outputs}"])
        head = f"def _run_{name}({', '.join(('m', *self.f.inputs))}):"
        return f"# {name}: {counts.text}\n{head}\n{textwrap.indent(lines, '    ')}"

    def constants(self) -> list[str]:
        """The prepared values that it reads: shared ones, and those of the legs of each loop."""
        lines = [f'"{self.f.name}": (', *_listed(self.shared), "    ("]
        for block in self.loops:
            values = _listed(self.f.per_leg.get(block.leg_type, ()), "    ")
            lines += [f"        (_{block.leg_type},", *values, "        ),"]
        return [*lines, "    ),", "),"]

    def _prepared(self) -> list[str]:
        """Names for prepared values."""
        is_any = self.shared or self.loops
        lines = [f'shared, legs = m.constants("{self.f.name}")'] if is_any else []
        return lines + self.outside.names(self.shared, "shared")

    def _once(self, block: Block) -> list[str]:
        rows = []
        for store in block.stores:
            (place,) = flat_places(store, self._columns(store.array))
            text = self.outside.assign(f"out_{store.array}[{place}]", self.outside.of(store.value))
            rows.append((store.equation, text))
        return self.outside.block(block) + self.outside.headed(rows)

    def _loop(self, block: Block) -> list[str]:
        """Statements of the legs of a type."""
        leg, text = block.leg_type, self.inside
        lines = text.names(list(self.f.per_leg.get(leg, ())), "k")
        lines += text.leg_inputs(self.f, leg)
        lines += text.statements(block.assignments) + text.required(block.checks)
        rows = []
        for s in block.sums:
            rows.append((s.equation, text.assign(str(s.target), text.of(s.expr), "+=")))
        for store in block.stores:
            table = flat_places(store, self._columns(store.array), self.bundle.leg_counts[leg])
            target = f"out_{store.array}[{self.tables.named(store.array, leg, table)}[leg]]"
            rows.append((store.equation, text.assign(target, text.of(store.value))))
        lines += text.headed(rows)
        sums = [str(s.target) for s in block.sums]
        return [
            *self.outside.names(sums, f"[0.0] * {len(sums)}"),
            f"for leg, k in legs[{self.loops.index(block)}]:",
            *textwrap.indent("\n".join(lines), "    ").split("\n"),
        ]

    def _columns(self, array: str) -> int:
        return columns(self.bundle.program.shapes[array])


def _tuple(values: Sequence[str]) -> str:
    return f"({', '.join(values)}{',' if values else ''})"


def _listed(names: Sequence[str], indent: str = "") -> list[str]:
    inner = "    " + indent
    return wrap(f"{inner}{_tuple(names)},", WIDTH - 8, f"{inner}    ")
