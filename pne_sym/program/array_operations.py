"""Operations: sums, products and parts of arrays."""

from __future__ import annotations

import numpy as np

from pne_sym.program.evaluate import Array, Status
from pne_sym.program.operation import Compute, Operation, Operations, finite

TINY = 1e-9
"""A distance of points from their centroid below this fraction of the legs' size is none."""
_FORMULAS: dict[str, Compute] = {
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    # a itself.
    "same": lambda a: a.copy(),
    # Entry n of a.
    "entry": lambda a, *, numbers: a[:, numbers[0]],
    "negative": lambda a: -a,
    # a (m x n) times the vector b.
    "times": lambda a, b: (a @ b[..., None])[..., 0],
    "product": lambda a, b: a @ b,
    # The transpose of a.
    "transposed": lambda a: np.swapaxes(a, -1, -2),
    # Half of a^T b a.
    "half_form": lambda a, b: 0.5 * np.einsum("si,sij,sj->s", a, b, a),
    # The sum of the products of entries of a and b.
    "dot": lambda a, b: np.sum(a * b, axis=1),
    # The vector a times the number b.
    "scale": lambda a, b: a * b[:, None],
    # Columns of a times the entries of b.
    "scale_columns": lambda a, b: a * b[:, None, :],
    "multiply": lambda a, b: a * b,
    # a with as many zeros behind that there are n entries.
    "extend": lambda a, *, numbers: np.pad(a, ((0, 0), (0, numbers[0] - a.shape[1]))),
    # The numbered rows (entries) of a.
    "take": lambda a, *, numbers: a[:, list(numbers)],
    # The numbered columns of a.
    "take_columns": lambda a, *, numbers: a[:, :, list(numbers)],
    # The columns of a, then those of b.
    "beside": lambda a, b: np.concatenate((a, b), axis=2),
    # The entries of a, then those of b.
    "join": lambda a, b: np.concatenate((a, b), axis=1),
    # The first n entries of a, and the rest.
    "split": lambda a, *, numbers: (a[:, : numbers[0]], a[:, numbers[0] :]),
    # The least entry of a.
    "least_entry": lambda a: np.min(a, axis=1),
    # 1 where no entry of a is negative, else 0.
    "not_negative": lambda a: np.where(finite(a), (a >= 0.0).all(axis=1), np.nan),
}
OPERATIONS = Operations({name: Operation(name, compute) for name, compute in _FORMULAS.items()})


@OPERATIONS(Status.SINGULAR)
def impossible(a: Array, *, numbers: tuple[int, ...]) -> Array:
    """n values that no forces give: SINGULAR."""
    return np.full((len(a), *numbers), np.nan)


@OPERATIONS()
def divide_rows(a: Array, b: Array, *, numbers: tuple[int, ...]) -> Array:
    """a, the numbered rows divided by the number b."""
    result = np.array(a)
    result[:, list(numbers)] /= b[:, None, None]
    return result


@OPERATIONS()
def choose_length(a: Array, b: Array) -> Array:
    """b where it is positive; else the first entry of a, or the second if it is `TINY` of that."""
    own = np.where(a[:, 0] > TINY * a[:, 1], a[:, 0], a[:, 1])
    return np.where(b > 0.0, b, own)


@OPERATIONS()
def inverse_root(a: Array) -> Array:
    """Entry by entry 1 / root of a; INVALID unless a is positive."""
    found: Array = 1.0 / np.sqrt(a)
    return np.where((a > 0.0) & (found > 0.0), found, np.nan)


@OPERATIONS()
def add_at(a: Array, b: Array, *, numbers: tuple[int, ...]) -> Array:
    """a with b added to the numbered entries."""
    result = np.array(a)
    result[:, list(numbers)] += b
    return result


@OPERATIONS()
def clear_at(a: Array, *, numbers: tuple[int, ...]) -> Array:
    """a with zeros at the numbered entries."""
    result = np.array(a)
    result[:, list(numbers)] = 0.0
    return result


@OPERATIONS()
def add_forces(a: Array, b: Array, c: Array, *, numbers: tuple[int, ...]) -> Array:
    """a, and the row of forces b_k c_k added to its row n_k, for every k."""
    result = np.array(a)
    for k, leg in enumerate(numbers):
        result[:, leg] += b[:, k, None] * c[:, k]
    return result


@OPERATIONS()
def wrap_turns(a: Array, *, numbers: tuple[int, ...]) -> Array:
    """a, the numbered entries turned into (-pi, pi]."""
    result, places = np.array(a), list(numbers)
    result[:, places] = np.pi - np.remainder(np.pi - a[:, places], 2.0 * np.pi)
    return result


@OPERATIONS(Status.OK, unbounded=True)
def unlimited(a: Array, *, numbers: tuple[int, ...]) -> Array:
    """a, infinite at the numbered entries."""
    result = np.array(a)
    result[:, list(numbers)] += np.inf
    return result


@OPERATIONS()
def spread(a: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """Of the first n entries of a the product, and the last over the first, 0 where that is 0."""
    some = a[:, : numbers[0]]
    return np.prod(some, axis=1), np.where(some[:, 0] == 0.0, 0.0, some[:, -1] / some[:, 0])
