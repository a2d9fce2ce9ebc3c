"""Plant the faults one at a time, and list those that no test sees: `make mutants`."""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from tests.mutants.faults import ROOT, Fault, FaultError, faults
from tests.mutants.trial import Outcome, Verdict, baseline, try_fault

_BASELINE = 3600.0
_BAD = (Verdict.SURVIVED, Verdict.TIMEOUT, Verdict.WRONG)


def main(arguments: Sequence[str]) -> int:
    """Run; 1 if a fault survived, a row is wrong, or a test fails without any fault."""
    given = _parser().parse_args(arguments)
    try:
        chosen = [f for f in faults() if _is_chosen(f, given.only)]
        check_rows(chosen)
    except FaultError as error:
        print(error, file=sys.stderr)
        return 1
    if not given.no_baseline and (failing := baseline(chosen, _BASELINE)):
        print(f"fails without a fault: {failing}", file=sys.stderr)
        return 1
    outcomes = run(chosen, given.jobs, given.seconds, wider=not given.no_wider)
    print(table(outcomes))
    return int(any(o.verdict in _BAD for o in outcomes))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description="Faults planted one at a time.")
    parser.add_argument("-j", "--jobs", type=int, default=1, help="trials side by side")
    parser.add_argument("--seconds", type=float, default=400.0, help="of a run, at most")
    parser.add_argument(
        "--only", nargs="*", default=[], help="names, such as lowering or program-3"
    )
    parser.add_argument("--no-wider", action="store_true", help="the named tests only")
    parser.add_argument("--no-baseline", action="store_true", help="trust that the tests pass")
    return parser


def _is_chosen(fault: Fault, only: Sequence[str]) -> bool:
    return not only or fault.name in only or fault.name.rpartition("-")[0] in only


def check_rows(chosen: Sequence[Fault]) -> None:
    """FaultError unless every row fits the sources."""
    for fault in chosen:
        fault.mutated((ROOT / fault.file).read_text(encoding="utf-8"))


def run(chosen: Sequence[Fault], jobs: int, seconds: float, *, wider: bool = True) -> list[Outcome]:
    """Outcomes in the order of the rows; progress goes to standard error."""
    start, found = time.perf_counter(), []
    with ThreadPoolExecutor(jobs) as pool:
        for outcome in pool.map(partial(try_fault, seconds=seconds, wider=wider), chosen):
            found.append(outcome)
            spent = time.perf_counter() - start
            print(
                f"[{len(found)} of {len(chosen)}, {spent:.0f} s] {outcome.fault.name}: "
                f"{outcome.verdict} {outcome.by}",
                file=sys.stderr,
                flush=True,
            )
    return found


def table(outcomes: Sequence[Outcome]) -> str:
    """For people: a line per fault, survivors once more, and the counts."""
    lines = ["| fault | what | file | verdict | by |", "|---|---|---|---|---|"]
    for o in outcomes:
        by = o.by.replace("|", r"\|")
        lines.append(f"| {o.fault.name} | {o.fault.what} | {o.fault.file} | {o.verdict} | {by} |")
    lines.append("")
    lines += [
        f"{o.verdict}: {o.fault.name}: {o.fault.what}" for o in outcomes if not o.verdict.is_good
    ]
    counts = Counter(o.verdict for o in outcomes)
    told = ", ".join(f"{counts[v]} {v.lower()}" for v in Verdict if counts[v])
    return "\n".join([*lines, f"{len(outcomes)} faults: {told or 'none'}"])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
