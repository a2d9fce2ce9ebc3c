"""Functions that begin with all that another one does call it in C."""

from __future__ import annotations

from dataclasses import replace

from pne_sym.backends.c_repeated import repeated
from pne_sym.program.public import Apply, Value
from tests.models import bundle, catalogue


def test_leg_reactions_begin_with_inverse_dynamics() -> None:
    program = bundle(catalogue("tripod_3rps")).program
    named = {f.name: f for f in program.public}
    reactions, inverse = named["leg_reactions"], named["inverse_dynamics"]
    split = next(s for s in reactions.steps if isinstance(s, Apply) and s.operation == "split")
    found = dict(zip([o.label for o in inverse.outputs], split.targets, strict=True))
    assert dict(repeated(program, reactions, inverse)) == found
    assert not repeated(program, inverse, reactions)
    assert not repeated(program, inverse, inverse)


def test_what_reads_more_than_the_results_does_all_itself() -> None:
    program = bundle(catalogue("tripod_3rps")).program
    named = {f.name: f for f in program.public}
    reactions, inverse = named["leg_reactions"], named["inverse_dynamics"]
    *rest, last = reactions.steps
    assert isinstance(last, Apply)
    also = replace(last, operands=(*last.operands, Value("H", (3, 3))))
    assert not repeated(program, replace(reactions, steps=(*rest, also)), inverse)
    other = replace(inverse, steps=(*inverse.steps[1:],))
    assert not repeated(program, reactions, other)
    without = replace(reactions, inputs=reactions.inputs[:-1])
    assert not repeated(program, without, inverse)
