"""A comparison in sections, for the terminal: what was done, then what it means.

First the specification, then equations, values, effects; rewritings and counts come last.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from pne_sym.review.difference import (
    BlockDifference,
    Change,
    Comparison,
    Contradiction,
    EquationDifference,
    Gap,
    Verdict,
)
from pne_sym.review.edit_words import FOLLOWING
from pne_sym.review.effect_text import effect_lines
from pne_sym.review.interface_text import before_after, interface_lines, listed, shortened

_SHOWN = 6
_LISTED = 60
"""Equations of a kind shown with their formulas; further ones are listed by id."""
_EDITS = 12
_SAME = (Verdict.IDENTICAL, Verdict.EQUAL)


@dataclass(frozen=True)
class Section:
    """A part of the answer.

    Attributes:
        title: what it is about.
        lines: those that begin with - and + are before and after.
        detail: of second rank: folded where that is possible.
    """

    title: str
    lines: tuple[str, ...]
    detail: bool = False


def as_json(found: Comparison) -> str:
    """Plain data as JSON."""
    return json.dumps(found.to_dict(), indent=1, ensure_ascii=False)


def as_text(found: Comparison) -> Iterator[str]:
    """Lines of plain text."""
    yield f"--- {found.before}"
    yield f"+++ {found.after}"
    yield from in_full(verdict(found), measured(found), sections(found), found.notes)


def in_full(
    headline: str, measured: str, sections: Iterable[Section], notes: Iterable[str]
) -> Iterator[str]:
    """Lines of plain text on one model."""
    yield headline
    yield from (measured,) if measured else ()
    for section in sections:
        yield from ("", section.title, *section.lines)
    yield from (f"note: {note}" for note in notes)


def sections(found: Comparison) -> list[Section]:
    """All that is told below the verdict, in the order in which people ask."""
    made = [
        Section("specification", tuple(_edits(found))),
        Section("files", tuple(_files(found))),
        Section("not what this pne-gen prints from the manifest's specification",
                tuple(_deviations(found))),
        Section("structure", tuple(_structure(found))),
        Section("values, at equal parameters", tuple(_values(found))),
        Section("interface", tuple(interface_lines(_told_elsewhere(found)))),
        Section("effect, each version at its own defaults", tuple(effect_lines(found.effects))),
        Section("rewritings and counts", tuple(_details(found)), detail=True),
    ]  # fmt: skip
    return [section for section in made if section.lines]


# ---- the answer in one line -----------------------------------------------------------------


def verdict(found: Comparison) -> str:
    """What was done, in one line; where that is not known, what is different and where first."""
    if found.equal:
        verdicts = {b.verdict for b in found.blocks} | {e.verdict for e in found.equations}
        same = verdicts <= {Verdict.IDENTICAL} and not found.files
        if found.specification:
            return f"equal: {_cause(found)}; the same values"
        return "equal: identical text" if same else "equal: different text, the same values"
    return f"different: {_cause(found)}"


def _cause(found: Comparison) -> str:
    if found.specification:
        own = [e.words for e in found.specification if not e.path.startswith(FOLLOWING)]
        first, *others = own or [e.words for e in found.specification]
        return first + (
            f", and {len(others)} other edit{'s' * (len(others) > 1)}" if others else ""
        )
    if found.not_compared:
        place = next((f"{d.path} {d.where}" for d in found.deviations if d.path), "")
        return "not all is compared" + (f"; first at {place}" if place else "")
    if found.structure:
        e = found.structure[0]
        return f"the derivation, first at {e.id}, {e.title}"
    if (s := next(iter(found.contradictions), found.statement)) is not None:
        line = f", {s.line}" if isinstance(s, Contradiction) and s.line else ""
        return f"the lowering, first at {s.equation} ({s.target}) in {s.function}{line}"
    bad = [b for b in found.blocks if b.verdict not in _SAME]
    if bad:
        place = next((f"; first at {f.path} {f.where}" for f in found.files if not f.accounted), "")
        return f"{bad[0].name}: {bad[0].verdict}{place}"
    files = [f for f in found.files if not f.accounted]
    if files:
        return (
            "files differ whose text no comparison of values accounts for; "
            f"first at {files[0].path} {files[0].where}"
        )
    return "equal values at equal parameters, but the interface changed"


def measured(found: Comparison) -> str:
    """At how many places values were compared, and how closely."""
    sets, states = found.samples
    if found.not_compared:
        return f"values not compared: {found.not_compared}"
    if not found.blocks and found.identical_files:
        return f"{found.identical_files} files are equal to the byte; nothing was derived or run"
    if not sets:
        same = {b.verdict for b in found.blocks} == {Verdict.IDENTICAL}
        return "the text of all functions is the same, so are values" if same else ""
    return (
        f"values compared at {states} states of {sets} parameter sets, "
        f"tolerance {found.tolerance:g} relative"
    )


# ---- specification and files ------------------------------------------------------------------


def _edits(found: Comparison) -> Iterator[str]:
    edits = found.specification or ()
    for e in edits[:_EDITS]:
        yield f"  {e.words}  [{e.path}]"
        if "->" not in e.words and "moved from joint" not in e.words:
            yield from before_after(e.before, e.after)
    if len(edits) > _EDITS:
        yield from listed("and", (e.path for e in edits[_EDITS:]))


def _files(found: Comparison) -> Iterator[str]:
    """Files that differ; those that are our own text on both sides only with what differs."""
    ours = [f.path for f in found.files if f.accounted]
    if ours:
        yield from listed("printed by this pne-gen on both sides:", ours)
    for f in found.files:
        if not f.accounted:
            yield f"  {f.path}: differs, {f.where} (counts as different)"
            yield from before_after(f.before, f.after)
    if found.files:
        yield f"  {found.identical_files} others are equal to the byte"


def _deviations(found: Comparison) -> Iterator[str]:
    for d in found.deviations:
        yield f"  {d.version}: {d.path}{', ' if d.path else ''}{d.where}"
        if d.printed or d.found:
            yield f"    printed: {d.printed.strip()}"
            yield f"    found:   {d.found.strip()}"


# ---- equations --------------------------------------------------------------------------------

_KINDS = (
    ("changed", (Verdict.DIFFERENT, Verdict.CHANGED)),
    ("new", (Verdict.ADDED,)),
    ("gone", (Verdict.REMOVED,)),
)


def _structure(found: Comparison) -> Iterator[str]:
    """Equations that are changed, new, gone; then how many say the same."""
    if not found.equations:
        return
    for kind, verdicts in _KINDS:
        group = [e for e in found.equations if e.verdict in verdicts]
        if not group:
            continue
        yield f"  {kind}: {_counted(group)}, in order of derivation"
        yield from _equations(group)
    if found.statement is not None:
        s = found.statement
        yield (
            f"  the derivation is the same, {s.count} statements of the program are not; "
            f"first of ({s.equation}) in {s.function}"
        )
        yield from before_after(s.before, s.after)
    for c in found.contradictions:
        line = f", {c.line}" if c.line else ""
        yield f"  {c.version}: the code contradicts its derivation, first at ({c.equation})"
        yield f"    {c.target} in {c.function}{line}"
        yield f"    is {c.found:.6g}; by the derivation {c.means} is {c.expected:.6g}"
    yield f"  {_unchanged(found)}"


def _unchanged(found: Comparison) -> str:
    same = [e for e in found.equations if e.verdict not in {v for _, vs in _KINDS for v in vs}]
    if len(same) == len(found.equations) and {e.verdict for e in same} == {Verdict.IDENTICAL}:
        return f"no equation changed ({len(same)})"
    parts = [f"{len(same)} equations say the same"]
    counts = {v: sum(e.verdict is v for e in same) for v in (Verdict.FOLLOWS, Verdict.EQUAL)}
    if counts[Verdict.FOLLOWS]:
        parts.append(f"{counts[Verdict.FOLLOWS]} of them with values that follow from the above")
    if counts[Verdict.EQUAL]:
        parts.append(f"{counts[Verdict.EQUAL]} in other words")
    sums = sorted({n for e in same for n in e.note.split("; ") if n.startswith("a sum over")})
    return "; ".join([", ".join(parts), *sums])


def _counted(group: list[EquationDifference]) -> str:
    """How many, by leg type."""
    types = Counter(f"leg type {e.leg_type}" if e.leg_type else "platform" for e in group)
    return ", ".join(f"{n} of {t}" for t, n in types.items())


def _equations(group: list[EquationDifference]) -> Iterator[str]:
    """The first of them; of further ones their places, of so many that they can be read."""
    for e in group[:_SHOWN]:
        yield from _equation(e)
    rest = list(shortened(_place(e) for e in group[_SHOWN:]))
    if rest:
        more = [f"and {len(rest) - _LISTED} more"] if len(rest) > _LISTED else []
        yield from listed("and", [*rest[:_LISTED], *more])


def _place(e: EquationDifference) -> str:
    return f"{e.id} {e.name}" if e.id in ("given", "output", e.leg_type) else e.id


def _equation(e: EquationDifference) -> Iterator[str]:
    yield f"  ({_place(e)}) {e.title}"
    yield from before_after(e.before, e.after)
    told = _gap(e.gap) if e.gap else ""
    if e.gap and e.gap.size != float("inf"):
        told += f": {e.gap.before:.6g} -> {e.gap.after:.6g}"
    if told or e.note:
        yield f"    {'; '.join(filter(None, (told, e.note)))}"


# ---- values -----------------------------------------------------------------------------------


def _values(found: Comparison) -> Iterator[str]:
    """Functions that are not the same, one a line; the others in one."""
    bad = [b for b in found.blocks if b.verdict not in _SAME]
    width = max((len(b.name) for b in bad), default=0)
    for block in bad:
        yield f"  {block.name:<{width}}  {told(block)}"
    same = [b.name for b in found.blocks if b.verdict in _SAME]
    if same and not bad:
        yield f"  all {len(same)} functions: the same"
    elif same:
        yield from listed("the same:", same)


def told(block: BlockDifference) -> str:
    """How a function compares; where no values could differ, why it does not."""
    if block.verdict is Verdict.DIFFERENT and block.gap is None and block.note:
        return block.note
    gap = f"; {_gap(block.gap)}" if block.gap else ""
    return f"{block.verdict}{gap}" + (f"; {block.note}" if block.note else "")


def _gap(gap: Gap) -> str:
    if gap.size == float("inf"):
        says_it = gap.where.startswith(("shapes", "the conditions"))
        return gap.where if says_it else f"at {gap.where} only one has a finite value"
    return f"largest relative difference {gap.size:.2g} at {gap.where}"


def _told_elsewhere(found: Comparison) -> list[Change]:
    """Changes of the interface that the specification does not tell already."""
    if not found.specification:
        return list(found.interface)
    return [c for c in found.interface if not c.what.startswith("default of ") and c.what != "home"]


# ---- what is left -----------------------------------------------------------------------------


def _details(found: Comparison) -> Iterator[str]:
    rewritten = [e for e in found.equations if e.verdict is Verdict.EQUAL]
    if rewritten:
        yield f"  rewritten with equal values: {len(rewritten)} equations"
        yield from _equations(rewritten)
    kept = (Verdict.IDENTICAL, Verdict.FOLLOWS)
    renamed = [e for e in found.equations if "renamed:" in e.note and e.verdict in kept]
    for e in renamed[:_SHOWN]:
        yield f"  {e.id}: {e.note}"
    texts = [b.name for b in found.blocks if b.verdict is Verdict.EQUAL]
    if texts:
        yield from listed("functions of different text, equal values:", texts)
    if found.operations:
        yield "  operations (mul, add, div, sqrt, trig)"
    for o in found.operations:
        yield f"    {o.function}: {_counts(o.before)} -> {_counts(o.after)}"


def _counts(counts: tuple[int, ...]) -> str:
    return ", ".join(map(str, counts)) if any(counts) else "none"
