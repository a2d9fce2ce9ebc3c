"""docs/code-review.md followed in a scratch repository: the diff driver."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest

from tests.cli import forked
from tests.cli.program import HANG, pne_gen
from tests.cli.test_diff import git, heavier
from tests.cli.test_generate import own_spec
from tests.sampling import sampled

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "docs/code-review.md").read_text()


def shell(command: str, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    path = f"{forked.program().parent}{os.pathsep}{os.environ['PATH']}"
    identity = {
        f"GIT_{who}_{what}": "test@localhost"
        for who in ("AUTHOR", "COMMITTER")
        for what in ("NAME", "EMAIL")
    }
    return subprocess.run(
        ["bash", "-eo", "pipefail", "-c", command],
        cwd=folder,
        env={**os.environ, "PATH": path, **identity, **variables},
        capture_output=True,
        text=True,
        timeout=HANG,
        check=False,
    )


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """A base branch with a spec and two generated models."""
    git(tmp_path, "init", "-q", "-b", "main")
    own_spec(tmp_path)
    (tmp_path / ".gitattributes").write_text("*.toml diff=pne\n")
    made = pne_gen("planar_3rpr", "--out", tmp_path / "generated", real=True)
    assert made.returncode == 0, made.stderr
    git(tmp_path, "add", "-A")
    git(tmp_path, "commit", "-q", "-m", "base")
    return tmp_path


@pytest.mark.parametrize("recipe", sampled(["textconv", "command"], 2))
def test_the_diff_driver(recipe: str, repository: Path) -> None:
    command = re.search(rf"^git config diff\.pne\.{recipe} .*$", GUIDE, re.MULTILINE)
    assert command
    assert shell(command.group(), repository).returncode == 0
    heavier(repository / "my_robot.toml")
    done = shell("git --no-pager diff", repository)
    assert (done.returncode, done.stderr) == (0, "")
    if recipe == "command":
        assert "different: platform: mass 12 -> 14 kg (+16.7 %)" in done.stdout
        assert "--- a/my_robot.toml\n+++ b/my_robot.toml\n" in done.stdout
        plain = shell("git --no-pager diff --no-ext-diff", repository).stdout
        assert "-mass = 12.0  # kg" in plain
        git(repository, "commit", "-q", "-a", "-m", "heavier")
        shown = shell("git --no-pager show --ext-diff", repository).stdout
        assert "platform: mass 12 -> 14 kg" in shown
    else:
        assert '-  "mass": 12.0,\n+  "mass": 14.0,' in done.stdout


def test_a_renamed_file_is_called_by_both_names(repository: Path) -> None:
    command = re.search(r"^git config diff\.pne\.command .*$", GUIDE, re.MULTILINE)
    assert command
    assert shell(command.group(), repository).returncode == 0
    git(repository, "mv", "my_robot.toml", "its robot.toml")
    heavier(repository / "its robot.toml")
    done = shell("git --no-pager diff -M HEAD", repository)
    assert done.returncode == 0
    assert "--- a/my_robot.toml\n+++ b/its robot.toml\n" in done.stdout


def test_the_driver_lets_a_broken_file_pass(repository: Path) -> None:
    command = re.search(r"^git config diff\.pne\.command .*$", GUIDE, re.MULTILINE)
    assert command
    shell(command.group(), repository)
    (repository / "my_robot.toml").write_text("name = ")
    done = shell("git --no-pager diff", repository)
    assert done.returncode == 0
    assert "b/my_robot.toml: syntax error" in done.stderr


def test_the_driver_tells_new_and_deleted_files(repository: Path) -> None:
    command = re.search(r"^git config diff\.pne\.command .*$", GUIDE, re.MULTILINE)
    assert command
    shell(command.group(), repository)
    spec = repository / "my_robot.toml"
    spec.rename(repository / "other.toml")
    git(repository, "add", "-A")
    done = shell("git --no-pager diff --cached --no-renames", repository)
    assert (done.returncode, done.stderr) == (0, "")
    assert "--- a/my_robot.toml\n+++ no model\n\nmy_robot: deleted: " in done.stdout
    assert "--- no model\n+++ b/other.toml\n\nother: new model: " in done.stdout
    assert "/tmp" not in done.stdout


def test_attributes_of_this_repository() -> None:
    def attributes(path: str) -> dict[str, str]:
        out = git(ROOT, "check-attr", "-a", "--", path)
        return dict(line.split(": ")[1:] for line in out.splitlines())

    assert attributes("pne_sym/manipulators/stewart.toml")["diff"] == "pne"
    for kind in ("py", "c", "h", "json"):
        assert attributes(f"generated/stewart/stewart.{kind}")["linguist-generated"] == "set"
    assert attributes("generated/stewart/stewart.md")["linguist-generated"] == "unset"
