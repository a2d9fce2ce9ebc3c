"""Frames as people know them: axes fixed in bodies, and what is given in them.

The program works in further frames, turned to joints' axes; what is given in one of those is told
here in the axes of its body, which are those of the specification.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp

from pne_sym.vector import Compose, Identity, Outer, Skew, Vector, vector_sum

if TYPE_CHECKING:
    from pne_sym.derivation.derivation import Derivation
    from pne_sym.derivation.equation import Equation
    from pne_sym.derivation.quantity import Frame, Given


@dataclass(frozen=True)
class BodyFrame:
    """Axes fixed in a body.

    Attributes:
        frame: name of the frame.
        body: what it is fixed in, in words.
        symbol: tensor that turns components in these axes into base axes; None for base axes.
        equation: defines the tensor; None where it is given.
        leg_type: of a link, the leg type; else "".
        axis: about which a link turns against the one before it, fixed in both.
        before: frame of that one.
    """

    frame: str
    body: str
    symbol: Any = None
    equation: Equation | None = None
    leg_type: str = ""
    axis: Any = None
    before: str = ""


def turned_about(axis: Vector, angle: Any) -> Any:
    """Rotation about an axis."""
    cosine, sine = sp.cos(angle), sp.sin(angle)
    return cosine * Identity + sine * Skew(axis) + (1 - cosine) * Outer(axis, axis)


def of_quaternion(vector: Vector, scalar: Any, square: Any) -> Any:
    """Rotation of a quaternion of any length: vector part, scalar part, squared length."""
    tilde = Skew(vector)
    return Identity + (2 / square) * (scalar * tilde + Compose(tilde, tilde))


class BodyAxes:
    """What is given, in axes of the bodies."""

    def __init__(self, derivation: Derivation) -> None:
        self.bodies: dict[str, BodyFrame] = {b.frame: b for b in derivation.body_frames}
        self.frames: Mapping[str, Frame] = {f.name: f for f in derivation.frames}
        self.givens = {g.symbol: g for g in derivation.givens}
        self.turning = {b.axis: b for b in derivation.body_frames if b.axis is not None}

    def of(self, given: Given) -> tuple[BodyFrame, tuple[Any, ...] | Vector]:
        """The body in which it is fixed; components in its axes, or else a vector fixed in it."""
        body, axes = self.axes(given.frame)
        if given.symbol in self.turning:  # the same in both links: known before the angle is
            body = self.bodies[self.turning[given.symbol].before]
            own = _combined(given.components, axes)
            return body, self.givens[own].components if isinstance(own, Vector) else own
        if given.frame == body.frame or len(given.components) != 3:
            return body, given.components
        return body, _combined(given.components, axes)

    def axes(self, frame: str) -> tuple[BodyFrame, Sequence[Any]]:
        """The body in which a frame is fixed, and its axes there: components, or vectors."""
        if frame in self.bodies:
            return self.bodies[frame], [_unit(k) for k in range(3)]
        found = self.frames[frame]
        if found.angle is not None:
            child = next(f for f in self.frames.values() if f.parent == frame)
            return self.bodies[child.name], found_axes(child, child.rows, by_row=True)
        assert found.parent is not None
        body, outer = self.axes(found.parent)
        own = found_axes(found, found.axes, by_row=False)
        return body, [a if isinstance(a, Vector) else _combined(a, outer) for a in own]

    def worked_in(self, leg_type: str) -> Iterator[tuple[str, BodyFrame, Sequence[Any]]]:
        """Frames of a leg type in which the program works besides: name, body, axes there."""
        for name in self.frames:
            body, axes = self.axes(name)
            own = body.leg_type == leg_type and name not in self.bodies
            if own and list(axes) != [_unit(k) for k in range(3)]:
                yield name, body, axes


def found_axes(frame: Frame, vectors: Any, *, by_row: bool) -> list[Any]:
    """Axes of a frame or of its parent, by rows or columns of its rotation."""
    if vectors is not None:
        return list(vectors)
    assert frame.rotation is not None
    entries = list(map(sp.sympify, frame.rotation))
    if by_row:
        return [tuple(entries[3 * k : 3 * k + 3]) for k in range(3)]
    return [tuple(entries[k::3]) for k in range(3)]


def _unit(k: int) -> tuple[Any, ...]:
    return tuple(sp.Integer(int(i == k)) for i in range(3))


def _combined(components: Sequence[Any], axes: Sequence[Any]) -> Any:
    """Components times axes, summed."""
    if any(isinstance(axis, Vector) for axis in axes):
        pairs = zip(components, axes, strict=True)
        return vector_sum(c * axis for c, axis in pairs if c != 0)
    return tuple(
        sp.Add(*(c * axis[i] for c, axis in zip(components, axes, strict=True))) for i in range(3)
    )


def rotations_by_place(derivation: Derivation) -> dict[tuple[str, int], list[Equation]]:
    """(chapter, number of equations before) -> rotations known there: as early as can be."""
    places: dict[tuple[str, int], list[Equation]] = {}
    waiting = list(derivation.rotations())
    unknown = {e.name for e in (*derivation.equations(), *waiting)}
    for chapter in derivation.chapters:
        for at in range(len(chapter.equations) + 1):
            if at:
                unknown.discard(chapter.equations[at - 1].name)
            if not chapter.id.endswith("-G"):
                ready = list(_ready(waiting, unknown, derivation, chapter.leg_type))
                if ready:
                    places[chapter.id, at] = ready
    assert not waiting, [e.name for e in waiting]
    return places


def _ready(
    waiting: list[Equation], unknown: set[str], derivation: Derivation, leg_type: str | None
) -> Iterator[Equation]:
    """Takes those of a chapter's owner off the list that need nothing unknown."""
    for equation in list(waiting):
        own = derivation.notation[equation.name].leg_type == (leg_type or "")
        if own and not unknown & set(equation.uses):
            waiting.remove(equation)
            unknown.discard(equation.name)
            yield equation
