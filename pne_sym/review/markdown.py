"""Comparisons as one Markdown comment: short first, details folded, a limit kept.

GitHub takes comments of 65,536 characters, of which some are left for what a workflow adds.
Where a comment would be longer, details go first, then whole sections, model by model from the
longest; what was left out is named.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from textwrap import shorten

from pne_sym.review.diff_text import Section, measured, sections, verdict
from pne_sym.review.difference import Comparison

LIMIT = 65_000
_RESERVE = 600
"""For the line that tells what is left out."""
_LEVELS = 4
_BY_CAUSE = ("structure", "interface")
"""Sections that the specification and the effect make up for."""
_FOLD = 12
"""Lines of a section that are shown without folding."""


@dataclass(frozen=True)
class Part:
    """What is told of one model.

    Attributes:
        name: of the model.
        headline: one line, plain text.
        is_equal: nothing else is told.
        versions: what was compared.
        measured: how closely, in a line.
        notes: what limits the comparison.
        sections: what is told, the last first to be left out.
        level: how much is told: 0 all, 1 without details, 2 without equations and interface
            either, 3 specification alone, 4 the headline.
    """

    name: str
    headline: str
    is_equal: bool = False
    versions: tuple[str, str] | None = None
    measured: str = ""
    notes: tuple[str, ...] = ()
    sections: tuple[Section, ...] = ()
    level: int = 0


def as_markdown(found: Comparison) -> Iterator[str]:
    """Markdown of one comparison."""
    mark = "✅" if found.equal else "⚠️"
    part = part_of("", found)
    parts = _within([replace(part, is_equal=False)], LIMIT - _RESERVE)
    yield f"### {mark} {escaped(part.headline)}"
    yield from _body(parts[0])
    yield from _left_out(parts)


def part_of(name: str, found: Comparison) -> Part:
    """What is told of a comparison."""
    pair = (found.before, found.after)
    parts = tuple(sections(found))
    return Part(name, verdict(found), found.equal, pair, measured(found), found.notes, parts)


def comment(parts: Sequence[Part]) -> Iterator[str]:
    """Markdown of several models: the equal ones in one line together, then the others."""
    count, of = sum(not p.is_equal for p in parts), len(parts)
    gone = [p.name for p in parts]
    parts = _within([*parts], LIMIT - _RESERVE)
    equal = [p.name for p in parts if p.is_equal]
    others = [p for p in parts if not p.is_equal]
    yield (f"### ⚠️ {count} of {of} models differ" if count else f"### ✅ all {of} models are equal")
    if equal:
        yield ""
        yield f"Equal: {', '.join(map(code, equal))}."
    for part in others:
        yield ""
        yield f"#### {escaped(part.name)}: {escaped(part.headline)}"
        if part.level < _LEVELS:
            yield from _body(part)
    if gone := gone[len(parts) :]:
        yield ""
        names = shorten(", ".join(gone), _RESERVE // 2, placeholder=" ...")
        yield f"And {len(gone)} further models, left out: {escaped(names)}"
    yield from _left_out(others)


def _body(part: Part) -> Iterator[str]:
    yield ""
    if part.versions is not None:
        about = " → ".join(map(code, part.versions))
        yield f"{about}: {escaped(part.measured)}." if part.measured else about
    yield from (f"> {escaped(note)}" for note in part.notes)
    kept = _kept(part)
    for section in kept:
        folded = section.detail or len(section.lines) > _FOLD
        yield from _section(section, is_open=not folded)
    if gone := [s.title for s in part.sections if s not in kept]:
        yield ""
        yield f"> Left out, as the comment would be too long: {escaped('; '.join(gone))}."


def _kept(part: Part) -> list[Section]:
    if part.level == 0:
        return list(part.sections)
    plain = [s for s in part.sections if not s.detail]
    if part.level == 1:
        return plain
    if part.level == 2:
        return [s for s in plain if s.title not in _BY_CAUSE]
    first = [s for s in plain if s.title == "specification"]
    return first or plain[:1]


def _size(part: Part) -> int:
    """Bytes, which are not fewer than characters; equal ones need their names alone."""
    if part.is_equal:
        return len(part.name.encode()) + 6
    body = list(_body(part)) if part.level < _LEVELS else []
    head = len(f"{escaped(part.name)}: {escaped(part.headline)}".encode()) + 8
    return head + sum(len(line.encode()) + 1 for line in body)


def _within(parts: list[Part], limit: int) -> list[Part]:
    """Less and less of the longest, until all fit; in the end the last ones are only counted."""
    parts = list(parts)
    sizes = [_size(p) for p in parts]
    total = sum(sizes)
    for level in range(1, _LEVELS + 1):
        longest = sorted(range(len(parts)), key=lambda k: -sizes[k])
        for k in longest:
            if total <= limit:
                return parts
            if not parts[k].is_equal:
                parts[k] = replace(parts[k], level=level)
                total += (size := _size(parts[k])) - sizes[k]
                sizes[k] = size
    while parts and total > limit:
        parts.pop()
        total -= sizes.pop()
    return parts


def _left_out(parts: Sequence[Part]) -> Iterator[str]:
    """Of what only the headline had room; what else is left out is told in its place."""
    told = sum(p.level == _LEVELS for p in parts)
    if told:
        yield ""
        yield f"> Of {told} models no more than the headline: the comment would be too long."


def _section(section: Section, *, is_open: bool) -> Iterator[str]:
    lines = section.lines
    fence = "`" * max(4, *(len(run) + 1 for line in lines for run in _ticks(line)))
    title = section.title[:1].upper() + section.title[1:]
    yield ""
    yield f"<details{' open' if is_open else ''}><summary>{escaped(title)}</summary>"
    yield ""
    yield f"{fence}diff"
    yield from lines
    yield fence
    yield ""
    yield "</details>"


def _ticks(line: str) -> list[str]:
    """Runs of backticks in a line."""
    return "".join(c if c == "`" else " " for c in line).split() or [""]


_LONG = 100


def code(text: str) -> str:
    """A text as code; long ones are cut."""
    text = " ".join(text.split()).replace("`", "'").replace("|", "/")
    return f"`{text[:_LONG]}{'...' if len(text) > _LONG else ''}`"


_ESCAPES = {ord(c): f"\\{c}" for c in "\\`*_[]"} | {ord(c): f"&#{ord(c)};" for c in "<>|#@&"}


def escaped(text: str) -> str:
    """A text that Markdown shows as it is."""
    return text.translate(_ESCAPES)
