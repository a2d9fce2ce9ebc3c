"""Every file of two versions accounted for: equal to the byte, or where it differs."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping

from pne_sym.review.difference import FileDifference
from pne_sym.review.folders import Entry, Folder

_LONG = 100
_FAR = 30
"""Lines of code above a line in which its equation is looked for."""
_ID = re.compile(rb"\s+(?:#|/\*|//|%)\s*\(([A-Za-z][A-Za-z0-9_-]{0,200})\)")


def file_differences(
    before: Folder, after: Folder, accounted: Collection[str]
) -> tuple[FileDifference, ...]:
    """Every file that is not the same, with the first line that differs.

    Args:
        before: a version.
        after: another.
        accounted: files whose difference is compared by what they mean.
    """
    return tuple(
        _difference(path, before.get(path), after.get(path), path in accounted)
        for path in sorted({*before, *after})
        if before.get(path) != after.get(path)
    )


def as_folder(texts: Mapping[str, str]) -> Folder:
    """Texts as the files of a folder."""
    return {name: Entry("file", text.encode()) for name, text in sorted(texts.items())}


def _difference(path: str, a: Entry | None, b: Entry | None, accounted: bool) -> FileDifference:
    if a is None or b is None:
        cache = "; Python may run it in place of the module: remove it"
        note = cache if "__pycache__" in path.split("/") else ""
        return FileDifference(path, f"only {'after' if a is None else 'before'}{note}")
    if a.kind != b.kind:
        return FileDifference(path, f"a {a.kind} before, a {b.kind} after")
    if a.kind != "file":
        return FileDifference(path, f"another {a.kind}")
    return FileDifference(path, *first_difference(a.content, b.content), accounted=accounted)


def first_difference(before: bytes, after: bytes) -> tuple[str, str, str]:
    """Where two contents first differ, and these lines: shortened, printable."""
    old, new = before.split(b"\n"), after.split(b"\n")
    common = min(len(old), len(new))
    k = next((i for i in range(common) if old[i] != new[i]), common)
    lines = [side[k] if k < len(side) else b"" for side in (old, new)]
    start = next((i for i in range(min(map(len, lines))) if lines[0][i] != lines[1][i]), 0)
    start = max(0, start - _LONG // 2) if max(map(len, lines)) > _LONG else 0
    where = f"line {k + 1}{_equation_above(old if k < len(old) else new, k)}"
    return where, _shown(lines[0], start), _shown(lines[1], start)


def _equation_above(lines: list[bytes], k: int) -> str:
    """The equation whose statement a line of code is: its id stands in the comment above."""
    for line in reversed(lines[max(0, k - _FAR) : k + 1]):
        if (found := _ID.match(line)) is not None:
            return f", under ({found[1].decode()})"
        if line and not line[:1].isspace():
            break
    return ""


def _shown(line: bytes, start: int) -> str:
    """A part of a line that holds the difference; what is not printable as an escape."""
    text = line[start : start + _LONG].decode("utf-8", errors="backslashreplace")
    shown = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
    return f"{'...' if start else ''}{shown}{'...' if len(line) > start + _LONG else ''}"
