"""Routines that functions have alike in C stand once."""

from __future__ import annotations

from pne_sym.backends.c_after import After
from pne_sym.backends.c_backend import _run
from pne_sym.backends.c_leg_parts import LegParts
from pne_sym.backends.c_once import Once
from pne_sym.backends.c_parts import Parts
from pne_sym.backends.c_stages import Stages
from pne_sym.backends.c_statements import Titles
from pne_sym.backends.c_text import Routine
from pne_sym.program.slices import slices
from tests.models import bundle, catalogue

A = Routine("A_end", ("real *x",), ("x[0] = 1;",))
B = Routine("B_end", ("real *x",), ("x[0] = 1;",))
OTHER = Routine("C_end", ("real *x",), ("x[0] = 2;",))
AGAIN = Routine("D_end", ("real *x",), ("x[0] = 2;",))
ALONE = Routine("E_end", ("real *y",), ("y[0] = 1;",))
EMPTY = Routine("F_end", (), ())


def test_what_is_alike_is_one_routine_and_has_one_text() -> None:
    once = Once(("end", r) for r in (A, B, OTHER, AGAIN, ALONE, EMPTY, EMPTY))
    assert once.of(A) is once.of(B)
    assert [once.of(r).name for r in (B, AGAIN)] == ["end", "end_2"]
    assert once.of(B).call() == "end(x);"
    assert [t.splitlines()[0] for t in once.texts()] == [
        "INLINE void end(real *x)",
        "INLINE void end_2(real *x)",
    ]
    assert once.own(A) == once.own(EMPTY) == []


def test_what_is_alone_keeps_its_name() -> None:
    once = Once(("end", r) for r in (A, OTHER, ALONE))
    assert once.of(ALONE) is ALONE
    assert not once.texts()
    assert once.own(ALONE) == [*ALONE.definition(), ""]


def test_what_functions_give_alike_is_one_routine_wherever_it_stands() -> None:
    """Sums of Z stand behind those of M in dynamics, and first in Z; entries of H are in three."""
    compiled = bundle(catalogue("planar_3rpr"))
    run = _run(compiled)
    stages = Stages(run.values())
    legs = {
        n: LegParts(Parts(compiled, run[n], stages, summed=True), slices(run[n]).legs[0])
        for n in ("dynamics", "Z", "H", "required")
    }
    pieces = {n: list(own.pieces()) for n, own in legs.items()}
    found = [r for own in pieces.values() for p in own if (r := p.routine)]
    once = Once((r.name.partition("_")[2], r) for r in found)
    calls = {n: [line for p in own for _, lines in p.printed(once) for line in lines]
             for n, own in pieces.items()}  # fmt: skip
    assert "sums_rpr(k, count, add, &v, terms);" in calls["Z"]
    assert "sums_rpr(k, count, add, &v, terms + 6*count);" in calls["dynamics"]
    assert all("entries_rpr(k, count, &v, o);" in calls[n] for n in ("dynamics", "H", "required"))


def test_what_follows_the_sums_over_the_legs_is_one_routine_too() -> None:
    """Dynamics calls what M and Z do with their sums; those of Z stand behind those of M there."""
    compiled = bundle(catalogue("planar_3rpr"))
    run = _run(compiled)
    stages = Stages(run.values())
    after = {n: After(Parts(compiled, run[n], stages, summed=True)) for n in ("dynamics", "M", "Z")}
    once = Once(("after", p.routine) for own in after.values() for p in own.pieces)
    of_m, of_z = (f.definition()[0].split("(")[0].split()[-1] for f in once.shared.values())
    lines = {n: own.routine(once).body for n, own in after.items()}
    assert [line.split("(")[0] for line in lines["dynamics"]] == [of_m, of_z]
    assert [line.split("(")[0] for n in "MZ" for line in lines[n]] == [of_m, of_z]
    assert "sums + 6*w" in lines["dynamics"][1]
    assert "sums, Z" in lines["Z"][0]


def test_an_equation_is_told_by_its_title_where_the_file_names_it_first() -> None:
    """Under its id alone everywhere else; what names inputs is no equation."""
    text = "/* (X) */\n    /* (M_tt) */\nM\n/* (M_tt) */"
    told = Titles(bundle(catalogue("planar_3rpr"))).told(text).split("\n")
    assert told[0] == "/* X: named entries */"
    assert told[1].startswith("    /* (M_tt) translational block of M")
    assert told[2:] == ["M", "/* (M_tt) */"]
