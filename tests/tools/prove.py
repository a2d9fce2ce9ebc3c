"""Prove that the generated C has no run-time errors: `python -m tests.tools.prove FOLDER NAME ...`.

Frama-C's Eva analyses all public functions of each model, each for one state and for a batch with
lanes and a remainder, one run for each of them, in two ways:

* safety: states, parameters and the prepared model are any bits at all, NaN and infinity among
  them.  Proved absent: accesses beyond an array or through a bad pointer, reads of what was never
  written, signed overflow, division by zero of integers, bad shifts, conversions out of range.
* numbers: states in a box, default parameters; infinite and NaN results of
  arithmetic are alarms too.

An alarm that EXPLAINED does not hold fails, and so does a run without a result.
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
OPTIONS = (*"-machdep gcc_x86_64 -eva -eva-no-results -eva-slevel 3".split(),)
# Loops of so many rounds are followed round by round; not those of iterations: there are too many.
UNROLL, UNROLL_ITERATED = "600", "39"
# Iterations are not told apart by the ways through them: there are too many.
MERGED = ("search_pose_residual", "search_constraint_residual", "singular_values")
SAFETY = ("-warn-special-float", "none")
NUMBERS = ("-warn-special-float", "non-finite")

# Half the width of the box in which the arithmetic is analysed, about a pose beside home and about
# zero (velocities, accelerations, forces).  Not about home: there symmetry makes candidates for a
# pivot equally long, and the analysis joins the two orders of rows into one that has no pivot.
# What iterates is left out: intervals cannot follow its steps.
BOX_POSE, BOX_OTHER = 1e-4, 1.0
# Rotations, by their number of entries: the box is about these.
ROTATIONS = {
    "R": {4: "0.8, -0.6, 0.6, 0.8", 9: "2./3, -1./3, 2./3, 2./3, 2./3, -1./3, -1./3, 2./3, 2./3"},
    "rpy": {3: "0.1, 0.2, 0.3"},
}
ITERATED = (
    *("forward_kinematics", "project", "condition", "condition_constrained", "manipulability"),
    *("singularity_distance", "reachable_wrench", "reachable_acceleration", "force_distribution"),
)
# Nor are the margins of joints analysed so: they are infinite, on purpose, where there is no limit.
NOT_IN_NUMBERS = (*ITERATED, "joint_margins")

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
    names = [
        f.name for f in model.functions if analysis == "safety" or f.name not in NOT_IN_NUMBERS
    ]
    return [PREPARE, *(Part(name, form) for name in names for form in ("state", "batch"))]


def driver(model: Interface, analysis: str, part: Part) -> str:
    """A C program that calls what is analysed."""
    name = model.name
    lines = [
        f'#include "{name}.h"', "#include <stddef.h>", '#include "__fc_builtin.h"', "",
        f"static {name}_params params;", f"static {name}_model model;",
        "static int status[9];", "", "void Frama_C_show_each_end(void);", "",
    ]  # fmt: skip
    lines += _CHOOSE[analysis]
    if part != PREPARE:
        lines += _caller(name, model.function(part.function), part.form)
    lines += ["int main(void)", "{"]
    if analysis == "numbers":
        lines.append(f"    {name}_prepare(&{name}_default_params, &model);")
    elif part == PREPARE:
        lines += [
            "    Frama_C_make_unknown((char *)&params, sizeof params);",
            f"    {name}_prepare(&params, &model);",
        ]
    if analysis == "safety":
        lines.append("    Frama_C_make_unknown((char *)&model, sizeof model);")
    if part != PREPARE:
        lines.append("    call();")
    lines += ["    Frama_C_show_each_end();", "    return 0;", "}", ""]
    return "\n".join(lines)


_ARGUMENTS = [
    "static void choose(double *x, size_t n, const double *at, double shift, double reach)", "{",
]  # fmt: skip
_CHOOSE = {
    "safety": [
        *_ARGUMENTS,
        "    (void)at, (void)shift, (void)reach;",
        "    Frama_C_make_unknown((char *)x, n*sizeof *x);", "}", "",
    ],
    "numbers": [
        *_ARGUMENTS,
        "    for (size_t k = 0; k < n; ++k) {",
        "        const double beside = shift*(k%2 ? -0.01 : 0.02)*(k + 1);",
        "        x[k] = (at ? at[k] + beside : 0) + Frama_C_double_interval(-reach, reach);",
        "    }", "}", "",
    ],
}  # fmt: skip


def _caller(name: str, f: Function, form: str) -> list[str]:
    """A C function that calls a public function, with optional arguments and without."""
    lines = ["static void call(void)", "{"]
    lines += [f"    static double in_{a.name}[{BATCH * a.size}];" for a in f.inputs]
    lines += [f"    double out_{a.name}[{BATCH * a.size}];" for a in f.outputs]
    for a in f.inputs:
        lines += _chosen(name, a)
    none = any(a.optional for a in f.inputs)
    for left_out in [False, True] if none else [False]:
        arguments = ["&model"] * f.has_model
        given = [f"{'NULL' if a.optional and left_out else f'in_{a.name}'}" for a in f.inputs]
        given += [f"out_{a.name}" for a in f.outputs]
        if form == "batch":
            states = 2 if f.name in ITERATED else BATCH  # no lanes there, but long analyses
            many = ", ".join([*arguments, str(states), *given, "status"])
            lines.append(f"    {name}_{f.name}_batch({many});")
        else:
            lines.append(f"    {name}_{f.name}({', '.join([*arguments, *given])});")
    return [*lines, "}", ""]


def _chosen(name: str, a: Array) -> list[str]:
    if a.positive:
        return [f"    choose(in_{a.name}, {BATCH * a.size}, NULL, 0, {BOX_OTHER});"]
    homes = {"X": "HOME_X", "X0": "HOME_X", "X1": "HOME_X", "q0": "HOME_Q"}
    if a.name in homes:
        where = f"{name}_{homes[a.name]}, 1, {BOX_POSE}"
    elif a.name in ROTATIONS:
        where = f"(const double[]){{{ROTATIONS[a.name][a.size]}}}, 0, {BOX_POSE}"
    else:
        where = f"NULL, 0, {BOX_OTHER}"
    return [
        f"    for (size_t k = 0; k < {BATCH}; ++k) {{",
        f"        choose(in_{a.name} + {a.size}*k, {a.size}, {where});",
        "    }",
    ]


@dataclass(frozen=True)
class Alarm:
    """A place in the C, and what could go wrong there."""

    line: int
    text: str


# Behind an alarm that always holds nothing is analysed: then this is not in the log.
_END = re.compile(r"^\[eva\] \S+: Frama_C_show_each_end:", re.MULTILINE)
_ALARM = re.compile(r"^\[eva:alarm\] (\S+):(\d+): Warning: ?\n?((?:.*\n)(?:  .*\n)*)", re.MULTILINE)


def alarms(log: str) -> list[Alarm]:
    """The alarms of an analysis, each once."""
    found = {Alarm(int(line), " ".join(text.split())) for _, line, text in _ALARM.findall(log)}
    return sorted(found, key=lambda alarm: (alarm.line, alarm.text))


def unexplained(analysis: str, found: list[Alarm]) -> list[Alarm]:
    """Those for which there is no reason in EXPLAINED."""
    texts = [text for kind, text in EXPLAINED if kind == analysis]
    return [alarm for alarm in found if not any(alarm.text.endswith(text) for text in texts)]


def analyse(folder: Path, analysis: str, part: Part, limit: float) -> tuple[list[Alarm], str]:
    """Alarms, and "" or why the analysis has no result."""
    name = folder.name
    with tempfile.TemporaryDirectory() as place:
        program = Path(place) / "driver.c"
        text = driver(read_header(folder / f"{name}.h"), analysis, part)
        program.write_text(text, encoding="utf-8")
        command = [
            "frama-c",
            *OPTIONS,
            "-eva-auto-loop-unroll",
            UNROLL_ITERATED if part.function in ITERATED else UNROLL,
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
    return alarms(log), "" if _END.search(log) else "the function's end is not reached"


def _merged(source: Path) -> list[str]:
    """The option for those functions of MERGED that a source has."""
    text = source.read_text(encoding="utf-8")
    found = ",".join(f"{name}:0" for name in MERGED if f" {name}(" in text)
    return ["-eva-slevel-function", found] if found else []


def _verdict(found: list[Alarm], open_ones: list[Alarm], fault: str) -> str:
    """A run in a few words."""
    counted = f"{len(found)} alarms, {len(open_ones)} unexplained" if found else "no alarm"
    return fault if "\n" in fault else f"{fault}; {counted}" if fault else counted


def prove(folder: Path, analysis: str, only: Sequence[str], limit: float) -> bool:
    """Analyse a model part by part and print what was found; whether anything is open."""
    name = folder.name
    open_runs = 0
    stopped: set[str] = set()  # functions
    for part in parts(read_header(folder / f"{name}.h"), analysis):
        if only and part.function not in only:
            continue
        begun = time.monotonic()
        if part.function in stopped:
            # A batch calls the function for one state too.
            print(f"{name} {analysis} {part}: not run, one state has no result", flush=True)
            continue
        found, fault = analyse(folder, analysis, part, limit)
        open_ones = unexplained(analysis, found)
        verdict = f"{_verdict(found, open_ones, fault)}, {time.monotonic() - begun:.0f} s"
        print(f"{name} {analysis} {part}: {verdict}", flush=True)
        for alarm in open_ones:
            print(f"  {name}.c:{alarm.line}: {alarm.text}", flush=True)
        open_runs += bool(fault or open_ones)
        stopped |= {part.function} if fault else set()
    return open_runs > 0


def main(arguments: list[str]) -> int:
    """Analyse; return the exit code."""
    parser = argparse.ArgumentParser(prog="prove", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="+")
    parser.add_argument("--analysis", choices=("safety", "numbers", "both"), default="both")
    parser.add_argument("--only", nargs="+", default=[], metavar="FUNCTION", help="not all of them")
    parser.add_argument("--limit", type=float, default=600.0, help="seconds for one run")
    given = parser.parse_args(arguments)
    if shutil.which("frama-c") is None:
        print("\n*** NOT RUN: prove: frama-c is not installed ***\n", file=sys.stderr)
        return int(os.environ.get("CI") == "true")
    failures = 0
    for name in given.names:
        for analysis in ("safety", "numbers") if given.analysis == "both" else (given.analysis,):
            failures += prove((given.folder / name).resolve(), analysis, given.only, given.limit)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
