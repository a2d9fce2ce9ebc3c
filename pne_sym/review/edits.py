"""What was edited: two specifications compared entry by entry, legs and joints aligned."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pne_sym.review.alignment import Pair, joint_pairs, leg_pairs
from pne_sym.review.difference import Edit
from pne_sym.review.edit_changes import CENTRE, is_vague, plain
from pne_sym.review.edit_words import FOLLOWING, rank, words

_LABELS = ("name", "title")
_OVERRIDE = re.compile(r"legs\[[\d, ]+\]\.(joints(\.\d|$)|platform_joint$)")
Key = str | int


@dataclass(frozen=True)
class Raw:
    """An entry that differs.

    Attributes:
        path: keys and positions (of lists: after, or before where the entry is gone).
        old, new: None where there is none.
        joint: of a table of a joint's entry, the joint after (or before).
        legs: all legs with such an edit, where there are several.
        alike: the values before and after of each of these edits.
    """

    path: tuple[Key, ...]
    old: Any
    new: Any
    joint: Mapping[str, Any] | None = None
    legs: tuple[int, ...] = ()
    alike: tuple[tuple[Any, Any], ...] = ()


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
    renamed = _renamed_types(before, after)
    if renamed:
        before = _with_types(before, renamed)
    raw = [Raw(("leg_types", old, "name"), old, new) for old, new in renamed.items()]
    raw += _differences((), before, after, None)
    raw = list(_joined(_about(_moved(_without_splits(raw)))))
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
    return own if own and _length(own) <= _length(found) else found


def _length(told: Sequence[Edit]) -> int:
    """Of two ways to tell the same: vague words, overrides as a whole count as several."""
    return sum(
        1 + is_vague(e.words) + 2 * (_OVERRIDE.match(e.path) is not None)
        for e in told
        if not e.path.startswith(FOLLOWING)
    )


def _renamed_types(before: Mapping[str, Any], after: Mapping[str, Any]) -> dict[str, str]:
    """Leg types that have another name, most of their joints being the same."""
    sides = [_joints_of_types(form) for form in (before, after)]
    gone = {name: joints for name, joints in sides[0].items() if name not in sides[1]}
    new = {name: joints for name, joints in sides[1].items() if name not in sides[0]}
    found: dict[str, str] = {}
    for name, joints in gone.items():
        for other, own in new.items():
            kept = [pair for pair in joint_pairs(joints, own) if None not in pair]
            if other not in found.values() and 2 * len(kept) > max(len(joints), len(own)):
                found[name] = other
                break
    return found


def _joints_of_types(form: Mapping[str, Any]) -> dict[str, Sequence[Any]]:
    """Joints of each leg type that legs have, of the type or of its first leg."""
    found: dict[str, Sequence[Any]] = {}
    for leg in form.get("legs", ()):
        name = leg.get("type")
        own = form.get("leg_types", {}).get(name, leg).get("joints")
        if name and isinstance(own, list):
            found.setdefault(name, own)
    return found


def _with_types(form: Mapping[str, Any], names: Mapping[str, str]) -> dict[str, Any]:
    """A specification with other names of its leg types."""
    legs = [
        {**g, "type": names.get(g["type"], g["type"])} if "type" in g else g for g in form["legs"]
    ]
    types = {names.get(name, name): table for name, table in form.get("leg_types", {}).items()}
    return {**form, "legs": legs} | ({"leg_types": types} if types else {})


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
        pairs = _pairs(path, old, new)
        kept = [i for i, j in pairs if i is not None and j is not None]
        if kept != sorted(kept):
            now = [
                next((i + 1 for i, of in pairs if of == j and i is not None), 0)
                for j in range(len(new))
            ]
            yield Raw((*path, "order"), list(range(1, len(old) + 1)), now)
        for i, j in pairs:
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


def _without_splits(raw: list[Raw]) -> list[Raw]:
    """Leg types of the full form that are called after a leg follow from what the leg overrides."""
    edited = {r.path[1] for r in raw if len(r.path) > 3 and r.path[0] == "legs"}
    return [
        r
        for r in raw
        if not (
            len(r.path) == 3
            and (r.path[0], r.path[2]) == ("legs", "type")
            and r.path[1] in edited
            and (f"{r.new}".startswith(f"{r.old}_") or f"{r.old}".startswith(f"{r.new}_"))
        )
    ]


def _about(raw: list[Raw]) -> list[Raw]:
    """An inertia about another point is one edit, whatever its entries are now."""
    points = {r.path[:-1]: r for r in raw if r.path[-1] == "inertia_about"}
    paths = [r.path for r in raw]
    found = []
    for r in raw:
        point = points.get(r.path[:-1])
        if r.path[-1] == "inertia" and point is not None:
            pair = [
                f"{plain(value)} about {at or CENTRE}"
                for value, at in ((r.old, point.old), (r.new, point.new))
            ]
            found.append(Raw(point.path, pair[0], pair[1], r.joint))
        elif r.path[-1] != "inertia_about" or (*r.path[:-1], "inertia") not in paths:
            found.append(r)
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
        for part in [[r for group in several for r in group]] if len(several) > 2 else several:
            first = part[0]
            legs = tuple(sorted({int(r.path[1]) for r in part})) if len(part) > 1 else ()
            pairs = tuple((r.old, r.new) for r in part)
            yield Raw(first.path, first.old, first.new, first.joint, legs, pairs)


def _told(r: Raw) -> Edit:
    sides = ("" if value is None else _shown(value) for value in (r.old, r.new))
    return Edit(words(r.path, r.alike, r.joint, r.legs), _text_of(r.path, r.legs), *sides)


def _text_of(path: tuple[Key, ...], legs: tuple[int, ...]) -> str:
    """legs[0].joints[1].axis; of several legs their positions within the brackets."""
    found = ""
    for k, key in enumerate(path):
        if k == 1 and legs:
            found += f"[{', '.join(map(str, legs))}]"
        elif isinstance(key, int):
            found += f"[{key}]"
        else:
            found += f".{key}" if found else str(key)
    return found


_LONG = 160


def _shown(value: Any) -> str:
    """As the specification writes it; of legs and leg types one entry or joint a line."""
    tables = value if isinstance(value, list) else [value]
    if tables and all(
        isinstance(t, Mapping) and t.keys() & {"joints", "base_point"} for t in tables
    ):
        lines = [line for table in tables for line in _lines(table)]
    else:
        lines = [plain(value)]
    return "\n".join(text if len(text) <= _LONG else f"{text[:_LONG]}..." for text in lines)


def _lines(leg: Mapping[str, Any]) -> Iterator[str]:
    for key, value in leg.items():
        if key != "joints" or not isinstance(value, list):
            yield f"{key} = {plain(value, quoted=True)}"
        else:
            yield from (f"joint {k + 1} = {plain(joint)}" for k, joint in enumerate(value))
