"""The examples and messages of docs/spec-format.md are true."""

from __future__ import annotations

import doctest
import re
import tomllib
import types
import warnings
from pathlib import Path

import numpy as np
import pytest

from pne_sym.mechanics.mobility import check_mobility
from pne_sym.model import body, home, joints, legs, reader
from pne_sym.model.errors import SpecError
from pne_sym.model.reader import from_mapping, from_text, to_full_form
from pne_sym.pipeline import compile_model
from pne_sym.starter import starter_text

PAGE = (Path(__file__).parents[2] / "docs" / "spec-format.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)


def test_the_complete_example() -> None:
    manipulator = from_text(blocks("toml")[0], ".toml", "my_robot.toml")
    assert [len(leg.joints) for leg in manipulator.legs] == [2, 2, 2]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_mobility(manipulator)
    module = types.ModuleType("my_robot")
    exec(compile_model(manipulator)["my_robot.py"], module.__dict__)
    tau = module.inverse_dynamics(module.HOME_X, np.zeros(3), np.zeros(3))
    assert np.isfinite(tau).all()


def test_the_full_form() -> None:
    (text,) = blocks("json")
    manipulator = from_text(text, ".json", "lift.json")
    assert from_mapping(to_full_form(manipulator), "again") == manipulator


def test_fragments_are_valid_in_a_specification() -> None:
    overrides = next(text for text in blocks("toml") if "joints.1.link.mass" in text)
    rest = 'name = "a"\nspace = "spatial"\nplatform.mass = 1\n'
    end = "[home]\nX = [0.09, 0, 0.5, 0, 0, 0, 1]\nq = [0, -1.5707963, 0.5]\n"
    (leg,) = from_text(rest + overrides + end, ".toml", "a.toml").legs
    assert (leg.joints[2].actuated, leg.joints[2].link.mass) == (False, 0.8)
    assert leg.platform_joint.offset == (0.0, 0.0, 0.01)


def test_inertia_forms_parse() -> None:
    lines = next(text for text in blocks("toml") if "principal values" in text).splitlines()
    assert len([tomllib.loads(line) for line in lines]) == 4


@pytest.mark.parametrize(
    "fields",
    [reader.FIELDS, legs.FIELDS, joints.FIELDS, joints.PLATFORM_FIELDS, body.FIELDS, home.FIELDS],
)
def test_every_field_is_documented(fields: tuple[str, ...]) -> None:
    assert [name for name in fields if f"`{name}" not in PAGE] == []


def test_messages_are_those_of_the_reader() -> None:
    example = blocks("toml")[0]
    changes = [
        ("base_point = [0.1, 0.8]", "base_pont = [0.1, 0.8]"),
        ('axis = "x"', "axis = [1, 1]"),
        ("platform_point = [0.1232051, -0.1866025]", "platform_point = [0.1232051, 0.5133975]"),
    ]
    for (old, new), shown in zip(changes, blocks("text")[0].splitlines(), strict=True):
        with pytest.raises(SpecError) as caught:
            from_text(example.replace(old, new), ".toml", "my_robot.toml")
        start, _, _ = shown.partition("...")
        assert str(caught.value).startswith(start)


def test_the_example_in_python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (text,) = blocks("python")
    test = doctest.DocTestParser().get_doctest(text, {}, "spec-format", None, 0)
    said: list[str] = []
    assert doctest.DocTestRunner().run(test, out=said.append).failed == 0, "".join(said)
    assert (tmp_path / "generated/pair/pair.py").is_file()


def test_the_notation_of_new() -> None:
    page = PAGE.partition("## A first file")[2].partition("## In an editor")[0]
    examples = re.findall(r"^\| `([0-9]-[^`]+)`", page, flags=re.MULTILINE)
    assert len(examples) == 5
    for architecture in examples + re.findall(r"--legs (\S+)", page):
        assert starter_text("my_robot", architecture)
