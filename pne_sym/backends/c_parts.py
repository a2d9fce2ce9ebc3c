"""The parts of a function of the program in C: before, over and after the legs.

Every part is written once.  Before and after the legs it is a loop over `w` states that stand
side by side; over the legs it is a loop over items: the legs of one state, or one leg of
several states.
"""

from __future__ import annotations

from collections.abc import Iterable

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_text import (
    PRINTER,
    WIDTH,
    CPrinter,
    Routine,
    c_name,
    comment,
    indented,
    statement,
    table,
    words_of,
)
from pne_sym.backends.describe import equation_titles
from pne_sym.backends.scalar import wrap
from pne_sym.program.ir import Assignment, Block, Check, Function, LegInput
from pne_sym.program.slices import columns, flat_places, is_full, slices, symbols

_SIZES = {"X": "NQ", "V": "NV", "A": "NV", "q": "NJ"}
_TROUBLES = ("unreachable", "singular")


def vector_name(vector: str) -> str:
    """Argument of an input vector; the displacements are told from the output q by their name."""
    return "joints" if vector == "q" else vector


def statements(
    assignments: Iterable[Assignment], titles: dict[str, str], printer: CPrinter
) -> list[str]:
    """Assignments, headed by the equations they belong to."""
    return headed(
        (
            (a.equation, statement(f"const real {c_name(str(a.target))} = {printer.text(a.expr)}"))
            for a in assignments
        ),
        titles,
    )


def headed(rows: Iterable[tuple[str, list[str]]], titles: dict[str, str]) -> list[str]:
    """Lines with the equations they belong to, under these."""
    lines: list[str] = []
    known = ""
    for equation, own in rows:
        if equation != known:
            known, title = equation, titles.get(equation, "")
            lines += comment(f"({equation}) {title}" if title else f"{equation}: named entries")
        lines += own
    return lines


class Parts:
    """The parts of one function, as routines."""

    def __init__(self, bundle: Bundle, function: Function) -> None:
        self.bundle = bundle
        self.f = function
        self.name = function.name
        self.printer = PRINTER
        self.titles = equation_titles(bundle.derivation)
        self.slices = slices(function)
        self.first, self.legs, self.last = (
            self.slices.before,
            self.slices.legs,
            self.slices.after,
        )
        self.passed, self.sums = self.slices.passed, self.slices.sums
        self.made = self.slices.made

    def passed_fields(self) -> list[str]:
        """Names of what the later parts need."""
        return [c_name(n) for n in self.passed]

    def columns(self, array: str) -> int:
        """Length of a row of an output array."""
        return columns(self.bundle.program.shapes[array])

    def is_full(self, array: str) -> bool:
        """Whether every entry of an array is stored."""
        return is_full(self.f, array, self.bundle.program.shapes[array], self.bundle.leg_counts)

    # ---- before and after the legs ---------------------------------------------------------

    def before(self) -> Routine:
        """Names the inputs, computes what the legs share."""
        reads = self.slices.reads_before
        lines = []
        for vector in self.f.inputs:
            size = self.bundle.coordinates.sizes[_SIZES[vector]]
            lines += [
                f"const real {vector}_{e} = {vector_name(vector)}[{e}*w + k];"
                for e in range(size)
                if f"{vector}_{e}" in reads
            ]
        lines += self._prepared(self.f.shared, reads)
        lines += statements(self.f.unpack, self.titles, self.printer)
        checks = list(self.f.unpack_checks)
        if self.first:
            lines += statements(self.first.assignments, self.titles, self.printer)
            checks += self.first.checks
        lines += [f"s->{c_name(n)}[k] = {c_name(n)};" for n in self.passed]
        lines += self._stores(self.first)
        lines += _flags(checks, self.printer, "t", "+=")
        return self._routine("before", f"{self.name}_values *s", lines)

    def after(self) -> Routine:
        """Computes what needs the sums over the legs."""
        assert self.last is not None
        reads = symbols(self.last)
        lines = self._passed(reads, "k")
        lines += [
            f"const real {c_name(n)} = s->sum[{at}][k];"
            for at, n in enumerate(self.sums)
            if n in reads
        ]
        lines += self._prepared(self.f.shared, reads)
        lines += statements(self.last.assignments, self.titles, self.printer)
        lines += self._stores(self.last)
        lines += _flags(self.last.checks, self.printer, "t", "+=")
        return self._routine("after", f"const {self.name}_values *s", lines)

    def _routine(self, part: str, values: str, lines: list[str]) -> Routine:
        """A loop over the states around the lines."""
        parameters = [
            "const prepared *m",
            "size_t w",
            *(f"const real *{vector_name(v)}" for v in self.f.inputs),
            values,
            *(f"real *{a}" for a in self.f.arrays),
            "verdict *t",
        ]
        return Routine.of(f"{self.name}_{part}", parameters, _loop("w", lines))

    def _passed(self, reads: set[str], index: str) -> list[str]:
        return [
            f"const real {c_name(n)} = s->{c_name(n)}[{index}];" for n in self.passed if n in reads
        ]

    def _prepared(self, names: Iterable[str], reads: set[str], index: str = "") -> list[str]:
        """The prepared values that are read; names made by the function itself are its own."""
        wanted = [n for n in names if n in reads and n not in self.made]
        return [f"const real {c_name(n)} = m->{c_name(n)}{index};" for n in wanted]

    def _stores(self, block: Block | None) -> list[str]:
        """Entries of the output arrays."""
        rows = []
        for store in block.stores if block else ():
            place = flat_places(store, self.columns(store.array), 1)[0]
            value = self.printer.text(store.value)
            rows.append((store.equation, statement(f"{store.array}[{place}*w + k] = {value}")))
        return headed(rows, self.titles)

    # ---- over the legs -----------------------------------------------------------------------

    def over(self, block: Block) -> Routine:
        """Computes one leg, for the legs of one state or for several states."""
        leg, reads = block.leg_type, symbols(block)
        tables: list[str] = []
        lines = self._passed(reads, "j")
        lines += self._prepared(self.f.shared, reads)
        lines += self._prepared(self.f.per_leg.get(leg, ()), reads, "[i]")
        lines += [
            self._leg_input(item, tables)
            for item in self.f.leg_inputs.get(leg, ())
            if item.symbol.name in reads
        ]
        lines += statements(block.assignments, self.titles, self.printer)
        rows = []
        for n, (target, value) in enumerate(block.sums):
            term, place = self.printer.text(value), f"o->sum[{n}][k]"
            text = f"{place} = add ? {place} + {term} : {term};  /* {target} */"
            rows.append((block.sum_equations[n], [text]))
        for n, store in enumerate(block.stores):
            text = f"o->entry[{n}][k] = {self.printer.text(store.value)};"
            rows.append((store.equation, [text]))
        lines += headed(rows, self.titles)
        lines += _flags(block.checks, self.printer, "o", "=")
        words = words_of(lines)
        lines = [
            h
            for n, h in (
                ("i", "const size_t i = leg + legs*k;"),
                ("j", "const size_t j = states*k;"),
            )
            if n in words
        ] + lines
        parameters = [
            "const prepared *m",
            "size_t w",
            "size_t leg",
            "size_t legs",
            f"const {self.name}_values *s",
            "size_t states",
            "size_t count",
            "int add",
            *(f"const real *{vector_name(v)}" for v in self.f.inputs),
            f"{self.name}_results_{leg} *o",
        ]
        return Routine.of(f"{self.name}_legs_{leg}", parameters, [*tables, *_loop("count", lines)])

    def _leg_input(self, item: LegInput, tables: list[str]) -> str:
        place = _place_text(item.indices, "i", f"place_{item.symbol.name}", tables)
        value = f"{vector_name(item.vector)}[({place})*w + j]"
        return f"const real {c_name(item.symbol.name)} = {value};"

    def place(self, block: Block) -> Routine:
        """Puts the entries of a leg where they belong in the output arrays."""
        leg, lines = block.leg_type, []
        tables: list[str] = []
        for n, store in enumerate(block.stores):
            flat = flat_places(store, self.columns(store.array), self.bundle.leg_counts[leg])
            place = _place_text(flat, "leg", f"place_{n}", tables)
            lines.append(f"{store.array}[({place})*w + k] = o->entry[{n}][first + k];")
        lines += [
            f"t->{flag}[k] += o->{flag}[first + k];"
            for flag in _TROUBLES
            if any(c.trouble == flag for c in block.checks)
        ]
        parameters = [
            "size_t w",
            f"const {self.name}_results_{leg} *o",
            "size_t leg",
            "size_t first",
            *(f"real *{a}" for a in self.f.arrays),
            "verdict *t",
        ]
        return Routine.of(f"{self.name}_place_{leg}", parameters, [*tables, *_loop("w", lines)])

    def results(self, block: Block, width: int) -> list[str]:
        """Fields of the structure of what the legs of a type give."""
        fields = [f"sum[{len(block.sums)}][{width}]"] if block.sums else []
        fields += [f"entry[{len(block.stores)}][{width}]"] if block.stores else []
        fields += [
            f"{flag}[{width}]" for flag in _TROUBLES if any(c.trouble == flag for c in block.checks)
        ]
        return fields or [f"none[{width}]"]


def _loop(count: str, lines: list[str]) -> list[str]:
    """The lines for every k."""
    if not lines:
        return []
    return [f"for (size_t k = 0; k < {count}; ++k) {{", *indented(lines), "}"]


def _place_text(places: tuple[int, ...], index: str, name: str, tables: list[str]) -> str:
    """Index text of the place of a leg; a table is declared where one is needed."""
    even = table(places, index)
    if even is not None:
        return even
    text = f"static const size_t {name}[] = {{{', '.join(map(str, places))}}};"
    tables += wrap(text, WIDTH - 8, "    ")
    return f"{name}[{index}]"


def _flags(checks: Iterable[Check], printer: CPrinter, target: str, operator: str) -> list[str]:
    """Flags of impossible states: 1 where a condition fails or is not a number."""
    parts: dict[str, list[str]] = {}
    for check in checks:
        value = printer.text(check.value)
        if check.trouble == "singular":
            tolerance = "TOLERANCE*TOLERANCE" if check.power == 2 else "TOLERANCE"
            condition = f"magnitude({value}) > {tolerance}*{printer.text(check.scale)}"
        elif check.trouble == "invalid":
            # apart, as loops with conditions on conditions do not run in lanes
            parts.setdefault("invalid", []).append(f"is_finite({value})")
            condition = f"{value} > 0"
        else:
            condition = f"{value} >= 0"
        parts.setdefault(str(check.trouble), []).append(condition)
    lines = []
    for trouble, conditions in parts.items():
        text = " + ".join(f"UNLESS({c})" for c in dict.fromkeys(conditions))
        lines += statement(f"{target}->{trouble}[k] {operator} {text}")
    return lines
