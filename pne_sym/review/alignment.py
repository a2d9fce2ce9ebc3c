"""Which leg and which joint of one version is which of the other: by name, else by likeness.

Legs stand in an order, and so do the joints of a leg: one that is put in or taken out moves
the others. Both are aligned as sequences, so that what stays is compared with itself.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

Table = Mapping[str, Any]
Pair = tuple[int | None, int | None]
"""Positions before and after; None where there is no counterpart."""
_UNNAMED = -0.75
"""Of a joint without counterpart: two joints of one kind are rather the same."""
_LEFT_OUT = -0.5
_KEPT = 10.0
"""Of a leg that is the same: as many as stand in one order keep it."""
_LEG = re.compile(r"^legs\[(\d+)\]")
_JOINT = re.compile(r"\.joints\[(\d+)\]")


def aligned(
    before: Sequence[Any], after: Sequence[Any], score: Callable[[Any, Any], float], gap: float
) -> list[Pair]:
    """The alignment of two sequences with the largest score (Needleman and Wunsch).

    Args:
        before: a sequence.
        after: another.
        score: of two entries that stand for the same.
        gap: score of an entry without counterpart.

    >>> aligned("ac", "abc", lambda a, b: 1.0 if a == b else -2.0, -0.5)
    [(0, 0), (None, 1), (1, 2)]
    """
    n, m = len(before), len(after)
    best = [[gap * (i + j) for j in range(m + 1)] for i in range(n + 1)]
    for i in range(n):
        for j in range(m):
            best[i + 1][j + 1] = max(
                best[i][j] + score(before[i], after[j]),
                best[i][j + 1] + gap,
                best[i + 1][j] + gap,
            )
    pairs: list[Pair] = []
    i, j = n, m
    while i or j:
        if i and j and best[i][j] == best[i - 1][j - 1] + score(before[i - 1], after[j - 1]):
            i, j = i - 1, j - 1
            pairs.append((i, j))
        elif j and best[i][j] == best[i][j - 1] + gap:
            j -= 1
            pairs.append((None, j))
        else:
            i -= 1
            pairs.append((i, None))
    return pairs[::-1]


def joint_pairs(before: Sequence[Table], after: Sequence[Table]) -> list[Pair]:
    """The joints of a leg, as the full form or its author writes them."""
    if before == after:
        return [(k, k) for k in range(len(before))]
    return aligned(before, after, _joint_score, _UNNAMED)


def leg_pairs(before: Sequence[Table], after: Sequence[Table]) -> list[Pair]:
    """The legs of a platform: in their order, but the same ones wherever they stand."""
    if before == after:
        return [(k, k) for k in range(len(before))]
    kept = aligned(before, after, _leg_score, _LEFT_OUT)
    gone = [i for i, j in kept if j is None and i is not None]
    new = [j for i, j in kept if i is None and j is not None]
    for i in gone:
        if (place := next((j for j in new if _is_same_leg(before[i], after[j])), None)) is not None:
            new.remove(place)
            kept = [pair for pair in kept if pair not in ((i, None), (None, place))]
            kept.append((i, place))
    return sorted(kept, key=lambda pair: (pair[0] or 0) - 0.5 if pair[1] is None else pair[1])


def _is_same_leg(a: Table, b: Table) -> bool:
    """By name where both have one, else by its two points."""
    if a.get("name") and b.get("name"):
        return bool(a["name"] == b["name"])
    return all(a.get(key) == b.get(key) for key in ("base_point", "platform_point"))


def _name_score(a: Table, b: Table) -> float:
    if a.get("name") and b.get("name"):
        return 4.0 if a["name"] == b["name"] else -2.0
    return 0.0


def _joint_score(a: Table, b: Table) -> float:
    found = 2.0 if a.get("kind") == b.get("kind") else -3.0
    for key, weight in (("axis", 1.0), ("axes", 1.0), ("link", 0.5), ("offset", 0.25)):
        found += weight if a.get(key) == b.get(key) else 0.0
    for key, weight in (("actuated", 0.25), ("extra", 0.25)):
        found += weight if bool(a.get(key)) == bool(b.get(key)) else 0.0
    return found + _name_score(a, b)


def _leg_score(a: Table, b: Table) -> float:
    found = _name_score(a, b) + _KEPT * _is_same_leg(a, b)
    for key in ("type", "base_point", "platform_point", "base_frame"):
        found += 1.0 if a.get(key) == b.get(key) else 0.0
    old, new = (x.get("joints") or () for x in (a, b))
    if isinstance(old, Sequence) and isinstance(new, Sequence):
        kinds = [[j.get("kind") for j in joints] for joints in (old, new)]
        found += 1.0 if kinds[0] == kinds[1] else 0.25
    return found


@dataclass(frozen=True)
class Alignment:
    """Who is who in two versions; positions count from 0.

    Attributes:
        legs: after -> before.
        joints: leg after -> joint after -> joint before.
        types: name of a leg type after -> before; several may stand for one. None of types
            that share no more than half of their joints.
    """

    legs: dict[int, int] = field(default_factory=dict)
    joints: dict[int, dict[int, int]] = field(default_factory=dict)
    types: dict[str, str] = field(default_factory=dict)

    def canonical(self, path: str) -> str:
        """A path after as it is before; with a mark where it has no counterpart."""
        found = _LEG.match(path)
        if found is None:
            return path
        leg = int(found[1])
        if leg not in self.legs:
            return f"new {path}"
        rest = path[found.end() :]
        if (joint := _JOINT.match(rest)) is not None:
            partner = self.joints[leg].get(int(joint[1]))
            if partner is None:
                return f"new {path}"
            rest = f".joints[{partner}]{rest[joint.end() :]}"
        return f"legs[{self.legs[leg]}]{rest}"


def align(
    before: Mapping[str, Any],
    after: Mapping[str, Any],
    written: tuple[Table | None, Table | None] = (None, None),
) -> Alignment:
    """The alignment of two versions by their manifests.

    Args:
        before: a manifest.
        after: another.
        written: the specifications as their authors wrote them: names of leg types.
    """
    sides = [_legs(m, w) for m, w in zip((before, after), written, strict=True)]
    legs = {j: i for i, j in leg_pairs(*sides) if i is not None and j is not None}
    joints = {
        j: {
            b: a
            for a, b in joint_pairs(sides[0][i]["joints"], sides[1][j]["joints"])
            if a is not None and b is not None
        }
        for j, i in legs.items()
    }
    alike = {
        j: i
        for j, i in legs.items()
        if 2 * len(joints[j]) > max(len(sides[0][i]["joints"]), len(sides[1][j]["joints"]))
    }
    owner = {leg: t["name"] for t in before["leg_types"] for leg in t["legs"]}
    types = {}
    for t in after["leg_types"]:
        partners = Counter(owner[alike[leg]] for leg in t["legs"] if alike.get(leg) in owner)
        if partners:
            types[t["name"]] = max(partners, key=lambda n: (partners[n], n == t["name"]))
    return Alignment(legs, joints, types)


def _legs(manifest: Mapping[str, Any], written: Table | None) -> list[dict[str, Any]]:
    """The legs of the full form, with the names of their types; bare ones in format 1."""
    form = manifest.get("specification")
    if isinstance(form, Mapping) and isinstance(form.get("legs"), list):
        legs = [dict(leg) for leg in form["legs"] if isinstance(leg, Mapping)]
        if all(isinstance(leg.get("joints"), list) for leg in legs):
            own = (written or {}).get("legs")
            alike = isinstance(own, list) and len(own) == len(legs)
            for leg, table in zip(legs, own or (), strict=True) if alike else ():
                if isinstance(table, Mapping):
                    leg |= {k: table[k] for k in ("type", "name") if k in table}
            return legs
    count = 1 + max((leg for leg, _ in manifest["joints"]), default=-1)
    return [{"joints": [{} for leg, _ in manifest["joints"] if leg == k]} for k in range(count)]
