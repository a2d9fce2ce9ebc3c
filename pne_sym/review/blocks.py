"""Functions of the generated code compared by what they return."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pne_sym.model.kinematics import Array
from pne_sym.review.c_driver import Key
from pne_sym.review.difference import BlockDifference, Gap, Verdict
from pne_sym.review.execution import Answer
from pne_sym.review.measure import gap_between

_FLOORS = {"constraints": 1e3}
"""Residuals vanish: rounding of lengths of some metres is no difference."""
Calls = Sequence[Mapping[Key, list[Array]]]


@dataclass(frozen=True)
class Terms:
    """How functions are compared.

    Attributes:
        kept: states that count, per set.
        tolerance: relative.
        functions: of the manifest, for the names of what they return.
        actuators: how many there are.
    """

    kept: Sequence[NDArray[Any]]
    tolerance: float
    functions: Mapping[str, Any]
    actuators: int

    def outputs(self, name: str) -> list[str]:
        """Names of what a function returns, where the manifest has them."""
        return list(self.functions.get(name, {}).get("outputs", ()))


def numpy_blocks(
    before: Answer,
    after: Answer,
    terms: Terms,
    same: Callable[[str], bool],
) -> Iterator[BlockDifference]:
    """Every function that one of the two NumPy modules exports.

    Args:
        before: what a version answers.
        after: what another answers.
        terms: how they are compared.
        same: whether the text of a function is the same.
    """
    faults = {**before.errors, **after.errors}
    for name, alone in _functions((*a.calls, a.errors) for a in (before, after)):
        reasons = [f"{why}{_with(k[1])}" for k, why in faults.items() if k[0] == name]
        if alone is not None:
            yield BlockDifference(name, alone)
        elif reasons:
            yield BlockDifference(name, Verdict.NOT_COMPARED, note=reasons[0])
        else:
            compared = _Function(name, terms.outputs(name), terms)
            yield compared.difference(name, before.calls, after.calls, same=same(name))


def c_blocks(before: Answer, after: Answer, terms: Terms) -> Iterator[BlockDifference]:
    """Every function of the two C modules, their sizes, home and defaults."""
    old, new = (
        {**a.constants, **{f"default of {n}": v for n, v in a.defaults.items()}}
        for a in (before, after)
    )
    for what in (w for w in old if w in new):
        gap = gap_between([old[what]], [new[what]])
        if gap is not None:
            yield BlockDifference(f"C: {what}", Verdict.DIFFERENT, gap)
    for name, alone in _functions(a.calls for a in (before, after)):
        if alone is not None:
            yield BlockDifference(f"C: {name}", alone)
            continue
        compared = _Function(name, [*terms.outputs(name), "status", "failures"], terms)
        yield compared.difference(f"C: {name}", before.calls, after.calls, same=False)


def _functions(
    versions: Iterable[Sequence[Mapping[Any, Any]]],
) -> Iterator[tuple[str, Verdict | None]]:
    """Functions that are called, in order, and how one compares that one version has alone."""
    old, new = (dict.fromkeys(key[0] for each in tables for key in each) for tables in versions)
    for name in old | new:
        alone = Verdict.REMOVED if name in old else Verdict.ADDED
        yield name, None if name in old and name in new else alone


class _Function:
    """Compares what a function returns."""

    def __init__(self, name: str, labels: list[str], terms: Terms) -> None:
        self.name, self.labels, self.terms = name, labels, terms

    def difference(self, title: str, before: Calls, after: Calls, *, same: bool) -> BlockDifference:
        """The verdict, with the largest difference over all calls and outputs."""
        own = [
            dict.fromkeys(k for each in calls for k in each if k[0] == self.name)
            for calls in (before, after)
        ]
        taken = [{n for key in keys for n in key[1]} for keys in own]
        given = sorted(taken[0] ^ taken[1])
        if own[0].keys() != own[1].keys() and not given:
            return BlockDifference(title, Verdict.DIFFERENT, note="not called in the same ways")
        if not sum(map(len, self.terms.kept)):
            verdict = Verdict.IDENTICAL if same else Verdict.NOT_COMPARED
            return BlockDifference(title, verdict, note="no state is possible")
        common = [key for key in own[0] if key in own[1]]
        gaps = [gap for key in common for gap in self._gaps(key, before, after)]
        worst = max(gaps, key=lambda g: g.size, default=None)
        if given:
            alike = worst is None or not worst.size > self.terms.tolerance
            note = f"only one takes {', '.join(given)}; " + (
                "without it they are the same" if alike else "without it values differ too"
            )
            return BlockDifference(title, Verdict.DIFFERENT, None if alike else worst, note=note)
        if worst is not None and worst.size > self.terms.tolerance:
            return BlockDifference(title, Verdict.DIFFERENT, worst)
        return BlockDifference(title, Verdict.IDENTICAL if same else Verdict.EQUAL, worst)

    def _gaps(self, key: Key, before: Calls, after: Calls) -> Iterator[Gap]:
        sides = [[each[key] for each in calls if key in each] for calls in (before, after)]
        counts = {len(outputs) for side in sides for outputs in side}
        if len(counts) != 1 or len(sides[0]) != len(sides[1]):
            yield Gap(np.inf, "shapes of what is returned", 0.0, 0.0)
            return
        for k in range(counts.pop()):
            a, b = ([self._kept(i, o[k]) for i, o in enumerate(side)] for side in sides)
            shapes = {x.shape[1:] for x in (*a, *b)}
            if len(shapes) != 1:
                yield Gap(np.inf, f"shapes {', '.join(map(str, sorted(shapes)))}", 0.0, 0.0)
                continue
            floor = _FLOORS.get(self.name, 0.0)
            gap = gap_between(np.concatenate(a), np.concatenate(b), floor=floor)
            if gap is not None:
                yield self._placed(gap, key, k)

    def _kept(self, k: int, value: Array) -> Array:
        """The states that count; of a basis what does not depend on its choice."""
        wanted = self.terms.kept[k]
        if value.ndim == 0 or len(value) <= max(wanted, default=-1):
            return np.full((1, 0, *value.shape), np.nan)
        rows: Array = value[wanted]
        actuators = max(1, self.terms.actuators)
        columns, odd = divmod(math.prod(rows.shape[1:]), actuators)
        if self.name == "null_space" and columns and not odd:
            basis = rows.reshape(len(rows), actuators, columns)
            rows = np.matmul(basis, np.swapaxes(basis, -1, -2))
        return rows

    def _placed(self, gap: Gap, key: Key, k: int) -> Gap:
        """The difference with the output and the call it is of."""
        several = len(self.labels) > 1
        of = f" of {self.labels[k]}" if several and k < len(self.labels) else ""
        how = ", states one by one" if key[2] == "single" else ""
        where = f"{gap.where}{of}{_with(key[1])}{how}"
        return Gap(gap.size, where, gap.before, gap.after)


def _with(given: Sequence[str]) -> str:
    return f" with {', '.join(given)}" if given else ""
