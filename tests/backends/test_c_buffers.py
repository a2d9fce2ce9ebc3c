"""Buffers of one state in C: those that are not cleared first are written, all of them."""

import re
from functools import cache

import pytest

from pne_sym.backends.c_backend import CBackend
from tests.models import bundle, catalogue

OF_LEGS = re.compile(r"\b(terms|o)_(\w+)\[(?:(\d+)\*)?LEGS\(\w+\)\] CLEARED")
NAMES = ["planar_3rpr", "planar_redundant"]


@cache
def routines(name: str) -> dict[str, str]:
    """Name -> text, of a model's routines."""
    text = CBackend().emit(bundle(catalogue(name)))[f"{name}.c"]
    return dict(re.findall(r"^\w+ void (\w+)\(([^;{]*\n\{.*?)^\}", text, re.MULTILINE | re.DOTALL))


def called(name: str, body: str) -> set[str]:
    """Routines that a routine calls; functions may share them."""
    return set(re.findall(r"\b(\w+)\(", body)) & routines(name).keys()


@pytest.mark.parametrize("name", NAMES)
def test_what_legs_give(name: str) -> None:
    """Legs of planar_redundant add nothing to some sums: there terms are zeros."""
    found = set()
    for function, body in routines(name).items():
        for array, leg, rows in OF_LEGS.findall(body):
            (over,) = (f for f in called(name, body) if f.endswith(f"_legs_{leg}"))
            written = set(re.findall(rf"\b{array}\[(\d+)\*count \+ k\]", routines(name)[over]))
            assert written == set(map(str, range(int(rows or 1)))), (function, array, leg)
            found.add(array)
    assert "o" in found


@pytest.mark.parametrize("name", NAMES)
def test_what_passes_between_the_parts(name: str) -> None:
    found = 0
    for function, body in routines(name).items():
        for size in re.findall(r"\bs\[(\d+)\] CLEARED", body):
            text = "\n".join(routines(name)[f] for f in called(name, body))
            written = set(re.findall(r"\bs\[(\d+)\*w \+ k\] =", text))
            assert written == set(map(str, range(int(size)))), function
            found += 1
    assert found > 5
