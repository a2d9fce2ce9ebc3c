"""Edits of a specification in words: axis flipped, joint inserted, mass +8 %."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pne_sym.review.edit_changes import axis_words, changes, count, kind

Key = str | int
_RANKS = (
    ("space",), ("legs", "leg_types", "joints"), ("type", "kind", "platform_joint", "coupling"),
    ("actuated joint", "actuated", "extra"), ("axis", "axes", "axis_link", "axis_platform"),
    ("offset", "pitch"), ("base_point", "platform_point", "base_frame", "rotation"),
    ("mass", "centre_of_mass", "inertia", "inertia_about", "link", "payload"),
)  # fmt: skip
FOLLOWING = ("home", "symbols")
"""Fields that follow from other edits: they come last, and no headline counts them."""


def rank(path: str, told: str) -> int:
    """What changes structure comes first; home, which follows, and notation last."""
    keys = [part.split("[")[0] for part in path.split(".")]
    if keys[0] in FOLLOWING:
        return 20 + FOLLOWING.index(keys[0])
    if keys[0] == "leg_types" and len(keys) == 2:
        return 3
    if keys[0] == "legs" and keys[-1] in ("type", "order"):
        return 1
    if path.endswith("]") or "inserted" in told:
        return 1
    other = 2 if told.endswith((" added", " removed")) else len(_RANKS)
    return next((k for k, of in enumerate(_RANKS) if keys[-1] in of), other)


def words(
    path: Sequence[Key],
    pairs: Sequence[tuple[Any, Any]],
    joint: Mapping[str, Any] | None = None,
    legs: Sequence[int] = (),
) -> str:
    """One line for people.

    Args:
        path: keys and positions, of several legs those of the first.
        pairs: the value before and after; of several legs of each. None where there is none.
        joint: the joint that the entry belongs to.
        legs: all legs whose edit this is, where there are several.
    """
    old, new = pairs[0]
    if tuple(path) == ("legs", "order"):
        return _order(new)
    if isinstance(path[-1], int):
        return _entry(path, old, new, legs)
    if path[0] == "leg_types" and path[-1] == "name" and len(path) == 3:
        return f"leg type {old} renamed {new}"
    if len(path) == 2 and path[0] == "leg_types":
        return f"leg type {path[1]}{_leg(old or new)} {kind(old, new)}"
    place = _place(path[:-1], joint, legs)
    what = changes(str(path[-1]), pairs)
    return f"{place}: {what}" if place else what


def _order(now: Sequence[int]) -> str:
    """Legs that stand in another order, by the places that they had; 0 where a leg is new."""
    moved = [k for k, leg in enumerate(now, 1) if leg != k]
    if len(moved) == 2 and now[moved[0] - 1] == moved[1]:
        return f"legs {moved[0]} and {moved[1]} swapped"
    return f"legs in another order, now {', '.join(str(k) if k else 'new' for k in now)}"


def _place(path: Sequence[Key], joint: Mapping[str, Any] | None, legs: Sequence[int]) -> str:
    """leg type ups, joint 2 (P); leg 3; platform; home."""
    parts: list[str] = []
    for k, key in enumerate(path):
        before = path[k - 1] if k else ""
        if key in ("legs", "leg_types", "joints", "link"):
            if key == "link":
                parts.append("link")
        elif before == "legs":
            parts.append(f"legs {_listed(legs)}" if len(legs) > 1 else f"leg {count(key)}")
        elif before == "leg_types":
            parts.append(f"leg type {key}")
        elif before == "joints":
            kind = f" ({joint['kind']})" if joint and joint.get("kind") else ""
            parts.append(f"joint {count(key)}{kind}")
        else:
            parts.append(str(key).replace("_", " "))
    return ", ".join(parts)


def _listed(positions: Sequence[int]) -> str:
    """1-3, 5: from 1, runs joined."""
    runs: list[list[int]] = []
    for k in sorted({p + 1 for p in positions}):
        if runs and k == runs[-1][-1] + 1:
            runs[-1].append(k)
        else:
            runs.append([k])
    return ", ".join(str(r[0]) if len(r) == 1 else f"{r[0]}-{r[-1]}" for r in runs)


def _entry(path: Sequence[Key], old: Any, new: Any, legs: Sequence[int]) -> str:
    """An entry of a list that is new or gone: a leg, a joint."""
    inserted = old is None
    table = new if inserted else old
    if path[-2] == "joints":
        place = _place(path[:-2], None, legs)
        what = f"joint {count(path[-1])} ({_joint(table)})"
        return f"{place}: {what} {'inserted' if inserted else 'removed'}"
    if path[-2] == "legs":
        return f"leg {count(path[-1])}{_leg(table)} {'added' if inserted else 'removed'}"
    return f"{_place(path[:-1], None, legs)}, entry {count(path[-1])} {kind(old, new)}"


def _joint(table: Any) -> str:
    if not isinstance(table, Mapping):
        return "joint"
    axis = table.get("axis", table.get("axes"))
    about = (
        f" {'along' if table.get('kind') == 'P' else 'about'} {axis_words(axis)}" if axis else ""
    )
    return f"{table.get('kind', '?')}{about}{', actuated' if table.get('actuated') else ''}"


def _leg(table: Any) -> str:
    if not isinstance(table, Mapping):
        return ""
    if table.get("type"):
        return f" (of type {table['type']})"
    joints = table.get("joints")
    kinds = [j.get("kind", "?") for j in joints] if isinstance(joints, list) else []
    end = table.get("platform_joint")
    last = end.get("kind", "") if isinstance(end, Mapping) else end or ""
    return f" ({''.join(kinds)}{last if last != 'rigid' else ''})" if kinds else ""
