"""What values of a program are called is what they are: each against its own equation."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
import sympy as sp

from pne_sym import manipulators
from pne_sym.backends.bundle import Bundle
from pne_sym.derivation import Law
from pne_sym.program.ir import Block, Program
from pne_sym.review.evaluation import Structure
from pne_sym.review.named import Statement, first_contradiction, statements
from tests.models import bundle, catalogue
from tests.random.drawing import draw
from tests.review.situations import situation
from tests.sampling import sampled

CHEAP = ("planar_3rpr", "fivebar_revolute", "tripod_3rps", "planar_4rpr_free", "delta", "stewart")
"""In the plane and in space, with constraints, extra coordinates, shared links, six legs."""


def said(of: Bundle, seed: int = 1) -> list[Statement]:
    at = situation(of, seed) or situation(of, seed, wide=False)
    assert at is not None
    return list(statements(Structure(of.derivation), of.program, at))


@pytest.mark.parametrize("name", sampled(manipulators.names(), 99, keep=CHEAP))
def test_every_name_tells_what_the_value_is(name: str) -> None:
    found = said(bundle(catalogue(name)))
    wrong = [s for s in found if not s.is_right]
    assert not wrong, wrong[:5]
    assert len({(s.function, s.name) for s in found}) > 100


@pytest.mark.only_in_all
def test_directions_are_known_before_the_angles_that_they_are_needed_for() -> None:
    """A leg RRPR whose second joint is an extra coordinate, its axes along none of the link's."""
    found = said(bundle(draw(1)))
    assert all(s.is_right for s in found)


@pytest.mark.parametrize("name", sampled(manipulators.names(), 99, keep=CHEAP[:2]))
def test_a_name_is_of_what_it_means_or_says_that_it_is_a_part(name: str) -> None:
    """And ids are those of the quantity; what has none is for the equation that it stands under."""
    of = bundle(catalogue(name))
    quantity = {e.id: e.name for e in of.derivation.equations()}
    defined = {e.name: e.id for e in of.derivation.equations()}
    for blocks, means in _scopes(of.program):
        for target, equation in _targets(blocks):
            first = means.get(target, ())[:1]
            if first and re.fullmatch(rf"(\w+_)?{first[0].name}(_\d+)?", target):
                assert equation == defined.get(first[0].quantity, equation), target
                continue
            part = rf"(\w+_)?({quantity[equation]}_t(_\d+)?|inv_\w+|least_\w+|pivot\w*)"
            assert re.fullmatch(part, target), (target, equation)


@pytest.mark.parametrize("name", sampled(manipulators.names(), 99, keep=["delta"]))
def test_a_constant_turned_needs_nothing_as_early_as_it_is_defined(name: str) -> None:
    """J_3 in axes of link 1 takes angles, and S before them: these keep their own names and ids."""
    of = bundle(catalogue(name))
    constant = {e.id for e in of.derivation.equations() if e.law is Law.LUMPING}
    for f in of.program.functions.values():
        for target, equation in _targets(f.blocks):
            first = f.means.get(target, ())[:1]
            assert equation not in constant or not first or first[0].name in target, target


def _scopes(program: Program) -> list[tuple[tuple[Block, ...], Any]]:
    return [
        (program.prepare, program.means),
        *((f.blocks, f.means) for f in program.functions.values()),
    ]


def _targets(blocks: tuple[Block, ...]) -> list[tuple[str, str]]:
    return [(str(a.target), a.equation) for b in blocks for a in (*b.assignments, *b.sums)]


def test_statements_follow_the_derivation() -> None:
    """In every block equations come in their order, but where one uses a later one's value."""
    of = bundle(catalogue("stewart"))
    order = {e.id: k for k, e in enumerate(of.derivation.equations())}
    for function in of.program.functions.values():
        for block in function.blocks:
            numbers = [order[a.equation] for a in block.assignments]
            assert numbers == sorted(numbers), function.name


def test_what_a_value_needs_first_names_it() -> None:
    """1/q_3 is needed long before it is a component of w_2; Q has its components."""
    f = bundle(catalogue("stewart")).program.functions["dynamics"]
    names = {str(a.target) for block in f.blocks for a in block.assignments}
    of_leg = {"Q_xx", "Q_xy", "Q_zz", "U_x", "S_dot_z"}
    assert {f"ups_{name}" for name in of_leg} | {"h_star_x", "inv_ups_q_3"} <= names


FAULTS: dict[str, Callable[[Any], Any]] = {
    "its sign": lambda expr: -expr,
    "a factor": lambda expr: 2 * expr,
    "the sign of a term": lambda expr: expr - 2 * expr.args[-1] if expr.is_Add else -expr,
}


@pytest.mark.parametrize("fault", sampled(FAULTS, 3))
def test_a_wrong_statement_is_found_where_it_stands(fault: str) -> None:
    """Every statement in turn: the first that contradicts is it, or the first that uses it."""
    right = bundle(catalogue("planar_3rpr"))
    at = situation(right, 3)
    assert at is not None
    f = right.program.functions["Z"]
    missed = []
    for k, block in enumerate(f.blocks):
        for n, a in enumerate(block.assignments):
            changed = replace(a, expr=FAULTS[fault](sp.sympify(a.expr)))
            own = (*block.assignments[:n], changed, *block.assignments[n + 1 :])
            blocks = (*f.blocks[:k], replace(block, assignments=own), *f.blocks[k + 1 :])
            functions = {"Z": replace(f, blocks=blocks)}
            program = replace(right.program, functions=functions)
            found = first_contradiction(right.derivation, program, [at])
            if found is None or (str(a.target) in f.means and found.name != str(a.target)):
                missed.append((str(a.target), found))
    assert not missed
