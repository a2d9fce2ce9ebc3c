"""Measure everything, or write the page of what has been measured: python -m bench [page]."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

from bench import growth, machine
from bench.c_programs import c_programs, peak
from bench.cases import NAMES, Case
from bench.features import counts, time_ratios
from bench.generation import generation_times, jax_compile_times
from bench.page import RESULTS, write_page
from bench.pinocchio_model import projection, projection_program
from bench.programs import Program, measure

COUNTS = {
    "inverse_dynamics": ("inverse_dynamics", "required"),
    "dynamics": ("dynamics",),
}
"""Entries of a manifest's operation counts, by function."""


def operations(case: Case) -> dict[str, int]:
    """Multiplications, additions, divisions and roots of a state."""
    said = json.loads((case.folder / f"{case.name}.json").read_text(encoding="utf-8"))["operations"]
    found = {}
    for function, names in COUNTS.items():
        counts = next(said[name] for name in names if name in said)
        found[function] = sum(counts[kind] for kind in ("mul", "add", "div", "sqrt"))
    return found


def timed(what: str, job: Callable[[], Any]) -> Any:
    """Do it and say how long it took."""
    start = time.monotonic()
    found = job()
    print(f"{what}: {time.monotonic() - start:.0f} s", file=sys.stderr, flush=True)
    return found


def programs_of(case: Case) -> list[Program]:
    """Generate a mechanism and compile all that is measured of it."""
    case.generate()
    python = (sys.executable, "-m", "bench.python_side", case.name)
    return [*c_programs(case), Program(case, "", "", python)]


def run() -> None:
    """Measure and write results.json."""
    cases = [Case(name) for name in NAMES]
    pool = ThreadPoolExecutor(1)
    tree = pool.submit(projection_program)  # beside all else that is compiled
    programs = {c.name: timed(f"compile {c.name}", partial(programs_of, c)) for c in cases}
    rows = []
    for case in cases:
        programs[case.name] += projection(case, tree.result())
        rows += timed(f"measure {case.name}", partial(measure, programs[case.name]))
    results = {
        "machine": machine.description(),
        "peak": timed("rate of the core", peak),
        "operations": {case.name: operations(case) for case in cases},
        "rows": rows,
        "growth": {
            "legs": timed("growth with legs", growth.over_legs),
            "states": timed("growth with states", growth.over_states),
        },
        "features": {
            "operations": timed("features", lambda: counts(cases[0].manipulator)),
            "times": timed("time of features", lambda: time_ratios(cases[0].manipulator)),
        },
        "generation": timed("generation", generation_times),
        "jax": timed("JAX's compiler", lambda: jax_compile_times(cases[0])),
    }
    RESULTS.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")


def main() -> None:
    """Run, and write the page."""
    parser = argparse.ArgumentParser(prog="bench", description=__doc__)
    parser.add_argument("what", nargs="?", choices=("all", "page"), default="all")
    if parser.parse_args().what == "all":
        run()
    write_page()


if __name__ == "__main__":
    main()
