"""Proves of models that every named value is what its name says: `make named`.

python -m tests.tools.named [--random COUNT] [--seed SEED] [MODEL ...]

Each model is evaluated at random parameters and states; every value that bears the name of a
quantity's component, every sum over legs and every stored entry is compared with the equation of
that quantity, evaluated on its own (`pne_sym/review/named.py`).
"""

from __future__ import annotations

import argparse
import sys
import warnings
from collections.abc import Iterable, Iterator

from pne_sym import manipulators
from pne_sym.backends.bundle import Bundle
from pne_sym.lowering.program import lower
from pne_sym.mechanics.derive import derive
from pne_sym.model.errors import SpecError
from pne_sym.model.manipulator import Manipulator
from pne_sym.review.evaluation import Structure
from pne_sym.review.named import Statement, statements
from tests.models import catalogue
from tests.random.drawing import draw
from tests.review.situations import situation

STATES = 2


def said(of: Bundle, states: int = STATES) -> list[Statement]:
    """What all statements say at some states; nothing where no state was found."""
    drawn = [situation(of, k) or situation(of, k, wide=False) for k in range(states)]
    structure = Structure(of.derivation)
    return [s for at in drawn if at for s in statements(structure, of.program, at)]


def models(names: Iterable[str], count: int, seed: int) -> Iterator[tuple[str, Manipulator]]:
    """Entries of the catalogue, and mechanisms drawn at random."""
    for name in names:
        yield name, catalogue(name)
    for k in range(seed, seed + count):
        yield f"random {k}", draw(k)


def main(arguments: list[str]) -> int:
    """Run; 1 if a statement contradicts its derivation."""
    parser = argparse.ArgumentParser(description="Named values against their own equations.")
    parser.add_argument("models", nargs="*", default=None, help="of the catalogue; else all")
    parser.add_argument("--random", type=int, default=0, help="mechanisms drawn at random")
    parser.add_argument("--seed", type=int, default=0, help="the first; the others follow")
    given = parser.parse_args(arguments)
    warnings.simplefilter("ignore")
    total, wrong, refused, stateless = 0, 0, 0, 0
    for label, manipulator in models(
        given.models or manipulators.names(), given.random, given.seed
    ):
        try:
            derivation = derive(manipulator)
        except SpecError:
            refused += 1
            continue
        of = Bundle(manipulator, derivation, lower(derivation))
        found = said(of)
        stateless += not found
        proven = len({(s.function, s.name) for s in found if "[" not in s.name})
        stored = len({(s.function, s.name) for s in found if "[" in s.name})
        bad = [s for s in found if not s.is_right]
        total, wrong = total + proven, wrong + bool(bad)
        print(f"{label}: {proven} named values, {stored} stored entries", flush=True)
        if bad:
            print(f"  CONTRADICTED first by {bad[0]}", flush=True)
    print(f"{total} named values in all; {refused} mechanisms refused, {stateless} without a state")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
