"""Each class of bad input, through the program itself: one message, exit code 2, no file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.cli.program import pne_gen
from tests.cli.test_faults import assert_refused
from tests.model.examples import ABSENT, planar, spatial, spoilt

FIELDS: list[tuple[str, str, Any, str]] = [
    ("unknown field", "platfrom", {}, "unknown field 'platfrom' (did you mean platform?)"),
    ("unknown inner field", "legs.0.base_pont", [0, 0, 0], "legs[0]: unknown field 'base_pont'"),
    ("missing field", "home", ABSENT, "missing field 'home'; expected home = a pose X"),
    ("missing inner field", "legs.0.joints.0.axis", ABSENT, "legs[0].joints[0]: missing field"),
    ("word", "space", "spacial", "space: value 'spacial'; expected one of point, planar"),
    ("type", "platform.mass", "heavy", "platform.mass: value 'heavy'; expected a number"),
    ("sign", "platform.mass", -1, "platform.mass: value -1; expected zero or a positive number"),
    ("shape", "legs.0.base_point", [0, 0], "expected a list of three numbers (x, y, z) (2 given)"),
    ("nan", "legs.0.base_point", [0, 0, float("nan")], "base_point[2]: value nan; expected a"),
    ("infinite", "gravity", [0, 0, float("-inf")], "gravity[2]: value -inf; expected a finite"),
    ("too large", "gravity", [0, 0, 1e13], "expected a finite number, at most 1e+12 in size"),
    ("zero axis", "legs.0.joints.0.axis", [0, 0, 0], "a unit vector (length 1 to 1e-06), got a"),
    ("long axis", "legs.0.joints.0.axis", [0, 0, 2], "got a vector of length 2"),
    ("frame", "legs.0.base_frame", [[1, 0, 0], [0, 1, 0], [0, 0, -1]], "a rotation matrix"),
    ("not symmetric", "platform.inertia", [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]], "a symmetric tens"),
    ("negative inertia", "platform.inertia", [1, 1, -0.1], "principal moment -0.1 kg m^2"),
    ("pitch", "legs.0.joints.0.pitch", 0.1, "expected no pitch: the joint is of kind P, not H"),
    ("kind", "legs.0.joints.0.kind", "Q", "value 'Q'; expected one of R, P, H, U, C, S"),
    ("flag", "legs.0.joints.0.actuated", "yes", "actuated: value 'yes'; expected true or false"),
    ("no legs", "legs", [], "legs: 0 legs; expected 1 to 128 legs"),
    ("many legs", "legs", [{}] * 129, "legs: 129 legs; expected 1 to 128 legs"),
    ("platform joint", "legs.0.platform_joint", "T", "expected one of S, R, U, rigid"),
    ("home length", "home.q", [0.5, 0.5], "home.q: 2 numbers; expected 1 numbers"),
    (
        "open loop",
        "home.q",
        [2.5],
        "home: the loops do not close at X: legs[0] has a loop-closure residual of",
    ),
    ("name grammar", "name", "Lift Me", "name: value 'Lift Me'; expected a lower-case letter"),
    ("path as a name", "name", "../lift", "name: value '../lift'; expected a lower-case letter"),
    ("command", "name", "explain", "'explain' is a command of pne-gen"),
    ("Python keyword", "name", "lambda", "'lambda' is a Python keyword"),
    ("C keyword", "name", "restrict", "'restrict' is a keyword of C or C++"),
    ("C header", "name", "tgmath", "'tgmath' is a standard header of C"),
    ("POSIX header", "name", "unistd", "'unistd' is a header of POSIX"),
    ("module", "name", "numpy", "'numpy' is a Python module"),
    ("title", "title", "a\nb", "title: value 'a\\nb'; expected one line of 1 to 120 printable"),
    ("symbol", "symbols", {"q_1": r"\input{x}"}, "symbols.q_1: value '\\\\input{x}'"),
    ("no such centre", "fixed_centre", [0, 0, 0], "the space 'spatial' has none"),
]


@pytest.mark.parametrize(("path", "value", "part"), [row[1:] for row in FIELDS],
                         ids=[row[0] for row in FIELDS])  # fmt: skip
def test_a_field_at_fault(path: str, value: Any, part: str, tmp_path: Path) -> None:
    file = tmp_path / "lift.json"
    file.write_text(json.dumps(spoilt(spatial(), path, value)))
    done = pne_gen("lift.json", "--out", "out", cwd=tmp_path, real=True)
    assert_refused(done, "pne-gen: error: lift.json: ", part)
    assert [item.name for item in tmp_path.iterdir()] == ["lift.json"]


FILES: list[tuple[str, bytes | None, str]] = [
    ("none.toml", None, "none.toml: no such file"),
    ("./none", None, "none: no such file; expected a specification in TOML or JSON"),
    ("none.tml", None, "none.tml: no such file; expected a specification in TOML or JSON"),
    ("a.toml", b"name = 'a_b'", "missing field 'space'; expected space = one of point, planar, "),
    ("a.yaml", b"", "a.yaml: file of kind '.yaml'; expected a .toml or .json file"),
    ("a.toml", b"name = \n", "a.toml: syntax error: Invalid value (at line 1, column 8)"),
    ("a.toml", b"name = 'a'\nname = 'b'\n", "syntax error: Cannot overwrite a value"),
    ("a.json", b"{'name': 1}", "syntax error: Expecting property name"),
    ("a.json", b'{"name": 1, "name": 2}', "field 'name' stands twice in one"),
    ("a.json", b"[]", "value []; expected a table with name, space, platform, legs, home"),
    ("a.toml", b"name = \xff", "byte 7 is not UTF-8; expected UTF-8 text"),
    ("a.json", b"[" * 100000, "nested too deeply; expected at most 16 levels"),
    ("a.toml", b"#" * (4 * 1024 * 1024 + 1), "file too large; expected at most 4194304 bytes"),
]


@pytest.mark.parametrize(("name", "content", "part"), FILES)
def test_a_file_at_fault(name: str, content: bytes | None, part: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    assert_refused(pne_gen(name, "--out", "out", cwd=tmp_path, real=True), part)
    assert not (tmp_path / "out").exists()


def mechanism(**changes: Any) -> dict[str, Any]:
    return planar() | changes


MECHANISMS: list[tuple[str, dict[str, Any], str]] = [
    (
        "singular leg",
        mechanism(
            legs=[
                {
                    "base_point": [0.0, 0.0],
                    "joints": [
                        {"kind": "R", "actuated": True},
                        {"kind": "R", "offset": [1.0, 0.0], "actuated": True},
                    ],
                    "platform_joint": {"kind": "R", "offset": [1.0, 0.0]},
                }
            ],
            home={"X": [2.0, 0.0], "q": [0.0, 0.0]},
            leg_types={},
        ),
        "the leg is singular at home",
    ),
    (
        "surplus freedom",
        mechanism(
            legs=[
                {
                    "base_point": [0.0, 0.0],
                    "joints": [
                        {"kind": "P", "axis": "x"},
                        {"kind": "R"},
                        {"kind": "P", "axis": "x"},
                    ],
                }
            ],
            home={"X": [2.0, 0.0], "q": [1.0, 0.0, 1.0]},
            leg_types={},
        ),
        "or the surplus ones marked extra = true",
    ),
]


@pytest.mark.parametrize(("spec", "part"), [row[1:] for row in MECHANISMS],
                         ids=[row[0] for row in MECHANISMS])  # fmt: skip
def test_equations_that_cannot_be_formed(spec: dict[str, Any], part: str, tmp_path: Path) -> None:
    (tmp_path / "pair.json").write_text(json.dumps(spec))
    assert_refused(pne_gen("pair.json", "--out", "out", cwd=tmp_path, real=True), part)
    assert not (tmp_path / "out").exists()


def warned(spec: dict[str, Any], folder: Path) -> str:
    """The warnings about a specification that is generated all the same."""
    (folder / "pair.json").write_text(json.dumps(spec))
    done = pne_gen("pair.json", "--out", "out", "--quiet", cwd=folder)
    assert (done.returncode, done.stdout) == (0, "")
    assert (folder / "out/pair/pair.py").is_file()
    assert all(line.startswith("pne-gen: warning: ") for line in done.stderr.splitlines())
    return done.stderr


def test_fewer_actuators_than_freedoms_are_a_warning(tmp_path: Path) -> None:
    spec = planar()
    spec["legs"][1]["joints"] = {"1": {"actuated": False}}
    assert "pair: legs: fewer actuators than degrees of freedom: 1 for 2" in warned(spec, tmp_path)


def test_a_rough_home_is_a_warning(tmp_path: Path) -> None:
    spec = planar()
    spec["home"]["q"][0][1] += 0.01
    assert "home: taken as a rough guess (loop-closure residual 0.00" in warned(spec, tmp_path)


def test_an_unused_leg_type_is_a_warning(tmp_path: Path) -> None:
    spec = planar()
    spec["leg_types"]["spare"] = {}
    assert "leg_types.spare: no leg is of this type" in warned(spec, tmp_path)


def test_mobility_is_told_unless_quiet(tmp_path: Path) -> None:
    (tmp_path / "pair.json").write_text(json.dumps(planar()))
    done = pne_gen("pair.json", "--out", "out", cwd=tmp_path)
    assert done.stdout.partition("\n")[2] == (
        "  2 degrees of freedom at home, 2 actuators, 0 constraints, 0 extra coordinates; "
        "section 3 of the paper: ordinary (3.1)\n"
    )
