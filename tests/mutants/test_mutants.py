"""The rows of faults fit the sources, and the script that plants them tells what it should."""

from __future__ import annotations

import ast
import sys
from pathlib import Path
from types import ModuleType

import pytest

from pne_sym.backends.templating import environment
from tests.mutants import run as script
from tests.mutants import trial
from tests.mutants.faults import ROOT, Fault, FaultError, faults
from tests.mutants.trial import Verdict, copy_sources, run_tests, try_fault

FAULTS = faults()
SAMPLE = [
    f for f in FAULTS if f.file in ("pne_sym/vector/dimensions.py", "pne_sym/model/rotation.py")
]
"""Whose tests take a second."""
SECONDS = 600.0
HARMLESS = Fault(
    "test-1",
    "nothing",
    "pne_sym/vector/dimensions.py",
    '"""Powers of kilogram, metre and second."""',
    '"""Powers of kg, m and s."""',
    ("tests/vector/test_dimensions.py",),
    (),
)


def test_there_are_enough_of_every_kind() -> None:
    assert len(FAULTS) >= 100
    assert len({f.name for f in FAULTS}) == len(FAULTS)
    assert len({(f.file, f.before, f.after) for f in FAULTS}) == len(FAULTS)
    parts = ("mechanics", "lowering", "program", "backends", "model", "vector")
    for folder in (*(f"pne_sym/{p}/" for p in parts), "templates/numpy/", "templates/c/"):
        assert sum(f.file.startswith(folder) for f in FAULTS) >= 2, folder


@pytest.mark.parametrize("fault", FAULTS, ids=lambda f: f.name)
def test_every_row_fits_the_sources(fault: Fault) -> None:
    """Its text is there once, its tests exist, and the file with the fault in it is still one."""
    text = fault.mutated((ROOT / fault.file).read_text(encoding="utf-8"))
    for test in (*fault.tests, *fault.wider):
        assert (ROOT / test.partition("::")[0]).exists(), test
    if fault.file.endswith(".jinja"):
        environment().parse(text)
        return
    ast.parse(text)
    if "_kinds/" not in fault.file:  # whose files enter themselves into a table
        imported(fault.file, text)


def imported(file: str, text: str) -> None:
    """Run the text of a module under another name."""
    name = file.removesuffix(".py").replace("/", ".")
    module = ModuleType(f"{name}_with_a_fault")
    module.__dict__.update(__package__=name.rpartition(".")[0], __file__=str(ROOT / file))
    sys.modules[module.__name__] = module
    try:
        exec(compile(text, file, "exec"), module.__dict__)
    finally:
        del sys.modules[module.__name__]


def test_a_row_that_no_longer_fits_is_an_error() -> None:
    with pytest.raises(FaultError, match=r"test-1: .* occurs 0 times in .*, expected once"):
        HARMLESS.mutated("def f(): pass")
    with pytest.raises(FaultError, match="occurs 2 times"):
        HARMLESS.mutated(HARMLESS.before * 2)


@pytest.mark.parametrize(
    ("row", "told"),
    [
        ('what = "x"\nfile = "f"\nbefore = "a"\nafter = "b"', "expected"),
        ('what = "x"\nfile = "f"\nbefore = "a"\nafter = "a"\ntests = ["t"]', "changes nothing"),
        ('what = "x"\nfile = "f"\nbefore = "a"\nafter = "b"\ntests = []', "names no test"),
        ('what = "x"\nfile = "f"\nbefore = "a"\nafter = "b"\ntests = ["t"]\nwhy = "c"', "why"),
    ],
)
def test_rows_that_say_too_little_or_too_much(row: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "rows.toml").write_text(f"[[fault]]\n{row}\n", encoding="utf-8")
    with pytest.raises(FaultError, match=f"rows-1: .*{told}"):
        faults(tmp_path)


# ---- trials ------------------------------------------------------------------------------------


def test_what_runs_is_the_copy(tmp_path: Path) -> None:
    top = copy_sources(tmp_path)
    (top / "tests/test_where.py").write_text(
        "import pne_sym, tests.mutants\n"
        "def test_where():\n"
        "    for module in (pne_sym, tests.mutants):\n"
        f"        assert module.__file__.startswith({str(top)!r})\n",
        encoding="utf-8",
    )
    assert run_tests(top, ["tests/test_where.py"], SECONDS).code == 0


@pytest.mark.parametrize("fault", SAMPLE, ids=lambda f: f.name)
def test_a_fault_is_found_by_the_tests_of_its_row(fault: Fault) -> None:
    before = (ROOT / fault.file).read_bytes()
    outcome = try_fault(fault, SECONDS, wider=False)
    assert outcome.verdict is Verdict.KILLED
    assert outcome.by.startswith(fault.tests[0])
    assert (ROOT / fault.file).read_bytes() == before


def replaced(**changes: object) -> Fault:
    return Fault(**{**vars(HARMLESS), **changes})  # type: ignore[arg-type]


@pytest.mark.only_in_all
def test_survivors_late_finds_and_wrong_rows(tmp_path: Path) -> None:
    assert try_fault(HARMLESS, SECONDS).verdict is Verdict.SURVIVED
    broken = 'raise NameError("nothing of that name")'
    for changes, wanted, told in (
        ({"after": broken}, Verdict.WRONG, ""),
        ({"tests": ("tests/no_such.py",)}, Verdict.WRONG, "exit code 4"),
        ({"needs": "no_such_module"}, Verdict.NOT_RUN, "needs no_such_module"),
    ):
        outcome = try_fault(replaced(**changes), SECONDS)
        assert outcome.verdict is wanted, outcome
        assert told in outcome.by
    late = replaced(
        before="result = result / known if k else result * known",
        after="result = result * known",
        tests=("tests/vector/test_rules.py",),
        wider=("tests/vector/test_dimensions.py",),
    )
    assert try_fault(late, SECONDS).verdict is Verdict.KILLED_LATE
    assert try_fault(late, SECONDS, wider=False).verdict is Verdict.SURVIVED


def test_a_mutant_that_runs_on_and_on_is_ended() -> None:
    endless = replaced(after='__import__("time").sleep(1e6)')
    outcome = try_fault(endless, 4.0)
    assert outcome.verdict is Verdict.TIMEOUT
    assert not outcome.verdict.is_good


@pytest.mark.parametrize(
    ("verdict", "code"),
    [
        (Verdict.KILLED, 0),
        (Verdict.NOT_RUN, 0),
        (Verdict.SURVIVED, 1),
        (Verdict.TIMEOUT, 1),
        (Verdict.WRONG, 1),
    ],
)
def test_exit_code_and_table(
    verdict: Verdict, code: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def outcome(fault: Fault, seconds: float, *, wider: bool) -> trial.Outcome:
        return trial.Outcome(fault, verdict if fault.name == "model-2" else Verdict.KILLED, "by")

    monkeypatch.setattr(script, "try_fault", outcome)
    assert script.main(["--only", "model", "--no-baseline", "-j", "2"]) == code
    told = capsys.readouterr().out
    names = [line.split(" | ")[0][2:] for line in told.splitlines() if line.startswith("| model-")]
    assert names == [f.name for f in FAULTS if f.name.startswith("model-")]
    assert (f"\n{verdict}: model-2: " in told) is (verdict is not Verdict.KILLED)


def test_without_a_fault_nothing_may_fail(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(script, "baseline", lambda chosen, seconds: "tests/x.py::test_y")
    assert script.main(["--only", "model"]) == 1
    assert "fails without a fault: tests/x.py::test_y" in capsys.readouterr().err
