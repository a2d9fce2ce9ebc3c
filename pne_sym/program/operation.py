"""An operation of public functions, on arrays over states."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pne_sym.program.evaluate import Array, Status

Shape = tuple[int, ...]
Compute = Callable[..., Array | tuple[Array, ...]]


@dataclass(frozen=True)
class Operation:
    """An operation on arrays.

    Attributes:
        name: in steps.
        compute: results, in order, of operands over states; floating-point faults are no matter.
        status: of a state in which a result is not finite although all operands are; OK where that
            is meant.
        unbounded: results may be infinite: what is not finite is NaN.
    """

    name: str
    compute: Compute
    status: Status = Status.INVALID
    unbounded: bool = False

    def __call__(self, operands: Sequence[Array], numbers: tuple[int, ...]) -> tuple[Array, ...]:
        """Results at operands over states."""
        takes = "numbers" in inspect.signature(self.compute).parameters
        with np.errstate(all="ignore"):
            found = self.compute(*operands, **({"numbers": numbers} if takes else {}))
        return found if isinstance(found, tuple) else (found,)

    def shapes(self, operands: Sequence[Shape], numbers: tuple[int, ...]) -> list[Shape]:
        """Shapes of what it gives for operands of these shapes."""
        found = self([np.ones((1, *shape)) for shape in operands], numbers)
        return [array.shape[1:] for array in found]


class Operations(dict[str, Operation]):
    """Operations by name; called, it enters a function under its own name."""

    def __call__(
        self, status: Status = Status.INVALID, *, unbounded: bool = False
    ) -> Callable[[Compute], Compute]:
        """What enters a function: see `Operation`."""

        def enter(compute: Compute) -> Compute:
            name = compute.__name__
            self[name] = Operation(name, compute, status, unbounded)
            return compute

        return enter


def finite(a: Array) -> NDArray[np.bool_]:
    """States in which every entry is finite."""
    return np.asarray(np.isfinite(a).all(axis=tuple(range(1, a.ndim))), dtype=np.bool_)


def blanked(a: Array, bad: NDArray[np.bool_]) -> Array:
    """Matrices with zeros in bad states: LAPACK refuses what is not finite."""
    return np.where(bad[:, None, None], np.float64(0.0), a)
