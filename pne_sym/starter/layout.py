"""The arrangement of legs: of a few usual ones, one whose actuators hold the platform well."""

from __future__ import annotations

import contextlib
import itertools
import warnings
from collections.abc import Iterator
from dataclasses import dataclass

from pne_sym.mechanics.mobility import actuation_quality
from pne_sym.model.errors import SpecError, SpecNote, SpecWarning
from pne_sym.model.joint_kinds import WrittenJoint
from pne_sym.model.kind import Kind
from pne_sym.model.legs import is_plane
from pne_sym.model.manipulator import Manipulator, Space
from pne_sym.model.platform_kinds import PlatformJointKind
from pne_sym.model.reader import from_mapping
from pne_sym.starter.actuators import Flags, choose_actuators, other_actuators
from pne_sym.starter.chain import Plain
from pne_sym.starter.choose import Shape, choose_shape, in_space
from pne_sym.starter.notation import SOURCE, LegGroup, fault, is_guide, is_marked
from pne_sym.starter.place import CORNER, HEIGHT, Placed, leg_names, place_legs, stretch
from pne_sym.starter.points import Points

HOME_X: dict[Space, list[float]] = {
    Space.POINT: [0.0, 0.0],
    Space.PLANAR: [0.0, 0.0, 0.0],
    Space.SPATIAL: [0.0, 0.0, 0.75, 0.0, 0.0, 0.0, 1.0],
    Space.TRANSLATIONAL: [0.0, 0.0, 0.75],
    Space.SPHERICAL: [0.0, 0.0, 0.0, 1.0],
}
_TILTS = (30.0, 60.0, -30.0, 90.0, 0.0, 15.0)
_SIDES = (-0.45, 0.45, 0.25, 0.7)
_HELD = 1e-6
_GOOD = 0.15


@dataclass(frozen=True)
class Plan:
    """A specification in the making.

    Attributes:
        groups: of the notation.
        shapes: of a leg of each group.
        actuators: for each group, whether each degree of freedom is actuated.
        spec: as plain data.
    """

    groups: tuple[LegGroup, ...]
    shapes: tuple[Shape, ...]
    actuators: tuple[Flags, ...]
    spec: Plain


def default_space(groups: tuple[LegGroup, ...]) -> Space:
    """The plane where all joints can move in it and legs are short; else space."""
    flat = all(
        group.platform is PlatformJointKind.REVOLUTE
        and group.dofs <= 3
        and all(letter.kind.in_plane for letter in group.letters)
        for group in groups
    )
    return Space.PLANAR if flat else Space.SPATIAL


def make_plan(
    name: str,
    title: str,
    groups: tuple[LegGroup, ...],
    space: Space,
    points: Points | None = None,
) -> Plan:
    """The arrangement, of a few usual ones, whose actuators hold the platform best.

    Raises:
        SpecError: the legs do not fit the space, or their degrees of freedom are dependent.
    """
    _check_letters(groups, space)
    draft = _Draft(name, title, groups, space, points)
    best = _first_good(draft.plans(None))
    if best[0] < _HELD and not is_marked(groups):
        other = _first_good(draft.plans(best[1]))
        best = other if other[0] >= _HELD else best
    return best[1]


def _first_good(plans: Iterator[tuple[float, Plan]]) -> tuple[float, Plan]:
    """The first plan whose actuators hold the platform well, else the best."""
    best = next(plans)
    for found in plans:
        if best[0] >= _GOOD:
            break
        if found[0] > best[0] + _HELD:
            best = found
    return best


@dataclass(frozen=True)
class _Draft:
    """What is asked for, and the arrangements that are tried for it."""

    name: str
    title: str
    groups: tuple[LegGroup, ...]
    space: Space
    points: Points | None = None

    def plans(self, poor: Plan | None) -> Iterator[tuple[float, Plan]]:
        """Arrangements with how well the actuators hold the platform.

        Args:
            poor: a plan whose actuators do not; then others are tried.
        """
        plane = is_plane(self.space)
        for side in _SIDES[:1] if plane else _SIDES:
            shapes = tuple(self._shape(group, side) for group in self.groups)
            if self.points:
                shapes = stretch(self.groups, shapes, self.points)
            if poor:
                actuators = list(other_actuators(poor.actuators, shapes))
            else:
                actuators = choose_actuators(self.groups, shapes, self._free(shapes))
            for (tilt, mirror), actuated in itertools.product(_options(self.space), actuators):
                spec, found = self._made(shapes, actuated, tilt, mirror=mirror)
                yield actuation_quality(found), Plan(self.groups, shapes, actuated, spec)

    def _shape(self, group: LegGroup, side: float) -> Shape:
        """A leg; a guide is straight if its degrees of freedom are independent so."""
        if is_guide(group, self.groups):
            with contextlib.suppress(SpecError):
                return choose_shape(group, self.space, side=side, straight=True)
        return choose_shape(group, self.space, side=side)

    def _made(
        self, shapes: tuple[Shape, ...], actuators: tuple[Flags, ...], tilt: float, *, mirror: bool
    ) -> tuple[Plain, Manipulator]:
        """The specification, with a home that closes, and what it describes."""
        legs = place_legs(
            self.groups, shapes, self.space, tilt=tilt, mirror=mirror, points=self.points
        )
        spec = self._spec(shapes, actuators, legs)
        if not self.points:
            return spec, _read(spec)
        if self.space is Space.SPHERICAL:
            spec["fixed_centre"] = [0.0, 0.0, self.points.height]
        elif not is_plane(self.space):
            spec["home"]["X"][2] = self.points.height
        found = _closed(spec)
        ends = list(itertools.accumulate((len(leg.joints) for leg in found.legs), initial=0))
        X = [round(x, 12) for x in found.home.X]
        q = [[round(x, 9) for x in found.home.q[a:b]] for a, b in itertools.pairwise(ends)]
        spec["home"] = {"X": X, "q": q}
        return spec, found

    def _free(self, shapes: tuple[Shape, ...]) -> Manipulator:
        """The mechanism without any actuator."""
        tilt, mirror = next(_options(self.space))
        none = tuple((False,) * len(shape.extra) for shape in shapes)
        return self._made(shapes, none, tilt, mirror=mirror)[1]

    def _spec(
        self, shapes: tuple[Shape, ...], actuators: tuple[Flags, ...], legs: list[Placed]
    ) -> Plain:
        plane, names = is_plane(self.space), leg_names(self.groups)
        types = {
            name: _leg_type(group, shape, actuated, plane=plane)
            for name, group, shape, actuated in zip(
                names, self.groups, shapes, actuators, strict=True
            )
        }
        by_name = dict(zip(names, shapes, strict=True))
        extra = [
            value
            for leg in legs
            for value, is_extra in zip(leg.q, by_name[leg.table["type"]].extra, strict=True)
            if is_extra
        ]
        spec: Plain = {
            "name": self.name,
            "title": self.title,
            "space": str(self.space),
            "gravity": [0.0, -9.81] if plane else [0.0, 0.0, -9.81],
        }
        if self.space is Space.SPHERICAL:
            spec["fixed_centre"] = [0.0, 0.0, HEIGHT]
        spec["platform"] = _platform(self.space)
        spec["leg_types"] = types
        spec["legs"] = [leg.table for leg in legs]
        spec["home"] = {"X": HOME_X[self.space] + extra, "q": [list(leg.q) for leg in legs]}
        return spec


def _closed(spec: Plain) -> Manipulator:
    """The legs closed near their usual bend, or as they can be."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpecWarning)
        warnings.simplefilter("ignore", SpecNote)
        try:
            return from_mapping(spec, SOURCE)
        except SpecError:
            return from_mapping({**spec, "home": {"X": spec["home"]["X"]}}, SOURCE)


def _read(spec: Plain) -> Manipulator:
    with warnings.catch_warnings():
        warnings.simplefilter("error", SpecWarning)
        return from_mapping(spec, SOURCE)


def _options(space: Space) -> Iterator[tuple[float, bool]]:
    """Tilts of the legs, degrees, and whether every other leg is mirrored."""
    if is_plane(space):
        return itertools.product(_TILTS, (False,))
    tilts = (0.0, 90.0 - CORNER, CORNER) if space is Space.TRANSLATIONAL else (0.0,)
    return itertools.product(tilts, (True, False))


def _check_letters(groups: tuple[LegGroup, ...], space: Space) -> None:
    if not is_plane(space):
        return
    for group in groups:
        kinds: list[Kind] = [*(letter.kind for letter in group.letters), group.platform]
        wrong = [kind.letter for kind in kinds if not kind.in_plane]
        if wrong:
            flat = " and ".join(kind.letter for kind in WrittenJoint if kind.in_plane)
            raise fault(
                f"joint {wrong[0]!r} of {group.plain} leaves the plane",
                f"joints {flat} in the space '{space}', or another --space",
            )


def _platform(space: Space) -> Plain:
    if space is Space.POINT:
        return {"mass": 0.5}
    if is_plane(space):
        return {"mass": 4.0, "centre_of_mass": [0.0, 0.0], "inertia": 0.05}
    return {"mass": 12.0, "centre_of_mass": [0.0, 0.0, 0.04], "inertia": [0.35, 0.35, 0.6]}


def _leg_type(group: LegGroup, shape: Shape, actuated: Flags, *, plane: bool) -> Plain:
    end: Plain = {"kind": group.platform.letter}
    if shape.chain.end:
        end["offset"] = [shape.chain.end, 0.0] if plane else [shape.chain.end, 0.0, 0.0]
    if shape.axis_link:
        end["axis_link"] = shape.axis_link
    joints, at = [], 0
    for written in shape.chain.joints:
        size = len(written.letter.kind.parts)
        fields = {**in_space(written.fields, plane)}
        link = fields.pop("link")
        for mark, values in (("actuated", actuated), ("extra", shape.extra)):
            own = list(values[at : at + size])
            if any(own):
                fields[mark] = own[0] if size == 1 else own
        joints.append({**fields, "link": link})
        at += size
    return {"platform_joint": end, "joints": joints}
