"""What the functions of a model take: real numbers, its own parameters, options by keyword."""

from __future__ import annotations

import inspect
import re
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from tests.models import catalogue, module
from tests.whole.calls import NOT_VECTORS, functions, states
from tests.whole.cases import Array, case

NAMES = ("fivebar_redundant", "hexapod_6x6r", "planar_3rpr", "spherical_3ups", "tripod_3rps")
"""Redundant actuators, iteration, a plane, a fixed centre, constraints."""
REQUIRED = {"X", "V", "A", "tau", "q_actuated", "X0", "X1", "step", "s", "t", "R", "rpy", "p"}
REQUIRED |= {"direction", "wrench_direction", "tau_min", "tau_max"}


def calls(name: str) -> list[tuple[str, str]]:
    """Every function of a model with every argument that is made of numbers."""
    found = functions(module(catalogue(name)))
    weighted = [("inverse_dynamics", "weights")]
    return [(f, a) for f, arguments in found.items() for a in arguments] + weighted


CALLS = [(name, *call) for name in NAMES for call in calls(name)]
UNFIT = {
    "complex numbers": lambda x: x + 0j,
    "a masked array": lambda x: np.ma.array(x, mask=np.zeros(x.shape, dtype=bool)),
    "truth values": lambda x: x > 0.0,
    "text": lambda x: x.astype(str),
    "NoneType": lambda x: np.full(x.shape, None),
    "complex": lambda x: (x + 0j).astype(object),
    "datetime64": lambda x: x.astype("datetime64[s]"),
}
IN_LISTS = {
    "truth values": lambda x: [bool(x[0]), *x[1:]],
    "complex numbers": lambda x: [*x[:-1], 1j],
    "text": lambda x: ["1", *x[1:]],
    "a masked array": lambda x: [np.ma.masked, *x[1:]],
}


def given(name: str, function: str) -> dict[str, Any]:
    """Good values for all arguments of a function."""
    c = case(name, 3)
    values: dict[str, Any] = {**states(c, (), seed=1), "weights": np.ones(c.model.NU), "p": c.p}
    return {n: values[n] for n in inspect.signature(getattr(c.model, function)).parameters
            if n in values}  # fmt: skip


@pytest.mark.parametrize(("name", "function", "argument"), CALLS)
def test_what_is_no_real_number(name: str, function: str, argument: str) -> None:
    values, called = given(name, function), getattr(module(catalogue(name)), function)
    value = np.asarray(values[argument])
    if not value.size:  # the position about a fixed centre
        return
    flat = value.reshape(-1)
    wrong = [(kind, make(value)) for kind, make in UNFIT.items()]
    wrong += [(kind, make(flat)) for kind, make in IN_LISTS.items()]
    wrong.append(("a masked array", [np.ma.array(flat)] * 2))
    for kind, bad in wrong:
        message = rf"^[\w ]+: {argument}: expected real numbers, got {kind}"
        with pytest.raises(TypeError, match=message):
            called(**{**values, argument: bad})
    for bad, message in ((np.ones(99), "has shape"), ([[1.0, 2.0], [3.0]], "is no array of numb")):
        if not value.shape and message == "has shape":
            continue  # numbers may come in any shape: as many states
        with pytest.raises(ValueError, match=rf"^[\w ]+: {argument} {message}"):
            called(**{**values, argument: bad})


@pytest.mark.parametrize("name", NAMES)
def test_other_forms_of_real_numbers(name: str) -> None:
    """Lists, integers, single precision, other byte orders, fractions."""
    model = module(catalogue(name))
    X = np.round(4.0 * np.array(model.HOME_X)) / 4.0 + 0.25
    expected = model.H(X)
    forms = (X.tolist(), tuple(X), list(X), X.astype("f4"), X.astype(">f8"), np.longdouble(X))
    fractions = [Fraction(x) for x in X]
    for form in (*forms, fractions, np.array(fractions)):
        np.testing.assert_array_equal(model.H(form), expected)
    whole = np.array(model.HOME_X).round().astype(int)
    for form in (whole, whole.astype(np.uint8) if (whole >= 0).all() else whole, whole.tolist()):
        np.testing.assert_array_equal(model.H(form), model.H(whole.astype(float)))


def test_parameters_that_are_no_real_numbers() -> None:
    model = module(catalogue("stewart"))
    good = np.array(model.Parameters().gravity)
    for make in (model.Parameters, model.Parameters().replace):
        for kind, unfit in UNFIT.items():
            with pytest.raises(
                TypeError, match=f"Parameters: gravity: expected real numbers, got {kind}"
            ):
                make(gravity=unfit(good))
        for kind, value in (("text", "12"), ("truth values", True), ("complex numbers", 2 + 0j),
                            ("a masked array", np.ma.array(2.0)), ("None", None)):  # fmt: skip
            with pytest.raises(
                TypeError, match=f"platform_mass: expected real numbers, got {kind}"
            ):
                make(platform_mass=value)
    assert model.Parameters(platform_mass=np.int8(3)).platform_mass == 3.0


def with_parameters(name: str) -> list[str]:
    model = module(catalogue(name))
    return [f for f in functions(model) if "p" in inspect.signature(getattr(model, f)).parameters]


@pytest.mark.parametrize(
    ("name", "function"), [(name, f) for name in NAMES for f in with_parameters(name)]
)
def test_parameters_by_position(name: str, function: str) -> None:
    """Right after what is required; others are refused, in an empty batch too."""
    model, values = module(catalogue(name)), given(name, function)
    called = getattr(model, function)
    needed = [v for n, v in values.items() if n in REQUIRED - {"p"}]
    options = {n: v for n, v in values.items() if n not in REQUIRED}
    for found, wanted in zip(
        _arrays(called(*needed, values["p"], **options)), _arrays(called(**values)), strict=True
    ):
        np.testing.assert_array_equal(found, wanted)
    for empty in (False, True):
        some = [np.empty((0, *np.shape(v))) for v in needed] if empty else needed
        if empty and "q0" in options:
            options = {}
        for wrong in (np.zeros(model.NW), {}, [values["p"]], "p", 0):
            told = (
                f"^p: expected Parameters, got {type(wrong).__name__}; a wrench is given as wrench="
            )
            with pytest.raises(TypeError, match=told):
                called(*some, wrong, **options)
        other = module(catalogue("stewart")).Parameters()
        with pytest.raises(TypeError, match=r"^p: expected Parameters, got Parameters of stewart"):
            called(*some, other, **options)


def _arrays(result: Any) -> tuple[Array, ...]:
    return result if isinstance(result, tuple) else (result,)


@pytest.mark.parametrize("name", NAMES)
def test_options_are_given_by_keyword(name: str) -> None:
    model = module(catalogue(name))
    for function in functions(model):
        parameters = inspect.signature(getattr(model, function)).parameters
        for argument, about in parameters.items():
            by_keyword = about.kind is inspect.Parameter.KEYWORD_ONLY
            assert by_keyword == (argument not in REQUIRED), (function, argument)
            assert (about.default is inspect.Parameter.empty) == (argument in REQUIRED - {"p"})
    assert "nearest" in NOT_VECTORS


def test_weights_are_positive_numbers() -> None:
    """Also where the actuators are not redundant, and they have no effect."""
    for name in ("fivebar_redundant", "stewart", "hexapod_6x6r"):
        model = module(catalogue(name))
        still = np.zeros(model.NV)
        for wrong in (0.0, -1.0, np.nan, np.inf):
            weights = np.ones(model.NU)
            weights[1] = wrong
            with pytest.raises(ValueError, match=re.escape("weights must be positive and finite")):
                model.inverse_dynamics(model.HOME_X, still, still, weights=weights)


@pytest.mark.parametrize("name", ["fivebar_redundant", "planar_4rpr"])
def test_weights_of_every_state(name: str) -> None:
    """Also where there are as many states as rows of H, or actuators."""
    c = case(name, 3)
    for count in (2, c.model.NV, c.model.NU):
        v = states(c, (count,), seed=2)
        weights = np.random.default_rng(9).uniform(0.2, 5.0, (count, c.model.NU))
        whole = _arrays(c.model.inverse_dynamics(v["X"], v["V"], v["A"], c.p, weights=weights))
        for k in range(count):
            arguments = (v["X"][k], v["V"][k], v["A"][k], c.p)
            one = _arrays(c.model.inverse_dynamics(*arguments, weights=weights[k]))
            for found, wanted in zip(whole, one, strict=True):
                assert np.abs(found[k] - wanted).max() < 1e-12 * np.abs(wanted).max()


@pytest.mark.parametrize(
    ("name", "function"), [(name, f) for name in NAMES for f in functions(module(catalogue(name)))]
)
def test_leading_dimensions_that_do_not_broadcast(name: str, function: str) -> None:
    """The message names the arguments and their leading dimensions."""
    values, called = given(name, function), getattr(module(catalogue(name)), function)
    arrays = [n for n in values if n not in ("p", "weights") and np.size(values[n])]
    for k, first in enumerate(arrays):
        for second in arrays[k + 1 :]:
            many = {n: np.tile(values[n], (count, *[1] * np.ndim(values[n])))
                    for n, count in ((first, 3), (second, 4))}  # fmt: skip
            with pytest.raises(ValueError, match="leading dimensions do not broadcast: ") as told:
                called(**{**values, **many})
            assert "(3,)" in str(told.value)
            assert "(4,)" in str(told.value)


def test_the_length_of_condition_is_a_positive_number() -> None:
    model = module(catalogue("stewart"))
    for wrong, kind in (("2", "text"), (True, "truth values"), (1j, "complex numbers")):
        with pytest.raises(
            TypeError, match=f"condition: length: expected real numbers, got {kind}"
        ):
            model.condition(model.HOME_X, length=wrong)
    for wrong in (0.0, -1.0, np.nan, np.inf, [1.0]):
        with pytest.raises(
            ValueError, match=r"condition: length is .*, expected a positive number"
        ):
            model.condition(model.HOME_X, length=wrong)
