"""Every public function is called with every argument, in both languages; none is left out."""

from __future__ import annotations

import inspect
from functools import cache

import numpy as np
import pytest

from pne_sym.backends.c_public import c_functions
from pne_sym.review.alignment import align
from pne_sym.review.c_driver import c_calls
from pne_sym.review.compare import compare
from pne_sym.review.difference import Verdict
from pne_sym.review.model import Model, from_bundle
from pne_sym.review.values import STATES, Runs
from tests.models import bundle, catalogue, module
from tests.sampling import sampled

MODELS = (
    "fivebar_redundant",  # weights, null space, a point
    "planar_3rpr",  # an angle
    "tripod_3rps",  # constraints
    "spherical_3ups",  # no position
    "hybrid_3rrrs",  # an extra coordinate
    "hexapod_6x6r",  # iterated: q0
)


def model(name: str) -> Model:
    return from_bundle(name, bundle(catalogue(name)))


@cache
def runs(name: str) -> Runs:
    manifest = model(name).manifest
    return Runs(model(name), model(name), 0, align(manifest, manifest))


@pytest.mark.parametrize("name", sampled(MODELS, 3))
def test_numpy(name: str) -> None:
    (answer, _), generated = runs(name).answers, module(catalogue(name))
    assert answer.errors == {}
    called = {(k[0], k[1]) for each in answer.calls for k in each}
    for function in generated.__all__:
        member = getattr(generated, function)
        if inspect.isclass(member):
            continue
        if not callable(member):
            assert function in answer.constants
            continue
        assert (function, ()) in called
        for p in inspect.signature(member).parameters.values():
            if p.default is not p.empty and p.name != "p":
                assert (function, (p.name,)) in called, f"{function}: {p.name}"
    assert {k[2] for each in answer.calls for k in each} == {"batch", "single"}
    assert runs(name).states >= STATES


@pytest.mark.parametrize("name", sampled(MODELS, 3))
def test_c(name: str) -> None:
    compiled = bundle(catalogue(name))
    calls = c_calls(model(name).functions)
    for api in c_functions(compiled):
        own = [c for c in calls if c.function == api.name]
        assert own
        for argument in api.inputs:
            if argument.optional and argument.size:
                assert any(argument.name in c.given for c in own)
                assert any(argument.name not in c.given for c in own)
        given = dict(zip((c.given for c in own), own, strict=True))
        assert all(c.outputs == tuple((o.name, o.size) for o in api.outputs) for c in own)
        assert () in given


@pytest.mark.parametrize("name", sampled(["fivebar_redundant", "tripod_3rps"], 2))
def test_the_driver_gives_numpys_values(name: str) -> None:
    """What is read from the C program is in its place: by the other language's values."""
    both = runs(name)
    answers, faults = both.c_answers()
    assert faults == []
    assert answers is not None
    assert np.array_equal(answers[0].constants["sizes"], answers[1].constants["sizes"])
    checked = 0
    for key, outputs in answers[0].calls[0].items():
        if key == ("prepare", (), "single"):
            assert not np.any(outputs[0])
            continue
        function, given, mode = key
        if function == "inverse_dynamics_weighted":
            function, given = "inverse_dynamics", tuple(sorted({*given, "weights"}))
            given = given if len(given) == 1 else ("wrench", "weights")
        expected = both.answers[0].calls[0][function, given, mode]
        if function == "null_space":
            continue
        for value, wanted in zip(outputs, expected, strict=False):
            assert value.shape[0] == STATES
            np.testing.assert_allclose(
                value, wanted.reshape(value.shape), rtol=1e-9, atol=1e-9, err_msg=str(key)
            )
            checked += 1
    assert checked > 40


def test_a_version_and_itself_is_the_same_in_every_function() -> None:
    same = compare(model("planar_3rpr"), model("planar_3rpr"), run=True)
    assert same.equal
    assert {b.verdict for b in same.blocks} == {Verdict.IDENTICAL}
    assert "C: all functions" in {b.name for b in same.blocks}
