"""Random geometry and inertia of the same structure, and random states.

Structure (fixed when code is generated): joint kinds and marks, axes along coordinate
directions, parallel and perpendicular axes, zero components of offsets, links without
mass and inertia.  Everything else is a live parameter, and is drawn at random here.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pne_sym.model.manipulator import (
    Body,
    Home,
    Joint,
    JointKind,
    Leg,
    Manipulator,
    Matrix3,
    PlatformJoint,
    PlatformJointKind,
    Space,
    Vector3,
)
from tests.oracle.closure import OracleError, assemble, follow
from tests.oracle.coordinates import (
    displaced,
    extra_indices,
    is_planar,
    platform_position,
    platform_rotation,
    pose_size,
    quaternion_of_vector,
    rotation_from_quaternion,
    task_size,
)
from tests.oracle.jets import Array
from tests.oracle.projection import Result, accelerated, complete_acceleration, project

_STRUCTURE_TOLERANCE = 1e-9
_ATTEMPTS = 300


class State(NamedTuple):
    """A closed state with its loads; flat, in the order of the description.

    Attributes:
        X: (nq,) pose and extra coordinates.
        q: (nj,) displacements on the branch of home; revolute ones in (-pi, pi].
        V: (nv,) velocity, admissible.
        A: (nv,) acceleration, admissible; extra coordinates without an actuator consistent.
        wrench: (nw,) external force and moment about the platform origin.
    """

    X: Array
    q: Array
    V: Array
    A: Array
    wrench: Array


def random_inertia(rng: np.random.Generator, moment: float) -> Matrix3:
    """A full inertia tensor of any rigid body: tr(S) E - S of a positive second moment S.

    Args:
        rng: source of randomness.
        moment: scale, kg m^2.
    """
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    second = frame @ np.diag(moment * rng.uniform(0.2, 1.0, 3)) @ frame.T
    return matrix3(np.trace(second) * np.eye(3) - second)


def vector3(vector: Array) -> Vector3:
    """Three components as the description's tuple."""
    x, y, z = (float(component) for component in vector)
    return (x, y, z)


def matrix3(matrix: Array) -> Matrix3:
    """Three rows as the description's tuple."""
    first, second, third = (vector3(row) for row in matrix)
    return (first, second, third)


class _Sampler:
    """Draws random geometry about a nominal manipulator.

    Attributes:
        size: characteristic length of the mechanism, m.
        reach: how far from the nominal values to go, 1 at most.
    """

    def __init__(
        self, nominal: Manipulator, rng: np.random.Generator, reach: float, structure_kept: bool
    ) -> None:
        self.planar = is_planar(nominal.space)
        self.space = nominal.space
        self.size = _characteristic_length(nominal)
        self.rng = rng
        self.reach = reach
        self.structure_kept = structure_kept

    def around(self, vector: Vector3, spread: float) -> Vector3:
        """`vector` plus a random one, in the plane for planar mechanisms."""
        change = self.rng.uniform(-spread, spread, 3)
        if self.planar:
            change[2] = 0.0
        return vector3(np.array(vector) + change)

    def turned(self, angle: float) -> Array:
        """A random rotation (3, 3) by up to about `angle` rad, in the plane if planar."""
        vector = self.rng.uniform(-angle, angle, 3)
        if self.planar:
            vector[:2] = 0.0
        return rotation_from_quaternion(quaternion_of_vector(vector))

    def stretched(self, offset: Vector3) -> Vector3:
        """Change the non-zero components; zero ones are structure."""
        if not self.structure_kept:
            return self.around(offset, 0.05 * self.reach * self.size)
        factors = 1.0 + 0.25 * self.reach * self.rng.uniform(-1.0, 1.0, 3)
        return vector3(np.array(offset) * factors)

    def body(self, body: Body, *, may_gain_mass: bool) -> Body:
        """Random mass, centre of mass and full, physically possible inertia tensor."""
        mass, trace = body.mass, float(np.trace(np.array(body.inertia)))
        if body.is_massless:
            if not may_gain_mass or self.structure_kept:
                return body
            mass = 1.0
        radius = np.sqrt(trace / (2.0 * mass)) if trace > 0.0 and mass > 0.0 else 0.1 * self.size
        moment = mass * radius**2 if mass > 0.0 else 0.5 * trace
        return Body(
            mass=float(mass * self.rng.uniform(0.6, 1.6)),
            centre_of_mass=self.around(body.centre_of_mass, 0.5 * float(radius)),
            inertia=random_inertia(self.rng, moment),
        )

    def leg(self, leg: Leg) -> Leg:
        """Random geometry and inertia of a leg."""
        frame = np.array(leg.base_frame) @ self.turned(0.5 * self.reach)
        point = leg.platform_point
        if self.space is not Space.POINT:  # there the platform is the output point itself
            arm = max(float(np.linalg.norm(point)), 0.1 * self.size)
            point = self.around(point, 0.25 * self.reach * arm)
        return replace(
            leg,
            base_point=self.around(leg.base_point, 0.15 * self.reach * self.size),
            base_frame=matrix3(frame),
            joints=tuple(self.joint(leg, index) for index in range(len(leg.joints))),
            platform_joint=self.platform_joint(leg),
            platform_point=point,
        )

    def joint(self, leg: Leg, index: int) -> Joint:
        """Random geometry of a joint and inertia of its link."""
        joint = leg.joints[index]
        others = [other.axis for i, other in enumerate(leg.joints) if i != index]
        if leg.platform_joint.axis_link is not None:
            others.append(leg.platform_joint.axis_link)
        revolute_in_plane = self.planar and joint.kind is not JointKind.PRISMATIC
        return replace(
            joint,
            axis=joint.axis if revolute_in_plane else self.axis(joint.axis, others),
            offset=self.stretched(joint.offset),
            pitch=joint.pitch * float(self.rng.uniform(0.8, 1.2)),
            link=self.body(joint.link, may_gain_mass=True),
        )

    def platform_joint(self, leg: Leg) -> PlatformJoint:
        """Random geometry of the joint at the platform."""
        joint = leg.platform_joint
        rotation = joint.rotation
        if rotation is not None:
            rotation = matrix3(np.array(rotation) @ self.turned(0.3 * self.reach))
        axis_link, axis_platform = joint.axis_link, joint.axis_platform
        if axis_link is not None and axis_platform is not None:
            axis_link = self.axis(axis_link, [other.axis for other in leg.joints])
            axis_platform = self.axis(axis_platform, [])
        return replace(
            joint,
            offset=self.stretched(joint.offset),
            axis_link=axis_link,
            axis_platform=axis_platform,
            rotation=rotation,
        )

    def axis(self, axis: Vector3, others: list[Vector3]) -> Vector3:
        """Tilt an axis unless its direction is structure."""
        vector = np.array(axis)
        cosines = [abs(float(vector @ np.array(other))) for other in others]
        related = any(min(c, abs(1.0 - c)) < _STRUCTURE_TOLERANCE for c in cosines)
        aligned = np.abs(vector).max() > 1.0 - _STRUCTURE_TOLERANCE
        if self.structure_kept and (aligned or related):
            return axis
        tilted = self.turned(0.3 * self.reach) @ vector
        return vector3(tilted / np.linalg.norm(tilted))


def randomise(
    manipulator: Manipulator, rng: np.random.Generator, structure_kept: bool = True
) -> Manipulator:
    """The same structure with random, fully asymmetric parameters and a new home.

    Args:
        manipulator: nominal mechanism with a valid home.
        rng: source of randomness.
        structure_kept: False: also tilt axes along coordinate directions, fill zero
            components of offsets and give mass to links without.

    Returns:
        A manipulator whose home closes the loops and is about as well conditioned as the
        nominal one.

    Raises:
        OracleError: none was found; e.g. for mechanisms that move only because of special
            geometry.
    """
    nominal = _quality(manipulator, np.array(manipulator.home.X), np.array(manipulator.home.q))
    for attempt in range(_ATTEMPTS):
        reach = max(0.96**attempt, 0.05)
        sampler = _Sampler(manipulator, rng, reach, structure_kept)
        centre = manipulator.fixed_centre
        candidate = replace(
            manipulator,
            gravity=sampler.around(manipulator.gravity, 4.0),
            platform=_random_platform(sampler, manipulator.platform),
            legs=tuple(sampler.leg(leg) for leg in manipulator.legs),
            fixed_centre=None if centre is None else sampler.around(centre, 0.1 * sampler.size),
        )
        try:
            X, q = _random_home(candidate, rng, reach)
            quality = _quality(candidate, X, q)
        except OracleError:
            continue
        if _acceptable(quality, nominal) and _near(manipulator, q):
            home = Home(X=tuple(map(float, X)), q=tuple(map(float, q)))
            return replace(candidate, home=home)
    raise OracleError(f"no well conditioned random geometry found for {manipulator.name}")


def random_state(manipulator: Manipulator, rng: np.random.Generator, spread: float = 1.0) -> State:
    """A random state near home, reached by continuation on home's branch.

    Args:
        manipulator: mechanism.
        rng: source of randomness.
        spread: 1: up to about 0.1 characteristic lengths and 0.25 rad from home.

    Raises:
        OracleError: no well conditioned state was found.
    """
    home = np.array(manipulator.home.X), np.array(manipulator.home.q)
    nominal = _quality(manipulator, *home)
    for attempt in range(_ATTEMPTS):
        step = _random_step(manipulator, rng, spread * 0.97**attempt)
        try:
            X, q = _moved(manipulator, *home, step, constrained=nominal.multipliers > 0)
            quality = _quality(manipulator, X, q)
        except OracleError:
            continue
        if _acceptable(quality, nominal):
            X, q = _wrapped(manipulator, X, q)
            return State(X, q, *_random_motion(manipulator, rng, X, q))
    raise OracleError(f"no well conditioned state found for {manipulator.name}")


class _Quality(NamedTuple):
    """Reciprocal condition numbers, of the legs and of the actuators; multipliers' number.

    And the sides of their singularities that the legs are on: sign of the determinant.
    """

    legs: tuple[float, ...]
    sides: tuple[float, ...]
    actuators: float
    multipliers: int
    axes_agree: bool


def _quality(manipulator: Manipulator, X: Array, q: Array) -> _Quality:
    state = project(manipulator, X, q, np.zeros(_velocity_size(manipulator)))
    if state.closure > 1e-6:
        raise OracleError(f"{manipulator.name}: the loops are open")
    free = [
        [index for index, joint in enumerate(leg.joints) if not joint.extra]
        for leg in manipulator.legs
    ]
    jacobians = [leg.jacobian[:, columns] for leg, columns in zip(state.legs, free, strict=True)]
    legs = tuple(map(_reciprocal_condition, jacobians))
    actuators = _reciprocal_condition(_actuator_matrix(state))
    return _Quality(
        legs,
        tuple(map(_side, jacobians)),
        actuators,
        state.Hk.shape[1],
        _axes_agree(manipulator, X, state),
    )


def _actuator_matrix(state: Result) -> Array:
    """[H Hk], constraints of length one, without the rows that no actuator reaches."""
    both = np.hstack([state.H, state.Hk / np.linalg.norm(state.Hk, axis=0)])
    reach = np.abs(both).max(axis=1)
    return np.delete(both, np.flatnonzero(reach <= 1e-12 * reach.max()), axis=0)


def _reciprocal_condition(matrix: Array) -> float:
    values = np.linalg.svd(matrix, compute_uv=False)
    return float(values.min() / values.max())


def _side(jacobian: Array) -> float:
    """Sign of the determinant: where it turns, continuation has passed to another branch."""
    square = jacobian.shape[0] == jacobian.shape[1]
    return float(np.sign(np.linalg.det(jacobian))) if square else 0.0


def _axes_agree(manipulator: Manipulator, X: Array, state: Result) -> bool:
    """Whether axes joined by a revolute platform joint point the same way."""
    platform = platform_rotation(manipulator, X)
    for leg, result in zip(manipulator.legs, state.legs, strict=True):
        joint = leg.platform_joint
        if joint.kind is not PlatformJointKind.REVOLUTE or is_planar(manipulator.space):
            continue
        link_axis = result.motion.rotation[-1] @ np.array(joint.axis_link)
        if link_axis @ platform @ np.array(joint.axis_platform) < 0.0:
            return False
    return True


def _acceptable(quality: _Quality, nominal: _Quality) -> bool:
    return (
        quality.axes_agree
        and quality.multipliers == nominal.multipliers
        and quality.sides == nominal.sides
        and all(a > 0.3 * b for a, b in zip(quality.legs, nominal.legs, strict=True))
        and quality.actuators > 0.3 * nominal.actuators
    )


def _near(manipulator: Manipulator, q: Array) -> bool:
    """Whether no joint went far from its nominal home (another branch, a flipped slide)."""
    for joint, new, old in zip(
        [joint for leg in manipulator.legs for joint in leg.joints],
        q,
        manipulator.home.q,
        strict=True,
    ):
        limit = 0.6 * abs(old) if joint.kind is JointKind.PRISMATIC and old != 0.0 else 1.2
        if abs(new - old) > limit:
            return False
    return True


def _random_platform(sampler: _Sampler, platform: Body) -> Body:
    body = sampler.body(platform, may_gain_mass=False)
    if sampler.space is Space.POINT:  # a particle at the output point
        return Body(body.mass, platform.centre_of_mass, platform.inertia)
    return body


def _random_home(
    manipulator: Manipulator, rng: np.random.Generator, reach: float
) -> tuple[Array, Array]:
    X = displaced(
        manipulator,
        np.array(manipulator.home.X),
        _random_step(manipulator, rng, 0.6 * reach),
    )
    return _wrapped(manipulator, *assemble(manipulator, X, np.array(manipulator.home.q)))


def _random_step(manipulator: Manipulator, rng: np.random.Generator, spread: float) -> Array:
    """A finite displacement (nv,) along V."""
    length = 0.1 * _characteristic_length(manipulator)
    translations = {
        Space.POINT: 2,
        Space.PLANAR: 2,
        Space.SPATIAL: 3,
        Space.TRANSLATIONAL: 3,
        Space.SPHERICAL: 0,
    }[manipulator.space]
    task = task_size(manipulator.space)
    scales = [length if row < translations else 0.25 for row in range(task)]
    extra = [joint for leg in manipulator.legs for joint in leg.joints if joint.extra]
    scales += [length if joint.kind is JointKind.PRISMATIC else 0.3 for joint in extra]
    step: Array = spread * rng.uniform(-1.0, 1.0, len(scales)) * np.array(scales)
    return step


def _moved(
    manipulator: Manipulator, X: Array, q: Array, step: Array, *, constrained: bool
) -> tuple[Array, Array]:
    if not constrained:
        target = displaced(manipulator, X, step)
        return target, follow(manipulator, X, q, target)
    for _ in range(5):
        X, q = assemble(manipulator, displaced(manipulator, X, step / 5), q)
    return X, q


def _random_motion(
    manipulator: Manipulator, rng: np.random.Generator, X: Array, q: Array
) -> tuple[Array, Array, Array]:
    """Admissible V and A, and a wrench."""
    size = _velocity_size(manipulator)
    V, A = rng.uniform(-1.5, 1.5, size), rng.uniform(-8.0, 8.0, size)
    wrench = rng.uniform(-30.0, 30.0, task_size(manipulator.space))
    Hk = project(manipulator, X, q, V).Hk
    if Hk.size:
        V = V - np.linalg.pinv(Hk.T) @ (Hk.T @ V)
        bias = project(manipulator, X, q, V).constraint_bias
        A = A - np.linalg.pinv(Hk.T) @ (Hk.T @ A + bias)
    try:
        A = complete_acceleration(manipulator, X, q, V, A, wrench)
    except OracleError:  # too few actuators: not every acceleration has forces
        moving = project(manipulator, X, q, V, A, wrench)
        A = accelerated(manipulator, moving, rng.uniform(-20.0, 20.0, moving.H.shape[1]))
    return V, A, wrench


def _wrapped(manipulator: Manipulator, X: Array, q: Array) -> tuple[Array, Array]:
    """Revolute displacements in (-pi, pi], in q and among the extra coordinates."""
    X, q = X.copy(), q.copy()
    joints = [joint for leg in manipulator.legs for joint in leg.joints]
    revolute = [joint.kind is JointKind.REVOLUTE for joint in joints]
    q[revolute] = -((np.pi - q[revolute]) % (2.0 * np.pi) - np.pi)
    X[pose_size(manipulator.space) :] = q[extra_indices(manipulator)]
    return X, q


def _velocity_size(manipulator: Manipulator) -> int:
    return task_size(manipulator.space) + len(extra_indices(manipulator))


def _characteristic_length(manipulator: Manipulator) -> float:
    """Mean distance from the base points to the platform's joints at home, m."""
    X = np.array(manipulator.home.X)
    position = platform_position(manipulator, X)
    rotation = platform_rotation(manipulator, X)
    return float(
        np.mean(
            [
                np.linalg.norm(position + rotation @ np.array(leg.platform_point) - leg.base_point)
                for leg in manipulator.legs
            ]
        )
    )
