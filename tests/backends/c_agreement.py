"""Generated C against generated NumPy: every public function, single states and batches."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from tests.backends.c_library import Array, CLibrary
from tests.bounds import bounded
from tests.infinite import finite_parts
from tests.targets.modules import SWAYING

TOLERANCE = 1e-11
FOUND_BY_ITERATION = {"forward_kinematics": 1e-8, "project": 1e-8}
"""Iterations on the pose stop at residuals of 1e-9, not at the last digit."""
FEW = 3
"""States for functions that run no states side by side."""


def vectors(
    module: Any, X: Array, q: Array, count: int, rng: np.random.Generator
) -> dict[str, Array]:
    """An array for every input of every function, states first, near the poses X (..., NQ).

    Constraints need not hold there, and loops not be closed by q: both codes then find the
    nearest closure.
    """
    near = np.resize(X, (count, module.NQ)) + rng.uniform(-0.02, 0.02, (count, module.NQ))
    guess = np.resize(q, (count, module.NJ)) + rng.uniform(-0.02, 0.02, (count, module.NJ))
    return {
        "X": near,
        "V": rng.uniform(-1.0, 1.0, (count, module.NV)),
        "A": rng.uniform(-5.0, 5.0, (count, module.NV)),
        "wrench": rng.uniform(-20.0, 20.0, (count, module.NW)),
        "q0": guess,
        "tau": rng.uniform(-50.0, 50.0, (count, module.NU)),
        "weights": np.tile(rng.uniform(0.5, 2.0, module.NU), (count, 1)),
        "q_actuated": np.resize(q, (count, module.NJ))[:, list(module.ACTUATED)],
        "X0": near,
        "X1": near + rng.uniform(-0.2, 0.2, near.shape),
        "step": rng.uniform(-1.0, 1.0, (count, module.NV)),
        "s": rng.uniform(-1.0, 2.0, count),
        "base": np.tile(SWAYING, (count, 1)),
        "rpy": rng.uniform(-3.0, 3.0, (count, 3)),
        **bounded(module, count),
        **_pose(module, near),
    }


def _pose(module: Any, X: Array) -> dict[str, Array]:
    """Position and rotation matrix, where the space has rotation."""
    if not hasattr(module, "rotation"):
        return {}
    R = module.rotation(X)
    position = {6: 3, 3: 0 if module.NQ > module.NV else 2}[module.NW]
    return {"R": R, "t": X[:, :position]}


POSE_HELPERS = (
    *("rotation", "pose", "pose_from_rpy", "X_dot"),
    *("retract", "difference", "interpolate"),
)
"""Functions without a model."""


def from_numpy(module: Any, name: str, given: Mapping[str, Array], p: Any) -> list[Array]:
    """What the function of the NumPy module makes of these inputs, (states, flat) each."""
    given = dict(given)
    options = {} if name in POSE_HELPERS else {"p": p}
    if name == "inverse_dynamics_weighted":
        name = "inverse_dynamics"
        given["weights"] = given["weights"][0]
    made = getattr(module, name)(**given, **options)
    made = made if isinstance(made, tuple) else (made,)
    if name.startswith("condition"):
        made = made[:2]  # status codes are compared apart
    n = len(next(iter(given.values())))
    return [np.reshape(array, (n, -1)) for array in made]


def compared(name: str, array: Array, module: Any) -> Array:
    """What of an output is determined: of a basis, the projector on the space it spans."""
    if name == "constraints":  # rounding where loops close: beside lengths of the order of one
        return np.hstack([array, np.ones((len(array), 1))])
    if name != "null_space":
        return array
    basis = array.reshape(len(array), module.NU, -1)
    return np.asarray(basis @ np.swapaxes(basis, 1, 2)).reshape(len(array), -1)


def error(got: Array, want: Array) -> float:
    """Largest difference, relative to the largest entry; NaN only where both are."""
    np.testing.assert_array_equal(np.isnan(got), np.isnan(want))
    got, want = finite_parts(got, want)
    size = float(np.nanmax(np.abs(want), initial=0.0))
    return float(np.nanmax(np.abs(got - want), initial=0.0)) / (size or 1.0)


def assert_agree(
    library: CLibrary,
    module: Any,
    given: Mapping[str, Array],
    p: Any = None,
    tolerance: float | None = None,
) -> int:
    """Every function of both; returns how many were compared."""
    for name, api in library.api.items():
        count = None if api.lanes else FEW
        inputs = {i.name: given[i.name][:count] for i in api.inputs}
        want = from_numpy(module, name, inputs, p)
        batch, status = library.batch(name, *inputs.values())
        limit = tolerance or FOUND_BY_ITERATION.get(name, TOLERANCE)
        assert len(want) == len(batch), name
        failed = np.any([np.isnan(w).any(axis=1) for w in want], axis=0)
        np.testing.assert_array_equal(status != 0, failed, err_msg=name)
        assert not failed.all(), name
        for got, wanted in zip(batch, want, strict=True):
            off = error(compared(name, got, module), compared(name, wanted, module))
            assert off < limit, (name, off)
        for k in range(len(status)):
            found, code = library.single(name, *(v[k] for v in inputs.values()))
            assert code == status[k], name
            for got, wanted in zip(found, batch, strict=True):
                off = error(
                    compared(name, got[None], module), compared(name, wanted[None, k], module)
                )
                assert off < limit, (name, k, off)
    return len(library.api)
