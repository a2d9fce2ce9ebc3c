"""Functions of the generated code compared: by their statements, and by value."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from pne_sym.review.difference import BlockDifference, Gap, Verdict
from pne_sym.review.measure import gap_between
from pne_sym.review.model import Model

_PARTS = {"inverse_dynamics": "required", "leg_reactions": "legs", "energy": "potential"}
_NAMES = {
    "energy": ("kinetic energy", "potential energy"),
    "inverse_dynamics": ("inverse_dynamics", "lambda of inverse_dynamics"),
    "forward_dynamics": ("forward_dynamics", "lambda of forward_dynamics"),
}
_FLOORS = {"constraints": 1e3}
"""Residuals vanish: rounding of lengths of some metres is no difference."""


def compare_blocks(
    before: Model, after: Model, old: list[Any], new: list[Any], tolerance: float
) -> Iterator[BlockDifference]:
    """Every function of the two modules.

    Args:
        before: a version.
        after: another.
        old: values by function, per set of parameters.
        new: likewise.
        tolerance: relative.
    """
    names = dict.fromkeys(n for values in (*old, *new) for n in values)
    for name in names:
        a, b = ([values[name] for values in side if name in values] for side in (old, new))
        same = _statements(before.source, name) == _statements(after.source, name)
        if not a or not b:
            yield BlockDifference(name, Verdict.ADDED if b else Verdict.REMOVED)
            continue
        for k in range(max(len(a[0]), len(b[0]))):
            label = _NAMES.get(name, (name,) * 2)[min(k, 1)]
            if k >= len(a[0]) or k >= len(b[0]):
                yield BlockDifference(label, Verdict.ADDED if k < len(b[0]) else Verdict.REMOVED)
                continue
            gap = _gap([v[k] for v in a], [v[k] for v in b], _FLOORS.get(name, 0.0))
            yield BlockDifference(label, *_verdict(gap, tolerance, same=same))


def _gap(a: list[Any], b: list[Any], floor: float) -> Gap | None:
    return gap_between(np.concatenate(a), np.concatenate(b), floor=floor)


def _verdict(gap: Gap | None, tolerance: float, *, same: bool) -> tuple[Verdict, Gap | None]:
    if gap is not None and gap.size > tolerance:
        return Verdict.DIFFERENT, gap
    return (Verdict.IDENTICAL if same else Verdict.EQUAL), gap


def _statements(source: str, name: str) -> list[str]:
    """Straight-line code of a function and its preparation, without comments."""
    part = _PARTS.get(name, name)
    wanted = re.compile(rf"def _{part}_(?:before|after|[a-z0-9_]+)\(|def _prepare\(")
    chunks = [c for c in re.split(r"\n(?=\S)", source) if wanted.match(c)]
    lines = [line.strip() for chunk in chunks or [source] for line in chunk.split("\n")]
    return [line for line in lines if line and not line.startswith("#")]
