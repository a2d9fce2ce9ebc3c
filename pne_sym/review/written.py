"""Changes of a specification as it is written: one edited line is one change, at its own path."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from pne_sym.review.difference import Change

DEFAULT = "default of "
"""Begins what `Change.what` says of a changed number."""
_LABELS = ("name", "title")


def as_written(
    found: Iterable[Change], before: Mapping[str, Any] | None, after: Mapping[str, Any] | None
) -> tuple[Change, ...]:
    """Changed defaults told as the edits of the specifications, where these are not more.

    Args:
        found: changes of the interface; defaults with their paths in the full form.
        before: the specification as it is written; None of a generated folder.
        after: likewise.
    """
    found = tuple(found)
    numbers = [c for c in found if c.what.startswith(DEFAULT) or c.what == "home"]
    if before is None or after is None or not numbers:
        return found
    edits = list(changes(before, after))
    if len(edits) > len(numbers):
        return found
    others = [change for change in found if change not in numbers]
    return (*others, *edits)


def changes(before: Mapping[str, Any], after: Mapping[str, Any]) -> Iterator[Change]:
    """What differs between two specifications, by the paths at which it is written.

    Names and titles are left out.

    >>> one = {"legs": [{"joints": {"0": {"pitch": 0.1}}}]}
    >>> two = {"legs": [{"joints": {"0": {"pitch": 0.2}}}]}
    >>> [str(change.what) for change in changes(one, two)]
    ['default of legs.0.joints.0.pitch']
    """
    for path, old, new in _differences("", before, after):
        if path in _LABELS:
            continue
        kind = "added" if old is None else "removed" if new is None else "changed"
        yield Change(kind, f"{DEFAULT}{path}", *("" if v is None else str(v) for v in (old, new)))


def _differences(path: str, old: Any, new: Any) -> Iterator[tuple[str, Any, Any]]:
    """Paths of the innermost tables and lists that differ, with both values; None where absent."""
    if isinstance(old, Mapping) and isinstance(new, Mapping):
        pairs = [(key, old.get(key), new.get(key)) for key in dict.fromkeys((*old, *new))]
    elif _is_nested(old) and _is_nested(new):
        size = max(len(old), len(new))
        padded = [[*each, *[None] * (size - len(each))] for each in (old, new)]
        pairs = list(zip(map(str, range(size)), *padded, strict=True))
    else:
        if old != new:
            yield path, old, new
        return
    for key, a, b in pairs:
        yield from _differences(f"{path}.{key}" if path else str(key), a, b)


def _is_nested(value: Any) -> bool:
    """Whether a value is a list of tables or of lists; one of numbers is a vector."""
    return isinstance(value, list) and any(isinstance(each, list | Mapping) for each in value)
