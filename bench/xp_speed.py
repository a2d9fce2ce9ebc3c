"""Measure array-API modules: time to compile every function under jax.jit, time per state.

    python bench/xp_speed.py [MODEL] [STATES]

Needs the extra `targets`.  Times to compile are of the processor; times per state are of the clock,
the least of several rounds in which NumPy and JAX take turns.
"""

from __future__ import annotations

import importlib
import inspect
import sys
import tempfile
import time
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from pne_sym.generation import generate

BLOCK = 2000
"""States that are computed together under lax.map: as many as the cache holds."""
ROUNDS = 5


def modules(name: str, folder: str) -> tuple[Any, Any]:
    """NAME.py and NAME_xp.py, generated."""
    generate(name, folder, ("numpy", "xp"))
    sys.path.insert(0, folder)
    return tuple(importlib.import_module(f"{name}.{m}") for m in (name, f"{name}_xp"))


def states(m: Any, count: int) -> dict[str, Any]:
    """Arguments of all functions around home."""
    rng = np.random.default_rng(0)
    X = m.HOME_X + 1e-2 * rng.uniform(-1.0, 1.0, (count, m.NQ))
    found = {name: rng.uniform(-1.0, 1.0, (count, m.NV)) for name in "VA"}
    found |= {"X": X, "X0": X, "tau": rng.uniform(-1.0, 1.0, (count, m.NU))}
    found["q_actuated"] = m.inverse_kinematics(X)[:, list(m.ACTUATED)]
    if hasattr(m, "rotation"):
        found |= {"R": m.rotation(X), "t": X[:, : m.NQ - 4], "rpy": X[:, :3]}
    return found


def seconds(run: Callable[[], Any], clock: Callable[[], float] = time.perf_counter) -> float:
    """Of one run."""
    start = clock()
    run()
    return clock() - start


def compile_times(x: Any, given: dict[str, Any]) -> dict[str, float]:
    """Seconds of the processor, all threads, to trace and compile each function."""
    found = {}
    for name in sorted(x.__all__):
        function = getattr(x, name)
        if not inspect.isfunction(function) or name == "parameters":
            continue
        taken = {n: given[n] for n in inspect.signature(function).parameters if n in given}
        p = {"p": x.parameters(jnp)} if "p" in inspect.signature(function).parameters else {}
        jitted = jax.jit(function)
        found[name] = seconds(
            lambda f=jitted, a=taken | p: f.lower(**a).compile(), time.process_time
        )
    return found


def main() -> None:
    """Print a table."""
    name = sys.argv[1] if len(sys.argv) > 1 else "stewart"
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 100_000
    jax.config.update("jax_enable_x64", True)
    with tempfile.TemporaryDirectory() as folder:
        m, x = modules(name, folder)
        few = {n: jnp.asarray(a) for n, a in states(m, 8).items()}
        for function, time_ in sorted(compile_times(x, few).items(), key=lambda row: -row[1]):
            print(f"compile {function:<24} {time_:6.2f} s")
        many = states(m, count)
        p = x.parameters(jnp)
        arrays = [many[n] for n in "XVA"]
        blocks = [jnp.asarray(a.reshape(-1, BLOCK, a.shape[-1])) for a in arrays]
        mapped = jax.jit(lambda *a: jax.lax.map(lambda b: x.inverse_dynamics(*b, p), a))
        mapped(*blocks).block_until_ready()
        times = [  # one after another, so that what else the machine does slows both
            (
                seconds(lambda: m.inverse_dynamics(*arrays)),
                seconds(lambda: mapped(*blocks).block_until_ready()),
            )
            for _ in range(ROUNDS)
        ]
        of_numpy, of_jax = (min(t) / count * 1e6 for t in zip(*times, strict=True))
        print(f"inverse_dynamics, {count} states: NumPy {of_numpy:.2f} us, JAX {of_jax:.2f} us")
        print(f"NumPy / JAX {of_numpy / of_jax:.2f}")


if __name__ == "__main__":
    main()
