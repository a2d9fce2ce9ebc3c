"""What is called from Python, in a process of its own: python -m bench.python_side NAME [RESULTS].

Prints `WHO FUNCTION ns failed` and writes what was computed, as speed.c does.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from bench.cases import BUILD, FUNCTIONS, Array, Case, States
from bench.peers import peers

ROUNDS = 9
SINGLES = 16
"""States that are called one by one in a round; all are computed once, for the comparison."""
Arrays = tuple[Array, ...]


@dataclass(frozen=True)
class Job:
    """A function of somebody.

    Attributes:
        key: who, and the function; "_batch" at its end: all states in a call.
        call: gives the results of one state, or of all.
        arguments: of the states.
    """

    key: str
    call: Callable[..., Any]
    arguments: Arrays

    def results(self) -> list[Array]:
        """Of all states."""
        if self.key.endswith("_batch"):
            return [np.asarray(a) for a in self.call(*self.arguments)]
        rows = [self.call(*row) for row in zip(*self.arguments, strict=True)]
        return [np.stack(arrays) for arrays in zip(*rows, strict=True)]

    def nanoseconds(self) -> float:
        """Of a state, the least of the rounds."""
        batch = self.key.endswith("_batch")
        rows = [self.arguments] if batch else list(zip(*self.arguments, strict=True))[:SINGLES]
        states, best = len(self.arguments[0]) if batch else len(rows), float("inf")
        for _ in range(ROUNDS):
            start = time.perf_counter()
            for row in rows:
                self.call(*row)
            best = min(best, time.perf_counter() - start)
        return 1e9 * best / states


def functions(m: Any) -> dict[str, Callable[..., Arrays]]:
    """Those of a module that are measured, without multipliers."""
    first = slice(0, 1)
    return {
        "inverse_dynamics": lambda *a: (
            m.inverse_dynamics(*a)[first] if m.NC else (m.inverse_dynamics(*a),)
        ),
        "dynamics": lambda *a: m.dynamics(*a)[:3],
        "forward_dynamics": lambda *a: (
            m.forward_dynamics(*a)[first] if m.NC else (m.forward_dynamics(*a),)
        ),
    }


def jitted(call: Callable[..., Arrays]) -> Callable[..., Any]:
    """Under jax.jit, waiting for the results."""
    compiled = jax.jit(call)
    return lambda *a: jax.block_until_ready(compiled(*a))


def jobs(case: Case, s: States) -> Iterator[Job]:
    """All that is called from Python."""
    arguments = dict(zip(FUNCTIONS, ((s.X, s.V, s.A), (s.X, s.V), (s.X, s.V, s.tau)), strict=True))
    for who, suffix in (("NumPy", ""), ("extension", "_ext")):
        for name, call in functions(case.module(suffix)).items():
            yield Job(f"{who} {name}", call, arguments[name])
            yield Job(f"{who} {name}_batch", call, arguments[name])
    jax.config.update("jax_enable_x64", True)
    jax.config.update("jax_compilation_cache_dir", str(BUILD / "jax"))
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
    for name, call in functions(case.module("_xp")).items():
        if name != "forward_dynamics":
            arrays = tuple(map(jnp.asarray, arguments[name]))
            yield Job(f"JAX {name}_batch", jitted(call), arrays)
    for key, call in peers(case, s):
        yield Job(key, call, (np.arange(len(s.X)),))


def main() -> None:
    """Measure."""
    case = Case(sys.argv[1])
    s, written = case.states(), []
    for job in jobs(case, s):
        found = job.results()
        written += found
        print(job.key, f"{job.nanoseconds():.1f}", int(not all(map(_finite, found))), flush=True)
    if len(sys.argv) > 2:
        Path(sys.argv[2]).write_bytes(b"".join(a.astype(float).tobytes() for a in written))


def _finite(a: Array) -> bool:
    return bool(np.isfinite(a).all())


if __name__ == "__main__":
    main()
