"""The proofs' alarms are read, explained or failed."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from tests.hostile.interface import read_header
from tests.tools import prove
from tests.tools.prove import Alarm

REPOSITORY = Path(__file__).parents[2]
FOLDER = REPOSITORY / "generated/fivebar_revolute"
LOG = """[eva] Analyzing a complete application starting at main
[eva:alarm] /x/arm.c:12: Warning: 
  out of bounds read. assert \\valid_read(a + i);
[eva:loop-unroll:auto] /x/arm.c:13: Automatic loop unrolling.
[eva:alarm] driver.c:7: Warning: 
  accessing uninitialized left-value.
  assert
  \\initialized(x + i);
[eva:alarm] /x/arm.c:30: Warning: assertion got status unknown.
[eva:alarm] /x/arm.c:139: Warning: 
  non-finite float value. assert \\is_finite((float)NAN);
[eva] done for function main
"""  # noqa: W291


def test_every_alarm_is_read() -> None:
    assert prove.alarms(LOG) == [
        Alarm(7, "accessing uninitialized left-value. assert \\initialized(x + i);"),
        Alarm(12, "out of bounds read. assert \\valid_read(a + i);"),
        Alarm(30, "assertion got status unknown."),
        Alarm(139, "non-finite float value. assert \\is_finite((float)NAN);"),
    ]


def test_what_is_explained_holds_for_one_analysis() -> None:
    found = prove.alarms(LOG)
    assert [alarm.line for alarm in prove.unexplained("numbers", found)] == [7, 12, 30]
    assert [alarm.line for alarm in prove.unexplained("safety", found)] == [7, 12, 30, 139]


def test_explanations_are_sentences() -> None:
    assert all(len(reason.split()) > 5 for reason in prove.EXPLAINED.values())


def compile_driver(text: str, folder: Path) -> None:
    (folder / "__fc_builtin.h").write_text(
        "void Frama_C_make_unknown(char *p, unsigned long n);\n"
        "double Frama_C_double_interval(double low, double high);\n"
    )
    (folder / "driver.c").write_text(text)
    command = ["gcc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-Wno-unused", "-fsyntax-only"]
    subprocess.run([*command, f"-I{FOLDER}", f"-I{folder}", folder / "driver.c"], check=True)


@pytest.mark.parametrize("analysis", ["safety", "numbers"])
def test_the_drivers_call_every_function_in_both_ways(analysis: str) -> None:
    model = read_header(FOLDER / "fivebar_revolute.h")
    calls = Counter[str]()
    for part in prove.parts(model, analysis):
        text = prove.driver(model, analysis, part)
        calls.update(set(re.findall(r"\bfivebar_revolute_(\w+)\(", text)) - {"prepare"})
    left_out = prove.NOT_IN_NUMBERS if analysis == "numbers" else ()
    names = [function.name for function in model.functions if function.name not in left_out]
    assert calls == Counter([*names, *(f"{name}_batch" for name in names)])


@pytest.mark.parametrize("analysis", ["safety", "numbers"])
@pytest.mark.parametrize("function", ["prepare", "inverse_dynamics"])
def test_drivers_compile(analysis: str, function: str, tmp_path: Path) -> None:
    model = read_header(FOLDER / "fivebar_revolute.h")
    chosen = [part for part in prove.parts(model, analysis) if part.function == function]
    for part in chosen:
        compile_driver(prove.driver(model, analysis, part), tmp_path)
    assert {part.form for part in chosen} >= {"state"}
    prepared = prove.driver(model, analysis, prove.PREPARE)
    assert ("_prepare(&params," in prepared) == (analysis == "safety")


@pytest.mark.parametrize(("ci", "code"), [("true", 1), ("", 0)])
def test_without_frama_c_nothing_is_proved(
    ci: str, code: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(prove.shutil, "which", lambda _: None)
    monkeypatch.setenv("CI", ci)
    assert prove.main([str(FOLDER.parent), "fivebar_revolute"]) == code
    assert "*** NOT RUN: prove" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("log", "in_time", "told"),
    [
        (LOG.replace("[eva] done for function main", ""), False, "no result within 9 s"),
        (LOG, True, "the function's end is not reached"),
        ("[eva] driver.c:40: Frama_C_show_each_end:\n" + LOG, True, ""),
    ],
)
def test_runs_that_stop_before_the_end_are_no_proofs(
    log: str, in_time: bool, told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(command: list[str], **_: object) -> subprocess.CompletedProcess[str]:
        if in_time:
            return subprocess.CompletedProcess(command, 0, log, "")
        raise subprocess.TimeoutExpired(
            command, 9, log.encode()
        )  # bytes, although text is asked for

    monkeypatch.setattr(prove.subprocess, "run", run)
    found, fault = prove.analyse(FOLDER, "safety", prove.Part("M", "state"), 9.0)
    assert found == prove.alarms(LOG)
    assert fault == told


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        (
            "",
            [
                "M, state: no alarm",
                "M, batch: no alarm",
                "Z, state: no alarm",
                "Z, batch: no alarm",
            ],
        ),
        (
            "no result within 9 s",
            [
                "M, state: no result within 9 s; no alarm",
                "M, batch: not run, one state has no result",
                "Z, state: no alarm",
                "Z, batch: no alarm",
            ],
        ),
    ],
)
def test_functions_one_at_a_time(
    fault: str, told: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def analyse(*arguments: Any) -> tuple[list[Alarm], str]:
        return [], fault if arguments[2] == prove.Part("M", "state") else ""

    monkeypatch.setattr(prove.shutil, "which", lambda _: "frama-c")
    monkeypatch.setattr(prove, "analyse", analyse)
    options = ["--analysis", "safety", "--only", "Z", "M"]
    assert prove.main([str(FOLDER.parent), FOLDER.name, *options]) == bool(fault)
    lines = capsys.readouterr().out.splitlines()
    assert [line.rsplit(", ", line.endswith(" s"))[0] for line in lines] == [
        f"fivebar_revolute safety {line}" for line in told
    ]


ARM_H = """/* The arm.
 * X: x
 */
#include <stddef.h>
#define ARM_NQ 1
typedef double arm_real;
typedef struct { arm_real mass; } arm_params;
typedef struct { arm_real mass; } arm_model;
extern const arm_params arm_default_params;
extern const arm_real arm_HOME_X[ARM_NQ];
int arm_prepare(const arm_params *params, arm_model *model);
/* Weight. In: X (NQ). Out: weight (NQ). */
int arm_weight(const arm_model *model, const arm_real *X, arm_real *weight);
size_t arm_weight_batch(const arm_model *model, size_t n, const arm_real *X, arm_real *weight,
    int *status);
"""
ARM_C = """#include "arm.h"
const arm_params arm_default_params = {1};
const arm_real arm_HOME_X[ARM_NQ] = {1};
int arm_prepare(const arm_params *params, arm_model *model)
{
    model->mass = params->mass;
    return 0;
}
int arm_weight(const arm_model *model, const arm_real *X, arm_real *weight)
{
    weight[0] = model->mass*X[0];
    return 0;
}
size_t arm_weight_batch(const arm_model *model, size_t n, const arm_real *X, arm_real *weight,
    int *status)
{
    for (size_t i = 0; i < n; ++i) {
        status[i] = arm_weight(model, X + i, weight + i);
    }
    return 0;
}
"""


@pytest.mark.skipif(shutil.which("frama-c") is None, reason="frama-c is not installed")
@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("", "", ""),
        ("X[0];", "X[9];", "out of bounds read"),
        ("i < n;", "i <= n;", "out of bounds"),
        ("model->mass*X[0]", "model->mass*X[0]/(X[0] - 1.02)", "non-finite double value"),
        (
            "weight[0] = model->mass*X[0]",
            "weight[0] = 1/(0*X[0])",
            "the function's end is not reached",
        ),
        ("    weight[0] = model", "    double w;\n    weight[0] = w*model", "uninitialized"),
    ],
)
def test_faults_are_alarms(
    old: str, new: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "arm").mkdir()
    (tmp_path / "arm/arm.h").write_text(ARM_H)
    (tmp_path / "arm/arm.c").write_text(ARM_C.replace(old, new) if old else ARM_C)
    code = prove.main([str(tmp_path), "arm"])
    said = capsys.readouterr().out
    assert "failed" not in said
    assert code == bool(told)
    assert told in said
