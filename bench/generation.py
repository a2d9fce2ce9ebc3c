"""CPU time of `pne-gen MODEL` over that of `import sympy`, medians of runs that alternate.

python bench/generation.py [MODEL ...] [--runs 5]
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

PNE_GEN = Path(sys.executable).with_name("pne-gen")
ALONE = {"all": ("--jobs", "1")}  # what workers take is not counted
MODELS = ("planar_3rpr", "stewart", "hexapod_6uhs", "hexapod_6x6r")


def cpu_time(command: Sequence[str | Path]) -> float:
    """Seconds of the processor that a command and its own processes take."""
    before = os.times()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = os.times()
    return sum(after[2:4]) - sum(before[2:4])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", nargs="*", default=MODELS, help="names, spec files, or all")
    parser.add_argument("--runs", type=int, default=5)
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as out:
        commands: dict[str, list[str | Path]] = {
            "import sympy": [sys.executable, "-c", "import sympy"],
            **{name: [PNE_GEN, name, "--out", out, *ALONE.get(name, ())] for name in chosen.models},
        }
        for command in commands.values():
            cpu_time(command)  # compiles the sources
        runs = [{n: cpu_time(c) for n, c in commands.items()} for _ in range(chosen.runs)]
    print(f"{'':16} {'CPU s':>7} {'times import sympy':>20}")
    for name in commands:
        seconds = statistics.median(run[name] for run in runs)
        ratio = statistics.median(run[name] / run["import sympy"] for run in runs)
        print(f"{name:16} {seconds:7.2f} {ratio:20.1f}")


if __name__ == "__main__":
    main()
