"""Random parameters and states near a model's home, the same for both versions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pne_sym.model.kinematics import rotation_about
from pne_sym.review.model import Model

Array = NDArray[np.float64]


def random_parameters(defaults: Mapping[str, Array], rng: np.random.Generator) -> dict[str, Array]:
    """Values near the defaults that keep what the structure demands.

    Args:
        defaults: by path of the full form.
        rng: where the random numbers come from.
    """
    planar = all(abs(v[2, 2] - 1.0) < 1e-9 for p, v in defaults.items() if p.endswith("base_frame"))
    return {path: _near(path, value, planar, rng) for path, value in defaults.items()}


def _near(path: str, value: Array, planar: bool, rng: np.random.Generator) -> Array:
    if path.endswith("frame"):
        return _turn(rng.normal(0.0, 0.05, 3) * ((0, 0, 1) if planar else 1)) @ value
    if "axis" in path.rpartition(".")[2] or path.endswith("rotation"):
        return value
    if path.endswith("inertia"):
        size = float(np.trace(value)) / 3.0
        noise = rng.normal(0.0, 0.03, (3, 3)) * size
        return np.asarray(value * rng.uniform(0.8, 1.25) + noise + noise.T, dtype=np.float64)
    if value.ndim == 0:
        return np.asarray(value * rng.uniform(0.8, 1.25), dtype=np.float64)
    size = float(np.linalg.norm(value))
    moved = value * rng.uniform(0.97, 1.03, value.shape) + 0.02 * size * rng.normal(
        size=value.shape
    )
    if planar and value.shape == (3,):
        moved[2] = value[2]
    return np.asarray(moved, dtype=np.float64)


def random_states(
    model: Model, count: int, size: float, rng: np.random.Generator
) -> dict[str, Any]:
    """X, V, A, tau near home, before constraints are met.

    Args:
        model: whose home.
        count: of states.
        size: a length of the mechanism, in metres.
        rng: where the random numbers come from.
    """
    sizes, pose = model.manifest["sizes"], model.manifest["coordinates"]["X"]
    home = np.array(model.manifest["home"]["X"], dtype=float)
    scale = np.array([0.05 * size if n in ("x", "y", "z") else 0.1 for n in pose])
    scale = np.concatenate((scale, np.full(len(home) - len(scale), 0.05)))
    X = home + scale * rng.normal(size=(count, len(home)))
    return {
        "X": X.tolist(),
        "V": rng.normal(size=(count, sizes["NV"])).tolist(),
        "A": rng.normal(size=(count, sizes["NV"])).tolist(),
        "tau": rng.normal(size=(count, sizes["NU"])).tolist(),
    }


def length_of(defaults: Mapping[str, Array]) -> float:
    """A typical length: the median distance of the legs' points from their origins."""
    lengths = [
        float(np.linalg.norm(v)) for p, v in defaults.items() if p.endswith(("_point", "offset"))
    ]
    positive = [length for length in lengths if length > 0.0]
    return float(np.median(positive)) if positive else 1.0


def _turn(vector: Array) -> Array:
    """Rotation matrix of a small rotation vector."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    return rotation_about(vector / angle, angle)
