"""`pne-gen diff` through the program itself: specs, folders, git revisions, its three outputs."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest

from tests.cli.program import pne_gen, tree
from tests.cli.test_faults import assert_refused
from tests.cli.test_generate import own_spec
from tests.sampling import sampled


def diff(*arguments: str | Path, cwd: Path | None = None):
    return pne_gen("diff", *arguments, real=True, cwd=cwd)


def git(folder: Path, *arguments: str) -> str:
    """Run git in a scratch repository, without the user's configuration."""
    done = subprocess.run(
        ["git", "-c", "user.name=test", "-c", "user.email=test@localhost", *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


def heavier(path: Path) -> None:
    path.write_text(path.read_text().replace("mass = 12.0", "mass = 14.0"))


@pytest.fixture(scope="module")
def repository(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two commits: a spec with its generated folder, then a heavier platform."""
    folder = tmp_path_factory.mktemp("repository")
    spec = own_spec(folder)
    git(folder, "init", "-q", "-b", "main")
    for edit in (lambda _: None, heavier):
        edit(spec)
        assert pne_gen(spec, "--out", folder / "generated", real=True).returncode == 0
        git(folder, "add", "-A")
        git(folder, "commit", "-q", "-m", "a version")
    return folder


def test_a_spec_and_itself() -> None:
    done = diff("planar_3rpr", "planar_3rpr")
    assert (done.returncode, done.stderr) == (0, "")
    assert "equal: identical text" in done.stdout
    assert "the text of all functions is the same" in done.stdout


def test_revisions_of_a_spec(repository: Path) -> None:
    done = diff("HEAD~1:my_robot.toml", "my_robot.toml", cwd=repository)
    assert (done.returncode, done.stderr) == (1, "")
    assert "different: platform: mass 12 -> 14 kg (+16.7 %)\n" in done.stdout
    assert "  platform: mass 12 -> 14 kg (+16.7 %)  [platform.mass]\n" in done.stdout
    assert "no equation changed" in done.stdout
    assert "required force of leg 1" in done.stdout
    assert diff("HEAD:./my_robot.toml", "my_robot.toml", "-q", cwd=repository).returncode == 0


def test_revisions_of_a_folder_and_the_spec(repository: Path) -> None:
    before = tree(repository / "generated")
    done = diff("main~1:generated/my_robot", "generated/my_robot/", "--json", cwd=repository)
    assert (done.returncode, done.stderr) == (1, "")
    found = json.loads(done.stdout)
    assert not found["equal"]
    assert found["equations"] == []
    assert found["not_compared"] == ""
    assert {f["path"] for f in found["files"] if f["accounted"]} == {
        f"my_robot.{kind}" for kind in ("c", "json", "py")
    }
    assert found["identical_equations"] > 50
    assert {b["verdict"] for b in found["blocks"]} == {"identical text"}
    assert [c["what"] for c in found["interface"]] == ["default of platform.mass"]
    assert diff("generated/my_robot", "my_robot.toml", cwd=repository).returncode == 0
    assert tree(repository / "generated") == before


def test_a_spoilt_folder(repository: Path, tmp_path: Path) -> None:
    folder = tmp_path / "my_robot"
    folder.mkdir()
    for name, content in tree(repository / "generated/my_robot").items():
        (folder / name).write_bytes(content)
    module = folder / "my_robot.py"
    text = module.read_text()
    spoilt = re.sub(r"(def _run_Z\(.*?    out_Z\[0\] = )", r"\1-", text, count=1, flags=re.DOTALL)
    assert spoilt != text
    module.write_text(spoilt)
    done = diff(repository / "generated/my_robot", folder, "--markdown")
    assert (done.returncode, done.stderr) == (1, "")
    assert "different: not all is compared" in done.stdout
    assert "my_robot.py: differs, line" in done.stdout
    assert "Values, at equal parameters" not in done.stdout
    done = diff(repository / "generated/my_robot", folder, "--markdown", "--run")
    assert (done.returncode, done.stderr) == (1, "")
    assert re.search(r"^  Z +different values", done.stdout, re.MULTILINE)
    assert re.search(r"^  the same: .*\bM,", done.stdout, re.MULTILINE)
    assert "C: all functions" in done.stdout


def test_markdown_of_another_mechanism() -> None:
    done = diff("stewart", "stewart_7ups", "--markdown")
    assert done.returncode == 1
    assert done.stdout.startswith("### ")
    assert "### ⚠️ different: leg 7 " in done.stdout
    assert "<details open><summary>Specification</summary>" in done.stdout
    assert "2 of platform" in done.stdout
    assert "a sum over 7 legs, was over 6" in done.stdout
    assert "-&#62;" in done.stdout


@pytest.mark.parametrize(
    ("before", "part"),
    [
        ("stewrt", "did you mean stewart"),
        ("no_such.toml", "no such file"),
        ("HEAD:no_such.toml", "git has no 'HEAD:no_such.toml'"),
        ("no_revision:my_robot.toml", "git has no"),
        ("HEAD:", "is no REVISION:PATH"),
        ("--output=x:y", "No such option"),
        ("HEAD:generated", "'stewart' is one model, 'HEAD:generated' holds several"),
        ("HEAD:generated/my_robot/my_robot.py", "file of kind '.py'"),
        ("generated", "'stewart' is one model, 'generated' holds several"),
    ],
)
def test_bad_input(before: str, part: str, repository: Path) -> None:
    done = diff(before, "stewart", cwd=repository)
    assert done.returncode == 2
    assert done.stdout == ""
    assert part in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("manifest", "module", "part"),
    [
        ("{", "", "is not JSON"),
        ("[]", "", "is not of pne_sym"),
        ('{"generator": "pne_sym"}', "", "its manifest has no 'name'"),
    ],
)
def test_a_folder_that_is_at_fault(
    manifest: str, module: str, part: str, repository: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "my_robot"
    folder.mkdir()
    (folder / "my_robot.json").write_text(manifest)
    (folder / "my_robot.py").write_text(module)
    assert_refused(diff(folder, "stewart"), part)


@pytest.mark.parametrize(
    ("module", "part"),
    sampled(
        [
            ("import nothing_like_this", "cannot be run: ModuleNotFoundError"),
            ("raise SystemExit(3)", "cannot be run"),
            ("def f(:", "cannot be run: SyntaxError"),
        ],
        3,
    ),
)
def test_a_module_that_is_at_fault(
    module: str, part: str, repository: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "my_robot"
    folder.mkdir()
    for name, content in tree(repository / "generated/my_robot").items():
        (folder / name).write_bytes(content)
    (folder / "my_robot.py").write_text(module)
    done = diff(repository / "generated/my_robot", folder, "--run")
    assert (done.returncode, done.stderr) == (1, "")
    assert "values not compared" in done.stdout
    assert part in done.stdout
    assert part not in diff(repository / "generated/my_robot", folder).stdout


def test_two_formats_exclude_each_other() -> None:
    assert_refused(diff("stewart", "stewart", "--json", "--markdown"), "exclude each other")
