"""Actuators anywhere in a leg, in any number: which rows give the forces, which A has forces.

K = [H Hk].  Full rank: every acceleration has forces.  Less: passive extra coordinates move as they
must.  Each case is written by hand; the numbers are drawn.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from pne_sym.backends.describe import describe
from pne_sym.mechanics.actuation import actuation
from pne_sym.model.manipulator import Joint, Manipulator
from pne_sym.model.reader import checked
from tests.backends.c_agreement import assert_agree, vectors
from tests.backends.c_library import OK, QUICK, SINGULAR, WARNINGS, CLibrary
from tests.models import bundle, module
from tests.oracle.mechanisms import mechanism
from tests.oracle.specs import State, random_state
from tests.random.invariants import Invariants
from tests.sampling import sampled

TOLERANCE = 1e-9
ARM = "Rz* Ry* Ry | S"
SPIN = "Rz0 Ry0 Rx+ Px* | S"


class Case(NamedTuple):
    """Legs, and what is known of [H Hk]: rows, columns, rank."""

    space: str
    legs: list[str]
    shape: tuple[int, int, int]
    coupled: bool = True
    held: bool = True
    plain: bool = False


CASES = {
    "an extra joint held by a surplus actuator": Case(
        "spatial", ["Rz* Ry* Ry* Ry+ | S", ARM, ARM], (7, 7, 7), plain=True
    ),
    "spins that nothing acts on": Case(
        "spatial", [SPIN] * 6, (12, 6, 6), coupled=False, plain=True
    ),
    "spins that nothing acts on, redundant": Case(
        "spatial", ["Rz* Ry0* Px* | S", *["Rz* Ry0* Px | S"] * 2, SPIN], (7, 8, 6),
        coupled=False, plain=True,
    ),
    "planar, held": Case("planar", ["Rz* Rz* Rz+ | R", "Rz* Px* | R"], (4, 4, 4)),
    "planar, held, more actuators": Case(
        "planar", ["Rz* Rz* Rz+ | R", "Rz* Px* | R", "Rz* Px | R"], (4, 5, 4)
    ),
    "two extra joints of a leg, one surplus actuator": Case(
        "planar", ["Rz* Rz* Rz+ Rz+ | R", "Rz* Px* | R"], (5, 4, 4)
    ),
    "three extra joints, one surplus actuator and two": Case(
        "planar", ["Rz* Rz* Rz+ Rz+ | R", "Rz* Px* Rz+ | R"], (6, 4, 4)
    ),
    "extra joints of two legs, one surplus actuator": Case(
        "planar", ["Rz* Rz+ Rz* | R", "Rz* Rz+ Px | R", "Rz* Px | R"], (5, 4, 4)
    ),
    "an extra joint held, another out of reach, and an actuator to spare": Case(
        "planar", ["Rz* Rz* Rz+ | R", "Rz* Px* | R", "Rz* Px | R", "Rz Px Rz+ | R"], (5, 5, 4)
    ),
    "actuators that act on an extra joint, as many as other rows": Case(
        "planar", ["Rz* Rz Rz+ | R", "Rz* Px* | R"], (4, 3, 3)
    ),
    "the constraint holds the extra joint": Case(
        "planar", ["Rz+ Rz* | R", "Rz* Px* | R"], (4, 4, 4)
    ),
    "the constraint acts on the extra joint": Case(
        "planar", ["Rz+ Rz* | R", "Rz* Px | R"], (4, 3, 3)
    ),
    "constrained, two extra joints, one surplus actuator": Case(
        "planar", ["Rz* | R", "Rz* Rz* Rz+ Rz+ | R"], (5, 4, 4)
    ),
    "constrained, an extra joint held, another out of reach, and an actuator to spare": Case(
        "planar", ["Rz* | R", "Rz* Rz* Rz+ | R", "Rz* Px | R", "Rz Px Rz+ | R"], (5, 5, 4)
    ),
    "too few": Case("planar", ["Rz* Rz Rz+ | R", "Rz* Px | R"], (4, 2, 2), held=False),
    "constrained, too few": Case(
        "planar", ["Rz* | R", "Rz Rz Rz+ | R"], (4, 2, 2), coupled=False, held=False
    ),
    "as many as rows, in the wrong places": Case(
        "spatial", ["Rz* Ry0* Px* | S"] * 2 + ["Rz Ry0 Px | S"], (6, 6, 5),
        coupled=False, held=False, plain=True,
    ),
    "in the wrong places, beside an extra joint": Case(
        "spatial", ["Rz* Ry0* Px* | S"] * 2 + ["Rz Ry0 Px Rx+ | S"], (7, 6, 5),
        coupled=False, held=False, plain=True,
    ),
}  # fmt: skip

RUN = ("planar, held", "constrained, two extra joints, one surplus actuator", "too few")
"""In every run."""


@cache
def spec(name: str) -> Manipulator:
    """The mechanism of a case, with drawn numbers."""
    case = CASES[name]
    # What is drawn must be regular: with all joints actuated that are not extra.
    actuated = [
        " ".join(j if "*" in j or "+" in j or len(j) < 2 else j + "*" for j in leg.split())
        for leg in case.legs
    ]
    ends = [leg.rpartition("|")[2] for leg in case.legs]
    regular = [f"{one.partition('|')[0]}|{end}" for one, end in zip(actuated, ends, strict=True)]
    drawn = mechanism(case.space, regular, np.random.default_rng(4), plain=case.plain)
    legs = tuple(
        replace(
            leg,
            joints=tuple(
                _marked(j, code)
                for j, code in zip(leg.joints, codes.split()[: len(leg.joints)], strict=True)
            ),
        )
        for leg, codes in zip(drawn.legs, case.legs, strict=True)
    )
    return checked(replace(drawn, legs=legs, name="drawn", title=name))


def _marked(joint: Joint, code: str) -> Joint:
    return replace(joint, actuated="*" in code)


def states(name: str) -> list[State]:
    rng = np.random.default_rng(7)
    return [random_state(spec(name), rng, 0.3) for _ in range(2)]


@pytest.mark.parametrize("name", sampled(CASES, 0, keep=RUN))
def test_generic_rank(name: str) -> None:
    case, found = CASES[name], actuation(spec(name))
    sizes = module(spec(name))
    rows, columns, rank = case.shape
    assert (sizes.NV, sizes.NU + sizes.NC, found.rank) == (rows, columns, rank)
    assert (found.is_coupled, found.is_determined) == (case.coupled, case.held)


@pytest.mark.parametrize("name", sampled(CASES, 0, keep=RUN))
def test_forces_and_accelerations(name: str) -> None:
    model, errors = module(spec(name)), dict[str, float]()

    def note(what: str, error: float) -> None:
        errors[what] = max(errors.get(what, 0.0), np.inf if np.isnan(error) else error)

    for state in states(name):
        guess = {} if bundle_is_closed(name) else {"q0": state.q}
        rng = np.random.default_rng(1)
        Invariants(spec(name), model, state, rng, guess).check(note)
    wrong = {what: error for what, error in errors.items() if not error < TOLERANCE}
    assert not wrong
    assert ("forward of inverse" in errors) == CASES[name].held


def bundle_is_closed(name: str) -> bool:
    return not describe(bundle(spec(name))).is_numeric


@pytest.mark.parametrize("name", sampled(CASES, 0, keep=RUN))
def test_c_agrees(name: str, tmp_path: Path) -> None:
    model = module(spec(name))
    library = CLibrary(bundle(spec(name)), tmp_path, flags=(*QUICK, *WARNINGS))
    given = vectors(
        model, np.array(spec(name).home.X), np.array(spec(name).home.q), 11,
        np.random.default_rng(1),
    )  # fmt: skip
    if not CASES[name].held:
        for function in ("inverse_dynamics", "leg_reactions", "complete_acceleration"):
            inputs = [given[i.name] for i in library.api[function].inputs]
            outputs, status = library.batch(function, *inputs)
            idle = (
                function == "complete_acceleration"
                and not bundle(spec(name)).coordinates.actuation.passive
            )
            assert (status == (OK if idle else SINGULAR)).all()
            assert idle or all(np.isnan(output).all() for output in outputs)
            del library.api[function]
    assert assert_agree(library, model, given) >= 10
