"""The parts of a function of the program in C: before, over and after the legs.

Every part is written once.  Before and after the legs it is a loop over `w` states that stand
side by side; over the legs it is a loop over items: the legs of one state, or one leg of
several states.  Arrays have their items side by side: what passes from part to part, s[n*w + k];
the sums over the legs, sums[n*w + k]; what a leg gives, terms[n*count + k] and o[n*count + k].
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

import sympy as sp

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_sizes import array_names, times
from pne_sym.backends.c_stages import Shared, Stage, Stages, aliases
from pne_sym.backends.c_text import (
    WIDTH,
    Routine,
    c_name,
    comment,
    in_pairs,
    indented,
    listing,
    statement,
    table,
    words_of,
)
from pne_sym.backends.describe import equation_titles
from pne_sym.backends.scalar import wrap
from pne_sym.program.ir import Assignment, Block, Check, Function, LegInput, Store
from pne_sym.program.slices import is_full, places_of, read_in, slices, symbols

_TROUBLES = ("unreachable", "singular")
_WORTH = 3


def vector_name(vector: str) -> str:
    """Argument of an input vector; the displacements are told from the output q by their name."""
    return "joints" if vector == "q" else vector


def statements(
    assignments: Iterable[Assignment],
    titles: dict[str, str],
    printer: Shared,
    loads: dict[str, str] | None = None,
) -> list[str]:
    """Assignments, headed by the equations they belong to; what they read is loaded before them.

    Args:
        assignments: in order.
        titles: of the equations.
        printer: of expressions.
        loads: where the names stand that are not yet at hand; those that are read are taken out.
    """
    waiting = {} if loads is None else loads
    rows = (
        (
            a.equation,
            [
                *loaded(waiting, a.expr),
                *statement(f"const real {c_name(a.target.name)} = {printer.text(a.expr)}"),
            ],
        )
        for a in assignments
    )
    return headed(rows, titles)


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


def loaded(loads: dict[str, str], *expressions: Any) -> list[str]:
    """Loads of what expressions read and is not yet at hand."""
    read = loads.keys() & set[str]().union(*(read_in(sp.sympify(e)) for e in expressions))
    return [f"const real {c_name(n)} = {loads.pop(n)};" for n in sorted(read)]


class Parts:
    """The parts of one function, as routines; `summed`: with the sum of all that it gives."""

    def __init__(self, bundle: Bundle, function: Function, stages: Stages, *, summed: bool) -> None:
        self.bundle, self.stages = bundle, stages
        self.f = function
        self.summed = summed
        self.name = function.name
        self.titles = equation_titles(bundle.derivation)
        self.slices = slices(function)
        self.first, self.legs, self.last = (
            self.slices.before,
            self.slices.legs,
            self.slices.after,
        )
        self.passed, self.sums = stages.passed(function.name), self.slices.sums
        self.made = self.slices.made
        self.least = least_values(bundle)

    def _place(self, store: Store, index: str, name: str, tables: list[str], legs: int = 1) -> str:
        """Where an entry stands in its array: the row by the length of rows, and the column."""
        names = array_names(self.bundle, store.array)
        rows, across = zip(*places_of(store, legs), strict=True)
        column = _place_text(across, index, f"{name}_column", tables)
        row = _place_text(rows, index, name, tables)
        if len(names) < 2:
            return row
        start = times(row, names[1])
        return column if start == "0" else start if column == "0" else f"{start} + {column}"

    def is_full(self, array: str) -> bool:
        """Whether every entry of an array is stored."""
        return is_full(self.f, array, self.bundle.program.shapes[array], self.bundle.leg_counts)

    # ---- before and after the legs ---------------------------------------------------------

    def before(self) -> Routine:
        """Names the inputs, computes what the legs share."""
        loads = entries(self.bundle, self.f, "k") | self._prepared(self.f.shared)
        shared = Shared(self.stages.members(self.name, ""), "v.")
        first = self.first.assignments if self.first else ()
        own = self.stages.own(self.name, (*self.f.unpack, *first))
        lines = self._run(self.stages.used(self.name, ""))
        lines += statements(own, self.titles, shared, loads)
        checks = [*self.f.unpack_checks, *(self.first.checks if self.first else ())]
        stored = self.stages.stored(self.name)
        for at, n in enumerate(self.passed):
            if n in stored:
                lines += loaded(loads, sp.Symbol(n))
                lines.append(f"s[{at}*w + k] = {shared.text(sp.Symbol(n))};")
        lines += self._ends(self.first, checks, loads, shared)
        return self._routine("before", ("real *s",), lines)

    def _run(self, stages: list[Stage]) -> list[str]:
        """Calls of stages, which leave what they compute in v."""
        if not stages:
            return []
        calls = [stage_routine(self.bundle, self.stages, s).call(v="&v") for s in stages]
        return [f"values{'_' * bool(stages[0].part)}{stages[0].part} v;", *calls]

    def after(self) -> Routine:
        """Computes what needs the sums over the legs."""
        assert self.last is not None
        loads = self._passed("k") | {n: f"sums[{at}*w + k]" for at, n in enumerate(self.sums)}
        loads |= self._prepared(self.f.shared)
        lines = statements(self.last.assignments, self.titles, Shared(), loads)
        lines += self._ends(self.last, self.last.checks, loads, Shared())
        return self._routine("after", ("const real *s", "const real *sums"), lines)

    def _routine(self, part: str, values: tuple[str, ...], lines: list[str]) -> Routine:
        """A loop over the states around the lines."""
        parameters = [
            "const prepared *m",
            "size_t w",
            *(f"const real *{vector_name(v)}" for v in self.f.inputs),
            *values,
            *(f"real *{a}" for a in self.f.arrays),
            "verdict *t",
        ]
        return Routine.of(f"{self.name}_{part}", parameters, _loop("w", lines))

    def _passed(self, index: str) -> dict[str, str]:
        return {n: f"s[{at}*w + {index}]" for at, n in enumerate(self.passed)}

    def _prepared(self, names: Iterable[str], index: str = "") -> dict[str, str]:
        """The prepared values; names made by the function itself are its own."""
        return {n: f"m->{c_name(n)}{index}" for n in names if n not in self.made}

    def _ends(
        self, block: Block | None, checks: Iterable[Check], loads: dict[str, str], shared: Shared
    ) -> list[str]:
        """Entries of the output arrays, and flags."""
        rows = []
        for store in block.stores if block else ():
            place = self._place(store, "", "", [])
            value = shared.text(store.value)
            text = statement(f"{store.array}[{_by(place)}*w + k] = {value}")
            rows.append((store.equation, [*loaded(loads, store.value), *text]))
        lines = headed(rows, self.titles)
        if self.summed and block and block.stores:
            lines += statement(f"t->total[k] += {self._summed(block, shared)}")
        return lines + self._flags(checks, "t->{}[k] +=", loads, shared)

    def _summed(self, block: Block, shared: Shared) -> str:
        """The sum of the different values that a block stores."""
        values = [sp.sympify(s.value) for s in block.stores]
        different = dict.fromkeys(-v if v.could_extract_minus_sign() else v for v in values)
        return in_pairs([shared.text(v) for v in different if not v.is_Number] or ["0"])

    # ---- over the legs -----------------------------------------------------------------------

    def over(self, block: Block) -> Routine:
        """Computes one leg, for the legs of one state or for several states."""
        leg = block.leg_type
        tables: list[str] = []
        shared = Shared(self.stages.members(self.name, leg), "v.")
        own = self.stages.own(self.name, block.assignments)
        reads = symbols(replace(block, assignments=tuple(own)))
        loads = self._passed("j") | entries(self.bundle, self.f, "j")
        loads |= self._prepared(self.f.shared)
        loads |= self._prepared(self.f.per_leg.get(leg, ()), "[i]")
        inputs = [i for i in self.f.leg_inputs.get(leg, ()) if i.symbol.name in reads]
        loads |= {i.symbol.name: leg_input(self.bundle, i, leg, tables) for i in inputs}
        lines = self._run(self.stages.used(self.name, leg))
        lines += statements(own, self.titles, shared, loads)
        lines += headed(self._of_leg(block, loads, shared), self.titles)
        rows = {f: f"o[{n}*count + k] =" for f, n in self.flag_rows(block).items()}
        if "total" in rows:
            lines += statement(f"{rows['total']} {self._summed(block, shared)}")
        lines += self._flags(block.checks, rows, loads, shared)
        words = words_of(lines)
        indices = {"i": "const size_t i = leg + legs*k;", "j": "const size_t j = states*k;"}
        lines = [line for n, line in indices.items() if n in words] + lines
        parameters = [
            "const prepared *m",
            "size_t w",
            "size_t leg",
            "size_t legs",
            "const real *s",
            "size_t states",
            "size_t count",
            "int add",
            *(f"const real *{vector_name(v)}" for v in self.f.inputs),
            "real *terms",
            "real *o",
        ]
        return Routine.of(f"{self.name}_legs_{leg}", parameters, [*tables, *_loop("count", lines)])

    def _of_leg(
        self, block: Block, loads: dict[str, str], shared: Shared
    ) -> Iterator[tuple[str, list[str]]]:
        """What a leg adds to the sums, and its entries, with their equations."""
        for (target, value), equation in zip(block.sums, block.sum_equations, strict=True):
            n = self.sums.index(str(target))
            term, place = shared.text(value), f"terms[{n}*count + k]"
            text = f"gather(&{place}, add, {term});  /* {target} */"
            yield equation, [*loaded(loads, value), text]
        for n, store in enumerate(block.stores):
            entry = statement(f"o[{n}*count + k] = {shared.text(store.value)}")
            yield store.equation, [*loaded(loads, store.value), *entry]

    def place(self, block: Block) -> Routine:
        """Puts the entries of a leg where they belong in the output arrays."""
        leg, lines = block.leg_type, []
        tables: list[str] = []
        for n, store in enumerate(block.stores):
            legs = self.bundle.leg_counts[leg]
            place = _by(self._place(store, "leg", f"place_{n}", tables, legs))
            lines.append(f"{store.array}[{place}*w + k] = o[{n}*count + first + k];")
        for flag, n in self.flag_rows(block).items():
            lines.append(f"t->{flag}[k] += o[{n}*count + first + k];")
        parameters = [
            "size_t w",
            "size_t count",
            "const real *o",
            "size_t leg",
            "size_t first",
            *(f"real *{a}" for a in self.f.arrays),
            "verdict *t",
        ]
        return Routine.of(f"{self.name}_place_{leg}", parameters, [*tables, *_loop("w", lines)])

    def flag_rows(self, block: Block) -> dict[str, int]:
        """Where the flags of a leg, and the sum of its entries, stand behind these."""
        flags = [f for f in _TROUBLES if any(c.trouble == f for c in block.checks)]
        flags += ["total"] * bool(self.summed and block.stores)
        return {flag: len(block.stores) + n for n, flag in enumerate(flags)}

    def _flags(
        self,
        checks: Iterable[Check],
        targets: str | dict[str, str],
        loads: dict[str, str],
        shared: Shared,
    ) -> list[str]:
        """Flags of impossible states: 1 where a condition fails or is not a number."""
        parts: dict[str, list[str]] = {}
        lines = []
        for check in checks:
            lines += loaded(loads, check.value, check.scale)
            for trouble, condition in self._conditions(check, shared):
                parts.setdefault(trouble, []).append(condition)
        for trouble, conditions in parts.items():
            text = " + ".join(f"UNLESS({c})" for c in dict.fromkeys(conditions))
            target = targets.format(trouble) if isinstance(targets, str) else targets[trouble]
            lines += statement(f"{target} {text}")
        return lines

    def _conditions(self, check: Check, shared: Shared) -> list[tuple[str, str]]:
        """What must hold, each with the trouble that it is where it does not."""
        value, trouble = shared.text(check.value), str(check.trouble)
        if trouble == "singular":
            text = _least(check, shared)
            return [(trouble, f"magnitude({value}) > {self.least.get(text, text)}")]
        if trouble == "invalid":
            # apart, as loops with conditions on conditions do not run in lanes
            return [(trouble, f"is_finite({value})"), (trouble, f"{value} > 0")]
        return [(trouble, f"{value} >= 0")]


def _least(check: Check, shared: Shared) -> str:
    """What a value must be larger than."""
    tolerance = "TOLERANCE*TOLERANCE" if check.power == 2 else "TOLERANCE"
    return f"{tolerance}*{shared.text(check.scale)}"


def least_values(bundle: Bundle) -> dict[str, str]:
    """What values must be larger than, where that is known: text -> name, the same everywhere."""
    checks = [c for f in bundle.program.functions.values() for b in f.blocks for c in b.checks]
    fixed = [c for c in checks if c.trouble == "singular" and sp.sympify(c.scale).is_Number]
    texts = dict.fromkeys(_least(check, Shared()) for check in fixed)
    return {text: f"LEAST_{k}" for k, text in enumerate(texts, 1)}


def leg_input(bundle: Bundle, item: LegInput, leg: str, tables: list[str]) -> str:
    """An entry of a vector that belongs to a leg."""
    places = item.indices
    if len(set(places)) > 1:
        copies = capacity(bundle.leg_counts[leg]) - len(places)
        places = (*places, *places[:1] * copies)
    place = _place_text(places, "i", f"place_{item.symbol.name}", tables)
    return f"{vector_name(item.vector)}[{_by(place)}*w + j]"


def entries(bundle: Bundle, function: Function, index: str) -> dict[str, str]:
    """Where entries of the input vectors stand, by name, and names that are entries."""
    found = {
        f"{vector}_{e}": f"{vector_name(vector)}[{e}*w + {index}]"
        for vector in function.inputs
        for e in range(bundle.coordinates.lengths[vector])
    }
    return found | {n: found[e] for n, e in aliases(function).items()}


def stage_routine(bundle: Bundle, stages: Stages, stage: Stage) -> Routine:
    """A stage as a routine, which leaves in v what others read."""
    tables: list[str] = []
    program, part = bundle.program, stage.part
    at = "j" if part else "k"
    own = stages.assignments(stage)
    made = {a.target.name for a in own}
    loads = {n: f"s[{k}*w + j]" for k, n in enumerate(stages.layout) if part}
    users = [p.function for p in stages.parts.values()]
    for function in users:
        loads = entries(bundle, function, at) | loads
        for item in function.leg_inputs.get(part, ()):
            name = item.symbol.name
            if name not in loads and any(item.symbol in a.expr.free_symbols for a in own):
                loads[name] = leg_input(bundle, item, part, tables)
    loads |= {
        n: f"m->{c_name(n)}{'[i]' * bool(of)}" for n, of in program.prepared if of in ("", part)
    }
    known = {n for other in stages.stages for n in other.exported if other.part == part} - made
    loads = {n: text for n, text in loads.items() if n not in made | known}
    titles = equation_titles(bundle.derivation)
    lines = statements(own, titles, Shared(known, "v->"), loads)
    lines += [f"v->{c_name(n)} = {c_name(n)};" for n in stage.exported]
    vectors = dict.fromkeys(v for f in users for v in f.inputs)
    parameters = [
        "const prepared *m",
        *(f"size_t {n}" for n in ("w", "i", at)),
        "const real *s",
        *(f"const real *{vector_name(v)}" for v in vectors),
        f"values{'_' * bool(part)}{part} *v",
    ]
    return Routine.of(stage.name, parameters, [*tables, *lines])


def stage_texts(bundle: Bundle, stages: Stages) -> list[str]:
    """The structures of shared values, and the routines of the stages."""
    texts = []
    for part in dict.fromkeys(s.part for s in stages.stages):
        own = [s for s in stages.stages if s.part == part]
        members = dict.fromkeys(c_name(n) for s in own for n in s.exported)
        lines = listing("real ", list(members), ";", "    ")
        name = f"values{'_' * bool(part)}{part};"
        texts.append("\n".join(["typedef struct {", *indented(lines), f"}} {name}"]))
        texts += ["\n".join(stage_routine(bundle, stages, s).definition()) for s in own]
    return texts


def capacity(legs: int) -> int:
    """Length of the model's arrays over legs: vectors of four entries, where these are worth it."""
    return legs if legs < _WORTH else -(-legs // 4) * 4


def _by(place: str) -> str:
    """A place as a factor."""
    return f"({place})" if " " in place else place


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
