"""Edits of a specification are told once, in words, at the paths of the author's own file."""

from __future__ import annotations

import copy
import math
import tomllib
from pathlib import Path
from typing import Any

import pytest

from pne_sym import manipulators
from pne_sym.model.full_form import to_full_form
from pne_sym.model.reader import from_text
from pne_sym.review.alignment import align, joint_pairs, leg_pairs
from pne_sym.review.compare import compare
from pne_sym.review.edits import best_edits, edits
from tests.models import catalogue
from tests.review.folders import find_version

FILE = manipulators.path("planar_3rpr").read_text(encoding="utf-8")


def compared(tmp_path: Path, *changes: tuple[str, str]):
    """The catalogue's file and an edited copy."""
    text = FILE
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    (tmp_path / "mine.toml").write_text(text)
    return compare(find_version("planar_3rpr"), find_version(str(tmp_path / "mine.toml")))


def one_line(line: str) -> tuple[str, str]:
    """A line with one of its numbers made larger."""
    key, _, value = line.partition(" = ")
    return line, f"{key} = {float(value.split()[0]) + 0.125!r}"


def test_a_line_of_a_leg_type_is_one_edit(tmp_path: Path) -> None:
    masses = [line for line in FILE.splitlines() if line.startswith("link.mass")]
    found = compared(tmp_path, one_line(masses[0]))
    (edit,) = found.specification
    assert edit.path == "leg_types.rpr.joints[0].link.mass"
    assert edit.words == "leg type rpr, joint 1 (R), link: mass 2 -> 2.125 kg (+6.25 %)"
    assert (edit.before, edit.after) == ("2.0", "2.125")
    assert [c.what for c in found.interface] == [
        f"default of legs[{leg}].joints[0].link.mass" for leg in range(3)
    ]
    assert not found.equal


def test_another_notation_of_the_same_is_no_edit(tmp_path: Path) -> None:
    gravity = next(line for line in FILE.splitlines() if line.startswith("gravity"))
    found = compared(tmp_path, (gravity, "gravity = [0, -9.81, 0]"))
    assert found.equal
    assert found.interface == found.specification == ()


def test_a_folder_has_paths_of_the_full_form(tmp_path: Path) -> None:
    """What its author wrote is not known of a generated folder."""
    import pne_sym  # noqa: PLC0415

    folder = pne_sym.generate("planar_3rpr", tmp_path)
    masses = [line for line in FILE.splitlines() if line.startswith("link.mass")]
    old, new = one_line(masses[0])
    (tmp_path / "mine.toml").write_text(FILE.replace(old, new, 1))
    found = compare(find_version(str(folder)), find_version(str(tmp_path / "mine.toml")))
    (edit,) = found.specification
    assert edit.path == "legs[0, 1, 2].joints[0].link.mass"
    assert edit.words == "legs 1-3, joint 1 (R), link: mass 2 -> 2.125 kg (+6.25 %)"


def leg(*joints: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"joints": list(joints), "base_point": [0, 0, 0], **more}


ROTATED = [
    [[math.cos(a), -math.sin(a)], [math.sin(a), math.cos(a)]]
    for a in map(math.radians, (0, 30, 60, 90))
]
R, P = {"kind": "R", "axis": "z"}, {"kind": "P", "axis": "x", "actuated": True}
CASES: list[tuple[dict[str, Any], dict[str, Any], list[tuple[str, str]]]] = [
    ({"a": {"b": 1}}, {"a": {"b": 1}}, []),
    ({"name": "a", "title": "b"}, {"name": "c"}, []),
    ({"a": [1, 2]}, {"a": [1, 3]}, [("a [1, 2] -> [1, 3]", "a")]),
    ({"space": "planar"}, {"space": "point"}, [("space planar -> point", "space")]),
    (
        {"platform": {"centre_of_mass": [0, 0, 0.04]}},
        {"platform": {"centre_of_mass": [0.01, 0, 0.04]}},
        [
            (
                "platform: centre of mass moved by 10 mm, off zero in x",
                "platform.centre_of_mass",
            )
        ],
    ),
    (
        {"platform": {"inertia": [1, 2, 3]}},
        {"platform": {"inertia": [[1, 0.1, 0], [0.1, 2, 0], [0, 0, 3]]}},
        [("platform: inertia now full (products of inertia)", "platform.inertia")],
    ),
    (
        {"platform": {"inertia": 2.0}},
        {"platform": {"inertia": {"izz": 2.5}}},
        [("platform: inertia changed by up to 25 %", "platform.inertia")],
    ),
    (
        {"legs": [leg(R, P)]},
        {"legs": [leg({**R, "axis": [0, 0, -1]}, P)]},
        [("leg 1, joint 1 (R): axis flipped", "legs[0].joints[0].axis")],
    ),
    (
        {"legs": [leg(R, P)]},
        {"legs": [leg({**R, "axis": [0, 1, 0]}, P)]},
        [("leg 1, joint 1 (R): axis turned by 90 degrees", "legs[0].joints[0].axis")],
    ),
    (
        {"legs": [leg(R, P)]},
        {"legs": [leg(R, {"kind": "R", "axis": "y"}, P)]},
        [("leg 1: joint 2 (R about y) inserted", "legs[0].joints[1]")],
    ),
    (
        {"legs": [leg(R, P)]},
        {"legs": [leg(P)]},
        [("leg 1: joint 1 (R about z) removed", "legs[0].joints[0]")],
    ),
    (
        {"legs": [leg(R, P)]},
        {"legs": [leg({**R, "actuated": True}, {"kind": "P", "axis": "x"})]},
        [("leg 1: actuated joint moved from joint 2 to joint 1", "legs[0].joints.actuated joint")],
    ),
    (
        {"legs": [leg(R, P)]},
        {"legs": [leg(R, {"kind": "P", "axis": "x"})]},
        [("leg 1, joint 2 (P): no longer actuated", "legs[0].joints[1].actuated")],
    ),
    (
        {"legs": [leg(R, P, platform_point=[k, 0, 0]) for k in range(3)]},
        {"legs": [leg(R, P, platform_point=[k, 0, 0]) for k in (0, 2)]},
        [("leg 2 (RP) removed", "legs[1]")],
    ),
    (
        {"legs": [leg(R, P)] * 2},
        {"legs": [leg(R, P)] * 2 + [leg(R, P, type="rp", base_point=[1, 0, 0])]},
        [("leg 3 (of type rp) added", "legs[2]")],
    ),
    (
        {"legs": [leg(P, platform_point=[k, 0]) for k in range(3)]},
        {"legs": [leg(P, platform_point=[k, 0.1]) for k in range(3)]},
        [
            (
                "legs 1-3: platform point set to 100 mm from zero, others otherwise",
                "legs[0, 1, 2].platform_point",
            )
        ],
    ),
    (
        {"legs": [leg(P)], "home": {"q": [1]}},
        {"legs": [leg({**P, "friction": {"viscous": 0.1}})], "home": {"q": [2]}},
        [
            ("leg 1, joint 1 (P): friction added", "legs[0].joints[0].friction"),
            ("home: q [1] -> [2]", "home.q"),
        ],
    ),
    (
        {"legs": [leg({**R, "kind": "U"}, P)]},
        {
            "legs": [
                leg({**R, "kind": "S", "extra": [False, True]}, {**P, "friction": {"viscous": 1}})
            ]
        },
        [
            ("leg 1, joint 1 (S): kind U -> S", "legs[0].joints[0].kind"),
            ("leg 1, joint 2 (P): friction added", "legs[0].joints[1].friction"),
            (
                "leg 1, joint 1 (S): an extra coordinate: false -> [false, true]",
                "legs[0].joints[0].extra",
            ),
        ],
    ),
    (
        {"gravity": [0, -9.81]},
        {"gravity": [1.62, 0]},
        [("gravity turned by 90 degrees, 9.81 -> 1.62 m/s^2 (-83.5 %)", "gravity")],
    ),
    (
        {"gravity": [0, -9.81]},
        {"gravity": [0, 0, -9.81]},
        [("gravity turned by 90 degrees", "gravity")],
    ),
    ({"a": 1.5}, {"a": 45.0}, [("a 1.5 -> 45 (30 times)", "a")]),
    (
        {"gravity": [0, -10]},
        {"gravity": [0, -5]},
        [("gravity 10 -> 5 m/s^2 (-50 %)", "gravity")],
    ),
    (
        {"legs": [leg({**P, "limits": {"displacement": [0.4, 0.9]}})]},
        {"legs": [leg({**P, "limits": {"displacement": [0.35, 0.9]}})]},
        [
            (
                "leg 1, joint 1 (P), limits: displacement 0.4 to 0.9 -> 0.35 to 0.9",
                "legs[0].joints[0].limits.displacement",
            )
        ],
    ),
    (
        {"legs": [leg(P)]},
        {"legs": [leg({**P, "name": "slide"}, name="front")]},
        [
            ("leg 1, joint 1 (P): named slide", "legs[0].joints[0].name"),
            ("leg 1: named front", "legs[0].name"),
        ],
    ),
    (
        {"platform": {"inertia": 2.0}},
        {"platform": {"inertia": [1, 2, 3], "inertia_about": "origin"}},
        [("platform: inertia now about the origin", "platform.inertia_about")],
    ),
    (
        {"platform": {"inertia_about": "origin"}},
        {"platform": {}},
        [("platform: inertia now about the centre of mass", "platform.inertia_about")],
    ),
    (
        {"legs": [leg({**P, "axes": ["z", "y"]})]},
        {"legs": [leg({**P, "axes": ["y", [0, 0, 1]]})]},
        [("leg 1, joint 1 (P): axes z, y -> y, z", "legs[0].joints[0].axes")],
    ),
    (
        {"legs": [leg(P, base_frame=ROTATED[k], platform_point=[k, 0]) for k in range(4)]},
        {"legs": [leg(P, base_frame=ROTATED[0], platform_point=[k, 0]) for k in range(4)]},
        [("legs 2-4: base frame turned by 30 to 90 degrees", "legs[1, 2, 3].base_frame")],
    ),
    (
        {"legs": [leg(R, P, base_point=[k, 0, 0]) for k in range(3)]},
        {"legs": [leg(R, P, base_point=[k, 0, 0]) for k in (0, 2, 1)]},
        [("legs 2 and 3 swapped", "legs.order")],
    ),
    (
        {"legs": [leg(R, P, base_point=[k, 0, 0], platform_joint="R") for k in range(3)]},
        {
            "legs": [
                leg(R, P, base_point=[k, 0, 0], platform_joint="S" if k == 0 else "R")
                for k in (1, 2, 0)
            ]
        },
        [
            ("legs in another order, now 2, 3, 1", "legs.order"),
            ("leg 3: platform joint R -> S", "legs[2].platform_joint"),
        ],
    ),
    (
        {"leg_types": {"rp": {"joints": [R, P]}}, "legs": [{"type": "rp"}] * 3},
        {"leg_types": {"arm": {"joints": [R, {**P, "axis": "y"}]}}, "legs": [{"type": "arm"}] * 3},
        [
            (
                "leg type arm, joint 2 (P): axis turned by 90 degrees",
                "leg_types.arm.joints[1].axis",
            ),
            ("leg type rp renamed arm", "leg_types.rp.name"),
        ],
    ),
    (
        {"symbols": {f"q_{k}": "L" for k in range(5)}},
        {"symbols": {f"q_{k}": "D" for k in range(5)}},
        [("symbols of q_0, q_1, q_2 and 2 more changed", "symbols")],
    ),
    (
        {"home": {"X": [1]}},
        {"home": {"X": [2]}, "symbols": {"e_2": "s"}},
        [("home: X [1] -> [2]", "home.X"), ("symbols of e_2 added", "symbols")],
    ),
]


@pytest.mark.parametrize(("before", "after", "expected"), CASES)
def test_edits(
    before: dict[str, Any], after: dict[str, Any], expected: list[tuple[str, str]]
) -> None:
    assert [(e.words, e.path) for e in edits(before, after)] == expected


@pytest.mark.parametrize("name", manipulators.names())
def test_a_file_does_not_differ_from_itself(name: str) -> None:
    data = tomllib.loads(manipulators.path(name).read_text(encoding="utf-8"))
    assert edits(data, data) == ()


def test_one_full_form_is_equal_however_it_is_written() -> None:
    form = to_full_form(catalogue("planar_3rpr"))
    assert best_edits((form, form), (tomllib.loads(FILE), form)) == ()


@pytest.mark.parametrize(
    ("line", "words", "path"),
    [
        (
            "joints.1.link.mass = 0.8",
            "leg 1, joint 2 (P), link: mass 1.2 -> 0.8 kg (-33.3 %)",
            "legs[0].joints[1].link.mass",
        ),
        (
            "joints.1.actuated = false",
            "leg 1, joint 2 (P): no longer actuated",
            "legs[0].joints[1].actuated",
        ),
    ],
)
def test_what_a_leg_overrides_is_told_with_what_it_was(line: str, words: str, path: str) -> None:
    text = FILE.replace('type = "rpr"', f'type = "rpr"\n{line}', 1)
    written = tomllib.loads(FILE), tomllib.loads(text)
    full = tuple(to_full_form(from_text(t, ".toml", "robot")) for t in (FILE, text))
    (edit,) = best_edits((full[0], full[1]), written)
    assert (edit.words, edit.path) == (words, path)


def test_what_is_put_in_is_shown_as_the_specification_writes_it() -> None:
    one = {"legs": [leg(R)]}
    two = {"legs": [leg(R), leg({**P, "link": {"mass": 1.5}}, R, type="a")]}
    (edit,) = edits(one, two)
    assert edit.after.split("\n") == [
        'joint 1 = { kind = "P", axis = "x", actuated = true, link = { mass = 1.5 } }',
        'joint 2 = { kind = "R", axis = "z" }',
        "base_point = [0, 0, 0]",
        'type = "a"',
    ]


def test_joints_and_legs_keep_who_they_are() -> None:
    form = to_full_form(catalogue("stewart"))
    legs: list[Any] = form["legs"]
    joints = legs[0]["joints"]
    spin = {**joints[0], "axis": [1.0, 0.0, 0.0]}
    assert joint_pairs(joints, [*joints[:2], spin, joints[2]]) == [
        (0, 0), (1, 1), (None, 2), (2, 3),
    ]  # fmt: skip
    assert joint_pairs(joints, joints[1:]) == [(0, None), (1, 0), (2, 1)]
    assert leg_pairs(legs, [*legs[:2], *legs[3:]])[2] == (2, None)
    named = copy.deepcopy(legs)
    for k, each in enumerate(named):
        each["name"] = f"leg{k}"
    turned = [{**each, "base_point": [0, 0, 0]} for each in (*named[1:], named[0])]
    assert leg_pairs(named, turned) == [*((k + 1, k) for k in range(5)), (0, 5)]


def test_paths_after_are_told_as_they_are_before() -> None:
    def manifest(*joints: dict[str, Any]) -> dict[str, Any]:
        legs = [leg(*joints), leg(*joints, base_point=[1, 0, 0])]
        types = [{"name": "t", "legs": [0, 1]}]
        return {"specification": {"legs": legs}, "leg_types": types, "joints": []}

    found = align(manifest(R, P), manifest(R, {"kind": "R", "axis": "y"}, P))
    assert found.canonical("legs[1].joints[2].link.mass") == "legs[1].joints[1].link.mass"
    assert found.canonical("legs[1].joints[1].link.mass") == "new legs[1].joints[1].link.mass"
    assert found.canonical("platform.mass") == "platform.mass"
    assert found.joints[0] == {0: 0, 2: 1}
    assert found.types == {"t": "t"}
