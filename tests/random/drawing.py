"""Mechanisms drawn at random: the structure first, then a geometry that closes at a home.

Legs of one plan have one structure (leg type) and geometries of their own.  A drawn geometry
is kept if legs, actuators, constraints and inertia are away from singularities at home.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from pne_sym.model.manipulator import (
    ZERO3,
    Body,
    Home,
    Joint,
    JointKind,
    Leg,
    Manipulator,
    PlatformJoint,
    PlatformJointKind,
    Space,
    Vector3,
)
from tests.oracle.chain import chain_poses
from tests.oracle.closure import OracleError, leg_closure, perpendicular_pair
from tests.oracle.coordinates import (
    extra_indices,
    is_planar,
    passive_extra_rows,
    platform_position,
    platform_rotation,
    quaternion_of_vector,
    rotation_from_quaternion,
    task_size,
)
from tests.oracle.forces import RANK_TOLERANCE, are_held, rank
from tests.oracle.jets import Array, constant
from tests.oracle.projection import project
from tests.oracle.randomisation import matrix3, random_inertia, vector3
from tests.random.central import guided, with_ends_at_origins
from tests.random.effects import with_coupling, with_effects, with_efforts

LEG_QUALITY = 0.06
"""Least reciprocal condition number of a leg's degrees of freedom."""
DRIVE_QUALITY = 0.02
"""Least reciprocal condition number of actuators and constraints together."""
INERTIA_QUALITY = 1e-5
"""Least reciprocal condition number of the inertia matrix that actuators see."""
GUIDED = 25
"""Of so many mechanisms one hangs on a central guide."""

_R, _P, _H = JointKind.REVOLUTE, JointKind.PRISMATIC, JointKind.HELICAL
_S, _END_R = PlatformJointKind.SPHERICAL, PlatformJointKind.REVOLUTE
_END_U, _RIGID = PlatformJointKind.UNIVERSAL, PlatformJointKind.RIGID
_MOMENTS = {_S: 0, _END_U: 1, _END_R: 2, _RIGID: 3}
_AXES = np.eye(3)
_NOWHERE = (False, False, False)

_SPACES = {
    Space.SPATIAL: 0.36,
    Space.PLANAR: 0.2,
    Space.POINT: 0.08,
    Space.TRANSLATIONAL: 0.18,
    Space.SPHERICAL: 0.18,
}
_LEGS = {
    Space.SPATIAL: (1, 8),
    Space.PLANAR: (1, 6),
    Space.POINT: (1, 4),
    Space.TRANSLATIONAL: (1, 6),
    Space.SPHERICAL: (1, 6),
}
_MOST_OF_LIGHT = 4


class NothingDrawn(Exception):
    """No regular geometry was found for a structure."""


@dataclass(frozen=True)
class _JointPlan:
    """Structure of a joint.

    Attributes:
        kind: R, P or H.
        axis: how it is drawn.
        present: which components of the offset there are.
        link: "full", "point" (a mass without inertia) or "none".
        tied: the axis follows from that of the preceding joint: "parallel", "across" or "".
        extra: its displacement is a coordinate of its own.
        turned_in: index of the coordinate direction that a plain axis has, else None.
    """

    kind: JointKind
    turned_in: int | None
    present: tuple[bool, bool, bool]
    link: str
    tied: str = ""
    extra: bool = False


@dataclass(frozen=True)
class _LegPlan:
    """Structure of a leg.

    Attributes:
        joints: from the base.
        end: platform joint.
        present: which components of its offset there are.
        link_axis, platform_axis: a direction's index, or None.
        missing: degrees of freedom that the leg lacks.
        at_origin: it meets the platform at its origin.
    """

    joints: tuple[_JointPlan, ...]
    end: PlatformJointKind
    present: tuple[bool, bool, bool]
    link_axis: int | None
    platform_axis: int | None
    missing: int
    at_origin: bool = False


MOVING = 0.2
"""Of so many mechanisms the base moves."""
COUPLED = 0.3
"""Of so many the motors are coupled."""
BOUNDED = 0.3
"""Of so many the actuators have limits of effort, all or some."""
DOUBLED = 0.25
"""Of so many of those with constraints a leg stands there twice."""


def draw(seed: int, *, light: bool = False, anywhere: bool = True) -> Manipulator:
    """The mechanism of a seed.

    Args:
        seed: of the generator.
        light: few leg types and short chains only, for a quick run.
        anywhere: whether every second mechanism, and nearly all with extra coordinates, have
            actuators anywhere, in any number; False: as many as degrees of freedom, or one or two
            more or less.
    """
    found = _structured(seed, light=light, anywhere=anywhere)
    moves = bool(np.random.default_rng([seed, 5]).random() < MOVING)
    found = doubled(found, np.random.default_rng([seed, 7]))
    found = with_effects(replace(found, moving_base=moves), np.random.default_rng([seed, 4]))
    rng = np.random.default_rng([seed, 6])
    found = with_coupling(found, rng) if rng.random() < COUPLED else found
    rng = np.random.default_rng([seed, 8])
    return with_efforts(found, int(rng.integers(1, 3)), 300.0) if rng.random() < BOUNDED else found


def _structured(seed: int, *, light: bool, anywhere: bool) -> Manipulator:
    if seed % GUIDED == 11:
        return guided(np.random.default_rng([seed, 3]))
    drawn = _drawn(seed, light=light)
    # A generator of its own: geometries stay those of the seed.
    rng = np.random.default_rng([seed, 1])
    if not anywhere or rng.random() < (0.1 if extra_indices(drawn) else 0.5):
        return drawn
    return actuated_anywhere(drawn, rng) or drawn


def _drawn(seed: int, *, light: bool) -> Manipulator:
    rng = np.random.default_rng(seed)
    # Drawn once: spaces where fewer structures are regular are not to become rare.
    space = Space(rng.choice(list(_SPACES), p=list(_SPACES.values())))
    while True:
        try:
            found = _Drawing(rng, space, light=light).run()
            return with_ends_at_origins(found, np.random.default_rng([seed, 2]))
        except NothingDrawn:
            continue


class _Drawing:
    def __init__(self, rng: np.random.Generator, space: Space, *, light: bool) -> None:
        self.rng, self.space, self.light = rng, space, light
        self.planar = is_planar(self.space)
        # How far from the textbook: aligned axes without offsets, or all general.
        self.wild = float(rng.choice([0.0, 0.35, 0.8])) * (0.2 if light else 1.0)

    def run(self) -> Manipulator:
        rng = self.rng
        least, most = _LEGS[self.space]
        most = min(most, _MOST_OF_LIGHT) if self.light else most
        # A single leg is a serial arm; fewer of them are drawn.
        count = int(rng.integers(least + (rng.random() < 0.7), most + 1))
        types = min(
            count,
            1 + int(rng.choice(3, p=[0.95, 0.05, 0.0] if self.light else [0.6, 0.3, 0.1])),
        )
        plans = [self._leg_plan() for _ in range(types)]
        owner = self._owners(plans, count)
        for _ in range(4):
            try:
                found = self._geometry([plans[k] for k in owner])
            except OracleError:
                continue
            marked = self._marks(found, owner)
            if marked is not None:
                return marked
        raise NothingDrawn

    # ---- structure -------------------------------------------------------------------

    def _owners(self, plans: list[_LegPlan], count: int) -> list[int]:
        """Plan of every leg; legs that would leave the platform no freedom are left out."""
        types, owner = len(plans), []
        dofs = task_size(self.space)
        for k in [*range(types), *self.rng.integers(0, types, count - types)]:
            if plans[k].missing < dofs:
                dofs -= plans[k].missing
                owner.append(int(k))
        if not owner:
            raise NothingDrawn
        return sorted(owner)

    def _leg_plan(self) -> _LegPlan:
        rng = self.rng
        if self.space is Space.SPHERICAL and rng.random() < 0.15:
            return self._wrist_plan()
        if self.planar:
            kinds, weights = [_END_R, _S], [0.8, 0.2]
        else:
            kinds = [_S, _END_U, _END_R, _RIGID]
            weights = [0.67, 0.13, 0.1, 0.1] if self.light else [0.55, 0.2, 0.15, 0.1]
        end = kinds[int(rng.choice(len(kinds), p=weights))]
        needed = 2 if self.planar else 3 + _MOMENTS[end]
        if self.light:  # chains of three joints at most
            missing = max(needed - int(rng.integers(2, 4)), int(rng.choice(2, p=[0.8, 0.2])))
            extras = int(rng.choice(2, p=[0.6, 0.4])) if missing == 0 else 0
        else:
            missing = int(rng.choice(4, p=[0.7, 0.16, 0.09, 0.05]))
            extras = int(rng.choice(3, p=[0.76, 0.19, 0.05]))
            extras = min(extras, 6 - max(1, needed - missing))
        length = max(1, needed - missing) + extras
        joints = self._joints(length)
        for index in rng.permutation(length)[:extras]:
            joints[index] = replace(joints[index], extra=True)
        axes = self._direction(), self._direction()
        missing = max(0, needed - length + extras)
        return _LegPlan(tuple(joints), end, self._present(), *axes, missing)

    def _wrist_plan(self) -> _LegPlan:
        """Two or three revolute joints about the fixed centre, and one at the platform."""
        extras = 0 if self.light else int(self.rng.choice(2, p=[0.7, 0.3]))
        joints = [
            _JointPlan(_R, self._direction(), _NOWHERE, self._link(), extra=k < extras)
            for k in range(2 + extras)
        ]
        axes = self._direction(), self._direction()
        return _LegPlan(tuple(joints), _END_R, _NOWHERE, *axes, 0, at_origin=True)

    def _joints(self, length: int) -> list[_JointPlan]:
        rng, joints = self.rng, []
        while len(joints) < length:
            macro = str(rng.choice(["", "U", "C", "S"], p=[0.6, 0.2, 0.1, 0.1]))
            size = {"": 1, "U": 2, "C": 2, "S": 3}[macro]
            if self.planar or len(joints) + size > length:
                macro = ""
            joints += self._part(macro, joints)
        return joints

    def _part(self, macro: str, before: list[_JointPlan]) -> list[_JointPlan]:
        """One joint, or a joint of several degrees of freedom: concurrent, without mass between."""
        first = self._joint(before)
        if not macro:
            return [first]
        if macro == "C":
            kinds = [_R, _P] if self.rng.random() < 0.7 else [_P, _R]
            hollow = replace(first, kind=kinds[0], link="none")
            return [hollow, replace(first, kind=kinds[1], present=_NOWHERE, tied="parallel")]
        parts = [replace(first, kind=_R)]
        for _ in range({"U": 1, "S": 2}[macro]):
            parts[-1] = replace(parts[-1], link="none")
            across = None
            if first.turned_in is not None:
                across = ((parts[-1].turned_in or 0) + int(self.rng.integers(1, 3))) % 3
            parts.append(
                _JointPlan(
                    _R, across, _NOWHERE, self._link(), "" if across is not None else "across"
                )
            )
        return parts

    def _joint(self, before: list[_JointPlan]) -> _JointPlan:
        rng = self.rng
        if self.planar:
            kind = _R if rng.random() < 0.6 else _P
            direction = 2 if kind is _R else self._direction(2)
            return _JointPlan(kind, direction, self._present(), self._link())
        kind = [_R, _P, _H][int(rng.choice(3, p=[0.58, 0.3, 0.12]))]
        tied, direction = "", self._direction()
        if before and rng.random() < 0.25:
            tied = str(rng.choice(["parallel", "across"]))
            last = before[-1].turned_in
            if last is None:
                direction = None
            elif tied == "parallel":
                direction, tied = last, ""
            elif direction == last:
                direction, tied = (last + 1) % 3, ""
        return _JointPlan(kind, direction, self._present(), self._link(), tied)

    def _direction(self, number: int = 3) -> int | None:
        general = self.rng.random() < self.wild
        return None if general else int(self.rng.integers(number))

    def _present(self) -> tuple[bool, bool, bool]:
        """Which components an offset has."""
        rng = self.rng
        likely = [0.5, 0.45, 0.05, 0.0] if self.light else [0.4, 0.3, 0.15, 0.15]
        way = str(rng.choice(["none", "one", "some", "all"], p=likely))
        flags = {
            "none": np.zeros(3),
            "one": np.eye(3)[rng.integers(2 if self.planar else 3)],
            "some": rng.integers(0, 2, 3),
            "all": np.ones(3),
        }[way]
        x, y, z = (bool(flag) for flag in flags)
        return (x, y, z and not self.planar)

    def _link(self) -> str:
        return str(self.rng.choice(["full", "point", "none"], p=[0.65, 0.1, 0.25]))

    # ---- geometry --------------------------------------------------------------------

    def _vector(self, spread: float) -> Vector3:
        vector = self.rng.uniform(-spread, spread, 3)
        return vector3(vector * (1.0, 1.0, 0.0 if self.planar else 1.0))

    def _unit(self, accept: Callable[[Array], bool] = lambda _: True) -> Array:
        """A direction away from the coordinate directions."""
        while True:
            drawn = np.array(self._vector(1.0))
            size = np.linalg.norm(drawn)
            if size > 0.3 and np.abs(drawn).max() < 0.95 * size and accept(drawn / size):
                return np.asarray(drawn / size)

    def _geometry(self, plans: list[_LegPlan]) -> Manipulator:
        """Legs of these plans, closed at a random home, all joints without actuators."""
        rng = self.rng
        point = self.space is Space.POINT
        inertia = random_inertia(rng, 0.05)
        platform = Body(3.0, self._vector(0.1), inertia)
        gravity = self._vector(9.0)
        empty = Manipulator(
            name=f"random_{rng.integers(1_000_000)}",
            title="a random mechanism",
            space=self.space,
            gravity=ZERO3 if rng.random() < 0.08 else gravity,
            platform=Body(mass=3.0) if point else platform,
            legs=(),
            home=Home(X=(), q=()),
            fixed_centre=self._vector(0.2) if self.space is Space.SPHERICAL else None,
        )
        pose = self._pose()
        legs = [self._leg(plan, empty, pose) for plan in plans]
        q = np.concatenate([displacements for _, displacements in legs])
        found = replace(empty, legs=tuple(leg for leg, _ in legs))
        X = np.concatenate([pose, q[extra_indices(found)]])
        return replace(found, home=Home(tuple(map(float, X)), tuple(map(float, q))))

    def _pose(self) -> Array:
        rng = self.rng
        place = rng.uniform(-0.3, 0.3, 3)
        level = rng.random() < 0.3
        turn = quaternion_of_vector(np.zeros(3) if level else rng.uniform(-0.6, 0.6, 3))
        poses: dict[Space, Array] = {
            Space.POINT: place[:2],
            Space.PLANAR: place * (1.0, 1.0, 0.0 if level else 2.0),
            Space.SPATIAL: np.concatenate([place, turn]),
            Space.TRANSLATIONAL: place,
            Space.SPHERICAL: turn,
        }
        return poses[self.space]

    def _leg(self, plan: _LegPlan, empty: Manipulator, pose: Array) -> tuple[Leg, Array]:
        best = 0.0
        for attempt in range(25):
            if attempt > 3 and best < 1e-9:
                raise OracleError("singular by structure")
            leg, q = self._any_leg(plan, empty, pose)
            free = [index for index, joint in enumerate(leg.joints) if not joint.extra]
            jacobian = leg_closure(empty, leg, pose, q).joints[:, free]
            if not free or len(free) > len(jacobian):
                raise OracleError("a leg without or with too many degrees of freedom")
            sizes = np.linalg.norm(jacobian, axis=0)
            if sizes.min() < LEG_QUALITY:
                continue
            values = np.linalg.svd(jacobian, compute_uv=False)
            best = max(best, values.min() / values.max())
            if values.min() > LEG_QUALITY * values.max():
                return leg, q
        raise OracleError("no regular leg")

    def _any_leg(self, plan: _LegPlan, empty: Manipulator, pose: Array) -> tuple[Leg, Array]:
        rng = self.rng
        joints = self._real_joints(plan)
        q = np.array(
            [rng.uniform(0.2, 0.8) if j.kind is _P else rng.uniform(-1.2, 1.2) for j in joints]
        )
        tilt = rng.uniform(-3.0, 3.0, 3) * ((0.0, 0.0, 1.0) if self.planar else (1.0, 1.0, 1.0))
        if rng.random() < 0.2:
            tilt *= 0.0
        frame = rotation_from_quaternion(quaternion_of_vector(tilt))
        at_origin = plan.at_origin or self.space is Space.POINT
        seat = ZERO3 if at_origin else self._vector(0.4)
        end = PlatformJoint(plan.end, offset=self._offset(plan.present))
        leg = Leg(ZERO3, matrix3(frame), joints, end, seat)
        rotation = platform_rotation(empty, pose)
        last = chain_poses(replace(leg, base_frame=matrix3(_AXES)), constant(q))[-1].rotation.value
        if not self.planar and plan.end is not _S:
            leg = self._ended(leg, plan, last, rotation)
        gap = platform_position(empty, pose) + rotation @ np.array(seat)
        frame = np.array(leg.base_frame)
        link = chain_poses(leg, constant(q))[-1]
        tip = link.origin.value + link.rotation.value @ np.array(end.offset)
        return replace(leg, base_point=vector3(gap - tip)), q

    def _ended(self, leg: Leg, plan: _LegPlan, last: Array, rotation: Array) -> Leg:
        """The leg with a platform joint that agrees with the home."""
        rng, end = self.rng, leg.platform_joint
        to_platform = rotation.T @ np.array(leg.base_frame) @ last
        if plan.end is _RIGID:
            return replace(leg, platform_joint=replace(end, rotation=matrix3(to_platform.T)))
        axis = self._unit() if plan.link_axis is None else _AXES[plan.link_axis]
        across = axis
        if plan.end is _END_U:
            angle = rng.uniform(0.0, 2.0 * np.pi)
            one, two = perpendicular_pair(axis)
            across = np.cos(angle) * one + np.sin(angle) * two
        on_platform = to_platform @ across
        if plan.platform_axis is not None:
            # Turn the base frame so that the axis has this direction in the platform.
            wanted = _AXES[plan.platform_axis]
            turn = rotation @ _aligning(on_platform, wanted) @ rotation.T
            leg = replace(leg, base_frame=matrix3(turn @ np.array(leg.base_frame)))
            on_platform = wanted
        end = replace(end, axis_link=vector3(axis), axis_platform=vector3(on_platform))
        return replace(leg, platform_joint=end)

    def _real_joints(self, plan: _LegPlan) -> tuple[Joint, ...]:
        joints: list[Joint] = []
        for part in plan.joints:
            axis = self._axis(part, np.array(joints[-1].axis) if joints else None)
            joints.append(
                Joint(
                    kind=part.kind,
                    axis=vector3(axis),
                    offset=self._offset(part.present),
                    pitch=float(self.rng.uniform(0.03, 0.12)) if part.kind is _H else 0.0,
                    extra=part.extra,
                    link=self._body(part.link),
                )
            )
        return tuple(joints)

    def _axis(self, part: _JointPlan, last: Array | None) -> Array:
        if part.turned_in is not None:
            return np.asarray(_AXES[part.turned_in])
        if last is not None and part.tied == "parallel":
            return np.asarray(last)
        if last is not None and part.tied == "across":
            one, two = perpendicular_pair(last)
            angle = self.rng.uniform(0.5, 1.0)
            return np.asarray(np.cos(angle) * one + np.sin(angle) * two)
        if self.planar:
            return self._unit()
        # Without relation to the preceding axis.
        return self._unit(lambda unit: last is None or 0.1 < abs(float(unit @ last)) < 0.9)

    def _offset(self, present: tuple[bool, bool, bool]) -> Vector3:
        sizes = self.rng.uniform(0.12, 0.45, 3) * self.rng.choice([-1.0, 1.0], 3)
        return vector3(np.where(present, sizes, 0.0))

    def _body(self, link: str) -> Body:
        if link == "none":
            return Body()
        mass, centre = float(self.rng.uniform(0.5, 2.0)), self._vector(0.2)
        if link == "point":
            return Body(mass, centre)
        return Body(mass, centre, random_inertia(self.rng, 0.03))

    # ---- marks -----------------------------------------------------------------------

    def _marks(self, found: Manipulator, owner: list[int]) -> Manipulator | None:
        """With as many actuators as degrees of freedom, more, or fewer; None if singular."""
        rng = self.rng
        all_driven = [[True] * len(leg.joints) for leg in found.legs]
        nv = task_size(found.space) + len(extra_indices(found))
        X, q = np.array(found.home.X), np.array(found.home.q)
        free = project(_actuated(found, all_driven), X, q, np.zeros(nv))
        if not _regular(free.Hk.T) and free.Hk.size:
            return None
        dofs = nv - free.Hk.shape[1]
        if dofs < 1:
            return None
        wish = int(rng.choice([0, 1, 2, -1], p=[0.7, 0.12, 0.1, 0.08]))
        # Marks of each leg, not of each type: every leg may become a type of its own.
        by_leg = not self.light and len(found.legs) < 4 and rng.random() < 0.3
        for _ in range(60):
            marks = self._some_marks(found, owner, by_leg=by_leg)
            actuators = sum(map(sum, marks))
            if not actuators or actuators > dofs + max(wish, 0) or actuators < dofs + min(wish, 0):
                continue
            made = _actuated(found, marks)
            try:
                if self._good(made, np.array(made.home.X), np.array(made.home.q)):
                    return made
            except OracleError:
                continue
        return None

    def _some_marks(
        self, found: Manipulator, owner: list[int], *, by_leg: bool
    ) -> list[list[bool]]:
        rng, types = self.rng, {}
        marks = []
        for leg, kind in zip(found.legs, owner, strict=True):
            if by_leg or kind not in types:
                size = len(leg.joints)
                actuators = rng.permutation(size)[
                    : int(rng.choice([0, 1, 2, 3], p=[0.1, 0.6, 0.2, 0.1]))
                ]
                types[kind] = [index in actuators for index in range(size)]
            marks.append(types[kind])
        return marks

    def _good(self, made: Manipulator, X: Array, q: Array) -> bool:
        """Whether actuators and inertia are away from singularities."""
        nv = task_size(made.space) + len(extra_indices(made))
        state = project(made, X, q, np.zeros(nv))
        passive = passive_extra_rows(made)
        rows = [row for row in range(nv) if row not in passive]
        actuators = np.hstack([state.H, state.Hk])[rows]
        if not _regular(actuators):
            return False
        if np.linalg.svd(actuators, compute_uv=False)[-1] < 0.02:
            return False
        values = np.linalg.eigvalsh(state.M)
        return bool(values[0] > INERTIA_QUALITY * values[-1])


def doubled(found: Manipulator, rng: np.random.Generator) -> Manipulator:
    """Now and then the mechanism with a leg's passive copy in the same place.

    What the copy constrains is constrained already, wherever the mechanism moves.
    """
    lacking = [k for k, leg in enumerate(found.legs) if _lacks(leg, planar=is_planar(found.space))]
    if not lacking or rng.random() > DOUBLED:
        return found
    k = int(rng.choice(lacking))
    ends = np.cumsum([0, *(len(leg.joints) for leg in found.legs)])
    joints = tuple(replace(joint, actuated=False) for joint in found.legs[k].joints)
    home = replace(found.home, q=(*found.home.q, *found.home.q[ends[k] : ends[k + 1]]))
    return replace(found, legs=(*found.legs, replace(found.legs[k], joints=joints)), home=home)


def _lacks(leg: Leg, *, planar: bool) -> bool:
    """Whether a leg without extra coordinates restricts the platform."""
    most = 2 if planar else 3 + _MOMENTS[leg.platform_joint.kind]
    return len(leg.joints) < most and not any(joint.extra for joint in leg.joints)


def actuated_anywhere(drawn: Manipulator, rng: np.random.Generator) -> Manipulator | None:
    """The mechanism with other actuators: anywhere, in any number; None if all are singular."""
    for _ in range(30):
        chance = float(rng.choice([0.3, 0.5, 0.7, 0.9]))
        marks = [
            [bool(rng.random() < (0.3 if joint.extra else chance)) for joint in leg.joints]
            for leg in drawn.legs
        ]
        if not any(map(any, marks)):
            continue
        made = _actuated(drawn, marks)
        if is_clear(made, np.array(made.home.X), np.array(made.home.q)):
            return made
    return None


def is_clear(made: Manipulator, X: Array, q: Array) -> bool:
    """Whether every rank on which forces and accelerations depend is beyond doubt."""
    nv, passive = task_size(made.space) + len(extra_indices(made)), passive_extra_rows(made)
    state = project(made, X, q, np.zeros(nv))
    K = np.hstack([state.H, state.Hk])
    others = [row for row in range(nv) if row not in passive]
    systems = [K, K[others]]
    if are_held(K, passive) and rank(K) < nv:
        systems.append(np.hstack([state.M[:, passive] / np.abs(state.M).max(), K]))
    values = np.linalg.eigvalsh(state.M)
    return all(map(_has_clear_rank, systems)) and bool(values[0] > INERTIA_QUALITY * values[-1])


def _has_clear_rank(matrix: Array) -> bool:
    values = np.linalg.svd(matrix, compute_uv=False)
    doubtful = (values > RANK_TOLERANCE * values[0]) & (values < DRIVE_QUALITY * values[0])
    return not bool(doubtful.any())


def _regular(matrix: Array) -> bool:
    """Whether the rows (or columns, if there are fewer) are far from dependent."""
    if not matrix.size:
        return False
    values = np.linalg.svd(matrix, compute_uv=False)
    return bool(values[-1] > DRIVE_QUALITY * values[0])


def _actuated(manipulator: Manipulator, marks: list[list[bool]]) -> Manipulator:
    legs = tuple(
        replace(
            leg,
            joints=tuple(
                replace(joint, actuated=mark) for joint, mark in zip(leg.joints, own, strict=True)
            ),
        )
        for leg, own in zip(manipulator.legs, marks, strict=True)
    )
    return replace(manipulator, legs=legs)


def _aligning(vector: Array, wanted: Array) -> Array:
    """A rotation that takes one unit vector to another."""
    axis = np.cross(vector, wanted)
    sine, cosine = float(np.linalg.norm(axis)), float(vector @ wanted)
    if sine < 1e-12:
        axis, sine = perpendicular_pair(vector)[0], 0.0
    else:
        axis = axis / sine
    return rotation_from_quaternion(quaternion_of_vector(axis * np.arctan2(sine, cosine)))


def describe(manipulator: Manipulator) -> str:
    """One line: space, and per leg its joints and platform joint."""
    legs = []
    for leg in manipulator.legs:
        joints = [_code(joint) for joint in leg.joints]
        legs.append(f"{' '.join(joints)} | {leg.platform_joint.kind}")
    kinds = dict.fromkeys(legs)
    return f"{manipulator.space}: " + "; ".join(f"{legs.count(k)} x {k}" for k in kinds)


def _code(joint: Joint) -> str:
    axis = "t"
    for letter, direction in zip("xyz", _AXES, strict=True):
        if joint.axis == tuple(direction):
            axis = letter
    offset = "".join(c for c, v in zip("xyz", joint.offset, strict=True) if v != 0.0)
    marks = "*" * joint.actuated + "+" * joint.extra + "0" * joint.link.is_massless
    marks += "f" * bool(joint.friction) + "s" * bool(joint.spring) + "m" * bool(joint.actuator)
    return f"{joint.kind}{axis}{marks}{f'({offset})' if offset else ''}"
