"""Processor time of `pne-gen NAME` over that of `import sympy`, and of JAX's compiler."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from statistics import median

from bench.cases import FUNCTIONS, Case

PNE_GEN = Path(sys.executable).with_name("pne-gen")
MODELS = ("planar_3rpr", "stewart", "hexapod_6uhs", "hexapod_6x6r")
RUNS = 3
JAX = """
import sys, time, importlib, numpy as np, jax, jax.numpy as jnp
jax.config.update("jax_enable_x64", True)
sys.path.insert(0, sys.argv[1])
m = importlib.import_module(sys.argv[2])
X, V = jnp.asarray([m.HOME_X]*8), jnp.zeros((8, m.NV))
last = {"inverse_dynamics": (V,), "dynamics": (), "forward_dynamics": (V[:, :m.NU],)}
for name in last:
    start = time.process_time()
    jax.jit(getattr(m, name)).lower(X, V, *last[name]).compile()
    print(time.process_time() - start)
"""


def cpu_time(command: Sequence[str | Path]) -> float:
    """Seconds of the processor that a command and its own processes take."""
    before = os.times()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = os.times()
    return sum(after[2:4]) - sum(before[2:4])


def generation_times() -> dict[str, list[float]]:
    """Seconds and times `import sympy`, medians of runs that alternate."""
    with tempfile.TemporaryDirectory() as out:
        commands: dict[str, list[str | Path]] = {
            "import sympy": [sys.executable, "-c", "import sympy"],
            **{name: [PNE_GEN, name, "--out", out] for name in MODELS},
        }
        cpu_time(commands["planar_3rpr"])  # compiles the sources
        runs = [{n: cpu_time(c) for n, c in commands.items()} for _ in range(RUNS)]
    of = {n: median(run[n] for run in runs) for n in commands}
    return {
        n: [round(s, 2), round(median(run[n] / run["import sympy"] for run in runs), 1)]
        for n, s in of.items()
    }


def jax_compile_times(case: Case) -> dict[str, float]:
    """Seconds of the processor, all threads, to trace and compile under jax.jit."""
    command = [sys.executable, "-c", JAX, str(case.folder), f"{case.name}_xp"]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return {n: round(float(s), 1) for n, s in zip(FUNCTIONS, said.split(), strict=True)}
