"""Versions of a model with one equation rewritten or spoilt, made in memory."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

from pne_sym.backends.bundle import Bundle
from pne_sym.derivation import Derivation, Equation
from pne_sym.lowering.program import lower
from pne_sym.model.manipulator import Manipulator
from pne_sym.review.compare import compare
from pne_sym.review.difference import Comparison, EquationDifference, Verdict
from pne_sym.review.model import Model, from_bundle
from tests.models import bundle, catalogue

Rewrite = Callable[[Equation], Equation]


@cache
def version(manipulator: Manipulator) -> Model:
    """The version as it is generated."""
    return from_bundle("before", bundle(manipulator))


def rewritten(derivation: Derivation, changes: dict[str, Rewrite]) -> Derivation:
    """The derivation with some equations changed, by name."""
    assert all(derivation.definition(name) for name in changes)
    return replace(
        derivation,
        chapters=tuple(
            replace(c, equations=tuple(changes.get(e.name, lambda e: e)(e) for e in c.equations))
            for c in derivation.chapters
        ),
    )


def compiled(manipulator: Manipulator, derivation: Derivation) -> Model:
    """A version with another derivation, lowered like any."""
    return from_bundle("after", Bundle(manipulator, derivation, lower(derivation)))


def with_rhs(rhs: Callable[[Any], Any]) -> Rewrite:
    """Another right-hand side; other forms, which would contradict it, are dropped."""
    return lambda e: replace(e, rhs=rhs(e.rhs), forms=())


def change(name: str, changes: dict[str, Rewrite]) -> Comparison:
    """A catalogue entry compared with itself after changes."""
    manipulator = catalogue(name)
    after = compiled(manipulator, rewritten(bundle(manipulator).derivation, changes))
    return compare(version(manipulator), after)


def of(found: Comparison, name: str) -> EquationDifference:
    """What was found of one quantity."""
    return next(e for e in found.equations if e.name == name)


def verdicts(found: Comparison) -> dict[str, Verdict]:
    """By name, where the text or the value is not the same."""
    return {e.name: e.verdict for e in found.equations if e.verdict is not Verdict.IDENTICAL}


def block(found: Comparison, name: str) -> Verdict:
    """Verdict of one block."""
    return next(b.verdict for b in found.blocks if b.name == name)
