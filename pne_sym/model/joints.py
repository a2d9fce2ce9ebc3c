"""Joints of a leg: one-freedom joints, and sequences that stand for U, C, S."""

from __future__ import annotations

from itertools import pairwise

from pne_sym.model.body import MASSLESS, read_body
from pne_sym.model.entry import Entry, Table
from pne_sym.model.errors import SpecError
from pne_sym.model.manipulator import (
    ZERO3,
    Joint,
    JointKind,
    PlatformJoint,
    PlatformJointKind,
    Vector3,
)
from pne_sym.model.values import ROUNDING, axis, flags, number, offset, rotation

FIELDS = ("kind", "axis", "axes", "offset", "pitch", "actuated", "extra", "link")
PLATFORM_FIELDS = ("kind", "offset", "axis_link", "axis_platform", "rotation")
MAX_JOINTS = 12

KINDS: dict[str, tuple[JointKind, ...]] = {
    "R": (JointKind.REVOLUTE,),
    "P": (JointKind.PRISMATIC,),
    "H": (JointKind.HELICAL,),
    "U": (JointKind.REVOLUTE, JointKind.REVOLUTE),
    "C": (JointKind.REVOLUTE, JointKind.PRISMATIC),
    "S": (JointKind.REVOLUTE, JointKind.REVOLUTE, JointKind.REVOLUTE),
}
"""Kinds of joints, and the freedoms that each stands for."""
_OUT_OF_PLANE: Vector3 = (0.0, 0.0, 1.0)


def read_joint(entry: Entry, *, plane: bool) -> tuple[Joint, ...]:
    """The one-freedom joints that a joint of the specification stands for.

    U, C and S become R R, R P and R R R at one point, with massless links
    between; the link given belongs to the last.

    Args:
        entry: a table of `FIELDS`.
        plane: motion in the plane z = 0.

    Raises:
        SpecError: a value or a combination without meaning.
    """
    table = entry.table(FIELDS)
    kind = table.require("kind", "R, P, H, U, C or S").choice(tuple(KINDS))
    kinds = KINDS[kind]
    if plane and kind not in ("R", "P"):
        raise table.fields["kind"].fault("R or P: other joints leave the plane")
    axes = _axes(table, kind, plane=plane)
    actuated = flags(table.get("actuated"), len(kinds))
    extra = flags(table.get("extra"), len(kinds))
    start = table.get("offset")
    first_offset = offset(start, plane=plane) if start else ZERO3
    link = table.get("link")
    last_link = read_body(link, plane=plane) if link else MASSLESS
    pitch = _pitch(table, kind)
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
        )
        for i in range(len(kinds))
    )


def read_platform_joint(entry: Entry, *, plane: bool) -> PlatformJoint:
    """The joint that closes a leg: its kind alone as a string, or a table.

    Raises:
        SpecError: a field that the kind needs is missing, or one that it has not.
    """
    if isinstance(entry.value, str):
        entry = Entry(entry.source, entry.where, {"kind": entry.value})
    table = entry.table(PLATFORM_FIELDS)
    kind = PlatformJointKind(
        table.require("kind", "S, R, U or rigid").choice([k.value for k in PlatformJointKind])
    )
    start = table.get("offset")
    point = offset(start, plane=plane) if start else ZERO3
    if plane:
        return _planar_platform_joint(table, kind, point)
    if kind in (PlatformJointKind.REVOLUTE, PlatformJointKind.UNIVERSAL):
        table.refuse(("rotation",), "only a rigid platform joint has it")
        in_link = axis(table.require("axis_link", "a unit vector in the last link's frame"))
        in_platform = axis(table.require("axis_platform", "a unit vector in the platform frame"))
        return PlatformJoint(kind, point, in_link, in_platform)
    table.refuse(("axis_link", "axis_platform"), f"a platform joint of kind {kind} has no axis")
    if kind is PlatformJointKind.RIGID:
        turned = table.require("rotation", "platform axes in the last link's frame")
        return PlatformJoint(kind, point, rotation=rotation(turned))
    table.refuse(("rotation",), "only a rigid platform joint has it")
    return PlatformJoint(kind, point)


def _planar_platform_joint(table: Table, kind: PlatformJointKind, point: Vector3) -> PlatformJoint:
    """In the plane R and S mean the same: the points coincide; the axis is (0, 0, 1)."""
    if kind not in (PlatformJointKind.REVOLUTE, PlatformJointKind.SPHERICAL):
        raise table.fields["kind"].fault("R or S: in the plane the legs are pinned")
    table.refuse(("rotation",), "only a rigid platform joint has it")
    for name in ("axis_link", "axis_platform"):
        given = table.get(name)
        if given and axis(given) != _OUT_OF_PLANE:
            raise given.fault("(0, 0, 1) or nothing: the axis is normal to the plane")
    return PlatformJoint(kind, point)


def _axes(table: Table, kind: str, *, plane: bool) -> tuple[Vector3, ...]:
    """The axis of each freedom."""
    if kind in ("U", "S"):
        table.refuse(("axis",), f"a joint of kind {kind} has axes = [...]")
        return _perpendicular(table, 2 if kind == "U" else 3)
    table.refuse(("axes",), f"a joint of kind {kind} has one axis")
    given = table.get("axis")
    if plane and kind == "R":
        if given and axis(given) != _OUT_OF_PLANE:
            raise given.fault("(0, 0, 1): revolute axes are normal to the plane z = 0")
        return (_OUT_OF_PLANE,)
    along = axis(table.require("axis", 'a unit vector such as "x" or [1, 0, 0]'), plane=plane)
    if plane and along[2] != 0.0:
        raise table.fields["axis"].fault("a direction in the plane z = 0")
    return (along,) * len(KINDS[kind])


def _perpendicular(table: Table, count: int) -> tuple[Vector3, ...]:
    """Axes of a universal or spherical joint, each perpendicular to the next."""
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


def _pitch(table: Table, kind: str) -> float:
    """The advance per angle, m/rad: only a helical joint has one."""
    if kind == "H":
        entry = table.require("pitch", "the advance per angle, m/rad")
        pitch = number(entry)
        if pitch == 0.0:
            raise entry.fault("a pitch other than zero; without advance the joint is of kind R")
        return pitch
    given = table.get("pitch")
    if given and number(given) != 0.0:
        raise given.fault(f"no pitch: the joint is of kind {kind}, not H")
    return 0.0


def check_count(entry: Entry, count: int) -> None:
    """Refuse a chain that is empty or absurdly long.

    Raises:
        SpecError: no joint, or more than `MAX_JOINTS`.
    """
    if not 1 <= count <= MAX_JOINTS:
        expected = f"1 to {MAX_JOINTS} joints with one freedom each"
        raise SpecError(entry.source, entry.where, f"{count} joints", expected)
