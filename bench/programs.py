"""Programs that measure: each prints `KEY ns failed` per function and writes what it computed."""

from __future__ import annotations

import hashlib
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from bench.cases import BUILD, ROOT, Array, Case, States, error

PROCESSES = 9
"""Identical binaries differ by 15 % between processes; the median of so many is shown."""
C_SOURCES = Path(__file__).resolve().parent / "c"
FAST = "-O3 -march=native -fno-math-errno"
SMALL, SINGLE = 1e-9, 1e-3
"""Errors of those who compute the same, in double and in single precision."""


@dataclass(frozen=True)
class Program:
    """Something to be measured in processes of its own.

    Attributes:
        case: of which mechanism.
        who: what is measured; the program's keys begin with it where it is "".
        compiler: gcc, clang or "".
        command: without the paths of states and results.
        tolerance: largest error of what computes the same.
    """

    case: Case
    who: str
    compiler: str
    command: tuple[str, ...]
    tolerance: float = SMALL
    results: Path = field(init=False)

    def __post_init__(self) -> None:
        name = "-".join((self.case.name, self.who or "python", self.compiler)).replace(" ", "_")
        object.__setattr__(self, "results", BUILD / f"{name.replace('/', '_')}.results")

    def run(self, *, check: bool) -> dict[str, float]:
        """Nanoseconds per state by key."""
        command = [*self.command, *([str(self.results)] if check else [])]
        done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(command)}: {done.returncode}\n{done.stderr[-2000:]}")
        found = {}
        for line in done.stdout.splitlines():
            key, ns, failed = line.rsplit(" ", 2)
            assert failed == "0", f"{self.who}: {line}"
            found[f"{self.who} {key}".strip()] = float(ns)
        return found


def write_states(path: Path, s: States, sizes: Sequence[int], prepared: Array) -> None:
    """States as speed.c reads them; sizes: NQ, NV, NU, NC."""
    header = np.array([len(s.X), *sizes, prepared.size], dtype=np.int64)
    arrays = [np.ascontiguousarray(a, dtype=float) for a in (s.X, s.V, s.A, s.tau, prepared)]
    path.write_bytes(b"".join([header.tobytes(), *(a.tobytes() for a in arrays)]))


def compiled(name: str, compiler: str, sources: Sequence[Path], flags: str) -> str:
    """Compile a program unless it has been; its path."""
    standard = "-std=c++17" if compiler.endswith("++") else "-std=gnu99"
    command = [compiler, standard, *flags.split(), *map(str, sources)]
    digest = hashlib.sha256("\0".join(command).encode())
    folders = {source.parent for source in sources}
    headers = sorted(path for folder in folders for path in folder.glob("*.h"))
    for text in (*headers, *sources):
        digest.update(text.read_bytes())
    program = BUILD / "programs" / f"{name}-{digest.hexdigest()[:12]}"
    program.parent.mkdir(parents=True, exist_ok=True)
    if not program.exists():
        unfinished = program.with_suffix(".unfinished")
        subprocess.run([*command, "-o", str(unfinished), "-lm"], check=True)
        unfinished.replace(program)
    return str(program)


def function_of(key: str) -> str:
    """The function that a key stands for."""
    return key.rsplit(" ", 1)[-1].removesuffix("_batch")


def errors(
    program: Program, keys: Sequence[str], right: Mapping[str, tuple[Array, ...]]
) -> dict[str, float]:
    """Of every key, from what the program has written."""
    found, at = np.fromfile(program.results), 0
    values = {}
    for key in keys:
        arrays = []
        for array in right[function_of(key)]:
            arrays.append(found[at : at + array.size].reshape(array.shape))
            at += array.size
        values[key] = error(tuple(arrays), right[function_of(key)])
    assert at == len(found), f"{program.who}: {len(found)} results, expected {at}"
    return values


def measure(programs: Sequence[Program], processes: int = PROCESSES) -> list[dict[str, Any]]:
    """Rows of the table; programs take turns, so that what else the machine does slows all."""
    times: dict[tuple[int, str], list[float]] = {}
    wrong: dict[tuple[int, str], float] = {}
    for turn in range(processes):
        for number, program in enumerate(programs):
            found = program.run(check=turn == 0)
            if turn == 0:
                right = program.case.right(program.case.states())
                gaps = errors(program, list(found), right)
                wrong |= {(number, key): gap for key, gap in gaps.items()}
            for key, ns in found.items():
                times.setdefault((number, key), []).append(ns)
    return [
        _row(programs[number], key, ns, wrong[number, key]) for (number, key), ns in times.items()
    ]


def _row(program: Program, key: str, ns: Sequence[float], gap: float) -> dict[str, Any]:
    who = key.rsplit(" ", 1)[0]
    return {
        "mechanism": program.case.name,
        "who": f"{who}, batch" if key.endswith("_batch") else who,
        "compiler": program.compiler,
        "function": function_of(key),
        "ns": round(median(ns), 2),
        "least": round(min(ns), 2),
        "most": round(max(ns), 2),
        "error": float(f"{gap:.1e}"),
        "same": gap <= program.tolerance,
    }
