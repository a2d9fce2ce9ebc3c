"""Buffers of one state in C: those that are not cleared first are written, all of them."""

import re
from functools import cache

import pytest

from pne_sym.backends.c_backend import CBackend
from tests.models import bundle, catalogue

OF_LEGS = re.compile(r"\b(terms|o)_(\w+)\[(?:(\w+)\*)?LEGS\(\w+\)\] CLEARED")
NAMES = ["planar_3rpr", "planar_redundant"]


@cache
def text_of(name: str) -> str:
    return CBackend().emit(bundle(catalogue(name)))[f"{name}.c"]


def rows(name: str, size: str) -> set[int]:
    """All rows of so many: a number, the name of one, or nothing for one."""
    named = re.findall(rf"^#define {size} \(\(size_t\)(\d+)\)", text_of(name), re.MULTILINE)
    return set(range(int(*(named or [size or 1]))))


@cache
def routines(name: str) -> dict[str, str]:
    """Name -> text, of a model's routines."""
    text = text_of(name)
    return dict(
        re.findall(r"^(?:\w+ )?\w+ void (\w+)\(([^;{]*\n\{.*?)^\}", text, re.MULTILINE | re.DOTALL)
    )


def called(name: str, body: str) -> set[str]:
    """Routines that a routine calls; functions may share them."""
    return set(re.findall(r"\b(\w+)\(", body)) & routines(name).keys()


def rows_written(name: str, function: str, array: str) -> set[int]:
    """Rows of an array that a routine writes itself or by those to which it passes the array."""
    body = routines(name)[function]
    found = set(map(int, re.findall(rf"\b{array}\[(\d+)\*count \+ k\]", body)))
    for other in called(name, body):
        for first in re.findall(rf"\b{other}\([^;]*\b{array}(?: \+ (\d+)\*count)?[,)]", body):
            found |= {int(first or 0) + row for row in rows_written(name, other, array)}
    return found


@pytest.mark.parametrize("name", NAMES)
def test_what_legs_give(name: str) -> None:
    """Legs of planar_redundant add nothing to some sums: there terms are zeros."""
    found = set()
    for function, body in routines(name).items():
        for array, leg, size in OF_LEGS.findall(body):
            (over,) = (f for f in called(name, body) if f.endswith(f"_legs_{leg}"))
            written = rows_written(name, over, array)
            assert written == rows(name, size), (function, array, leg)
            found.add(array)
    assert "o" in found


@pytest.mark.parametrize("name", NAMES)
def test_what_passes_between_the_parts(name: str) -> None:
    found = 0
    for function, body in routines(name).items():
        for size in re.findall(r"\bs\[(\w+)\] CLEARED", body):
            text = "\n".join(routines(name)[f] for f in called(name, body))
            written = set(map(int, re.findall(r"\bs\[(\d+)\*w \+ k\] =", text)))
            assert written == rows(name, size), function
            found += 1
    assert found > 5


def test_entries_that_nobody_writes_are_cleared() -> None:
    """Actuators of planar_redundant have no part in some rows of H; those of planar_3rpr in all."""
    runs = ("dynamics_run", "dynamics_run_lanes", "H_run", "H_run_lanes")
    cleared = {n: ["clear(H, " in routines(n)[function] for function in runs] for n in NAMES}
    assert cleared == {"planar_3rpr": [False] * 4, "planar_redundant": [True] * 4}
