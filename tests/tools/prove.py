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
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.hostile.interface import Array, Function, Interface, read_header

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


@dataclass(frozen=True)
class Part:
    """What one run of Eva analyses: a public function for one state or for a batch.

    `prepare` is a part too: in `safety` nothing else calls it with damaged parameters.
    """

    function: str
    form: str

    def __str__(self) -> str:
        return f"{self.function}, {self.form}"


PREPARE = Part("prepare", "state")


def parts(model: Interface, analysis: str) -> list[Part]:
    """All that an analysis looks at."""
    names = [f.name for f in model.functions if analysis == "safety" or f.name not in ITERATED]
    return [PREPARE, *(Part(name, form) for name in names for form in ("state", "batch"))]


def driver(model: Interface, analysis: str, chosen: Sequence[Part] = ()) -> str:
    """A C program that calls what is analysed; all parts unless some are chosen."""
    name = model.name
    chosen = chosen or parts(model, analysis)
    lines = [
        f'#include "{name}.h"', "#include <stddef.h>", '#include "__fc_builtin.h"', "",
        f"static {name}_params params;", f"static {name}_model model;",
        "static int status[9];", "",
    ]  # fmt: skip
    lines += _CHOOSE[analysis]
    called = [f for f in model.functions if any(part.function == f.name for part in chosen)]
    for f in called:
        lines += _caller(name, f, [part.form for part in chosen if part.function == f.name])
    lines += ["int main(void)", "{"]
    if analysis == "numbers":
        lines.append(f"    {name}_prepare(&{name}_default_params, &model);")
    elif PREPARE in chosen:
        lines += [
            "    Frama_C_make_unknown((char *)&params, sizeof params);",
            f"    {name}_prepare(&params, &model);",
        ]
    if analysis == "safety":
        lines.append("    Frama_C_make_unknown((char *)&model, sizeof model);")
    lines += [f"    call_{f.name}();" for f in called]
    return "\n".join([*lines, "    return 0;", "}", ""])


_CHOOSE = {
    "safety": [
        "static void choose(double *x, size_t n, const double *home, double reach)", "{",
        "    (void)home, (void)reach;",
        "    Frama_C_make_unknown((char *)x, n*sizeof *x);", "}", "",
    ],
    "numbers": [
        "static void choose(double *x, size_t n, const double *home, double reach)", "{",
        "    for (size_t k = 0; k < n; ++k) {",
        "        const double centre = home ? home[k] + (k%2 ? -0.01 : 0.02)*(k + 1) : 0;",
        "        x[k] = centre + Frama_C_double_interval(-reach, reach);",
        "    }", "}", "",
    ],
}  # fmt: skip


def _caller(name: str, f: Function, forms: Sequence[str]) -> list[str]:
    """A C function that calls a public function, with optional arguments and without."""
    lines = [f"static void call_{f.name}(void)", "{"]
    lines += [f"    static double in_{a.name}[{BATCH * a.size}];" for a in f.inputs]
    lines += [f"    double out_{a.name}[{BATCH * a.size}];" for a in f.outputs]
    for a in f.inputs:
        lines += _chosen(name, a)
    none = any(a.optional for a in f.inputs)
    for left_out in [False, True] if none else [False]:
        arguments = ["&model"] * f.has_model
        given = [f"{'NULL' if a.optional and left_out else f'in_{a.name}'}" for a in f.inputs]
        given += [f"out_{a.name}" for a in f.outputs]
        if "state" in forms:
            lines.append(f"    {name}_{f.name}({', '.join([*arguments, *given])});")
        states = 2 if f.name in ITERATED else BATCH  # no lanes there, but long analyses
        many = ", ".join([*arguments, str(states), *given, "status"])
        if "batch" in forms:
            lines.append(f"    {name}_{f.name}_batch({many});")
    return [*lines, "}", ""]


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


def analyse(
    folder: Path, analysis: str, limit: float, chosen: Sequence[Part] = ()
) -> tuple[list[Alarm], str]:
    """Alarms, and "" or why the analysis has no result."""
    name = folder.name
    with tempfile.TemporaryDirectory() as place:
        program = Path(place) / "driver.c"
        text = driver(read_header(folder / f"{name}.h"), analysis, chosen)
        program.write_text(text, encoding="utf-8")
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
        except subprocess.TimeoutExpired as stopped:
            log = (stopped.stdout or b"").decode(errors="replace")
            return alarms(log), f"no result within {limit:.0f} s"
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


def _verdict(found: list[Alarm], open_ones: list[Alarm], fault: str) -> str:
    """A run in a few words."""
    counted = f"{len(found)} alarms, {len(open_ones)} unexplained" if found else "no alarm"
    if fault.startswith("no result"):
        return f"{fault}; until then {counted}"
    return fault or counted


def runs(folder: Path, analysis: str, each: bool, only: Sequence[str]) -> list[tuple[Part, ...]]:
    """The parts that are analysed together: all, or one at a time."""
    found = parts(read_header(folder / f"{folder.name}.h"), analysis)
    chosen = [part for part in found if not only or part.function in only]
    return [(part,) for part in chosen] if each else [tuple(chosen)]


def prove(folder: Path, analysis: str, given: argparse.Namespace) -> bool:
    """Analyse a model and print what was found; whether anything is open."""
    open_runs = 0
    stopped: set[str] = set()  # functions
    for chosen in runs(folder, analysis, given.each, given.only):
        begun = time.monotonic()
        label = f"{folder.name} {analysis}" + (f" {chosen[0]}" if given.each else "")
        if chosen[0].function in stopped:
            # A batch calls the function for one state too.
            print(f"{label}: not run, since one state has no result", flush=True)
            continue
        found, fault = analyse(folder, analysis, given.limit, chosen)
        open_ones = unexplained(analysis, found)
        took = time.monotonic() - begun
        print(f"{label}: {_verdict(found, open_ones, fault)}, {took:.0f} s", flush=True)
        for alarm in open_ones:
            print(f"  {folder.name}.c:{alarm.line}: {alarm.text}", flush=True)
        open_runs += bool(fault or open_ones)
        stopped |= {chosen[0].function} if fault else set()
    return open_runs > 0


def main(arguments: list[str]) -> int:
    """Analyse; return the exit code."""
    parser = argparse.ArgumentParser(prog="prove", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="+")
    parser.add_argument("--analysis", choices=("safety", "numbers", "both"), default="both")
    parser.add_argument("--each", action="store_true", help="one run for each function and form")
    parser.add_argument("--only", nargs="+", default=[], metavar="FUNCTION", help="not all of them")
    parser.add_argument("--limit", type=float, default=3600.0, help="seconds for one run")
    given = parser.parse_args(arguments)
    if shutil.which("frama-c") is None:
        print("\n*** NOT RUN: prove: frama-c is not installed ***\n", file=sys.stderr)
        return int(os.environ.get("CI") == "true")
    failures = 0
    for name in given.names:
        for analysis in ("safety", "numbers") if given.analysis == "both" else (given.analysis,):
            failures += prove((given.folder / name).resolve(), analysis, given)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
