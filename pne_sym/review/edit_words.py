"""Edits of a specification in words: axis flipped, joint inserted, mass +8 %."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

Key = str | int
_UNITS = {
    "mass": "kg", "pitch": "m/rad", "rate": "", "effort": "", "gear_ratio": "",
    "rotor_inertia": "kg m^2",
}  # fmt: skip
_NAMED = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_AXES = ("axis", "axis_link", "axis_platform")
_POINTS = ("base_point", "platform_point", "centre_of_mass", "offset", "fixed_centre")
_FRAMES = ("base_frame", "rotation")
_RANKS = (
    ("space",), ("legs", "leg_types", "joints"), ("type", "kind", "platform_joint", "coupling"),
    ("actuated joint", "actuated", "extra"), ("axis", "axes", "axis_link", "axis_platform"),
    ("offset", "pitch"), ("base_point", "platform_point", "base_frame", "rotation"),
    ("mass", "centre_of_mass", "inertia", "inertia_about", "link", "payload"),
)  # fmt: skip
FOLLOWING = ("home", "symbols")
"""Fields that follow from other edits: they come last, and no headline counts them."""


def rank(path: str, told: str) -> tuple[int, str]:
    """What changes structure comes first; home, which follows, and notation last."""
    keys = [part.split("[")[0] for part in path.split(".")]
    if keys[0] in FOLLOWING:
        return (20 + FOLLOWING.index(keys[0]), "")
    if keys[0] == "leg_types" and len(keys) == 2:
        return (3, "")
    if keys[0] == "legs" and keys[-1] == "type":
        return (1, "")
    if told.endswith((" added", " removed", " inserted")) or "inserted" in told:
        return (1, "")
    return (next((k for k, of in enumerate(_RANKS) if keys[-1] in of), len(_RANKS)), "")


def words(
    path: Sequence[Key],
    old: Any,
    new: Any,
    joint: Mapping[str, Any] | None = None,
    legs: Sequence[int] = (),
) -> str:
    """One line for people.

    Args:
        path: keys and positions.
        old: the value before; None where there is none.
        new: likewise.
        joint: the joint that the entry belongs to.
        legs: all legs whose edit this is, where there are several; the values are the first's.
    """
    if isinstance(path[-1], int):
        return _entry(path, old, new, legs)
    if len(path) == 2 and path[0] == "leg_types":
        return f"leg type {path[1]} {_kind(old, new)}"
    place = _place(path[:-1], joint, legs)
    several = len({*legs}) > 1
    what = _change(str(path[-1]), old, new, several=several)
    return f"{place}: {what}" if place else what


def _place(path: Sequence[Key], joint: Mapping[str, Any] | None, legs: Sequence[int]) -> str:
    """leg type ups, joint 2 (P); leg 3; platform; home."""
    parts: list[str] = []
    for k, key in enumerate(path):
        before = path[k - 1] if k else ""
        if key in ("legs", "leg_types", "joints", "link"):
            if key == "link":
                parts.append("link")
        elif before == "legs":
            parts.append(f"legs {_listed(legs)}" if len(legs) > 1 else f"leg {_count(key)}")
        elif before == "leg_types":
            parts.append(f"leg type {key}")
        elif before == "joints":
            kind = f" ({joint['kind']})" if joint and joint.get("kind") else ""
            parts.append(f"joint {_count(key)}{kind}")
        else:
            parts.append(str(key).replace("_", " "))
    return ", ".join(parts)


def _count(key: Key) -> str:
    return str(int(key) + 1) if str(key).isdigit() else str(key)


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
        what = f"joint {_count(path[-1])} ({_joint(table)})"
        return f"{place}: {what} {'inserted' if inserted else 'removed'}"
    if path[-2] == "legs":
        return f"leg {_count(path[-1])}{_leg(table)} {'added' if inserted else 'removed'}"
    return f"{_place(path[:-1], None, legs)}, entry {_count(path[-1])} {_kind(old, new)}"


def _joint(table: Any) -> str:
    if not isinstance(table, Mapping):
        return "joint"
    axis = table.get("axis", table.get("axes"))
    about = f" {'along' if table.get('kind') == 'P' else 'about'} {_axis(axis)}" if axis else ""
    return f"{table.get('kind', '?')}{about}{', actuated' if table.get('actuated') else ''}"


def _axis(axis: Any) -> str:
    if isinstance(axis, str):
        return axis
    vector = _vector(axis)
    named = next((n for n, v in _NAMED.items() if vector == v), None)
    turned = next((n for n, v in _NAMED.items() if vector and _negative(vector) == v), None)
    return named or (f"-{turned}" if turned else ", ".join(map(str, axis)))


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


def _kind(old: Any, new: Any) -> str:
    return "added" if old is None else "removed" if new is None else "changed"


def _change(key: str, old: Any, new: Any, *, several: bool) -> str:
    """What happened to an entry."""
    name = key.replace("_", " ")
    for of, told in (
        ((*_AXES, "axes"), _turned), (_POINTS, _shifted), (_FRAMES, _rotated),
        (("inertia",), _inertia),
    ):  # fmt: skip
        if key in of:
            return f"{name} {told(old, new)}{', others alike' if several else ''}"
    if key == "symbols":
        known = list(dict.fromkeys((*(old or ()), *(new or ()))))
        more = f" and {len(known) - 3} more" if len(known) > 3 else ""
        return f"symbols of {', '.join(known[:3])}{more} {_kind(old, new)}"
    if key == "actuated joint":
        return f"actuated joint moved from joint {_count(old)} to joint {_count(new)}"
    if key in ("actuated", "extra") and not isinstance(old or new, list):
        what = {"actuated": "actuated", "extra": "an extra coordinate"}[key]
        return f"{'now' if new else 'no longer'} {what}"
    if _is_number(old) and _is_number(new):
        unit = f" {_UNITS[key]}" if _UNITS.get(key) else ""
        return f"{name} {old:g} -> {new:g}{unit}{_percent(old, new)}"
    short = all(v is None or isinstance(v, str | int | float | bool) for v in (old, new))
    if short and old is not None and new is not None:
        return f"{name} {old} -> {new}"
    if isinstance(old or new, Mapping) and isinstance((old or new).get("mass"), int | float):
        return f"{name} {_kind(old, new)} (mass {(old or new)['mass']:g} kg)"
    return f"{name} {_kind(old, new)}"


def _turned(old: Any, new: Any) -> str:
    a, b = _vector(old), _vector(new)
    if a is None or b is None:
        return _kind(old, new)
    if max(abs(x + y) for x, y in zip(a, b, strict=True)) < 1e-9:
        return "flipped"
    return f"turned by {_degrees(_angle(a, b))}"


def _shifted(old: Any, new: Any) -> str:
    a, b = (_vector(v) if v is not None else (0.0, 0.0, 0.0) for v in (old, new))
    if a is None or b is None:
        return _kind(old, new)
    step = [y - x for x, y in zip(a, b, strict=True)]
    if not any(a):
        return f"set to {_length(math.hypot(*b))} from zero"
    if not any(b):
        return f"removed, was {_length(math.hypot(*a))}"
    off = [n for n, x, y in zip("xyz", a, b, strict=True) if x == 0.0 and y != 0.0]
    return (
        f"moved by {_length(math.hypot(*step))}{f', off zero in {chr(44).join(off)}' * bool(off)}"
    )


def _rotated(old: Any, new: Any) -> str:
    rows = [_matrix(v) for v in (old, new)]
    if rows[0] is None or rows[1] is None:
        return _kind(old, new)
    trace = sum(
        x * y for a, b in zip(rows[0], rows[1], strict=True) for x, y in zip(a, b, strict=True)
    )
    return f"turned by {_degrees(math.acos(max(-1.0, min(1.0, (trace - 1.0) / 2.0))))}"


def _inertia(old: Any, new: Any) -> str:
    a, b = _tensor(old), _tensor(new)
    if a is None or b is None:
        return _kind(old, new)
    products = [any(t[i][j] for i, j in ((0, 1), (0, 2), (1, 2))) for t in (a, b)]
    if products[0] != products[1]:
        return "now full (products of inertia)" if products[1] else "no longer full"
    if not any(x for row in a for x in row):
        return "set, from zero"
    size = max(abs(x) for row in a for x in row)
    step = max(
        (y - x for r, s in zip(a, b, strict=True) for x, y in zip(r, s, strict=True)), key=abs
    )
    return f"changed by up to {100.0 * abs(step) / size:.3g} %"


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _percent(old: float, new: float) -> str:
    return f" ({100.0 * (new - old) / abs(old):+.3g} %)" if old else ""


def _length(metres: float) -> str:
    return f"{1000.0 * metres:.3g} mm" if metres < 1.0 else f"{metres:.4g} m"


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.3g} degrees"


def _angle(a: Sequence[float], b: Sequence[float]) -> float:
    size = math.hypot(*a) * math.hypot(*b)
    return (
        math.acos(max(-1.0, min(1.0, sum(x * y for x, y in zip(a, b, strict=True)) / size)))
        if size
        else 0.0
    )


def _negative(vector: Sequence[float]) -> tuple[float, ...]:
    return tuple(0.0 - x for x in vector)


def _vector(value: Any) -> tuple[float, ...] | None:
    """Three components: of a list of two or three, or of the name of an axis."""
    if isinstance(value, str):
        unit = _NAMED.get(value.lstrip("-"))
        return (_negative(unit) if value.startswith("-") else unit) if unit else None
    if not isinstance(value, Sequence) or not all(map(_is_number, value)):
        return None
    found = tuple(float(x) for x in value)
    return (*found, 0.0) if len(found) == 2 else found if len(found) == 3 else None


def _matrix(value: Any) -> list[tuple[float, ...]] | None:
    """Three rows; a rotation in the plane is one about z."""
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) not in (2, 3):
        return None
    rows = [_vector(row) for row in value]
    found = [row for row in rows if row is not None]
    if len(found) != len(value):
        return None
    return found if len(found) == 3 else [*found, (0.0, 0.0, 1.0)]


def _tensor(value: Any) -> list[tuple[float, ...]] | None:
    """An inertia tensor in one of the forms of the specification."""
    if value is None:
        return [(0.0, 0.0, 0.0)] * 3
    if _is_number(value):
        return [(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, float(value))]
    if isinstance(value, Mapping):
        entry = {k: float(v) for k, v in value.items() if _is_number(v)}
        names = (("ixx", "ixy", "ixz"), ("ixy", "iyy", "iyz"), ("ixz", "iyz", "izz"))
        return [tuple(entry.get(n, 0.0) for n in row) for row in names]
    diagonal = _vector(value)
    if diagonal is not None:
        return [tuple(x if i == j else 0.0 for j in range(3)) for i, x in enumerate(diagonal)]
    return _matrix(value)
