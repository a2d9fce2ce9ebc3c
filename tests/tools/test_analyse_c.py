"""The analysers find what they are there to find, and read all that templates can print."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.tools import analyse_c
from tests.tools.test_compile_c import SOURCE, folder_with

REPOSITORY = Path(__file__).parents[2]
ENDS = "    return 0;"
UNINITIALISED = """    double x[1];
    if (params->mass > 0) {
        x[0] = 1;
    }
    model->params.mass = x[0];
    return 0;"""
NULL = "    const arm_params *p = 0;\n    return p->mass > 0;"
BEYOND = "    int x[3] = {0, 0, 0};\n    return x[3];"
SIGNED = "    signed char c = (signed char)params->mass;\n    return (unsigned char)c == c ? 0 : c;"
FLOATING = (
    "    int n = 0;\n    for (float x = 0; x < 1; x += 0.1F) {\n        ++n;\n    }\n    return n;"
)


def planted(tmp_path: Path, fault: str, monkeypatch: pytest.MonkeyPatch, tool: str) -> int:
    if shutil.which(tool) is None:
        pytest.skip(f"{tool} is not installed")
    monkeypatch.setattr(analyse_c, "COMMANDS", {tool: analyse_c.COMMANDS[tool]})
    return analyse_c.main([str(folder_with(tmp_path, source=SOURCE.replace(ENDS, fault)))])


@pytest.mark.parametrize("tool", analyse_c.COMMANDS)
def test_clean_code_passes(tool: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert planted(tmp_path, ENDS, monkeypatch, tool) == 0


@pytest.mark.parametrize(
    ("tool", "fault"),
    [
        ("gcc", NULL),
        ("clang", NULL),
        ("clang", UNINITIALISED),
        ("clang-tidy", SIGNED),
        ("clang-tidy", FLOATING),
        ("cppcheck", NULL),
        ("cppcheck", BEYOND),
    ],
)
def test_a_fault_is_found(
    tool: str, fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert planted(tmp_path, fault, monkeypatch, tool) == 1


@pytest.mark.parametrize(("ci", "code"), [("true", 1), ("", 0)])
def test_a_missing_tool_is_seen_and_fails_in_ci(
    ci: str,
    code: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(analyse_c, "COMMANDS", {"no-such-tool": ("no-such-tool", "")})
    monkeypatch.setenv("CI", ci)
    assert analyse_c.main([str(folder_with(tmp_path))]) == code
    assert "*** NOT RUN: check-analysers with no-such-tool" in capsys.readouterr().err


def test_no_source_at_all_fails(tmp_path: Path) -> None:
    assert analyse_c.main([str(tmp_path)]) == 1


def test_the_sample_has_every_line_of_the_templates_that_the_catalogue_has() -> None:
    lines = {
        line.strip()
        for path in (REPOSITORY / "templates/c").glob("*.c.jinja")
        for line in path.read_text().splitlines()
        if "{{" not in line and "{%" not in line
    }
    printed = {
        path.stem: {line.strip() for line in path.read_text().splitlines()} & lines
        for path in (REPOSITORY / "generated").glob("*/*.c")
    }
    in_sample = set().union(*(printed[name] for name in analyse_c.SAMPLE))
    assert set().union(*printed.values()) <= in_sample
    assert len(in_sample) > 300


def test_what_is_switched_off_has_a_reason() -> None:
    for checks in analyse_c.OFF.values():
        assert all(len(reason.split()) > 5 for reason in checks.values())
    for tool, (before, after) in analyse_c.COMMANDS.items():
        switched = {word[1:] for word in before.split("=")[-1].split(",") if word.startswith("-")}
        assert switched - {"*"} <= set(analyse_c.OFF.get(tool, {})), (before, after)
