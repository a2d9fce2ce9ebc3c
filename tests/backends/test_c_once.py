"""Routines that functions have alike in C stand once."""

from __future__ import annotations

from pne_sym.backends.c_once import Once
from pne_sym.backends.c_text import Routine

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
