"""Operations as C has them, against their definitions, for one state and for many side by side."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
import pytest

from pne_sym.backends.c_backend import CBackend, support
from pne_sym.backends.c_functions import LANES
from pne_sym.backends.c_operations import OPERATIONS as PRINTED
from pne_sym.backends.c_operations import lanes_of
from pne_sym.backends.c_solve import Eliminations
from pne_sym.backends.c_steps import Steps
from pne_sym.backends.c_support import needed
from pne_sym.backends.c_text import Routine, parameter_name
from pne_sym.program.evaluate import Status
from pne_sym.program.operation import finite
from pne_sym.program.operations import OPERATIONS
from pne_sym.program.public import Apply, Argument, PublicFunction, Value
from tests import models
from tests.backends.c_library import WARNINGS, find_compiler, run
from tests.backends.test_numpy_operations import CASES, PROJECTED, Shape, operands

LISTED = [(name, *case) for name, cases in CASES.items() for case in cases]


def function(operation: str, shapes: tuple[Shape, ...], numbers: tuple[int, ...]) -> PublicFunction:
    """A public function that applies an operation."""
    inputs = tuple(Value(f"in{k}", shape) for k, shape in enumerate(shapes))
    made = OPERATIONS[operation].shapes(shapes, numbers)
    targets = tuple(Value(f"out{k}", shape) for k, shape in enumerate(made))
    step = Apply(operation, inputs, targets, numbers)
    return PublicFunction(
        operation,
        "",
        tuple(Argument(v, (), "") for v in inputs),
        tuple(Argument(v, (), "", label=v.name) for v in targets),
        (step,),
        "",
        needs_model=False,
        unbounded=OPERATIONS[operation].unbounded,
    )


def exported(number: int, of: PublicFunction, routine: Routine, *, lanes: bool) -> list[str]:
    """A function that calls the routine; what is empty is left out."""
    empty = {a.name for a in of.inputs if not a.value.size}
    empty |= {f"{o.label}_out" for o in of.outputs if not o.value.size}
    taken = [p for p in routine.parameters if parameter_name(p) not in empty]
    parameters = ", ".join(taken if lanes else [*taken, "int *code"])
    head = f"void run_{number}{'_lanes' if lanes else ''}({parameters})"
    call = routine.call_with(dict.fromkeys(empty, "NULL"))
    definition = routine.definition()
    if not {"static", "INLINE"} & set(routine.kind.split()):
        definition[0] = f"static {definition[0]}"
    return [*definition, f"{head};", f"{head} {{ {'' if lanes else '*code = '}{call} }}"]


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    bundle, folder = models.bundle(models.catalogue("planar_3rpr")), tmp_path_factory.mktemp("c")
    files = CBackend().emit(bundle)
    lines = []
    for number, case in enumerate(LISTED):
        for lanes in [False, True] if lanes_of(case[0]) else [False]:
            of = function(*case)
            routine = Steps(bundle, of, {}, {}, Eliminations(), lanes=lanes).routine()
            name = f"of_{number}{'_lanes' if lanes else ''}"
            routine = routine._replace(name=name)
            lines += exported(number, of, routine, lanes=lanes)
    head = files["planar_3rpr.c"].split("/* ---- parameters ---- */")[0]

    text = "\n".join(lines)
    (folder / "planar_3rpr.h").write_text(files["planar_3rpr.h"])
    source = folder / "operations.c"
    source.write_text("\n".join((head, needed(support(bundle, 8), [text]), text)))
    made = folder / "operations.so"
    run(find_compiler("gcc"), "-std=c99", "-O1", *WARNINGS, "-shared", "-fPIC", source, "-o", made,
        "-lm")  # fmt: skip
    return ctypes.CDLL(str(made))


def called(of: Any, given: list[Any], shapes: list[Shape], states: int) -> tuple[list[Any], Any]:
    """Outputs and codes of the states of one call."""
    inputs = [np.ascontiguousarray(a, dtype=float) for a in given]
    outputs = [np.full((states, *shape), 77.0) for shape in shapes]
    codes = np.full(states, -1, np.intc)
    arrays = [a for a in (*inputs, *outputs) if a.size]
    of(*(a.ctypes.data_as(ctypes.c_void_p) for a in (*arrays, codes)))
    return outputs, codes


def test_every_operation_is_printed() -> None:
    assert PRINTED - {"search"} == set(OPERATIONS)


@pytest.mark.parametrize("number", range(len(LISTED)), ids=[case[0] for case in LISTED])
def test_they_are_what_is_defined(library: ctypes.CDLL, number: int) -> None:
    operation, shapes, numbers = LISTED[number]
    given = operands(shapes, LANES, operation)
    wanted = OPERATIONS[operation](given, numbers)
    known = np.logical_and.reduce([finite(a) for a in given])
    good = known & np.logical_and.reduce(
        [~np.isnan(a.reshape(LANES, -1)).any(axis=1) for a in wanted]
    )
    codes = np.where(good, 0, int(OPERATIONS[operation].status))
    codes[~known] = Status.INVALID
    made = OPERATIONS[operation].shapes(shapes, numbers)
    one = getattr(library, f"run_{number}")
    single = [called(one, [a[k : k + 1] for a in given], made, 1) for k in range(LANES)]
    outputs = [np.concatenate(o) for o in zip(*(o for o, _ in single), strict=True)]
    np.testing.assert_array_equal(np.concatenate([c for _, c in single]), codes)
    assert_right(outputs, wanted, good, operation)
    assert all(np.isnan(a[~good]).all() for a in outputs)
    if lanes_of(operation):
        outputs, found = called(getattr(library, f"run_{number}_lanes"), given, made, LANES)
        assert (codes[found == 0] == 0).all()  # others are settled one by one
        assert (found[codes == 0] == 0).all()
        assert_right(outputs, wanted, good, operation)


def assert_right(outputs: list[Any], wanted: Any, good: Any, operation: str) -> None:
    """Outputs are what is wanted where the state is good."""
    for a, b in zip(outputs, wanted, strict=True):
        rows = [np.swapaxes(v, -1, -2) if operation == "resolve" else v for v in (a, b)]
        if operation in PROJECTED:
            rows = [v @ np.swapaxes(v, -1, -2) for v in rows]
        np.testing.assert_allclose(rows[0][good], rows[1][good], rtol=1e-11, atol=1e-12)
