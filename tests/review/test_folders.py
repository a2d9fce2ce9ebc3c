"""Folders under review are a stranger's: bounded, no link followed, manifests checked."""

from __future__ import annotations

import copy
import json
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pne_sym.backends.emission import emit
from pne_sym.generation import InputError
from pne_sym.model.full_form import to_full_form
from pne_sym.review import folders as reading
from pne_sym.review.folders import read_folder
from pne_sym.review.manifests import FORMATS, read_manifest
from pne_sym.review.reproduction import reproduced
from tests.cli.test_diff import git
from tests.models import bundle, catalogue, module
from tests.review.folders import diff, edit, find_version, pair, texts, write

MODEL = "planar_3rpr"
Manifest = dict[str, Any]


def manifest(name: str = MODEL) -> Manifest:
    return json.loads(texts(name)[f"{name}.json"])


@pytest.mark.parametrize("name", ["planar_3rpr", "fivebar_revolute", "tripod_3rps", "stewart"])
def test_the_manifest_holds_what_the_folder_is_printed_from(name: str, tmp_path: Path) -> None:
    found = manifest(name)
    assert found["format"] == FORMATS[-1] == 2
    assert found["specification"] == json.loads(json.dumps(to_full_form(catalogue(name))))
    model = reproduced(find_version(str(write(tmp_path, name))))
    assert model.deviations == ()
    assert model.bundle is not None
    assert emit(model.bundle) == texts(name)
    lines = texts(name)[f"{name}.json"].split("\n")
    legs = [line for line in lines if line.startswith("  {") and '"base_point"' in line]
    assert len(legs) == len(found["specification"]["legs"])


def test_folders_of_one_specification_with_another_value_are_compared(tmp_path: Path) -> None:
    before = write(tmp_path / "before", MODEL)
    form = copy.deepcopy(manifest()["specification"])
    form["platform"]["mass"] = 7.0
    spec = tmp_path / "heavier.json"
    spec.write_text(json.dumps(form))
    after = tmp_path / "after" / MODEL
    after.mkdir(parents=True)
    model = find_version(str(spec))
    assert model.bundle is not None
    for name, text in emit(model.bundle).items():
        (after / name).write_text(text)
    done = diff(before, after)
    assert done.exit_code == 1
    assert "different: platform: mass 4 -> 7 kg (+75 %)\n" in done.output
    assert "platform: mass 4 -> 7 kg (+75 %)  [platform.mass]\n" in done.output
    assert "values not compared" not in done.output
    least = np.linalg.eigvalsh(module(catalogue(MODEL)).M(module(catalogue(MODEL)).HOME_X))[0]
    found = re.search(r"least eigenvalue of M +(\S+) -> (\S+) \(\+", done.output)
    assert found  # with more mass it is greater
    assert found[1] == f"{least:.4g}"
    assert "printed by this pne-gen on both sides: planar_3rpr.c, planar_3rpr.json" in done.output
    assert diff(after, spec).exit_code == 0


def test_another_title_alone_is_no_difference_of_meaning(tmp_path: Path) -> None:
    before = write(tmp_path / "before", MODEL)
    form = manifest()["specification"] | {"title": "Another title"}
    spec = tmp_path / "titled.json"
    spec.write_text(json.dumps(form))
    done = diff(before, spec)
    assert done.exit_code == 0, done.output
    assert "equal: different text, the same values" in done.output
    assert "note: title: Planar 3-RPR platform -> Another title" in done.output


def as_format_1(text: str) -> str:
    found = json.loads(text) | {"format": 1}
    return json.dumps({k: v for k, v in found.items() if k not in ("functions", "specification")})


def test_format_1_is_read_and_says_what_it_cannot(tmp_path: Path) -> None:
    before, after = pair(tmp_path, MODEL)
    for folder in (before, after):
        edit(folder / f"{MODEL}.json", as_format_1)
    assert diff(before, after).exit_code == 0
    edit(after / f"{MODEL}.py", lambda text: f"{text}\n# a remark\n")
    done = diff(before, after)
    assert done.exit_code == 1
    assert "its manifest, of format 1, does not hold the specification" in done.output
    done = diff(before, after, "--run")
    assert done.exit_code == 1
    assert "different text, equal values" in done.output


FAULTS: dict[str, Callable[[Manifest], Any]] = {
    "format": lambda m: m.update(format=3),
    "sizes": lambda m: m["sizes"].update(NQ=10**9),
    "NQ": lambda m: m["sizes"].update(NQ=4),
    "coordinates": lambda m: m["coordinates"].update(X=[1, 2, 3]),
    "home": lambda m: m["home"].update(X=["0", "0", "0"]),
    "home ": lambda m: m["home"].update(X=[10**400, 0, 0]),
    "parameters": lambda m: m["parameters"][0].update(name="x; system()"),
    "parameters ": lambda m: m["parameters"][0].update(path="../" * 9),
    "impossible shape": lambda m: m["parameters"][0].update(shape=[9999, 9999]),
    "zero by structure": lambda m: m["parameters"][0].update(zero_by_structure=[3]),
    "one entry per leg": lambda m: m["parameters"][-1].update(legs=[0]),
    "one name": lambda m: m["parameters"].append(m["parameters"][0]),
    "functions": lambda m: m["functions"].update({"M(void); int x": m["functions"]["M"]}),
    "functions ": lambda m: m["functions"]["M"].update(inputs={"X": -1}),
    "specification": lambda m: m.update(specification=[]),
    "operations": lambda m: m["operations"].update(M=3),
    "leg_types": lambda m: m["leg_types"][0].update(branches={"b": [2]}),
    "actuator": lambda m: m["actuators"][0].__setitem__(0, 9),
    "another model": lambda m: m.update(name="other"),
    "not of pne_sym": lambda m: m.update(generator="x"),
}


@pytest.mark.parametrize("case", FAULTS)
def test_a_manifest_at_fault_is_refused(case: str, tmp_path: Path) -> None:
    folder = write(tmp_path, MODEL)
    spoilt = manifest()
    FAULTS[case](spoilt)
    (folder / f"{MODEL}.json").write_text(json.dumps(spoilt))
    done = diff(folder, folder)
    assert done.exit_code == 2
    assert case.strip() in done.output
    assert len(done.output) < 600


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("{", "is not JSON"),
        ("[]", "is not of pne_sym"),
        ('{"a": 1, "a": 2}', "stands twice"),
        ('{"generator": "pne_sym", "a": ' + "[" * 100_000 + "]" * 100_000 + "}", "deep"),
        (f'{{"generator": "pne_sym", "name": {"9" * 5000}}}', "not JSON"),
        (" " * (5 * 2**20), "is larger than"),
    ],
)
def test_a_text_that_is_no_manifest(text: str, part: str) -> None:
    with pytest.raises(InputError) as caught:
        read_manifest(text, "it")
    assert part in str(caught.value)
    assert len(str(caught.value)) < 500


def test_a_specification_that_is_refused_is_not_derived(tmp_path: Path) -> None:
    before, after = pair(tmp_path, MODEL)
    edit(after / f"{MODEL}.json", lambda text: text.replace('"mass": 4.0', '"mass": -4.0', 1))
    done = diff(before, after)
    assert done.exit_code == 1
    assert "the specification in its manifest is refused" in done.output


def test_links_are_not_followed(tmp_path: Path) -> None:
    before, after = pair(tmp_path, MODEL)
    secret = tmp_path / "secret"
    secret.write_text("a secret\n")
    (after / f"{MODEL}.md").unlink()
    (after / f"{MODEL}.md").symlink_to(secret)
    (after / "more").symlink_to(tmp_path)
    done = diff(before, after)
    assert done.exit_code == 1
    assert "a file before, a link after" in done.output
    assert "more: differs, only after" in done.output
    assert "a secret" not in done.output
    (after / f"{MODEL}.json").unlink()
    (after / f"{MODEL}.json").symlink_to(before / f"{MODEL}.json")
    assert diff(before, after).exit_code == 2


def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    before, after = pair(tmp_path, MODEL)
    (after / "notes.txt").unlink(missing_ok=True)
    os.mkfifo(after / "notes.txt")
    done = diff(before, after)
    assert done.exit_code == 1
    assert "notes.txt: differs, only after" in done.output


def test_limits_of_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "a/x").write_bytes(bytes(300))
    (tmp_path / "a/y").write_bytes(bytes(300))
    monkeypatch.setattr(reading, "MOST_FILES", 1)
    with pytest.raises(InputError, match="more than 1 files"):
        read_folder(tmp_path / "a")
    monkeypatch.setattr(reading, "MOST_FILES", 9)
    monkeypatch.setattr(reading, "LARGEST_FOLDER", 500)
    with pytest.raises(InputError, match="larger than 500 bytes"):
        read_folder(tmp_path / "a")
    monkeypatch.setattr(reading, "LARGEST_FILE", 200)
    with pytest.raises(InputError, match="larger than 200 bytes"):
        read_folder(tmp_path / "a")
    (tmp_path / "b/c/d/e/f/g/h/i/j/k").mkdir(parents=True)
    with pytest.raises(InputError, match="levels deep"):
        read_folder(tmp_path / "b")


def test_a_tree_of_git_is_read_as_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All files, links as links, limits before contents; from a folder below the root too."""
    git(tmp_path, "init", "-q", "-b", "main")
    folder = write(tmp_path / "generated", MODEL)
    (folder / "link").symlink_to("/etc/hostname")
    (folder / "sub").mkdir()
    (folder / "sub/ä b").write_text("more")
    git(tmp_path, "add", "-A")
    git(tmp_path, "commit", "-q", "-m", "a version")
    monkeypatch.chdir(folder)
    there = find_version(f"main:generated/{MODEL}")
    assert there.folder == read_folder(folder)
    assert there.folder["link"].kind == "link"
    assert there.folder["sub/ä b"].content == b"more"
    assert diff("main:./", folder).exit_code == 2  # a folder without a name of its own
    assert diff(f"main:generated/{MODEL}", folder).exit_code == 0
    monkeypatch.setattr(reading, "LARGEST_FILE", 2000)
    with pytest.raises(InputError, match="larger than 2000 bytes"):
        find_version(f"main:generated/{MODEL}")


def test_a_copy_of_another_name_is_found_by_its_manifest(tmp_path: Path) -> None:
    folder = write(tmp_path, MODEL)
    folder.rename(tmp_path / "copy.old")
    assert find_version(str(tmp_path / "copy.old")).name == MODEL


def test_a_derived_model_is_the_same_as_its_folder() -> None:
    assert emit(bundle(catalogue(MODEL))) == texts(MODEL)
