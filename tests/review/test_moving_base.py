"""A base that moves beside one that is fixed: compared at rest; two that move, in motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import checked
from pne_sym.review.compare import compare
from pne_sym.review.diff_text import as_text
from pne_sym.review.difference import Comparison, Verdict
from tests.models import bundle, catalogue
from tests.review.versions import block, compiled, of, rewritten, version, with_rhs


def moving() -> Manipulator:
    return checked(replace(catalogue("planar_3rpr"), moving_base=True))


def spoilt(name: str, rhs: Callable[[Any], Any]) -> Any:
    """The model on a moving base with another equation."""
    changed = rewritten(bundle(moving()).derivation, {name: with_rhs(rhs)})
    return compiled(moving(), changed)


def note_of(found: Comparison, name: str) -> str:
    return next(b.note for b in found.blocks if b.name == name)


def test_beside_a_fixed_base() -> None:
    """What takes `base` is told, and that nothing else differs."""
    found = compare(version(catalogue("planar_3rpr")), version(moving()))
    assert not found.equal
    assert block(found, "Z") is Verdict.DIFFERENT
    assert note_of(found, "Z") == "only one takes base; without it they are the same"
    assert all(b.gap is None or b.gap.size < 1e-12 for b in found.blocks)
    assert block(found, "M") is Verdict.EQUAL
    shown = list(as_text(found))
    assert "  Z                 only one takes base; without it they are the same" in shown
    assert any(line.startswith("  functions that take base: Z, dynamics") for line in shown)
    assert any("compared with it at rest" in line for line in shown)
    assert not any(line.count(" = -g") > 1 for line in shown)  # sides of equal text are told once
    assert not [e for e in found.equations if e.verdict is Verdict.DIFFERENT]


def test_other_values_beside_a_fixed_base() -> None:
    found = compare(version(catalogue("planar_3rpr")), spoilt("m_star", lambda e: 2 * e))
    assert note_of(found, "Z") == "only one takes base; without it values differ too"
    assert of(found, "m_star").verdict is Verdict.DIFFERENT


def test_two_that_move() -> None:
    """What the motion of the base adds is compared too."""
    found = compare(version(moving()), spoilt("g_f", lambda e: 2 * e))
    assert of(found, "g_f").verdict is Verdict.DIFFERENT
    assert block(found, "Z") is Verdict.DIFFERENT
    assert block(found, "M") in (Verdict.EQUAL, Verdict.IDENTICAL)
