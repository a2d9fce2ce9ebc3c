"""Joints of a leg: one-degree-of-freedom joints, and sequences that stand for U, C, S."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any

from pne_sym.model.body import MASSLESS, read_body
from pne_sym.model.effects import Friction
from pne_sym.model.entry import Entry, Table
from pne_sym.model.errors import SpecError
from pne_sym.model.joint_kinds import WrittenJoint
from pne_sym.model.kind import letters
from pne_sym.model.manipulator import ZERO3, Joint, PlatformJoint, Vector3
from pne_sym.model.names import read_part_name
from pne_sym.model.platform_kinds import PlatformJointKind
from pne_sym.model.read_effects import FIELDS as EFFECTS
from pne_sym.model.read_effects import read_effects, read_friction
from pne_sym.model.spherical import USUAL
from pne_sym.model.values import ROUNDING, axis, flags, number, offset, rotation

FIELDS = (
    "kind", "axis", "axes", "offset", "pitch", "actuated", "extra", "link", *EFFECTS, "name"
)  # fmt: skip
PLATFORM_FIELDS = ("kind", "offset", "axis_link", "axis_platform", "rotation", "friction")
MAX_JOINTS = 12

_OUT_OF_PLANE: Vector3 = (0.0, 0.0, 1.0)


def read_joint(entry: Entry, *, plane: bool) -> tuple[Joint, ...]:
    """The one-degree-of-freedom joints that a joint of the specification stands for.

    U, C and S become R R, R P and R R R at one point, with massless links
    between; the link given belongs to the last.

    Args:
        entry: a table of `FIELDS`.
        plane: motion in the plane z = 0.

    Raises:
        SpecError: a value or a combination without meaning.
    """
    table = entry.table(FIELDS)
    kind = _kind(table, plane=plane)
    kinds = kind.parts
    axes = _axes(table, kind, plane=plane)
    actuated = flags(table.get("actuated"), len(kinds))
    extra = flags(table.get("extra"), len(kinds))
    first_offset = table.read("offset", partial(offset, plane=plane), ZERO3)
    last_link = table.read("link", partial(read_body, plane=plane), MASSLESS)
    pitch = _pitch(table, kind)
    effects = read_effects(table, actuated, mixed=len(set(kinds)) > 1)
    names = _names(table.get("name"), len(kinds))
    last = len(kinds) - 1
    return tuple(
        Joint(
            kind=kinds[i],
            axis=axes[i],
            offset=first_offset if i == 0 else ZERO3,
            pitch=pitch,
            actuated=actuated[i],
            extra=extra[i],
            link=last_link if i == last else MASSLESS,
            name=names[i],
            **vars(effects[i]),
        )
        for i in range(len(kinds))
    )


def _kind(table: Table, *, plane: bool) -> WrittenJoint:
    known = [kind.letter for kind in WrittenJoint]
    kind = WrittenJoint(table.require("kind", letters(WrittenJoint)).choice(known))
    if plane and not kind.in_plane:
        flat = letters(each for each in WrittenJoint if each.in_plane)
        raise table.fields["kind"].fault(f"{flat}: other joints leave the plane")
    return kind


def _names(entry: Entry | None, count: int) -> list[str]:
    """For each degree of freedom: a list, or one name, numbered where they are several."""
    if entry is None:
        return [""] * count
    if isinstance(entry.value, list | tuple):
        entries = entry.items()
        if len(entries) != count:
            raise entry.fault(f"a name, or a list of {count}: one for each degree of freedom")
        return [read_part_name(each) for each in entries]
    name = read_part_name(entry)
    return [name] if count == 1 else [f"{name}_{k}" for k in range(1, count + 1)]


def read_platform_joint(entry: Entry, *, plane: bool) -> PlatformJoint:
    """The joint that closes a leg: its kind alone as a string, or a table.

    Raises:
        SpecError: a field that the kind needs is missing, or one that it has not.
    """
    if isinstance(entry.value, str):
        entry = Entry(entry.source, entry.where, {"kind": entry.value})
    table = entry.table(PLATFORM_FIELDS)
    known = [kind.letter for kind in PlatformJointKind]
    kind = PlatformJointKind(table.require("kind", letters(PlatformJointKind)).choice(known))
    point = table.read("offset", partial(offset, plane=plane), ZERO3)
    friction = _friction(table, kind)
    if plane:
        return replace(_planar_platform_joint(table, kind, point), friction=friction)
    if "axis_link" not in kind.fields:
        axes = "axis_link", "axis_platform"
        table.refuse(axes, f"a platform joint of kind {kind} has no axis")
    if "rotation" not in kind.fields:
        table.refuse(("rotation",), _NO_ROTATION)
    stated = {name: _stated(table, name) for name in kind.fields}
    return PlatformJoint(kind, point, **stated, friction=friction)


def _friction(table: Table, kind: PlatformJointKind) -> Friction | None:
    entry = table.get("friction")
    if entry is None or entry.value is False:
        return None
    if len(kind.right_angles) == len(_OUT_OF_PLANE):
        raise entry.fault(f"none: a platform joint of kind {kind} does not turn")
    return read_friction(entry)


_NO_ROTATION = "only a rigid platform joint has it"
_STATED = {
    "axis_link": "a unit vector in the last link's frame",
    "axis_platform": "a unit vector in the platform frame",
    "rotation": "platform axes in the last link's frame",
}


def _stated(table: Table, name: str) -> Any:
    """A direction, or a rotation, that a platform joint needs."""
    entry = table.require(name, _STATED[name])
    return rotation(entry) if name == "rotation" else axis(entry)


def _planar_platform_joint(table: Table, kind: PlatformJointKind, point: Vector3) -> PlatformJoint:
    """In the plane R and S mean the same: the points coincide; the axis is (0, 0, 1)."""
    if not kind.in_plane:
        raise table.fields["kind"].fault("R or S: in the plane the legs are pinned")
    table.refuse(("rotation",), _NO_ROTATION)
    for name in ("axis_link", "axis_platform"):
        given = table.get(name)
        if given and axis(given) != _OUT_OF_PLANE:
            raise given.fault("(0, 0, 1) or nothing: the axis is normal to the plane")
    return PlatformJoint(kind, point)


def _axes(table: Table, kind: WrittenJoint, *, plane: bool) -> tuple[Vector3, ...]:
    """The axis of each degree of freedom."""
    if kind.crossed:
        table.refuse(("axis",), f"a joint of kind {kind} has axes = [...]")
        return _perpendicular(table, len(kind.parts))
    table.refuse(("axes",), f"a joint of kind {kind} has one axis")
    given = table.get("axis")
    if plane and kind.implied:
        if given and axis(given) != _OUT_OF_PLANE:
            raise given.fault("(0, 0, 1): revolute axes are normal to the plane z = 0")
        return (_OUT_OF_PLANE,)
    along = axis(table.require("axis", 'a unit vector such as "x" or [1, 0, 0]'), plane=plane)
    if plane and along[2] != 0.0:
        raise table.fields["axis"].fault("a direction in the plane z = 0")
    return (along,) * len(kind.parts)


def _perpendicular(table: Table, count: int) -> tuple[Vector3, ...]:
    """Axes of a universal or spherical joint, each perpendicular to the next.

    Of a spherical one they may be left out: `legs` then chooses by what follows.
    """
    if count == len(USUAL) and table.get("axes") is None:
        return USUAL
    entry = table.require("axes", f"a list of {count} unit vectors, from the base side")
    items = entry.items()
    if len(items) != count:
        raise entry.fault(f"{count} unit vectors, from the base side ({len(items)} given)")
    axes = tuple(axis(item) for item in items)
    for a, b in pairwise(axes):
        if abs(sum(x * y for x, y in zip(a, b, strict=True))) > ROUNDING:
            raise entry.fault(
                "axes perpendicular to the next; write single R joints for a skew joint"
            )
    return axes


def _pitch(table: Table, kind: WrittenJoint) -> float:
    """The advance per angle, m/rad: only a joint that turns and slides has one."""
    if kind.pitched:
        entry = table.require("pitch", "the advance per angle, m/rad")
        pitch = number(entry)
        if pitch == 0.0:
            raise entry.fault("a pitch other than zero; without advance the joint is of kind R")
        return pitch
    given = table.get("pitch")
    if given and number(given) != 0.0:
        pitched = letters(each for each in WrittenJoint if each.pitched)
        raise given.fault(f"no pitch: the joint is of kind {kind}, not {pitched}")
    return 0.0


def check_count(entry: Entry, count: int) -> None:
    """Refuse a chain that is empty or absurdly long.

    Raises:
        SpecError: no joint, or more than `MAX_JOINTS`.
    """
    if not 1 <= count <= MAX_JOINTS:
        expected = f"1 to {MAX_JOINTS} joints with one degree of freedom each"
        raise SpecError(entry.source, entry.where, f"{count} joints", expected)
