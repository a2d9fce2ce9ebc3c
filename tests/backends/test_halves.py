"""What precedes the legs in C: what they wait for, and what can follow them."""

import pytest
import sympy as sp

from pne_sym.backends.c_backend import _run
from pne_sym.backends.c_halves import _closure
from pne_sym.backends.c_parts import Parts
from pne_sym.backends.c_stages import Stages
from pne_sym.program.ir import Assignment
from tests.models import bundle, catalogue


@pytest.mark.parametrize("name", ["stewart", "planar_3rpr", "tripod_3rps"])
def test_each_value_is_in_one_half(name: str) -> None:
    """What the legs read in the first, which is before them."""
    compiled = bundle(catalogue(name))
    run = _run(compiled)
    stages = Stages(run.values())
    for function in run.values():
        parts = Parts(compiled, function, stages, summed=False)
        early, late = parts.early, parts.late
        used = stages.used(function.name, "")
        assert [s for s in used if s in early.stages or s in late.stages] == used
        assert not {s.name for s in early.stages} & {s.name for s in late.stages}
        assert not set(early.stored) & set(late.stored)
        stored = stages.stored(function.name) & set(stages.passed(function.name))
        assert {*early.stored, *late.stored} == stored
        assert not stages.read_by_legs(function.name) & set(late.stored)
        local = [{a.target.name for a in half.own} for half in (early, late)]
        read = [{s.name for a in half.own for s in a.expr.free_symbols} for half in (early, late)]
        assert not read[0] & (local[1] | {n for s in late.stages for n in s.exported})
        assert not read[1] & local[0]  # a local value of the other routine


def test_what_only_the_sums_meet_stands_behind_the_legs() -> None:
    compiled = bundle(catalogue("stewart"))
    run = _run(compiled)
    dynamics = Parts(compiled, run["dynamics"], Stages(run.values()), summed=True)
    before, between = ("\n".join(r.body) for r in (dynamics.before(), dynamics.between()))
    assert "stage_X(" in before
    assert "stage_Z_dynamics(" in between


def test_statements_that_share_a_local_value_stay_together() -> None:
    """y needs x, and z reads x, which is a local value of the first half; w needs neither."""
    texts = {"x": "V_0 + 1", "y": "2*x", "z": "3*x", "w": "V_1"}
    own = [Assignment(sp.Symbol(n), sp.parse_expr(text), "") for n, text in texts.items()]
    first, _ = _closure({"y"}, own, [], Stages([]))
    assert [a.target.name for a in first] == ["x", "y", "z"]


def test_what_reads_the_most_is_the_first_of_what_two_functions_share() -> None:
    """So fewer values wait while the rest is computed: Z, which reads velocities, before M."""
    run = _run(bundle(catalogue("stewart")))
    used = [s.name for s in Stages(run.values()).used("dynamics", "ups")]
    assert used == [f"stage_ups_{n}" for n in ("X", "V_X", "Z_dynamics", "M_dynamics")]
