"""Numbers for every name of a derivation at a state, all in base axes.

What is given comes from the specification, the state and the oracle's link rotations; what is
defined is evaluated from its own equation.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from pne_sym.derivation import Derivation, Equation
from pne_sym.model.full_form import to_full_form
from pne_sym.model.manipulator import Leg, Manipulator
from pne_sym.vector import LegSum, TensorLegSum, TensorSymbol, VectorLegSum, VectorSymbol
from pne_sym.vector.evaluate import evaluate
from tests.models import at_path
from tests.oracle.coordinates import joint_slices, pose_size, task_size, twist_basis
from tests.oracle.projection import Result, project
from tests.oracle.specs import State

Array = NDArray[np.float64]
_SUMS = (LegSum, VectorLegSum, TensorLegSum)
_SYMBOLS = {LegSum: sp.Symbol, VectorLegSum: VectorSymbol, TensorLegSum: TensorSymbol}


class Situation:
    """A manipulator's derivation at a state, with an acceleration of its own.

    Attributes:
        oracle: the independent values at the acceleration.
        platform: names without a leg.
        legs: names seen by each leg, in the order of the specification.
    """

    def __init__(
        self, manipulator: Manipulator, derivation: Derivation, state: State, A: Array
    ) -> None:
        self.manipulator, self.derivation, self.state, self.A = manipulator, derivation, state, A
        self.form = to_full_form(manipulator)
        self.oracle: Result = project(manipulator, state.X, state.q, state.V, A, state.wrench)
        self.type_of = {i: t.name for t in derivation.leg_types for i in t.indices}
        self.platform = Names(self, None)
        self.legs = [Names(self, index) for index in range(len(manipulator.legs))]

    def state_scalars(self) -> dict[str, float]:
        """Components of pose, twist and acceleration, and of the rotation matrix."""
        basis = twist_basis(self.manipulator.space)
        task = task_size(self.manipulator.space)
        twist, rate = basis @ self.state.V[:task], basis @ self.A[:task]
        values: dict[str, Any] = {}
        motion = self.oracle.platform
        for i, a in enumerate("xyz"):
            values |= {f"t_{a}": motion.origin[i], f"t_dot_{a}": twist[i], f"t_ddot_{a}": rate[i]}
            values |= {f"omega_{a}": twist[3 + i], f"alpha_{a}": rate[3 + i]}
            values |= {f"R_{a}{b}": motion.rotation[i, j] for j, b in enumerate("xyz")}
        return {name: float(value) for name, value in values.items()}

    def legs_of(self, leg_type: str) -> list[Names]:
        """The legs of a type."""
        return [names for i, names in enumerate(self.legs) if self.type_of[i] == leg_type]


class Names(Mapping[str, Any]):
    """Values by name, made when they are asked for."""

    def __init__(self, situation: Situation, index: int | None) -> None:
        self.situation, self.index = situation, index
        self.derivation = situation.derivation
        self.defined: dict[str, Equation] = {e.name: e for e in self.derivation.equations()}
        self.given = {g.symbol.name: g for g in self.derivation.givens}
        self.made: dict[str, Any] = {}
        self.scalars = situation.state_scalars() | self._parameters()
        if index is not None:
            self.scalars |= self._extras(index)

    # ---- of the specification and the state ----------------------------------------------

    @property
    def leg(self) -> Leg:
        assert self.index is not None
        return self.situation.manipulator.legs[self.index]

    @cached_property
    def leg_type(self) -> str:
        assert self.index is not None
        return self.situation.type_of[self.index]

    def named(self, stem: str) -> str:
        """The name of a quantity of this leg."""
        return f"{self.leg_type}_{stem}"

    def stem(self, name: str) -> str:
        """A name without its leg type."""
        return name.removeprefix(f"{self.leg_type}_")

    def _parameters(self) -> dict[str, float]:
        table, found = self.derivation.parameters, {}
        for name, (field, entry) in table.entries.items():
            path = self._path(field.paths, field.leg_type)
            if path is not None:
                value = np.ravel(np.array(at_path(self.situation.form, path), dtype=float))
                found[name] = float(value[entry])
        for name, (leg_type, signs) in table.branches.items():
            if self.index is not None and leg_type == self.leg_type:
                info = next(t for t in self.derivation.leg_types if t.name == leg_type)
                found[name] = float(signs[info.indices.index(self.index)])
        return found

    def _path(self, paths: tuple[str, ...], leg_type: str | None) -> str | None:
        if leg_type is None:
            return paths[0]
        if self.index is None or leg_type != self.leg_type:
            return None
        return next(p for p in paths if p.startswith(f"legs[{self.index}]."))

    def _extras(self, index: int) -> dict[str, float]:
        """Extra coordinates of the leg, and displacements that are found by iteration."""
        s, found = self.situation, {}
        legs = s.manipulator.legs
        first = sum(j.extra for leg in legs[:index] for j in leg.joints)
        pose, task = pose_size(s.manipulator.space), task_size(s.manipulator.space)
        q = s.state.q[joint_slices(s.manipulator)[index]]
        for j, joint in enumerate(self.leg.joints, 1):
            if joint.extra:
                found[self.named(f"y_{j}_extra")] = s.state.X[pose + first]
                found[self.named(f"yd_{j}")] = s.state.V[task + first]
                found[self.named(f"ydd_{j}")] = s.A[task + first]
                first += 1
            elif self.named(f"q_{j}") not in self.defined:
                found[self.named(f"q_{j}")] = q[j - 1]
        return {name: float(value) for name, value in found.items()}

    # ---- frames ---------------------------------------------------------------------------

    def rotation(self, frame: str) -> Array:
        """base_R_frame; that of a link is the oracle's."""
        if f"frame {frame}" not in self.made:
            self.made[f"frame {frame}"] = self._rotation(frame)
        found: Array = self.made[f"frame {frame}"]
        return found

    def _rotation(self, name: str) -> Any:
        s = self.situation
        if name == "base":
            return np.eye(3)
        if name == "platform":
            return s.oracle.platform.rotation
        assert self.index is not None
        kind, number = re.fullmatch(rf"{self.leg_type}\.([a-z]+)(\d+)", name).groups()  # type: ignore[union-attr]
        j = int(number)
        if kind == "spec":
            frames = s.oracle.legs[self.index].motion.rotation
            return frames[j - 1] if j else np.array(self.leg.base_frame, dtype=float)
        frame = next(f for f in self.derivation.frames if f.name == name)
        if kind == "axes" and j:  # fixed in the link: seen from the link's own frame
            link = next(f for f in self.derivation.frames if f.name == f"{self.leg_type}.spec{j}")
            return self._matrix(link.rotation, link.rows, self.rotation(link.name), inverse=True)
        assert frame.parent is not None
        return self._matrix(frame.rotation, frame.axes, self.rotation(frame.parent), inverse=False)

    def _matrix(self, entries: Any, axes: Any, parent: Array, *, inverse: bool) -> Any:
        """base_R_child, of entries in the parent frame, or of axes as vectors."""
        known = [None if e is None else float(e) for e in entries or (None,) * 9]
        if axes is None:
            matrix = np.array(known, dtype=float).reshape(3, 3)
            return parent @ (matrix.T if inverse else matrix)
        made = np.array([evaluate(axis, self) for axis in axes]).T
        local = parent.T @ made
        local = local.T if inverse else local
        for value, entry in zip(local.ravel(), known, strict=True):
            assert entry is None or abs(value - entry) < 1e-9, "a structural entry is wrong"
        return made

    # ---- names ----------------------------------------------------------------------------

    def __getitem__(self, name: str) -> Any:
        if name not in self.made:
            self.made[name] = self._make(name)
        return self.made[name]

    def _make(self, name: str) -> Any:
        if name in self.given:
            given = self.given[name]
            components = np.array([evaluate(sp.sympify(c), self.scalars) for c in given.components])
            if given.frame == "":
                return float(components[0])
            rotation = self.rotation(given.frame)
            if components.size == 9:
                return rotation @ components.reshape(3, 3) @ rotation.T
            return rotation @ components
        if name in self.scalars:
            return self.scalars[name]
        return self.value(self.defined[name].rhs)

    def value(self, expr: Any) -> Any:
        """Value of an expression, sums over legs included."""
        sums: dict[Any, Any] = {}
        for k, node in enumerate(_sums_in(expr)):
            body, leg_type = node.args
            name = f"sum {k} of {id(expr)}"
            legs = self.situation.legs_of(leg_type.name)
            self.made[name] = sum(evaluate(body, names) for names in legs)
            options = {"real": True} if isinstance(node, LegSum) else {}
            sums[node] = _SYMBOLS[type(node)](name, **options)
        return evaluate(expr.xreplace(sums) if sums else expr, self)

    def __iter__(self) -> Iterator[str]:
        return iter({**self.given, **self.scalars, **self.defined})

    def __len__(self) -> int:
        return len(list(iter(self)))


def _sums_in(expr: Any) -> list[Any]:
    if isinstance(expr, _SUMS):
        return [expr]
    return [node for arg in getattr(expr, "args", ()) for node in _sums_in(arg)]
