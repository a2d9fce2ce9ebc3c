"""The starter as commented TOML, and its file."""

from __future__ import annotations

import os
import tempfile
import textwrap
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from pne_sym.mechanics.mobility import mobility
from pne_sym.model.entry import Entry, nearest
from pne_sym.model.errors import SpecError, SpecNote, show
from pne_sym.model.legs import is_plane
from pne_sym.model.manipulator import Manipulator, Space
from pne_sym.model.names import read_name
from pne_sym.model.reader import from_mapping, from_text
from pne_sym.starter.actuators import check_actuators
from pne_sym.starter.chain import Plain
from pne_sym.starter.layout import Plan, default_space, make_plan
from pne_sym.starter.notation import LegGroup, parse_legs
from pne_sym.starter.place import leg_names
from pne_sym.starter.points import Geometry
from pne_sym.starter.words import HEAD, HOME, LEGS, SPACES, joint_comment

SUFFIX = ".toml"
_UNITS = {
    "mass": "kg",
    "centre_of_mass": "m",
    "inertia": "kg m^2",
    "offset": "m",
    "pitch": "m/rad",
    "base_point": "m",
    "platform_point": "m",
}


def write_starter(
    path: Path,
    legs: str,
    space: str | None = None,
    geometry: Geometry | None = None,
    *,
    force: bool = False,
) -> Manipulator:
    """Write a first specification; return the manipulator that it describes.

    Args:
        path: a `.toml` file to be; its stem becomes the manipulator's name.
        legs: the architecture, such as 6-UPS.
        space: the task space; default: the plane where the legs fit it, else space.
        geometry: where the legs stand; default: evenly around the platform.
        force: replace a file that stands there.

    Raises:
        SpecError: the name, the architecture, the space or the points are at fault; the
            actuators are not what the degrees of freedom ask for; the method does not cover it; the
            file stands there already, or cannot be written.
    """
    where = str(path)
    if path.suffix != SUFFIX:
        raise SpecError(where, "", f"file of kind {show(path.suffix)}", "a .toml file")
    name = read_name(Entry(where, "", path.stem))
    if (path.exists() or path.is_symlink()) and not force:
        raise SpecError(where, "", "the file exists", "another name, or --force to replace it")
    from pne_sym.mechanics.derive import derive  # noqa: PLC0415 - brings SymPy

    text = starter_text(name, legs, space, geometry)
    manipulator = from_text(text, SUFFIX, where)
    told = check_actuators(manipulator, parse_legs(legs))
    derive(manipulator)  # what the method does not cover is refused now, not at generation
    try:
        _write(path, text, replace=force)
    except FileExistsError:
        raise SpecError(where, "", "the file exists", "another name, or --force") from None
    except OSError as error:
        raise SpecError(where, "", f"cannot be written: {error.strerror}") from None
    if told:
        warnings.warn(told, SpecNote, stacklevel=2)
    return manipulator


def starter_text(
    name: str, legs: str, space: str | None = None, geometry: Geometry | None = None
) -> str:
    """The text of a first specification.

    Raises:
        SpecError: the architecture, the space or the points are at fault.
    """
    groups = parse_legs(legs)
    chosen = _space(space) if space is not None else default_space(groups)
    architecture = "+".join(f"{group.count}-{group.plain}" for group in groups)
    adjective = "planar-point" if chosen is Space.POINT else str(chosen)
    title = f"{adjective} {architecture} manipulator"
    points = geometry.points(groups, chosen) if geometry else None
    plan = make_plan(name, title[:1].upper() + title[1:120], groups, chosen, points)
    return "\n".join(_lines(plan, chosen)) + "\n"


def _space(text: str) -> Space:
    known = [space.value for space in Space]
    if text not in known:
        raise SpecError(
            "--space", "", f"value {show(text)}", f"one of {', '.join(known)}{nearest(text, known)}"
        )
    return Space(text)


def _write(path: Path, text: str, *, replace: bool) -> None:
    """All of the text or no file; what stands there is replaced only if that is wanted."""
    handle, name = tempfile.mkstemp(prefix=".", suffix=".part", dir=path.parent)
    part = Path(name)
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            stream.write(text)
        part.chmod(0o644)
        if replace:
            part.replace(path)
        else:
            path.hardlink_to(part)
    finally:
        part.unlink(missing_ok=True)


def _lines(plan: Plan, space: Space) -> Iterator[str]:
    spec = plan.spec
    yield f"# {spec['title']}"
    yield from HEAD
    found = mobility(from_mapping(spec, "starter"))
    yield from textwrap.wrap(f"# {found}.", 96, subsequent_indent="# ")
    yield ""
    yield f"name = {_value(spec['name'])}  # of files, modules and prefixes"
    yield f"title = {_value(spec['title'])}"
    yield f"space = {_value(spec['space'])}  # {SPACES[space]}"
    yield f"gravity = {_value(spec['gravity'])}  # m/s^2, base frame"
    if "fixed_centre" in spec:
        yield f"fixed_centre = {_value(spec['fixed_centre'])}  # m, base frame"
    yield ""
    yield from _platform(spec["platform"], space)
    for name, group in zip(leg_names(plan.groups), plan.groups, strict=True):
        yield ""
        yield from _leg_type(name, group, plan)
    yield ""
    yield from LEGS[is_plane(space)]
    for leg in spec["legs"]:
        yield "[[legs]]"
        yield from _fields(leg, _UNITS)
        yield ""
    yield "[home]"
    yield from HOME
    yield f"X = {_value(spec['home']['X'])}"
    yield "q = ["
    for row in spec["home"]["q"]:
        yield f"    {_value(row)},"
    yield "]"


def _platform(fields: Plain, space: Space) -> Iterator[str]:
    yield "[platform]"
    if space is Space.POINT:
        yield "# A payload at the output point."
    moments = "izz" if is_plane(space) else "ixx, iyy, izz"
    own = {"centre_of_mass": "m, platform frame", "inertia": f"kg m^2: {moments}"}
    yield from _fields(fields, _UNITS | own)


def _leg_type(name: str, group: LegGroup, plan: Plan) -> Iterator[str]:
    fields = plan.spec["leg_types"][name]
    shape = plan.shapes[plan.groups.index(group)]
    count = f"{group.count} leg{'s' if group.count > 1 else ''}"
    yield f"# {group.plain}, from the base to the platform joint: shared by {count}."
    yield f"[leg_types.{name}]"
    yield f"platform_joint = {_value(fields['platform_joint'])}"
    for written, joint in zip(shape.chain.joints, fields["joints"], strict=True):
        yield ""
        yield f"[[leg_types.{name}.joints]]"
        yield from joint_comment(written.comment, joint)
        yield from _fields(joint, _UNITS)


def _fields(table: Plain, units: Mapping[str, str]) -> Iterator[str]:
    """Fields one a line; those of inner tables dotted."""
    for name, value in table.items():
        if isinstance(value, dict) and name in ("link", "platform_joint"):
            inner = {f"{name}.{key}": item for key, item in value.items()}
        else:
            inner = {name: value}
        for key, item in inner.items():
            unit = units.get(key.rpartition(".")[2], "")
            yield f"{key} = {_value(item)}" + (f"  # {unit}" if unit else "")


def _value(value: Any) -> str:
    """A value in TOML, on one line; strings here are of letters the writer chose itself."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return repr(round(value, 9) + 0.0)
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_value(item)}" for key, item in value.items()) + " }"
    return "[" + ", ".join(_value(item) for item in value) + "]"
