"""Operations of public functions in C, and what public functions run side by side."""

from __future__ import annotations

from collections.abc import Sequence

from pne_sym.backends.bundle import Bundle
from pne_sym.program.public import Apply, Default, PublicFunction, Run

_COPY = "{a}[i]"
_CHANGED = ("divide_rows", "add_at", "clear_at", "add_forces", "wrap_turns", "unlimited")
"""Operations that change some entries of a copy."""
ENTRIES = {
    "add": "{a}[i] + {b}[i]",
    "subtract": "{a}[i] - {b}[i]",
    "negative": "-{a}[i]",
    "multiply": "{a}[i]*{b}[i]",
    "scale": "{a}[i]*{b}[i%({w})]",
    "inverse_root": "1/root({a}[i])",
    "scale_columns": "{a}[i]*{b}[i%({row})]",
    "choose_length": "{b}[i] > 0 ? {b}[i] : {a}[i] > TINY*{a}[{w} + i] ? {a}[i] : {a}[{w} + i]",
    "extend": "i < {all_a} ? {a}[i] : 0",
    "impossible": "R(NAN)",
    **dict.fromkeys(_CHANGED, _COPY),
}
"""Operations whose result is first, or altogether, an expression for every entry i."""
LANES = {
    "impossible": "check({size}, {w}, {x}, why.singular);",
    "divide_rows": "divide_rows({count}, {n}, {w}, {places}, {b}, {x});",
    "add_at": "add_at({count}, {row}, {places}, {b}, {x});",
    "clear_at": "clear_at({count}, {row}, {places}, {x});",
    "add_forces": "add_forces({count}, {n}, {w}, {places}, {b}, {c}, {x});",
    "wrap_turns": "wrap_turns({count}, {row}, {places}, {x});",
    "unlimited": "unlimited({count}, {size}, {w}, {places}, {x}, {doubt});",
    "not_negative": "not_negative({m}, {w}, {a}, {x}, {doubt});",
    "take": "take({count}, {row}, {places}, {a}, {x});",
    "take_columns": "take_columns({m}, {n}, {count}, {w}, {places}, {a}, {x});",
    "times": "product({m}, {n}, 1, {w}, {a}, {b}, {x});",
    "product": "product({m}, {n}, {p}, {w}, {a}, {b}, {x});",
    "transposed": "transpose({m}, {n}, {w}, {a}, {x});",
    "half_form": "half_form({m}, {w}, {a}, {b}, {x});",
    "dot": "inner({m}, {w}, {a}, {b}, {x});",
    "beside": "beside({m}, {row}, {row_b}, {a}, {b}, {x});",
    "join": "beside(1, {all_a}, {all_b}, {a}, {b}, {x});",
    "saddle": "saddle({m}, {p}, {stride}, {w}, {a}, {b}, {x});",
    "solve": "solve({m}, {w}, {b}, work, {x}, why.singular);",
}
"""Calls for states side by side."""
_POSES = (
    "rotation_of_quaternion", "quaternion_of_rotation", "angle_of_rotation", "rotation_of_angle",
    "quaternion_of_rpy",
)  # fmt: skip
_TURNS = ("quaternion_rate", "turn_quaternion", "turn_between")
SINGLE = {
    "solve": "solve_state({m}, {b}, work, {x}, why.singular);",
    "least_norm": "least_norm({m}, {n}, {a}, {b}, {x}, why.singular);",
    "resolve": "resolve({m}, {n}, {p}, {first}, {a}, {b}, {x}, {y}, why.singular);",
    "null_basis": "null_basis({m}, {n}, {first}, {a}, {x});",
    "singular_values": "singular_values({m}, {n}, {a}, {x});",
    "least_entry": "least_entry({m}, {a}, {x});",
    "spread": "spread({first}, {a}, {x}, {y});",
    "factors_within": "factors_within({m}, {a}, {b}, {c}, {x}, {y}, why.unreachable, "
    "why.overflow);",
    "factors_of_some": "factors_of_some({m}, {a}, {b}, {c}, {d}, {x}, {y}, why.unreachable, "
    "why.overflow);",
    "nearest_within": "nearest_within({m}, {a}, {b}, {c}, {d}, {x}, why.unreachable, "
    "why.overflow);",
    **{name: f"{name}({{a}}, {{x}});" for name in _POSES},
    **{name: f"{name}({{a}}, {{b}}, {{x}});" for name in _TURNS},
}
"""Calls for one state."""
_BIG = ("least_norm", "resolve", "null_basis", "singular_values")
_BOUNDED = ("nearest_within", "factors_of_some")
PARTS = ("same", "entry", "split", "take")
"""Operations whose results may be parts of the operand."""
OPERATIONS = frozenset((*ENTRIES, *LANES, *SINGLE, *PARTS, "search"))
WITHOUT = ("weights", "length")
"""Inputs that no C function takes; a function has a second form with weights that it reads."""
FILL = {Default.ZEROS: "0", Default.ONES: "1"}


def lanes_of(operation: str) -> bool:
    """Whether states side by side have the operation."""
    return operation in LANES or (operation not in SINGLE and operation != "search")


def results_of(function: PublicFunction) -> dict[str, str]:
    """Outputs that a function of the program gives as they are -> its name."""
    runs = [step for step in function.steps if isinstance(step, Run)]
    given = {t.name: run.function for run in runs for t in run.targets}
    return {o.name: given[o.name] for o in function.outputs if o.name in given}


def runs_in_lanes(function: PublicFunction) -> bool:
    """Whether a batch runs several states side by side: one run of the legs, and what can be.

    It is worth another body where the result is that of the run, or of a system solved with it;
    what is made of these results otherwise takes one state after another.
    """
    runs = [step for step in function.steps if isinstance(step, Run)]
    worth = results_of(function) or "solve" in function.operations
    possible = len(runs) == 1 and all(map(lanes_of, function.operations))
    return bool(function.is_exported and worth and possible)


def biggest(bundle: Bundle) -> int:
    """Most rows or columns of the matrices of which norms, ranks and singular values are taken."""
    program = bundle.program
    steps = [step for f in program.public for step in f.steps]
    shapes = [program.shapes[f"residual_{c.leg_type}"][1:] for c in program.closures]
    shapes += [s.operands[0].shape for s in steps if isinstance(s, Apply) and s.operation in _BIG]
    shapes += [f.outputs[0].value.shape for f in program.public if not f.is_exported]
    bounded = [s for s in steps if isinstance(s, Apply) and s.operation in _BOUNDED]
    shapes += [(s.operands[0].size + 1,) for s in bounded]  # a factor beside the forces
    return max(n for shape in shapes for n in shape)


def c_order(names: Sequence[str]) -> list[str]:
    """Inputs in the order of the C: a first guess stands after the pose."""
    rest = [name for name in names if name != "q0"]
    if "q0" in names:
        rest.insert(next((k for k, n in enumerate(rest, 1) if n in ("X", "X0")), 0), "q0")
    return rest
