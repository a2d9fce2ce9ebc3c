"""Dynamics from poses alone: exact time derivatives, then d'Alembert's principle.

The only mechanics here is the pose of each body as a function of the joint displacements
and of the platform's coordinates.  Velocities, accelerations and partial velocities come
from pushing truncated Taylor numbers of time through these functions, and the generalised
inertia forces are

    P_k = sum over bodies of  m (a - g) . dc/dx_k + (I alpha + omega x I omega) . dtheta/dx_k.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pne_sym.model.manipulator import Body, Leg, Manipulator, Space
from tests.oracle.base import REST, Base, base_of
from tests.oracle.bodies import (
    Bodies,
    LinkMotion,
    bodies_of,
    inertia_matrix,
    kinetic_energy,
    motion_of,
    only_body,
    potential_energy,
    virtual_forces,
)
from tests.oracle.chain import chain_poses
from tests.oracle.closure import OracleError, closure_residual, leg_closure
from tests.oracle.coordinates import (
    Pose,
    actuated_indices,
    is_planar,
    joint_slices,
    passive_extra_rows,
    platform_motion,
    platform_rotation,
    task_size,
    twist_basis,
)
from tests.oracle.effects import friction, rotor_matrix, springs, stored, turning_friction
from tests.oracle.forces import RANK_TOLERANCE, completion, forces
from tests.oracle.jets import Array, cross_matrix, taylor


@dataclass(frozen=True)
class LegResult:
    """One leg: m joints, nc closure conditions, k of them left out by its degrees of freedom.

    Attributes:
        motion: of its m links, at the given A.
        jacobian: (nc, m) rates of the closure conditions by joint rate; for a spherical
            platform joint the columns are the vectors v_j (base axes).
        rates: (m, nv) joint rates by V: qd = rates V.
        joint_forces: (m,) inertia-minus-gravity force of the distal links along each
            freedom at the given A (the method's Gamma_j), N or N m.
        joint_inertia: (m, m) inertia matrix of the chain in its joint rates.
        reaction: (6,) force and moment of the leg on the platform at the platform joint
            (base axes, moment about the platform point), at tau, lam and A.
        constraint_wrenches: (k, 6) force and moment at the platform joint per unit lambda.
    """

    motion: LinkMotion
    jacobian: Array
    rates: Array
    joint_forces: Array
    joint_inertia: Array
    reaction: Array
    constraint_wrenches: Array


@dataclass(frozen=True)
class Result:
    """Everything about one state.  Flat orders as in the description: legs, then joints.

    nv velocities (platform, then extra), nj joints, nu actuated joints, nc multipliers.

    Attributes:
        M: (nv, nv) inertia matrix.
        Z: (nv,) velocity terms minus gravity.
        H: (nv, nu) of the actuated joints.
        Hk: (nv, nc) of the multipliers.  Sign, and for several multipliers of one leg the
            basis, are arbitrary.
        constraint_bias: (nc,) with Hk^T A + constraint_bias = 0.
        qd: (nj,) joint rates.
        qdd: (nj,) joint accelerations at A.
        tau: (nu,) driving forces for A and the wrench; least norm where not unique.  Rows
            of extra coordinates that are not actuated hold in least squares only.
        lam: (nc,) multipliers that go with tau.
        tau_residual: (nv,) what tau and lam leave of M A + Z - W; zero for a consistent A.
        load: (nv,) the wrench as a generalised force.
        kinetic: J.
        potential: J, zero at the base origin, with that of springs.
        dissipation: W, power that friction takes.
        inertia_forces: (nv,) the sums P_k at A; equal to M A + Z for an admissible A.
        closure: largest closure residual of the given q (m, or sines of angles).
        legs: per leg.
        platform: motion of the platform (no leading axis).
    """

    M: Array
    Z: Array
    H: Array
    Hk: Array
    constraint_bias: Array
    qd: Array
    qdd: Array
    tau: Array
    lam: Array
    tau_residual: Array
    load: Array
    kinetic: float
    potential: float
    dissipation: float
    inertia_forces: Array
    closure: float
    legs: tuple[LegResult, ...]
    platform: LinkMotion


@dataclass(frozen=True)
class _LegKinematics:
    """First-order kinematics of a leg with nc closure conditions; see `LegResult`.

    `residual` (nc,): of the conditions.
    `demand` (nc, nv): rates of the conditions by V, joints without extra ones at rest.
    `wrench_map` (6, nc): from the conditions' multipliers to the wrench on the platform at
    the platform joint.  `multipliers` (nc, k): per unit lambda.
    `split` (m without extra ones, nc): rates of these joints by those of the conditions.
    """

    leg: Leg
    q: Array
    free: list[int]
    residual: Array
    jacobian: Array
    demand: Array
    rates: Array
    wrench_map: Array
    multipliers: Array
    split: Array
    bodies: Bodies


@dataclass(frozen=True)
class _Motion:
    """The whole mechanism at one acceleration; `remainders`: see `_joint_acceleration`.

    `dragged`: by leg, the moment (3,) of the platform joint's friction on the last link.
    `in_space`: of the links, with the base.  `rotors`: (nj,) forces that these take along joints.
    """

    qd: Array
    qdd: Array
    rotors: Array
    links: list[LinkMotion]
    platform: LinkMotion
    forces: Array
    remainders: list[Array]
    kinetic: float
    potential: float
    dissipation: float
    dragged: list[Array]
    in_space: list[LinkMotion]
    gravity: Array


def project(
    manipulator: Manipulator,
    X: Array,
    q: Array,
    V: Array,
    A: Array | None = None,
    wrench: Array | None = None,
    base: Base | None = None,
    *,
    moments: tuple[int, ...] = (),
) -> Result:
    """Evaluate the dynamics at a closed state.

    Args:
        manipulator: mechanism.
        X: (nq,) pose and extra coordinates.
        q: (nj,) displacements that close the loops at X.
        V: (nv,) velocity.
        A: (nv,) acceleration, default zero.
        wrench: (nw,) external force and moment about the platform origin, default none.
        base: its motion, by default that of `base_of`.
        moments: by leg, how many multipliers are moments; by default those that are pure here.

    Returns:
        The matrices and all derived quantities.

    Raises:
        OracleError: a leg is singular or has degrees of freedom that X and V do not determine.
    """
    X, q, V = (np.asarray(array, dtype=float) for array in (X, q, V))
    A = np.zeros_like(V) if A is None else np.asarray(A, dtype=float)
    base = base or base_of(manipulator)
    legs = [
        _leg_kinematics(manipulator, number, X, q[where], moments[number] if moments else None)
        for number, where in enumerate(joint_slices(manipulator))
    ]
    platform = _platform_bodies(manipulator, X, V.size)
    still = _evaluate(manipulator, legs, platform, X, V, np.zeros_like(V), base)
    moving = _evaluate(manipulator, legs, platform, X, V, A, base) if A.any() else still
    H = np.vstack([leg.rates for leg in legs]).T[:, actuated_indices(manipulator)]
    Hk = np.hstack([-leg.demand.T @ leg.multipliers for leg in legs])
    load = np.zeros_like(V)
    if wrench is not None:
        load[: task_size(manipulator.space)] = wrench
    demand = moving.forces - load
    tau, lam = forces(H, Hk, demand, passive_extra_rows(manipulator))
    bodies = [leg.bodies.by(leg.rates) for leg in legs]
    return Result(
        M=np.sum([inertia_matrix(group) for group in [*bodies, platform]], axis=0)
        + _all_rates(legs).T @ rotor_matrix(manipulator) @ _all_rates(legs),
        Z=still.forces,
        H=H,
        Hk=Hk,
        constraint_bias=-np.concatenate(
            [leg.multipliers.T @ rest for leg, rest in zip(legs, still.remainders, strict=True)]
        ),
        qd=moving.qd,
        qdd=moving.qdd,
        tau=tau,
        lam=lam,
        tau_residual=demand - H @ tau - Hk @ lam,
        load=load,
        kinetic=moving.kinetic,
        potential=moving.potential,
        dissipation=moving.dissipation,
        inertia_forces=moving.forces,
        closure=max(float(np.abs(leg.residual).max()) for leg in legs),
        legs=_leg_results(manipulator, legs, moving, tau, lam),
        platform=moving.platform,
    )


def admissible(result: Result) -> tuple[Array, Array]:
    """The motions that constraints leave: V = N v and A = c + N a.

    Where the split of a leg's inertia between free and constrained directions is a matter
    of choice, N^T M N, N^T (M c + Z) and N^T H are not.

    Returns:
        N: (nv, nv - nc) orthonormal columns.
        c: (nv,) the smallest admissible acceleration.
    """
    left, values, _ = np.linalg.svd(result.Hk)
    rank = int((values > RANK_TOLERANCE * values.max(initial=0.0)).sum())
    c = -np.linalg.pinv(result.Hk.T, rcond=RANK_TOLERANCE) @ result.constraint_bias
    return left[:, rank:], c


def complete_acceleration(
    manipulator: Manipulator,
    X: Array,
    q: Array,
    V: Array,
    A: Array,
    wrench: Array | None = None,
) -> Array:
    """Change entries of A that belong to passive extra coordinates, so that forces exist.

    Where actuators and constraints together have full rank, nothing changes.  Else M A + Z - W is
    brought into their range, by the least change in the metric of M.

    Returns:
        (nv,) acceleration.

    Raises:
        OracleError: no change of these entries does.
    """
    rows = passive_extra_rows(manipulator)
    if not rows:
        return A
    state = project(manipulator, X, q, V, A, wrench)
    result = np.array(A, dtype=float)
    K = np.hstack([state.H, state.Hk])
    result[rows] += completion(state.M, state.M @ A + state.Z - state.load, K, rows)
    return result


def accelerated(manipulator: Manipulator, result: Result, tau: Array) -> Array:
    """A under driving forces and the state's wrench: from reduced equations, no multipliers."""
    N, c = admissible(result)
    force = N.T @ (result.H @ tau + result.load - result.Z - result.M @ c)
    return np.asarray(c + N @ np.linalg.solve(N.T @ result.M @ N, force))


def _leg_kinematics(
    manipulator: Manipulator, number: int, X: Array, q: Array, pure: int | None
) -> _LegKinematics:
    """Rates of a leg's joints by V, and what its degrees of freedom leave to the platform."""
    leg = manipulator.legs[number]
    closure = leg_closure(manipulator, leg, X, q)
    free = [index for index, joint in enumerate(leg.joints) if not joint.extra]
    left, values, _ = np.linalg.svd(closure.joints[:, free])
    if len(free) > left.shape[0] or values.min() <= RANK_TOLERANCE * values.max():
        raise OracleError(f"leg {number} is singular or has undetermined degrees of freedom")
    rates = _extra_selection(manipulator, number)
    task, total = task_size(manipulator.space), rates.shape[1]
    demand = closure.platform @ twist_basis(manipulator.space) @ np.eye(task, total)
    demand += closure.joints @ rates
    # What completes the degrees of freedom tells which part of any motion is theirs.
    null_space = left[:, len(free) :]
    motions = completing(manipulator.space, null_space, pure)
    split = np.linalg.inv(np.hstack([closure.joints[:, free], motions]))[: len(free)]
    rates[free] = -split @ demand
    wrench_map = -_at_joint(manipulator, leg, X) @ closure.platform.T
    unit_rates = taylor(q, np.eye(q.size), np.zeros((q.size,) * 2))
    return _LegKinematics(
        leg=leg,
        q=q,
        free=free,
        residual=closure.residual,
        jacobian=closure.joints,
        demand=demand,
        rates=rates,
        wrench_map=wrench_map,
        multipliers=_unit_multipliers(null_space, demand, wrench_map),
        split=split,
        bodies=bodies_of([joint.link for joint in leg.joints], chain_poses(leg, unit_rates)),
    )


def completing(space: Space, null_space: Array, pure: int | None) -> Array:
    """(nc, k) motions that complete a leg's degrees of freedom, by its constraint wrenches.

    Lambda is the component of the leg's force along the unit force of such a wrench, or of its
    moment where that is all there is: the motions are along these forces and about these moments.

    Args:
        space: tells how many conditions are of points.
        null_space: (nc, k) orthonormal multipliers of the conditions that do no work.
        pure: how many of them are taken for moments, those with the least forces.
    """
    points = 2 if is_planar(space) else 3
    _, sizes, wrenches = np.linalg.svd(null_space[:points])
    if pure is None:
        pure = null_space.shape[1] - int((sizes > RANK_TOLERANCE).sum())
    motions = null_space @ wrenches.T
    forces = null_space.shape[1] - pure
    motions[points:, :forces] = 0.0
    motions[:points, forces:] = 0.0
    return np.asarray(motions)


def moments_at_home(manipulator: Manipulator) -> tuple[int, ...]:
    """By leg, how many of the wrenches that it leaves out are pure moments at home."""
    found, X, q = [], np.array(manipulator.home.X), np.array(manipulator.home.q)
    for leg, where in zip(manipulator.legs, joint_slices(manipulator), strict=True):
        free = [index for index, joint in enumerate(leg.joints) if not joint.extra]
        joints = leg_closure(manipulator, leg, X, q[where]).joints[:, free]
        null_space = np.linalg.svd(joints)[0][:, len(free) :]
        points = 2 if is_planar(manipulator.space) else 3
        forces = np.linalg.matrix_rank(null_space[:points], tol=RANK_TOLERANCE)
        found.append(null_space.shape[1] - int(forces))
    return tuple(found)


def _extra_selection(manipulator: Manipulator, number: int) -> Array:
    """(m, nv): picks the rates of the leg's extra joints from V, zero for all others."""
    task = task_size(manipulator.space)
    counts = [sum(joint.extra for joint in leg.joints) for leg in manipulator.legs]
    column = task + sum(counts[:number])
    joints = manipulator.legs[number].joints
    selection = np.zeros((len(joints), task + sum(counts)))
    for row, joint in enumerate(joints):
        if joint.extra:
            selection[row, column] = 1.0
            column += 1
    return selection


def _at_joint(manipulator: Manipulator, leg: Leg, X: Array) -> Array:
    """(6, 6): wrench about the platform origin to wrench about the platform joint."""
    arm = platform_rotation(manipulator, X) @ np.array(leg.platform_point, dtype=float)
    shift = np.eye(6)
    shift[3:, :3] = -cross_matrix(arm)
    return shift


def _unit_multipliers(null_space: Array, demand: Array, wrench_map: Array) -> Array:
    """Multipliers (nc, k) of the closure conditions per unit lambda.

    Lambda is a force where it transmits one (unit force part), else a moment.  Conditions
    that no coordinate can violate, such as rotations that the space locks, drop out.
    """
    left, values, _ = np.linalg.svd(null_space.T @ demand)
    multipliers = null_space
    if values.size < null_space.shape[1] or (values < RANK_TOLERANCE).any():
        multipliers = null_space @ left[:, : int((values > RANK_TOLERANCE).sum())]
    wrenches = wrench_map @ multipliers
    force = np.linalg.norm(wrenches[:3], axis=0)
    moment = np.linalg.norm(wrenches[3:], axis=0)
    units: Array = np.where(force > RANK_TOLERANCE * moment, force, moment)
    return multipliers / units


def _platform_bodies(manipulator: Manipulator, X: Array, nv: int) -> Bodies:
    """The platform's partial velocities by the entries of V."""
    twists = (twist_basis(manipulator.space) @ np.eye(task_size(manipulator.space), nv)).T
    pose = platform_motion(manipulator, X, twists, np.zeros_like(twists))
    carried = _carried(manipulator)
    return bodies_of(carried, [pose] * len(carried))


def _carried(manipulator: Manipulator) -> list[Body]:
    """The platform, and what it carries."""
    return [manipulator.platform, *([manipulator.payload] if manipulator.payload else [])]


def _evaluate(
    manipulator: Manipulator,
    legs: list[_LegKinematics],
    platform: Bodies,
    X: Array,
    V: Array,
    A: Array,
    base: Base,
) -> _Motion:
    """Accelerations of all bodies and the generalised inertia-minus-gravity forces."""
    gravity = base.rotation.T @ np.array(manipulator.gravity, dtype=float)
    basis = twist_basis(manipulator.space) @ np.eye(task_size(manipulator.space), V.size)
    pose = platform_motion(manipulator, X, basis @ V, basis @ A)
    qd, qdd, links, remainders, carried_links = [], [], [], [], []
    for leg in legs:
        rate = leg.rates @ V
        acceleration, remainder, poses = _joint_acceleration(manipulator, leg, pose, rate, A)
        bodies_of_leg = [joint.link for joint in leg.leg.joints]
        links.append(motion_of(bodies_of_leg, poses))
        carried_links.append(
            links[-1]
            if base is REST
            else motion_of(bodies_of_leg, [base.carries(each) for each in poses])
        )
        qd.append(rate)
        qdd.append(acceleration)
        remainders.append(remainder)
    fixed = _carried(manipulator)
    carried = motion_of(fixed, [pose] * len(fixed))
    bodies = [leg.bodies.by(leg.rates) for leg in legs]
    pairs = list(zip([*bodies, platform], [*links, carried], strict=True))
    in_space = [*carried_links, motion_of(fixed, [base.carries(pose)] * len(fixed))]
    turned = rotor_matrix(manipulator)
    taken = np.split(turned @ np.concatenate(qdd), np.cumsum([len(each) for each in qd])[:-1])
    triples = list(zip(legs, qd, taken, strict=True))
    turning = [carried.angular_velocity[0] - motion.angular_velocity[-1] for motion in links]
    dragged = [
        turning_friction(leg.leg.platform_joint.friction, of)
        for leg, of in zip(legs, turning, strict=True)
    ]
    return _Motion(
        qd=np.concatenate(qd),
        qdd=np.concatenate(qdd),
        rotors=np.concatenate(taken),
        links=links,
        platform=only_body(motion_of([manipulator.platform], [pose])),
        forces=np.sum(
            [
                virtual_forces(body, motion, gravity)
                for body, motion in zip([*bodies, platform], in_space, strict=True)
            ],
            axis=0,
        )
        + np.sum([leg.rates.T @ _in_joints(leg, *rates) for leg, *rates in triples], axis=0)
        + np.sum(
            [
                leg.rates.T @ _against(leg, moment) + platform.angle_partials[0].T @ moment
                for leg, moment in zip(legs, dragged, strict=True)
            ],
            axis=0,
        ),
        remainders=remainders,
        kinetic=sum(kinetic_energy(*pair) for pair in pairs)
        + 0.5 * float(np.concatenate(qd) @ turned @ np.concatenate(qd)),
        potential=sum(potential_energy(*pair, gravity) for pair in pairs)
        + sum(stored(leg.leg.joints, leg.q) for leg in legs),
        dissipation=sum(float(friction(leg.leg.joints, rate) @ rate) for leg, rate, _ in triples)
        + sum(float(moment @ of) for moment, of in zip(dragged, turning, strict=True)),
        dragged=dragged,
        in_space=carried_links,
        gravity=gravity,
    )


def _against(leg: _LegKinematics, moment: Array) -> Array:
    """(m,) forces along the joints that a moment on the last link spares."""
    return np.asarray(-leg.bodies.angle_partials[-1].T @ moment)


def _in_joints(leg: _LegKinematics, rate: Array, rotors: Array) -> Array:
    """(m,) forces along the joints that friction and springs take, and rotors those given."""
    joints = leg.leg.joints
    return friction(joints, rate) + springs(joints, leg.q) + rotors


def _all_rates(legs: list[_LegKinematics]) -> Array:
    """(nj, nv) rates of all joints by V."""
    return np.vstack([leg.rates for leg in legs])


def _joint_acceleration(
    manipulator: Manipulator, leg: _LegKinematics, platform: Pose, rate: Array, A: Array
) -> tuple[Array, Array, list[Pose]]:
    """Joint accelerations (m,), what they leave of the closure's second derivative, the links."""
    # Rows of `rates` that belong to extra joints only select their entry of A.
    acceleration = np.where([joint.extra for joint in leg.leg.joints], leg.rates @ A, 0.0)

    def second_derivative() -> tuple[Array, list[Pose]]:
        poses = chain_poses(leg.leg, taylor(leg.q, rate, acceleration))
        return closure_residual(manipulator.space, leg.leg, poses[-1], platform).second, poses

    acceleration[leg.free] -= leg.split @ second_derivative()[0]
    return acceleration, *second_derivative()


def _leg_results(
    manipulator: Manipulator,
    legs: list[_LegKinematics],
    moving: _Motion,
    tau: Array,
    lam: Array,
) -> tuple[LegResult, ...]:
    actuators = np.zeros(moving.qd.size)
    actuators[actuated_indices(manipulator)] = tau
    results, first = [], 0
    parts = zip(
        legs, moving.links, moving.in_space, joint_slices(manipulator), moving.dragged, strict=True
    )
    for leg, motion, in_space, where, moment in parts:
        own = slice(first, first + leg.multipliers.shape[1])
        first = own.stop
        forces = virtual_forces(leg.bodies, in_space, moving.gravity)
        forces += _in_joints(leg, moving.qd[where], moving.rotors[where]) + _against(leg, moment)
        # Virtual power of joint j: reaction . v_j = tau_j - Gamma_j.
        power = (actuators[where] - forces)[leg.free]
        reaction = leg.split.T @ power
        results.append(
            LegResult(
                motion=motion,
                jacobian=leg.jacobian,
                rates=leg.rates,
                joint_forces=forces,
                joint_inertia=inertia_matrix(leg.bodies) + rotor_matrix(manipulator)[where, where],
                reaction=leg.wrench_map @ (reaction + leg.multipliers @ lam[own])
                - np.concatenate((np.zeros(3), moment)),
                constraint_wrenches=(leg.wrench_map @ leg.multipliers).T,
            )
        )
    return tuple(results)
