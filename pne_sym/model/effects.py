"""What acts in a joint beside its link: friction, a spring, the rotor of its motor; its limits.

A field that is None is absent: nothing of it is derived.  A field that is there is a live
parameter, also where its value is zero.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Friction:
    """Friction of a joint at the rate v: viscous v + coulomb v / sqrt(v^2 + velocity_scale^2).

    Attributes:
        viscous: N m s/rad, of a prismatic joint N s/m; not negative.
        coulomb: N m or N; not negative.
        velocity_scale: rate below which Coulomb friction grows linearly, rad/s or m/s; positive.
            It is there where `coulomb` is.
    """

    viscous: float | None = None
    coulomb: float | None = None
    velocity_scale: float | None = None


@dataclass(frozen=True)
class Spring:
    """A spring at a joint: stiffness (q - rest) pulls the displacement q back.

    Attributes:
        stiffness: N m/rad or N/m; not negative.
        rest: displacement at which it is slack, rad or m.
    """

    stiffness: float
    rest: float = 0.0


@dataclass(frozen=True)
class Actuator:
    """The motor of an actuated joint.

    Attributes:
        rotor_inertia: of all that turns with the motor, about its axis, kg m^2; not negative.
        gear_ratio: motor angle per displacement, of a prismatic joint rad/m; not zero.
    """

    rotor_inertia: float
    gear_ratio: float


@dataclass(frozen=True)
class Limits:
    """What a joint may do.  They do not act on it.

    Attributes:
        displacement: least and largest, rad or m.
        rate: largest size, rad/s or m/s.
        effort: largest size of the actuator's force, N m or N.
    """

    displacement: tuple[float, float] | None = None
    rate: float | None = None
    effort: float | None = None


@dataclass(frozen=True)
class Effects:
    """All of these, of one joint."""

    friction: Friction | None = None
    spring: Spring | None = None
    actuator: Actuator | None = None
    limits: Limits | None = None
