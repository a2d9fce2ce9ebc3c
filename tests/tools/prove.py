"""Prove that the generated C has no run-time errors: `python -m tests.tools.prove FOLDER NAME ...`.

Frama-C's Eva analyses all public functions of each model, one state and batches with lanes and
a remainder, in two ways:

* safety: states, parameters and the prepared model are any bits at all, NaN and infinity among
  them.  Proved absent: accesses beyond an array or through a bad pointer, reads of what was never
  written, signed overflow, division by zero of integers, bad shifts, conversions out of range.
* numbers: states in a box, default parameters; infinite and NaN results of
  arithmetic are alarms too.

An alarm that EXPLAINED does not hold fails, and so does an explanation that is not needed.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from tests.hostile.interface import Array, Interface, read_header

BATCH = 9  # a lane of 8 states, and a remainder
OPTIONS = (
    *"-machdep gcc_x86_64 -eva -eva-no-results -eva-auto-loop-unroll 49 -eva-slevel 3".split(),
)
# Iterations are not told apart by the ways through them: there are too many.
MERGED = ("{name}_forward_kinematics", "{name}_project")
SAFETY = ("-warn-special-float", "none")
NUMBERS = ("-warn-special-float", "non-finite")

# Half the width of the box in which the arithmetic is analysed, about a pose beside home and about
# zero (velocities, accelerations, forces).  Not about home: there symmetry makes candidates for a
# pivot equally long, and the analysis joins the two orders of rows into one that has no pivot.
# What iterates is left out: intervals cannot follow its steps.
BOX_POSE, BOX_OTHER = 1e-3, 1.0
ITERATED = ("forward_kinematics", "project", "condition")

# (analysis, text of the alarm) -> why it is none.
EXPLAINED = {
    ("numbers", "assert \\is_finite((float)NAN);"): (
        "NaN is what an impossible state gives, written on purpose"
    ),
}


def driver(model: Interface, analysis: str) -> str:
    """A C program that calls what is analysed."""
    name = model.name
    lines = [
        f'#include "{name}.h"', "#include <stddef.h>", '#include "__fc_builtin.h"', "",
        f"static {name}_params params;", f"static {name}_model model;",
        "static int status[9];", "",
    ]  # fmt: skip
    if analysis == "safety":
        lines += [
            "static void choose(double *x, size_t n, const double *home, double reach)", "{",
            "    (void)home, (void)reach;",
            "    Frama_C_make_unknown((char *)x, n*sizeof *x);", "}", "",
        ]  # fmt: skip
    else:
        lines += [
            "static void choose(double *x, size_t n, const double *home, double reach)", "{",
            "    for (size_t k = 0; k < n; ++k) {",
            "        const double centre = home ? home[k] + (k%2 ? -0.01 : 0.02)*(k + 1) : 0;",
            "        x[k] = centre + Frama_C_double_interval(-reach, reach);",
            "    }", "}", "",
        ]  # fmt: skip
    functions = [f for f in model.functions if analysis == "safety" or f.name not in ITERATED]
    for f in functions:
        lines += [f"static void call_{f.name}(void)", "{"]
        lines += [f"    static double in_{a.name}[{BATCH * a.size}];" for a in f.inputs]
        lines += [f"    double out_{a.name}[{BATCH * a.size}];" for a in f.outputs]
        for a in f.inputs:
            lines += _chosen(name, a)
        none = any(a.optional for a in f.inputs)
        for chosen in [False, True] if none else [False]:
            arguments = ["&model"] * f.has_model
            given = [f"{'NULL' if a.optional and chosen else f'in_{a.name}'}" for a in f.inputs]
            given += [f"out_{a.name}" for a in f.outputs]
            lines.append(f"    {name}_{f.name}({', '.join([*arguments, *given])});")
            states = 2 if f.name in ITERATED else BATCH  # no lanes there, but long analyses
            many = ", ".join([*arguments, str(states), *given, "status"])
            lines.append(f"    {name}_{f.name}_batch({many});")
        lines += ["}", ""]
    lines += ["int main(void)", "{"]
    if analysis == "safety":
        lines += [
            "    Frama_C_make_unknown((char *)&params, sizeof params);",
            f"    {name}_prepare(&params, &model);",
            "    Frama_C_make_unknown((char *)&model, sizeof model);",
        ]
    else:
        lines.append(f"    {name}_prepare(&{name}_default_params, &model);")
    lines += [f"    call_{f.name}();" for f in functions]
    return "\n".join([*lines, "    return 0;", "}", ""])


def _chosen(name: str, a: Array) -> list[str]:
    homes = {"X": "HOME_X", "X0": "HOME_X", "q0": "HOME_Q"}
    home = f"{name}_{homes[a.name]}" if a.name in homes else "NULL"
    reach = BOX_POSE if a.name in homes else BOX_OTHER
    if a.positive:
        return [f"    choose(in_{a.name}, {BATCH * a.size}, NULL, {reach});"]
    return [
        f"    for (size_t k = 0; k < {BATCH}; ++k) {{",
        f"        choose(in_{a.name} + {a.size}*k, {a.size}, {home}, {reach});",
        "    }",
    ]


@dataclass(frozen=True)
class Alarm:
    """A place in the C, and what could go wrong there."""

    line: int
    text: str


_ALARM = re.compile(r"^\[eva:alarm\] (\S+):(\d+): Warning: ?\n?((?:.*\n)(?:  .*\n)*)", re.MULTILINE)


def alarms(log: str) -> list[Alarm]:
    """The alarms of an analysis, each once."""
    found = {Alarm(int(line), " ".join(text.split())) for _, line, text in _ALARM.findall(log)}
    return sorted(found, key=lambda alarm: (alarm.line, alarm.text))


def unexplained(analysis: str, found: list[Alarm]) -> list[Alarm]:
    """Those for which there is no reason in EXPLAINED."""
    texts = [text for kind, text in EXPLAINED if kind == analysis]
    return [alarm for alarm in found if not any(alarm.text.endswith(text) for text in texts)]


def analyse(folder: Path, analysis: str, limit: float) -> tuple[list[Alarm], str]:
    """Alarms, and "" or why the analysis has no result."""
    name = folder.name
    with tempfile.TemporaryDirectory() as place:
        program = Path(place) / "driver.c"
        program.write_text(driver(read_header(folder / f"{name}.h"), analysis), encoding="utf-8")
        command = [
            "frama-c",
            *OPTIONS,
            *_merged(folder / f"{name}.c"),
            *(SAFETY if analysis == "safety" else NUMBERS),
            f"-cpp-extra-args=-I{folder}",
            str(program),
            str(folder / f"{name}.c"),
        ]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, check=False, timeout=limit
            )
        except subprocess.TimeoutExpired:
            return [], f"no result within {limit:.0f} s"
    log = done.stdout + done.stderr
    if done.returncode or "done for function main" not in log:
        return [], f"Frama-C failed:\n{log[-2000:]}"
    return alarms(log), ""


def _merged(source: Path) -> list[str]:
    """The option for those functions of MERGED that a source has."""
    text = source.read_text(encoding="utf-8")
    names = [function.format(name=source.stem) for function in MERGED]
    found = ",".join(f"{name}:0" for name in names if f" {name}(" in text)
    return ["-eva-slevel-function", found] if found else []


def main(arguments: list[str]) -> int:
    """Analyse; return the exit code."""
    parser = argparse.ArgumentParser(prog="prove", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="+")
    parser.add_argument("--analysis", choices=("safety", "numbers", "both"), default="both")
    parser.add_argument("--limit", type=float, default=3600.0, help="seconds for one analysis")
    given = parser.parse_args(arguments)
    if shutil.which("frama-c") is None:
        print("\n*** NOT RUN: prove: frama-c is not installed ***\n", file=sys.stderr)
        return int(os.environ.get("CI") == "true")
    failures = 0
    for name in given.names:
        for analysis in ("safety", "numbers") if given.analysis == "both" else (given.analysis,):
            begun = time.monotonic()
            found, fault = analyse((given.folder / name).resolve(), analysis, given.limit)
            open_ones = unexplained(analysis, found)
            verdict = fault or f"{len(found)} alarms, {len(open_ones)} unexplained"
            print(f"{name} {analysis}: {verdict}, {time.monotonic() - begun:.0f} s", flush=True)
            for alarm in open_ones:
                print(f"  {name}.c:{alarm.line}: {alarm.text}")
            failures += bool(fault or open_ones)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
