"""Operations as NumPy modules have them, against their definitions, state by state."""

from __future__ import annotations

import math
from itertools import compress
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pne_sym.backends.numpy_backend import NumpyBackend
from pne_sym.backends.numpy_public import Steps
from pne_sym.backends.numpy_support import needed, support
from pne_sym.program.ir import Program
from pne_sym.program.operations import OPERATIONS
from pne_sym.program.public import Apply, Value

Shape = tuple[int, ...]
STEPS = Steps(SimpleNamespace(program=Program((), ())))
CASES: dict[str, list[tuple[tuple[Shape, ...], tuple[int, ...]]]] = {
    "add": [(((4,), (4,)), ())],
    "subtract": [(((4,), (4,)), ())],
    "same": [(((4,),), ())],
    "impossible": [(((4,),), (3,))],
    "entry": [(((4,),), (2,))],
    "negative": [(((4,),), ())],
    "times": [(((3, 4), (4,)), ())],
    "product": [(((3, 4), (4, 2)), ())],
    "transposed": [(((3, 4),), ())],
    "half_form": [(((4,), (4, 4)), ())],
    "scale_columns": [(((3, 4), (4,)), ())],
    "divide_rows": [(((3, 4), ()), (0, 2))],
    "choose_length": [(((2,), ()), ())],
    "multiply": [(((4,), (4,)), ())],
    "dot": [(((4,), (4,)), ())],
    "scale": [(((4,), ()), ())],
    "inverse_root": [(((4,),), ())],
    "extend": [(((4,),), (6,)), (((4,),), (4,))],
    "take": [(((5,),), (1, 2, 3)), (((5,),), (4, 0)), (((5, 2),), (1,)), (((5,),), ())],
    "take_columns": [(((3, 5),), (1, 2)), (((3, 5),), (4, 0))],
    "add_at": [(((5,), (2,)), (1, 3))],
    "clear_at": [(((5,),), (0, 4))],
    "beside": [(((3, 2), (3, 1)), ())],
    "join": [(((3,), (2,)), ())],
    "split": [(((5,),), (3,))],
    "add_forces": [(((4, 3), (3,), (3, 3)), (1, 0, 1))],
    "wrap_turns": [(((4,),), (0, 3))],
    "unlimited": [(((4,),), (0, 3))],
    "not_negative": [(((4,),), ()), (((1,),), ())],
    "least_entry": [(((4,),), ()), (((1,),), ())],
    "spread": [(((4,),), (3,)), (((2,),), (1,))],
    "factors_within": [(((4,), (4,), (4,)), ()), (((1,), (1,), (1,)), ())],
    "factors_of_some": [(((5,), (5,), (5, 5), (5,)), ()), (((1,), (1,), (1, 1), (1,)), ())],
    "nearest_within": [(((6,), (6, 6), (6,), (6,)), ()), (((1,), (1, 1), (1,), (1,)), ())],
    "solve": [(((n, n), (n,)), ()) for n in (1, 2, 6)],
    "saddle": [(((4, 4), (4, 2)), ())],
    "least_norm": [(((3, 5), (3,)), ()), (((3, 3), (3,)), ())],
    "resolve": [(((4, 6), (4, 7)), (4,)), (((4, 2), (4, 3)), (2,))],
    "singular_values": [(((4, 6),), ()), (((6, 4),), ())],
    "null_basis": [(((3, 5),), (3,)), (((4, 4),), (4,))],
    "rotation_of_quaternion": [(((4,),), ())],
    "quaternion_of_rotation": [(((3, 3),), ())],
    "angle_of_rotation": [(((2, 2),), ())],
    "rotation_of_angle": [(((1,),), ())],
    "quaternion_of_rpy": [(((3,),), ())],
    "quaternion_rate": [(((4,), (3,)), ())],
    "turn_quaternion": [(((4,), (3,)), ())],
    "turn_between": [(((4,), (4,)), ())],
}
PROJECTED = ("resolve", "null_basis")
"""Bases: what they span is compared."""


class Mode:
    """What operations ask of the mode in which a module runs."""

    def __init__(self, states: int) -> None:
        self.states = states


def operands(shapes: tuple[Shape, ...], states: int, operation: str) -> list[Any]:
    """Random ones, states first; the second state singular, the third not finite."""
    rng = np.random.default_rng(1)
    found = [rng.uniform(-2.0, 2.0, (states, *shape)) for shape in shapes]
    if operation.endswith("_of_rotation"):
        found = [np.linalg.qr(a)[0] for a in found]
        found[0][..., 0] *= np.linalg.det(found[0])[:, None]
    if operation == "inverse_root":
        found = [np.abs(a) + 0.1 for a in found]
    if operation in ("solve", "least_norm") and shapes[0][0] > 1:
        found[0][1, 1] = -3.0 * found[0][1, 0]
        found[0][1, 1, -1] *= 1.0 + 1e-13  # nearly: below the threshold of pivots
    if operation in ("factors_within", "factors_of_some", "nearest_within"):
        found = within_bounds(found, rng)
    found[0][2] = np.nan
    return found


def within_bounds(found: list[Any], rng: np.random.Generator) -> list[Any]:
    """Gram matrices of normals; bounds that leave something, but for those of the second state."""
    n = found[0].shape[1]
    if found[1].ndim == 2:
        found[1][1] = 0.0
        found[-1] = np.abs(found[-1]) + 1.0
        found[0][1], found[-1][1] = 3.0, 2.0
    if len(found) == 4:
        normals = rng.normal(size=(len(found[0]), n, max(n // 3, 1)))
        normals[1, 0] = 0.0
        found[2 if found[1].ndim == 2 else 1] = normals @ np.swapaxes(normals, 1, 2)
    if found[1].ndim == 3:
        found[2], found[3] = -1.5 - np.abs(found[2]), 1.5 + np.abs(found[3])
        found[2][1] = found[0][1] + 0.5
        found[3][1] = found[0][1] + 1.5
    return found


def printed(operation: str, shapes: tuple[Shape, ...], numbers: tuple[int, ...], given: Any) -> Any:
    """What the module's text makes of operands, states first again."""
    names = [Value(f"x_{k}", shape) for k, shape in enumerate(shapes)]
    shapes_of = OPERATIONS[operation].shapes(shapes, numbers)
    targets = tuple(Value(f"y_{k}", shape) for k, shape in enumerate(shapes_of))
    text = STEPS.applied(Apply(operation, tuple(names), targets, numbers))
    scope: dict[str, Any] = {"np": np, "math": math, "compress": compress}
    exec(needed(support(), [text]), scope)
    scope |= {v.name: np.moveaxis(a, 0, -1) for v, a in zip(names, given, strict=True)}
    scope["m"] = Mode(len(given[0]))
    with np.errstate(all="ignore"):
        found = eval(text, scope)
    return [np.moveaxis(a, -1, 0) for a in (found if isinstance(found, tuple) else (found,))]


def test_every_operation_is_printed() -> None:
    assert NumpyBackend().operations & set(OPERATIONS) == set(CASES) == set(OPERATIONS)


@pytest.mark.parametrize("states", [3, 20])
@pytest.mark.parametrize("operation", CASES)
def test_they_are_what_is_defined(operation: str, states: int) -> None:
    for shapes, numbers in CASES[operation]:
        given = operands(shapes, states, operation)
        wanted = OPERATIONS[operation](given, numbers)
        kept = [a.copy() for a in given]
        found = printed(operation, shapes, numbers, given)
        for a, b in zip(given, kept, strict=True):
            np.testing.assert_array_equal(a, b, "an operand was changed")
        assert len(found) == len(wanted)
        for a, b in zip(found, wanted, strict=True):
            assert a.shape == b.shape
            rows = [np.swapaxes(v, -1, -2) if operation == "resolve" else v for v in (a, b)]
            if operation in PROJECTED:
                rows = [v @ np.swapaxes(v, -1, -2) for v in rows]
            np.testing.assert_allclose(*rows, rtol=1e-11, atol=1e-12, err_msg=str(shapes))


def test_rows_of_rounding_are_no_directions() -> None:
    """Nor in the module: rows that vanish on the others are the same with and without rounding."""
    k = np.random.default_rng(0).normal(size=(2, 6, 3))
    k[0, 2] = 0.0
    k[1] = k[0]
    k[1, 2] = 1e-17 * np.arange(1.0, 4.0)
    _, idle = printed("resolve", ((6, 3), (6, 3)), (3,), [k, k])
    _, wanted = OPERATIONS["resolve"]((k, k), (3,))
    for rows in (idle, wanted):
        assert np.abs(rows @ k).max() < 1e-14
    np.testing.assert_allclose(*(np.swapaxes(v, 1, 2) @ v for v in (idle, wanted)), atol=1e-12)
    np.testing.assert_allclose(*(np.swapaxes(v, 0, 1) @ v for v in idle), atol=1e-9)


def test_a_module_has_what_it_needs_and_no_more() -> None:
    text = needed(support(), ["y = _singular_values(x)"])
    assert "def _matrices(" in text
    assert "def _solve(" not in text
    assert "_PIVOT" not in text
