"""`--target`: generated, checked, compared, explained, removed; of a target of tests and of xp."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

import pne_sym
from pne_sym import generation
from pne_sym.backends import registry
from pne_sym.backends.emission import emit
from pne_sym.backends.target import TargetError
from pne_sym.cli.app import app
from pne_sym.cli.arguments import arrange
from tests.backends import columns
from tests.cli.program import pne_gen, tree
from tests.cli.test_faults import assert_refused
from tests.cli.test_generate import own_spec
from tests.models import bundle, catalogue

MODEL = "fivebar_revolute"
XP = f"{MODEL}_xp.py"
H = f"columns/+{MODEL}/H.m"


def run(*arguments: str | Path) -> Result:
    """`pne-gen` in this process, where targets can be added."""
    return CliRunner().invoke(app, arrange([str(a) for a in arguments]))


@cache
def printed(manipulator, targets, known):
    return emit(bundle(manipulator), targets)


@pytest.fixture(autouse=True)
def compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    """The model is derived once for all tests, and printed once for each set of targets."""

    def compile_model(manipulator, targets=None):
        asked = None if targets is None else tuple(targets)
        return dict(printed(manipulator, asked, registry.TARGETS))

    monkeypatch.setattr("pne_sym.pipeline.compile_model", compile_model)


@pytest.fixture
def with_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registry, "TARGETS", (*registry.TARGETS, columns.TARGET))


def generated(out: Path, targets: str = "") -> Path:
    """A folder generated with targets."""
    done = run(MODEL, "--out", out, *(["--target", targets] if targets else []))
    assert done.exit_code == 0, done.output
    return out / MODEL


def pair(out: Path, targets: str) -> tuple[Path, Path]:
    before = generated(out / "before", targets)
    shutil.copytree(before, out / "after" / MODEL)
    return before, out / "after" / MODEL


def edit(path: Path, change: Callable[[str], str] = lambda text: text + "% mine\n") -> None:
    path.write_text(change(path.read_text()))


# --- a target that writes into folders ------------------------------------------------


def test_a_new_target_goes_all_the_way(with_columns: None, tmp_path: Path) -> None:
    """What is registered is generated, checked and removed when it is no longer wanted."""
    plain = tree(generated(tmp_path))
    folder = generated(tmp_path, "columns,numpy,c")
    found = tree(folder)
    assert found.keys() - plain.keys() >= {H, "columns/README.txt"}
    assert {p for p in plain if plain[p] != found[p]} == {f"{MODEL}.json"}
    assert json.loads(found[f"{MODEL}.json"])["targets"] == ["numpy", "c", "columns"]
    assert run("check", MODEL, "--out", tmp_path).exit_code == 0
    (folder / H).with_name("mine.m").write_text("mine\n")
    assert run("check", "--out", tmp_path).exit_code == 0
    generated(tmp_path)
    mine = {f"columns/+{MODEL}/mine.m": b"mine\n"}
    assert tree(folder) == plain | mine
    assert run("check", "--out", tmp_path).exit_code == 0


def test_check_knows_what_ought_to_be_there(with_columns: None, tmp_path: Path) -> None:
    folder = generated(tmp_path, "columns")
    before = tree(folder)
    assert f"{MODEL}.py" not in before
    edit(folder / H)
    (folder / H).with_name("M.m").unlink()
    (folder / H).with_name("old.m").write_text(columns.SIGNED)
    done = run("check", "--out", tmp_path)
    assert done.exit_code == 1
    for told in (f"changed: {folder / H}\n", f"missing: {folder}/columns/+{MODEL}/M.m\n"):
        assert told in done.output
    assert f"stale: {folder}/columns/+{MODEL}/old.m\n" in done.output
    assert "-% mine\n" in done.output
    last = done.output.splitlines()[-1]
    assert last == f"to mend it: pne-gen {MODEL} --out {tmp_path} --target columns"
    assert run(*last.split()[4:]).exit_code == 0
    assert tree(folder) == before


def test_diff_accounts_for_every_file_of_it(with_columns: None, tmp_path: Path) -> None:
    before, after = pair(tmp_path, "numpy,c,columns")
    assert run("diff", before, after).exit_code == 0
    assert run("diff", MODEL, after).exit_code == 0
    assert run("diff", after, MODEL).exit_code == 0
    edit(after / H)
    done = run("diff", before, after)
    assert done.exit_code == 1
    assert f"{H}: differs, line" in done.output
    assert f"{after}: {H}, line" in done.output
    assert "values not compared" in done.output
    (after / H).unlink()
    done = run("diff", before, after)
    assert (done.exit_code, f"{after}: {H}, missing" in done.output) == (1, True)


def test_diff_tells_the_user_s_files_among_them_from_ours(
    with_columns: None, tmp_path: Path
) -> None:
    """They are compared to the byte; nothing is derived for them, and nothing accounts for them."""
    before, after = pair(tmp_path, "numpy,c,columns")
    for folder, text in ((before, "mine\n"), (after, "yours\n")):
        (folder / H).with_name("mine.m").write_text(text)
    done = run("diff", before, after)
    assert done.exit_code == 1
    assert "mine.m: differs, line 1 (counts as different)" in done.output
    assert "not what this pne-gen prints" not in done.output
    (after / H).with_name("mine.m").write_text(columns.SIGNED)
    done = run("diff", before, after)
    assert done.exit_code == 1
    assert "mine.m, would not be printed" in done.output


def test_explain_has_it_as_a_stage(with_columns: None) -> None:
    done = run("explain", MODEL, "rrr-K1", "--stage", "columns")
    assert done.exit_code == 0, done.output
    assert "in H" in done.output
    assert "require true" not in done.output
    assert "S_x = " in done.output
    done = run("explain", MODEL, "--stage", "columns")
    assert f"% ---- {H}\nfunction found = H(X)\n" in done.output


def test_a_target_that_cannot_print_a_model_is_one_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    poor = replace(columns.TARGET, name="poor", backend="tests.backends.columns:PoorBackend")
    monkeypatch.setattr(registry, "TARGETS", (*registry.TARGETS, poor))
    done = run(MODEL, "--target", "numpy,poor", "--out", tmp_path / "out")
    assert done.exit_code == 2
    assert done.output.count("\n") == 1
    assert "the target poor cannot print" in done.output
    assert not (tmp_path / "out").exists()


# --- xp ----------------------------------------------------------------------------------


def test_xp_is_written_checked_and_removed(tmp_path: Path) -> None:
    folder = generated(tmp_path, "numpy,c,xp")
    compile((folder / XP).read_text(), XP, "exec")
    assert run("check", "--out", tmp_path).exit_code == 0
    done = run("check", "--out", tmp_path, "--target", "numpy,c")
    assert done.exit_code == 1
    assert f"stale: {folder / XP}\n" in done.output
    assert f"changed: {folder / MODEL}.json\n" in done.output
    generated(tmp_path)
    assert not (folder / XP).exists()
    done = run("check", "--out", tmp_path, "--target", "c,numpy,xp")
    assert f"missing: {folder / XP}\n" in done.output


def test_a_file_of_that_name_that_is_the_user_s(tmp_path: Path) -> None:
    folder = generated(tmp_path)
    (folder / XP).write_text("mine = 1\n")
    assert run("check", "--out", tmp_path).exit_code == 0
    generated(tmp_path)
    before = tree(folder)
    done = run(MODEL, "--target", "xp", "--out", tmp_path)
    assert (done.exit_code, done.output.count("\n")) == (2, 1)
    assert f"refusing to replace {folder / XP}: pne-gen did not write it" in done.output
    assert tree(folder) == before


def test_xp_in_diff(tmp_path: Path) -> None:
    """A changed module counts as different; it is not run, also where the others are."""
    before, after = pair(tmp_path, "numpy,c,xp")
    edit(after / XP, lambda text: text.replace("0.5 * ", "0.25 * ", 1))
    done = run("diff", before, after)
    assert done.exit_code == 1
    assert f"{XP}: differs, line" in done.output
    done = run("diff", before, after, "--run")
    assert done.exit_code == 1
    assert re.search(r"^  xp +not compared; its text differs", done.output, re.MULTILINE)
    assert re.search(r"^  the same: (?:.|\n    )*, C: all functions$", done.output, re.MULTILINE)


def test_folders_of_other_targets_are_different(tmp_path: Path) -> None:
    one, more = generated(tmp_path / "one"), generated(tmp_path / "more", "numpy,c,xp")
    done = run("diff", one, more)
    assert done.exit_code == 1
    assert f"{XP}: differs, only after (counts as different)" in done.output
    assert "note: targets: numpy, c -> numpy, c, xp" in done.output
    assert run("diff", more, MODEL).exit_code == 0


def test_a_folder_without_numpy_is_compared(tmp_path: Path) -> None:
    before, after = pair(tmp_path, "xp")
    assert run("diff", before, MODEL).exit_code == 0
    edit(after / XP)
    assert run("diff", before, after).exit_code == 1
    done = run("diff", before, after, "--run")
    assert done.exit_code == 1
    assert "its NumPy module cannot be run" in done.output


@pytest.mark.parametrize(
    ("targets", "code", "part"),
    [
        (["xp", "of_tomorrow"], 1, "its targets: no target 'of_tomorrow'; allowed are"),
        (["../x"], 2, "its entry 'targets' is not as pne_sym writes it"),
        ("numpy", 2, "its entry 'targets'"),
        ([], 2, "its entry 'targets'"),
    ],
)
def test_targets_of_a_stranger_s_manifest(
    targets: object, code: int, part: str, tmp_path: Path
) -> None:
    before, after = pair(tmp_path, "numpy,c")
    manifest = after / f"{MODEL}.json"
    manifest.write_text(json.dumps(json.loads(manifest.read_text()) | {"targets": targets}))
    for arguments in ((before, after), (MODEL, after)):
        done = run("diff", *arguments)
        assert (done.exit_code, part in done.output) == (code, True), done.output


def test_check_of_a_folder_with_targets_of_another_version(tmp_path: Path) -> None:
    manifest = generated(tmp_path) / f"{MODEL}.json"
    manifest.write_text(manifest.read_text().replace("{", '{"targets": ["of_tomorrow"],', 1))
    done = run("check", "--out", tmp_path)
    assert (done.exit_code, done.output.count("\n")) == (2, 1)
    assert f"{tmp_path / MODEL}: its manifest names its targets: no target" in done.output
    assert run("check", "--out", tmp_path, "--target", "numpy,c").exit_code == 1


def test_from_python(tmp_path: Path) -> None:
    pne_sym.generate(MODEL, tmp_path, ("numpy", "xp"))
    assert generation.check(MODEL, tmp_path) == []
    assert {d.path.name for d in generation.check(MODEL, tmp_path, ("numpy",))} == {
        XP,
        f"{MODEL}.json",
    }
    with pytest.raises(TargetError, match="no target 'matlab'; allowed are numpy, c, xp"):
        pne_sym.generate(MODEL, tmp_path, ("matlab",))
    assert sorted(pne_sym.compile_model(catalogue(MODEL), ["xp"])) == [
        f"{MODEL}.json",
        f"{MODEL}.md",
        XP,
    ]


# --- through the program itself --------------------------------------------------------------


@pytest.mark.parametrize("command", [("stewart",), ("all",), ("check", "stewart")])
def test_an_unknown_target_is_refused_before_all_else(command: str, tmp_path: Path) -> None:
    done = pne_gen(*command, "--out", tmp_path / "out", "--target", "numpy,matlab")
    allowed = "numpy, c, xp, octave, ext, with commas between"
    assert_refused(done, f"no target 'matlab'; allowed are {allowed}")
    assert not (tmp_path / "out").exists()


def test_targets_before_the_model_and_in_worker_processes(tmp_path: Path) -> None:
    assert pne_gen("--target", "xp", "stewart", "--out", tmp_path).returncode == 0
    assert (tmp_path / "stewart/stewart_xp.py").is_file()
    assert not (tmp_path / "stewart/stewart.c").exists()
    done = pne_gen("all", "--target", "c,xp", "--out", tmp_path, "--jobs", "2")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "delta/delta_xp.py").is_file()
    assert pne_gen("check", "--out", tmp_path, "--jobs", "2").returncode == 0


def test_a_command_that_mends_for_each_set_of_targets(tmp_path: Path) -> None:
    pne_gen("stewart", own_spec(tmp_path), "--target", "xp", "--out", tmp_path)
    pne_gen("delta", "--out", tmp_path)
    spec = str(tmp_path / "my_robot.toml")
    done = pne_gen("check", "stewart", "delta", spec, "--out", tmp_path, PNE_TEST_VERSION="2")
    assert done.returncode == 1  # of the stub, NAME.py alone has the version
    assert done.stdout.splitlines()[-1] == f"to mend it: pne-gen delta --out {tmp_path}"
    for name in ("stewart", "my_robot"):
        (tmp_path / f"{name}/{name}_xp.py").unlink()
    done = pne_gen("check", "stewart", "delta", spec, "--out", tmp_path, PNE_TEST_VERSION="2")
    assert done.stdout.splitlines()[-2:] == [
        f"to mend it: pne-gen stewart {spec} --out {tmp_path} --target xp",
        f"to mend it: pne-gen delta --out {tmp_path}",
    ]


def test_help_tells_the_targets() -> None:
    told = " ".join(pne_gen("stewart", "--help").stdout.split())
    for target in registry.TARGETS:
        assert (f"{target.name}: " in told) != target.always
    assert "--target NAMES" in told
    assert "[default: numpy,c]" in told
