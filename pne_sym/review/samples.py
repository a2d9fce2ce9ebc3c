"""Random parameters and states near a model's home, the same for both versions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pne_sym.model.kinematics import Array, rotation_about


def random_parameters(defaults: Mapping[str, Array], rng: np.random.Generator) -> dict[str, Array]:
    """Values near the defaults that keep what the structure demands.

    What is zero without being so by structure is moved too: that a default happens to be
    zero must not hide what depends on it.

    Args:
        defaults: by path of the full form.
        rng: where the random numbers come from.
    """
    planar = all(abs(v[2, 2] - 1.0) < 1e-9 for p, v in defaults.items() if p.endswith("base_frame"))
    size = length_of(defaults)
    return {path: _near(path, value, (planar, size), rng) for path, value in defaults.items()}


def _near(path: str, value: Array, of: tuple[bool, float], rng: np.random.Generator) -> Array:
    planar, length = of
    if path.endswith("frame"):
        return _turn(rng.normal(0.0, 0.05, 3) * ((0, 0, 1) if planar else 1)) @ value
    if "axis" in path.rpartition(".")[2] or path.endswith("rotation"):
        return value
    if path.endswith("inertia") and value.ndim:  # congruent: no moment becomes negative
        skewed = np.eye(3) + rng.normal(0.0, 0.03, (3, 3))
        moved = rng.uniform(0.8, 1.25) * (skewed @ value @ skewed.T)
        if not value.any():
            moved = 0.01 * length * length * (skewed @ skewed.T)
        return np.asarray(0.5 * (moved + moved.T), dtype=np.float64)
    if value.ndim == 0:
        return np.asarray((value or 0.1) * rng.uniform(0.8, 1.25), dtype=np.float64)
    size = float(np.linalg.norm(value)) or length
    moved = value * rng.uniform(0.97, 1.03, value.shape) + 0.02 * size * rng.normal(
        size=value.shape
    )
    if planar and value.shape == (3,):
        moved[2] = value[2]
    return np.asarray(moved, dtype=np.float64)


_BOUND = 1e4
"""Size of the bounds of actuator forces: so wide that there are forces within, or nearly."""
SHARED = ("weights", "length", "nearest")
"""Arguments that are the same for all states."""


def random_values(
    manifest: Mapping[str, Any], count: int, size: float, rng: np.random.Generator
) -> dict[str, Array]:
    """Values for the arguments of functions by name, near home, before constraints are met.

    "R with nearest" is R where `nearest` is given too.

    Args:
        manifest: of the model.
        count: of states.
        size: a length of the mechanism, in metres.
        rng: where the random numbers come from.
    """
    sizes, pose = manifest["sizes"], manifest["coordinates"]["X"]
    home, q = (np.array(manifest["home"][n], dtype=float) for n in ("X", "q"))
    scale = np.array([0.05 * size if n in ("x", "y", "z") else 0.1 for n in pose])
    scale = np.concatenate((scale, np.full(len(home) - len(scale), 0.05)))

    def drawn(key: str, amount: float = 1.0) -> Array:
        return amount * rng.normal(size=(count, sizes[key]))

    found = {
        "X": home + scale * rng.normal(size=(count, len(home))),
        "V": drawn("NV"),
        "A": drawn("NV"),
        "tau": drawn("NU"),
        "wrench": drawn("NW"),
        "weights": rng.uniform(0.5, 2.0, sizes["NU"]),
        "length": np.array(rng.uniform(0.5, 2.0) * size),
        "q0": q + drawn("NJ", 0.01),
        "s": rng.uniform(-0.5, 1.5, count),
        "step": drawn("NV", 0.3),
        "base": _bases(pose, count, rng),
    }
    found |= _orientations(pose, count, rng)
    return found | {
        "direction": drawn("NV"),
        "wrench_direction": drawn("NW"),
        "tau_min": -_BOUND * rng.uniform(0.5, 1.0, (count, sizes["NU"])),
        "tau_max": _BOUND * rng.uniform(0.5, 1.0, (count, sizes["NU"])),
        "reference": drawn("NU", 2.0 * _BOUND),
    }


def _bases(pose: list[str], count: int, rng: np.random.Generator) -> Array:
    """Motions of the base: rotations row by row, angular and linear motion."""
    turns, others = rng.normal(size=(count, 3)), rng.normal(size=(count, 9))
    if "z" not in pose and "qw" not in pose:  # in the plane
        turns[:, :2] = 0.0
    return np.array([[*_turn(v).ravel(), *rest] for v, rest in zip(turns, others, strict=True)])


def _orientations(pose: list[str], count: int, rng: np.random.Generator) -> dict[str, Array]:
    """Arguments of the helpers for poses."""
    places = sum(name in ("x", "y", "z") for name in pose)
    turns = rng.normal(0.0, 1.0, (count, 3))
    matrices = [_turn(v if "qw" in pose else v * (0, 0, 1)) for v in turns]
    side = 3 if "qw" in pose else 2
    R = np.array([matrix[:side, :side] for matrix in matrices])
    return {
        "t": rng.normal(size=(count, places)),
        "rpy": turns,
        "R": R,
        "nearest": np.array(1.0),
        "R with nearest": R
        + 0.5 * rng.normal(size=R.shape),  # no rotations: some need a reflection
    }


def actuated(manifest: Mapping[str, Any], q: Array) -> Array:
    """The displacements of the actuated joints among those of all."""
    return q[:, [manifest["joints"].index(joint) for joint in manifest["actuators"]]]


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
