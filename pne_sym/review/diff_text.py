"""A comparison as text for the terminal and as Markdown for a pull request."""

from __future__ import annotations

import json
from collections.abc import Iterator

from pne_sym.review.difference import BlockDifference, Comparison, EquationDifference, Gap, Verdict

_SHOWN = 8
"""Equations shown with their formulas; further ones are listed by id."""
_LONG = 100


def as_json(found: Comparison) -> str:
    """Plain data as JSON."""
    return json.dumps(found.to_dict(), indent=1, ensure_ascii=False)


def as_text(found: Comparison) -> Iterator[str]:
    """Lines of plain text; those that begin with - and + are before and after."""
    yield f"--- {found.before}"
    yield f"+++ {found.after}"
    yield verdict(found)
    yield measured(found)
    yield from _files(found)
    if found.blocks:
        yield ""
        yield "blocks"
    width = max((len(b.name) for b in found.blocks), default=0)
    for block in found.blocks:
        yield f"  {block.name:<{width}}  {_told(block)}"
    if found.equations:
        yield ""
        yield from _summary(found)
    yield from _equations(found)
    if found.interface:
        yield ""
        yield "interface"
        for change in found.interface:
            yield f"  {change.kind}: {change.what}"
            yield from _before_after(change.before, change.after)
    if found.operations:
        yield ""
        yield "operations (mul, add, div, sqrt, trig)"
        for o in found.operations:
            yield f"  {o.function}: {_counts(o.before)} -> {_counts(o.after)}"
    for note in found.notes:
        yield f"note: {note}"


def verdict(found: Comparison) -> str:
    """The answer in one line."""
    if not found.equal:
        if found.not_compared:
            return "different: not all is compared"
        if found.origins:
            first = found.origins[0]
            return f"different: first at {first.id} ({first.name}), {first.title}"
        if any(b.verdict not in (Verdict.IDENTICAL, Verdict.EQUAL) for b in found.blocks):
            return "different"
        if any(not f.accounted for f in found.files):
            return "different: files differ whose text no comparison of values accounts for"
        return "different: equal values at equal parameters, but the interface changed"
    verdicts = {b.verdict for b in found.blocks} | {e.verdict for e in found.equations}
    same = verdicts <= {Verdict.IDENTICAL} and not found.files
    return "equal: identical text" if same else "equal: different text, the same values"


def measured(found: Comparison) -> str:
    """At how many places values were compared, and how closely."""
    sets, states = found.samples
    if found.not_compared:
        return f"values not compared: {found.not_compared}"
    if not sets and found.identical_files:
        return f"{found.identical_files} files are equal to the byte; nothing was derived or run"
    return (
        f"values compared at {states} states of {sets} parameter sets, "
        f"tolerance {found.tolerance:g} relative"
    )


def _files(found: Comparison) -> Iterator[str]:
    """Files that differ, then where folders are not what this pne-gen prints."""
    if found.files:
        yield ""
        yield f"files ({found.identical_files} others are equal to the byte)"
    for f in found.files:
        how = "printed by this pne-gen on both sides" if f.accounted else "counts as different"
        yield f"  {f.path}: differs, {f.where} ({how})"
        if not f.accounted:
            yield from _before_after(f.before, f.after)
    if found.deviations:
        yield ""
        yield "not what this pne-gen prints from the manifest's specification"
    for d in found.deviations:
        yield f"  {d.version}: {d.path}{', ' if d.path else ''}{d.where}"
        if d.printed or d.found:
            yield f"    printed: {d.printed.strip()}"
            yield f"    found:   {d.found.strip()}"


def _told(block: BlockDifference) -> str:
    gap = f"; {_gap(block.gap)}" if block.gap else ""
    return f"{block.verdict}{gap}" + (f"; {block.note}" if block.note else "")


def _gap(gap: Gap) -> str:
    if gap.size == float("inf"):
        return (
            gap.where
            if gap.where.startswith(("shapes", "the conditions"))
            else f"at {gap.where} only one has a value"
        )
    return f"largest relative difference {gap.size:.2g} at {gap.where}"


def _counts(counts: tuple[int, ...]) -> str:
    return ", ".join(map(str, counts))


def _summary(found: Comparison) -> Iterator[str]:
    """Per leg type and for the platform, how many equations compare how."""
    groups: dict[str, dict[Verdict, int]] = {}
    for e in found.equations:
        counts = groups.setdefault(f"leg type {e.leg_type}" if e.leg_type else "platform", {})
        counts[e.verdict] = counts.get(e.verdict, 0) + 1
    yield "equations"
    for group, counts in sorted(groups.items()):
        told = [f"{counts[v]} {_WORDS[v]}" for v in Verdict if v in counts]
        yield f"  {group}: {', '.join(told)}"


_WORDS = {
    Verdict.IDENTICAL: "identical",
    Verdict.EQUAL: "rewritten with equal values",
    Verdict.DIFFERENT: "different",
    Verdict.FOLLOWS: "changed by what they use only",
    Verdict.CHANGED: "of different text",
    Verdict.ADDED: "added",
    Verdict.REMOVED: "removed",
}


def _equations(found: Comparison) -> Iterator[str]:
    for kind in (Verdict.DIFFERENT, Verdict.CHANGED, Verdict.EQUAL, Verdict.ADDED, Verdict.REMOVED):
        group = [e for e in found.equations if e.verdict is kind]
        if not group:
            continue
        yield ""
        yield f"{_WORDS[kind]}, in order of derivation"
        for e in group[:_SHOWN]:
            yield from _equation(e)
        if len(group) > _SHOWN:
            yield "  and " + ", ".join(_place(e) for e in group[_SHOWN:])
    renamed = [
        e
        for e in found.equations
        if e.note.startswith("renamed") and e.verdict in (Verdict.IDENTICAL, Verdict.FOLLOWS)
    ]
    for e in renamed:
        yield f"  {e.id}: {e.note}"


def _place(e: EquationDifference) -> str:
    return e.id if any(c.isdigit() for c in e.id) else f"{e.id} {e.name}"


def _equation(e: EquationDifference) -> Iterator[str]:
    yield f"  ({_place(e)}) {e.title}"
    yield from _before_after(e.before, e.after)
    if e.gap:
        told = _gap(e.gap)
        if e.gap.size != float("inf"):
            told += f": {e.gap.before:.6g} -> {e.gap.after:.6g}"
        yield f"    {told}"
    if e.note:
        yield f"    {e.note}"


def _before_after(before: str, after: str) -> Iterator[str]:
    yield from (f"-   {line}" for line in before.split("\n") if line)
    yield from (f"+   {line}" for line in after.split("\n") if line)


def as_markdown(found: Comparison) -> Iterator[str]:
    """Markdown for a comment: the verdict, a table of blocks, details folded."""
    mark = "✅" if found.equal else "⚠️"
    yield f"### {mark} {_escaped(verdict(found))}"
    yield ""
    yield f"{_code(found.before)} → {_code(found.after)}: {_escaped(measured(found))}."
    yield ""
    files = list(_files(found))
    if files:
        yield from _folded("Files", files, is_open=True)
    if found.blocks:
        yield "| Block | Result |"
        yield "| --- | --- |"
    for block in found.blocks:
        yield f"| {_escaped(block.name)} | {_escaped(_told(block))} |"
    yield ""
    if found.equations:
        yield from (_escaped(line.strip()) + "  " for line in list(_summary(found))[1:])
    if found.interface:
        yield ""
        yield "**Interface**"
        yield ""
        for change in found.interface:
            texts = " → ".join(_code(t) for t in (change.before, change.after) if t)
            yield f"- {change.kind}: {_escaped(change.what)} {texts}"
    details = list(_equations(found))
    if details:
        yield from _folded("Equations", details)
    if found.operations:
        rows = [
            f"{o.function}: {_counts(o.before)} -> {_counts(o.after)}" for o in found.operations
        ]
        yield from _folded("Operations (mul, add, div, sqrt, trig)", rows)
    for note in found.notes:
        yield f"> {_escaped(note)}"


def _folded(title: str, lines: list[str], *, is_open: bool = False) -> Iterator[str]:
    fence = "`" * max(4, *(len(run) + 1 for line in lines for run in _ticks(line)))
    yield ""
    yield f"<details{' open' if is_open else ''}><summary>{title}</summary>"
    yield ""
    yield f"{fence}diff"
    yield from lines
    yield fence
    yield ""
    yield "</details>"
    yield ""


def _ticks(line: str) -> list[str]:
    """Runs of backticks in a line."""
    return "".join(c if c == "`" else " " for c in line).split() or [""]


def _code(text: str) -> str:
    """A text as code; long ones are cut."""
    text = " ".join(text.split()).replace("`", "'").replace("|", "/")
    return f"`{text[:_LONG]}{'...' if len(text) > _LONG else ''}`"


def _escaped(text: str) -> str:
    for mark in "\\`*_[]<>|#":
        text = text.replace(mark, f"&#{ord(mark)};" if mark in "<>|#" else f"\\{mark}")
    return text
