"""Dynamics by Pinocchio: the tree of bodies, projected on the loop closures.

The legs and the platform are branches of one tree; every platform joint is a closure
between the end of a branch and the platform.  Kinematics, inertia matrix and bias forces
of the tree are Pinocchio's.  The closures act in two ways: `dynamics` eliminates the joint
rates, `forward_dynamics` keeps all of them with multipliers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from pne_sym.model.manipulator import (
    Body,
    Joint,
    JointKind,
    Leg,
    Manipulator,
    PlatformJointKind,
    Space,
)
from tests.oracle.coordinates import (
    actuated_indices,
    extra_indices,
    is_planar,
    pose_size,
    task_size,
)
from tests.oracle.jets import Array

_RCOND = 1e-9
_AXES = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


@dataclass(frozen=True)
class TreeDynamics:
    """Matrices and loads by Pinocchio; shapes and meaning as in `projection.Result`.

    Attributes:
        M: (nv, nv).
        Z: (nv,).
        H: (nv, nu).
        qd: (nj,).
        qdd: (nj,).
        tau: (nu,), least norm where not unique.
        kinetic: J.
        potential: J, zero at the base origin.
    """

    M: Array
    Z: Array
    H: Array
    qd: Array
    qdd: Array
    tau: Array
    kinetic: float
    potential: float


@dataclass(frozen=True)
class TreeMotion:
    """Accelerations and closure loads under given driving forces.

    Attributes:
        A: (nv,) platform and extra coordinates.
        qdd: (nj,) joints.
        reactions: (legs, 6) force and moment of each leg on the platform at its platform
            joint, base axes; meaningful where the closures are independent.
    """

    A: Array
    qdd: Array
    reactions: Array


@dataclass(frozen=True)
class _Closures:
    """Closure conditions of all legs: rates `jacobian` v, accelerations + `drift`.

    Row blocks belong to legs; `wrench` (6, rows of the leg) turns the leg's multipliers
    into the wrench on the platform at the joint.
    """

    jacobian: Array
    drift: Array
    wrenches: list[Array]
    rows: list[slice]


class PinocchioModel:
    """A manipulator as a Pinocchio tree with loop closures.

    The tree's velocity v holds the platform's entries first, then the joint rates in the
    order of q.  The platform's entries are Pinocchio's own: body axes for joints with
    free rotation in space.
    """

    def __init__(self, manipulator: Manipulator) -> None:
        self.manipulator = manipulator
        self.model: Any = pin.Model()
        self.model.gravity = pin.Motion(np.array(manipulator.gravity, dtype=float), np.zeros(3))
        platform = self._add_platform()
        self._leg_frames: list[int] = []
        self._platform_frames: list[int] = []
        for number, leg in enumerate(manipulator.legs):
            last = self._add_leg(number, leg)
            self._leg_frames.append(
                self._add_frame(f"end{number}", last, leg.platform_joint.offset)
            )
            self._platform_frames.append(
                self._add_frame(f"seat{number}", platform, leg.platform_point)
            )
        self._data: Any = self.model.createData()
        self.task = task_size(manipulator.space)
        self._extra = [self.task + index for index in extra_indices(manipulator)]
        self._actuated = [self.task + index for index in actuated_indices(manipulator)]

    def dynamics(
        self,
        X: Array,
        q: Array,
        V: Array,
        A: Array | None = None,
        wrench: Array | None = None,
    ) -> TreeDynamics:
        """Evaluate a closed state; arguments as those of `projection.project`."""
        V = np.asarray(V, dtype=float)
        A = np.zeros_like(V) if A is None else np.asarray(A, dtype=float)
        configuration = self._configuration(X, q)
        closures = self._closures(configuration, np.zeros(self.model.nv))
        G = self._elimination(closures, X)
        v = G @ V
        closures = self._closures(configuration, v)
        inertia, bias = self._tree(configuration, v)
        still = self._tree_acceleration(closures, X, V, np.zeros_like(V))
        moving = self._tree_acceleration(closures, X, V, A)
        selection = np.eye(self.model.nv)[:, self._actuated]
        load = inertia @ moving + bias - self._tree_load(X, wrench)
        return TreeDynamics(
            M=G.T @ inertia @ G,
            Z=G.T @ (inertia @ still + bias),
            H=G.T @ selection,
            qd=v[self.task :],
            qdd=moving[self.task :],
            tau=self._actuators(closures, selection, load),
            kinetic=float(pin.computeKineticEnergy(self.model, self._data, configuration, v)),
            potential=float(pin.computePotentialEnergy(self.model, self._data, configuration)),
        )

    def forward_dynamics(
        self, X: Array, q: Array, V: Array, tau: Array, wrench: Array | None = None
    ) -> TreeMotion:
        """Accelerations under driving forces, from the tree's equations with multipliers."""
        V = np.asarray(V, dtype=float)
        configuration = self._configuration(X, q)
        still = self._closures(configuration, np.zeros(self.model.nv))
        v = self._elimination(still, X) @ V
        closures = self._closures(configuration, v)
        inertia, bias = self._tree(configuration, v)
        load = self._tree_load(X, wrench) - bias
        load[self._actuated] += tau
        C = closures.jacobian
        system = np.block([[inertia, C.T], [C, np.zeros((C.shape[0],) * 2)]])
        solution = np.linalg.lstsq(system, np.concatenate([load, -closures.drift]), rcond=1e-14)[0]
        acceleration, multipliers = np.split(solution, [self.model.nv])
        # The multipliers act on the legs; the platform feels their opposite through the
        # closure's negative platform side, hence directly.
        reactions = np.array(
            [
                wrench_map @ multipliers[rows]
                for wrench_map, rows in zip(closures.wrenches, closures.rows, strict=True)
            ]
        )
        platform = self._platform_map(X)
        A = np.linalg.solve(platform, acceleration[: self.task] - self._platform_bias(X, V))
        return TreeMotion(
            np.concatenate([A, acceleration[self._extra]]), acceleration[self.task :], reactions
        )

    def _add_platform(self) -> int:
        space, parent = self.manipulator.space, 0
        placement = pin.SE3.Identity()
        if space is Space.SPHERICAL:
            placement.translation = np.array(self.manipulator.fixed_centre, dtype=float)
        joints = {
            Space.POINT: [pin.JointModelPX(), pin.JointModelPY()],
            Space.PLANAR: [pin.JointModelPX(), pin.JointModelPY(), pin.JointModelRZ()],
            Space.SPATIAL: [pin.JointModelFreeFlyer()],
            Space.TRANSLATIONAL: [pin.JointModelTranslation()],
            Space.SPHERICAL: [pin.JointModelSpherical()],
        }[space]
        for number, joint in enumerate(joints):
            parent = self.model.addJoint(parent, joint, placement, f"platform{number}")
        self._append(parent, self.manipulator.platform)
        return parent

    def _add_leg(self, number: int, leg: Leg) -> int:
        parent = 0
        base = pin.SE3(np.array(leg.base_frame, dtype=float), np.array(leg.base_point, dtype=float))
        for index, joint in enumerate(leg.joints):
            placement = pin.SE3(np.eye(3), np.array(joint.offset, dtype=float))
            if index == 0:
                placement = base * placement
            name = f"leg{number}_{index}"
            parent = self.model.addJoint(parent, _joint_model(joint), placement, name)
            self._append(parent, joint.link)
        return parent

    def _append(self, joint_id: int, body: Body) -> None:
        inertia = pin.Inertia(
            body.mass,
            np.array(body.centre_of_mass, dtype=float),
            np.array(body.inertia, dtype=float),
        )
        self.model.appendBodyToJoint(joint_id, inertia, pin.SE3.Identity())

    def _add_frame(self, name: str, joint_id: int, point: tuple[float, float, float]) -> int:
        placement = pin.SE3(np.eye(3), np.array(point, dtype=float))
        frame = pin.Frame(name, joint_id, placement, pin.FrameType.OP_FRAME)
        return int(self.model.addFrame(frame))

    def _configuration(self, X: Array, q: Array) -> Array:
        """Pinocchio's configuration: its quaternions are scalar last as well."""
        configuration = np.concatenate([X[: pose_size(self.manipulator.space)], q])
        normalised: Array = pin.normalize(self.model, configuration)
        return normalised

    def _platform_map(self, X: Array) -> Array:
        """(nt, nt) from V to the tree's platform velocity: body axes where it turns freely."""
        space = self.manipulator.space
        if space not in (Space.SPATIAL, Space.SPHERICAL):
            return np.eye(self.task)
        quaternion = np.asarray(X)[pose_size(space) - 4 : pose_size(space)]
        to_body = pin.Quaternion(quaternion / np.linalg.norm(quaternion)).matrix().T
        return np.kron(np.eye(self.task // 3), to_body)

    def _platform_bias(self, X: Array, V: Array) -> Array:
        """What differentiating `_platform_map` adds to the tree's platform acceleration."""
        bias = np.zeros(self.task)
        if self.manipulator.space is Space.SPATIAL:
            bias[:3] = -np.cross(V[3:6], V[:3])
        return self._platform_map(X) @ bias

    def _tree(self, configuration: Array, v: Array) -> tuple[Array, Array]:
        """Inertia matrix and bias forces of the tree."""
        upper = np.triu(pin.crba(self.model, self._data, configuration))
        inertia = upper + np.triu(upper, 1).T
        bias: Array = pin.nonLinearEffects(self.model, self._data, configuration, v).copy()
        return inertia, bias

    def _tree_load(self, X: Array, wrench: Array | None) -> Array:
        load = np.zeros(self.model.nv)
        if wrench is not None:
            load[: self.task] = np.linalg.solve(self._platform_map(X).T, wrench)
        return load

    def _given_and_free(self) -> tuple[list[int], list[int]]:
        """Entries of v that V determines directly, and those that the closures determine."""
        given = [*range(self.task), *self._extra]
        return given, [index for index in range(self.model.nv) if index not in given]

    def _elimination(self, closures: _Closures, X: Array) -> Array:
        """(tree nv, nv): v = G V, least squares where legs leave degrees of freedom out."""
        given, free = self._given_and_free()
        G = np.zeros((self.model.nv, len(given)))
        G[: self.task, : self.task] = self._platform_map(X)
        G[self._extra, range(self.task, len(given))] = 1.0
        G[free] = -np.linalg.pinv(closures.jacobian[:, free]) @ (closures.jacobian @ G)
        return G

    def _tree_acceleration(self, closures: _Closures, X: Array, V: Array, A: Array) -> Array:
        _, free = self._given_and_free()
        acceleration = np.zeros(self.model.nv)
        acceleration[: self.task] = self._platform_map(X) @ A[: self.task]
        acceleration[: self.task] += self._platform_bias(X, V)
        acceleration[self._extra] = A[self.task :]
        demand = closures.jacobian @ acceleration + closures.drift
        acceleration[free] = -np.linalg.pinv(closures.jacobian[:, free]) @ demand
        return acceleration

    def _actuators(self, closures: _Closures, selection: Array, load: Array) -> Array:
        """Least-norm driving forces from the virtual motions that closures allow.

        The acceleration must have forces: that of extra coordinates without an actuator, too.
        """
        _, values, right = np.linalg.svd(closures.jacobian)
        rank = int((values > _RCOND * values.max()).sum())
        motions = right[rank:]
        tau: Array = np.linalg.pinv(motions @ selection, rcond=_RCOND) @ (motions @ load)
        return tau

    def _closures(self, configuration: Array, v: Array) -> _Closures:
        """All closure conditions, with drift: their acceleration at zero tree acceleration."""
        zero = np.zeros(self.model.nv)
        pin.forwardKinematics(self.model, self._data, configuration, v, zero)
        pin.computeJointJacobians(self.model, self._data, configuration)
        pin.updateFramePlacements(self.model, self._data)
        jacobians, drifts, wrenches, rows = [], [], [], []
        first = 0
        for number in range(len(self.manipulator.legs)):
            jacobian, drift, wrench = self._leg_closure(number)
            jacobians.append(jacobian)
            drifts.append(drift)
            wrenches.append(wrench)
            rows.append(slice(first, first + drift.size))
            first += drift.size
        return _Closures(np.vstack(jacobians), np.concatenate(drifts), wrenches, rows)

    def _leg_closure(self, number: int) -> tuple[Array, Array, Array]:
        """Jacobian, drift and wrench map of one leg: leg's side minus platform's."""
        end, seat = self._leg_frames[number], self._platform_frames[number]
        directions, spin = self._directions(number, end, seat)
        relative = self._frame_jacobian(end) - self._frame_jacobian(seat)
        drift = self._frame_acceleration(end) - self._frame_acceleration(seat)
        drift[3:] += spin
        return directions @ relative, directions @ drift, directions.T

    def _directions(self, number: int, end: int, seat: int) -> tuple[Array, Array]:
        """Closure conditions (rows, 6) on relative twists, and the term (3,) that the
        turning of the directions adds to the relative angular acceleration."""
        leg = self.manipulator.legs[number]
        joint, planar = leg.platform_joint, is_planar(self.manipulator.space)
        translations = np.eye(6)[: 2 if planar else 3]
        if joint.kind is PlatformJointKind.RIGID:
            return np.vstack([translations, np.eye(6)[5:] if planar else np.eye(6)[3:]]), np.zeros(
                3
            )
        if planar or joint.kind is PlatformJointKind.SPHERICAL:
            return translations, np.zeros(3)
        spin_end, spin_seat = self._frame_spin(end), self._frame_spin(seat)
        link_axis = self._data.oMf[end].rotation @ np.array(joint.axis_link)
        seat_axis = self._data.oMf[seat].rotation @ np.array(joint.axis_platform)
        if joint.kind is PlatformJointKind.REVOLUTE:
            # omega_seat - omega_end stays along the axis, which turns with the link.
            across = np.linalg.svd(link_axis[None])[2][1:]
            rows = np.hstack([np.zeros((2, 3)), across])
            return np.vstack([translations, rows]), np.cross(spin_end, spin_seat)
        # d/dt (a . b) = (omega_end - omega_seat) . (a x b)
        normal = np.cross(link_axis, seat_axis)
        normal_rate = np.cross(np.cross(spin_end, link_axis), seat_axis)
        normal_rate += np.cross(link_axis, np.cross(spin_seat, seat_axis))
        along = (spin_end - spin_seat) @ normal_rate / (normal @ normal)
        row = np.concatenate([np.zeros(3), normal])[None]
        return np.vstack([translations, row]), along * normal

    def _frame_jacobian(self, frame: int) -> Array:
        jacobian: Array = pin.getFrameJacobian(self.model, self._data, frame, _AXES)
        return jacobian

    def _frame_acceleration(self, frame: int) -> Array:
        motion = pin.getFrameClassicalAcceleration(self.model, self._data, frame, _AXES)
        return np.concatenate([motion.linear, motion.angular])

    def _frame_spin(self, frame: int) -> Array:
        return np.array(pin.getFrameVelocity(self.model, self._data, frame, _AXES).angular)


def _joint_model(joint: Joint) -> Any:
    axis = np.array(joint.axis, dtype=float)
    axis /= np.linalg.norm(axis)
    if joint.kind is JointKind.REVOLUTE:
        return pin.JointModelRevoluteUnaligned(axis)
    if joint.kind is JointKind.PRISMATIC:
        return pin.JointModelPrismaticUnaligned(axis)
    return pin.JointModelHelicalUnaligned(axis, joint.pitch)
