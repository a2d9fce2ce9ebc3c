"""Choice of axes and extra joints of a leg, so that it is regular at home."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from pne_sym.model.closure import leg_residual
from pne_sym.model.entry import Entry
from pne_sym.model.joint_kinds import WrittenJoint
from pne_sym.model.joints import read_joint
from pne_sym.model.kinematics import Pose, chain_pose
from pne_sym.model.leg_types import a_leg
from pne_sym.model.legs import is_plane
from pne_sym.model.manipulator import (
    IDENTITY3,
    ZERO3,
    Joint,
    Leg,
    PlatformJoint,
    PlatformJointKind,
    Space,
)
from pne_sym.starter.chain import Axes, Chain, Plain, build_chain
from pne_sym.starter.notation import SOURCE, LegGroup, fault

Array = npt.NDArray[np.float64]

GOOD = 0.2
"""Independence of a leg's degrees of freedom (0 dependent, 1 orthogonal) that ends the search."""
LEAST = 0.02
_MOST_TRIED = 3000
_DIRECTIONS = dict(zip("xyz", IDENTITY3, strict=True))


@dataclass(frozen=True)
class Shape:
    """A leg at home in its own frame.

    Attributes:
        chain: its joints as written.
        extra: degrees of freedom that are coordinates of their own.
        idle: those of them that do not move the platform joint at all.
        axis_link: of a platform joint U or R in space, name of a direction.
        axis_leg: the platform's axis of it, in the leg frame.
        tip: the platform joint in the leg frame, m.
        last: axes of the last link in the leg frame.
        concentric: all axes pass through the fixed centre.
        is_welded: the platform joint is rigid.
        mirrored: whether this is the mirror image.
    """

    chain: Chain
    extra: tuple[bool, ...]
    idle: int
    axis_link: str
    axis_leg: Array
    tip: Array
    last: Array
    concentric: bool = False
    is_welded: bool = False
    mirrored: bool = False

    @property
    def home(self) -> tuple[float, ...]:
        """Displacements of all degrees of freedom."""
        return displacements(self.chain, mirrored=self.mirrored)


def is_concentric(group: LegGroup, space: Space) -> bool:
    """Whether all axes of a leg pass through the fixed centre, as those of hinges alone must."""
    hinges = all(not letter.kind.slides for letter in group.letters)
    return space is Space.SPHERICAL and hinges and group.platform.moments > 0


def choose_shape(group: LegGroup, space: Space, *, side: float, straight: bool = False) -> Shape:
    """The first usual choice of axes whose degrees of freedom are well independent, else the best.

    Where the platform does not turn, one that leaves all of its motions free comes first.

    Raises:
        SpecError: degrees of freedom that are always dependent, or too few marked extra.
    """
    plane, concentric = is_plane(space), is_concentric(group, space)
    best: tuple[float, Shape] | None = None
    tried = itertools.islice(_candidates(group, plane=plane), _MOST_TRIED)
    for axes, axis_link in tried:
        chain = build_chain(group, axes, side, concentric=concentric, straight=straight)
        score, shape = _judged(group, chain, axis_link, space)
        if best is None or score > best[0] + 1e-9:
            best = (score, shape)
        if score >= GOOD:
            break
    assert best is not None
    if best[0] < LEAST:
        raise fault(
            f"the degrees of freedom of {a_leg(group.plain)} are dependent however its axes "
            "are laid",
            "a chain without superfluous joints, or the surplus marked extra by *",
        )
    return best[1]


def reshaped(shape: Shape, *, mirrored: bool, plane: bool, platform: PlatformJointKind) -> Shape:
    """The same leg or its mirror image, with tip and axes at its own home."""
    tip, frame = _end(shape.chain, plane=plane, mirrored=mirrored)
    axis_leg = _platform_axis(platform, frame, shape.axis_link)
    return replace(shape, axis_leg=axis_leg, tip=tip, last=frame, mirrored=mirrored)


def displacements(chain: Chain, *, mirrored: bool) -> tuple[float, ...]:
    """Displacements of all degrees of freedom at home."""
    return tuple(
        -value if mirrored and flips else value
        for joint in chain.joints
        for value, flips in zip(joint.home, joint.mirrored, strict=True)
    )


def dofs(chain: Chain, *, plane: bool) -> tuple[Joint, ...]:
    """The joints with one degree of freedom each that the written ones stand for."""
    return tuple(
        joint
        for written in chain.joints
        for joint in read_joint(Entry(SOURCE, "", in_space(written.fields, plane)), plane=plane)
    )


def in_space(fields: Plain, plane: bool) -> Plain:
    """The fields as they are, or with what the plane has."""
    if not plane:
        return fields
    link = {**fields["link"], "inertia": fields["link"]["inertia"][2]}
    result = {**fields, "link": link}
    if WrittenJoint(fields["kind"]).implied:
        result.pop("axis", None)
    for table, name in ((result, "offset"), (link, "centre_of_mass")):
        if name in table:
            table[name] = table[name][:2]
    return result


def _candidates(group: LegGroup, *, plane: bool) -> Iterator[tuple[tuple[Axes, ...], str]]:
    """Axes of all joints, and of the platform joint; the first joint varies fastest."""
    kinds = [letter.kind for letter in group.letters]
    choices = [kind.plane_choices if plane else kind.axis_choices for kind in kinds]
    ends = ("y", "z", "x") if not plane and "axis_link" in group.platform.fields else ("",)
    for end in ends:
        for reverse in itertools.product(*reversed(choices)):
            yield tuple(reversed(reverse)), end


def _judged(group: LegGroup, chain: Chain, axis_link: str, space: Space) -> tuple[float, Shape]:
    """Independence of the degrees of freedom, and the shape with its extra joints chosen.

    Legs that hold a platform which does not turn are judged below all others.
    """
    plane = is_plane(space)
    tip, frame = _end(chain, plane=plane, mirrored=False)
    axis_leg = _platform_axis(group.platform, frame, axis_link)
    welded, concentric = "rotation" in group.platform.fields, is_concentric(group, space)
    shape = Shape(chain, (), 0, axis_link, axis_leg, tip, frame, concentric, welded)
    columns, by_twist = _columns(group, shape, plane=plane)
    sides = (columns, np.hstack([columns, by_twist]))
    ranks = [np.linalg.matrix_rank(side, tol=1e-8) for side in sides]
    holds = space is Space.TRANSLATIONAL and bool(ranks[1] > ranks[0])
    sizes = np.linalg.norm(columns, axis=0)
    still = sizes < 1e-9
    columns = columns / np.where(still, 1.0, sizes)
    conditions = 2 if plane else 3 + group.platform.moments
    score, extra = -1.0, (False,) * columns.shape[1]
    for chosen in _extra_sets(group, columns.shape[1], conditions):
        rest = columns[:, [k for k, is_extra in enumerate(chosen) if not is_extra]]
        worst = float(np.linalg.svd(rest, compute_uv=False)[-1]) if rest.size else 0.0
        if worst > score + 1e-9:
            score, extra = worst, chosen
    idle = sum(bool(a and b) for a, b in zip(extra, still, strict=True))
    return (0.1 * score if holds else score), replace(shape, extra=extra, idle=idle)


def _extra_sets(group: LegGroup, count: int, conditions: int) -> Iterator[tuple[bool, ...]]:
    """The marked extra degrees of freedom, or every choice of as many as are surplus."""
    marked = []
    for letter in group.letters:
        marked += [False] * (len(letter.kind.parts) - 1) + [letter.extra]
    surplus = max(0, count - conditions)
    if any(marked):
        if sum(marked) < surplus:
            raise fault(
                f"{count - sum(marked)} degrees of freedom of {a_leg(group.plain)} that are not "
                "marked extra",
                f"at most {conditions}: {surplus} marked by *, or none to have them chosen",
            )
        yield tuple(marked)
        return
    order = [*range(1, count), 0]
    for chosen in itertools.combinations(order, surplus):
        yield tuple(k in chosen for k in range(count))


def _columns(group: LegGroup, shape: Shape, *, plane: bool) -> tuple[Array, Array]:
    """Rates of the residual by joints and by translations, platform parallel to the leg."""
    kind = PlatformJointKind.SPHERICAL if plane else group.platform
    platform = PlatformJoint(kind, (shape.chain.end, 0.0, 0.0))
    if shape.axis_link:
        axes = {"axis_link": _DIRECTIONS[shape.axis_link], "axis_platform": shape.axis_leg.tolist()}
        platform = replace(platform, **axes)
    if "rotation" in kind.fields:
        platform = replace(platform, rotation=shape.last.T.tolist())
    leg = Leg(ZERO3, IDENTITY3, dofs(shape.chain, plane=plane), platform, ZERO3)
    _, by_q, by_twist = leg_residual(leg, np.array(shape.home), Pose(shape.tip, np.eye(3)))
    return (by_q[:2], by_twist[:2, :2]) if plane else (by_q, by_twist[:, :3])


def _end(chain: Chain, *, plane: bool, mirrored: bool) -> tuple[Array, Array]:
    """The platform joint and the last link's axes, in the leg frame at home."""
    end = PlatformJoint(PlatformJointKind.SPHERICAL, (chain.end, 0.0, 0.0))
    leg = Leg(ZERO3, IDENTITY3, dofs(chain, plane=plane), end, ZERO3)
    found = chain_pose(leg, displacements(chain, mirrored=mirrored))
    return found.tip, found.last


def _platform_axis(platform: PlatformJointKind, frame: Array, axis_link: str) -> Array:
    """The axis fixed in the platform: perpendicular to the link's, or the same."""
    if not axis_link:
        return np.zeros(3)
    own: Array = frame @ np.array(_DIRECTIONS[axis_link])
    if not platform.keeps_right_angle:
        return own
    for name in "zyx":
        if abs(own @ np.array(_DIRECTIONS[name])) < 1e-9:
            return np.array(_DIRECTIONS[name])
    other: Array = frame @ np.array(_DIRECTIONS["x" if axis_link == "z" else "z"])
    return other
