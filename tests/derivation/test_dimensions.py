"""Units that a derivation states are those of its right-hand sides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pne_sym import manipulators
from pne_sym.derivation import Derivation
from pne_sym.derivation.dimensions import wrong_dimensions
from pne_sym.mechanics.derive import derive
from tests.random.drawing import draw


@pytest.mark.parametrize("name", manipulators.names())
def test_of_the_catalogue(name: str) -> None:
    assert not list(wrong_dimensions(derive(manipulators.load(name))))


@pytest.mark.parametrize("seed", range(30))
def test_at_random(seed: int) -> None:
    assert not list(wrong_dimensions(derive(draw(seed))))


@pytest.fixture(scope="module")
def stewart() -> Derivation:
    return derive(manipulators.load("stewart"))


def test_every_stated_unit_matters(stewart: Derivation) -> None:
    """A wrong unit of any quantity that an equation uses or defines is found."""
    used = {e.name for e in stewart.equations()} | {n for e in stewart.equations() for n in e.uses}
    names = sorted(n for n in used if n in stewart.notation)
    rng = np.random.default_rng(0)
    for name in rng.choice(names, 40, replace=False):
        quantity = stewart.notation[name]
        wrong = replace(quantity, unit="kg^7" if quantity.unit in ("-", "rad") else "-")
        changed = replace(stewart, notation={**stewart.notation, name: wrong})
        assert list(wrong_dimensions(changed)), name


def test_scales_have_the_dimension_of_what_is_tested(stewart: Derivation) -> None:
    guarded = [
        (k, j, e, c)
        for k, chapter in enumerate(stewart.chapters)
        for j, e in enumerate(chapter.equations)
        for c in e.conditions
        if c.scale != 0
    ]
    assert guarded
    for k, j, equation, condition in guarded:
        wrong = replace(equation, conditions=(replace(condition, scale=condition.scale**3),))
        chapter = stewart.chapters[k]
        equations = (*chapter.equations[:j], wrong, *chapter.equations[j + 1 :])
        chapters = (*stewart.chapters[:k], replace(chapter, equations=equations))
        changed = replace(stewart, chapters=(*chapters, *stewart.chapters[k + 1 :]))
        assert list(wrong_dimensions(changed)), equation.id
