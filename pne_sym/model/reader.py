"""The reader of specifications: TOML or JSON, shorthand or full form.

Warnings are issued as `SpecWarning` through `warnings.warn`.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path

from pne_sym.model.body import FIELDS as BODY_FIELDS
from pne_sym.model.body import read_body
from pne_sym.model.coupling import read_coupling
from pne_sym.model.entry import Entry, Table
from pne_sym.model.errors import SpecError, printable, show
from pne_sym.model.files import parse, read_file
from pne_sym.model.full_form import to_full_form
from pne_sym.model.home import read_home
from pne_sym.model.legs import is_plane, read_legs
from pne_sym.model.limits import check_limits
from pne_sym.model.manipulator import ZERO3, Body, Home, Leg, Manipulator, Space, Vector3
from pne_sym.model.names import read_name
from pne_sym.model.symbols import read_symbols
from pne_sym.model.values import vector

FIELDS = (
    "name",
    "title",
    "space",
    "gravity",
    "fixed_centre",
    "moving_base",
    "coupling",
    "platform",
    "leg_types",
    "legs",
    "home",
    "symbols",
)
PLATFORM_FIELDS = (*BODY_FIELDS, "payload")
LONGEST_TITLE = 120
STANDARD_GRAVITY = 9.81

__all__ = ["checked", "from_mapping", "from_text", "read_spec", "to_full_form"]


def read_spec(path: Path) -> Manipulator:
    """Read a specification file.

    Args:
        path: a `.toml` or `.json` file.

    Raises:
        SpecError: the file is at fault: one message with file, field, value
            and what is allowed.
    """
    return from_text(read_file(path), path.suffix, str(path))


def from_text(text: str, suffix: str, source: str) -> Manipulator:
    """Read a specification from text.

    Args:
        text: TOML or JSON.
        suffix: `.toml` or `.json`.
        source: what to call it in messages.

    Raises:
        SpecError: the text is at fault.
    """
    data = parse(text, suffix, source)
    if not isinstance(data, Mapping):
        raise Entry(source, "", data).fault("a table with name, space, platform, legs, home")
    return from_mapping(data, source)


def from_mapping(data: Mapping[str, object], source: str) -> Manipulator:
    """Read a specification from plain tables, lists, numbers and strings.

    Args:
        data: as parsed from TOML or JSON.
        source: what to call it in messages.

    Raises:
        SpecError: a field is at fault.
    """
    table = Entry(source, "", data).table(FIELDS)
    name = read_name(table.require("name", "its name, such as my_robot"))
    spaces = [space.value for space in Space]
    space = Space(table.require("space", f"one of {', '.join(spaces)}").choice(spaces))
    legs = read_legs(table.require("legs", "a list of legs"), table.get("leg_types"), space)
    centre = _fixed_centre(table, space)
    at_home = table.require("home", "a pose X and displacements q")
    return Manipulator(
        name=name,
        title=_title(table, name),
        space=space,
        gravity=_gravity(table, space),
        platform=_platform(table, space),
        payload=_payload(table, space),
        legs=legs,
        fixed_centre=centre,
        symbols=read_symbols(table.get("symbols")),
        moving_base=table.read("moving_base", Entry.flag, False),
        coupling=read_coupling(table.get("coupling"), legs),
        home=_home(at_home, space, legs, centre),  # last: what is found is told
    )


def _home(entry: Entry, space: Space, legs: tuple[Leg, ...], centre: Vector3 | None) -> Home:
    """Pose and displacements, within the limits of the joints."""
    home = read_home(entry, space, legs, centre)
    check_limits(entry, home, legs)
    return home


def checked(manipulator: Manipulator) -> Manipulator:
    """A manipulator built in Python, validated and normalised like one that is read.

    Raises:
        SpecError: a field is at fault.
    """
    try:
        form = to_full_form(manipulator)
        source = f"Manipulator({show(manipulator.name)})"
    except (AttributeError, TypeError, ValueError) as error:
        raise SpecError(
            show(manipulator),
            "",
            printable(f"not a manipulator: {error}"),
            "Manipulator and its parts, of tuples of numbers",
        ) from error
    return from_mapping(form, source)


def _title(table: Table, name: str) -> str:
    entry = table.get("title")
    if entry is None:
        return name
    title = entry.text()
    if not 1 <= len(title) <= LONGEST_TITLE or not title.isprintable():
        raise entry.fault(f"one line of 1 to {LONGEST_TITLE} printable characters")
    return title


def _gravity(table: Table, space: Space) -> Vector3:
    g, plane = -STANDARD_GRAVITY, is_plane(space)
    down = (0.0, g, 0.0) if plane else (0.0, 0.0, g)
    return table.read("gravity", partial(vector, plane=plane), down)


def _platform(table: Table, space: Space) -> Body:
    entry = table.require("platform", "a table with mass, centre_of_mass, inertia")
    return _at_output(entry, read_body(entry, plane=is_plane(space), also=("payload",)), space)


def _payload(table: Table, space: Space) -> Body | None:
    """The second body of the platform, or None."""
    entry = table.require("platform", "a table").table(PLATFORM_FIELDS).get("payload")
    if entry is None or entry.value is False:
        return None
    return _at_output(entry, read_body(entry, plane=is_plane(space)), space)


def _at_output(entry: Entry, body: Body, space: Space) -> Body:
    """The body; in the space of a point it is there."""
    if space is Space.POINT and body.centre_of_mass != ZERO3:
        raise Entry(entry.source, f"{entry.where}.centre_of_mass", list(body.centre_of_mass)).fault(
            "(0, 0) or nothing: in the space 'point' the platform is the output point"
        )
    return body


def _fixed_centre(table: Table, space: Space) -> Vector3 | None:
    if space is Space.SPHERICAL:
        return vector(table.require("fixed_centre", "the centre of rotation, base frame (m)"))
    table.refuse(("fixed_centre",), f"the space '{space}' has none, only 'spherical'")
    return None
