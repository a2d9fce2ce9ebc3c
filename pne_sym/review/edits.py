"""What was edited: two specifications compared entry by entry, legs and joints aligned."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pne_sym.review.alignment import Pair, joint_pairs, leg_pairs
from pne_sym.review.difference import Edit
from pne_sym.review.edit_words import rank, words

_LABELS = ("name", "title")
Key = str | int


@dataclass(frozen=True)
class Raw:
    """An entry that differs.

    Attributes:
        path: keys and positions (of lists: after, or before where the entry is gone).
        old, new: None where there is none.
        joint: of a table of a joint's entry, the joint after (or before).
        more: other legs with the same edit.
    """

    path: tuple[Key, ...]
    old: Any
    new: Any
    joint: Mapping[str, Any] | None = None
    more: tuple[int, ...] = ()


def edits(before: Mapping[str, Any], after: Mapping[str, Any]) -> tuple[Edit, ...]:
    """The edits that lead from one specification to another, what changes structure first.

    Names and titles are left out.

    Args:
        before: as it is written, or its full form.
        after: likewise.

    >>> one = {"legs": [{"joints": [{"kind": "H", "pitch": 0.1}]}]}
    >>> two = {"legs": [{"joints": [{"kind": "H", "pitch": 0.2}]}]}
    >>> [(e.words, e.path) for e in edits(one, two)]
    [('leg 1, joint 1 (H): pitch 0.1 -> 0.2 m/rad (+100 %)', 'legs[0].joints[0].pitch')]
    """
    raw = list(_joined(_moved(list(_differences((), before, after, None)))))
    return tuple(sorted((_told(r) for r in raw), key=lambda e: rank(e.path, e.words)))


def best_edits(
    full: tuple[Mapping[str, Any], Mapping[str, Any]],
    written: tuple[Mapping[str, Any] | None, Mapping[str, Any] | None],
) -> tuple[Edit, ...]:
    """The edits as their author wrote them, where these are no more than those of the full forms.

    Args:
        full: full forms before and after.
        written: the specifications as they are written; None of a generated folder.
    """
    found = edits(*full)
    if written[0] is None or written[1] is None or not found:
        return found
    own = edits(written[0], written[1])
    return own if own and len(own) <= len(found) else found


def _differences(
    path: tuple[Key, ...], old: Any, new: Any, joint: Mapping[str, Any] | None
) -> Iterator[Raw]:
    """The innermost tables and lists that differ; of symbols all together."""
    if path == ("symbols",) and old != new:
        both = [table or {} for table in (old, new)]
        own = [{k: v for k, v in a.items() if b.get(k) != v} for a, b in (both, both[::-1])]
        yield Raw(path, own[0] or None, own[1] or None)
    elif isinstance(old, Mapping) and isinstance(new, Mapping):
        for key in dict.fromkeys((*old, *new)):
            if (*path, key) not in {(name,) for name in _LABELS}:
                yield from _differences((*path, key), old.get(key), new.get(key), joint)
    elif _is_nested(old) and _is_nested(new):
        for i, j in _pairs(path, old, new):
            a, b = None if i is None else old[i], None if j is None else new[j]
            inner = b if b is not None else a
            of = inner if path[-1:] == ("joints",) and isinstance(inner, Mapping) else joint
            place = j if j is not None else i
            assert place is not None
            yield from _differences((*path, place), a, b, of)
    elif old != new:
        yield Raw(path, old, new, joint)


def _pairs(path: tuple[Key, ...], old: Sequence[Any], new: Sequence[Any]) -> list[Pair]:
    tables = all(isinstance(x, Mapping) for x in (*old, *new))
    if tables and path[-1:] == ("joints",):
        return joint_pairs(old, new)
    if tables and path == ("legs",):
        return leg_pairs(old, new)
    size = max(len(old), len(new))
    return [(k if k < len(old) else None, k if k < len(new) else None) for k in range(size)]


def _is_nested(value: Any) -> bool:
    """Whether a value is a list of tables; vectors and matrices are told as a whole."""
    return isinstance(value, list) and any(isinstance(x, Mapping) for x in value)


def _moved(raw: list[Raw]) -> list[Raw]:
    """An actuator taken off one joint of a leg and put on another is one edit."""
    found = list(raw)
    marks = [r for r in raw if r.path[-1] == "actuated" and "joints" in r.path]
    for off in (r for r in marks if r.old and not r.new):
        for on in (r for r in marks if r.new and not r.old and r in found):
            if on.path[:-2] == off.path[:-2]:
                found[found.index(on)] = Raw(
                    (*on.path[:-2], "actuated joint"), off.path[-2], on.path[-2]
                )
                found.remove(off)
                break
    return found


def _joined(raw: list[Raw]) -> Iterator[Raw]:
    """The same edit of several legs told once; alike ones of more than two legs too."""
    groups: dict[Any, list[Raw]] = {}
    for r in raw:
        of_leg = len(r.path) > 2 and r.path[0] == "legs" and isinstance(r.path[1], int)
        same = (r.path[2:], repr(r.old), repr(r.new)) if of_leg else r.path
        groups.setdefault(same, []).append(r)
    alike: dict[Any, list[list[Raw]]] = {}
    for key, group in groups.items():
        whole = group[0].path[0] == "legs" and len(group[0].path) > 2
        alike.setdefault(key[0] if whole else key, []).append(group)
    for several in alike.values():
        if len(several) > 2:
            first = several[0][0]
            legs = tuple(sorted({int(r.path[1]) for group in several for r in group}))
            yield Raw(first.path, first.old, first.new, first.joint, legs)
            continue
        for group in several:
            legs = tuple(int(r.path[1]) for r in group) if len(group) > 1 else ()
            yield Raw(group[0].path, group[0].old, group[0].new, group[0].joint, legs)


def _told(r: Raw) -> Edit:
    return Edit(
        words(r.path, r.old, r.new, r.joint, r.more),
        _text_of(r.path, r.more),
        "" if r.old is None else _shown(r.old),
        "" if r.new is None else _shown(r.new),
    )


def _text_of(path: tuple[Key, ...], more: tuple[int, ...]) -> str:
    """legs[0].joints[1].axis; of several legs their positions within the brackets."""
    found = ""
    for k, key in enumerate(path):
        if k == 1 and more:
            found += f"[{', '.join(map(str, more))}]"
        elif isinstance(key, int):
            found += f"[{key}]"
        else:
            found += f".{key}" if found else str(key)
    return found


_LONG = 160


def _shown(value: Any) -> str:
    text = str(value)
    return text if len(text) <= _LONG else f"{text[:_LONG]}..."
