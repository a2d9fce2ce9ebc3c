"""The gate behind the lowering: whole programs pass, spoilt ones do not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
import sympy as sp

from pne_sym.program.ir import (
    Assignment,
    Block,
    Check,
    Function,
    LegInput,
    Program,
    Store,
)
from pne_sym.program.verify import ProgramError, verify
from tests.models import bundle, catalogue, parameter_names
from tests.sampling import SAMPLE


def real(name: str) -> Any:
    return sp.Symbol(name, real=True)


PARAMETERS = {"k": "leg", "g": ""}


def _store(array: str, value: Any, row: Any, column: Any = None) -> Store:
    return Store(array, value, row, column, "E1")


def program(**changes: Any) -> Program:
    """A small program with every feature; `changes` replace parts of its function."""
    f = Function(
        name="f",
        inputs=("X",),
        arrays=("M", "Z"),
        unpack=(Assignment(real("t"), real("X_0") * 2, "X"),),
        unpack_checks=(Check("invalid", real("t"), sp.S.One, 2, "X"),),
        blocks=(
            Block(
                "",
                (Assignment(real("u"), real("t") + real("g2"), "P1"),),
                stores=(_store("Z", real("u"), 0),),
            ),
            Block(
                "leg",
                (Assignment(real("v"), sp.sqrt(real("u")) * real("k2") / real("y"), "L1"),),
                checks=(Check("singular", real("v"), real("k2"), 1, "L1"),),
                sums=(Assignment(real("w"), real("v"), "E1"),),
                stores=(_store("M", -real("v"), (0, 1), 1),),
            ),
            Block(
                "",
                (Assignment(real("z"), real("w") ** 2, "E1"),),
                stores=(_store("M", real("z"), 0, 0), _store("Z", real("u"), 1)),
            ),
        ),
        leg_inputs={"leg": (LegInput(real("y"), "X", (1, 2)),)},
        shared=("g2",),
        per_leg={"leg": ("k2",)},
    )
    prepare = (
        Block("", (Assignment(real("g2"), real("g") ** 2, "G1"),)),
        Block("leg", (Assignment(real("k2"), real("k") ** 2, "G2"),)),
    )
    whole = {key: changes.pop(key) for key in ("prepare", "prepared") if key in changes}
    base = Program(
        prepare, (("g2", ""), ("k2", "leg")), {"f": replace(f, **changes)}, {"M": (2, 2), "Z": (2,)}
    )
    return replace(base, **whole)


def blocks(spoil: Callable[[list[Block]], None]) -> Program:
    """The program with its blocks changed in place."""
    made = list(program().functions["f"].blocks)
    spoil(made)
    return program(blocks=tuple(made))


def with_first(expr: Any, equation: str = "P1") -> Program:
    """The program with another first statement."""
    first = program().functions["f"].blocks[0]
    changed = replace(first, assignments=(Assignment(real("u"), expr, equation),))
    return blocks(lambda b: b.__setitem__(0, changed))


def with_leg(**changes: Any) -> Program:
    """The program with another leg block."""
    return blocks(lambda b: b.__setitem__(1, replace(b[1], **changes)))


def test_a_right_program_passes() -> None:
    verify(program(), PARAMETERS)


@pytest.mark.parametrize("name", SAMPLE)
def test_lowered_programs_pass(name: str) -> None:
    manipulator = catalogue(name)
    verify(bundle(manipulator).program, parameter_names(manipulator))


SPOILT: dict[str, tuple[Callable[[], Program], str]] = {
    "assigned twice": (
        lambda: with_leg(assignments=(Assignment(real("u"), real("t"), "L1"),)),
        "u is assigned twice",
    ),
    "a prepared value assigned": (
        lambda: with_leg(assignments=(Assignment(real("g2"), real("t"), "L1"),)),
        "assigned twice",
    ),
    "an input assigned": (
        lambda: with_leg(assignments=(Assignment(real("y"), real("t"), "L1"),)),
        "assigned twice",
    ),
    "a sum assigned": (
        lambda: with_leg(sums=(Assignment(real("u"), real("v"), "E1"),)),
        "u is assigned twice",
    ),
    "used before": (lambda: blocks(lambda b: b.reverse()), "w is not defined before"),
    "used within its own statement": (lambda: with_first(real("u") + 1), "u is not defined before"),
    "unknown name": (lambda: with_first(real("nobody")), "f: u = nobody: nobody is not defined"),
    "an input entry behind the unpacking": (
        lambda: with_first(real("X_0")),
        "X_0 is not defined before",
    ),
    "a leg's value outside its loop": (
        lambda: blocks(
            lambda b: b.__setitem__(2, Block("", (Assignment(real("z"), real("v"), "E1"),)))
        ),
        "v is not defined before",
    ),
    "a leg's prepared value outside its loop": (
        lambda: with_first(real("k2")),
        "k2 is not defined before",
    ),
    "a sum within the loop": (
        lambda: with_leg(assignments=(Assignment(real("v"), real("w"), "L1"),)),
        "w is not defined before",
    ),
    "another leg type's value": (
        lambda: blocks(
            lambda b: b.insert(2, Block("arm", (Assignment(real("a"), real("v"), "A1"),)))
        ),
        "v is not defined before",
    ),
    "a value from another vector": (
        lambda: program(unpack=(Assignment(real("t"), real("V_0"), "X"),)),
        "V_0 is not defined",
    ),
    "an unknown input vector": (lambda: program(inputs=("X", "Q")), "inputs are"),
    "a leg input of an absent vector": (
        lambda: program(leg_inputs={"leg": (LegInput(real("y"), "V", (1, 2)),)}),
        "y is no input",
    ),
    "no equation id": (lambda: with_first(real("t"), ""), "u = t: no equation id"),
    "no equation id of a check": (
        lambda: with_leg(checks=(Check("singular", real("v"), real("k2"), 1, ""),)),
        "check of v: no equation id",
    ),
    "an unknown status": (
        lambda: with_leg(checks=(Check("odd", real("v"), real("k2"), 1, "L1"),)),
        "status odd",
    ),
    "a check's power": (
        lambda: with_leg(checks=(Check("singular", real("v"), real("k2"), 3, "L1"),)),
        "power 3",
    ),
    "a check of an unknown value": (
        lambda: with_leg(checks=(Check("singular", real("q"), real("k2"), 1, "L1"),)),
        "q is not",
    ),
    "a check by an unknown scale": (
        lambda: with_leg(checks=(Check("singular", real("v"), real("q"), 1, "L1"),)),
        "q is not",
    ),
    "a fractional power": (
        lambda: with_first(real("t") ** sp.Rational(1, 3)),
        "outside the closed set",
    ),
    "a symbolic power": (lambda: with_first(real("t") ** real("g2")), "outside the closed set"),
    "an exponential": (lambda: with_first(sp.exp(real("t"))), "outside the closed set"),
    "a sign": (lambda: with_first(sp.sign(real("t"))), "outside the closed set"),
    "a piecewise function": (
        lambda: with_first(sp.Piecewise((real("t"), real("t") > 0), (0, True))),
        "closed set",
    ),
    "infinity": (lambda: with_first(sp.oo), "outside the closed set"),
    "not a number": (lambda: with_first(sp.nan), "outside the closed set"),
    "a constant that is no number": (lambda: with_first(sp.pi * real("t")), "closed set"),
    "a symbol of the same name": (lambda: with_first(sp.Symbol("t")), "t is not real"),
    "a target of other assumptions": (
        lambda: program(unpack=(Assignment(sp.Symbol("t"), real("X_0"), "X"),)),
        "not a real symbol",
    ),
    "a target that is no symbol": (
        lambda: program(unpack=(Assignment(-real("t"), real("X_0"), "X"),)),
        "not a real symbol",
    ),
    "an output written twice": (
        lambda: with_leg(stores=(_store("M", real("v"), (0, 0), 1),)),
        r"M\[0, 1\] is written twice",
    ),
    "an output written in two blocks": (
        lambda: with_leg(stores=(_store("M", real("v"), (0, 1), 0),)),
        r"M\[0, 0\] is written twice",
    ),
    "an output outside its shape": (
        lambda: with_leg(stores=(_store("M", real("v"), (0, 2), 1),)),
        "outside the shape",
    ),
    "an output at a negative place": (
        lambda: with_leg(stores=(_store("M", real("v"), (0, -1), 1),)),
        "outside the shape",
    ),
    "a vector with a column": (
        lambda: with_leg(stores=(_store("Z", real("v"), 1, 1),)),
        "outside the shape",
    ),
    "an output of another function": (
        lambda: with_leg(stores=(_store("H", real("v"), 0, 1),)),
        "H is not an output",
    ),
    "an output of an unknown value": (
        lambda: with_leg(stores=(_store("M", real("q"), 0, 1),)),
        "q is not defined",
    ),
    "uneven tables": (
        lambda: with_leg(stores=(_store("M", real("v"), (0, 1), (1, 1, 1)),)),
        "uneven",
    ),
    "a sum over no legs": (
        lambda: blocks(
            lambda b: b.__setitem__(
                0, replace(b[0], sums=(Assignment(real("w"), real("t"), "E1"),))
            )
        ),
        "a sum over no legs",
    ),
    "a sum of an unknown value": (
        lambda: with_leg(sums=(Assignment(real("w"), real("q"), "E1"),)),
        "sum w: q is not defined",
    ),
    "two loops over a leg type": (lambda: blocks(lambda b: b.append(b[1])), "two loops over 'leg'"),
    "a value that is not prepared": (
        lambda: program(shared=("g2", "g3")),
        "g3 is not a prepared value",
    ),
    "a leg's value taken for a shared one": (
        lambda: program(shared=("g2", "k2"), per_leg={}),
        "k2 is not a prepared value",
    ),
    "a prepared value that nothing computes": (
        lambda: program(prepared=(("g2", ""), ("k2", "leg"), ("k3", "leg"))),
        "k3 is not defined",
    ),
    "a value prepared twice": (
        lambda: program(prepared=(("g2", ""), ("k2", "leg"), ("k2", "leg"))),
        "prepared twice",
    ),
    "a preparation from the state": (
        lambda: program(prepare=(Block("", (Assignment(real("g2"), real("X_0"), "G1"),)),)),
        "prepare: .*X_0 is not defined",
    ),
    "a shared value prepared from a leg's": (
        lambda: program(prepare=(Block("", (Assignment(real("g2"), real("k"), "G1"),)),)),
        "prepare: .*k is not defined",
    ),
    "a function under another name": (lambda: program(name="g"), "calls itself 'g'"),
}


@pytest.mark.parametrize("fault", SPOILT)
def test_a_spoilt_program_is_refused(fault: str) -> None:
    make, message = SPOILT[fault]
    with pytest.raises(ProgramError, match=message):
        verify(make(), PARAMETERS)


@pytest.mark.parametrize("kind", ["drop", "repeat", "swap", "rename"])
def test_a_spoilt_real_program_is_refused(kind: str) -> None:
    """Every statement of a lowered function in turn: dropped, repeated, moved, renamed."""
    manipulator = catalogue("fivebar_prismatic")
    whole, names = bundle(manipulator).program, parameter_names(manipulator)
    function = whole.functions["dynamics"]
    tried = 0
    for number, block in enumerate(function.blocks):
        for k, statement in enumerate(block.assignments):
            changed = list(block.assignments)
            if kind == "drop":
                del changed[k]
            elif kind == "repeat":
                changed.append(statement)
            elif kind == "swap":
                users = [
                    i for i, a in enumerate(changed) if statement.target in a.expr.free_symbols
                ]
                if not users:
                    continue
                changed.insert(users[0], changed.pop(k))  # behind its first user
            else:
                changed[k] = replace(statement, target=real(statement.target.name + "_x"))
            others = list(function.blocks)
            others[number] = replace(block, assignments=tuple(changed))
            spoilt = replace(function, blocks=tuple(others))
            with pytest.raises(ProgramError):
                verify(replace(whole, functions={"dynamics": spoilt}), names)
            tried += 1
    assert tried > 20
