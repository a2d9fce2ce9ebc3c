"""A mechanism in space as a picture: solids by kind of joint, painted far to near."""

from __future__ import annotations

import math

import numpy as np

from pne_sym.drawing import style
from pne_sym.drawing.frames import Plate, base_plate, frame_solids, platform_plate
from pne_sym.drawing.order import painted
from pne_sym.drawing.scene import Bar, LegScene, Part, Scene, Slide, Turn
from pne_sym.drawing.shapes import Label, Picture, Shape
from pne_sym.drawing.solids import Solid, ball, box, cylinder, perpendiculars
from pne_sym.drawing.view import View
from pne_sym.model.kind import Look
from pne_sym.model.kinematics import Array

_THREADS = 11
_CROWDED = 8.0


def spatial_picture(scene: Scene, view: View, ground: Scene | None = None) -> Picture:
    """The picture of a mechanism in space.

    Args:
        scene: the mechanism.
        view: where it is looked at from.
        ground: the scene that the base is laid out for; default the same.
    """
    ground = ground or scene
    sizes = style.proportions(ground)
    plate = base_plate(ground, view, sizes)
    solids = list(plate.solids)
    for leg, laid_out in zip(scene.legs, ground.legs, strict=True):
        solids += _Leg(leg, view, sizes, laid_out.parts[0]).solids()
    solids += platform_plate(scene, view, sizes, plate.normal)
    frames, labels = frame_solids(scene, view, sizes)
    shapes = [shape for solid in painted(solids + frames, view) for shape in solid.shapes]
    return Picture(tuple(shapes), (*labels, *_numbers(ground, view, plate, sizes)), ())


def _numbers(scene: Scene, view: View, plate: Plate, sizes: style.Proportions) -> list[Label]:
    """The legs' numbers, off the rim of the base plate, or beside the posts where there is none."""
    bases = np.array([leg.base for leg in scene.legs])
    feet, rim_at = bases, 1.5 * sizes.joint
    if np.isfinite(plate.top):
        rim_at = 4.0 * sizes.joint
        feet = bases - np.outer(bases @ plate.normal - plate.top, plate.normal)
    away = feet - feet.mean(axis=0)
    labels = []
    for number, (foot, direction) in enumerate(zip(feet, away, strict=True), start=1):
        unit = direction / (float(np.linalg.norm(direction)) or 1.0)
        rim = view.flat(foot + rim_at * unit)
        off = view.flat(unit)
        x, y = 10.0 * off / (float(np.linalg.norm(off)) or 1.0)
        if y > 2.0:  # behind the leg: beside its foot
            rim, x, y = view.flat(foot), math.copysign(12.0, x), 2.0
        below = 5.0 if y < 0.0 else 0.0  # the plate's side is seen in front
        labels.append(Label(rim, str(number), (x, y - below), style.LABEL, 7.0, balloon=True))
    return labels


class _Leg:
    """The solids of a leg."""

    def __init__(self, leg: LegScene, view: View, sizes: style.Proportions, rail: Part) -> None:
        self.leg, self.view, self.sizes, self.rail = leg, view, sizes, rail
        self.crowded = sizes.apart < _CROWDED * sizes.joint

    def solids(self) -> list[Solid]:
        """All parts, from the base."""
        result: list[Solid] = []
        for index, part in enumerate(self.leg.parts):
            if isinstance(part, Bar):
                result.append(self._rod(part.start, part.end, self.sizes.link, style.LINK))
            elif isinstance(part, Slide):
                result += self._rail(part, index) if part.grounded else self._strut(part)
            else:
                result += self._turn(part, index)
        return result

    def _rod(self, start: Array, end: Array, radius: float, colour: str) -> Solid:
        return cylinder(self.view, start, end, radius, style.Paint(colour))

    def _turn(self, turn: Turn, index: int) -> list[Solid]:
        r, view = self.sizes.joint, self.view
        paint = style.joint_paint(actuated=any(turn.actuated), extra=turn.extra)
        bias = 2.0 * r if index == len(self.leg.parts) - 1 else 0.0
        if turn.look is Look.BALL:
            return [ball(view, turn.point, 1.3 * r, paint, bias)]
        if turn.look is Look.BLOCK:
            halves = tuple(0.9 * r * axis for axis in np.eye(3))
            return [
                box(view, turn.point, (halves[0], halves[1], halves[2]), style.Paint(style.LINK))
            ]
        if turn.look is Look.PIN:
            point, half = turn.point + self._aside(turn, index), 1.7 * r * turn.axes[0]
            return [cylinder(view, point - half, point + half, 1.2 * r, paint, 1.5 * r + bias)]
        pins = []
        for axis, actuated in zip(turn.axes, turn.actuated, strict=True):
            own = style.joint_paint(actuated=actuated, extra=turn.extra)
            half = 2.1 * r * axis
            ends = turn.point - half, turn.point + half
            pins.append(cylinder(view, *ends, 0.75 * r, own, r + bias))
        return [*pins, ball(view, turn.point, 0.95 * r, style.Paint(paint.fill), bias)]

    def _aside(self, turn: Turn, index: int) -> Array:
        """Where another joint sits at the same point, a spin joint is shown along its axis."""
        parts, r = self.leg.parts, self.sizes.joint
        neighbours = [parts[k] for k in (index - 1, index + 1) if 0 <= k < len(parts)]
        if not any(
            isinstance(other, Turn) and float(np.linalg.norm(other.point - turn.point)) < r
            for other in neighbours
        ):
            return np.zeros(3)
        for other in neighbours:
            if isinstance(other, Turn):
                continue
            middle = 0.5 * (other.start + other.end) - turn.point
            if abs(float(middle @ turn.axes[0])) > 0.999 * float(np.linalg.norm(middle)) > 0.0:
                shift: Array = 3.6 * r * middle / np.linalg.norm(middle)
                return shift
        return np.zeros(3)

    def _strut(self, slide: Slide) -> list[Solid]:
        """A tube and the rod in it; the actuator is the collar at the tube's mouth."""
        r, view = self.sizes.joint, self.view
        mouth, step = slide.mouth, slide.outwards
        paint = style.joint_paint(actuated=slide.actuated, extra=slide.extra)
        ends = mouth - 2.6 * r * step, mouth + 0.6 * r * step
        collar = cylinder(view, *ends, 1.45 * r, paint, 1.2 * r)
        rod = self._rod(mouth, slide.end, 0.5 * r, style.LINK)
        if slide.helical:
            rod = self._threaded(rod, mouth, slide.end)
        return [self._rod(slide.start, mouth, 1.05 * r, style.TUBE), rod, collar]

    def _threaded(self, rod: Solid, start: Array, end: Array) -> Solid:
        """The rod with its thread."""
        a, b = self.view.flat(start), self.view.flat(end)
        along = b - a
        across = 0.62 * self.sizes.joint * np.array([-along[1], along[0]])
        across /= float(np.linalg.norm(along)) or 1.0
        lean = 0.35 / _THREADS * along
        turns = []
        for k in range(1, _THREADS):
            middle = a + k / _THREADS * along
            line = np.array([middle - across - lean, middle + across + lean])
            turns.append(Shape(line, "", style.OUTLINE, 0.9, closed=False))
        return Solid(rod.outline, (*rod.shapes, *turns), rod.core, rod.bias)

    def _rail(self, slide: Slide, index: int) -> list[Solid]:
        """A rail on the base and what slides on it: a carriage beside the next joint, or a sleeve.

        Rails that stand close together have sleeves.
        """
        r = self.sizes.joint
        down = np.zeros(3) if self.crowded else self._away(slide, index) * 1.9 * r
        rail = self.rail
        assert isinstance(rail, Slide)
        sense = slide.axis if float((rail.end - rail.start) @ slide.axis) >= 0.0 else -slide.axis
        start, end = rail.start - 2.0 * r * sense, rail.end + 4.0 * r * sense
        paint = style.joint_paint(actuated=slide.actuated, extra=slide.extra)
        rod = self._rod(start + down, end + down, 0.7 * r, style.BASE)
        if self.crowded:
            half = 3.2 * r * slide.axis
            ends = slide.end - half, slide.end + half
            return [rod, cylinder(self.view, *ends, 1.35 * r, paint, r)]
        side = np.cross(slide.axis, down)
        side *= 1.5 * r / float(np.linalg.norm(side))
        halves = (2.2 * r * slide.axis, side, 0.45 * down)
        return [rod, box(self.view, slide.end + down, halves, paint)]

    def _away(self, slide: Slide, index: int) -> Array:
        """Unit vector across the rail, away from the next link."""
        points = [
            part.point if isinstance(part, Turn) else part.end
            for part in self.leg.parts[index + 1 :]
        ]
        for point in points:
            link = slide.end - point
            across = link - (link @ slide.axis) * slide.axis
            length = float(np.linalg.norm(across))
            if length > self.sizes.joint:
                unit: Array = across / length
                return unit
        return perpendiculars(slide.axis)[0]
