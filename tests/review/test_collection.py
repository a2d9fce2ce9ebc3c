"""Folders of models in one answer; the limit of a comment kept by leaving out, and saying so."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from pne_sym.review import model
from pne_sym.review.diff_text import Section
from pne_sym.review.markdown import LIMIT, Part, comment, escaped
from pne_sym.review.model import Model
from pne_sym.review.sources import Source
from tests.cli.test_generate import own_spec
from tests.review.folders import diff, write


@pytest.fixture
def pairs(tmp_path: Path) -> tuple[Path, Path]:
    """Two folders of the same two models."""
    before, after = tmp_path / "before", tmp_path / "after"
    for name in ("planar_3rpr", "fivebar_revolute"):
        write(before, name)
    shutil.copytree(before, after)
    return before, after


def test_equal_models_are_told_in_one_line(pairs: tuple[Path, Path]) -> None:
    done = diff(*pairs, "--markdown")
    assert done.exit_code == 0
    assert done.output == (
        "### ✅ all 2 models are equal\n\nEqual: `fivebar_revolute`, `planar_3rpr`.\n"
    )
    assert "equal: fivebar_revolute, planar_3rpr" in diff(*pairs).output


def test_one_that_cannot_be_compared_does_not_stop_the_others(pairs: tuple[Path, Path]) -> None:
    before, after = pairs
    (after / "planar_3rpr/planar_3rpr.json").write_text("{")
    shutil.rmtree(after / "fivebar_revolute")
    spec = own_spec(after)
    done = diff(before, after)
    assert done.exit_code == 1, done.output
    assert "planar_3rpr: cannot be compared: " in done.output
    assert "fivebar_revolute: deleted: " in done.output
    assert f"{spec.stem}: new model: " in done.output
    told = json.loads(diff(before, after, "--json").output)
    assert told["equal"] is False
    assert told["models"].keys() == {"planar_3rpr", "fivebar_revolute", spec.stem}


def test_an_internal_error_of_one_model_does_not_stop_the_others(
    pairs: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(source: Source) -> Model:
        raise ZeroDivisionError("a fault of ours")

    before, after = pairs
    (after / "planar_3rpr/planar_3rpr.md").write_text("other")
    monkeypatch.setattr(model, "version_of", broken)
    done = diff(before, after)
    assert done.exit_code == 1
    assert "planar_3rpr: cannot be compared: internal error: ZeroDivisionError" in done.output
    assert "equal: fivebar_revolute" in done.output


def test_why_values_are_not_compared_is_told_of_each_model(pairs: tuple[Path, Path]) -> None:
    before, after = pairs
    module = after / "planar_3rpr/planar_3rpr.py"
    module.write_text(module.read_text() + "\n# a remark\n")
    done = diff(before, after)
    assert "\nvalues not compared: " in done.output
    assert "note: equations, interface and operations are compared as the" in done.output


def test_a_place_is_kept_when_folders_are_compared(pairs: tuple[Path, Path]) -> None:
    module = pairs[1] / "planar_3rpr/planar_3rpr.py"
    module.write_text(module.read_text() + "\n# a remark\n")
    done = diff(*pairs, "--markdown")
    assert done.exit_code == 1
    assert "#### planar\\_3rpr: different: not all is compared; first at planar\\_3rpr.py line" in (
        done.output
    )
    assert "Equal: `fivebar_revolute`." in done.output


def test_no_model(tmp_path: Path) -> None:
    spec = own_spec(tmp_path)
    done = diff("/dev/null", spec, "--as", "robots/my_robot.toml")
    assert done.exit_code == 1
    assert done.output.startswith(
        "--- no model\n+++ b/robots/my_robot.toml\n\nmy_robot: new model: "
    )
    assert str(tmp_path) not in done.output
    assert "my_robot: deleted: " in diff(spec, "/dev/null").output
    assert diff("/dev/null", "/dev/null").exit_code == 0


def part(name: str, lines: int) -> Part:
    made = tuple(f"{name} line {k} " + 80 * "é" for k in range(lines))
    sections = (
        Section("specification", made[:2]),
        Section("structure", made),
        Section("rewritings and counts", made, detail=True),
    )
    return Part(name, "different: something was edited", sections=sections)


@pytest.mark.parametrize(
    ("count", "lines", "what"),
    [
        (3, 10, ""),
        (3, 100, "too long: rewritings and counts."),
        (9, 300, "too long: structure; rewritings and counts."),
        (190, 100, "models no more than the headline: the comment"),
        (2000, 10, "further models, left out: m"),
    ],
)
def test_the_limit_of_a_comment(count: int, lines: int, what: str) -> None:
    parts = [part(f"m{k}", lines) for k in range(count)]
    made = list(comment(parts))
    text = "\n".join(made)
    assert len(text.encode()) <= LIMIT
    assert what in text
    assert bool(what) == ("too long" in text)
    if count < 500:
        assert all(f"#### m{k}: " in text for k in range(count))
    else:
        assert "further models" in text
    assert text.count("<details") == text.count("</details>")
    assert f"{count} of {count} models differ" in text


def test_effects_are_left_out_after_equations() -> None:
    """What a change means is read before how it came about."""
    lines = tuple(f"line {k} {80 * 'e'}" for k in range(40))
    titles = ("specification", "structure", "values", "interface", "effect")
    made = [
        Part(f"m{k}", "different", sections=tuple(Section(t, lines) for t in titles))
        for k in range(5)
    ]
    text = "\n".join(comment(made))
    assert text.count("<summary>Effect</summary>") == 5
    assert 0 < text.count("<summary>Structure</summary>") < 5
    assert "> Left out, as the comment would be too long: structure; interface." in text


def test_nothing_in_a_headline_acts() -> None:
    assert escaped("a -> b | @all <b> & #1 `x` _y_") == (
        "a -&#62; b &#124; &#64;all &#60;b&#62; &#38; &#35;1 \\`x\\` \\_y\\_"
    )
