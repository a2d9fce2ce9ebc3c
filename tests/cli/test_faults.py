"""What is wrong with the input, in one message, and the exit code."""

from __future__ import annotations

import resource
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.cli.program import pne_gen, tree
from tests.cli.test_generate import own_spec


def assert_refused(done, *parts: str, code: int = 2) -> None:
    """One line of error, with the parts given, nothing else, and the exit code."""
    assert done.returncode == code, done.stderr
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith("pne-gen: error: ")
    for part in parts:
        assert part in done.stderr


def test_unknown_model_names_the_nearest(tmp_path: Path) -> None:
    assert_refused(pne_gen("stewrt", "--out", tmp_path / "out"), "'stewrt'", "did you mean stewart")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("word", "command"), [("lst", "list"), ("chekc", "check"), ("dif", "diff"), ("drew", "draw")]
)
def test_a_mistyped_command(word: str, command: str, tmp_path: Path) -> None:
    done = pne_gen(word, cwd=tmp_path)
    assert_refused(done, f"no command or manipulator '{word}'; did you mean pne-gen {command}?")
    assert list(tmp_path.iterdir()) == []


def test_unknown_second_model_leaves_nothing_written(tmp_path: Path) -> None:
    assert_refused(pne_gen("stewart", "zzz", "--out", tmp_path / "out"), "'zzz'")
    assert not (tmp_path / "out").exists()


def test_missing_spec_file(tmp_path: Path) -> None:
    assert_refused(pne_gen("no_such.toml", cwd=tmp_path), "no_such.toml: no such file")
    assert tree(tmp_path) == {}


def test_bad_spec_file(tmp_path: Path) -> None:
    (tmp_path / "bad.toml").write_text("name = ")
    assert_refused(pne_gen("bad.toml", cwd=tmp_path), "bad.toml")


def test_spec_with_an_unknown_field(tmp_path: Path) -> None:
    path = own_spec(tmp_path)
    path.write_text("gravitty = 1\n" + path.read_text())
    assert_refused(pne_gen(path), "gravitty", "gravity")


def test_a_manipulator_outside_the_method(tmp_path: Path) -> None:
    assert_refused(pne_gen("stewart", "--out", tmp_path, fault="outside"), "outside the method")


def test_two_sources_of_one_name(tmp_path: Path) -> None:
    path = own_spec(tmp_path)
    other = own_spec(tmp_path, "other")
    other.write_text(path.read_text())
    assert_refused(pne_gen(path, other, "--out", tmp_path / "out"), "both named 'my_robot'")


def test_control_characters_of_a_name_do_not_reach_the_terminal(tmp_path: Path) -> None:
    done = pne_gen("\x1b[31mred", "--out", tmp_path)
    assert done.returncode == 2
    assert "\x1b" not in done.stderr


@pytest.mark.parametrize("below", ["", "/deeper", "/deeper/still"])
def test_an_output_path_that_is_a_file(below: str, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    done = pne_gen("stewart", "--out", f"{tmp_path}/file{below}")
    assert_refused(done, f"cannot write {tmp_path}/file{below}", "is not a folder")
    assert tree(tmp_path) == {"file": b"mine"}


def test_a_folder_of_someone_else_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "stewart").mkdir()
    (tmp_path / "stewart/thesis.tex").write_text("mine")
    assert_refused(pne_gen("stewart", "--out", tmp_path), "refusing to replace")
    assert tree(tmp_path) == {"stewart/thesis.tex": b"mine"}


def test_an_internal_error_is_one_line_and_a_hint(tmp_path: Path) -> None:
    done = pne_gen("stewart", "--out", tmp_path, fault="bug")
    assert done.returncode == 3
    error, hint = done.stderr.splitlines()
    assert error == "pne-gen: error: internal error: RuntimeError: two lines"
    assert "--debug" in hint
    assert tree(tmp_path) == {}


def test_debug_shows_the_traceback_of_an_internal_error(tmp_path: Path) -> None:
    done = pne_gen("stewart", "--out", tmp_path, "--debug", fault="bug")
    assert done.returncode == 3
    assert "Traceback" in done.stderr


@pytest.mark.parametrize("command", [["stewart"], ["all"], ["check", "stewart"]])
@pytest.mark.parametrize("option", [["--out", ""], ["--out="], ["-o", ""]])
def test_an_output_folder_without_a_name(
    command: list[str], option: list[str], tmp_path: Path
) -> None:
    done = pne_gen(*command, *option, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert "the name of the folder is empty" in done.stderr
    assert tree(tmp_path) == {}


def test_an_unknown_option(tmp_path: Path) -> None:
    done = pne_gen("stewart", "--ouput", tmp_path)
    assert done.returncode == 2
    assert "No such option" in done.stderr
    assert "--ouput" in done.stderr


def test_no_model_at_all(tmp_path: Path) -> None:
    done = pne_gen("--out", tmp_path)
    assert done.returncode == 2
    assert "NAME_OR_SPEC" in done.stderr


def test_help_has_examples_and_exit_codes() -> None:
    done = pne_gen("--help")
    assert done.returncode == 0
    assert "pne-gen stewart --out generated/" in done.stdout
    assert "130 interrupted" in done.stdout


@pytest.mark.parametrize("word", ["stewart", "all", "list", "check"])
def test_every_command_has_help(word: str) -> None:
    done = pne_gen(word, "--help")
    assert done.returncode == 0
    assert done.stdout.startswith("Usage: pne-gen ")


def test_version_is_told_at_once() -> None:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = pne_gen("--version", real=True, fresh=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert done.stdout == f"pne-gen {version('pne-sym')}\n"
    # 0.13 s where it was written; of the processor, so that a busy machine does not count.
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < 2.0


@pytest.mark.parametrize(
    ("word", "slow"),
    [("--version", ("numpy", "sympy", "pydantic")), ("stewrt", ("sympy", "pydantic"))],
)
def test_what_is_told_at_once_waits_for_no_library(word: str, slow: tuple[str, ...]) -> None:
    done = pne_gen(word, real=True, PYTHONPROFILEIMPORTTIME="1")
    imported = {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}
    assert "click" in imported
    assert imported.isdisjoint(slow)
