"""Steps of public functions that must not be printed."""

from __future__ import annotations

import pytest

from pne_sym.program.public import (
    Apply,
    Argument,
    PublicFunction,
    Search,
    Step,
    StepError,
    Value,
    verify_steps,
)

X, Y, Z = (Value(name, (3,)) for name in "XYZ")
GOOD = Apply("negative", (X,), (Y,))


def function(*steps: Step, output: Value = Y) -> PublicFunction:
    given, made = Argument(X, ("NQ",), "given"), Argument(output, ("NQ",), "made")
    return PublicFunction("test", "Test.", (given,), (made,), steps, "dynamics")


def test_right_steps_pass() -> None:
    verify_steps(function(GOOD))
    verify_steps(function(Search("residual", "slope", (X,), (Y,), halving=True)))


@pytest.mark.parametrize(
    "spoilt",
    [
        function(),  # the output is not made
        function(Apply("negative", (Z,), (Y,))),  # not known
        function(Apply("negative", (Value("X", (4,)),), (Y,))),  # of another shape
        function(GOOD, GOOD),  # made twice
        function(Apply("negative", (X,), (X,)), output=X),  # an input is made
        function(Search("residual", "slope", (Z,), (Y,), halving=True)),
        function(GOOD, output=Value("Y", (2,))),
    ],
)
def test_others_are_refused(spoilt: PublicFunction) -> None:
    with pytest.raises(StepError, match="test: "):
        verify_steps(spoilt)
