"""The parts of a function in NumPy: before the legs, over the legs of a type, after them."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.numpy_text import WIDTH, PythonText
from pne_sym.backends.scalar import wrap
from pne_sym.program.count import count_function
from pne_sym.program.ir import Block, Function, Store
from pne_sym.program.slices import columns, flat_places, slices

PLAN_NAMES = {"legs": "LEGS_FORCE"}


class Parts:
    """A function in parts, and the names of the values that pass between them."""

    def __init__(self, text: PythonText, bundle: Bundle, function: Function) -> None:
        self.w, self.bundle = text, bundle
        self.f = function
        self.slices = slices(function)

    def text(self) -> str:
        """All parts as functions, headed by the operation counts."""
        name, counts = self.f.name, count_function(self.f, self.bundle.leg_counts)
        comment = (
            f"# {name}: {counts.mul} mul, {counts.add} add, {counts.div} div, "
            f"{counts.sqrt} sqrt, {counts.trig} trig"
        )
        parts = [comment + "\n" + self._before(name)]
        parts += [self._leg(name, block) for block in self.slices.legs]
        if self.slices.after:
            parts.append(self._after(name, self.slices.after))
        return "\n\n\n".join(parts)

    def _header(self, lines: list[str], names: list[str]) -> list[str]:
        used = " ".join(lines)
        return [f"{n} = f.{n}" for n in names if f"{n}(" in used]

    def _define(self, signature: str, body: list[str]) -> str:
        math = self._header(body, ["sqrt", "sin", "cos", "atan2", "least"])
        return f"def {signature}:\n" + textwrap.indent("\n".join(math + body), "    ")

    def _before(self, name: str) -> str:
        part = self.slices.before
        inputs = {v: self._entries(v) for v in self.f.inputs}
        body = self.w.names(self.slices.shared(part), "c")
        for vector, size in inputs.items():
            for k in size:
                body.append(f"{vector}_{k} = {vector}[{k}]")
        body += self.w.statements(self.f.unpack)
        checks = list(self.f.unpack_checks)
        if part:
            body += self.w.statements(part.assignments)
            checks += part.checks
        stores = self._store_values(part)
        body.append(f"ok = {self._input_checks(checks)}")
        body += self.w.returns(
            ["ok", f"({self._tuple(self.slices.passed)})", f"({self._tuple(stores)})"]
        )
        return self._define(
            f"_{name}_before(c, {', '.join(self.f.inputs)}, f)"
            if self.f.inputs
            else f"_{name}_before(c, f)",
            body,
        )

    def _input_checks(self, checks: list[Any]) -> str:
        parts = [
            f"({c.value} > 0.0) & ({c.value} < np.inf)" for c in checks if c.trouble == "invalid"
        ]
        rest = [c for c in checks if c.trouble != "invalid"]
        if rest:
            parts.append(self.w.checks(rest))
        return " & ".join(parts) or "True"

    def _entries(self, vector: str) -> list[int]:
        sizes = {"X": "NQ", "V": "NV", "A": "NV", "q": "NJ"}
        return self.slices.entries(vector, self.bundle.coordinates.sizes[sizes[vector]])

    def _tuple(self, values: Sequence[str]) -> str:
        return ", ".join(values) + ("," if values else "")

    def _store_values(self, block: Block | None) -> list[str]:
        if block is None:
            return []
        return [self.w.of(store.value) for store in block.stores]

    def _leg(self, name: str, block: Block) -> str:
        leg = block.leg_type
        inputs = [i.symbol.name for i in self.f.leg_inputs.get(leg, ())]
        body = self.w.names(self.slices.shared(block), "c")
        body += self.w.names(list(self.f.per_leg.get(leg, ())), "k")
        body += self.w.names(inputs, "x")
        body += self.w.names(self.slices.passed_to(block), "s")
        body += self.w.statements(block.assignments)
        body.append(f"ok = {self.w.checks(block.checks)}")
        sums = [self.w.of(value) for _, value in block.sums]
        body += self.w.returns(
            ["ok", f"({self._tuple(sums)})", f"({self._tuple(self._store_values(block))})"]
        )
        return self._define(f"_{name}_{leg}(c, k, x, s, f)", body)

    def _after(self, name: str, block: Block) -> str:
        body = self.w.names(self.slices.shared(block), "c")
        body += self.w.names(self.slices.passed_to(block), "s")
        body += self.w.names(list(self.slices.sums), "t")
        body += self.w.statements(block.assignments)
        body.append(f"ok = {self.w.checks(block.checks)}")
        body += self.w.returns(["ok", f"({self._tuple(self._store_values(block))})"])
        return self._define(f"_{name}_after(c, s, t, f)", body)

    # ---- plan ------------------------------------------------------------------------------

    def plan(self) -> str:
        """The table that `_run` follows."""
        name, shapes = self.f.name, self.bundle.program.shapes
        lines = [f"_{PLAN_NAMES.get(name, name.upper())} = _Plan("]
        lines.append(f"    inputs={self.f.inputs!r},")
        arrays = tuple((a, shapes[a]) for a in self.f.arrays)
        lines += wrap(f"    arrays={arrays!r},", WIDTH, "        ")
        parts = self.slices
        lines += self._listing(
            "    before",
            f"_{name}_before",
            parts.shared(parts.before),
            self._targets(parts.before, shapes),
        )
        lines.append("    legs=(")
        for block in parts.legs:
            lines += self._leg_plan(name, block, shapes)
        lines.append("    ),")
        if parts.after:
            lines += self._listing(
                "    after",
                f"_{name}_after",
                parts.shared(parts.after),
                self._targets(parts.after, shapes),
                [parts.passed.index(n) for n in parts.passed_to(parts.after)],
            )
        lines.append(")")
        return "\n".join(lines)

    def _listing(
        self,
        key: str,
        function: str,
        names: list[str],
        targets: list[str],
        passed: list[int] | None = None,
    ) -> list[str]:
        lines = [f"{key}=_Part("]
        inner = "        "
        lines.append(f"{inner}{function},")
        lines += wrap(f"{inner}{tuple(names)!r},", WIDTH, inner)
        if passed is not None:
            lines += wrap(f"{inner}{tuple(passed)!r},", WIDTH, inner)
        else:
            lines.append(f"{inner}None,")
        lines.append(
            f"{inner}({', '.join(targets)}{',' if targets else ''}),"
            if len(targets) < 4
            else f"{inner}("
        )
        if len(targets) >= 4:
            lines += wrap(f"{inner}    " + ", ".join(targets) + ",", WIDTH, f"{inner}    ")
            lines.append(f"{inner}),")
        lines.append("    ),")
        return lines

    def _targets(self, block: Block | None, shapes: dict[str, tuple[int, ...]]) -> list[str]:
        """(array number, flat index) of every stored value."""
        if block is None:
            return []
        return [f"({self.f.arrays.index(s.array)}, {self._flat(s, shapes)})" for s in block.stores]

    def _flat(self, store: Store, shapes: dict[str, tuple[int, ...]]) -> str:
        tables = [i for i in (store.row, store.column) if isinstance(i, tuple)]
        width = columns(shapes[store.array])
        places = flat_places(store, width, len(tables[0]) if tables else 1)
        return repr(places if tables else places[0])

    def _leg_plan(self, name: str, block: Block, shapes: dict[str, tuple[int, ...]]) -> list[str]:
        leg = block.leg_type
        parts = self.slices
        passed = [parts.passed.index(n) for n in parts.passed_to(block)]
        inputs = tuple((i.vector, i.indices) for i in self.f.leg_inputs.get(leg, ()))
        shared = parts.shared(block)
        inner = "            "
        lines = ["        _LegPart(", f"{inner}_{name}_{leg},", f'{inner}"{leg}",']
        lines += wrap(f"{inner}{tuple(shared)!r},", WIDTH, inner)
        lines += wrap(f"{inner}{tuple(self.f.per_leg.get(leg, ()))!r},", WIDTH, inner)
        lines += wrap(f"{inner}{inputs!r},", WIDTH, inner)
        lines += wrap(f"{inner}{tuple(passed)!r},", WIDTH, inner)
        lines.append(f"{inner}{len(block.sums)},")
        lines.append(f"{inner}(")
        for target in self._targets(block, shapes):
            lines += wrap(f"{inner}    {target},", WIDTH, f"{inner}    ")
        lines += [f"{inner}),", "        ),"]
        return lines
