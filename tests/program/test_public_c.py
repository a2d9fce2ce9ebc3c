"""Public functions of the generated C against the interpreter: values and statuses, one table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pne_sym import manipulators
from pne_sym.program.evaluate import Status
from tests import models
from tests.backends.c_library import CLibrary
from tests.infinite import finite_parts
from tests.program.test_public import TOLERANCE, interpreter, spanned, states
from tests.sampling import sampled

COPIES = 3  # of every state: a lane of 8, and a remainder


@pytest.mark.parametrize("name", sampled(manipulators.names(), 8))
def test_every_function_is_the_interpreter_s(name: str, tmp_path: Path) -> None:
    manipulator = models.catalogue(name)
    run, library = (
        interpreter(manipulator),
        CLibrary(models.bundle(manipulator), tmp_path, flags=()),
    )
    given = {
        key: np.tile(array, (COPIES, *[1] * (array.ndim - 1)))
        for key, array in states(manipulator, models.module(manipulator)).items()
    }
    given = {key: array.reshape(len(array), -1) for key, array in given.items()}
    given["X"][1] = given["X0"][1] = np.nan
    given["X"][5, 0] += 1e3  # out of reach, or another pose
    for function in library.api.values():
        shapes = {a.name: a.value.shape for a in function.of.inputs}
        arguments = {i.name: given[i.name].reshape(-1, *shapes[i.name]) for i in function.inputs}
        wanted = run.call(function.of.name, **arguments)
        found, status = library.batch(function.name, *(given[i.name] for i in function.inputs))
        where = f"{name} {function.name}"
        np.testing.assert_array_equal(status, wanted.status, where)
        assert (status == Status.OK).sum() >= len(status) - 3
        for array, output in zip(found, wanted.outputs, strict=True):
            answers = [array.reshape(output.shape), output]
            if function.name == "null_space":
                answers = [spanned(a) for a in answers]
            np.testing.assert_array_equal(*map(np.isnan, answers), where)
            answers = finite_parts(*answers)
            across = tuple(range(1, output.ndim))
            size = np.nanmax(np.abs(answers[1]), axis=across, keepdims=True, initial=0.0)
            off = np.abs(answers[0] - answers[1]) / np.where(size > 0.0, size, 1.0)
            assert np.nanmax(off, initial=0.0) <= TOLERANCE, where
