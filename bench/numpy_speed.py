"""Measure the NumPy module, as ratios to `numpy.linalg.solve` of its systems in the same run.

    python bench/numpy_speed.py [MODEL] [STATES]

All times are of the processor: medians over rounds in which everything takes its turn.
"""

from __future__ import annotations

import importlib
import sys
import tempfile
import time
from collections.abc import Callable
from statistics import median
from typing import Any

import numpy as np

from pne_sym.generation import generate

ROUNDS = 9
COUNTS = (1, 10, 100, 1000)
"""Numbers of states, besides that of the command line."""


def seconds(run: Callable[[], Any], times: int) -> float:
    """Of the processor for one run."""
    start = time.process_time()
    for _ in range(times):
        run()
    return (time.process_time() - start) / times


def jobs(m: Any, count: int) -> dict[str, Callable[[], Any]]:
    """What is measured, at so many states around home."""
    rng, lead = np.random.default_rng(0), () if count == 1 else (count,)
    X = m.HOME_X + 1e-2 * rng.uniform(-1.0, 1.0, (*lead, m.NQ))
    V, A = rng.uniform(-1.0, 1.0, (2, *lead, m.NV))
    M, b = m.M(X), V[..., None]
    return {
        "numpy.linalg.solve": lambda: np.linalg.solve(M, b),
        "inverse dynamics": lambda: m.inverse_dynamics(X, V, A),
        "M, Z, H": lambda: m.dynamics(X, V),
        "inverse kinematics": lambda: m.inverse_kinematics(X),
    }


def main() -> None:
    """Print a table."""
    name = sys.argv[1] if len(sys.argv) > 1 else "stewart"
    most = int(sys.argv[2]) if len(sys.argv) > 2 else 100_000
    with tempfile.TemporaryDirectory() as folder:
        generate(name, folder, ("numpy",))
        sys.path.insert(0, folder)
        m = importlib.import_module(f"{name}.{name}")
        print(f"{name}: time per state, and its ratio to that of numpy.linalg.solve")
        for count in (*COUNTS, most):
            given, times = jobs(m, count), max(1, 300 // count)
            rounds = [{n: seconds(run, times) for n, run in given.items()} for _ in range(ROUNDS)]
            of = {n: median(r[n] for r in rounds) / count for n in given}
            unit = of["numpy.linalg.solve"]
            rows = (f"{n} {t * 1e6:.2f} us ({t / unit:.1f})" for n, t in of.items())
            print(f"{count:>8} states: {', '.join(rows)}")


if __name__ == "__main__":
    main()
