"""Stack and code of stewart.c on a Cortex-M4F: python -m bench.stack MODEL_FOLDER."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

COMPILER = "arm-none-eabi-gcc"
FLAGS = "-O2 -mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=hard -fno-math-errno"
DEFINED = "-std=c99 -ffunction-sections -fdata-sections -DSTEWART_REAL=float -DSTEWART_LANES=1"
FUNCTIONS = ("inverse_dynamics", "dynamics", "forward_dynamics", "inverse_kinematics", "prepare")
BOUNDS = {"dynamics": 3000, "inverse_dynamics": 2000}
"""Bytes of stack at most."""
FOUND = Path(__file__).resolve().parent / "stack.json"


def call_graph(text: str) -> tuple[dict[str, int], dict[str, list[str]]]:
    """Stack of every function itself, and whom it calls, from -fcallgraph-info=su."""
    own = {n: int(b) for n, b in re.findall(r'title: "([^"]+)" label: "[^"]*\\n(\d+) bytes', text)}
    calls: dict[str, list[str]] = {}
    for source, target in re.findall(r'sourcename: "([^"]+)" targetname: "([^"]+)"', text):
        calls.setdefault(source, []).append(target)
    return own, calls


def deepest(name: str, own: dict[str, int], calls: dict[str, list[str]]) -> int:
    """Stack of a function with all that it calls; nothing here calls itself."""
    below = (deepest(n, own, calls) for n in calls.get(name, ()))
    return own.get(name, 0) + max(below, default=0)


def linked_size(folder: Path, function: str) -> int:
    """Code and constants of a program that has this function alone; libm and libc apart."""
    command = (
        f"{COMPILER} {FLAGS} -nostdlib -r -Wl,--gc-sections -Wl,-e,{function} -Wl,-u,{function}"
    )
    program = folder / function
    subprocess.run([*command.split(), str(folder / "s.o"), "-o", str(program)], check=True)
    said = subprocess.run(
        ["arm-none-eabi-size", str(program)], capture_output=True, text=True, check=True
    )
    return int(said.stdout.splitlines()[1].split()[0])


def size_of(folder: Path, what: str) -> int:
    """Of a type, in bytes."""
    source = f'#include "stewart.h"\nchar size[sizeof({what})];\n'
    (folder / "size.c").write_text(source, encoding="utf-8")
    command = f"{COMPILER} {FLAGS} {DEFINED} -c {folder}/size.c -o {folder}/size.o -I{folder}"
    subprocess.run(command.split(), check=True)
    said = subprocess.run(
        ["arm-none-eabi-nm", "-S", f"{folder}/size.o"], capture_output=True, text=True, check=True
    )
    return int(said.stdout.split()[1], 16)


def measured(model: Path) -> dict[str, Any]:
    """Everything that the page says of it."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file in ("stewart.c", "stewart.h"):
            (folder / file).write_bytes((model / file).read_bytes())
        command = f"{COMPILER} {FLAGS} {DEFINED} -fcallgraph-info=su -c stewart.c -o s.o"
        subprocess.run(command.split(), check=True, cwd=folder)
        own, calls = call_graph((folder / "s.ci").read_text(encoding="utf-8"))
        rows = [
            {"function": f, "stack": deepest(f, own, calls), "code": linked_size(folder, f)}
            for f in (f"stewart_{f}" for f in FUNCTIONS)
        ]
        sizes = {n: size_of(folder, f"stewart_{n}") for n in ("model", "params")}
    said = subprocess.run([COMPILER, "-dumpversion"], capture_output=True, text=True, check=True)
    compiler = f"{COMPILER} {said.stdout.strip()}"
    return {"compiler": compiler, "flags": FLAGS, "rows": rows} | sizes


def main() -> None:
    """Print a table and keep it for the page; an error where a bound is missed."""
    if shutil.which(COMPILER) is None:
        sys.exit(f"stack: {COMPILER} is not installed (Debian: gcc-arm-none-eabi)")
    found = measured(Path(sys.argv[1]))
    FOUND.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    missed = []
    for row in found["rows"]:
        print(f"{row['function']:28} stack {row['stack']:5} B, code {row['code']:6} B")
        most = BOUNDS.get(row["function"].removeprefix("stewart_"))
        if most is not None and row["stack"] > most:
            missed.append(f"{row['function']}: {row['stack']} B of stack, at most {most}")
    print(f"model {found['model']} B, parameters {found['params']} B")
    sys.exit("\n".join(missed) or None)


if __name__ == "__main__":
    main()
