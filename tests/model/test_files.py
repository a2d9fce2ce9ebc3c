"""Files: what cannot be read or parsed is told; hostile text neither hangs nor crashes."""

from __future__ import annotations

import copy
import json
import random
import subprocess
import sys
import time
import warnings
from pathlib import Path
from typing import Any

import pytest

from pne_sym import manipulators
from pne_sym.model.errors import SpecError, SpecNote, SpecWarning
from pne_sym.model.files import MAX_BYTES
from pne_sym.model.reader import from_mapping, from_text, read_spec, to_full_form
from tests.model.examples import spatial


def test_json_and_toml_give_the_same(tmp_path: Path) -> None:
    toml = tmp_path / "a.toml"
    toml.write_text(manipulators.path("stewart").read_text(encoding="utf-8"))
    file = tmp_path / "a.JSON"
    file.write_text(json.dumps(to_full_form(read_spec(toml))), encoding="utf-8-sig")
    assert read_spec(file) == read_spec(toml)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.toml", None, "no such file; expected a specification in TOML or JSON"),
        ("a.yaml", b"", "file of kind '.yaml'; expected a .toml or .json file"),
        ("a", b"", "file of kind ''; expected a .toml or .json file"),
        ("a.toml", b"name = \xff", "byte 7 is not UTF-8; expected UTF-8 text"),
        ("a.toml", b"#" * (MAX_BYTES + 1), f"file too large; expected at most {MAX_BYTES} bytes"),
        ("a.toml", b"name = \n", "syntax error: Invalid value (at line 1, column 8)"),
        ("a.toml", b"name = 'a'\nname = 'b'\n", "syntax error: Cannot overwrite a value (at"),
        ("a.json", b"{'name': 1}", "syntax error: Expecting property name"),
        ("a.json", b'{"name": 1, "name": 2}', "syntax error: field 'name' stands twice in one"),
        ("a.json", b"[]", "value []; expected a table with name, space, platform, legs, home"),
        ("a.json", b"", "syntax error: Expecting value"),
        ("a.json", b"9" * 5000, "syntax error: "),
        ("a.toml", b"legs = " + b"9" * 5000, "syntax error: "),
        ("a.toml", b"legs = 0x" + b"f" * 90000, "missing field 'name'"),
        ("a.json", b"[" * 100000, "nested too deeply; expected at most 16 levels"),
        ("a.toml", b"a = " + b"[" * 100000, "nested too deeply; expected at most 16 levels"),
        ("a.toml", b"a = " + b"{a=" * 100000, "nested too deeply; expected at most 16 levels"),
        ("a.toml", b"a." * 1000000 + b"a = 1", "nested too deeply; expected at most 16 levels"),
        ("a.toml", b"'a' . \"a\" ." * 300000 + b"a = 1", "nested too deeply"),
        ("a.json", b'{"a":' * 20 + b"1" + b"}" * 20, "nested too deeply"),
        ("a.toml", b"a" * 4000000, "syntax error: "),
        ("a.toml", b"'" * 4000000, "syntax error: "),
    ],
)
def test_file_fault(tmp_path: Path, name: str, content: bytes | None, message: str) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    start = time.process_time()  # of this process: a busy machine does not count
    with pytest.raises(SpecError) as caught:
        read_spec(path)
    assert time.process_time() - start < 5.0
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    assert message in text
    assert text.isprintable()


def test_not_a_regular_file(tmp_path: Path) -> None:
    folder = tmp_path / "a.toml"
    folder.mkdir()
    with pytest.raises(SpecError, match="not a regular file"):
        read_spec(folder)
    with pytest.raises(SpecError, match=r"x\?\.toml: no such file"):
        read_spec(Path("x\n.toml"))
    with pytest.raises(SpecError):
        read_spec(Path("x\0.toml"))


def test_long_lists_are_refused_before_they_are_read() -> None:
    text = '{"name": "a", "space": "spatial", "legs": [' + "1," * 1900000 + "1]}"
    with pytest.raises(SpecError, match="legs: 1900001 elements; expected at most 4096"):
        from_text(text, ".json", "a.json")


def test_many_legs_that_do_not_close_are_refused_in_time() -> None:
    spec = spatial()
    joint = {"kind": "R", "axis": "x", "offset": [0.01, 0.02, 0.03]}
    spec["legs"] = [spec["legs"][0] | {"joints": [joint] * 12}] * 24
    spec["home"]["q"] = [0.1] * (12 * 24)
    start = time.process_time()
    with pytest.raises(SpecError, match="loops do not close"):
        from_mapping(spec, "many.toml")
    assert time.process_time() - start < 15.0


WORDS: list[Any] = [
    None, True, -1, 0, 1, 1e300, -1e-300, float("nan"), 10**30, "", "x", "R", "S", "{{ 7 * 7 }}",
    "__import__('os')", "%s%n", "\x00\u202e", [], {}, [[]], [0, 0, 0], [1, 0, 0], [[1, 0, 0]] * 3,
    {"kind": "U"}, {"rpy_deg": [10, 20, 30]}, {"0": {}}, ["x", "y"],
]  # fmt: skip


@pytest.mark.parametrize("seed", range(8))
def test_mutated_structure_gives_a_manipulator_or_one_message(seed: int) -> None:
    rng = random.Random(seed)
    names = manipulators.names()
    for _ in range(60):
        form: Any = to_full_form(manipulators.load(rng.choice(names)))
        for _ in range(rng.randint(1, 3)):
            mutate(form, rng)
        read_or_refuse(json.dumps(form), ".json")


@pytest.mark.parametrize("seed", range(4))
def test_mutated_bytes_give_a_manipulator_or_one_message(seed: int) -> None:
    rng = random.Random(seed)
    text = manipulators.path("fivebar_offset").read_text(encoding="utf-8")
    for _ in range(60):
        start = rng.randrange(len(text))
        end = start + rng.choice([0, 1, 1, 5, 40])
        piece = rng.choice(["", "[", "]", '"', "=", "9", "-", ".", "\n", "\x00", "é", "[[legs]]\n"])
        read_or_refuse(text[:start] + piece + text[end:], ".toml")


def mutate(form: Any, rng: random.Random) -> None:
    """Replace, add or remove something somewhere in a tree of dicts and lists."""
    while True:
        keys = list(form) if isinstance(form, dict) else list(range(len(form)))
        if not keys:
            return
        key = rng.choice(keys)
        if isinstance(form[key], dict | list) and rng.random() < 0.8:
            form = form[key]
            continue
        if rng.random() < 0.15:
            del form[key]
        else:
            form[key] = copy.deepcopy(rng.choice(WORDS))
        return


def read_or_refuse(text: str, suffix: str) -> None:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SpecNote)
            manipulator = from_text(text, suffix, "fuzz")
    except (SpecError, SpecWarning) as told:
        message = str(told)
    else:
        message = "fuzz: fine"
        assert from_mapping(to_full_form(manipulator), "again") == manipulator
    assert message.startswith("fuzz: ")
    assert message.isprintable()


def test_reading_needs_no_heavy_import() -> None:
    """Time is not measured here; what costs it is: sympy and pydantic stay out."""
    code = (
        "import sys; from pne_sym import manipulators; manipulators.load('stewart');"
        "print(sorted({'sympy', 'pydantic', 'jinja2'} & set(sys.modules)))"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert result.stdout.strip() == "[]"
