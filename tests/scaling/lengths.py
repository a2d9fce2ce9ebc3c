"""The same mechanism built larger: every length multiplied, masses and times as they are."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from pne_sym.backends.bundle import Bundle
from tests.whole.cases import Array

_METRES = re.compile(r"(?<![a-zA-Z])m(?:\^(\d))?(?![a-zA-Z])")


def power_of_length(unit: str) -> int:
    """Power of the metre in a unit; that of the newton and the joule counts.

    >>> [power_of_length(u) for u in ("kg m^2", "m/s^2", "1/m", "m/rad", "-", "N m", "J")]
    [2, 1, -1, 1, 0, 2, 2]
    """
    above, _, below = unit.partition("/")
    power = sum(int(n or 1) for n in _METRES.findall(above))
    power -= sum(int(n or 1) for n in _METRES.findall(below))
    return power + len(re.findall(r"\bN\b", above)) + 2 * len(re.findall(r"\bJ\b", above))


def parameters(bundle: Bundle, factor: float) -> dict[str, Any]:
    """The default parameters of the mechanism that is `factor` times as large."""
    return {
        f.name: np.asarray(f.default, dtype=float) * factor ** power_of_length(f.unit)
        for f in bundle.derivation.parameters.fields
    }


def turning_extras(bundle: Bundle) -> list[bool]:
    """Whether each extra coordinate is an angle; that of a helix is, too."""
    legs = bundle.manipulator.legs
    return [legs[i].joints[j].kind != "P" for i, j in bundle.coordinates.extras]


def pose_powers(bundle: Bundle) -> Array:
    """Power of the metre of the entries of X."""
    pose = [int(name in ("x", "y", "z")) for name in bundle.coordinates.pose]
    return np.array(pose + [int(not turns) for turns in turning_extras(bundle)])


def rate_powers(bundle: Bundle) -> Array:
    """Power of the metre of the entries of V and A."""
    rates = [int(c < 3) for c in bundle.coordinates.components]
    return np.array(rates + [int(not turns) for turns in turning_extras(bundle)])


def force_powers(bundle: Bundle) -> Array:
    """Power of the metre of generalised forces: 1 of forces, 2 of moments."""
    return 2 - rate_powers(bundle)


def joint_powers(bundle: Bundle) -> Array:
    """Power of the metre of the entries of q."""
    joints = [joint for leg in bundle.manipulator.legs for joint in leg.joints]
    return np.array([int(joint.kind == "P") for joint in joints])


def actuator_powers(bundle: Bundle) -> Array:
    """Power of the metre of the entries of tau."""
    c = bundle.coordinates
    joints = joint_powers(bundle)
    return 2 - np.array([joints[c.joints.index(a)] for a in c.actuators], dtype=int)


def scaled(bundle: Bundle, vectors: Mapping[str, Any], factor: float) -> dict[str, Array]:
    """X, V, A, q (and tau, wrench) of the same motion in the larger mechanism."""
    c = bundle.coordinates
    powers = {
        "X": pose_powers(bundle),
        "V": rate_powers(bundle),
        "A": rate_powers(bundle),
        "q": joint_powers(bundle),
        "tau": actuator_powers(bundle),
        "wrench": force_powers(bundle)[: len(c.wrench)],
    }
    return {n: np.asarray(v) * factor ** powers[n].astype(float) for n, v in vectors.items()}
