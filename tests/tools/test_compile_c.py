"""The check that compiles the generated C finds what it is there to find."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.tools import compile_c

HEADER = """#ifndef ARM_H
#define ARM_H
#ifndef ARM_REAL
#define ARM_REAL double
#endif
#ifdef __cplusplus
extern "C" {
#endif
typedef ARM_REAL arm_real;
typedef struct { arm_real mass; } arm_params;
typedef struct { arm_params params; } arm_model;
extern const arm_params arm_default_params;
int arm_prepare(const arm_params *params, arm_model *model);
#ifdef __cplusplus
}
#endif
#endif
"""
SOURCE = """#include "arm.h"
const arm_params arm_default_params = {(arm_real)0.1};
int arm_prepare(const arm_params *params, arm_model *model)
{
    model->params.mass = (arm_real)2.0 * params->mass;
    return 0;
}
"""


def folder_with(tmp_path: Path, header: str = HEADER, source: str = SOURCE) -> Path:
    (tmp_path / "arm").mkdir()
    (tmp_path / "arm/arm.h").write_text(header)
    (tmp_path / "arm/arm.c").write_text(source)
    return tmp_path


@pytest.fixture(autouse=True)
def installed_compilers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only what is installed here, and gcc and g++ at least."""
    pairs = [pair for pair in compile_c.COMPILERS if all(map(shutil.which, pair))]
    assert ("gcc", "g++") in pairs
    monkeypatch.setattr(compile_c, "COMPILERS", pairs)


def test_clean_code_passes(tmp_path: Path) -> None:
    assert compile_c.main(folder_with(tmp_path)) == 0


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("(arm_real)2.0", "2.0"),  # a double in code that is compiled as float
        ("    return 0;", "    int unused;\n    return 0;"),
        ("    return 0;", "    return (int)params->mass == 0 ? model->params.mass : 0;"),
        ("    return 0;", "    return 0; // not C90, but C99\n    {int model = 1; (void)model;}"),
        ("#include", "#error\n#include"),
    ],
)
def test_a_warning_in_the_source_fails(old: str, new: str, tmp_path: Path) -> None:
    assert compile_c.main(folder_with(tmp_path, source=SOURCE.replace(old, new))) == 1


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('extern "C" {', "namespace arm {"),  # the object's names cannot be found from C++
        ("arm_model *model);", "arm_model *class);"),
        ("#ifndef ARM_H\n", "#if 1\n"),  # included twice
        ("ARM_REAL arm_real", "double arm_real[1]"),
    ],
)
def test_a_header_that_cxx_cannot_use_fails(old: str, new: str, tmp_path: Path) -> None:
    assert compile_c.main(folder_with(tmp_path, header=HEADER.replace(old, new))) == 1


def test_no_source_at_all_fails(tmp_path: Path) -> None:
    assert compile_c.main(tmp_path) == 1


@pytest.mark.parametrize(("ci", "code"), [("true", 1), ("", 0)])
def test_a_missing_compiler_is_seen_and_fails_in_ci(
    ci: str,
    code: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(compile_c, "COMPILERS", [("gcc", "g++"), ("no-such-cc", "no-such-c++")])
    monkeypatch.setenv("CI", ci)
    assert compile_c.main(folder_with(tmp_path)) == code
    assert "*** NOT RUN: check-c with no-such-cc: not installed ***" in capsys.readouterr().err
