"""The workflows of docs/code-review.md: each step under `bash -e`, repositories of both kinds."""

from __future__ import annotations

import os
import re
import stat
import subprocess
from pathlib import Path

import pytest

from tests.cli import forked
from tests.cli.program import HANG, pne_gen
from tests.cli.test_diff import git, heavier
from tests.cli.test_generate import own_spec

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "docs/code-review.md").read_text()
REVIEW, OWN, COMMENT = re.findall(r"```yaml\n(.*?)\n```", GUIDE, re.DOTALL)

GH = """#!/usr/bin/env bash
# Answers as the API does, from files; writes down what it is asked to write.
set -e
echo "$*" >> "$GH_LOG"
case "$*" in
  *"/pulls/"*) cat "$GH_STATE/head" ;;
  *"--paginate"*"/comments"*)
    while read -r id user first; do
      test "$user $first" = "github-actions[bot] <!-- pne-gen diff -->" && echo "$id" || true
    done < "$GH_STATE/comments" ;;
  *"--method"*) cp body.md "$GH_STATE/written" ;;
  *) exit 1 ;;
esac
"""
PIP = '#!/usr/bin/env bash\necho "$*" >> "$PIP_LOG"\n'


def steps(workflow: str) -> dict[str, str]:
    """Commands of a workflow's steps, by name."""
    found = re.finditer(
        r"- name: (\w+)\n(?:        .*\n)*?        run: (.*\n(?:          .*(?:\n|$))*)",
        f"{workflow}\n",
    )
    return {m[1]: _commands(m[2].rstrip("\n").split("\n")) for m in found}


def _commands(lines: list[str]) -> str:
    return lines[0] if lines[0] != "|" else "\n".join(line[10:] for line in lines[1:])


class Runner:
    """Runs steps as a GitHub runner does, in a scratch repository."""

    def __init__(self, place: Path) -> None:
        self.place = place
        self.folder = place / "repository"
        self.folder.mkdir()
        programs = place / "bin"
        programs.mkdir()
        for name, text in (("gh", GH), ("python", PIP)):
            file = programs / name
            file.write_text(text)
            file.chmod(file.stat().st_mode | stat.S_IXUSR)
        path = [str(programs), str(forked.program().parent), os.environ["PATH"]]
        self.variables = {
            "PATH": os.pathsep.join(path), "BASE": "main~0", "NUMBER": "7", "SPECS": "robots",
            "MODELS": "generated", "REPO": "me/robots", "HEAD": "abc123",
            "GITHUB_STEP_SUMMARY": str(place / "summary"), "GH_LOG": str(place / "gh.log"),
            "GH_STATE": str(place), "PIP_LOG": str(place / "pip.log"),
        }  # fmt: skip

    def run(self, command: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            ["bash", "-e", "-c", command],
            cwd=self.folder,
            env={**os.environ, **self.variables},
            capture_output=True,
            text=True,
            timeout=HANG,
            check=False,
        )

    def commit(self) -> None:
        git(self.folder, "add", "-A")
        git(self.folder, "commit", "-q", "-m", "a version")

    def review(self) -> str:
        """The step Diff: what it writes."""
        done = self.run(steps(REVIEW)["Diff"])
        assert (done.returncode, done.stderr) == (0, "")
        text = (self.folder / "review/comment.md").read_text()
        assert (self.place / "summary").read_text().endswith(text)
        assert (self.folder / "review/number").read_text() == "7\n"
        return text


@pytest.fixture
def runner(tmp_path: Path) -> Runner:
    """A repository with a base branch of two generated models."""
    made = Runner(tmp_path)
    git(made.folder, "init", "-q", "-b", "main")
    out = made.folder / "generated"
    assert pne_gen("planar_3rpr", "--out", out, real=True).returncode == 0
    assert pne_gen("fivebar_revolute", "--out", out, real=True).returncode == 0
    made.commit()
    return made


def test_a_repository_of_ones_own(runner: Runner) -> None:
    assert runner.run(steps(REVIEW)["Install"]).returncode == 0
    assert (runner.place / "pip.log").read_text() == "-I -m pip install pne-sym\n"
    robots = runner.folder / "robots"
    robots.mkdir()
    spec = own_spec(robots)
    out = runner.folder / "generated"
    assert pne_gen(spec, "--out", out, real=True).returncode == 0
    for name in ("planar_3rpr", "fivebar_revolute"):
        git(runner.folder, "rm", "-rq", f"generated/{name}")
    runner.commit()
    assert runner.run(steps(REVIEW)["Check"]).returncode == 0
    git(runner.folder, "checkout", "-q", "-b", "change")
    heavier(spec)
    checked = runner.run(steps(REVIEW)["Check"])
    assert checked.returncode == 1
    assert "to mend it: pne-gen robots/my_robot.toml --out generated" in checked.stdout
    assert pne_gen(spec, "--out", out, real=True).returncode == 0
    text = runner.review()
    assert text.startswith("### ⚠️ 1 of 1 models differ\n")
    assert "#### my\\_robot: different: platform: mass 12 -&#62; 14 kg (+16.7 %)\n" in text
    assert "required force of leg 1" in text


def test_pne_sym_itself(runner: Runner) -> None:
    assert runner.run(steps(OWN)["Install"]).returncode == 0
    assert (runner.place / "base/generated/planar_3rpr/planar_3rpr.md").exists()
    assert (runner.place / "pip.log").read_text() == "-I -m pip install ../base\n"
    assert runner.run(steps(OWN)["Check"]).returncode == 0
    git(runner.folder, "checkout", "-q", "-b", "change")
    generated = runner.folder / "generated"
    module = generated / "planar_3rpr/planar_3rpr.py"
    module.write_text(module.read_text().replace("_TOLERANCE = 1", "_TOLERANCE = 2", 1))
    git(runner.folder, "rm", "-rq", "generated/fivebar_revolute")
    (generated / "broken").mkdir()
    (generated / "broken/broken.json").write_text("{")
    assert runner.run(steps(OWN)["Check"]).returncode in (1, 2)
    text = runner.review()
    assert "#### fivebar\\_revolute: deleted: " in text
    assert "#### planar\\_3rpr: different: not all is compared; first at planar\\_3rpr.py" in text
    assert "planar_3rpr.py: differs, line" in text
    assert "#### broken: cannot be compared: 'generated/broken': its manifest is not JSON" in text


def test_no_models_before_or_after(runner: Runner) -> None:
    git(runner.folder, "checkout", "-q", "-b", "change")
    git(runner.folder, "rm", "-rq", "generated")
    assert "2 of 2 models differ" in runner.review()
    runner.commit()
    git(runner.folder, "branch", "-f", "main", "change")
    assert "all 0 models are equal" in runner.review()
    assert pne_gen("planar_3rpr", "--out", runner.folder / "generated", real=True).returncode == 0
    assert "planar\\_3rpr: new model: Planar 3-RPR platform" in runner.review()


def test_what_cannot_be_compared_at_all_is_told(runner: Runner) -> None:
    (runner.folder / "generated").rename(runner.folder / "gone")
    (runner.folder / "generated").mkdir()
    (runner.folder / "generated/notes.txt").write_text("nothing")
    text = runner.review()
    assert text.startswith("The models cannot be compared.\n````\npne-gen: error: ")


def commented(runner: Runner, comments: str, head: str = "abc123") -> tuple[int, str]:
    """The step Comment: its exit code and what it asked of GitHub."""
    review = runner.folder / "review"
    review.mkdir(exist_ok=True)
    (review / "number").write_text("7\n")
    (review / "comment.md").write_text("### ✅ all 2 models are equal\n")
    (runner.place / "head").write_text(f"{head}\n")
    (runner.place / "comments").write_text(comments)
    log = runner.place / "gh.log"
    log.unlink(missing_ok=True)
    done = runner.run(steps(COMMENT)["Comment"])
    return done.returncode, log.read_text()


MARK = "<!-- pne-gen diff -->"


def test_one_comment_is_kept_and_nobody_elses_is_touched(runner: Runner) -> None:
    others = f"1 github-actions[bot] Coverage\n2 somebody {MARK}\n"
    code, log = commented(runner, others)
    assert code == 0
    assert "--method POST repos/me/robots/issues/7/comments -F body=@body.md" in log
    assert (runner.place / "written").read_text() == f"{MARK}\n### ✅ all 2 models are equal\n"
    code, log = commented(runner, f"{others}3 github-actions[bot] {MARK}\n")
    assert code == 0
    assert "--method PATCH repos/me/robots/issues/comments/3 -F body=@body.md" in log
    assert "POST" not in log


def test_a_comment_goes_to_the_pull_request_that_was_reviewed(runner: Runner) -> None:
    code, log = commented(runner, "", head="another")
    assert code != 0
    assert "--method" not in log
    (runner.folder / "review/number").write_text("$(touch hacked)")
    done = runner.run(steps(COMMENT)["Comment"])
    assert done.returncode != 0
    assert not (runner.folder / "hacked").exists()


def test_a_link_in_the_artifact_is_not_followed(runner: Runner) -> None:
    """It could point to what the second workflow alone may read."""
    commented(runner, "")
    (runner.place / "gh.log").unlink()
    secret = runner.place / "secret"
    for name, text in (("number", "7\n"), ("comment.md", "a token")):
        file = runner.folder / "review" / name
        kept = file.read_text()
        secret.write_text(text)
        file.unlink()
        file.symlink_to(secret)
        assert runner.run(steps(COMMENT)["Comment"]).returncode != 0
        assert not (runner.place / "gh.log").exists()
        file.unlink()
        file.write_text(kept)


def test_rights() -> None:
    assert "pull_request_target" not in GUIDE.replace("`pull_request_target`", "")
    assert "--run" not in REVIEW + OWN + COMMENT
    assert "persist-credentials: false" in REVIEW
    assert "permissions:\n  contents: read\n" in REVIEW
    assert "write" not in REVIEW
    assert "checkout" not in COMMENT
    assert "pull-requests: write" in COMMENT
    assert re.findall(r"\$\{\{ ([\w.]+) \}\}", REVIEW) == ["github.base_ref", "github.event.number"]
    for command in (*steps(REVIEW).values(), *steps(OWN).values(), *steps(COMMENT).values()):
        assert "${{" not in command
    assert set(steps(REVIEW)) == {"Install", "Check", "Diff"}
