"""Legs of a specification: written out, or of a shared type with own geometry."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import replace
from functools import partial

from pne_sym.model.entry import Entry, Table, nearest
from pne_sym.model.errors import SpecError, SpecWarning
from pne_sym.model.joints import FIELDS as JOINT_FIELDS
from pne_sym.model.joints import check_count, read_joint, read_platform_joint
from pne_sym.model.leg_types import Key, named_structures, structure_key
from pne_sym.model.manipulator import (
    IDENTITY3,
    ZERO3,
    Joint,
    Leg,
    PlatformJoint,
    PlatformJointKind,
    Space,
)
from pne_sym.model.names import read_part_name, read_type_name, refuse_twice
from pne_sym.model.spherical import USUAL, with_axes
from pne_sym.model.values import rotation, vector

FIELDS = (
    "type", "base_point", "base_frame", "joints", "platform_joint", "platform_point", "name"
)  # fmt: skip
TYPE_FIELDS = ("joints", "platform_joint")
MAX_LEGS = 128

_LegTypes = Mapping[str, Table]


def is_plane(space: Space) -> bool:
    """Whether the mechanism moves in the plane z = 0."""
    return space in (Space.POINT, Space.PLANAR)


def read_legs(legs: Entry, leg_types: Entry | None, space: Space) -> tuple[Leg, ...]:
    """All legs, with leg types and overrides expanded.

    Args:
        legs: a list of tables of `FIELDS`.
        leg_types: tables of `TYPE_FIELDS` by name, if any.
        space: the task space.

    Raises:
        SpecError: what cannot be expanded or has no meaning.
    """
    types = _leg_types(leg_types)
    entries = legs.items()
    if not 1 <= len(entries) <= MAX_LEGS:
        raise legs.fault(f"1 to {MAX_LEGS} legs", problem=f"{len(entries)} legs")
    used: set[str] = set()
    result = tuple(_read_leg(entry, types, used, space) for entry in entries)
    refuse_twice(legs, [leg.name for leg in result], "leg")
    for name in types.keys() - used:
        types[name].entry.warn(": no leg is of this type")
    return _typed(legs, result, {name: _structure(table, space) for name, table in types.items()})


def _typed(
    legs: Entry, read: tuple[Leg, ...], written: Mapping[str, Key | None]
) -> tuple[Leg, ...]:
    """The legs with the names of their structures for those of their types."""
    structures = named_structures(read, written)
    names = [structure.name for structure in structures if structure.name]
    for structure in structures:
        if names.count(structure.name) > 1:
            raise legs.fault(
                "another name for a leg or a leg type",
                problem=f"legs of two structures would be of the type '{structure.name}'",
            )
    called = [
        f"{leg.name or f'leg{i}'}_{joint.name or f'joint{j}'}"
        for i, leg in enumerate(read, 1)
        for j, joint in enumerate(leg.joints, 1)
    ]
    if len(set(called)) < len(called):
        twice = next(name for name in called if called.count(name) > 1)
        problem = f"two joints would be called '{twice}'"
        raise legs.fault("other names for a leg or a joint", problem=problem)
    found = {i: structure.name for structure in structures for i in structure.indices}
    return tuple(replace(leg, type=found[i]) for i, leg in enumerate(read))


def _structure(shared: Table, space: Space) -> Key | None:
    """The structure of a leg type as it is written; None where legs have to complete it."""
    plane = is_plane(space)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SpecWarning)  # they come with the legs
            bare = Table(shared.entry, {})
            end = _platform_joint(bare, shared, space)
            joints = _joints(bare, shared, end, plane=plane)
    except SpecError:
        return None
    return structure_key(Leg(ZERO3, IDENTITY3, joints, end, ZERO3))


def _leg_types(entry: Entry | None) -> _LegTypes:
    if entry is None:
        return {}
    return {read_type_name(named, name): named.table(TYPE_FIELDS) for name, named in entry.named()}


def _read_leg(entry: Entry, types: _LegTypes, used: set[str], space: Space) -> Leg:
    table = entry.table(FIELDS)
    plane = is_plane(space)
    shared = _shared(table, types, used)
    end = _platform_joint(table, shared, space)
    return Leg(
        type=table.read("type", Entry.text, ""),
        name=table.read("name", read_part_name, ""),
        base_point=vector(table.require("base_point", "its position (m)"), plane=plane),
        base_frame=table.read("base_frame", partial(rotation, plane=plane), IDENTITY3),
        joints=_joints(table, shared, end, plane=plane),
        platform_joint=end,
        platform_point=_platform_point(table, space),
    )


def _shared(table: Table, types: _LegTypes, used: set[str]) -> Table | None:
    """The leg type that the leg names, or None."""
    entry = table.get("type")
    if entry is None:
        return None
    name = entry.text()
    own = table.get("joints")
    if not types and own is not None and isinstance(own.value, list | tuple):
        read_type_name(entry, name)  # of legs that are written out: a name, and nothing else
        return None
    if name not in types:
        known = ", ".join(list(types)[:10]) or "a table [leg_types.NAME] to be added"
        raise entry.fault(f"the name of a leg type: {known}{nearest(name, types)}")
    used.add(name)
    return types[name]


def _joints(
    table: Table, shared: Table | None, end: PlatformJoint, *, plane: bool
) -> tuple[Joint, ...]:
    own = table.get("joints")
    if own is not None and not isinstance(own.value, Mapping):
        source, entries = own, own.items()
    elif shared is None:
        source = own or table.require("joints", "a list of joints, or type = a leg type")
        entries = source.items()
    else:
        source = shared.require("joints", "a list of joints")
        entries = source.items()
        if own is not None:
            entries = _overridden(entries, own)
    check_count(source, len(entries))
    parts = [read_joint(entry, plane=plane) for entry in entries]
    for k in reversed(range(len(parts))):
        if len(parts[k]) == len(USUAL) and entries[k].table(JOINT_FIELDS).get("axes") is None:
            parts[k] = with_axes(parts[k], next(iter(parts[k + 1 : k + 2]), [None])[0], end)
    joints = tuple(joint for part in parts for joint in part)
    check_count(source, len(joints))
    refuse_twice(source, [joint.name for joint in joints], "joint")
    return joints


def _overridden(entries: list[Entry], own: Entry) -> list[Entry]:
    """Joints of a type with fields replaced by the leg's own tables `joints.0`, `joints.1` ..."""
    result = list(entries)
    numbers = {str(i): i for i in range(len(entries))}
    for name, entry in own.named():
        if name not in numbers:
            raise SpecError(
                own.source,
                own.where,
                f"unknown joint {name[:20]!r}",
                "a joint of the leg type, counted from 0: " + ", ".join(numbers),
            )
        index = numbers[name]
        result[index] = entry.over(entries[index])
    return result


def _platform_joint(table: Table, shared: Table | None, space: Space) -> PlatformJoint:
    own = table.get("platform_joint")
    common = shared.get("platform_joint") if shared else None
    if common and isinstance(common.value, str):
        common = replace(common, value={"kind": common.value})
    entry = own.over(common) if own else common
    if entry is None:
        return PlatformJoint(
            PlatformJointKind.REVOLUTE if is_plane(space) else PlatformJointKind.SPHERICAL
        )
    joint = read_platform_joint(entry, plane=is_plane(space))
    if joint.friction and space is Space.POINT:
        raise entry.fault("no friction: an output point does not turn")
    return joint


def _platform_point(table: Table, space: Space) -> tuple[float, float, float]:
    if space is not Space.POINT:
        entry = table.require("platform_point", "its position in the platform frame (m)")
        return vector(entry, plane=is_plane(space))
    given = table.get("platform_point")
    if given and vector(given, plane=True) != ZERO3:
        raise given.fault("(0, 0) or nothing: in the space 'point' all legs meet at the output")
    return ZERO3
