"""Frames and how components pass from one to another.

The frames form a tree.  A step is a constant rotation (numbers or prepared
values) or a turn about z by a known cosine and sine.  Neighbouring constant
steps are multiplied once, among the parameters.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import sympy as sp

from pne_sym.derivation import Frame
from pne_sym.lowering.algebra import negative
from pne_sym.lowering.triples import IDENTITY, XYZ, Matrix, Triple, matrix, transposed, triple

if TYPE_CHECKING:
    from pne_sym.lowering.components import Lowering


class TurnStep(NamedTuple):
    """Turn about z: v_to = (c x + sign s y, c y - sign s x, z).

    Cosine and sine are looked up only when a component needs them: what lies along
    the axis passes before the angle is known.
    """

    c: Any
    s: Any
    sign: int


Step = Matrix | TurnStep
"""From frame to frame; a matrix is what components are multiplied by."""


class Frames:
    """The tree of frames of a derivation."""

    def __init__(self, of: Lowering) -> None:
        self.of, self.b = of, of.b
        self._store = of.trials.store  # forgets with a rolled-back trial
        self._frame = {frame.name: frame for frame in of.d.frames}
        self._steps: dict[tuple[str, str], list[Step]] = {}
        self._matrix: dict[str, Matrix] = {}

    def steps(self, origin: str, target: str) -> list[Step]:
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

    def _path(self, origin: str, target: str) -> list[Step]:
        up, down = self._ancestors(origin), self._ancestors(target)
        common = next(name for name in up if name in down)
        ways = ((up[: up.index(common)], -1), (down[: down.index(common)][::-1], 1))
        return [self._step(self._frame[name], sign) for names, sign in ways for name in names]

    def _step(self, frame: Frame, sign: int) -> Step:
        """From a frame to its parent (-1), or from there."""
        if frame.angle is not None:
            return TurnStep(*frame.angle, sign)
        to_parent = self.matrix(frame)
        return to_parent if sign < 0 else transposed(to_parent)

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

    def _merge(self, path: list[Step]) -> list[Step]:
        merged: list[Step] = []
        for step in path:
            last = merged[-1] if merged else None
            if last is None or isinstance(step, TurnStep) or isinstance(last, TurnStep):
                merged.append(step)
            else:
                merged[-1] = self._product(step, last)
        return [step for step in merged if step != IDENTITY]

    def _product(self, a: Matrix, b: Matrix) -> Matrix:
        columns = transposed(b)
        return matrix(lambda i, j: self.b.dot(a[i], columns[j]))

    def apply(self, step: Step, v: Triple, hint: str = "") -> Triple:
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
        return triple(lambda i: b.dot(step[i], v, f"{hint}_{XYZ[i]}"))
