"""What the engine says of a leg: the named quantities of its derivation, evaluated.

Everything is taken from the derivation: what is given and in which frame, the frames, the
equations.  Vectors and tensors are evaluated in base axes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import sympy as sp

from pne_sym.derivation import Derivation, Frame, ParameterField, full_name
from pne_sym.vector import TensorSymbol
from pne_sym.vector.evaluate import evaluate
from tests.models import at_path, bundle, catalogue
from tests.oracle.coordinates import rotation_from_quaternion
from tests.paper.printed import Array
from tests.paper.sampling import Sample


def leg_quantities(sample: Sample, form: Any, leg: int, wanted: tuple[str, ...]) -> dict[str, Any]:
    """Values of named quantities of a leg, in base axes.

    Args:
        sample: the state.
        form: full form of the sample's manipulator.
        leg: position of the leg.
        wanted: names, without the leg type.
    """
    derivation = bundle(catalogue(sample.manipulator.name)).derivation
    scalars = _scalars(derivation, sample, form, leg)
    turning = {frame.name: frame.angle for frame in derivation.frames if frame.angle}
    turns: dict[str, tuple[float, float]] = dict.fromkeys(turning, (1.0, 0.0))
    for _ in turning:  # an angle is found without its own frame, from the base to the platform
        known = _Leg(derivation, scalars, turns)
        turns = {name: (known[c.name], known[s.name]) for name, (c, s) in turning.items()}
    known = _Leg(derivation, scalars, turns)
    return {name: known[full_name(derivation, name)] for name in wanted}


class _Leg(dict[str, Any]):
    """Values by name, each found when it is needed first."""

    def __init__(
        self,
        derivation: Derivation,
        scalars: dict[str, float],
        turns: dict[str, tuple[float, float]],
    ) -> None:
        super().__init__(scalars)
        self.turns = turns
        self.givens = {given.symbol.name: given for given in derivation.givens}
        self.frames = {frame.name: frame for frame in derivation.frames}
        self.equations = {equation.name: equation for equation in derivation.equations()}

    def __missing__(self, name: str) -> Any:
        if name in self.equations:
            value = evaluate(self.equations[name].rhs, self)
        else:
            value = self._given(name)
        self[name] = value
        return value

    def _given(self, name: str) -> Any:
        """A vector or tensor that is given."""
        given = self.givens[name]
        values = np.array([evaluate(sp.sympify(c), self) for c in given.components])
        axes = self.rotation(given.frame)
        if isinstance(given.symbol, TensorSymbol):
            return axes @ values.reshape(3, 3) @ axes.T
        return axes @ values

    def rotation(self, name: str) -> Array:
        """base_R_frame."""
        frame: Frame = self.frames[name]
        if frame.parent is None:
            return np.eye(3)
        parent = self.rotation(frame.parent)
        if frame.angle is not None:
            c, s = self.turns[name]
            return np.asarray(parent @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
        assert frame.rotation is not None
        entries = [evaluate(sp.sympify(entry), self) for entry in frame.rotation]
        return np.asarray(parent @ np.array(entries).reshape(3, 3))


def _scalars(derivation: Derivation, sample: Sample, form: Any, leg: int) -> dict[str, float]:
    """State, live parameters and branch signs."""
    spatial = len(sample.X) == 7
    values: dict[str, float] = {}
    vectors = {"t": sample.X[:3], "t_dot": sample.V[:3]}
    vectors |= {"omega": sample.V[3:]} if spatial else {}
    for stem, vector in vectors.items():
        values |= {f"{stem}_{axis}": float(v) for axis, v in zip("xyz", vector, strict=False)}
    if spatial:
        R = rotation_from_quaternion(sample.X[3:])
        values |= {f"R_{'xyz'[i]}{'xyz'[j]}": R[i, j] for i in range(3) for j in range(3)}
    numbers: dict[str, Array] = {}
    for name, (field, index) in derivation.parameters.entries.items():
        if field.name not in numbers:
            numbers[field.name] = _numbers(field, form, leg)
        values[name] = float(numbers[field.name][index])
    for name, (_, signs) in derivation.parameters.branches.items():
        values[name] = float(signs[leg])
    return values


def _numbers(field: ParameterField, form: Any, leg: int) -> Array:
    """A live parameter's numbers for a leg."""
    path = field.paths[leg] if field.leg_type else field.paths[0]
    return np.array(at_path(form, path), dtype=float).ravel()
