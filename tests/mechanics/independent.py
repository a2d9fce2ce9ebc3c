"""Independent values of named quantities: name pattern -> function of the oracle's results.

None of these functions looks at the derivation.  They use poses, velocities and accelerations of
the bodies (differentiated poses), Newton's and Euler's laws link by link, and the oracle's joint
forces and inertia matrices (d'Alembert).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np

from pne_sym.model.manipulator import Body, JointKind, PlatformJointKind, Space
from tests.mechanics.evaluation import Array, Names
from tests.oracle.closure import leg_closure, perpendicular_pair
from tests.oracle.coordinates import is_planar, joint_slices, pose_size, task_size
from tests.oracle.effects import friction, margins, rotors, springs, stored, turning_friction
from tests.oracle.jets import cross, cross_matrix
from tests.oracle.projection import completing

_SLIDE = JointKind.PRISMATIC


class Facts:
    """What the oracle says about one leg at one acceleration; joints count from 1.

    The axes of frames (`turn`, `axes`), to which some scalars refer, are the derivation's; they
    are constant in a link and are turned by the oracle's rotations.
    """

    def __init__(self, names: Names) -> None:
        assert names.index is not None
        self.names, self.s, self.leg = names, names.situation, names.leg
        self.index = names.index
        self.manipulator = self.s.manipulator
        self.planar = is_planar(self.manipulator.space)
        self.result = self.s.oracle.legs[self.index]
        self.motion, self.platform = self.result.motion, self.s.oracle.platform
        self.count = len(self.leg.joints)
        self.gravity = np.array(self.manipulator.gravity)
        self.q = self._own(self.s.state.q)
        self.qd, self.qdd = self._own(self.s.oracle.qd), self._own(self.s.oracle.qdd)
        self.free = [j for j in range(1, self.count + 1) if not self.leg.joints[j - 1].extra]
        self.extras = [j for j in range(1, self.count + 1) if self.leg.joints[j - 1].extra]

    def _own(self, flat: Array) -> Any:
        """A leg's entries of a flat vector, with a dummy in front."""
        return np.concatenate(([np.nan], flat[joint_slices(self.manipulator)[self.index]]))

    # ---- kinematics -------------------------------------------------------------------------

    def turns(self, j: int) -> bool:
        return self.leg.joints[j - 1].kind is not JointKind.PRISMATIC

    def group(self, j: int) -> int:
        """The turning joint that link j turns with, 0 for the base."""
        return max((k for k in range(1, j + 1) if self.turns(k)), default=0)

    def members(self, group: int) -> list[int]:
        return [j for j in range(1, self.count + 1) if self.group(j) == group]

    def rotation(self, j: int) -> Any:
        return self.motion.rotation[j - 1] if j else np.array(self.leg.base_frame)

    def link_point(self, i: int, point: Any) -> tuple[Array, Array]:
        """Position and acceleration of a point fixed in link i (0: the base)."""
        arm = self.rotation(i) @ np.array(point)
        if i == 0:
            return np.array(self.leg.base_point) + arm, np.zeros(3)
        w, a = self.motion.angular_velocity[i - 1], self.motion.angular_acceleration[i - 1]
        place = self.motion.origin[i - 1] + arm
        return place, self.motion.acceleration[i - 1] + cross(a, arm) + cross(w, cross(w, arm))

    def joint_point(self, j: int) -> tuple[Array, Array]:
        """Origin of joint j before its own displacement; j = m + 1: the tip."""
        end = j == self.count + 1
        offset = self.leg.platform_joint.offset if end else self.leg.joints[j - 1].offset
        return self.link_point(j - 1, offset)

    def tip_centre(self, j: int) -> Any:
        """Where the revolutes beyond slide j meet, with the slide at zero."""
        first = min(k for k in range(j + 1, self.count + 1) if self.turns(k))
        return self.joint_point(first)[0] - self.q[j] * self.e(j)

    @property
    def tip(self) -> Any:
        return self.joint_point(self.count + 1)[0]

    @cached_property
    def arm(self) -> Any:
        """Platform origin to connection point."""
        return self.platform.rotation @ np.array(self.leg.platform_point)

    @property
    def point(self) -> Any:
        """Connection point, as the platform carries it."""
        return self.platform.origin + self.arm

    @property
    def centripetal(self) -> Any:
        w = self.platform.angular_velocity
        return cross(w, cross(w, self.arm))

    @property
    def tangential(self) -> Any:
        return self.platform.acceleration + cross(self.platform.angular_acceleration, self.arm)

    def e(self, j: int) -> Any:
        return self.rotation(j) @ np.array(self.leg.joints[j - 1].axis)

    def v(self, j: int) -> Any:
        column = np.zeros(3)
        rows = 2 if self.planar else 3
        column[:rows] = self.result.jacobian[:rows, j - 1]
        return column

    def omega(self, j: int) -> Any:
        return self.motion.angular_velocity[j - 1] if j else np.zeros(3)

    def alpha(self, j: int) -> Any:
        return self.motion.angular_acceleration[j - 1] if j else np.zeros(3)

    @cached_property
    def point_leg(self) -> bool:
        """Whether the leg holds the platform by a force alone."""
        return self.planar or self.leg.platform_joint.kind is PlatformJointKind.SPHERICAL

    @cached_property
    def constrained(self) -> bool:
        return len(self.result.constraint_wrenches) > 0

    @cached_property
    def moment_directions(self) -> Any:
        """Rows: unit directions in which the platform joint transmits moments."""
        joint = self.leg.platform_joint
        if self.point_leg:
            return np.zeros((0, 3))
        if joint.kind is PlatformJointKind.RIGID:
            return np.eye(3)
        axis = self.platform.rotation @ np.array(joint.axis_platform)
        if joint.kind is PlatformJointKind.UNIVERSAL:
            return cross(self.rotation(self.count) @ np.array(joint.axis_link), axis)[None]
        return np.array(perpendicular_pair(axis))

    @cached_property
    def amount_directions(self) -> Any:
        """Rows: the directions of moments whose amounts the derivation names, as it states them."""
        joint, last = self.leg.platform_joint, self.rotation(self.count)
        if joint.kind is PlatformJointKind.RIGID:
            return last.T[[2, 0, 1]]
        if joint.kind is not PlatformJointKind.REVOLUTE:
            return self.moment_directions
        axis = np.array(joint.axis_link)
        main = int(np.argmax(np.abs(axis)))
        assert abs(axis[main]) == 1.0, "axes in general position have no value here"
        return [last @ cross(np.eye(3)[(main + k) % 3], axis) for k in (1, 2)]

    def amounts(self, vector: Array) -> Any:
        """Components of a vector along those directions."""
        return np.linalg.pinv(np.array(self.amount_directions).T) @ vector

    @cached_property
    def duals(self) -> tuple[Any, Any]:
        """Forces w_j and moments o_j of the reciprocal wrenches: rows by joint number."""
        n = self.moment_directions
        screws = [np.concatenate([self.v(j), n @ self.e(j) * self.turns(j)]) for j in self.free]
        if self.point_leg:
            inverse = np.linalg.pinv(np.array(screws).T)
        else:
            left = np.linalg.svd(np.array(screws).T)[0][:, len(self.free) :]
            motions = completing(Space.SPATIAL, left, None)
            inverse = np.linalg.inv(np.column_stack([*screws, motions]))[: len(self.free)]
        w, o = np.full((self.count + 1, 3), np.nan), np.full((self.count + 1, 3), np.nan)
        w[self.free], o[self.free] = inverse[:, :3], inverse[:, 3:] @ n
        return w, o

    def w(self, j: int) -> Any:
        return self.duals[0][j]

    def o(self, j: int) -> Any:
        return self.duals[1][j]

    # ---- bodies -----------------------------------------------------------------------------

    def mass(self, j: int) -> float:
        return self.leg.joints[j - 1].link.mass

    def has_mass(self, j: int) -> bool:
        return not self.leg.joints[j - 1].link.is_massless

    @cached_property
    def tip_body(self) -> int:
        """The last link, where it is referred to the connection point; else 0.

        It is where it has inertia, and the leg leaves the connection point free to move.
        """
        return self.count if self.has_mass(self.count) and not self.constrained else 0

    def reference(self, j: int) -> tuple[Array, Array]:
        """Reference point of link j and its acceleration."""
        if j == self.tip_body:
            return self.tip, self.tangential + self.centripetal
        return self.motion.origin[j - 1], self.motion.acceleration[j - 1]

    def tensor(self, j: int) -> Any:
        """Inertia about the centre of mass, base axes; in the plane izz alone."""
        local = np.array(self.leg.joints[j - 1].link.inertia, dtype=float)
        if self.planar:
            local = np.diag([0.0, 0.0, local[2, 2]])
        return self.rotation(j) @ local @ self.rotation(j).T

    def first_moment(self, j: int) -> Any:
        return self.mass(j) * (self.motion.centre[j - 1] - self.reference(j)[0])

    def reference_tensor(self, j: int) -> Any:
        arm = self.motion.centre[j - 1] - self.reference(j)[0]
        return self.tensor(j) + point_inertia(self.mass(j), arm)

    def force(self, j: int) -> Any:
        """Newton: inertia force of link j less its weight."""
        return self.mass(j) * (self.motion.centre_acceleration[j - 1] - self.gravity)

    def moment(self, j: int) -> Any:
        """Euler: inertia moment of link j about its centre of mass."""
        w, tensor = self.omega(j), self.tensor(j)
        return tensor @ self.alpha(j) + cross(w, tensor @ w)

    def moment_about(self, j: int, point: Array) -> Any:
        return self.moment(j) + cross(self.motion.centre[j - 1] - point, self.force(j))

    @property
    def tip_force(self) -> Any:
        return self.force(self.count) if self.tip_body else np.zeros(3)

    def gamma(self, j: int) -> float:
        """All distal inertia and weight along freedom j, the last link's force left out."""
        return float(self.result.joint_forces[j - 1] - self.v(j) @ self.tip_force)

    def combined(self, *, moment: bool = False, reduced: bool) -> Any:
        """Sum over the degrees of freedom of the reciprocal wrench times the distal forces."""
        vectors = self.o if moment else self.w
        forces = self.gamma if reduced else (lambda j: float(self.result.joint_forces[j - 1]))
        return np.sum([vectors(j) * forces(j) for j in self.free], axis=0)

    def groups_from(self, group: int) -> list[int]:
        return [j for j in range(1, self.count + 1) if self.group(j) >= group and self.has_mass(j)]

    @property
    def tip_mass(self) -> float:
        """Mass that is counted with the platform."""
        return self.mass(self.count) if self.tip_body else 0.0

    @cached_property
    def extra_columns(self) -> list[int]:
        """Entries of V that are the leg's extra rates."""
        legs = self.manipulator.legs[: self.index]
        first = task_size(self.manipulator.space) + sum(j.extra for x in legs for j in x.joints)
        return [first + k for k in range(len(self.extras))]

    def extra_coordinate(self, j: int) -> float:
        first = self.extra_columns[self.extras.index(j)] - task_size(self.manipulator.space)
        return float(self.s.state.X[pose_size(self.manipulator.space) + first])


def point_inertia(mass: float, arm: Array) -> Any:
    matrix: Array = mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return matrix


def square(w: Array) -> Any:
    tilde = cross_matrix(w)
    return tilde @ tilde


Value = Callable[[Facts, int], Any]
LEG: list[tuple[str, Value]] = []
"""Patterns of a leg's names; a number in the name is the joint's."""


def value_of(*patterns: str) -> Callable[[Value], Value]:
    def register(function: Value) -> Value:
        LEG.extend((pattern, function) for pattern in patterns)
        return function

    return register


def leg_value(stem: str) -> tuple[Value, int] | None:
    """The function for a name without its leg type, and the number in it."""
    for pattern, function in LEG:
        match = re.fullmatch(pattern, stem)
        if match:
            return function, int(match.group(1)) if match.groups() else 0
    return None


# ---- geometry -----------------------------------------------------------------------------------


@value_of("S")
def _s(f: Facts, j: int) -> Any:
    return f.point - np.array(f.leg.base_point)


@value_of(r"x_(\d+)", r"xi_(\d+)")
def _x(f: Facts, j: int) -> Any:
    return f.point - f.joint_point(j)[0]


@value_of(r"r_(\d+)")
def _r(f: Facts, j: int) -> Any:
    return f.tip - f.joint_point(j)[0]


@value_of("residual")
def _residual(f: Facts, j: int) -> Any:
    return f.point - f.tip


@value_of("size_0")
def _size_at_home(f: Facts, j: int) -> Any:
    """The largest lever arm of the leg type at home if it slides, else a small part of any."""
    arms = _arms_at_home(f)
    info = next(t for t in f.names.derivation.leg_types if f.index in t.indices)
    own = max(arms[index] for index in info.indices)
    least = 1e-3 * (max(arms) or 1.0)
    turning = [j for j, joint in enumerate(f.leg.joints) if joint.kind is not _SLIDE]
    slides = turning and any(
        joint.kind is not JointKind.REVOLUTE for joint in f.leg.joints[turning[0] :]
    )
    return float(f"{max(own, least) if slides else least:.5e}")


def _arms_at_home(f: Facts) -> list[float]:
    m = f.manipulator
    X, q = np.array(m.home.X), np.array(m.home.q)
    found = []
    for leg, where in zip(m.legs, joint_slices(m), strict=True):
        columns = leg_closure(m, leg, X, q[where]).joints[: 2 if f.planar else 3]
        turning = [joint.kind is not _SLIDE for joint in leg.joints]
        found.append(float(np.linalg.norm(columns[:, turning], axis=0).max(initial=0.0)))
    return found


@value_of("size")
def _size(f: Facts, j: int) -> Any:
    """Offsets beyond the first turning joint, each link's across what its joints slide along."""
    joints, squared = f.leg.joints, _size_at_home(f, j) ** 2
    turning = [k for k, joint in enumerate(joints) if joint.kind is not _SLIDE]
    offsets = [*(joint.offset for joint in joints), f.leg.platform_joint.offset]
    for first, following in zip(turning, [*turning, len(joints)][1:], strict=True):
        along = [joint.axis for joint in joints[first + 1 : following]]
        helical = joints[first].kind is JointKind.HELICAL
        along += [joints[first].axis] if helical or first == turning[0] else []
        axes = [a for k, a in enumerate(along) if not _parallel_to_any(a, along[:k])]
        rows = np.array([np.sum(offsets[first + 1 : following + 1], axis=0), *axes])
        squared += np.linalg.det(rows @ rows.T) if len(rows) <= 3 else 0.0
    return np.sqrt(squared + sum(joint.pitch**2 for joint in joints))


def _parallel_to_any(axis: Any, others: Any) -> bool:
    return any(np.linalg.norm(np.cross(axis, other)) < 1e-9 for other in others)


@value_of(r"rho_tip_(\d+)")
def _rho_tip(f: Facts, j: int) -> Any:
    return f.motion.centre[j - 1] - f.tip


@value_of(r"h_(\d+)")
def _h(f: Facts, j: int) -> Any:
    return f.first_moment(j)


@value_of(r"h_group_(\d+)")
def _h_group(f: Facts, j: int) -> Any:
    return sum(f.first_moment(k) for k in f.members(j) if f.has_mass(k))


@value_of(r"J_(\d+)")
def _j(f: Facts, j: int) -> Any:
    return f.reference_tensor(j)


@value_of(r"J_group_(\d+)")
def _j_group(f: Facts, j: int) -> Any:
    return sum(f.reference_tensor(k) for k in f.members(j) if f.has_mass(k))


@value_of(r"Sigma_(\d+)")
def _sigma(f: Facts, j: int) -> Any:
    total = _j_group(f, j)
    return 0.5 * np.trace(total) * np.eye(3) - total


@value_of(r"px_(\d+)")
def _px(f: Facts, j: int) -> Any:
    if not f.turns(j):
        return f.e(j) @ _projected(f, j)
    return f.names.rotation(f"{f.names.leg_type}.turn{j}")[:, 0] @ _projected(f, j)


@value_of(r"py_(\d+)")
def _py(f: Facts, j: int) -> Any:
    return f.names.rotation(f"{f.names.leg_type}.turn{j}")[:, 1] @ _projected(f, j)


def _projected(f: Facts, j: int) -> Any:
    """What the inverse kinematics of joint j projects on directions fixed in link j - 1."""
    found = (f.names.defined.get(f.names.named(f"p{axis}_{j}")) for axis in "xy")
    used = [f.names.stem(name) for equation in found if equation for name in equation.uses]
    platform_axis = f.leg.platform_joint.axis_platform
    if any(name.startswith("end_p") for name in used) and platform_axis is not None:
        return f.platform.rotation @ np.array(platform_axis)  # the joint turns an axis into place
    vector: Array = _x(f, j)
    if any(name.startswith("from_centre") for name in used):
        vector = vector - (f.tip_centre(j) - f.joint_point(j)[0])
    return vector


@value_of(r"c_(\d+)")
def _cosine(f: Facts, j: int) -> Any:
    return _turned(f, j)[0]


@value_of(r"s_(\d+)")
def _sine(f: Facts, j: int) -> Any:
    return _turned(f, j)[1]


def _turned(f: Facts, j: int) -> tuple[float, float]:
    """Cosine and sine of the angle from the turn frame to the link's axes."""
    turn = f.names.rotation(f"{f.names.leg_type}.turn{j}")
    axes = f.names.rotation(f"{f.names.leg_type}.axes{j}")
    local = turn.T @ axes
    assert np.allclose(local[:, 2], [0.0, 0.0, 1.0], atol=1e-12)
    return float(local[0, 0]), float(local[1, 0])


@value_of(r"q_(\d+)")
def _q(f: Facts, j: int) -> Any:
    return f.q[j]


# ---- rates --------------------------------------------------------------------------------------


@value_of("S_dot")
def _s_dot(f: Facts, j: int) -> Any:
    return f.platform.velocity + cross(f.platform.angular_velocity, f.arm)


@value_of("S_dot_rest")
def _s_dot_rest(f: Facts, j: int) -> Any:
    return _s_dot(f, j) - sum(f.v(k) * f.qd[k] for k in f.extras)


@value_of(r"v_(\d+)")
def _v(f: Facts, j: int) -> Any:
    return f.v(j)


@value_of(r"w_(\d+)")
def _w(f: Facts, j: int) -> Any:
    return f.w(j)


@value_of(r"o_(\d+)")
def _o(f: Facts, j: int) -> Any:
    return f.o(j)


@value_of(r"qd_(\d+)")
def _qd(f: Facts, j: int) -> Any:
    return f.qd[j]


@value_of(r"omega_(\d+)")
def _omega(f: Facts, j: int) -> Any:
    return f.omega(j)


@value_of(r"W_(\d+)")
def _w_tensor(f: Facts, j: int) -> Any:
    return square(f.omega(j))


@value_of(r"eta_(\d+)")
def _eta(f: Facts, j: int) -> Any:
    turning = sum((f.qd[k] * f.e(k) for k in f.free if f.turns(k)), np.zeros(3))
    return f.amount_directions[j - 1] @ turning


# ---- accelerations ------------------------------------------------------------------------------


@value_of("u_1")
def _u(f: Facts, j: int) -> Any:
    return f.centripetal


@value_of("a_p")
def _a_p(f: Facts, j: int) -> Any:
    return f.tangential


@value_of("S_ddot")
def _s_ddot(f: Facts, j: int) -> Any:
    return f.tangential + f.centripetal


@value_of(r"zeta_(\d+)")
def _zeta(f: Facts, j: int) -> Any:
    return f.alpha(j) - f.alpha(f.group(j - 1)) - f.qdd[j] * f.e(j)


@value_of(r"beta_(\d+)")
def _beta(f: Facts, j: int) -> Any:
    return f.alpha(j) - sum(f.qdd[k] * f.e(k) for k in range(1, j + 1) if f.turns(k))


@value_of("bias")
def _bias(f: Facts, j: int) -> Any:
    tip = f.joint_point(f.count + 1)[1]
    return tip - sum(f.v(k) * f.qdd[k] for k in range(1, f.count + 1))


@value_of("rel")
def _rel(f: Facts, j: int) -> Any:
    return _s_ddot(f, j) - _bias(f, j) - sum(f.v(k) * f.qdd[k] for k in f.extras)


@value_of(r"qdd_(\d+)")
def _qdd(f: Facts, j: int) -> Any:
    return f.qdd[j]


@value_of(r"etad_(\d+)")
def _eta_dot(f: Facts, j: int) -> Any:
    turning = sum((f.qdd[k] * f.e(k) for k in f.free if f.turns(k)), np.zeros(3))
    return f.amount_directions[j - 1] @ turning


@value_of(r"alpha_(\d+)")
def _alpha(f: Facts, j: int) -> Any:
    return f.alpha(j)


@value_of(r"B_(\d+)")
def _b(f: Facts, j: int) -> Any:
    return cross_matrix(f.alpha(j)) + square(f.omega(j))


@value_of(r"a_o_(\d+)")
def _a_o(f: Facts, j: int) -> Any:
    return f.joint_point(j)[1]


@value_of(r"acc_(\d+)")
def _acc(f: Facts, j: int) -> Any:
    return f.reference(j)[1] - f.gravity


# ---- forces -------------------------------------------------------------------------------------


@value_of(r"phi_(\d+)")
def _phi(f: Facts, j: int) -> Any:
    return f.force(j) - f.mass(j) * _acc(f, j)


@value_of(r"f_(\d+)")
def _f(f: Facts, j: int) -> Any:
    return f.force(j)


@value_of(r"mu_(\d+)")
def _mu(f: Facts, j: int) -> Any:
    return sum(f.moment_about(k, f.reference(k)[0]) for k in f.members(j) if f.has_mass(k))


@value_of(r"N_(\d+)")
def _n(f: Facts, j: int) -> Any:
    origin = f.joint_point(j)[0]
    total = sum(f.moment_about(k, origin) for k in f.groups_from(j))
    return total - cross(f.tip - origin, f.tip_force)


@value_of(r"T_(\d+)")
def _t(f: Facts, j: int) -> Any:
    return sum(f.force(k) for k in range(j, f.count + 1) if f.has_mass(k)) - f.tip_force


@value_of(r"Gamma_(\d+)")
def _gamma(f: Facts, j: int) -> Any:
    return f.gamma(j)


# ---- friction, springs, rotors -------------------------------------------------------------------


@value_of(r"vs2_(\d+)")
def _velocity_scale(f: Facts, j: int) -> Any:
    friction = f.leg.joints[j - 1].friction
    assert friction is not None
    return (friction.velocity_scale or 0.0) ** 2


@value_of(r"friction_(\d+)")
def _friction(f: Facts, j: int) -> Any:
    return friction(f.leg.joints, f.qd[1:])[j - 1]


@value_of("vs2_end_p")
def _end_velocity_scale(f: Facts, j: int) -> Any:
    law = f.leg.platform_joint.friction
    assert law is not None
    return (law.velocity_scale or 0.0) ** 2


@value_of("omega_end")
def _end_turning(f: Facts, j: int) -> Any:
    return f.platform.angular_velocity - f.motion.angular_velocity[-1]


@value_of("friction_end")
def _end_friction(f: Facts, j: int) -> Any:
    return turning_friction(f.leg.platform_joint.friction, _end_turning(f, j))


@value_of(r"middle_(\d+)")
def _middle(f: Facts, j: int) -> Any:
    return float(np.mean(_range(f, j)))


@value_of(r"half_(\d+)")
def _half(f: Facts, j: int) -> Any:
    return 0.5 * float(np.diff(_range(f, j))[0])


@value_of(r"off_(\d+)")
def _off(f: Facts, j: int) -> Any:
    off, joint = f.q[j] - _middle(f, j), f.leg.joints[j - 1]
    wraps = joint.kind is JointKind.REVOLUTE and not joint.extra
    return off - 2.0 * np.pi * np.round(off / (2.0 * np.pi)) if wraps else off


@value_of(r"off2_(\d+)")
def _off2(f: Facts, j: int) -> Any:
    return _off(f, j) ** 2


@value_of(r"margin_(\d+)")
def _margin(f: Facts, j: int) -> Any:
    return margins(f.leg.joints, f.q[1:])[j - 1]


def _range(f: Facts, j: int) -> Any:
    limits = f.leg.joints[j - 1].limits
    assert limits is not None
    assert limits.displacement is not None
    return np.array(limits.displacement)


@value_of(r"spring_(\d+)")
def _spring(f: Facts, j: int) -> Any:
    return springs(f.leg.joints, f.q[1:])[j - 1]


@value_of(r"stored_(\d+)")
def _stored(f: Facts, j: int) -> Any:
    return stored(f.leg.joints[j - 1 : j], f.q[j : j + 1])


@value_of(r"rotor_(\d+)")
def _rotor(f: Facts, j: int) -> Any:
    return rotors(f.leg.joints)[j - 1]


@value_of(r"motor_(\d+)")
def _motor(f: Facts, j: int) -> Any:
    return f.qd[j] / _per_turn(f, j)


@value_of(r"per_turn_(\d+)")
def _per_turn(f: Facts, j: int) -> Any:
    actuator = f.leg.joints[j - 1].actuator
    assert actuator is not None
    return 1.0 / actuator.gear_ratio


# ---- composite bodies ---------------------------------------------------------------------------


def _beyond(f: Facts, k: int) -> list[int]:
    """Links from k outwards whose mass is not counted with the platform."""
    return [i for i in range(k, f.count + 1) if f.has_mass(i) and i != f.tip_body]


def _axis(f: Facts, j: int) -> Any:
    return f.e(j) if f.turns(j) else np.zeros(3)


def _start(f: Facts, group: int) -> Any:
    return f.joint_point(group)[0] if group else np.array(f.leg.base_point)


def _moves(f: Facts, k: int, point: Array) -> Any:
    """Acceleration of a point beyond joint k per unit acceleration of the joint."""
    if not f.turns(k):
        return f.e(k)
    pitch = f.leg.joints[k - 1].pitch
    return cross(f.e(k), point - f.motion.origin[k - 1]) + pitch * f.e(k)


def _effort(f: Facts, k: int, group: int) -> Any:
    """Moment about a group's origin per unit acceleration of joint k."""
    start = _start(f, group)
    total = sum(
        f.tensor(i) @ _axis(f, k)
        + cross(f.motion.centre[i - 1] - start, f.mass(i) * _moves(f, k, f.motion.centre[i - 1]))
        for i in _beyond(f, k)
    )
    return total + f.reference_tensor(f.tip_body) @ _axis(f, k) if f.tip_body else total


@value_of(r"hc_(\d+)")
def _composite_moment(f: Facts, j: int) -> Any:
    start = _start(f, f.group(j))
    return sum(f.mass(i) * (f.motion.centre[i - 1] - start) for i in _beyond(f, j))


@value_of(r"Jc_(\d+)")
def _composite_tensor(f: Facts, j: int) -> Any:
    start = _start(f, j)
    total = sum(
        f.tensor(i) + point_inertia(f.mass(i), f.motion.centre[i - 1] - start)
        for i in _beyond(f, j)
    )
    return total + f.reference_tensor(f.tip_body) if f.tip_body else total


@value_of(r"P_c_(\d+)")
def _composite_force(f: Facts, j: int) -> Any:
    return sum(f.mass(i) * _moves(f, j, f.motion.centre[i - 1]) for i in _beyond(f, j))


@value_of(r"L_c_(\d+)")
def _own_effort(f: Facts, j: int) -> Any:
    return _effort(f, j, f.group(j))


def _joint_inertia(f: Facts, j: int, k: int) -> Any:
    """The oracle's inertia matrix of the links, less what the platform accounts for."""
    full = float(f.result.joint_inertia[j - 1, k - 1])
    if j == k:
        full -= float(rotors(f.leg.joints)[j - 1])
    if not f.tip_body:
        return full
    h = f.first_moment(f.tip_body)
    return full - (
        f.tip_mass * f.v(j) @ f.v(k)
        + f.v(j) @ cross(_axis(f, k), h)
        + f.v(k) @ cross(_axis(f, j), h)
    )


def _effort_about(group: int) -> Value:
    return lambda f, j: _effort(f, j, group)


def _inertia_with(k: int) -> Value:
    return lambda f, j: _joint_inertia(f, j, k)


for _number in range(1, 10):
    value_of(rf"L_c_(\d+)_{_number}")(_effort_about(_number))
    value_of(rf"D_(\d+)_{_number}")(_inertia_with(_number))


@value_of("G")
def _g(f: Facts, j: int) -> Any:
    return f.combined(reduced=True)


@value_of("G_m")
def _g_m(f: Facts, j: int) -> Any:
    return f.combined(moment=True, reduced=True)


@value_of(r"G_m(\d+)")
def _g_amount(f: Facts, j: int) -> Any:
    return f.amounts(_g_m(f, 0))[j - 1]


@value_of("c")
def _c(f: Facts, j: int) -> Any:
    point = f.tangential + f.centripetal - f.gravity
    return -f.combined(reduced=False) + f.tip_mass * point


@value_of("c_true")
def _c_true(f: Facts, j: int) -> Any:
    """The reaction less what the actuators (and lambda) contribute."""
    force = f.result.reaction[:3].copy()
    tau, lam = iter(f.s.oracle.tau), f.s.oracle.lam
    for index, leg in enumerate(f.manipulator.legs):
        for k, joint in enumerate(leg.joints, 1):
            if joint.actuated:
                amount = next(tau)
                if index == f.index and k in f.free:
                    force -= amount * f.w(k)
    wrenches = [leg.constraint_wrenches for leg in f.s.oracle.legs]
    first = sum(len(w) for w in wrenches[: f.index])
    return force - lam[first : first + len(wrenches[f.index])] @ wrenches[f.index][:, :3]


@value_of("c_m")
def _c_m(f: Facts, j: int) -> Any:
    return -f.combined(moment=True, reduced=False) - _end_friction(f, j)


@value_of("Q")
def _q_matrix(f: Facts, j: int) -> Any:
    w = np.array([f.w(k) for k in f.free])
    rows = [k - 1 for k in f.free]
    full = w.T @ f.result.joint_inertia[np.ix_(rows, rows)] @ w
    return full - f.tip_mass * np.eye(3)


@value_of(r"P_(\d+)")
def _p(f: Facts, j: int) -> Any:
    column = f.extra_columns[f.extras.index(j)]
    return f.result.rates[:, column] @ f.result.joint_forces


@value_of(r"H_a_(\d+)")
def _h_a(f: Facts, j: int) -> Any:
    return cross(f.arm, f.w(j)) + f.o(j)


# ---- the platform -------------------------------------------------------------------------------


class PlatformFacts:
    """What the oracle says about the platform and the whole."""

    def __init__(self, legs: list[Facts]) -> None:
        self.legs, self.s = legs, legs[0].s
        self.oracle, self.motion = self.s.oracle, self.s.oracle.platform
        self.body = self.s.manipulator.platform
        self.gravity = np.array(self.s.manipulator.gravity)
        components = self.s.derivation.coordinates
        assert components is not None
        self.linear = [k for k, c in enumerate(components.components) if c < 3]
        self.angular = [k for k, c in enumerate(components.components) if c >= 3]

    @property
    def arm(self) -> Any:
        return self.motion.centre - self.motion.origin

    @property
    def tensor(self) -> Any:
        return self._tensor(self.body)

    def _tensor(self, body: Body) -> Any:
        """Inertia about the body's own centre, base axes."""
        local = np.array(body.inertia, dtype=float)
        if self.legs[0].planar:
            local = np.diag([0.0, 0.0, local[2, 2]])
        return self.motion.rotation @ local @ self.motion.rotation.T

    @cached_property
    def bodies(self) -> list[tuple[float, Any, Any, Any]]:
        """Platform and payload: mass, arm, inertia, and acceleration less gravity, base axes."""
        found = [(self.body.mass, self.arm, self.tensor, self.motion.centre_acceleration)]
        payload = self.s.manipulator.payload
        if payload:
            arm = self.motion.rotation @ np.array(payload.centre_of_mass)
            w, alpha = self.motion.angular_velocity, self.motion.angular_acceleration
            moved = self.motion.acceleration + cross(alpha, arm) + cross(w, cross(w, arm))
            found.append((payload.mass, arm, self._tensor(payload), moved))
        return [(mass, arm, tensor, a - self.gravity) for mass, arm, tensor, a in found]

    @property
    def force(self) -> Any:
        own = sum(mass * a for mass, _, _, a in self.bodies)
        return own + sum(f.tip_mass * _acceleration(f) for f in self.legs)

    @property
    def moment(self) -> Any:
        w, alpha = self.motion.angular_velocity, self.motion.angular_acceleration
        own = sum(
            tensor @ alpha + cross(w, tensor @ w) + cross(arm, mass * a)
            for mass, arm, tensor, a in self.bodies
        )
        return own + sum(cross(f.arm, f.tip_mass * _acceleration(f)) for f in self.legs)

    def block(self, matrix: Array, rows: list[int], columns: list[int]) -> Any:
        return matrix[np.ix_(rows, columns)]


def _acceleration(f: Facts) -> Any:
    return f.tangential + f.centripetal - f.gravity


def _lumped_mass(p: PlatformFacts) -> Any:
    return sum(mass for mass, *_ in p.bodies) + sum(f.tip_mass for f in p.legs)


def _lumped_moment(p: PlatformFacts) -> Any:
    own = sum(mass * arm for mass, arm, *_ in p.bodies)
    return own + sum(f.tip_mass * f.arm for f in p.legs)


def _lumped_tensor(p: PlatformFacts) -> Any:
    own = sum(tensor + point_inertia(mass, arm) for mass, arm, tensor, _ in p.bodies)
    return own + sum(point_inertia(f.tip_mass, f.arm) for f in p.legs)


PLATFORM: dict[str, Callable[[PlatformFacts], Any]] = {
    "W_p": lambda p: square(p.motion.angular_velocity),
    "B_p": lambda p: (
        cross_matrix(p.motion.angular_acceleration) + square(p.motion.angular_velocity)
    ),
    "a_t": lambda p: p.motion.acceleration - p.gravity,
    "m_star": _lumped_mass,
    "h_star": _lumped_moment,
    "J_star": _lumped_tensor,
    "f_p": lambda p: p.force,
    "mu_p": lambda p: p.moment,
    "potential": lambda p: p.oracle.potential,
    "dissipation": lambda p: p.oracle.dissipation,
    "b_c": lambda p: np.mean([f.arm for f in p.legs], axis=0),
    "spread": lambda p: np.sqrt(np.sum(np.var([f.arm for f in p.legs], axis=0))),
}
"""Quantities of the platform itself."""

ASSEMBLED: dict[str, tuple[str, Callable[[PlatformFacts], Any]]] = {
    "R_t": ("linear", lambda p: p.oracle.inertia_forces[p.linear]),
    "R_a": ("angular", lambda p: p.oracle.inertia_forces[p.angular]),
    "Z_t": ("linear", lambda p: p.oracle.Z[p.linear]),
    "Z_a": ("angular", lambda p: p.oracle.Z[p.angular]),
    "M_tt": ("linear linear", lambda p: p.block(p.oracle.M, p.linear, p.linear)),
    "M_ta": ("linear angular", lambda p: p.block(p.oracle.M, p.linear, p.angular)),
    "M_aa": ("angular angular", lambda p: p.block(p.oracle.M, p.angular, p.angular)),
}
"""Blocks of the whole: the rows (and columns) that are coordinates, and their values."""
