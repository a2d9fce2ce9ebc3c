"""The parts of a function in NumPy: before the legs, over the legs of a type, after them."""

from __future__ import annotations

import textwrap
from typing import Any

import sympy as sp

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.numpy_text import WIDTH, PythonText
from pne_sym.backends.scalar import wrap
from pne_sym.program.count import count_function
from pne_sym.program.ir import Assignment, Block, Function, Store

PLAN_NAMES = {"legs": "LEGS_FORCE"}


def block_symbols(block: Block) -> set[Any]:
    """Symbols that a block reads or computes with."""
    expressions = [a.expr for a in block.assignments]
    expressions += [sp.sympify(s.value) for s in block.stores]
    expressions += [sp.sympify(v) for _, v in block.sums]
    expressions += [e for c in block.checks for e in (c.value, c.scale)]
    return {symbol for e in expressions for symbol in e.free_symbols}


class Parts:
    """A function in parts, and the names of the values that pass between them."""

    def __init__(self, text: PythonText, bundle: Bundle, function: Function) -> None:
        self.w, self.bundle = text, bundle
        self.f = function
        blocks = function.blocks
        self.before = next((b for b in blocks if not b.leg_type and not _is_total(b, blocks)), None)
        self.legs = [b for b in blocks if b.leg_type]
        self.total = next((b for b in blocks if not b.leg_type and b is not self.before), None)
        made = [str(a.target) for a in function.unpack]
        made += [str(a.target) for a in (self.before.assignments if self.before else ())]
        later = {
            s.name
            for b in [*self.legs, *([self.total] if self.total else [])]
            for s in block_symbols(b)
        }
        self.passed = [n for n in dict.fromkeys(made) if n in later]

    def text(self) -> str:
        """All parts as functions, headed by the operation counts."""
        name, counts = self.f.name, count_function(self.f, self.bundle.leg_counts)
        comment = (
            f"# {name}: {counts.mul} mul, {counts.add} add, {counts.div} div, "
            f"{counts.sqrt} sqrt, {counts.trig} trig"
        )
        parts = [comment + "\n" + self._before(name)]
        parts += [self._leg(name, block) for block in self.legs]
        if self.total:
            parts.append(self._after(name))
        return "\n\n\n".join(parts)

    def _header(self, lines: list[str], names: list[str]) -> list[str]:
        used = " ".join(lines)
        return [f"{n} = f.{n}" for n in names if f"{n}(" in used]

    def _define(self, signature: str, body: list[str]) -> str:
        math = self._header(body, ["sqrt", "sin", "cos", "atan2"])
        return f"def {signature}:\n" + textwrap.indent("\n".join(math + body), "    ")

    def _before(self, name: str) -> str:
        inputs = {v: self._entries(v) for v in self.f.inputs}
        body = self.w.names(self._shared(self.before, self.f.unpack), "c")
        for vector, size in inputs.items():
            for k in size:
                body.append(f"{vector}_{k} = {vector}[{k}]")
        body += self.w.statements(self.f.unpack)
        checks = list(self.f.unpack_checks)
        if self.before:
            body += self.w.statements(self.before.assignments)
            checks += self.before.checks
        stores = self._store_values(self.before)
        body.append(f"ok = {self._input_checks(checks)}")
        body += self.w.returns(["ok", f"({self._tuple(self.passed)})", f"({self._tuple(stores)})"])
        return self._define(
            f"_{name}_before(c, {', '.join(self.f.inputs)}, f)"
            if self.f.inputs
            else f"_{name}_before(c, f)",
            body,
        )

    def _input_checks(self, checks: list[Any]) -> str:
        parts = [f"({c.value} > 0.0)" for c in checks if c.trouble == "invalid"]
        rest = [c for c in checks if c.trouble != "invalid"]
        if rest:
            parts.append(self.w.checks(rest))
        return " & ".join(parts) or "True"

    def _entries(self, vector: str) -> list[int]:
        used = {s.name for a in self.f.unpack for s in a.expr.free_symbols}
        sizes = {"X": "NQ", "V": "NV", "A": "NV", "q": "NJ"}
        count = self.bundle.coordinates.sizes[sizes[vector]]
        return [k for k in range(count) if f"{vector}_{k}" in used]

    def _shared(self, block: Block | None, unpack: tuple[Assignment, ...] = ()) -> list[str]:
        used = {s.name for s in block_symbols(block)} if block else set()
        used |= {s.name for a in unpack for s in a.expr.free_symbols}
        return [n for n in self.f.shared if n in used]

    def _tuple(self, values: list[str]) -> str:
        return ", ".join(values) + ("," if values else "")

    def _store_values(self, block: Block | None) -> list[str]:
        if block is None:
            return []
        return [self.w.of(store.value) for store in block.stores]

    def _leg(self, name: str, block: Block) -> str:
        leg = block.leg_type
        used = {s.name for s in block_symbols(block)}
        inputs = [i.symbol.name for i in self.f.leg_inputs.get(leg, ())]
        body = self.w.names([n for n in self.f.shared if n in used], "c")
        body += self.w.names(list(self.f.per_leg.get(leg, ())), "k")
        body += self.w.names(inputs, "x")
        body += self.w.names([n for n in self.passed if n in used], "s")
        body += self.w.statements(block.assignments)
        body.append(f"ok = {self.w.checks(block.checks)}")
        sums = [self.w.of(value) for _, value in block.sums]
        body += self.w.returns(
            ["ok", f"({self._tuple(sums)})", f"({self._tuple(self._store_values(block))})"]
        )
        return self._define(f"_{name}_{leg}(c, k, x, s, f)", body)

    def _after(self, name: str) -> str:
        assert self.total is not None
        used = {s.name for s in block_symbols(self.total)}
        sums = [str(t) for b in self.legs for t, _ in b.sums]
        body = self.w.names(self._shared(self.total), "c")
        body += self.w.names([n for n in self.passed if n in used], "s")
        body += self.w.names(sums, "t")
        body += self.w.statements(self.total.assignments)
        body.append(f"ok = {self.w.checks(self.total.checks)}")
        body += self.w.returns(["ok", f"({self._tuple(self._store_values(self.total))})"])
        return self._define(f"_{name}_after(c, s, t, f)", body)

    # ---- plan ------------------------------------------------------------------------------

    def plan(self) -> str:
        """The table that `_run` follows."""
        name, shapes = self.f.name, self.bundle.program.shapes
        lines = [f"_{PLAN_NAMES.get(name, name.upper())} = _Plan("]
        lines.append(f"    inputs={self.f.inputs!r},")
        arrays = tuple((a, shapes[a]) for a in self.f.arrays)
        lines += wrap(f"    arrays={arrays!r},", WIDTH, "        ")
        before = self._shared(self.before, self.f.unpack)
        lines += self._listing(
            "    before", f"_{name}_before", before, self._targets(self.before, shapes)
        )
        lines.append("    legs=(")
        for block in self.legs:
            lines += self._leg_plan(name, block, shapes)
        lines.append("    ),")
        if self.total:
            used = {s.name for s in block_symbols(self.total)}
            passed = [k for k, n in enumerate(self.passed) if n in used]
            lines += self._listing(
                "    after",
                f"_{name}_after",
                self._shared(self.total),
                self._targets(self.total, shapes),
                passed,
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
        width = shapes[store.array][1] if len(shapes[store.array]) == 2 else 1
        rows, columns = store.row, store.column if store.column is not None else 0
        if isinstance(rows, tuple) or isinstance(columns, tuple):
            count = len(rows) if isinstance(rows, tuple) else len(columns)  # type: ignore[arg-type]
            r = rows if isinstance(rows, tuple) else (rows,) * count
            c = columns if isinstance(columns, tuple) else (columns,) * count
            return repr(tuple(i * width + j for i, j in zip(r, c, strict=True)))
        return repr(rows * width + columns)

    def _leg_plan(self, name: str, block: Block, shapes: dict[str, tuple[int, ...]]) -> list[str]:
        leg = block.leg_type
        used = {s.name for s in block_symbols(block)}
        passed = [k for k, n in enumerate(self.passed) if n in used]
        inputs = tuple((i.vector, i.indices) for i in self.f.leg_inputs.get(leg, ()))
        shared = [n for n in self.f.shared if n in used]
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


def _is_total(block: Block, blocks: tuple[Block, ...]) -> bool:
    """Whether a block without legs stands after a leg loop."""
    place = blocks.index(block)
    return any(b.leg_type for b in blocks[:place])
