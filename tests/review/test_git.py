"""docs/code-review.md followed in a scratch repository: diff driver and workflow commands."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest

from tests.cli.program import HANG, PROGRAM, pne_gen
from tests.cli.test_diff import git, heavier
from tests.cli.test_generate import own_spec
from tests.sampling import sampled

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "docs/code-review.md").read_text()
WORKFLOW = next(re.finditer(r"```yaml\n(.*?)```", GUIDE, re.DOTALL)).group(1)


def shell(command: str, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    path = f"{PROGRAM.parent}{os.pathsep}{os.environ['PATH']}"
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


def step(name: str) -> str:
    """The commands of a step of the workflow."""
    found = re.search(
        rf"- name: {name}\n(?:        .*\n)*?        run: (.*\n(?:          .*\n)*)", WORKFLOW
    )
    assert found, name
    lines = found.group(1).split("\n")
    if lines[0] != "|":
        return lines[0]
    return "\n".join(line[10:] for line in lines[1:])


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
        assert "changed: default of platform.mass\n-   12.0\n+   14.0\n" in done.stdout
        plain = shell("git --no-pager diff --no-ext-diff", repository).stdout
        assert "-mass = 12.0  # kg" in plain
        git(repository, "commit", "-q", "-a", "-m", "heavier")
        assert (
            "default of platform.mass" in shell("git --no-pager show --ext-diff", repository).stdout
        )
    else:
        assert '-  "mass": 12.0,\n+  "mass": 14.0,' in done.stdout


def test_the_driver_lets_a_broken_file_pass(repository: Path) -> None:
    command = re.search(r"^git config diff\.pne\.command .*$", GUIDE, re.MULTILINE)
    assert command
    shell(command.group(), repository)
    (repository / "my_robot.toml").write_text("name = ")
    done = shell("git --no-pager diff", repository)
    assert done.returncode == 0
    assert "syntax error" in done.stderr


def test_the_workflows_own_commands(repository: Path) -> None:
    base = {"BASE": "main"}
    (repository / "robots").mkdir()
    spec = (repository / "my_robot.toml").rename(repository / "robots/my_robot.toml")
    assert pne_gen(spec, "--out", repository / "generated", real=True).returncode == 0
    git(repository, "add", "-A")
    git(repository, "commit", "-q", "-m", "a robot of its own")
    assert shell(step("Check"), repository).returncode == 0
    git(repository, "checkout", "-q", "-b", "change")
    pne_gen("sixbar", "--out", repository / "generated", real=True)
    module = repository / "generated/my_robot/my_robot.py"
    module.write_text(module.read_text().replace("_TOLERANCE = 1", "_TOLERANCE = 2", 1))
    checked = shell(step("Check"), repository)
    assert checked.returncode == 1
    assert "to mend it: pne-gen robots/my_robot.toml --out generated" in checked.stdout
    done = shell(step("Diff"), repository, **base)
    assert (done.returncode, done.stderr) == (0, "")
    comment = (repository / "comment.md").read_text()
    assert "## my_robot\n### ⚠️ different: not all is compared" in comment
    assert "my_robot.py: differs, line" in comment
    assert "## planar_3rpr\n### ✅ equal: identical text" in comment
    assert "## sixbar\nNew.\n" in comment


def test_the_workflow_is_yaml_that_names_no_secret_but_its_token() -> None:
    assert "pull_request_target" not in WORKFLOW
    assert "--run" not in WORKFLOW
    assert not re.search(r"install \.\s", WORKFLOW)
    assert re.findall(r"\$\{\{ ([\w.]+) \}\}", WORKFLOW) == [
        "github.base_ref",
        "github.token",
        "github.event.number",
        "github.event.number",
    ]


def test_attributes_of_this_repository() -> None:
    def attributes(path: str) -> dict[str, str]:
        out = git(ROOT, "check-attr", "-a", "--", path)
        return dict(line.split(": ")[1:] for line in out.splitlines())

    assert attributes("pne_sym/manipulators/stewart.toml")["diff"] == "pne"
    for kind in ("py", "c", "h", "json"):
        assert attributes(f"generated/stewart/stewart.{kind}")["linguist-generated"] == "set"
    assert attributes("generated/stewart/stewart.md")["linguist-generated"] == "unset"
