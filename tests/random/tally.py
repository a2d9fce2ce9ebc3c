"""Draw, derive and compare many mechanisms, and print the tally.

python -m tests.random.tally COUNT [FIRST_SEED] [--c]
"""

from __future__ import annotations

import re
import sys
import time
import traceback
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from tests.random.drawing import describe, draw
from tests.random.judging import TOLERANCE, Verdict, judge


@dataclass
class Tally:
    """What became of the mechanisms drawn so far.

    Attributes:
        drawn, derived, iterated, constrained, compiled, at_home: how many.
        other_branch: states at which iteration from home found another closure.
        refused: reason -> how many.
        errors: worst error by quantity, and the seed that has it.
        failures: seed and what is wrong.
    """

    drawn: int = 0
    derived: int = 0
    iterated: int = 0
    constrained: int = 0
    compiled: int = 0
    at_home: int = 0
    other_branch: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    errors: dict[str, tuple[float, int]] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)

    def add(self, seed: int, verdict: Verdict) -> None:
        """Count a verdict."""
        self.drawn += 1
        if verdict.refused:
            self.refused[re.sub(r"\d+", "n", verdict.refused)] += 1
            return
        self.derived += 1
        self.iterated += verdict.iterated
        self.constrained += verdict.constrained
        self.compiled += verdict.compiled
        self.at_home += verdict.stateless
        self.other_branch += verdict.other_branch
        for name, error in verdict.errors.items():
            if error >= self.errors.get(name, (-1.0, 0))[0]:
                self.errors[name] = (error, seed)

    def fail(self, seed: int, title: str, problem: str) -> None:
        """Count a failure."""
        self.failures.append(f"seed {seed}: {title}\n    {problem}")
        print(self.failures[-1], flush=True)

    def __str__(self) -> str:
        """For people."""
        lines = [
            f"drawn {self.drawn}, derived {self.derived} ({self.constrained} constrained, "
            f"{self.iterated} by iteration, {self.compiled} also in C, {self.at_home} at home "
            f"only), refused {sum(self.refused.values())}, failures {len(self.failures)}; "
            f"{self.other_branch} states on another closure when iterated from home",
            *(f"  refused {n}: {reason}" for reason, n in self.refused.most_common()),
            *(f"  {name}: worst {e:.1e} (seed {s})" for name, (e, s) in self.errors.items()),
        ]
        return "\n".join(lines)


def one(tally: Tally, seed: int, *, light: bool = False, with_c: bool = False) -> None:
    """Draw and judge the mechanism of a seed."""
    manipulator = draw(seed, light=light)
    title = describe(manipulator)
    try:
        verdict = judge(manipulator, np.random.default_rng(seed), with_c=with_c)
    except Exception:  # noqa: BLE001: a crash of any kind is what is looked for
        tally.drawn += 1
        tally.fail(seed, title, traceback.format_exc(limit=-3))
        return
    tally.add(seed, verdict)
    if verdict.wrong:
        wrong = ", ".join(f"{name} {error:.1e}" for name, error in verdict.wrong.items())
        tally.fail(seed, title, wrong)


def main(arguments: list[str]) -> int:
    """Run; 1 if anything failed."""
    numbers = [int(a) for a in arguments if a.isdigit()]
    count, first = (*numbers, 0, 0)[:2] if len(numbers) > 1 else ((*numbers, 600)[0], 0)
    tally, start = Tally(), time.perf_counter()
    for seed in range(first, first + count):
        one(tally, seed, light="--light" in arguments, with_c="--c" in arguments)
        if (seed - first + 1) % 50 == 0:
            print(f"{seed - first + 1} of {count}, {time.perf_counter() - start:.0f} s", flush=True)
    print(tally)
    print(f"{time.perf_counter() - start:.0f} s; right is below {TOLERANCE:g}")
    return 1 if tally.failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
