"""What happened to one entry of a specification: axis flipped, gravity turned, mass +8 %."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from pne_sym.model.kinematics import Array
from pne_sym.review.edit_vectors import NAMED, angle, is_number, matrix, tensor, vector

Key = str | int
_UNITS = {
    "mass": "kg", "pitch": "m/rad", "rate": "", "effort": "", "gear_ratio": "",
    "rotor_inertia": "kg m^2",
}  # fmt: skip
_SHORT = 3
"""Entries of a list of numbers that is told in words."""
CENTRE = "centre_of_mass"
_VAGUE = re.compile(r" (added|removed|changed)( \(.*\))?$")
_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def is_vague(told: str) -> bool:
    """Whether words do not tell more than that something is other."""
    return _VAGUE.search(told) is not None


def changes(key: str, pairs: Sequence[tuple[Any, Any]]) -> str:
    """What happened to an entry, of one leg or of several.

    Args:
        key: of the entry.
        pairs: before and after, of each leg; None where there is none.

    >>> changes("mass", [(1.0, 2.0)])
    'mass 1 -> 2 kg (+100 %)'
    >>> changes("offset", [([0, 0.1], [0, 0.2]), ([0, 0], [0.05, 0])])
    'offset moved by 100 mm, others otherwise'
    >>> changes("axis", [([1, 0], [0.6, 0.8]), ([1, 0], [0.8, 0.6])])
    'axis turned by 36.9 to 53.1 degrees'
    """
    told = [_change(key, old, new) for old, new in pairs]
    numbers = [[float(n) for n in _NUMBER.findall(text)] for text in told]
    rest = {_NUMBER.sub("#", text) for text in told}
    if len(set(told)) == 1:
        return told[0]
    if len(rest) > 1 or "->" in told[0]:
        return f"{told[0]}, others otherwise"
    ranges = iter([sorted(column) for column in zip(*numbers, strict=True)])
    return _NUMBER.sub(lambda _: _range(next(ranges)), told[0])


def _range(values: Sequence[float]) -> str:
    least, largest = f"{values[0]:g}", f"{values[-1]:g}"
    return least if least == largest else f"{least} to {largest}"


def kind(old: Any, new: Any) -> str:
    """Whether an entry is added, removed or changed; None where there is none."""
    return "added" if old is None else "removed" if new is None else "changed"


def _change(key: str, old: Any, new: Any) -> str:
    """What happened to an entry."""
    name = key.replace("_", " ")
    if (geometry := _GEOMETRY.get(key)) is not None:
        return f"{name} {geometry(old, new)}"
    if (own := _OWN.get(key)) is not None and (told_so := own(old, new)):
        return told_so
    if is_number(old) and is_number(new):
        unit = f" {_UNITS[key]}" if _UNITS.get(key) else ""
        return f"{name} {old:g} -> {new:g}{unit}{_percent(old, new)}"
    if all(isinstance(v, list) and _is_short(v) for v in (old, new)):
        rounded = [f"[{', '.join(f'{x:.4g}' for x in v)}]" for v in (old, new)]
        return f"{name} {' -> '.join(rounded)}" if len({*rounded}) > 1 else f"{name} changed"
    if all(_is_short(v) for v in (old, new)):
        return f"{name} {plain(old)} -> {plain(new)}"
    if isinstance(old or new, Mapping) and isinstance((old or new).get("mass"), int | float):
        return f"{name} {kind(old, new)} (mass {(old or new)['mass']:g} kg)"
    return f"{name} {kind(old, new)}"


def _is_short(value: Any) -> bool:
    """Whether a value has room in a headline."""
    few = isinstance(value, list) and len(value) <= _SHORT
    return isinstance(value, str | bool | int | float) or (few and all(map(is_number, value)))


def plain(value: Any, *, quoted: bool = False) -> str:
    """A value as the specification writes it; a text alone without quotes.

    >>> plain({"rest": 0.5, "pair": [1, True], "of": "x"})
    '{ rest = 0.5, pair = [1, true], of = "x" }'
    """
    if isinstance(value, Mapping):
        inner = ", ".join(f"{k} = {plain(v, quoted=True)}" for k, v in value.items())
        return f"{{ {inner} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(plain(v, quoted=True) for v in value)}]"
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if quoted and isinstance(value, str) else str(value)


# ---- entries with words of their own ----------------------------------------------------------


def _symbols(old: Any, new: Any) -> str:
    known = list(dict.fromkeys((*(old or ()), *(new or ()))))
    more = f" and {len(known) - _SHORT} more" if len(known) > _SHORT else ""
    return f"symbols of {', '.join(known[:_SHORT])}{more} {kind(old, new)}"


def _moved(old: Any, new: Any) -> str:
    return f"actuated joint moved from joint {count(old)} to joint {count(new)}"


def _marked(what: str, old: Any, new: Any) -> str:
    if isinstance(old, list) or isinstance(new, list):
        return f"{what}: {plain(old or False)} -> {plain(new or False)}"
    return f"{'now' if new else 'no longer'} {what}"


def _called(old: Any, new: Any) -> str:
    if old is None or new is None:
        return f"named {new}" if old is None else f"no longer named {old}"
    return ""


def _about(old: Any, new: Any) -> str:
    """Inertia about another point; values may stand before the points."""
    point = str(new or CENTRE).rpartition(" ")[2].replace("_", " ")
    return f"inertia now about the {point}" if old != new else ""


def _gravity(old: Any, new: Any) -> str:
    a, b = vector(old), vector(new)
    if a is None or b is None:
        return ""
    sizes = [float(np.linalg.norm(v)) for v in (a, b)]
    value = f"{sizes[0]:.4g} -> {sizes[1]:.4g} m/s^2{_percent(*sizes)}"
    turn = angle(a, b)
    if turn < 1e-9:
        return f"gravity {value}"
    same = abs(sizes[0] - sizes[1]) <= 1e-9 * max(sizes)
    return f"gravity turned by {_degrees(turn)}{'' if same else f', {value}'}"


def _platform_joint(old: Any, new: Any) -> str:
    kinds = [v.get("kind") if isinstance(v, Mapping) else v for v in (old, new)]
    return (
        "" if None in kinds or kinds[0] == kinds[1] else f"platform joint {kinds[0]} -> {kinds[1]}"
    )


def _limits(old: Any, new: Any) -> str:
    if not all(isinstance(v, list) and len(v) == 2 for v in (old, new)):
        return ""
    return f"displacement {old[0]:g} to {old[1]:g} -> {new[0]:g} to {new[1]:g}"


_OWN = {
    "symbols": _symbols,
    "actuated joint": _moved,
    "actuated": lambda old, new: _marked("actuated", old, new),
    "extra": lambda old, new: _marked("an extra coordinate", old, new),
    "name": _called,
    "inertia_about": _about,
    "gravity": _gravity,
    "displacement": _limits,
    "platform_joint": _platform_joint,
}


def count(key: Key) -> str:
    """A position as people count; other keys as they are."""
    return str(int(key) + 1) if str(key).isdigit() else str(key)


def axis_words(axis: Any) -> str:
    """The name of an axis, or its components."""
    if isinstance(axis, str):
        return axis
    own = vector(axis)
    for name in (*NAMED, *(f"-{letter}" for letter in NAMED)):
        if own is not None and np.array_equal(own, vector(name)):  # type: ignore[arg-type]
            return name
    return ", ".join(map(str, axis))


# ---- vectors, rotations, inertias -------------------------------------------------------------


def _turned(old: Any, new: Any) -> str:
    a, b = vector(old), vector(new)
    if a is None or b is None:
        if not all(isinstance(v, list) for v in (old, new)):
            return kind(old, new)
        return " -> ".join(", ".join(map(axis_words, v)) for v in (old, new))
    if np.abs(a + b).max() < 1e-9:
        return "flipped"
    return f"turned by {_degrees(angle(a, b))}"


def _shifted(old: Any, new: Any) -> str:
    a, b = (vector(v) if v is not None else np.zeros(3) for v in (old, new))
    if a is None or b is None:
        return kind(old, new)
    if not a.any():
        return f"set to {_length(b)} from zero"
    if not b.any():
        return f"removed, was {_length(a)}"
    off = ",".join(n for n, x, y in zip("xyz", a, b, strict=True) if x == 0.0 and y != 0.0)
    return f"moved by {_length(b - a)}{f', off zero in {off}' if off else ''}"


def _rotated(old: Any, new: Any) -> str:
    a, b = matrix(old), matrix(new)
    if a is None or b is None:
        return kind(old, new)
    step = float(np.linalg.norm(b - a))
    return f"turned by {_degrees(2.0 * math.asin(min(1.0, step / math.sqrt(8.0))))}"


def _inertia(old: Any, new: Any) -> str:
    a, b = tensor(old), tensor(new)
    if a is None or b is None:
        return kind(old, new)
    products = [np.triu(t, 1).any() for t in (a, b)]
    if products[0] != products[1]:
        return "now full (products of inertia)" if products[1] else "no longer full"
    if not a.any():
        return "set, from zero"
    return f"changed by up to {100.0 * np.abs(b - a).max() / np.abs(a).max():.3g} %"


_GEOMETRY = {
    **dict.fromkeys(("axis", "axes", "axis_link", "axis_platform"), _turned),
    **dict.fromkeys(("base_point", "platform_point", "offset", "fixed_centre", CENTRE), _shifted),
    **dict.fromkeys(("base_frame", "rotation"), _rotated),
    "inertia": _inertia,
}


def _percent(old: float, new: float) -> str:
    """How much larger; as a factor where a percentage is hard to read."""
    if not old:
        return ""
    ratio = new / old
    if ratio >= 10.0:
        return f" ({ratio:.3g} times)"
    return f" ({100.0 * (new - old) / abs(old):+.3g} %)"


def _length(way: Array) -> str:
    metres = float(np.linalg.norm(way))
    return f"{1000.0 * metres:.3g} mm" if metres < 1.0 else f"{metres:.4g} m"


def _degrees(turn: float) -> str:
    return f"{math.degrees(turn):.3g} degrees"
