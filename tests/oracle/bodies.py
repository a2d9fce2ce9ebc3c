"""Motion of rigid bodies from their poses, and d'Alembert's sums over them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pne_sym.model.manipulator import Body
from tests.oracle.chain import carried_point
from tests.oracle.coordinates import Pose
from tests.oracle.jets import Array, angular_acceleration, angular_velocity


@dataclass(frozen=True)
class LinkMotion:
    """Motion of bodies at one instant; all vectors in base axes, base origin.

    The leading axis n runs over the links of a leg, from the base (n = m); it is absent for
    the platform.

    Attributes:
        origin: (n, 3) position of the body's frame, m.
        rotation: (n, 3, 3) from body axes to base axes.
        velocity: (n, 3) of the frame's origin, m/s.
        angular_velocity: (n, 3), rad/s.
        acceleration: (n, 3) of the frame's origin, m/s^2.
        angular_acceleration: (n, 3), rad/s^2.
        centre: (n, 3) position of the centre of mass, m.
        centre_velocity: (n, 3), m/s.
        centre_acceleration: (n, 3), m/s^2.
    """

    origin: Array
    rotation: Array
    velocity: Array
    angular_velocity: Array
    acceleration: Array
    angular_acceleration: Array
    centre: Array
    centre_velocity: Array
    centre_acceleration: Array


@dataclass(frozen=True)
class Bodies:
    """Inertias of n bodies and their partial velocities by some k rates.

    Attributes:
        mass: (n,), kg.
        inertia: (n, 3, 3) about the centres of mass, base axes, kg m^2.
        centre_partials: (n, 3, k) velocity of the centre of mass per rate.
        angle_partials: (n, 3, k) angular velocity per rate.
    """

    mass: Array
    inertia: Array
    centre_partials: Array
    angle_partials: Array

    def by(self, rates: Array) -> Bodies:
        """The same bodies by other rates: present rates = `rates` (k, l) times the new."""
        return Bodies(
            self.mass, self.inertia, self.centre_partials @ rates, self.angle_partials @ rates
        )


def bodies_of(bodies: list[Body], unit_motions: list[Pose]) -> Bodies:
    """Partial velocities from poses whose one leading axis (k,) holds one unit rate each."""
    centres, angles, tensors = [], [], []
    for body, pose in zip(bodies, unit_motions, strict=True):
        rotation = pose.rotation.value[0]
        centres.append(carried_point(pose, body.centre_of_mass).first.T)
        angles.append(angular_velocity(pose.rotation).T)
        tensors.append(rotation @ np.array(body.inertia, dtype=float) @ rotation.T)
    mass = np.array([body.mass for body in bodies], dtype=float)
    return Bodies(mass, np.array(tensors), np.array(centres), np.array(angles))


def motion_of(bodies: list[Body], poses: list[Pose]) -> LinkMotion:
    """Motion of n bodies from their poses (without leading axes)."""
    centres = [
        carried_point(pose, body.centre_of_mass) for body, pose in zip(bodies, poses, strict=True)
    ]
    return LinkMotion(
        origin=np.array([pose.origin.value for pose in poses]),
        rotation=np.array([pose.rotation.value for pose in poses]),
        velocity=np.array([pose.origin.first for pose in poses]),
        angular_velocity=np.array([angular_velocity(pose.rotation) for pose in poses]),
        acceleration=np.array([pose.origin.second for pose in poses]),
        angular_acceleration=np.array([angular_acceleration(pose.rotation) for pose in poses]),
        centre=np.array([centre.value for centre in centres]),
        centre_velocity=np.array([centre.first for centre in centres]),
        centre_acceleration=np.array([centre.second for centre in centres]),
    )


def only_body(motion: LinkMotion) -> LinkMotion:
    """Drop the leading axis of a motion of one body."""
    return LinkMotion(**{name: array[0] for name, array in vars(motion).items()})


def virtual_forces(bodies: Bodies, motion: LinkMotion, gravity: Array) -> Array:
    """d'Alembert's sums (k,) of inertia-minus-gravity loads over partial velocities."""
    force = bodies.mass[:, None] * (motion.centre_acceleration - gravity)
    spin = motion.angular_velocity
    momentum = np.einsum("nij,nj->ni", bodies.inertia, spin)
    moment = np.einsum("nij,nj->ni", bodies.inertia, motion.angular_acceleration)
    moment += np.cross(spin, momentum)
    linear: Array = np.einsum("nik,ni->k", bodies.centre_partials, force)
    angular: Array = np.einsum("nik,ni->k", bodies.angle_partials, moment)
    return linear + angular


def inertia_matrix(bodies: Bodies) -> Array:
    """Inertia matrix (k, k) of the bodies in their rates."""
    centres, angles = bodies.centre_partials, bodies.angle_partials
    linear: Array = np.einsum("n,nik,nil->kl", bodies.mass, centres, centres)
    angular: Array = np.einsum("nik,nij,njl->kl", angles, bodies.inertia, angles)
    return linear + angular


def kinetic_energy(bodies: Bodies, motion: LinkMotion) -> float:
    """Kinetic energy, J."""
    linear = bodies.mass @ np.sum(motion.centre_velocity**2, axis=1)
    spin = motion.angular_velocity
    return 0.5 * float(linear + np.einsum("ni,nij,nj->", spin, bodies.inertia, spin))


def potential_energy(bodies: Bodies, motion: LinkMotion, gravity: Array) -> float:
    """Potential energy of gravity, zero at the base origin, J."""
    return -float(bodies.mass @ motion.centre @ gravity)
