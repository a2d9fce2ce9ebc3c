"""The recipes of docs/architecture.md, carried out in a scratch copy of the sources."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
_BLOCK = re.compile(r"^```(\w+) ?(.*)\n((?:.*\n)*?)```$", re.MULTILINE)


@dataclass(frozen=True)
class Block:
    """A block of code: its language, what the fence says of it, its text."""

    language: str
    said: str
    text: str

    def told(self, key: str) -> str:
        found = re.search(rf'{key}=(?:"([^"]*)"|(\S+))', self.said)
        return (found[1] or found[2]) if found else ""


def recipe(title: str) -> list[Block]:
    """The blocks below a heading of the recipes."""
    (section,) = re.findall(rf"^### {title}\n((?:(?!^#).*\n)*)", PAGE, re.MULTILINE)
    return [Block(*found) for found in _BLOCK.findall(section)]


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    folder = tmp_path / "copy"
    folder.mkdir()
    for name in ("pne_sym", "templates"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    (folder / "docs").mkdir()
    shutil.copy(ROOT / "docs/spec-format.md", folder / "docs")
    return folder


def write(copy: Path, blocks: list[Block]) -> None:
    """Do what the blocks say to the copy."""
    for block in blocks:
        if path := block.told("file"):
            assert not (copy / path).exists()
            (copy / path).write_text(block.text, encoding="utf-8")
        if path := block.told("in"):
            lines = (copy / path).read_text(encoding="utf-8").splitlines(keepends=True)
            (place,) = (k for k, line in enumerate(lines) if block.told("after") in line)
            lines[place + 1 : place + 1] = block.text.splitlines(keepends=True)
            (copy / path).write_text("".join(lines), encoding="utf-8")


def run(copy: Path, *command: str) -> str:
    done = subprocess.run(
        [sys.executable, *command],
        cwd=copy,
        env={**os.environ, "PYTHONPATH": str(copy), "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


PNE_GEN = ("-c", "import sys; from pne_sym.cli import main; sys.exit(main(sys.argv[1:]))")


def test_the_copy_is_what_runs(copy: Path) -> None:
    told = run(copy, "-c", "import pne_sym; print(pne_sym.__file__)")
    assert Path(told.strip()).is_relative_to(copy)


def test_an_output_function(copy: Path) -> None:
    blocks = recipe("Add an output function")
    assert len(blocks) == 3
    write(copy, blocks)
    (check,) = (b.text for b in blocks if b.said == "run")
    targets = "numpy,c,xp,octave"
    run(copy, *PNE_GEN, "planar_3rpr", "--target", targets, "--out", "generated_here")
    assert (copy / "generated_here/planar_3rpr/octave/+planar_3rpr/applied_force.m").is_file()
    header = (copy / "generated_here/planar_3rpr/planar_3rpr.h").read_text()
    assert "planar_3rpr_applied_force_batch(" in header
    assert (
        "def applied_force(" in (copy / "generated_here/planar_3rpr/planar_3rpr_xp.py").read_text()
    )
    run(copy, "-c", check)


def specification(copy: Path, model: str, name: str, *changes: tuple[str, str]) -> str:
    """A model of the catalogue under another name, with changes of its text; its file."""
    text = (copy / f"pne_sym/manipulators/{model}.toml").read_text(encoding="utf-8")
    for old, new in ((f'"{model}"', f'"{name}"'), *changes):
        assert old in text, old
        text = text.replace(old, new)
    (copy / f"{name}.toml").write_text(text, encoding="utf-8")
    return f"{name}.toml"


def documented(copy: Path, blocks: list[Block], letter: str) -> None:
    """The row of a kind stands in its table, below the others."""
    (row,) = (b.text for b in blocks if b.language == "md")
    assert row.startswith(f"| `{letter}` ")
    page = (copy / "docs/spec-format.md").read_text(encoding="utf-8").splitlines()
    before = page[page.index(row.rstrip()) - 1]
    assert before.startswith("| `")


@pytest.mark.only_in_all
def test_a_joint_kind(copy: Path) -> None:
    blocks = recipe("Add a joint kind")
    assert len(blocks) == 3
    write(copy, blocks)
    documented(copy, blocks, "N")
    nuts = (('kind = "H"', 'kind = "N"'), (", 5.0]", ", 0.25]"))
    names = "hexapod_6uhs", specification(copy, "hexapod_6uhs", "hexapod_6uns", *nuts)
    for name in names:
        run(copy, *PNE_GEN, name, "--target", "numpy", "--out", "generated_here")
    run(copy, "-c", blocks[-1].text)
    report = (copy / "generated_here/hexapod_6uns/hexapod_6uns.md").read_text(encoding="utf-8")
    assert "| 3 | nut | actuated |" in report
    told = run(copy, *PNE_GEN, "new", "mine.toml", "--legs", "6-UNS")
    assert (copy / "mine.toml").is_file(), told


@pytest.mark.only_in_all
def test_a_platform_joint(copy: Path) -> None:
    blocks = recipe("Add a platform joint")
    assert len(blocks) == 3
    write(copy, blocks)
    documented(copy, blocks, "slotted")
    end = 'kind = "U", axis_link = "y"'
    slotted = specification(
        copy, "tripod_3upu", "tripod_slotted", (end, end.replace('"U"', '"slotted"'))
    )
    hinge = '[[leg_types.upu.joints]]\nkind = "R"\naxis = "y"\n\n# base_point (base frame'
    hinged = specification(
        copy,
        "tripod_3upu",
        "tripod_hinged",
        (end, 'kind = "R", axis_link = "z"'),
        ("# base_point (base frame", hinge),
        (", 0.8],", ", 0.8, -0.2],"),
    )
    for name in (slotted, hinged):
        run(copy, *PNE_GEN, name, "--target", "numpy", "--out", "generated_here")
    run(copy, "-c", blocks[-1].text)


def test_a_back_end(copy: Path) -> None:
    blocks = recipe("Add a back end")
    assert len(blocks) == 3
    write(copy, blocks)
    (commands,) = (b.text for b in blocks if b.language == "sh")
    generate, check, explain = (line.split()[1:] for line in commands.splitlines())
    run(copy, *PNE_GEN, *generate)
    assert (copy / "out/planar_3rpr/listing/planar_3rpr.txt").is_file()
    assert "up to date" in run(copy, *PNE_GEN, *check)
    assert "c_1 =" in run(copy, *PNE_GEN, *explain)
    run(copy, *PNE_GEN, "planar_3rpr", "--out", "out/")
    assert not (copy / "out/planar_3rpr/listing").exists(), "stale"


def test_every_recipe_is_tested() -> None:
    recipes = PAGE.split("## Recipes")[1]
    assert re.findall(r"^### (.*)$", recipes, re.MULTILINE) == [
        "Add an output function",
        "Add a joint kind",
        "Add a platform joint",
        "Add a back end",
    ]
