"""`pne-gen NAME_OR_SPEC --out DIR` and `pne-gen all`, through the installed program."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import pne_sym.manipulators
from pne_sym.cli.app import _check, _generate
from pne_sym.cli.console import Report, Step
from pne_sym.generation import Compiled
from pne_sym.model.manipulator import Manipulator
from tests.cli.program import PROGRAM, environment, on_a_terminal, pne_gen, tree

STEWART_SPEC = Path(pne_sym.manipulators.__file__).with_name("stewart.toml")


def own_spec(folder: Path, name: str = "my_robot") -> Path:
    """The catalogue's Stewart platform as a file of one's own."""
    path = folder / f"{name}.toml"
    path.write_text(STEWART_SPEC.read_text().replace('name = "stewart"', f'name = "{name}"'))
    return path


def test_writes_the_model_and_says_so(tmp_path: Path) -> None:
    done = pne_gen("stewart", "--out", "generated", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("wrote generated/stewart: 4 files")
    assert set(tree(tmp_path)) == {
        "generated/__init__.py",
        *(
            f"generated/stewart/{file}"
            for file in ("__init__.py", "stewart.c", "stewart.json", "stewart.py")
        ),
    }


def test_the_written_package_imports(tmp_path: Path) -> None:
    pne_gen("stewart", "--out", "generated", cwd=tmp_path)
    subprocess.run(
        [sys.executable, "-c", "from generated import stewart; assert stewart.version == 1"],
        cwd=tmp_path,
        check=True,
    )


@pytest.mark.parametrize(
    "arguments",
    [
        ("stewart", "--out", "DIR"),
        ("--out", "DIR", "stewart"),
        ("-q", "stewart", "-o", "DIR"),
        ("--out=DIR", "stewart"),
    ],
)
def test_options_may_stand_before_and_after(arguments: tuple[str, ...], tmp_path: Path) -> None:
    done = pne_gen(*arguments, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "DIR/stewart/stewart.py").is_file()


def test_several_models_and_files_at_once(tmp_path: Path) -> None:
    done = pne_gen("stewart", own_spec(tmp_path), "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out/stewart/stewart.py").is_file()
    assert (tmp_path / "out/my_robot/my_robot.py").is_file()


def test_all_writes_the_catalogue(tmp_path: Path) -> None:
    done = pne_gen("all", "--out", tmp_path, "--jobs", "2")
    assert done.returncode == 0, done.stderr
    told = [line.split(":")[0] for line in done.stdout.splitlines() if line[0] != " "]
    assert told == [f"wrote {tmp_path / name}" for name in pne_sym.manipulators.names()]


@pytest.mark.parametrize(
    ("fault", "code", "told"),
    [
        ("warning", 0, "pne-gen: warning: stewart: unusual inertia\n"),
        ("outside", 2, "outside the method\n"),
        ("bug", 3, "internal error"),
    ],
)
def test_what_a_worker_process_finds_is_told(
    fault: str, code: int, told: str, tmp_path: Path
) -> None:
    done = pne_gen("all", "--out", tmp_path, "--jobs", "2", fault=fault)
    assert done.returncode == code
    assert told in done.stderr
    assert "Traceback" not in done.stderr


def test_quiet_says_nothing(tmp_path: Path) -> None:
    done = pne_gen("stewart", "--out", tmp_path, "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_a_second_run_writes_the_same_bytes(tmp_path: Path) -> None:
    pne_gen("stewart", "--out", tmp_path / "a")
    first = tree(tmp_path / "a")
    pne_gen("stewart", "--out", tmp_path / "a")
    assert tree(tmp_path / "a") == first


def test_a_file_of_an_earlier_generation_disappears(tmp_path: Path) -> None:
    pne_gen("stewart", "--out", tmp_path)
    (tmp_path / "stewart/stewart.h").write_text("")
    pne_gen("stewart", "--out", tmp_path)
    assert not (tmp_path / "stewart/stewart.h").exists()


def test_a_warning_is_one_line(tmp_path: Path) -> None:
    done = pne_gen("stewart", "--out", tmp_path, fault="warning")
    assert done.returncode == 0
    assert done.stderr == "pne-gen: warning: stewart: unusual inertia\n"


def test_progress_shows_on_a_terminal_and_leaves_the_result(tmp_path: Path) -> None:
    code, shown = on_a_terminal("stewart", "--out", tmp_path)
    assert code == 0
    assert "\x1b[" in shown
    assert f"wrote {tmp_path}/stewart" in shown


def test_help_is_a_word_too() -> None:
    assert pne_gen("help").stdout == pne_gen("--help").stdout
    assert pne_gen("help", "draw").stdout == pne_gen("draw", "--help").stdout


def test_list_has_tabs_between_when_piped() -> None:
    done = pne_gen("list")
    assert done.returncode == 0
    rows = [line.split("\t") for line in done.stdout.splitlines()]
    assert [row[0] for row in rows] == list(pne_sym.manipulators.names())
    facts = {row[0]: row[1:] for row in rows}
    assert facts["stewart"] == ["6-UPS Stewart platform", "6", "6 P", "6-UPS"]
    assert facts["stewart_sps"][1:] == ["12 (6 passive)", "6 P", "6-URPS"]
    assert facts["planar_mixed"][1:] == ["3", "2 P + 1 R", "1-RPR+1-RRR+1-PRR"]
    assert facts["planar_4rpr"][1:] == ["3", "4 P", "4-RPR"]


def test_list_is_a_table_on_a_terminal() -> None:
    code, shown = on_a_terminal("list", COLUMNS="150")
    head, *lines = shown.splitlines()
    assert code == 0
    assert head.split() == ["name", "DOF", "actuators", "legs", "title"]
    assert len(lines) == len(pne_sym.manipulators.names())
    for column in head.split():
        place = head.index(column)
        assert all(line[place - 1] == " " != line[place] for line in lines if place)


@pytest.mark.parametrize("run", [_generate, _check])
def test_progress_names_the_model_at_work(
    run: Callable[..., object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its name is shown before the work on it begins, and that of no other."""
    shown: list[str] = []
    at_work: list[tuple[str, str]] = []

    def compile_many(
        models: list[Manipulator], jobs: int, targets: dict[str, tuple[str, ...]]
    ) -> Iterator[Compiled]:
        for model in models:
            at_work.append((model.name, shown[-1]))
            yield Compiled(model, {f"{model.name}.json": "{}"})

    monkeypatch.setattr("pne_sym.generation.compile_many", compile_many)
    monkeypatch.setattr(Step, "working_on", lambda self, text: shown.append(text))
    names = ["sixbar", "delta", "stewart"]
    if run is _generate:
        run(names, tmp_path, "numpy,c", jobs=1, quiet=True)
    else:
        run(names, tmp_path, ("numpy", "c"), jobs=1, report=Report(quiet=True))
    assert at_work == [(name, name) for name in names]


@pytest.mark.parametrize(
    "arguments", ["list", "check delta --out {}/none", "diff fivebar_revolute {}/changed.toml"]
)
def test_a_reader_that_leaves_early_is_told_nothing_but_not_0(
    arguments: str, tmp_path: Path
) -> None:
    """Neither is all done, nor is it known that nothing differs."""
    fivebar = STEWART_SPEC.with_name("fivebar_revolute.toml").read_text()
    (tmp_path / "changed.toml").write_text(fivebar.replace("mass = ", "mass = 1", 1))
    command = f"{PROGRAM} {arguments.format(tmp_path)} | true; echo ${{PIPESTATUS[0]}}"
    real = environment(real="diff" in arguments)
    done = subprocess.run(
        ["bash", "-c", command], env=real, capture_output=True, text=True, check=True
    )
    assert (done.stdout, done.stderr) == ("141\n", "")


@pytest.mark.parametrize(
    "arguments",
    ["list", "check delta --out {}/none", "explain fivebar_revolute", "--help", "--version"],
)
def test_a_full_disk_under_the_output_is_one_line(arguments: str, tmp_path: Path) -> None:
    real = environment(real="explain" in arguments)
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [PROGRAM, *arguments.format(tmp_path).split()],
            env=real,
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 2
    assert done.stderr == (
        "pne-gen: error: cannot write to standard output: No space left on device\n"
    )
