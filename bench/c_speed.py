"""Time of the generated C per state, and instructions per state where valgrind is installed.

python bench/c_speed.py [MODEL] [--compiler gcc] [--real double]
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from pne_sym import manipulators  # noqa: E402  (the package is found from here)
from pne_sym.backends.c_backend import CBackend  # noqa: E402
from pne_sym.backends.describe import describe  # noqa: E402
from pne_sym.pipeline import compile_bundle  # noqa: E402

STATES = 1024
FLAGS = {
    "scalar": "-O3 -march=native -fno-math-errno -fno-tree-vectorize -fno-tree-slp-vectorize",
    "-O2": "-O2",
    "-O3": "-O3 -march=native",
    "-O3 -fno-math-errno": "-O3 -march=native -fno-math-errno",
}


def build(folder: Path, name: str, options: argparse.Namespace, flags: str) -> Path:
    """The benchmark as a program."""
    program = folder / "speed"
    defines = [f"-DMODEL={name}", f"-DUPPER={name.upper()}"]
    defines += [f"-DLAMBDA={options.multipliers}", f"-DITERATED={options.iterated}"]
    real = f"-D{name.upper()}_REAL={options.real}"
    sources = [str(ROOT / "bench" / "c_speed.c"), str(folder / f"{name}.c")]
    subprocess.run(
        [options.compiler, "-std=gnu99", *flags.split(), *defines, real, f"-I{folder}", *sources,
         "-o", str(program), "-lm"], check=True)  # fmt: skip
    return program


def times(program: Path) -> dict[str, float]:
    """Nanoseconds per state of every function."""
    text = subprocess.run([program, "300"], capture_output=True, text=True, check=True).stdout
    return {name: float(ns) for name, ns in re.findall(r"(\w+) ([\d.]+) ns", text)}


def instructions(program: Path, function: str) -> float | None:
    """Instructions per state of a function, by callgrind; None without valgrind."""
    if shutil.which("valgrind") is None:
        return None
    counts = []
    for rounds in ("1", "2"):
        command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", str(program)]
        done = subprocess.run([*command, rounds, function], capture_output=True, text=True,
                              check=False)  # fmt: skip
        found = re.search(r"Collected : (\d+)", done.stderr)
        if found is None:
            return None
        counts.append(int(found.group(1)))
    return (counts[1] - counts[0]) / STATES


def main() -> None:
    """Print a table: functions by flags."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", nargs="?", default="stewart")
    parser.add_argument("--compiler", default="gcc")
    parser.add_argument("--real", default="double")
    options = parser.parse_args()
    bundle = compile_bundle(manipulators.load(options.model))
    options.multipliers = int(bundle.coordinates.sizes["NC"] > 0)
    options.iterated = int(describe(bundle).is_numeric)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in CBackend().emit(bundle).items():
            (folder / file).write_text(text, encoding="utf-8")
        print(f"{options.model}, {options.compiler}, {options.real}: ns per state")
        for label, flags in FLAGS.items():
            program = build(folder, options.model, options, flags)
            row = ", ".join(f"{f} {ns:.0f}" for f, ns in times(program).items())
            print(f"  {label}: {row}")
        program = build(folder, options.model, options, "-O2")
        for function in ("inverse_dynamics", "dynamics", "forward_dynamics"):
            count = instructions(program, function)
            shown = "NOT RUN: no valgrind" if count is None else f"{count:.0f} instructions"
            print(f"  {function}, -O2, callgrind: {shown}")


if __name__ == "__main__":
    main()
