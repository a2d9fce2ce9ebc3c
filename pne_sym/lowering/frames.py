"""Frames and how components pass from one to another.

The frames form a tree.  A step is a constant rotation (numbers or prepared
values) or a turn about z by a known cosine and sine.  Neighbouring constant
steps are multiplied once, among the parameters.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp

from pne_sym.derivation import Frame
from pne_sym.lowering.algebra import negative
from pne_sym.lowering.triples import XYZ, Matrix, Triple, matrix, transposed, triple

if TYPE_CHECKING:
    from pne_sym.lowering.components import Lowering


@dataclass(frozen=True)
class ConstantStep:
    """v_to = matrix v_from."""

    matrix: Matrix


@dataclass(frozen=True)
class TurnStep:
    """Turn about z: v_to = (c x + sign s y, c y - sign s x, z).

    Cosine and sine are looked up only when a component needs them: what lies along
    the axis passes before the angle is known.
    """

    c: Any
    s: Any
    sign: int


class Frames:
    """The tree of frames of a derivation."""

    def __init__(self, of: Lowering) -> None:
        self.of, self.b = of, of.b
        self._store = of.trials.store  # forgets with a rolled-back trial
        self._frame = {frame.name: frame for frame in of.d.frames}
        self._steps: dict[tuple[str, str], list[ConstantStep | TurnStep]] = {}
        self._matrix: dict[str, Matrix] = {}

    def steps(self, origin: str, target: str) -> list[ConstantStep | TurnStep]:
        """Steps from one frame to another, constant neighbours merged."""
        key = (origin, target)
        if key not in self._steps:
            self._store(self._steps, key, self._merge(self._path(origin, target)))
        return self._steps[key]

    def _ancestors(self, name: str) -> list[str]:
        line = [name]
        while (parent := self._frame[line[-1]].parent) is not None:
            line.append(parent)
        return line

    def _path(self, origin: str, target: str) -> list[ConstantStep | TurnStep]:
        up, down = self._ancestors(origin), self._ancestors(target)
        common = next(name for name in up if name in down)
        path: list[ConstantStep | TurnStep] = []
        for name in up[: up.index(common)]:
            path.append(self._to_parent(self._frame[name]))
        for name in reversed(down[: down.index(common)]):
            path.append(self._to_child(self._frame[name]))
        return path

    def _to_child(self, frame: Frame) -> ConstantStep | TurnStep:
        if frame.angle is not None:
            return TurnStep(*frame.angle, 1)
        return ConstantStep(transposed(self.matrix(frame)))

    def _to_parent(self, frame: Frame) -> ConstantStep | TurnStep:
        if frame.angle is not None:
            return TurnStep(*frame.angle, -1)
        return ConstantStep(self.matrix(frame))

    def matrix(self, frame: Frame) -> Matrix:
        """parent_R_child of a frame that does not turn."""
        if frame.name not in self._matrix:
            assert frame.rotation is not None
            entries = list(frame.rotation)
            if None in entries:
                entries = self._fill(frame, entries)
            made = matrix(lambda i, j: sp.sympify(entries[3 * i + j]))
            self._store(self._matrix, frame.name, made)
        return self._matrix[frame.name]

    def _fill(self, frame: Frame, entries: list[Any]) -> list[Any]:
        assert frame.parent is not None
        if frame.axes is not None:
            columns = [self.of.vector(axis, frame.parent) for axis in frame.axes]
            found = [c for row in zip(*columns, strict=True) for c in row]
        else:
            assert frame.rows is not None
            found = [c for row in frame.rows for c in self.of.vector(row, frame.name)]
        return [f if e is None else e for e, f in zip(entries, found, strict=True)]

    def _merge(self, path: list[ConstantStep | TurnStep]) -> list[ConstantStep | TurnStep]:
        merged: list[ConstantStep | TurnStep] = []
        for step in path:
            last = merged[-1] if merged else None
            if isinstance(step, ConstantStep) and isinstance(last, ConstantStep):
                product = self._product(step.matrix, last.matrix)
                merged[-1] = ConstantStep(product)
            else:
                merged.append(step)
        return [s for s in merged if not (isinstance(s, ConstantStep) and _is_identity(s.matrix))]

    def _product(self, a: Matrix, b: Matrix) -> Matrix:
        columns = transposed(b)
        return matrix(lambda i, j: self.b.dot(a[i], columns[j]))

    def apply(self, step: ConstantStep | TurnStep, v: Triple, hint: str = "") -> Triple:
        """Components after a step."""
        b, (x, y, z) = self.b, v
        if isinstance(step, TurnStep):
            if x == 0 and y == 0:
                return v
            c, s = self.of.scalar(step.c), self.of.scalar(step.s)
            s = s if step.sign == 1 else negative(s)
            return (
                b.add((b.mul(c, x), b.mul(s, y)), f"{hint}_x"),
                b.add((b.mul(c, y), negative(b.mul(s, x))), f"{hint}_y"),
                z,
            )
        return triple(lambda i: b.dot(step.matrix[i], v, f"{hint}_{XYZ[i]}"))


def _is_identity(m: Matrix) -> bool:
    return all(m[i][j] == (1 if i == j else 0) for i in range(3) for j in range(3))
