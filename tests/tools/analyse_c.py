"""Static analysers on the generated C: `python -m tests.tools.analyse_c FOLDER [NAME ...]`.

gcc -fanalyzer, clang's analyzer, clang-tidy (bugprone, cert) and cppcheck read FOLDER/NAME/NAME.c,
or every model's below FOLDER; a finding fails.  With --sample only SAMPLE is read: models in which
together every line of the templates stands that stands in the catalogue.  A tool that is not
installed is reported as not run, and in CI (CI=true) is a failure.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

# The shortest that together have all that the templates can print for the catalogue.
SAMPLE = (
    "fivebar_revolute",
    "planar_4rpr",
    "spherical_3ups",
    "tripod_3rps",
    "stewart_sps",
    "hexapod_6x6r",
    "quadrupod",
)

# Read by these tools in `make analyse` alone: they take longer than for all others together.
LEFT_OUT_OF_SAMPLE = tuple(
    (tool, name) for tool in ("cppcheck", "gcc") for name in ("hexapod_6x6r", "quadrupod")
)

# What is switched off, all of it, and why.
OFF = {
    "clang-tidy": {
        "bugprone-easily-swappable-parameters": (
            "functions of mechanics take several vectors of numbers; the header names them"
        ),
        "bugprone-branch-clone": (
            "a constant may be the same for double and long double; every precision is written"
        ),
    },
}

CPPCHECK = "warning,portability,performance"  # not style, which is a matter of taste

COMMANDS = {
    # At -O1 gcc has inlined the parts, so that numbers of rows and states are constants.
    "gcc": ("gcc -std=c99 -O1 -fanalyzer -Werror -c -o /dev/null", ""),
    "clang": (
        "clang -std=c99 --analyze -Xclang -analyzer-werror -Xclang -analyzer-output=text",
        "",
    ),
    "clang-tidy": (
        "clang-tidy --quiet --warnings-as-errors=* --checks=-*,bugprone-*,cert-*"
        + "".join(f",-{check}" for check in OFF["clang-tidy"]),
        "-- -std=c99",
    ),
    "cppcheck": (
        "cppcheck --quiet --std=c99 -D__GNUC__=12 --error-exitcode=1 --enable=" + CPPCHECK,
        "",
    ),
}


def main(arguments: list[str]) -> int:
    """Run every analyser on every source; return the exit code."""
    parser = argparse.ArgumentParser(prog="analyse_c", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--sample", action="store_true", help="only the models of SAMPLE")
    given = parser.parse_args(arguments)
    every = sorted(
        path.stem for path in given.folder.glob("*/*.c") if path.stem == path.parent.name
    )
    names = SAMPLE if given.sample else given.names or every
    if not names:
        print(f"no C file below {given.folder}", file=sys.stderr)
        return 1
    tools = [tool for tool in COMMANDS if _is_installed(tool)]
    failures = (len(COMMANDS) - len(tools)) * (os.environ.get("CI") == "true")
    for name in names:
        source = given.folder / name / f"{name}.c"
        chosen = [t for t in tools if not (given.sample and (t, name) in LEFT_OUT_OF_SAMPLE)]
        failures += sum(not _passes(tool, source) for tool in chosen)
    return 1 if failures else 0


def _is_installed(tool: str) -> bool:
    if shutil.which(tool):
        return True
    print(f"\n*** NOT RUN: check-analysers with {tool}: not installed ***\n", file=sys.stderr)
    return False


def _passes(tool: str, source: Path) -> bool:
    """Whether a tool finds nothing in a source; what it finds is shown."""
    before, after = COMMANDS[tool]
    begun = time.monotonic()
    done = subprocess.run(
        [*before.split(), str(source), *after.split()],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    passed = done.returncode == 0
    seconds = time.monotonic() - begun
    print(f"{tool:11}{source}: {'nothing' if passed else 'FOUND'}, {seconds:.0f} s", flush=True)
    if not passed:
        print(done.stdout, flush=True)
    return passed


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
