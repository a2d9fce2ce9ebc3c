"""The guards of a program in numbers: value and scale of every check, leg by leg."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from pne_sym.backends.bundle import Bundle
from pne_sym.program.evaluate import evaluate, prepare, value_of
from pne_sym.program.ir import Check
from tests.whole.cases import Array


class Tested(NamedTuple):
    """A check at some states.

    Attributes:
        function, check: where it stands.
        value, scale: what is compared, (states,) or (legs, states); a squared value comes with a
            squared scale.
    """

    function: str
    check: Check
    value: Array
    scale: Array


def checks_at(bundle: Bundle, vectors: Mapping[str, Array]) -> Iterator[Tested]:
    """Every check of every function at the states X, V, A, q (states, ...)."""
    program = bundle.program
    prepared = prepare(program, _entries(bundle))
    for name, function in program.functions.items():
        values = evaluate(program, name, prepared, vectors).values
        for block in function.blocks:
            for check in block.checks:
                value, scale = (value_of(e, values) for e in (check.value, check.scale))
                yield Tested(name, check, np.asarray(value), np.asarray(scale))


def _entries(bundle: Bundle) -> dict[str, Array]:
    """Entries of the parameters and signs of the branches by name."""
    table = bundle.derivation.parameters
    found = {}
    for name, (field, index) in table.entries.items():
        value = np.asarray(field.default, dtype=float)
        flat = value.reshape(len(value) if field.leg_type else 1, -1)[:, index]
        found[name] = flat if field.leg_type else flat[0]
    branches = {name: np.array(signs, dtype=float) for name, (_, signs) in table.branches.items()}
    return found | branches
