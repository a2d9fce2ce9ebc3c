"""Names are names: with others only these change, and nothing is read off them."""

from __future__ import annotations

import ast
import io
import random
import re
import tokenize
from typing import Any

import numpy as np
import pytest

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.emission import emit
from pne_sym.lowering.builder import Builder
from pne_sym.lowering.margins import OWN_NAMES
from pne_sym.lowering.meaning import Meaning
from pne_sym.lowering.program import lower
from pne_sym.model.manipulator import Manipulator
from pne_sym.program.count import count_function
from pne_sym.program.evaluate import prepare
from pne_sym.program.interpret import Interpreter
from tests import models
from tests.derivation.renaming import all_names, renamed
from tests.sampling import sampled

PREFIX = "zq_"
TARGETS = ("numpy", "c", "xp", "octave")
DRAWN = "planar_3rrr"
NAMES = (
    "planar_3rpr",
    "tripod_3rps",
    "stewart_sps",
    DRAWN,
    "fivebar_redundant",
    "tripod_3upu",
    "planar_mixed",
    "hexapod_6x6r",
    "spherical_3ups",
)
"""A plane, constraints, extra coordinates, iteration, redundancy, moments, leg types, a centre."""
CASES = sampled(NAMES, len(NAMES), keep=[DRAWN])
VALUES = ("M", "Z", "H", "inverse_kinematics", "inverse_dynamics")


def model(name: str) -> Manipulator:
    return models.drawn(name) if name == DRAWN else models.catalogue(name)


def prefixed(name: str) -> str:
    return PREFIX + name.replace(PREFIX, "")


def under_other_names(manipulator: Manipulator, names: Any) -> Bundle:
    derivation = renamed(models.bundle(manipulator).derivation, names)
    return Bundle(manipulator, derivation, lower(derivation))


@pytest.mark.parametrize("name", CASES)
def test_a_common_prefix_is_all_that_changes(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The lowering's own names get it too, so that the order is kept."""
    manipulator, stem = model(name), Builder._stem
    before = emit(models.bundle(manipulator), TARGETS)

    def renamed_stem(self: Builder, hint: str, stage: Any) -> str:
        made = stem(self, hint, stage)
        return made if hint in OWN_NAMES else prefixed(made)

    monkeypatch.setattr(Builder, "_stem", renamed_stem)
    told = Meaning.stem
    monkeypatch.setattr(Meaning, "stem", lambda *given: prefixed(told(*given)))
    after = emit(under_other_names(manipulator, prefixed), TARGETS)
    assert before.keys() == after.keys()
    for file, text in before.items():
        assert PREFIX not in text
        assert stripped(file, after[file].replace(PREFIX, "")) == stripped(file, text), file
    assert sum(text.count(PREFIX) for text in after.values()) > 500


def stripped(file: str, text: str) -> Any:
    """What a text says, wherever its lines are broken."""
    if file.endswith(".py"):
        comments = [
            t.string
            for t in tokenize.generate_tokens(io.StringIO(text).readline)
            if t.type == tokenize.COMMENT
        ]
        return [ast.dump(ast.parse(text)), " ".join(comments)]
    if file.endswith(".json"):
        return re.sub(r'"derivation": "\w+"', "", text)
    if file.endswith(".m"):  # lines are continued, names do not begin with an underscore
        text = re.sub(r"\btmp_", "_", text.replace(" ...", " "))
    return [w.rstrip("_") for w in re.findall(r"\w+|[^\w\s]", text)]


@pytest.mark.parametrize("name", CASES)
def test_with_shuffled_names_values_are_equal(name: str) -> None:
    manipulator = model(name)
    before = models.bundle(manipulator)
    old = all_names(before.derivation)
    numbers = random.Random(1).sample(range(100_000, 1_000_000), len(old))
    names = dict(zip(old, (f"n{k}_{'abc'[k % 3]}" for k in numbers), strict=True))
    after = under_other_names(manipulator, names.__getitem__)
    answers = [values(bundle) for bundle in (before, after)]
    for function, wanted in answers[0].items():
        for a, b in zip(wanted, answers[1][function], strict=True):
            assert np.isfinite(a).all(), function
            np.testing.assert_allclose(b, a, rtol=0, atol=1e-10 * np.abs(a).max(initial=1.0))
    totals = [
        sum(count_function(f, b.leg_counts).total for f in b.program.functions.values())
        for b in (before, after)
    ]
    assert totals[1] == pytest.approx(totals[0], rel=0.01)


def values(bundle: Bundle) -> dict[str, Any]:
    """What public functions give at states around home."""
    c, program, home = bundle.coordinates, bundle.program, bundle.manipulator.home
    prepared = prepare(program, bundle.derivation.parameters.values())
    run = Interpreter(program, prepared, home.q)
    rng = np.random.default_rng(0)
    given = {
        "X": np.array(home.X) + 2e-3 * rng.uniform(-1.0, 1.0, (4, len(home.X))),
        "V": rng.uniform(-1.0, 1.0, (4, c.sizes["NV"])),
        "A": rng.uniform(-1.0, 1.0, (4, c.sizes["NV"])),
    }
    found = {}
    for name in VALUES:
        read = {a.name: given[a.name] for a in run.functions[name].inputs if a.name in given}
        found[name] = run.call(name, **read).outputs
    return found
