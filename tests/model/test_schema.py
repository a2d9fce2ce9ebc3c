"""The published schema: up to date, true of every valid specification, alert to typical errors."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from pne_sym import manipulators
from pne_sym.model import body, home, joints, legs, reader
from pne_sym.model.errors import SpecError
from pne_sym.model.reader import from_mapping, to_full_form
from pne_sym.model.schema import json_schema, schema_text
from pne_sym.starter import starter_text
from tests.model.examples import ABSENT, planar, spatial, spoilt

FILE = Path(__file__).parents[2] / "docs/pne_sym.schema.json"
VALIDATOR = jsonschema.Draft202012Validator(json_schema())


def faults(spec: Any) -> list[str]:
    return [f"{error.json_path}: {error.message}" for error in VALIDATOR.iter_errors(spec)]


def test_file_is_up_to_date() -> None:
    assert FILE.read_text(encoding="utf-8") == schema_text(), "`make schema` writes it"


def test_it_is_a_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(json_schema())


@pytest.mark.parametrize("name", manipulators.names())
def test_catalogue_is_valid_in_both_forms(name: str) -> None:
    text = manipulators.path(name).read_text(encoding="utf-8")
    assert faults(tomllib.loads(text)) == []
    assert faults(to_full_form(manipulators.load(name))) == []


@pytest.mark.parametrize("text", ["6-UPS", "3-UPU", "2-RPR+1-RRR", "6-UHS", "1-RRRRS+2-RRRS"])
def test_starters_are_valid(text: str) -> None:
    assert faults(tomllib.loads(starter_text("my_robot", text))) == []


def test_examples_of_the_documentation_are_valid() -> None:
    page = (FILE.parent / "spec-format.md").read_text(encoding="utf-8")
    example = page.split("```toml\n")[1].split("```")[0]
    assert faults(tomllib.loads(example)) == []


def test_every_field_of_the_reader_is_described() -> None:
    definitions: Any = json_schema()["$defs"]
    tables = [
        (reader.FIELDS, json_schema()),
        (body.FIELDS, definitions["body"]),
        (joints.FIELDS, definitions["joint"]),
        (joints.PLATFORM_FIELDS, definitions["platformJoint"]["anyOf"][1]),
        (legs.FIELDS, definitions["leg"]),
        (legs.TYPE_FIELDS, definitions["legType"]),
        (home.FIELDS, definitions["home"]),
    ]
    for fields, table in tables:
        assert tuple(table["properties"]) == tuple(fields)
        assert all(len(field["description"]) > 5 for field in table["properties"].values())


TYPICAL: list[tuple[str, Any]] = [
    ("name", ABSENT),
    ("name", "Lift"),
    ("name", "check"),
    ("name", "volatile"),
    ("name", 3),
    ("space", "spacial"),
    ("platfrom", {}),
    ("platform.mas", 1),
    ("platform.mass", -1),
    ("platform.mass", "2 kg"),
    ("platform.inertia", [1, 2]),
    ("platform.inertia", {"ixw": 2}),
    ("platform.inertia_about", "joint"),
    ("fixed_centre", [0, 0, 0]),
    ("gravity", [0, 0, -9.81, 0]),
    ("gravity", 9.81),
    ("title", ""),
    ("legs", []),
    ("legs", {}),
    ("legs.0.base_pont", [0, 0, 0]),
    ("legs.0.base_point", ABSENT),
    ("legs.0.base_point", [0, 0, "1"]),
    ("legs.0.base_point", [0, 0, True]),
    ("legs.0.base_point", [0, 0, 1e13]),
    ("legs.0.base_frame", {"rpy": [0, 0]}),
    ("legs.0.base_frame", {"rpz": [0, 0, 0]}),
    ("legs.0.base_frame", [[1, 0, 0], [0, 1, 0], [0, 0]]),
    ("legs.0.joints", []),
    ("legs.0.joints", ABSENT),
    ("legs.0.joints.0.kind", "Q"),
    ("legs.0.joints.0.axis", "up"),
    ("legs.0.joints.0.axis", ABSENT),
    ("legs.0.joints.0.actuated", "yes"),
    ("legs.0.joints.0.axes", ["x", "y"]),
    ("legs.0.joints.0", {"kind": "H", "axis": "z"}),
    ("legs.0.joints.0", {"kind": "U", "axis": "z"}),
    ("legs.0.joints.0", {"kind": "U", "axes": ["z"]}),
    ("legs.0.joints.0.link.mass", ABSENT),
    ("legs.0.platform_joint", "T"),
    ("legs.0.platform_joint.axis", "x"),
    ("home", ABSENT),
    ("home.X", ABSENT),
    ("home.X", "here"),
    ("home.velocity", [0]),
]


@pytest.mark.parametrize(("path", "value"), TYPICAL)
def test_typical_errors_are_caught_by_schema_and_reader(path: str, value: Any) -> None:
    spec = spoilt(spatial(), path, value)
    assert faults(spec) != []
    with pytest.raises(SpecError):
        from_mapping(spec, "spoilt")


def test_overrides_of_a_leg_type() -> None:
    spec = planar()
    spec["legs"][1]["joints"] = {"1": {"actuated": False, "link": {"mass": 2.0}}}
    assert faults(spec) == []
    spec["legs"][1]["joints"] = {"first": {"actuated": False}}
    assert faults(spec) != []
    spec["legs"][1]["joints"] = {"1": {"actuatd": False}}
    assert faults(spec) != []
