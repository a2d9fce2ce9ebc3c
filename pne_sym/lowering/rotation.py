"""Components from frame to frame: joint by joint, or by the axes of a frame in base axes.

Which is cheaper depends on what is there already and on how many vectors pass.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING

import sympy as sp

from pne_sym.lowering.frames import Frames, TurnStep
from pne_sym.lowering.statements import Atom
from pne_sym.lowering.triples import (
    IDENTITY,
    XYZ,
    Matrix,
    Triple,
    cross,
    entry,
    matrix,
    on_both_sides,
    symmetrised,
    transposed,
    triple,
)
from pne_sym.program.ir import Component
from pne_sym.vector import nodes as n

if TYPE_CHECKING:
    from pne_sym.lowering.components import Lowering

_NONE = (sp.S.Zero,) * 3


class Rotation:
    """Turns components of vectors and tensors into those in another frame."""

    def __init__(self, of: Lowering) -> None:
        self.of, self.b, self.trials, self.frames = of, of.b, of.trials, Frames(of)
        self._axis_columns: dict[tuple[str, str, int], Triple] = {}

    def vector(self, v: Triple, origin: str, target: str, hint: str = "") -> Triple:
        """Components of a vector in another frame: step by step, or by axis columns."""
        if origin == target or all(c == 0 for c in v):
            return v
        makers = [lambda: self._by_steps(v, origin, target, hint)]
        if origin == "base" and all((target, "base", k) in self._axis_columns for k in range(3)):
            makers.append(lambda: self._by_rows(v, target, hint))
        if target == "base" and origin != "platform":
            makers.append(lambda: self._by_columns(v, origin, target, hint))
        return self.trials.cheapest(makers)

    def _by_rows(self, v: Triple, frame: str, hint: str) -> Triple:
        axes = triple(lambda k: self.axis_column(frame, "base", k))
        return triple(lambda k: self.b.dot(axes[k], v, f"{hint}_tip_{XYZ[k]}"))

    def _by_steps(self, v: Triple, origin: str, target: str, hint: str) -> Triple:
        steps = self.frames.steps(origin, target)
        for k, step in enumerate(steps):
            last = k == len(steps) - 1
            v = self.frames.apply(
                step, v, f"{hint}_in_base" if last and target == "base" else f"{hint}_r{k}"
            )
        return v

    def _by_columns(self, v: Triple, origin: str, target: str, hint: str) -> Triple:
        columns = triple(lambda k: self.axis_column(origin, target, k) if v[k] != 0 else _NONE)
        rows = transposed(columns)
        return triple(lambda i: self.b.dot(v, rows[i], f"{hint}_in_base_{XYZ[i]}"))

    def components(self) -> Iterator[tuple[Component, Atom]]:
        """The entries of axes that were made."""
        for (origin, target, k), column in self._axis_columns.items():
            for i, atom in enumerate(column):
                yield Component("", target, (i, k), axes=origin), atom

    def axis_column(self, origin: str, target: str, k: int) -> Triple:
        """Axis k of a frame in another: along a known vector, by cross product, or turned."""
        key = (origin, target, k)
        if key in self._axis_columns:
            return self._axis_columns[key]
        hint = f"axis_{XYZ[k]}_{origin.replace('.', '_')}"
        makers: list[Callable[[], Triple]] = [
            lambda: self._by_steps(IDENTITY[k], origin, target, hint)
        ]
        along = self.along(origin, target, k)
        if along is not None:
            makers.append(along)
        others = [(origin, target, (k + 1) % 3), (origin, target, (k + 2) % 3)]
        if all(other in self._axis_columns for other in others):
            a, c = (self._axis_columns[other] for other in others)
            makers.append(lambda: cross(self.b, a, c, hint))
        return self.trials.store(self._axis_columns, key, self.trials.cheapest(makers))

    def along(self, origin: str, target: str, k: int) -> Callable[[], Triple] | None:
        """A way by a vector whose only component in the origin frame is its k-th."""
        for (name, frame), v in self.of.known.items():
            if frame == origin and not isinstance(v[k], tuple) and not v[k].is_Number:
                same = self._same_vector(name, target) if v.count(0) == 2 else None
                if same is not None:
                    return partial(self._over, same, v[k], f"axis_{XYZ[k]}")
        return None

    def _over(self, v: Triple, length: Atom, hint: str) -> Triple:
        return triple(lambda i: self.b.divide(v[i], length, entry(hint, i)))

    def _same_vector(self, name: str, target: str) -> Triple | None:
        """Components in the target of a vector or of an equal one."""
        definition, known = self.of.definition, self.of.known
        forms = definition[name].forms if name in definition else ()
        equal = [form.name for form in forms if isinstance(form, n.VectorSymbol)]
        there = ((same, target) for same in (name, *equal) if (same, target) in known)
        return next((known[key] for key in there), None)

    def tensor(
        self, t: Matrix, origin: str, target: str, symmetric: bool, hint: str = ""
    ) -> Matrix:
        """Components of a tensor in another frame."""
        if origin == target:
            return t
        makers = [lambda: self._tensor_by_steps(t, origin, target, symmetric)]
        if target == "base" and origin != "platform" and not symmetric:
            # A T A^T with the axes A of the frame of origin in base axes
            by_columns = partial(self._by_columns, origin=origin, target="base", hint=hint)
            makers.append(lambda: on_both_sides(by_columns, t))
        if symmetric and target == "base":
            makers += [partial(self._tensor_by_columns, t, origin, target, k) for k in range(3)]
        return self.trials.cheapest(makers)

    def _tensor_by_steps(self, t: Matrix, origin: str, target: str, symmetric: bool) -> Matrix:
        for step in self.frames.steps(origin, target):
            t = on_both_sides(partial(self.frames.apply, step), t)
            if symmetric and not isinstance(step, TurnStep):
                t = symmetrised(self.b, t)
        return symmetrised(self.b, t) if symmetric else t

    def _tensor_by_columns(self, t: Matrix, origin: str, target: str, k: int) -> Matrix:
        """T_kk E + sym(x a^T) + sym(y b^T) with two axes x, y: axis k is eliminated.

        Where no entry on the diagonal stays, the last follows from the trace, which does.
        """
        b = self.b
        i, j = (k + 1) % 3, (k + 2) % 3
        x, y, z = (self.axis_column(origin, target, m) for m in (i, j, k))
        half = sp.Rational(1, 2)
        xx = b.mul(half, b.add((t[i][i], -t[k][k])))
        yy = b.mul(half, b.add((t[j][j], -t[k][k])))
        a = [b.add((b.mul(xx, x[m]), b.mul(t[i][j], y[m]), b.mul(t[i][k], z[m]))) for m in range(3)]
        c = [b.add((b.mul(yy, y[m]), b.mul(t[j][k], z[m]))) for m in range(3)]
        rows = [[sp.S.Zero] * 3 for _ in range(3)]
        for p in range(3):
            half_pp = b.add((b.mul(x[p], a[p]), b.mul(y[p], c[p])))
            rows[p][p] = b.add((t[k][k], b.mul(sp.Integer(2), half_pp)))
        if all(b.stage_of(rows[p][p]).depends_on_state for p in range(3)):
            trace = b.add([t[m][m] for m in range(3)])
            rows[2][2] = b.add((trace, -rows[0][0], -rows[1][1]))
        for p in range(3):
            for q in range(p + 1, 3):
                rows[p][q] = rows[q][p] = b.add(
                    (b.mul(x[p], a[q]), b.mul(x[q], a[p]), b.mul(y[p], c[q]), b.mul(y[q], c[p]))
                )
        return matrix(lambda p, q: rows[p][q])
