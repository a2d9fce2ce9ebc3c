"""Hostile states for the generated C: `python -m tests.hostile.campaign FOLDER [NAME ...]`.

Every model below FOLDER (or those named) is compiled once for each build and
called, every public function in turn, single and in batches, with states that
nobody should send: what is not finite, the largest and smallest numbers, random
bits, quaternions of no length, poses at the border of reach, other parameters.
Checked: NaN exactly where the status is not OK, finite numbers where it is;
words around the outputs, the inputs and the model untouched; counts and codes of
a batch; under MSan no use of uninitialised memory (outputs included), under TSan
no data race with threads that share a model.  Exit code 1 where a promise breaks.
How often single and batch differ is printed, for ordinary and for hostile numbers.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from tests.hostile.interface import Array, Interface, read_header

ENGINE = Path(__file__).with_name("engine.c")
CODES = ("OK", "UNREACHABLE", "SINGULAR", "INVALID", "NOT_CONVERGED")
_COMMON = ("-std=gnu99", "-g", "-pthread")
_SANITIZED = ("-O1", "-fno-omit-frame-pointer")


@dataclass(frozen=True)
class Build:
    """A compiler, its flags, the real type and how many threads share the model."""

    compiler: str
    flags: tuple[str, ...]
    real: str = "double"
    threads: int = 1


BUILDS = {
    "fast": Build("gcc", ("-O3", "-march=native", "-fno-math-errno")),
    "quick": Build("clang", ("-O0",)),
    "float": Build("gcc", ("-O2",), "float"),
    # vectors, as buffers are cleared first where there are none
    "memory": Build(
        "clang",
        (*_SANITIZED, "-march=native", "-fsanitize=memory", "-fno-sanitize-recover=all"),
    ),
    "thread": Build("clang", (*_SANITIZED, "-fsanitize=thread"), threads=4),
    "address": Build(
        "clang", (*_SANITIZED, "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    ),
}


def interface_text(model: Interface, actuated: tuple[int, ...]) -> str:
    """The C text that tells the engine what functions there are."""
    name, sizes = model.name, model.sizes
    largest = max(a.size for f in model.functions for a in (*f.inputs, *f.outputs))
    lines = [
        f'#include "{name}.h"',
        f"typedef {name}_real real;",
        f"typedef {name}_model model_type;",
        f"typedef {name}_params params_type;",
        f"enum {{ FUNCTIONS = {len(model.functions)}, LARGEST = {largest} }};",
        f"enum {{ INVALID = {name.upper()}_INVALID }};",
        f"#define prepare {name}_prepare",
        f"#define default_params (&{name}_default_params)",
        "typedef struct {",
        "    const char *name;",
        "    size_t size, quaternion;",
        "    int optional, positive;",
        "    const real *home;",
        "} array;",
        "typedef struct {",
        "    const char *name;",
        "    int (*single)(const model_type *, const real *const *, real *const *);",
        "    size_t (*batch)(const model_type *, size_t, const real *const *, real *const *,",
        "        int *);",
        "    size_t inputs, outputs;",
        "    array in[ARRAYS], out[ARRAYS];",
        "    int endless;",
        "} function;",
    ]
    home = json.dumps([0.0] * sizes["NU"]).strip("[]")
    lines.append(f"static real home_actuators[] = {{{home}}};")
    for f in model.functions:
        arguments = [f"in[{k}]" for k in range(len(f.inputs))]
        arguments += [f"out[{k}]" for k in range(len(f.outputs))]
        head = "const real *const *in, real *const *out"
        unused = [] if f.has_model else ["    (void)m;"]
        one = ", ".join(["m"] * f.has_model + arguments)
        many = ", ".join(["m"] * f.has_model + ["n"] + arguments + ["status"])
        lines += [
            f"static int one_{f.name}(const model_type *m, {head})", "{", *unused,
            f"    return {name}_{f.name}({one});", "}",
            f"static size_t many_{f.name}(const model_type *m, size_t n, {head}, int *status)",
            "{", *unused, f"    return {name}_{f.name}_batch({many});", "}",
        ]  # fmt: skip
    lines.append("static const function functions[FUNCTIONS] = {")
    for f in model.functions:
        ins = ", ".join(_array_text(model, a) for a in f.inputs)
        outs = ", ".join(_array_text(model, a) for a in f.outputs)
        lines.append(
            f'    {{"{f.name}", one_{f.name}, many_{f.name}, {len(f.inputs)}, {len(f.outputs)}, '
            f"{{{ins}}}, {{{outs}}}, {int(f.endless)}}},"
        )
    lines += ["};", "static void find_home(void)", "{"]
    lines += [f"    home_actuators[{k}] = {name}_HOME_Q[{q}];" for k, q in enumerate(actuated)]
    return "\n".join([*lines, "}", ""])


def _array_text(model: Interface, a: Array) -> str:
    homes = dict.fromkeys(("X", "X0", "X1"), f"{model.name}_HOME_X")
    homes |= {"q0": f"{model.name}_HOME_Q", "q_actuated": "home_actuators"}
    pose = a.name in ("X", "X0", "X1") and model.quaternion is not None
    quaternion = model.quaternion if pose else "(size_t)-1"
    flags = f"{int(a.optional)}, {int(a.positive)}"
    return f'{{"{a.name}", {a.size}, {quaternion}, {flags}, {homes.get(a.name, "NULL")}}}'


def actuated_joints(manifest: Path) -> tuple[int, ...]:
    """Places in q of the actuated joints, in the order of tau."""
    data = json.loads(manifest.read_text(encoding="utf-8"))
    return tuple(data["joints"].index(joint) for joint in data["actuators"])


def compile_engine(folder: Path, build: Build, into: Path) -> Path:
    """The program for a model's folder; a compiler's error ends the run."""
    name = folder.name
    model = read_header(folder / f"{name}.h")
    text = interface_text(model, actuated_joints(folder / f"{name}.json"))
    (into / "interface.inc").write_text(text, encoding="utf-8")
    program = into / "program"
    real = f"-D{name.upper()}_REAL={build.real}"
    command = [build.compiler, *_COMMON, *build.flags, real, f"-I{folder}", f"-I{into}",
        str(ENGINE), str(folder / f"{name}.c"), "-o", str(program), "-lm"]  # fmt: skip
    subprocess.run(command, check=True)
    return program


@dataclass(frozen=True)
class Line:
    """What is counted of one function: states, codes, differences of single and batch."""

    name: str
    states: int
    codes: tuple[int, ...]
    status: tuple[int, int]
    values: tuple[int, int]
    worst: float


def run(program: Path, states: int, seed: int, threads: int) -> tuple[list[Line], str, bool]:
    """Counts of each function, what was found at fault, and whether nothing was."""
    done = subprocess.run(
        [program, str(states), str(seed), str(threads)],
        capture_output=True,
        text=True,
        check=False,
        # How far back it knows where a thread was: what it cannot tell it does not report.
        env={**os.environ, "TSAN_OPTIONS": "history_size=7"},
    )
    lines = []
    for line in done.stdout.splitlines():
        name, *numbers, worst = line.split()
        n = [int(number) for number in numbers]
        lines.append(Line(name, n[0], tuple(n[1:6]), (n[6], n[7]), (n[8], n[9]), float(worst)))
    return lines, done.stderr, done.returncode == 0


def main(arguments: list[str]) -> int:
    """Run the campaign; return the exit code."""
    parser = argparse.ArgumentParser(prog="campaign", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--states", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--builds", default="fast,memory,thread")
    parser.add_argument("--functions", action="store_true", help="a line for every function")
    given = parser.parse_args(arguments)
    names = given.names or sorted(p.parent.name for p in given.folder.glob("*/*.h"))
    print(f"{'model':24}{'build':9}{'states':>9}", *(f"{c:>13}" for c in CODES), end="")
    print("  single/batch: status ordinary, hostile; values; worst; seconds")
    failures = 0
    for name in names:
        for build in given.builds.split(","):
            failures += not _one(given.folder / name, build, given)
    return 1 if failures else 0


def _one(folder: Path, name: str, given: argparse.Namespace) -> bool:
    build = BUILDS[name]
    if shutil.which(build.compiler) is None:
        print(f"\n*** NOT RUN: hostile, {name}: {build.compiler} is not installed ***\n")
        return os.environ.get("CI") != "true"
    with tempfile.TemporaryDirectory() as place:
        program = compile_engine(folder, build, Path(place))
        begun = time.monotonic()
        lines, told, passed = run(program, given.states, given.seed, build.threads)
        seconds = time.monotonic() - begun
    for line in lines if given.functions else []:
        _print(f"  {line.name}", name, [line])
    _print(folder.name, name, lines, f"{seconds:8.1f}{'' if passed else '  FAILED'}")
    print(told, end="", flush=True)
    return passed


def _print(what: str, build: str, lines: list[Line], after: str = "") -> None:
    codes = [sum(column) for column in zip(*(line.codes for line in lines), strict=True)]
    status = [sum(column) for column in zip(*(line.status for line in lines), strict=True)]
    values = [sum(column) for column in zip(*(line.values for line in lines), strict=True)]
    worst = max((line.worst for line in lines), default=0.0)
    states = sum(line.states for line in lines)
    print(f"{what:24}{build:9}{states:9}", *(f"{c:13}" for c in codes), end="")
    print(f"  {status}  {values}  {worst:.2g} {after}", flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
