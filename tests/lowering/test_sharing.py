"""What functions of a model have in common is the same text in each."""

from __future__ import annotations

import pytest

from tests.models import bundle, catalogue


@pytest.mark.parametrize("name", ["fivebar_revolute", "tripod_3rps", "planar_mixed"])
def test_a_value_has_one_name_and_one_statement_in_all_functions(name: str) -> None:
    """So back ends can print it once; names of values that differ never meet."""
    program = bundle(catalogue(name)).program
    known: dict[str, tuple[object, str, str]] = {}
    shared = 0
    for function in program.functions.values():
        for block in function.blocks:
            for a in block.assignments:
                own = (a.expr, a.equation, block.leg_type)
                shared += a.target.name in known
                assert known.setdefault(a.target.name, own) == own, (function.name, a.target)
    assert shared > len(known) / 2
