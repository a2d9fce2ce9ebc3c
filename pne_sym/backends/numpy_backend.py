"""The NumPy back end: one module that imports nothing but numpy."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from typing import Any

import sympy as sp

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import (
    Described,
    FieldView,
    describe,
    equation_titles,
    field_views,
)
from pne_sym.backends.scalar import PYTHON, ScalarPrinter, wrap
from pne_sym.backends.templating import render
from pne_sym.derivation import LegTypeInfo
from pne_sym.program.count import count_function
from pne_sym.program.ir import Assignment, Block, Function, Store

_WIDTH = 98
PLAN_NAMES = {"legs": "LEGS_FORCE"}


@dataclass(frozen=True)
class ClosureView:
    """Legs of a type whose displacements are found by iteration."""

    plan: str
    joints: list[list[int]]


@dataclass(frozen=True)
class ModuleView:
    """Ready strings for the module's template."""

    described: Described
    fields: tuple[FieldView, ...]
    defaults: tuple[str, ...]
    legs: tuple[LegTypeInfo, ...]
    driven_joints: tuple[int, ...]
    turning_drives: tuple[int, ...]
    actuator_legs: tuple[int, ...]
    closures: tuple[ClosureView, ...]
    extra_joints: tuple[int, ...]
    turning_joints: tuple[bool, ...]
    branches: tuple[str, ...]
    prepare: str
    functions: tuple[str, ...]
    plans: tuple[str, ...]


class NumpyBackend:
    """Emits NAME.py and __init__.py."""

    name = "numpy"

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """File name -> text."""
        view = self.view(bundle)
        return {
            f"{bundle.name}.py": render("numpy/module.py.jinja", view=view, d=view.described),
            "__init__.py": render("numpy/package.py.jinja", d=view.described),
        }

    def view(self, bundle: Bundle) -> ModuleView:
        """What the template prints."""
        writer = _Writer(bundle)
        plans = tuple(writer.plan(f) for f in bundle.program.functions.values())
        fields, c = field_views(bundle), bundle.coordinates
        driven = tuple(c.joints.index(a) for a in c.actuators)
        return ModuleView(
            describe(bundle),
            fields,
            tuple(line for f in fields for line in _default_lines(f)),
            bundle.derivation.leg_types,
            driven,
            tuple(k for k, j in enumerate(driven) if c.turning[j]),
            tuple(leg for leg, _ in c.actuators),
            _closures(bundle),
            tuple(c.joints.index(e) for e in c.extras),
            c.turning,
            writer.branches(),
            writer.prepare(),
            tuple(writer.function(f) for f in bundle.program.functions.values()),
            plans,
        )


def _closures(bundle: Bundle) -> tuple[ClosureView, ...]:
    """What the iteration on the loop closure needs, per leg type."""
    c = bundle.coordinates
    return tuple(
        ClosureView(
            f"_CLOSURE_{t.name.upper()}",
            [
                [c.joints.index((leg, j)) for j in range(t.joints) if t.methods[j] != "given"]
                for leg in t.indices
            ],
        )
        for t in bundle.derivation.leg_types
        if not t.is_closed
    )


def _default_lines(f: FieldView) -> list[str]:
    """Lines of a parameter's default, one per leg."""
    if not f.per_leg:
        return [f'"{f.name}": {f.rows[0]},']
    return [f'"{f.name}": [', *(f"    {row}," for row in f.rows), "],"]


class _Writer:
    def __init__(self, bundle: Bundle) -> None:
        self.bundle = bundle
        self.printer = ScalarPrinter(PYTHON)
        self.titles = equation_titles(bundle.derivation)

    def text(self, expr: Any) -> str:
        return str(self.printer.doprint(sp.sympify(expr)))

    # ---- straight-line code ------------------------------------------------------------

    def statements(self, assignments: tuple[Assignment, ...]) -> list[str]:
        """Assignments, headed by the equations they belong to."""
        lines: list[str] = []
        equation = ""
        for assignment in assignments:
            if assignment.equation != equation:
                equation = assignment.equation
                title = self.titles.get(equation, "")
                lines.append(f"# ({equation}) {title}" if title else f"# {equation}: named entries")
            lines += self.assign(str(assignment.target), self.text(assignment.expr))
        return lines

    def assign(self, target: str, value: str) -> list[str]:
        line = f"{target} = {value}"
        if len(line) <= _WIDTH - 4:
            return [line]
        return [f"{target} = (", *wrap(f"    {value}", _WIDTH - 4, "    "), ")"]

    def names(self, names: list[str], source: str) -> list[str]:
        """Unpack a tuple; nothing for an empty one."""
        if not names:
            return []
        line = (
            f"{', '.join(names)}, = {source}"
            if len(names) == 1
            else f"{', '.join(names)} = {source}"
        )
        if len(line) <= _WIDTH - 4:
            return [line]
        return ["(", *wrap("    " + ", ".join(names) + ",", _WIDTH - 4, "    "), f") = {source}"]

    def returns(self, values: list[str]) -> list[str]:
        """Return a tuple."""
        if not values:
            return ["return ()"]
        line = f"return ({', '.join(values)},)"
        if len(line) <= _WIDTH - 4:
            return [line]
        return ["return (", *wrap("    " + ", ".join(values) + ",", _WIDTH - 4, "    "), ")"]

    def checks(self, block_checks: Any) -> str:
        """One truth value of all guards of a block."""
        parts = []
        for check in block_checks:
            value = self.text(check.value)
            if check.trouble == "unreachable":
                parts.append(f"({value} >= 0.0)")
                continue
            tolerance = "_TOLERANCE * _TOLERANCE" if check.power == 2 else "_TOLERANCE"
            parts.append(f"(abs({value}) > {tolerance} * {self.text(check.scale)})")
        return " & ".join(dict.fromkeys(parts)) or "True"

    # ---- functions -----------------------------------------------------------------------

    def function(self, function: Function) -> str:
        """The parts of a function: before, over and after the legs."""
        counts = count_function(function, self.bundle.leg_counts)
        parts = [_Parts(self, function).text(counts)]
        return "\n\n\n".join(parts)

    def plan(self, function: Function) -> str:
        """How the parts are put together."""
        return _Parts(self, function).plan(self.bundle.program.shapes)

    # ---- preparation ----------------------------------------------------------------------

    def branches(self) -> tuple[str, ...]:
        """Signs of the assembly branches, per leg."""
        return tuple(
            f'"{name}": np.array([{", ".join(f"{s}.0" for s in signs)}]),'
            for name, (_, signs) in self.bundle.derivation.parameters.branches.items()
        )

    def prepare(self) -> str:
        """Body of the function that computes the prepared values."""
        program, table = self.bundle.program, self.bundle.derivation.parameters
        used = {s.name for block in program.prepare for s in _block_symbols(block)}
        formulas = [self.text(a.expr) for block in program.prepare for a in block.assignments]
        lines = ["sqrt = np.sqrt"]
        # Angles can be fixed by the parameters alone: of a leg that keeps a locked orientation.
        lines += [
            f"{name} = np.{of_numpy}"
            for name, of_numpy in (("sin", "sin"), ("cos", "cos"), ("atan2", "arctan2"))
            if any(f"{name}(" in formula for formula in formulas)
        ]
        # named, so that one more leg does not change every line that runs over the legs
        lines += [f'_{t} = (len(_LEGS["{t}"]),)' for t in self.bundle.leg_counts]
        for name, (parameter, index) in table.entries.items():
            if name in used:
                at = np_index(parameter.shape, index, per_leg=parameter.leg_type is not None)
                lines.append(f"{name} = p.{parameter.name}{at}")
        for name in table.branches:
            if name in used:
                lines.append(f'{name} = _BRANCHES["{name}"]')
        for block in program.prepare:
            lines += self.statements(block.assignments)
            for target, value in block.sums:
                legs = f"_{block.leg_type}"
                lines.append(f"{target} = np.sum(np.broadcast_to({self.text(value)}, {legs}))")
        shared = [n for n, leg in program.prepared if not leg]
        lines.append("shared = {")
        lines += [f'    "{n}": float({n}),' for n in shared]
        lines += ["}", "legs = {"]
        for leg_type in self.bundle.leg_counts:
            lines.append(f'    "{leg_type}": {{')
            for n in (n for n, leg in program.prepared if leg == leg_type):
                lines.append(f'        "{n}": np.broadcast_to({n}, _{leg_type}),')
            lines.append("    },")
        lines += ["}", "return shared, legs"]
        return textwrap.indent("\n".join(lines), "    ")


def np_index(shape: tuple[int, ...], index: int, *, per_leg: bool) -> str:
    """Subscript of one entry of a parameter array."""
    where = []
    if per_leg:
        where.append(":")
    if shape == (3,):
        where.append(str(index))
    elif shape == (3, 3):
        where += [str(index // 3), str(index % 3)]
    return f"[{', '.join(where)}]" if where and where != [":"] else ""


def _block_symbols(block: Block) -> set[Any]:
    expressions = [a.expr for a in block.assignments]
    expressions += [sp.sympify(s.value) for s in block.stores]
    expressions += [sp.sympify(v) for _, v in block.sums]
    expressions += [e for c in block.checks for e in (c.value, c.scale)]
    return {symbol for e in expressions for symbol in e.free_symbols}


class _Parts:
    """Names of the values that pass between the parts of a function."""

    def __init__(self, writer: _Writer, function: Function) -> None:
        self.w = writer
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
            for s in _block_symbols(b)
        }
        self.passed = [n for n in dict.fromkeys(made) if n in later]

    def text(self, counts: Any) -> str:
        """All parts as functions."""
        f, name = self.f, self.f.name
        comment = (
            f"# {name}: {counts.mul} mul, {counts.add} add, {counts.div} div, "
            f"{counts.sqrt} sqrt, {counts.trig} trig"
        )
        parts = [comment + "\n" + self._before(name)]
        parts += [self._leg(name, block) for block in self.legs]
        if self.total:
            parts.append(self._after(name))
        del f
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
        count = self.w.bundle.coordinates.sizes[sizes[vector]]
        return [k for k in range(count) if f"{vector}_{k}" in used]

    def _shared(self, block: Block | None, unpack: tuple[Assignment, ...] = ()) -> list[str]:
        used = {s.name for s in _block_symbols(block)} if block else set()
        used |= {s.name for a in unpack for s in a.expr.free_symbols}
        return [n for n in self.f.shared if n in used]

    def _tuple(self, values: list[str]) -> str:
        return ", ".join(values) + ("," if values else "")

    def _store_values(self, block: Block | None) -> list[str]:
        if block is None:
            return []
        return [self.w.text(store.value) for store in block.stores]

    def _leg(self, name: str, block: Block) -> str:
        leg = block.leg_type
        used = {s.name for s in _block_symbols(block)}
        inputs = [i.symbol.name for i in self.f.leg_inputs.get(leg, ())]
        body = self.w.names([n for n in self.f.shared if n in used], "c")
        body += self.w.names(list(self.f.per_leg.get(leg, ())), "k")
        body += self.w.names(inputs, "x")
        body += self.w.names([n for n in self.passed if n in used], "s")
        body += self.w.statements(block.assignments)
        body.append(f"ok = {self.w.checks(block.checks)}")
        sums = [self.w.text(value) for _, value in block.sums]
        body += self.w.returns(
            ["ok", f"({self._tuple(sums)})", f"({self._tuple(self._store_values(block))})"]
        )
        return self._define(f"_{name}_{leg}(c, k, x, s, f)", body)

    def _after(self, name: str) -> str:
        assert self.total is not None
        used = {s.name for s in _block_symbols(self.total)}
        sums = [str(t) for b in self.legs for t, _ in b.sums]
        body = self.w.names(self._shared(self.total), "c")
        body += self.w.names([n for n in self.passed if n in used], "s")
        body += self.w.names(sums, "t")
        body += self.w.statements(self.total.assignments)
        body.append(f"ok = {self.w.checks(self.total.checks)}")
        body += self.w.returns(["ok", f"({self._tuple(self._store_values(self.total))})"])
        return self._define(f"_{name}_after(c, s, t, f)", body)

    # ---- plan ------------------------------------------------------------------------------

    def plan(self, shapes: dict[str, tuple[int, ...]]) -> str:
        """The table that `_run` follows."""
        name = self.f.name
        lines = [f"_{PLAN_NAMES.get(name, name.upper())} = _Plan("]
        lines.append(f"    inputs={self.f.inputs!r},")
        arrays = tuple((a, shapes[a]) for a in self.f.arrays)
        lines += wrap(f"    arrays={arrays!r},", _WIDTH, "        ")
        before = self._shared(self.before, self.f.unpack)
        lines += self._listing(
            "    before", f"_{name}_before", before, self._targets(self.before, shapes)
        )
        lines.append("    legs=(")
        for block in self.legs:
            lines += self._leg_plan(name, block, shapes)
        lines.append("    ),")
        if self.total:
            used = {s.name for s in _block_symbols(self.total)}
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
        lines += wrap(f"{inner}{tuple(names)!r},", _WIDTH, inner)
        if passed is not None:
            lines += wrap(f"{inner}{tuple(passed)!r},", _WIDTH, inner)
        else:
            lines.append(f"{inner}None,")
        lines.append(
            f"{inner}({', '.join(targets)}{',' if targets else ''}),"
            if len(targets) < 4
            else f"{inner}("
        )
        if len(targets) >= 4:
            lines += wrap(f"{inner}    " + ", ".join(targets) + ",", _WIDTH, f"{inner}    ")
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
        used = {s.name for s in _block_symbols(block)}
        passed = [k for k, n in enumerate(self.passed) if n in used]
        inputs = tuple((i.vector, i.indices) for i in self.f.leg_inputs.get(leg, ()))
        shared = [n for n in self.f.shared if n in used]
        inner = "            "
        lines = ["        _LegPart(", f"{inner}_{name}_{leg},", f'{inner}"{leg}",']
        lines += wrap(f"{inner}{tuple(shared)!r},", _WIDTH, inner)
        lines += wrap(f"{inner}{tuple(self.f.per_leg.get(leg, ()))!r},", _WIDTH, inner)
        lines += wrap(f"{inner}{inputs!r},", _WIDTH, inner)
        lines += wrap(f"{inner}{tuple(passed)!r},", _WIDTH, inner)
        lines.append(f"{inner}{len(block.sums)},")
        lines.append(f"{inner}(")
        for target in self._targets(block, shapes):
            lines += wrap(f"{inner}    {target},", _WIDTH, f"{inner}    ")
        lines += [f"{inner}),", "        ),"]
        return lines


def _is_total(block: Block, blocks: tuple[Block, ...]) -> bool:
    """Whether a block without legs stands after a leg loop."""
    place = blocks.index(block)
    return any(b.leg_type for b in blocks[:place])
