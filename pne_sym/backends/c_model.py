"""Parameters and prepared model in C: structures, defaults, checks, preparation."""

from __future__ import annotations

import math

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_sizes import count_of, times
from pne_sym.backends.c_stages import Shared
from pne_sym.backends.c_statements import capacity, statements
from pne_sym.backends.c_sums import common_sums
from pne_sym.backends.c_text import (
    c_name,
    comment,
    indented,
    listing,
    statement,
    words_of,
)
from pne_sym.backends.describe import field_views
from pne_sym.derivation import ParameterField, Rule
from pne_sym.program.ir import Block, Store
from pne_sym.program.slices import symbols


def parameter_fields(bundle: Bundle) -> list[str]:
    """Members of the structure of parameters, each with its meaning and unit."""
    lines = []
    for f in field_views(bundle):
        lines += comment(f"{f.meaning} [{f.unit}]")
        dimensions = "".join(f"[{n}]" for n in f.shape)
        lines.append(f"{bundle.name}_real {f.name}{dimensions};")
    return lines


def default_values(bundle: Bundle) -> list[str]:
    """Initialisers of the default parameters, one line per leg."""
    lines = []
    for f in field_views(bundle):
        if not f.per_leg:
            lines.append(f"{_literal(f.rows[0])},  /* {f.name} */")
            continue
        lines += [f"{{  /* {f.name} */", *(f"    {_literal(row)}," for row in f.rows), "},"]
    return lines


def _literal(row: str) -> str:
    """A nested list of numbers in Python as an initialiser of the real type."""
    text = row.replace("[", "{").replace("]", "}")
    parts = text.replace("{", "{ ").replace("}", " }").replace(",", " ,").split()
    return "".join(p if p in "{}" else f"{p} " if p == "," else number(p) for p in parts)


def number(text: str) -> str:
    """A number in Python as a constant of the real type; zero and one are that in any type."""
    return {"0.0": "0", "1.0": "1"}.get(text, f"R({text})")


def model_fields(bundle: Bundle) -> list[str]:
    """Members of the prepared model: arrays over the legs of a type, then shared values.

    The arrays come first, so that vectors in them lie as evenly in memory as the model does.
    """
    real, program = f"{bundle.name}_real", bundle.program
    lines = []
    for leg, count in bundle.leg_counts.items():
        own = [f"{c_name(n)}[{capacity(count)}]" for n, of in program.prepared if of == leg]
        copies = "; copies of the first fill up" * (capacity(count) > count)
        if own:
            lines += comment(f"{count} legs of type {leg}{copies}")
            lines += listing(f"{real} ", own, ";", "        ")
    shared = [c_name(n) for n, leg in program.prepared if not leg]
    lines += listing(f"{real} ", shared, ";", "        ") if shared else []
    return lines or [f"{real} none;"]


# ---- preparation --------------------------------------------------------------------------


class _Kept(Shared):
    """Prints assignments of what is kept in the model where it is computed."""

    def __init__(self) -> None:
        super().__init__()
        self.kept, self.leg = set[str](), False

    def keep(self, block: Block, *, leg: bool) -> None:
        """Keep what the block stores under its own name."""
        self.leg = leg
        self.kept |= {s.array for s in block.stores if _is_own(s)}

    def assigned(self, name: str, value: str) -> str:
        """A value given to its name, and to the model where it is kept."""
        if name not in self.kept:
            return super().assigned(name, value)
        self.kept.remove(name)
        return f"KEEP{'_OF_LEG' * self.leg}({c_name(name)}, {value})"


def _is_own(store: Store) -> bool:
    return str(store.value) == store.array


class _Preparation:
    def __init__(self, bundle: Bundle) -> None:
        self.bundle = bundle
        self.blocks = common_sums(bundle.program.prepare)
        self.printer = _Kept()

    def body(self) -> list[str]:
        """Statements that compute the prepared model from the parameters."""
        lines: list[str] = []
        totals = [str(s.target) for block in self.blocks for s in block.sums]
        lines += [f"real {c_name(n)} = 0;" for n in dict.fromkeys(totals)]
        for block in self.blocks:
            if not block.leg_type:
                self.printer.keep(block, leg=False)
        lines += self._parameters(set[str]().union(*map(symbols, self.blocks)), None)
        once = self.printer.kept
        for block in self.blocks:
            self.printer.kept = set() if block.leg_type else once
            lines += self._legs(block) if block.leg_type else self._once(block)
        return lines

    def _once(self, block: Block) -> list[str]:
        self.printer.leg = False
        return [*statements(block.assignments, self.printer), *self._stored(block)]

    def _legs(self, block: Block) -> list[str]:
        leg = block.leg_type
        self.printer.keep(block, leg=True)
        inner = self._parameters(symbols(block), leg)
        inner += [*statements(block.assignments, self.printer), *self._stored(block)]
        count, legs = self.bundle.leg_counts[leg], count_of(leg)
        filled = capacity(count) > count
        sums: list[str] = []
        for s in block.sums:
            sums += statement(f"{c_name(str(s.target))} += {self.printer.text(s.expr)}")
        inner += [f"if (leg < {legs}) {{", *indented(sums), "}"] if filled and sums else sums
        if "own" in words_of(inner):
            own = f"leg < {legs} ? leg : 0" if filled else "leg"
            inner.insert(0, f"const size_t own = {own};")
        every = f"FILLED({legs})" if filled else legs
        return [f"for (size_t leg = 0; leg < {every}; ++leg) {{", *indented(inner), "}"]

    def _stored(self, block: Block) -> list[str]:
        """What is kept and not yet in the model."""
        lines: list[str] = []
        for s in block.stores:
            if s.array in self.printer.kept or not _is_own(s):
                place = f"model->{c_name(s.array)}{'[leg]' * bool(block.leg_type)}"
                lines += statement(f"{place} = {self.printer.text(s.value)}")
        return lines

    def _parameters(self, used: set[str], leg: str | None) -> list[str]:
        """The entries of the parameters, and the signs of the branches, that are used."""
        table, lines = self.bundle.derivation.parameters, list[str]()
        for name, (parameter, index) in table.entries.items():
            if name in used and parameter.leg_type == leg:
                lines += statement(self.printer.assigned(name, _entry(parameter, index)))
        for name, (leg_type, signs) in table.branches.items():
            if name in used and leg_type == leg:
                values = ", ".join(map(str, signs))
                lines.append(f"static const signed char signs_{name}[] = {{{values}}};")
                lines += statement(self.printer.assigned(name, f"signs_{name}[own]"))
        return lines


def _entry(parameter: ParameterField, index: int) -> str:
    """Where an entry of a parameter stands."""
    at = parameter.name + ("[own]" if parameter.leg_type else "")
    if len(parameter.shape) == 2:
        row, column = divmod(index, parameter.shape[1])
        return f"params->{at}[{row}][{column}]"
    return f"params->{at}[{index}]" if parameter.shape else f"params->{at}"


def prepare_body(bundle: Bundle) -> list[str]:
    """Statements that compute the prepared model from the parameters."""
    return _Preparation(bundle).body()


# ---- checks ---------------------------------------------------------------------------------


_CHECKS: dict[Rule, tuple[str, ...]] = {
    Rule.FREE: (),
    Rule.MASS: ("none_negative",),
    Rule.POSITIVE: ("all_positive",),
    Rule.NONZERO: ("none_zero",),
    Rule.UNIT: ("all_unit",),
    Rule.INERTIA: ("all_inertias",),
    Rule.PLANAR_INERTIA: ("all_planar_inertias",),
    Rule.ROTATION: ("all_rotations",),
    Rule.PLANAR_ROTATION: ("all_rotations", "all_about_z"),
    Rule.INVERTIBLE: (),
}
"""What a parameter must be -> functions that check it."""


def parameter_checks(bundle: Bundle) -> list[str]:
    """Conditions that the parameters must satisfy, one per line."""
    lines = []
    for f in field_views(bundle):
        first = "&p->" + f.name + "[0]" * len(f.shape)
        count, size = count_of(f.leg_type) if f.leg_type else "1", math.prod(f.core)
        lines.append(f"ok &= all_within({first}, {times(count, size)});")
        lines += [f"ok &= all_zero({first} + {k}, {count}, {size});" for k in f.zeros]
        lines += [f"ok &= {check}({first}, {count});" for check in _CHECKS[f.rule]]
        if f.rule is Rule.INVERTIBLE:
            lines.append(f"real work[{size}];")
            lines.append(f"ok &= is_invertible({first}, {f.shape[0]}, work);")
    for n, relation in enumerate(bundle.derivation.parameters.relations):
        count, other, step = count_of(relation.leg_type), f"fixed_{n}", 0
        if isinstance(relation.second, str):
            other, step = f"&p->{relation.second}[0][0]", 3
        else:
            values = ", ".join(map(str, relation.second))
            lines.append(f"static const real fixed_{n}[] = {{{values}}};")
        first = f"&p->{relation.first}[0][0]"
        lines.append(f"ok &= all_at_angle({first}, {other}, {step}, {count}, {relation.cosine});")
    return lines
