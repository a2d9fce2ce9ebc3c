"""What users of a model see of a change: parameters, defaults, coordinates, leg types."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from pne_sym.review.alignment import Alignment
from pne_sym.review.difference import Change, OperationChange
from pne_sym.review.manifests import COUNTS
from pne_sym.review.model import Model, paths_of

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
    yield from _parameters(before, after, alignment)
    if defaults:
        yield from _defaults(*defaults)
    yield from _legs(before, after, alignment)
    yield from _leg_types(before.manifest, after.manifest, alignment)
    for name in ("X", "V", "wrench"):
        a, b = (m.manifest["coordinates"][name] for m in (before, after))
        yield from _changed(f"coordinates {name}", ", ".join(a), ", ".join(b))
    if before.functions and after.functions:
        yield from _functions(before.functions, after.functions)
    for key in _PLAIN:
        yield from _changed(key, str(before.manifest.get(key)), str(after.manifest.get(key)))


def _changed(what: str, before: str, after: str) -> Iterator[Change]:
    if before != after:
        yield Change("changed", what, before, after)


def _parameters(before: Model, after: Model, alignment: Alignment) -> Iterator[Change]:
    """Parameters added, removed, renamed: the same where they stand at the same paths."""
    free = list(before.parameters)
    for parameter in after.parameters:
        partner = _partner(parameter, free, alignment)
        if partner is None:
            yield Change("added", f"parameter {parameter['name']}", after=_described(parameter))
            continue
        free.remove(partner)
        if partner["name"] != parameter["name"]:
            yield Change("renamed", "parameter", partner["name"], parameter["name"])
        yield from _changed(
            f"parameter {parameter['name']}", _described(partner), _described(parameter)
        )
    for parameter in free:
        yield Change("removed", f"parameter {parameter['name']}", before=_described(parameter))


def _functions(before: dict[str, Any], after: dict[str, Any]) -> Iterator[Change]:
    """Public functions and their arguments."""
    for name, function in after.items():
        if name not in before:
            yield Change("added", f"function {name}", after=_signature(function))
        else:
            yield from _changed(f"function {name}", _signature(before[name]), _signature(function))
    for name in (n for n in before if n not in after):
        yield Change("removed", f"function {name}", before=_signature(before[name]))


def _signature(function: dict[str, Any]) -> str:
    sides = [
        ", ".join(f"{n} ({size})" for n, size in function[side].items())
        for side in ("inputs", "outputs")
    ]
    return f"{sides[0]} -> {sides[1]}"


def _partner(
    parameter: dict[str, Any], among: list[dict[str, Any]], alignment: Alignment
) -> dict[str, Any] | None:
    paths = {alignment.canonical(path) for path in paths_of(parameter)}
    shared = [p for p in among if paths & set(paths_of(p))]
    named = [p for p in shared if p["name"] == parameter["name"]]
    return next(iter(named or shared), None)


def _described(parameter: dict[str, Any]) -> str:
    zeros = parameter.get("zero_by_structure")
    fixed = f", entries {zeros} zero by structure" if zeros else ""
    return f"{parameter['unit']}, shape {parameter['shape']}{fixed}"


def _defaults(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[Change]:
    for path, value in new.items():
        if path in old and not np.array_equal(old[path], value):
            yield Change("changed", f"default of {path}", _text(old[path]), _text(value))


def _text(value: Any) -> str:
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


def _leg_types(
    before: dict[str, Any], after: dict[str, Any], alignment: Alignment
) -> Iterator[Change]:
    """Leg types, matched by their legs."""
    old, new = ({t["name"]: t for t in m["leg_types"]} for m in (before, after))
    taken = set()
    for name, info in new.items():
        partner = alignment.types.get(name)
        if partner is None or partner in taken:
            yield Change("added", f"leg type {name}", after=_leg_type(info))
            continue
        taken.add(partner)
        if partner != name:
            yield Change("renamed", "leg type", partner, name)
        yield from _changed(f"leg type {name}", _leg_type(old[partner]), _leg_type(info))
    for name in (n for n in old if n not in taken):
        yield Change("removed", f"leg type {name}", before=_leg_type(old[name]))


def _leg_type(info: dict[str, Any]) -> str:
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
