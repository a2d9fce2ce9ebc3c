"""The parts of a function of the program in C: before, over and after the legs.

What precedes the legs is in two parts, of which the second, "between", is met by their sums alone.
Every part is written once.  All but those over the legs are for state k of `w` states that stand
side by side; over the legs it is for item k of `count`: of the legs of one state, or of several
states of one leg.  Arrays have their items side by side: what passes from part to part, s[n*w + k];
the sums over the legs, sums[n*w + k]; what a leg gives, terms[n*count + k] and o[n*count + k].
"""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_halves import Half, halves
from pne_sym.backends.c_sizes import array_names, times
from pne_sym.backends.c_stage_texts import stage_routine
from pne_sym.backends.c_stages import Shared, Stages
from pne_sym.backends.c_statements import (
    entries,
    factor,
    headed,
    loaded,
    place_text,
    statements,
    vector_name,
)
from pne_sym.backends.c_text import (
    Routine,
    c_name,
    in_pairs,
    statement,
)
from pne_sym.program.ir import Block, Check, Function, Store
from pne_sym.program.slices import is_full, places_of, read_by, slices

STATUSES = ("unreachable", "singular")


class Parts:
    """The parts of one function, as routines; `summed`: with the sum of all that it gives."""

    def __init__(self, bundle: Bundle, function: Function, stages: Stages, *, summed: bool) -> None:
        self.bundle, self.stages = bundle, stages
        self.f = function
        self.summed = summed
        self.name = function.name
        self.slices = own = slices(function)
        self.first, self.legs, self.last = own.before, own.legs, own.after
        self.passed, self.sums = stages.passed(function.name), stages.sums(function.name)
        self.made = own.made
        self.least = least_values(bundle)
        self.known = stages.known(function.name)
        self.first_checks = [*function.unpack_checks, *(self.first.checks if self.first else ())]
        stores = self.first.stores if self.first else ()
        self.early, self.late = halves(self.slices, stages, read_by((*self.first_checks, *stores)))

    def place_of(
        self, store: Store, index: str, name: str, tables: list[str], legs: int = 1
    ) -> str:
        """Where an entry stands in its array: the row by the length of rows, and the column."""
        names = array_names(self.bundle, store.array)
        rows, across = zip(*places_of(store, legs), strict=True)
        column = place_text(across, index, f"{name}_column", tables)
        row = place_text(rows, index, name, tables)
        if len(names) < 2:
            return row
        start = times(row, names[1])
        return column if start == "0" else start if column == "0" else f"{start} + {column}"

    def is_full(self, array: str) -> bool:
        """Whether every entry of an array is stored."""
        return is_full(self.f, array, self.bundle.program.shapes[array], self.bundle.leg_counts)

    # ---- before and after the legs ---------------------------------------------------------

    def before(self) -> Routine:
        """Names the inputs, computes what the legs need, and what is looked at before them."""
        return self._half("before", self.early)

    def between(self) -> Routine:
        """Computes what is needed only with the sums over the legs.

        Apart, as what the legs of one state wait for is to be under way first.
        """
        return self._half("between", self.late)

    def _half(self, part: str, half: Half) -> Routine:
        loads, members = entries(self.bundle, self.f, "k"), self.stages.members(self.name, "")
        shared = Shared(members, "v->", self.prepared(self.f.shared), self.known)
        lines = [stage_routine(self.bundle, self.stages, s).call() for s in half.stages]
        lines += statements(half.own, shared, loads)
        for n in half.stored:
            lines += loaded(loads, sp.Symbol(n))
            lines.append(f"s[{self.passed.index(n)}*w + k] = {shared.text(sp.Symbol(n))};")
        if half is self.early:
            lines += self._ends(self.first, self.first_checks, loads, shared)
        return self._routine(part, ("values *v", "real *s"), lines)

    def after(
        self, blocks: Iterable[Block], lines: Iterable[str] = (), first: tuple[int, int] = (0, 0)
    ) -> Routine:
        """Computes what needs the sums over the legs.

        Args:
            blocks: what is computed, and what that gives.
            lines: that stand before it.
            first: places in s and in sums from which these are counted.
        """
        loads = self.passed_at("k", first[0])
        loads |= {n: f"sums[{at}*w + k]" for at, n in enumerate(self.sums[first[1] :])}
        shared = Shared(places=self.prepared(self.f.shared), known=self.known)
        body = [*lines]
        for block in blocks:
            body += statements(block.assignments, shared, loads)
            body += self._ends(block, block.checks, loads, shared)
        return self._routine("after", ("const real *s", "const real *sums"), body)

    def _routine(self, part: str, values: tuple[str, ...], lines: list[str]) -> Routine:
        """The lines as a routine of state k."""
        parameters = [
            "const prepared *m",
            "size_t w",
            "size_t k",
            *(f"const real *{vector_name(v)}" for v in self.f.inputs),
            *values,
            *(f"real *{a}" for a in self.f.arrays),
            "status_flags *t",
        ]
        return Routine.of(f"{self.name}_{part}", parameters, lines)

    def passed_at(self, index: str, first: int = 0) -> dict[str, str]:
        """What was made before the legs, for the state with this index, from the first place on."""
        return {n: f"s[{at}*w + {index}]" for at, n in enumerate(self.passed[first:])}

    def prepared(self, names: Iterable[str], index: str = "") -> dict[str, str]:
        """The prepared values; names made by the function itself are its own."""
        return {n: f"m->{c_name(n)}{index}" for n in names if n not in self.made}

    def _ends(
        self, block: Block | None, checks: Iterable[Check], loads: dict[str, str], shared: Shared
    ) -> list[str]:
        """Entries of the output arrays, and flags."""
        rows = []
        for store in block.stores if block else ():
            place = self.place_of(store, "", "", [])
            value = shared.text(store.value)
            text = statement(f"{store.array}[{factor(place)}*w + k] = {value}")
            rows.append((store.equation, [*loaded(loads, store.value), *text]))
        lines = headed(rows)
        if self.summed and block and block.stores:
            lines += statement(f"t->total[k] += {self.summed_up(block, shared)}")
        return lines + self.flags(checks, "t->{}[k] +=", loads, shared)

    def summed_up(self, block: Block, shared: Shared) -> str:
        """The sum of the different values that a block stores."""
        values = [s.value for s in block.stores]
        different = dict.fromkeys(-v if v.could_extract_minus_sign() else v for v in values)
        return in_pairs([shared.text(v) for v in different if not v.is_Number] or ["0"])

    def flag_rows(self, block: Block) -> dict[str, int]:
        """Where the flags of a leg, and the sum of its entries, stand behind these."""
        flags = [f for f in STATUSES if any(c.status == f for c in block.checks)]
        flags += ["total"] * bool(self.summed and block.stores)
        return {flag: len(block.stores) + n for n, flag in enumerate(flags)}

    def flags(
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
            for status, condition in self._conditions(check, shared):
                parts.setdefault(status, []).append(condition)
        for status, conditions in parts.items():
            text = " + ".join(f"UNLESS({c})" for c in dict.fromkeys(conditions))
            target = targets.format(status) if isinstance(targets, str) else targets[status]
            lines += statement(f"{target} {text}")
        return lines

    def _conditions(self, check: Check, shared: Shared) -> list[tuple[str, str]]:
        """What must hold, each with the status that it is where it does not."""
        value, status = shared.text(check.value), str(check.status)
        if status == "singular":
            text = _least(check, shared)
            return [(status, f"magnitude({value}) > {self.least.get(text, text)}")]
        if status == "invalid":
            # apart, as loops with conditions on conditions do not run in lanes
            return [(status, f"is_finite({value})"), (status, f"{value} > 0")]
        return [(status, f"{value} >= 0")]


def _least(check: Check, shared: Shared) -> str:
    """What a value must be larger than."""
    tolerance = "TOLERANCE*TOLERANCE" if check.power == 2 else "TOLERANCE"
    return f"{tolerance}*{shared.text(check.scale)}"


def least_values(bundle: Bundle) -> dict[str, str]:
    """What values must be larger than, where that is known: text -> name, the same everywhere."""
    checks = [c for f in bundle.program.functions.values() for b in f.blocks for c in b.checks]
    fixed = [c for c in checks if c.status == "singular" and c.scale.is_Number]
    texts = dict.fromkeys(_least(check, Shared()) for check in fixed)
    return {text: f"LEAST_{k}" for k, text in enumerate(texts, 1)}
