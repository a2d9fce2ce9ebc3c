"""What users of a model see of a change: parameters, defaults, coordinates, leg types."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from pne_sym.review.alignment import Alignment
from pne_sym.review.difference import Change, OperationChange
from pne_sym.review.manifests import COUNTS
from pne_sym.review.model import Model, paths_of

Table = dict[str, Any]
Pair = tuple[Table | None, Table | None]
"""Before and after; None where there is no counterpart."""
_PLAIN = ("space", "sizes", "joints", "actuators", "extra", "constraints", "home")


def interface_changes(
    before: Model,
    after: Model,
    defaults: Sequence[Mapping[str, Any]],
    alignment: Alignment,
) -> Iterator[Change]:
    """All changes of the interface.

    Args:
        before: a version of the model.
        after: another.
        defaults: of both by the paths of the full form before; none where they are not known.
        alignment: of legs and joints.
    """
    yield from _matched("parameter", _parameters(before, after, alignment), _described)
    if defaults:
        yield from _defaults(*defaults)
    yield from _legs(before, after, alignment)
    leg_types = _leg_types(before.manifest, after.manifest, alignment)
    yield from _matched("leg type", leg_types, _leg_type)
    for name in ("X", "V", "wrench"):
        a, b = (m.manifest["coordinates"][name] for m in (before, after))
        yield from _changed(f"coordinates {name}", ", ".join(a), ", ".join(b))
    if before.functions and after.functions:
        yield from _matched("function", _functions(before, after), _signature)
    for key in _PLAIN:
        yield from _changed(key, str(before.manifest.get(key)), str(after.manifest.get(key)))


def _changed(what: str, before: str, after: str) -> Iterator[Change]:
    if before != after:
        yield Change("changed", what, before, after)


def _matched(
    kind: str, pairs: Iterable[Pair], described: Callable[[Table], str]
) -> Iterator[Change]:
    """Tables of a kind that are new, gone, renamed, or described otherwise."""
    for old, new in pairs:
        if old is None and new is not None:
            yield Change("added", f"{kind} {new['name']}", after=described(new))
        elif old is not None and new is None:
            yield Change("removed", f"{kind} {old['name']}", before=described(old))
        elif old is not None and new is not None:
            if old["name"] != new["name"]:
                yield Change("renamed", kind, old["name"], new["name"])
            yield from _changed(f"{kind} {new['name']}", described(old), described(new))


def _parameters(before: Model, after: Model, alignment: Alignment) -> Iterator[Pair]:
    """Parameters before and after: the same where they stand at the same paths."""
    free = list(before.parameters)
    for parameter in after.parameters:
        partner = _partner(parameter, free, alignment)
        if partner is not None:
            free.remove(partner)
        yield partner, parameter
    yield from ((parameter, None) for parameter in free)


def _functions(before: Model, after: Model) -> Iterator[Pair]:
    """Public functions, by their names."""
    old, new = ({n: {"name": n, **f} for n, f in m.functions.items()} for m in (before, after))
    yield from ((old.get(name), new.get(name)) for name in new | old)


def _signature(function: Table) -> str:
    sides = [
        ", ".join(f"{n} ({size})" for n, size in function[side].items())
        for side in ("inputs", "outputs")
    ]
    return f"{sides[0]} -> {sides[1]}"


def _partner(parameter: Table, among: list[Table], alignment: Alignment) -> Table | None:
    paths = {alignment.canonical(path) for path in paths_of(parameter)}
    shared = [p for p in among if paths & set(paths_of(p))]
    named = [p for p in shared if p["name"] == parameter["name"]]
    return next(iter(named or shared), None)


def _described(parameter: Table) -> str:
    zeros = parameter.get("zero_by_structure")
    fixed = f", entries {zeros} zero by structure" if zeros else ""
    return f"{parameter['unit']}, shape {parameter['shape']}{fixed}"


def _defaults(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[Change]:
    for path, value in new.items():
        if path in old and not np.array_equal(old[path], value):
            yield Change("changed", f"default of {path}", text_of(old[path]), text_of(value))


def text_of(value: Any) -> str:
    """Numbers of an array, or what stands for them."""
    return str(np.asarray(value).tolist())


def _legs(before: Model, after: Model, alignment: Alignment) -> Iterator[Change]:
    """Legs that stand at another place, or have no counterpart."""
    counts = [
        1 + max((leg for t in m.manifest["leg_types"] for leg in t["legs"]), default=-1)
        for m in (before, after)
    ]
    old = {k: str(k + 1) for k in range(counts[0])}
    now = [old.get(alignment.legs.get(k, -1), "new") for k in range(counts[1])]
    yield from _changed("legs", ", ".join(old.values()), ", ".join(now))


def _leg_types(before: Table, after: Table, alignment: Alignment) -> Iterator[Pair]:
    """Leg types, matched by their legs."""
    old, new = ({t["name"]: t for t in m["leg_types"]} for m in (before, after))
    for name, info in new.items():
        yield old.pop(alignment.types.get(name, ""), None), info
    yield from ((info, None) for info in old.values())


def _leg_type(info: Table) -> str:
    legs = ", ".join(str(leg + 1) for leg in info["legs"])
    branches = "; ".join(f"{n} {signs}" for n, signs in info["branches"].items())
    several = "s" * (len(info["legs"]) > 1)
    return f"{info['architecture']}, leg{several} {legs}" + (f"; {branches}" if branches else "")


def operation_changes(before: Model, after: Model) -> Iterator[OperationChange]:
    """Functions whose operation counts changed."""
    old, new = (m.manifest["operations"] for m in (before, after))
    for name in dict.fromkeys((*old, *new)):
        counts = [tuple(int(o.get(name, {}).get(c, 0)) for c in COUNTS) for o in (old, new)]
        if counts[0] != counts[1]:
            yield OperationChange(name, *counts)
