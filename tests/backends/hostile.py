"""Single and batch C, and NumPy, at hostile states: the statuses and values side by side.

`python -m tests.backends.hostile stewart 20000` prints what differs.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tests.backends.c_library import FAST, INVALID, OK, Array, CLibrary
from tests.models import bundle, catalogue, module

CHUNK = 7  # fewer than run side by side: a batch of so many runs them one by one
SPECIAL = (0.0, -0.0, 5e-324, 1e-300, 1e-160, 1e-12, 1e68, -1e75, 1e160, 1e300, np.inf, np.nan)
FUNCTIONS = ("M", "Z", "H", "dynamics", "inverse_dynamics", "forward_dynamics")
DIRECTIONS = 6


class Compared(NamedTuple):
    """A function at hostile states.

    Attributes:
        single, batch: status codes.
        error: largest difference over the size of what the function gives for inputs of that size.
        bound: 1e-12 times the condition, where there is one.
    """

    single: Array
    batch: Array
    error: Array
    bound: Array

    @property
    def disagree(self) -> Array:
        """Where the statuses differ, but for results that overflow in one of them."""
        overflow = (self.single == INVALID) | (self.batch == INVALID)
        return (self.single != self.batch) & ~overflow


def hostile(rng: np.random.Generator, count: int, base: Array) -> Array:
    """Vectors near `base`, a share of them with entries of any magnitude."""
    x = base + rng.normal(0.0, 0.3, (count, len(base)))
    kind = rng.integers(0, 6, count)
    x[kind == 1] *= 10.0 ** rng.uniform(-160.0, 160.0, (np.sum(kind == 1), 1))
    x[kind == 2] *= 10.0 ** rng.uniform(-160.0, 160.0, (np.sum(kind == 2), len(base)))
    rows = np.flatnonzero(kind == 3)
    x[rows, rng.integers(0, len(base), len(rows))] = rng.choice(SPECIAL, len(rows))
    return x


def inputs(name: str, count: int, rng: np.random.Generator, X: Array | None) -> dict[str, Array]:
    """All inputs; poses are hostile, or given."""
    model = module(catalogue(name))
    sizes = {"V": model.NV, "A": model.NV, "tau": model.NU, "wrench": model.NW}
    found = {n: hostile(rng, count, np.zeros(size)) for n, size in sizes.items()}
    poses = hostile(rng, count, model.HOME_X) if X is None else X
    return found | {"X": poses, "q0": np.tile(model.HOME_Q, (count, 1))}


def one_by_one(library: CLibrary, name: str, given: list[Array]) -> tuple[list[Array], Array]:
    """The batch in chunks so small that every state is computed alone."""
    parts = [
        library.batch(name, *(a[k : k + CHUNK] for a in given))
        for k in range(0, len(given[0]), CHUNK)
    ]
    outputs = [np.concatenate(arrays) for arrays in zip(*(p[0] for p in parts), strict=True)]
    return outputs, np.concatenate([p[1] for p in parts])


def compare(library: CLibrary, name: str, given: dict[str, Array], bound: Array) -> Compared:
    """A function by itself and side by side."""
    order = [i.name for i in library.api[name].inputs]
    batch, status = library.batch(name, *(given[n] for n in order))
    single, alone = one_by_one(library, name, [given[n] for n in order])
    size = _size(library, name, given, [*batch, *single])
    error = np.zeros(len(status))
    with np.errstate(all="ignore"):
        off = np.max([np.max(np.abs(a - b), axis=1) for a, b in zip(batch, single, strict=True)], 0)
        error = np.where((status == OK) & (alone == OK) & (off > 0.0), off / size, 0.0)
    return Compared(alone, status, error, bound)


def _size(library: CLibrary, name: str, given: dict[str, Array], found: list[Array]) -> Array:
    """Largest output for inputs of this size in other directions: terms can cancel in one.

    Not a number where all other directions overflow: what cancels in this one is not known there.
    """
    rng, order = np.random.default_rng(1), [i.name for i in library.api[name].inputs]
    with np.errstate(all="ignore"):
        size = np.max([np.nanmax(np.abs(a), axis=1, initial=0.0) for a in found], axis=0)
        known = np.zeros(len(size), dtype=bool)
        for _ in range(DIRECTIONS):
            turned = {
                n: np.max(np.abs(given[n]), axis=1, keepdims=True)
                * rng.uniform(-1.0, 1.0, given[n].shape)
                for n in given
            }
            turned |= {n: given[n] for n in ("X", "q0")}
            for array in library.batch(name, *(turned[n] for n in order))[0]:
                known |= np.isfinite(array).all(axis=1)
                size = np.fmax(size, np.nanmax(np.abs(array), axis=1, initial=0.0))
        return np.where(known, size, np.nan)


def bounds(name: str, given: dict[str, Array]) -> tuple[Array, Array]:
    """1e-12 times the condition of the legs, and of the legs and the actuators together."""
    model = module(catalogue(name))
    function = getattr(model, "condition_constrained", model.condition)
    guess = {"q0": given["q0"]} if "q0" in model.M.__code__.co_varnames else {}
    with np.errstate(all="ignore"):
        sigma, legs, _ = function(given["X"], **guess)
        of_legs = 1e-12 / np.minimum(legs.min(axis=1), 1.0)
        return of_legs, of_legs * sigma[:, 0] / sigma[:, -1]


def compared(
    library: CLibrary, name: str, count: int, seed: int, X: Array | None = None
) -> Iterator[tuple[str, dict[str, Array], Compared]]:
    """Every function of `FUNCTIONS` at hostile states."""
    rng = np.random.default_rng(seed)
    for function in FUNCTIONS:
        given = inputs(name, count, rng, X)
        legs, actuators = bounds(name, given)
        bound = actuators if function == "inverse_dynamics" else legs
        if function == "forward_dynamics":
            bound = legs * _condition_of_masses(name, given)
        yield function, given, compare(library, function, given, bound)


def _condition_of_masses(name: str, given: dict[str, Array]) -> Any:
    model = module(catalogue(name))
    with np.errstate(all="ignore"):
        M = model.M(given["X"])
        good = np.isfinite(M).all(axis=(1, 2))
        return np.where(good, np.linalg.cond(np.where(good[:, None, None], M, np.eye(model.NV))), 1)


def main() -> None:
    """Print the differences of a model."""
    name, count = sys.argv[1], int(sys.argv[2])
    with tempfile.TemporaryDirectory() as folder:
        library = CLibrary(bundle(catalogue(name)), Path(folder), flags=FAST)
        for function, _, found in compared(library, name, count, 0):
            over = np.nanmax(found.error / found.bound, initial=0.0)
            print(
                f"{name} {function}: {count} states, statuses differ at "
                f"{np.sum(found.single != found.batch)} ({found.disagree.sum()} without overflow), "
                f"largest error {np.nanmax(found.error):.1e}, {over:.1e} of the bound"
            )


if __name__ == "__main__":
    main()
