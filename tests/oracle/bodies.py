"""Motion of rigid bodies from their poses, and d'Alembert's sums over them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pne_sym.model.manipulator import Body
from tests.oracle.coordinates import Pose
from tests.oracle.jets import Array, Jet, angular_acceleration, angular_velocity, cross


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
    origin, rotation = _together(unit_motions)
    # (k, n, 3, 3) and (k, n, 3): one unit rate each, of all bodies.
    spin, centre = angular_velocity(rotation), _centres(bodies, origin, rotation).first
    own = np.array([body.inertia for body in bodies], dtype=float)
    turned = rotation.value[0]
    mass = np.array([body.mass for body in bodies], dtype=float)
    return Bodies(
        mass,
        turned @ own @ np.swapaxes(turned, -1, -2),
        np.moveaxis(centre, 0, -1),
        np.moveaxis(spin, 0, -1),
    )


def _together(poses: list[Pose]) -> tuple[Jet, Jet]:
    """Origins (..., n, 3) and rotations (..., n, 3, 3) of n poses."""
    return (
        Jet(np.stack([pose.origin.terms for pose in poses], axis=-2)),
        Jet(np.stack([pose.rotation.terms for pose in poses], axis=-3)),
    )


def _centres(bodies: list[Body], origin: Jet, rotation: Jet) -> Jet:
    """Centres of mass (..., n, 3)."""
    own = np.array([body.centre_of_mass for body in bodies], dtype=float)
    return Jet(origin.terms + (rotation.terms @ own[..., None])[..., 0])


def motion_of(bodies: list[Body], poses: list[Pose]) -> LinkMotion:
    """Motion of n bodies from their poses (without leading axes)."""
    origin, rotation = _together(poses)
    centre = _centres(bodies, origin, rotation)
    return LinkMotion(
        origin=origin.value,
        rotation=rotation.value,
        velocity=origin.first,
        angular_velocity=angular_velocity(rotation),
        acceleration=origin.second,
        angular_acceleration=angular_acceleration(rotation),
        centre=centre.value,
        centre_velocity=centre.first,
        centre_acceleration=centre.second,
    )


def only_body(motion: LinkMotion) -> LinkMotion:
    """Drop the leading axis of a motion of one body."""
    return LinkMotion(**{name: array[0] for name, array in vars(motion).items()})


def virtual_forces(bodies: Bodies, motion: LinkMotion, gravity: Array) -> Array:
    """d'Alembert's sums (k,) of inertia-minus-gravity loads over partial velocities."""
    force = bodies.mass[:, None] * (motion.centre_acceleration - gravity)
    spin = motion.angular_velocity
    momentum = (bodies.inertia @ spin[..., None])[..., 0]
    moment = (bodies.inertia @ motion.angular_acceleration[..., None])[..., 0]
    moment += cross(spin, momentum)
    linear: Array = np.tensordot(force, bodies.centre_partials)
    angular: Array = np.tensordot(moment, bodies.angle_partials)
    return linear + angular


def inertia_matrix(bodies: Bodies) -> Array:
    """Inertia matrix (k, k) of the bodies in their rates."""
    centres, angles = bodies.centre_partials, bodies.angle_partials
    linear: Array = np.tensordot(bodies.mass[:, None, None] * centres, centres, ((0, 1), (0, 1)))
    angular: Array = np.tensordot(angles, bodies.inertia @ angles, ((0, 1), (0, 1)))
    return linear + angular


def kinetic_energy(bodies: Bodies, motion: LinkMotion) -> float:
    """Kinetic energy, J."""
    linear = bodies.mass @ np.sum(motion.centre_velocity**2, axis=1)
    spin = motion.angular_velocity
    return 0.5 * float(linear + np.sum(spin * (bodies.inertia @ spin[..., None])[..., 0]))


def potential_energy(bodies: Bodies, motion: LinkMotion, gravity: Array) -> float:
    """Potential energy of gravity, zero at the base origin, J."""
    return -float(bodies.mass @ motion.centre @ gravity)
