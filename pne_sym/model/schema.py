"""The specification format as a JSON Schema, for editors that complete and check.

The names of fields, kinds, spaces and the bounds are those of the reader: a field that the reader
does not know cannot stand here, and one that it knows cannot be missing.  What a schema cannot
say (closed loops, unit axes, physical inertias) only the reader checks.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from pne_sym.model import body, home, joints, legs, names, read_effects, reader, symbols, values
from pne_sym.model.joint_kinds import WrittenJoint
from pne_sym.model.manipulator import Space
from pne_sym.model.platform_kinds import PlatformJointKind
from pne_sym.model.schema_text import MEANING

Schema = dict[str, object]

ADDRESS = "https://json-schema.org/draft/2020-12/schema"
_NUMBER: Schema = {"type": "number", "minimum": -values.LARGEST, "maximum": values.LARGEST}
_POSITIVE: Schema = {"type": "number", "minimum": 0, "maximum": values.LARGEST}
_FLAG: Schema = {"type": "boolean"}
_NAME_PATTERN = f"^(?=.{{1,{names.LONGEST}}}$){names.GRAMMAR}$"
_PART: Schema = {
    "type": "string",
    "pattern": f"^(?=.{{1,{names.LONGEST_OF_PART}}}$){names.GRAMMAR}$",
}


def json_schema() -> Schema:
    """The schema, as plain data.

    >>> sorted(json_schema()["required"])
    ['home', 'legs', 'name', 'platform', 'space']
    """
    return {
        "$schema": ADDRESS,
        "title": "Specification of a parallel manipulator for pne_sym",
        "description": "TOML or JSON; SI units and radians. docs/spec-format.md explains it.",
        **_specification(),
        "$defs": {
            "number": _NUMBER,
            "vector": _list_of(_ref("number"), 2, 3),
            "rows": {"anyOf": [_rows(3), _rows(2)]},
            "axis": {"anyOf": [{"enum": list(values.DIRECTIONS)}, _ref("vector")]},
            "rotation": _rotation(),
            "body": _body(),
            "platform": _platform(),
            **_effects(),
            "joint": _joint(),
            "jointOverride": _override(joints.FIELDS, _joint_fields()),
            "platformJoint": _platform_joint(),
            "platformJointOverride": _override(joints.PLATFORM_FIELDS, _platform_joint_fields()),
            "legType": _leg_type(),
            "leg": _leg(),
            "home": _home(),
        },
    }


def schema_text() -> str:
    """The schema as the text of its file, docs/pne_sym.schema.json."""
    return json.dumps(json_schema(), indent=2, ensure_ascii=False) + "\n"


def _specification() -> Schema:
    spaces = [str(space) for space in Space]
    fields: dict[str, Schema] = {
        "name": {"type": "string", "pattern": _NAME_PATTERN, "not": {"enum": names.reserved()}},
        "title": {"type": "string", "minLength": 1, "maxLength": reader.LONGEST_TITLE},
        "space": {"enum": spaces},
        "gravity": _ref("vector"),
        "fixed_centre": _list_of(_ref("number"), 3),
        "moving_base": _FLAG,
        "coupling": {"anyOf": [_some(_some(_ref("number"))), {"const": False}]},
        "platform": _ref("platform"),
        "leg_types": {
            "type": "object",
            "propertyNames": {"pattern": _NAME_PATTERN},
            "additionalProperties": _ref("legType"),
        },
        "legs": {"type": "array", "items": _ref("leg"), "minItems": 1, "maxItems": legs.MAX_LEGS},
        "home": _ref("home"),
        "symbols": {
            "type": "object",
            "maxProperties": symbols.MOST,
            "additionalProperties": {"type": "string"},
        },
    }
    required = "name", "space", "platform", "legs", "home"
    table = _table("specification", reader.FIELDS, fields, required)
    space, centre = {"space": {"const": str(Space.SPHERICAL)}}, {"required": ["fixed_centre"]}
    spherical = {"properties": space, "required": ["space"]}
    return {**table, "if": spherical, "then": centre, "else": {"not": centre}}


def _body() -> Schema:
    triple = _list_of(_ref("number"), 3)
    components = {name: _ref("number") for name in body.COMPONENTS}
    fields: dict[str, Schema] = {
        "mass": _POSITIVE,
        "centre_of_mass": _ref("vector"),
        "inertia": {
            "anyOf": [
                triple,
                _rows(3),
                _rows(2),
                _POSITIVE,
                _object(components),
            ]
        },
        "inertia_about": {"enum": ["centre_of_mass", "origin"]},
    }
    table = _table("body", body.FIELDS, fields, ("mass",))
    return {**table, "dependentRequired": {"inertia_about": ["inertia"]}}


def _platform() -> Schema:
    """A body that may carry another one."""
    payload: Schema = {
        "anyOf": [_ref("body"), {"const": False}],
        "description": MEANING["platform"]["payload"],
    }
    table: Any = _body()
    return {**table, "properties": {**table["properties"], "payload": payload}}


def _joint_fields() -> dict[str, Schema]:
    flags: Schema = {"anyOf": [_FLAG, _list_of(_FLAG, 1, 3)]}
    return {
        "name": {"anyOf": [_PART, _list_of(_PART, 1, 3)]},
        "kind": {"enum": [kind.letter for kind in WrittenJoint]},
        "axis": _ref("axis"),
        "axes": _list_of(_ref("axis"), 2, 3),
        "offset": _ref("vector"),
        "pitch": _ref("number"),
        "actuated": flags,
        "extra": flags,
        "link": _ref("body"),
        **{name: _for_each(_ref(name)) for name in read_effects.FIELDS},
    }


def _for_each(item: Schema) -> Schema:
    """For all degrees of freedom of a joint, or a list with an entry for each; false: none."""
    none: Schema = {"const": False}
    return {"anyOf": [item, none, _list_of({"anyOf": [item, none]}, 1, 3)]}


def _effects() -> Schema:
    """Friction, spring, motor and limits of a joint."""
    number, least = _ref("number"), _POSITIVE
    some: Schema = {"type": "number", "minimum": values.SNAP, "maximum": values.LARGEST}
    scale: Schema = {"coulomb": ["velocity_scale"], "velocity_scale": ["coulomb"]}
    speeds = {"viscous": least, "coulomb": least, "velocity_scale": some}
    friction = _table("friction", read_effects.FRICTION, speeds, ())
    gear: Schema = {**_NUMBER, "not": {"const": 0}}
    actuator = {"rotor_inertia": least, "gear_ratio": gear}
    spring = {"stiffness": least, "rest": number}
    limits = {"displacement": _list_of(number, 2), "rate": some, "effort": some}
    return {
        "friction": {**friction, "dependentRequired": scale, "minProperties": 1},
        "spring": _table("spring", read_effects.SPRING, spring, ("stiffness",)),
        "actuator": _table("actuator", read_effects.ACTUATOR, actuator, read_effects.ACTUATOR),
        "limits": {**_table("limits", read_effects.LIMITS, limits, ()), "minProperties": 1},
    }


def _joint() -> Schema:
    """What goes with which kind; in the plane an R joint needs no axis."""
    crossed = [kind for kind in WrittenJoint if kind.crossed]
    others = [kind for kind in WrittenJoint if not kind.crossed]
    plain = [kind for kind in others if not (kind.pitched or kind.implied)]
    rules: list[Schema] = [
        _when(crossed, {"not": {"required": ["axis"]}}),
        _when([kind for kind in crossed if len(kind.parts) < 3], {"required": ["axes"]}),
        _when([kind for kind in others if kind.pitched], {"required": ["axis", "pitch"]}),
        _when(plain, {"required": ["axis"]}),
        _when(others, {"not": {"required": ["axes"]}}),
    ]
    for kind in crossed:
        axes = _list_of(_ref("axis"), len(kind.parts))
        rules.append(_when([kind], {"properties": {"axes": axes}}))
    return {**_table("joint", joints.FIELDS, _joint_fields(), ("kind",)), "allOf": rules}


def _platform_joint_fields() -> dict[str, Schema]:
    return {
        "kind": {"enum": [kind.letter for kind in PlatformJointKind]},
        "offset": _ref("vector"),
        "axis_link": _ref("axis"),
        "axis_platform": _ref("axis"),
        "rotation": _ref("rotation"),
        "friction": {"anyOf": [_ref("friction"), {"const": False}]},
    }


def _platform_joint() -> Schema:
    """A kind alone, or a table; fields of it may stand with each leg, so none is required."""
    fields = _platform_joint_fields()
    table = _table("platform_joint", joints.PLATFORM_FIELDS, fields, ())
    return {"anyOf": [fields["kind"], table]}


def _leg_type() -> Schema:
    fields: dict[str, Schema] = {
        "joints": _joints(_ref("joint")),
        "platform_joint": _ref("platformJoint"),
    }
    return _table("leg_type", legs.TYPE_FIELDS, fields, ())


def _leg() -> Schema:
    override: Schema = {
        "type": "object",
        "patternProperties": {"^(0|[1-9][0-9]?)$": _ref("jointOverride")},
        "additionalProperties": False,
    }
    fields: dict[str, Schema] = {
        "type": {"type": "string", "pattern": _NAME_PATTERN},
        "name": _PART,
        "base_point": _ref("vector"),
        "base_frame": _ref("rotation"),
        "joints": {"anyOf": [_joints(_ref("joint")), override]},
        "platform_joint": _ref("platformJoint"),
        "platform_point": _ref("vector"),
    }
    table = _table("leg", legs.FIELDS, fields, ("base_point",))
    return {**table, "anyOf": [{"required": ["type"]}, {"required": ["joints"]}]}


def _home() -> Schema:
    flat: Schema = {"type": "array", "items": _ref("number")}
    fields: dict[str, Schema] = {
        "X": flat,
        "q": {"anyOf": [flat, {"type": "array", "items": flat}]},
    }
    return _table("home", home.FIELDS, fields, ("X",))


def _rotation() -> Schema:
    angles = _list_of(_ref("number"), 3)
    tables = [_table("rotation", (name,), {name: angles}, (name,)) for name in ("rpy", "rpy_deg")]
    return {"anyOf": [_ref("rows"), *tables]}


def _table(
    table: str, known: tuple[str, ...], fields: dict[str, Schema], required: tuple[str, ...]
) -> Schema:
    """A table of exactly the fields that the reader knows, each with its meaning.

    Raises:
        KeyError: a field of the reader is missing here, or has no meaning in words.
    """
    described = {name: {**fields[name], "description": MEANING[table][name]} for name in known}
    return _object(described, {"required": list(required)})


def _object(fields: Mapping[str, object], rules: Schema | None = None) -> Schema:
    """A table of these fields and no others."""
    known = {"type": "object", "properties": fields}
    return {**known, **(rules or {}), "additionalProperties": False}


def _override(known: tuple[str, ...], fields: dict[str, Schema]) -> Schema:
    """Any of the fields of a table, none of them required."""
    loose = {**fields, "link": {"type": "object"}} if "link" in known else dict(fields)
    for name in set(known) & set(read_effects.FIELDS):
        loose[name] = {"anyOf": [fields[name], {"type": "object"}]}
    return _object({name: loose[name] for name in known})


def _joints(item: Schema) -> Schema:
    return {"type": "array", "items": item, "minItems": 1, "maxItems": joints.MAX_JOINTS}


def _when(kinds: list[WrittenJoint], then: Schema) -> Schema:
    letters = [kind.letter for kind in kinds]
    own = {"properties": {"kind": {"enum": letters}}, "required": ["kind"]}
    return {"if": own, "then": then}


def _rows(size: int) -> Schema:
    return _list_of(_list_of(_ref("number"), size), size)


def _list_of(item: Schema, least: int, most: int | None = None) -> Schema:
    return {"type": "array", "items": item, "minItems": least, "maxItems": most or least}


def _some(item: Schema) -> Schema:
    return {"type": "array", "items": item, "minItems": 1}


def _ref(name: str) -> Schema:
    return {"$ref": f"#/$defs/{name}"}
