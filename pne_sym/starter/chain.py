"""A leg of plausible size from its letters, for a given choice of axes.

The leg frame has x along the leg at zero displacements.  Links are bars along x, telescopes of
cylinder and rod, and carriages; angles at home keep the leg bent, so that nothing is aligned.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from pne_sym.model.joint_kinds import JointKind
from pne_sym.starter.notation import LegGroup, Letter

Axes = tuple[str, ...]
Plain = dict[str, Any]
"""A table as the file will have it."""

BEND = (0.9, -1.2, 0.8, -0.9, 0.7, -0.6, 0.5)
LENGTHS = {0: 0.6, 1: 0.7, 2: 0.45, 3: 0.35}
CYLINDER: Plain = {
    "mass": 2.4,
    "centre_of_mass": [0.18, 0.0, 0.0],
    "inertia": [0.001, 0.026, 0.026],
}
ROD: Plain = {"mass": 1.1, "centre_of_mass": [-0.22, 0.0, 0.0], "inertia": [0.0005, 0.018, 0.018]}
CARRIAGE: Plain = {"mass": 2.0, "inertia": [0.004, 0.004, 0.004]}
SHOULDER: Plain = {
    "mass": 1.5,
    "centre_of_mass": [0.06, 0.0, 0.0],
    "inertia": [0.002, 0.004, 0.004],
}
SHORT = 0.12
PITCH = 0.1


@dataclass(frozen=True)
class WrittenJoint:
    """A joint as the file will have it.

    Attributes:
        fields: kind, axis or axes, offset, pitch, link.
        home: displacement of each degree of freedom; what a mirrored leg negates is in `mirrored`.
        mirrored: for each degree of freedom, whether a mirrored leg has the opposite sign.
        comment: what it is, for people.
        letter: of the notation.
    """

    fields: Plain
    home: tuple[float, ...]
    mirrored: tuple[bool, ...]
    comment: str
    letter: Letter


@dataclass(frozen=True)
class Chain:
    """The joints of a leg, and where the platform joint sits on its last link (m, along x)."""

    joints: tuple[WrittenJoint, ...]
    end: float


def build_chain(
    group: LegGroup, axes: tuple[Axes, ...], side: float, *, concentric: bool, straight: bool
) -> Chain:
    """The chain for one choice of axes.

    Args:
        group: the legs.
        axes: of every joint.
        side: how far legs lean to the side at home, rad.
        concentric: all axes pass through one point.
        straight: an extensible leg does not lean at all.
    """
    letters = group.letters
    bars = _bars(letters, axes)
    length = LENGTHS.get(bars, 0.3)
    joints: list[WrittenJoint] = []
    gap, bends = 0.0, 0
    for index, (letter, own) in enumerate(zip(letters, axes, strict=True)):
        telescope = _is_telescope(letters, axes, index)
        after = _is_telescope(letters, axes, index + 1)
        bend = BEND[bends % len(BEND)] if bars > 1 else 0.0 if straight else 0.35
        place = _Place(length, telescope, after, bend, 0.0 if straight else side)
        joint, gap_after = _joint(letter, own, gap, place)
        bends += not letter.kind.slides and any(axis != "x" for axis in own)
        joints.append(joint)
        gap = 0.0 if concentric else gap_after
    return Chain(tuple(joints), gap)


def scaled(chain: Chain, factor: float) -> Chain:
    """The chain with all lengths multiplied; masses with them, as of bars of equal thickness."""
    joints = []
    for joint in chain.joints:
        fields = {**joint.fields, "link": _scaled_link(joint.fields["link"], factor)}
        if "offset" in fields:
            fields["offset"] = _times(fields["offset"], factor)
        slides = [part.slides and not part.pitched for part in joint.letter.kind.parts]
        home = [round(x * factor, 6) if s else x for x, s in zip(joint.home, slides, strict=True)]
        joints.append(replace(joint, fields=fields, home=tuple(home)))
    return Chain(tuple(joints), round(chain.end * factor, 6))


def _scaled_link(link: Plain, factor: float) -> Plain:
    powers = {"mass": 1, "centre_of_mass": 1, "inertia": 3}
    return {name: _times(value, factor ** powers[name]) for name, value in link.items()}


def _times(value: Any, factor: float) -> Any:
    if isinstance(value, list):
        return [_times(item, factor) for item in value]
    return float(f"{value * factor:.4g}")


@dataclass(frozen=True)
class _Place:
    length: float
    telescope: bool
    before_telescope: bool
    bend: float
    side: float


def _joint(letter: Letter, axes: Axes, gap: float, place: _Place) -> tuple[WrittenJoint, float]:
    """A joint and how far along x of its link the next one sits."""
    kind = letter.kind
    fields: Plain = {"kind": kind.letter}
    if kind.crossed:
        fields["axes"] = list(axes)
    else:
        fields["axis"] = axes[0]
    if gap:
        fields["offset"] = [gap, 0.0, 0.0]
    if kind.pitched:
        fields["pitch"] = PITCH
    own = axes if kind.crossed else axes * len(kind.parts)
    homes = [_home(part, axis, place) for part, axis in zip(kind.parts, own, strict=True)]
    home, mirrored = (tuple(values) for values in zip(*homes, strict=True))
    link, text, after = _sliding_link(place) if kind.slides else _turning_link(axes, place)
    fields["link"] = link
    return WrittenJoint(fields, home, mirrored, f"{kind.comment} {text}", letter), after


def _home(kind: JointKind, axis: str, place: _Place) -> tuple[float, bool]:
    """Displacement of a degree of freedom, and whether mirrored legs have the opposite."""
    if kind.slides:
        way = place.length if place.telescope else 0.1
        return round(way / kind.advance(PITCH), 6), False
    if axis == "z":
        return place.bend, False
    return (place.side, True) if axis == "y" else (0.2, True)


def _sliding_link(place: _Place) -> tuple[Plain, str, float]:
    if place.telescope:
        return ROD, "The link is the rod, whose frame slides with the joint.", 0.0
    if place.before_telescope:
        return CYLINDER, "The link is the cylinder, x along it.", 0.0
    return CARRIAGE, "The link is the carriage.", 0.0


def _turning_link(axes: Axes, place: _Place) -> tuple[Plain, str, float]:
    if place.before_telescope:
        return CYLINDER, "The link is the cylinder, x along the leg.", 0.0
    if axes == ("x",):
        return SHOULDER, "The link is short, x along it.", SHORT
    length = place.length
    mass = round(2.4 * length, 2)
    across = round(mass * length**2 / 12 + 0.0005, 4)
    link: Plain = {
        "mass": mass,
        "centre_of_mass": [round(length / 2, 4), 0.0, 0.0],
        "inertia": [0.0005, across, across],
    }
    return link, "The link is a bar, x along it.", length


def _bars(letters: tuple[Letter, ...], axes: tuple[Axes, ...]) -> int:
    """How many long links there are: telescopes, and bars beyond a joint that bends."""
    found = 0
    for index, (letter, own) in enumerate(zip(letters, axes, strict=True)):
        bends = not letter.kind.slides and any(axis != "x" for axis in own)
        if _is_telescope(letters, axes, index) or (
            bends and not _is_telescope(letters, axes, index + 1)
        ):
            found += 1
    return found


def _is_telescope(letters: tuple[Letter, ...], axes: tuple[Axes, ...], index: int) -> bool:
    """Whether a joint slides along a leg that a joint before it turns."""
    if not 0 < index < len(letters) or not letters[index].kind.slides:
        return False
    turning = not letters[index - 1].kind.slides and axes[index - 1] != ("x",)
    return turning and axes[index] == ("x",)
