"""Draw, derive and compare many mechanisms, and print the tally.

python -m tests.random.tally --count 600 --seed 0 --jobs 2

One line per mechanism, then how many were drawn, derived and refused (by reason), what the
derived ones were, and the worst error of every quantity.  Exit code 1 if any answer is wrong, any
refusal has no mechanical reason, or anything but a refusal is raised.
"""

from __future__ import annotations

import argparse
import multiprocessing
import re
import sys
import time
import traceback
from collections import Counter
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from pne_sym.model.manipulator import Manipulator
from tests.oracle.closure import OracleError
from tests.oracle.coordinates import extra_indices, passive_extra_rows, task_size
from tests.oracle.forces import are_held, rank
from tests.oracle.projection import project
from tests.random.drawing import describe, draw
from tests.random.judging import TOLERANCE, Verdict, judge

MECHANICAL = (
    r"\d+ degrees of freedom where the platform joint leaves \d+ to be determined",
    r"the leg is singular at home",
    r"two solutions of the inverse kinematics meet at home",
    r"overconstrained: of the \d+ constraints",
    r"the legs hold the platform: nothing moves at home",
    r"of the joints marked extra, \d+ cannot move: how the platform is guided holds them",
    r"no joint is actuated",
)
"""Reasons for which a mechanism is outside the method."""


@dataclass(frozen=True)
class Outcome:
    """What became of the mechanism of a seed.

    Attributes:
        seed: of the drawing.
        title: structure in one line.
        features: what occurs in it.
        verdict: None if judging crashed.
        problem: why it fails; empty if the answer, or the refusal, is right.
        seconds: that judging took.
    """

    seed: int
    title: str
    features: frozenset[str]
    verdict: Verdict | None
    problem: str
    seconds: float

    @property
    def derived(self) -> bool:
        """Whether code was generated and compared."""
        return self.verdict is not None and not self.verdict.refused

    def __str__(self) -> str:
        """For people."""
        what = "refused: " + self.verdict.refused if self.verdict and self.verdict.refused else "ok"
        problem = f"FAILED\n    {self.problem}"
        return f"{self.seed} ({self.seconds:.1f} s) {self.title}: " + (
            problem if self.problem else what
        )


def outcome(
    seed: int, *, light: bool = False, with_c: bool = True, anywhere: bool = True
) -> Outcome:
    """Draw and judge the mechanism of a seed."""
    manipulator = draw(seed, light=light, anywhere=anywhere)
    known = seed, describe(manipulator), features(manipulator)
    start = time.perf_counter()
    try:
        verdict = judge(manipulator, np.random.default_rng(seed), with_c=with_c)
    except Exception:  # a crash of any kind is what is looked for
        problem = traceback.format_exc(limit=-3)
        return Outcome(*known, None, problem, time.perf_counter() - start)
    return Outcome(*known, verdict, _problem(verdict), time.perf_counter() - start)


def _problem(verdict: Verdict) -> str:
    if verdict.refused and not any(re.match(reason, verdict.refused) for reason in MECHANICAL):
        return f"refused without a mechanical reason: {verdict.refused}"
    return ", ".join(f"{name} {error:.1e}" for name, error in verdict.wrong.items())


def features(manipulator: Manipulator) -> frozenset[str]:
    """Space, kinds of joints and platform joints, and marks that occur."""
    joints = [joint for leg in manipulator.legs for joint in leg.joints]
    return frozenset(
        {
            f"space {manipulator.space}",
            f"{len(manipulator.legs)} legs",
            *(f"joint {joint.kind}" for joint in joints),
            *(f"platform joint {leg.platform_joint.kind}" for leg in manipulator.legs),
            *("actuated extra" if joint.actuated else "passive extra" for joint in joints
              if joint.extra),
            *("massless link" for joint in joints if joint.link.is_massless),
            *("friction" for joint in joints if joint.friction),
            *("spring" for joint in joints if joint.spring),
            *({"payload"} if manipulator.payload else ()),
            *("motor" for joint in joints if joint.actuator),
            *("limits of displacement" for joint in joints if joint.has_stroke),
            *("limits of effort" for joint in joints if joint.limits and joint.limits.effort),
            *("platform friction" for leg in manipulator.legs if leg.platform_joint.friction),
            *({"moving base"} if manipulator.moving_base else ()),
            *({"coupled motors"} if manipulator.coupling else ()),
            *_ranks(manipulator),
        }
    )  # fmt: skip


def _ranks(manipulator: Manipulator) -> set[str]:
    """What the actuators hold at home."""
    twist = task_size(manipulator.space) + len(extra_indices(manipulator))
    home = np.array(manipulator.home.X), np.array(manipulator.home.q)
    try:
        state = project(manipulator, *home, np.zeros(twist))
    except OracleError:
        return set()
    K, passive = np.hstack([state.H, state.Hk]), passive_extra_rows(manipulator)
    if not are_held(K, passive):
        return {"too few actuators"}
    found = {"redundant actuators"} if K.shape[1] > rank(K) else set()
    if passive:
        least = twist - len(passive)
        what = "all" if rank(K) == twist else "some" if rank(K) > least else "none"
        found.add(f"passive extra, {what} held by surplus actuators")
    return found


@dataclass
class Tally:
    """What became of the mechanisms drawn so far.

    Attributes:
        drawn, derived, iterated, constrained, overconstrained, compiled, at_home: how many.
        other_branch: states at which iteration from home found another closure.
        refused: reason -> how many.
        features: what occurs -> in how many of the derived.
        errors: worst error by quantity, and the seed that has it.
        failed: seeds.
    """

    drawn: int = 0
    derived: int = 0
    iterated: int = 0
    constrained: int = 0
    overconstrained: int = 0
    compiled: int = 0
    at_home: int = 0
    other_branch: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    features: Counter[str] = field(default_factory=Counter)
    errors: dict[str, tuple[float, int]] = field(default_factory=dict)
    failed: list[int] = field(default_factory=list)

    def add(self, found: Outcome) -> None:
        """Count an outcome."""
        self.drawn += 1
        if found.problem:
            self.failed.append(found.seed)
        verdict = found.verdict
        if verdict is None:
            return
        if verdict.refused:
            self.refused[re.sub(r"\d+", "n", verdict.refused)] += 1
            return
        self.derived += 1
        self.features.update(found.features)
        self.iterated += verdict.iterated
        self.constrained += verdict.constrained
        self.overconstrained += verdict.overconstrained
        self.compiled += verdict.compiled
        self.at_home += verdict.stateless
        self.other_branch += verdict.other_branch
        for name, error in verdict.errors.items():
            if error >= self.errors.get(name, (-1.0, 0))[0]:
                self.errors[name] = (error, found.seed)

    def __str__(self) -> str:
        """For people."""
        lines = [
            f"drawn {self.drawn}, derived {self.derived} ({self.constrained} constrained, "
            f"{self.overconstrained} of them more than once, "
            f"{self.iterated} by iteration, {self.compiled} also in C, {self.at_home} at home "
            f"only), refused {sum(self.refused.values())}, failed {len(self.failed)}; "
            f"{self.other_branch} states on another closure when iterated from home",
            *(f"  refused {n}: {reason}" for reason, n in self.refused.most_common()),
            *(f"  {n} with {what}" for what, n in sorted(self.features.items())),
            *(f"  {name}: worst {e:.1e} (seed {s})" for name, (e, s) in self.errors.items()),
            *(f"  failed: seed {seed}" for seed in sorted(self.failed)),
        ]
        return "\n".join(lines)


def main(arguments: list[str]) -> int:
    """Run; 1 if anything failed."""
    parser = argparse.ArgumentParser(description="Mechanisms drawn at random, and their tally.")
    parser.add_argument("--count", type=int, default=600, help="how many")
    parser.add_argument("--seed", type=int, default=0, help="the first; the others follow")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--light", action="store_true", help="few leg types, short chains")
    parser.add_argument("--no-c", action="store_true", help="NumPy only")
    given = parser.parse_args(arguments)
    tally, start = Tally(), time.perf_counter()
    work = partial(outcome, light=given.light, with_c=not given.no_c)
    seeds = range(given.seed, given.seed + given.count)
    # Processes are renewed: what SymPy caches of one mechanism is of no use to the next.
    with multiprocessing.get_context("spawn").Pool(given.jobs, maxtasksperchild=20) as pool:
        for found in pool.imap_unordered(work, seeds):
            tally.add(found)
            print(f"[{tally.drawn} of {given.count}] {found}", flush=True)
    print(tally)
    print(f"{time.perf_counter() - start:.0f} s; right is below {TOLERANCE:g}")
    return 1 if tally.failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
