"""A share of `make hostile`, and that it finds what it is there to find."""

from __future__ import annotations

from pathlib import Path

import pytest

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_public import c_functions
from pne_sym.backends.manifest import ManifestBackend
from tests import models
from tests.backends.c_library import find_compiler, write_sources
from tests.hostile.campaign import BUILDS, CODES, Line, compile_engine, run
from tests.hostile.interface import read_header
from tests.sampling import sampled

STATES = 10_000


def written(bundle: Bundle, folder: Path) -> Path:
    """A model's folder, as far as the campaign reads it."""
    (folder / bundle.name).mkdir()
    source = write_sources(bundle, folder / bundle.name)
    for name, text in ManifestBackend().emit(bundle).items():
        (folder / bundle.name / name).write_text(text, encoding="utf-8")
    return source


def campaign(source: Path, build: str, states: int = STATES) -> tuple[list[Line], str, bool]:
    chosen = BUILDS[build]
    find_compiler(chosen.compiler)
    place = source.parent.parent / build
    place.mkdir()
    program = compile_engine(source.parent, chosen, place)
    return run(program, states, 3, chosen.threads)


@pytest.mark.parametrize("which", ["fivebar_revolute", "tripod_3rps", "planar_4rpr"])
def test_the_header_tells_of_every_function(which: str, tmp_path: Path) -> None:
    bundle = models.bundle(models.catalogue(which))
    table = c_functions(bundle)
    found = read_header(written(bundle, tmp_path).with_suffix(".h"))
    assert [f.name for f in found.functions] == [a.name for a in table]
    for function, api in zip(found.functions, table, strict=True):
        assert function.has_model == api.has_model
        for told, meant in zip(
            (*function.inputs, *function.outputs), (*api.inputs, *api.outputs), strict=True
        ):
            assert (told.name, told.size, told.optional) == (meant.name, meant.size, meant.optional)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("which", "build"),
    sampled(
        [
            ("tripod_3rps", "memory"),
            ("tripod_3rps", "thread"),
            ("planar_redundant", "memory"),
            ("planar_3rpr", "memory"),
            ("planar_mixed", "quick"),
            ("fivebar_redundant", "float"),
            ("stewart", "fast"),
        ],
        0,
        keep=[("planar_3rpr", "memory"), ("planar_mixed", "quick")],
    ),
)
def test_hostile_states_break_no_promise(which: str, build: str, tmp_path: Path) -> None:
    source = written(models.bundle(models.catalogue(which)), tmp_path)
    lines, told, passed = campaign(source, build)
    assert passed, told
    assert sum(line.states for line in lines) >= STATES
    codes = [sum(column) for column in zip(*(line.codes for line in lines), strict=True)]
    assert codes[0] > STATES / 5
    assert codes[CODES.index("INVALID")] > STATES / 50
    assert all(line.status[0] == line.values[0] == 0 for line in lines), "single and batch differ"


DELIVER = """EVERY_ENTRY(size) {
        out[size*k + e] = x[e*LANES + k];
"""
FLAGS = "    status_flags why;\n"
PLANTED = {
    "NaN is left out": ("quick", "out[e] = R(NAN);", "out[e] = 0;", "impossible, but not NaN"),
    "infinite counts as finite": ("quick", "return x - x == 0;", "return x == x;", "not finite"),
    "a word too many": (
        "quick",
        DELIVER,
        f"{DELIVER}        out[size*LANES] = 0;\n",
        "writes beyond its output",
    ),
    "failures are not counted": (
        "quick",
        "failed += code[k] != OK;",
        "failed += code[k] > 1;",
        "count of failures",
    ),
    "an output is not written": (
        "memory",
        DELIVER,
        DELIVER.replace("out[", "if (e) out["),
        "use-of-uninitialized-value",
    ),
    "a state is kept": (
        "thread",
        FLAGS,
        FLAGS.replace("status_flags", "static status_flags"),
        "data race",
    ),
}


@pytest.mark.parametrize("fault", PLANTED)
def test_a_planted_fault_is_found(fault: str, tmp_path: Path) -> None:
    build, old, new, message = PLANTED[fault]
    source = written(models.bundle(models.catalogue("fivebar_revolute")), tmp_path)
    text = source.read_text(encoding="utf-8")
    assert old in text
    source.write_text(text.replace(old, new), encoding="utf-8")
    _, told, passed = campaign(source, build, 4000)
    assert not passed
    assert message in told
