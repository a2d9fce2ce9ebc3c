"""Compile all generated C with every warning an error: `compile_c.py FOLDER`.

Every FOLDER/*/NAME.c as double and as float, by gcc and clang; every NAME.h
included and its object linked from C++, by g++ and clang++.  A compiler that
is not installed is reported as not run, and in CI (CI=true) is a failure.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Werror".split()
C_FLAGS = ["-std=c99", *WARNINGS]
OPTIMISED = {"stewart"}  # at -O2, which warns of more; the others quickly, at -O0
CXX_FLAGS = ["-std=c++11", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
COMPILERS = (("gcc", "g++"), ("clang", "clang++"))
OBJECT = "model.o"
CALLER = """#include "{name}.h"
#include "{name}.h"
int main() {{
    static {name}_model model;
    return {name}_prepare(&{name}_default_params, &model);
}}
"""


def main(folder: Path) -> int:
    """Compile everything below `folder`; return the exit code."""
    sources = sorted(path for path in folder.glob("*/*.c") if path.stem == path.parent.name)
    if not sources:
        print(f"no C file below {folder}", file=sys.stderr)
        return 1
    failures = 0
    for compiler, cxx in COMPILERS:
        missing = [tool for tool in (compiler, cxx) if shutil.which(tool) is None]
        for tool in missing:
            print(f"\n*** NOT RUN: check-c with {tool}: not installed ***\n", file=sys.stderr)
            failures += os.environ.get("CI") == "true"
        if compiler in missing:
            continue
        for source in sources:
            with tempfile.TemporaryDirectory() as build:
                passed = _compile(compiler, source, Path(build)) and (
                    cxx in missing or _link_from_cxx(cxx, source, Path(build))
                )
            failures += not passed
    return 1 if failures else 0


def _compile(compiler: str, source: Path, build: Path) -> bool:
    """Compile as float, then as double, which is what stays in `build`."""
    level = "-O2" if source.stem in OPTIMISED else "-O0"
    real = f"-D{source.stem.upper()}_REAL=float"
    return all(
        _run([compiler, *C_FLAGS, level, *extra, "-c", str(source), "-o", str(build / OBJECT)])
        for extra in ([real], [])
    )


def _link_from_cxx(cxx: str, source: Path, build: Path) -> bool:
    """Include the header from C++, twice; link and run a call of the C object."""
    caller, program = build / "caller.cpp", build / "caller"
    caller.write_text(CALLER.format(name=source.stem))
    inputs = [f"-I{source.parent}", str(caller), str(build / OBJECT), "-lm"]
    return _run([cxx, *CXX_FLAGS, *inputs, "-o", str(program)]) and _run([str(program)])


def _run(command: list[str]) -> bool:
    """Run a command, showing it; return whether it succeeded."""
    print(" ".join(command), flush=True)
    return subprocess.run(command, check=False).returncode == 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
