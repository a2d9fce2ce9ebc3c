"""A manipulator as frozen data: the full form of a specification.

A manipulator is a platform carried by legs in parallel.  A leg is a chain of
joints with one degree of freedom each (universal, cylindrical and spherical joints are
sequences of them with massless links between), closed by a platform joint.

All quantities are in SI units and radians.  Frames: the *base* frame is fixed;
a leg's base frame is given by `Leg.base_frame`; each link carries a frame at
its joint, parallel to the leg's base frame when all displacements are zero.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

from pne_sym.model.effects import Actuator, Friction, Limits, Spring
from pne_sym.model.errors import SpecError
from pne_sym.model.joint_kinds import JointKind
from pne_sym.model.platform_kinds import PlatformJointKind
from pne_sym.model.platform_kinds.interface import Closure, Direction

Vector3 = tuple[float, float, float]
Matrix3 = tuple[Vector3, Vector3, Vector3]

__all__ = [
    "IDENTITY3",
    "ZERO3",
    "ZERO33",
    "Body",
    "Home",
    "Joint",
    "JointKind",
    "Leg",
    "Manipulator",
    "Matrix3",
    "PlatformJoint",
    "PlatformJointKind",
    "Space",
    "Vector3",
]

ZERO3: Vector3 = (0.0, 0.0, 0.0)
IDENTITY3: Matrix3 = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
ZERO33: Matrix3 = (ZERO3, ZERO3, ZERO3)


class Space(enum.StrEnum):
    """The task space: which components of the platform's motion are coordinates."""

    POINT = "point"
    PLANAR = "planar"
    SPATIAL = "spatial"
    TRANSLATIONAL = "translational"
    SPHERICAL = "spherical"


@dataclass(frozen=True)
class Body:
    """Inertia of a rigid body, in the body's own frame.

    Attributes:
        mass: kg.
        centre_of_mass: from the body's origin, m.
        inertia: tensor about the centre of mass, body axes, kg m^2
            (off-diagonal entry ixy = -integral of x y dm).
    """

    mass: float = 0.0
    centre_of_mass: Vector3 = ZERO3
    inertia: Matrix3 = ZERO33

    @property
    def is_massless(self) -> bool:
        """Whether the body has neither mass nor inertia (a structural fact)."""
        return self.mass == 0.0 and not any(any(row) for row in self.inertia)


@dataclass(frozen=True)
class Joint:
    """A joint with one degree of freedom and the link that it moves.

    Attributes:
        kind: revolute, prismatic or helical.
        axis: unit vector in the preceding link's frame.
        offset: from the preceding joint's origin (the first: from the leg's
            base point) to this joint's, in the preceding link's frame, m.
        pitch: advance of a helical joint per angle, m/rad; 0 otherwise.
        actuated: the joint is actuated.
        extra: the displacement is a generalised coordinate of its own.
        link: inertia of the link that the joint moves, in the link's frame.
        friction, spring, actuator, limits: what acts in the joint, and its bounds; None: absent.
        name: what names in the generated code are made of; "": its number in the leg.
    """

    kind: JointKind
    axis: Vector3
    offset: Vector3 = ZERO3
    pitch: float = 0.0
    actuated: bool = False
    extra: bool = False
    link: Body = Body()
    friction: Friction | None = None
    spring: Spring | None = None
    actuator: Actuator | None = None
    limits: Limits | None = None
    name: str = ""

    @property
    def has_stroke(self) -> bool:
        """Whether its displacement has limits."""
        return self.limits is not None and self.limits.displacement is not None

    @property
    def has_effort(self) -> bool:
        """Whether the force of its actuator has a limit."""
        return self.actuated and self.limits is not None and self.limits.effort is not None

    @property
    def turns(self) -> bool:
        """Whether the link turns against the link before it."""
        return self.kind.turns

    @property
    def turn(self) -> float:
        """Angle by which the link turns, per unit of displacement."""
        return float(self.kind.turn(self.pitch))

    @property
    def advance(self) -> float:
        """Motion along the axis per unit of displacement: 1, 0, or the pitch (m/rad)."""
        return float(self.kind.advance(self.pitch))


@dataclass(frozen=True)
class PlatformJoint:
    """The joint that closes a leg at the platform.

    Attributes:
        kind: spherical, revolute, universal or rigid.
        offset: position in the last link's frame, m.
        axis_link: axis fixed in the last link (R, U), last link's frame.
        axis_platform: axis fixed in the platform (R, U), platform frame.
        rotation: platform axes in the last link's frame (rigid):
            base_R_link rotation = base_R_platform.
        friction: against the turning of the platform relative to the link; None: absent.
    """

    kind: PlatformJointKind
    offset: Vector3 = ZERO3
    axis_link: Vector3 | None = None
    axis_platform: Vector3 | None = None
    rotation: Matrix3 | None = None
    friction: Friction | None = None

    @property
    def right_angles(self) -> tuple[tuple[Direction, Direction], ...]:
        """Right angles that it keeps; none where nothing is stated, in the plane."""
        stated = all(getattr(self, field) is not None for field in self.kind.fields)
        return self.kind.right_angles if stated else ()

    @property
    def closures(self) -> list[Closure]:
        """What closes the loop besides the points, in numbers."""
        return self.kind.closures(self)


@dataclass(frozen=True)
class Leg:
    """A chain of joints from the base to the platform.

    Attributes:
        base_point: in the base frame, m.
        base_frame: rotation from leg axes to base axes.
        joints: from the base to the platform.
        platform_joint: the joint that closes the chain.
        platform_point: of the platform joint, in the platform frame, m.
        type: name of its leg type; "": legs of its structure are named by their architecture.
        name: its own; "": its number.
    """

    base_point: Vector3
    base_frame: Matrix3
    joints: tuple[Joint, ...]
    platform_joint: PlatformJoint
    platform_point: Vector3
    type: str = ""
    name: str = ""

    @property
    def offsets(self) -> list[Vector3]:
        """Of the joints, then of the platform joint."""
        return [*(joint.offset for joint in self.joints), self.platform_joint.offset]


@dataclass(frozen=True)
class Home:
    """A pose and the joint displacements that close the loops there.

    It chooses the assembly branch of every leg.

    Attributes:
        X: platform coordinates followed by the extra coordinates.
        q: displacements of all chain joints, leg by leg from the base; empty, in what is
            built in Python, to have them found from X.
    """

    X: tuple[float, ...]
    q: tuple[float, ...] = ()


@dataclass(frozen=True)
class Manipulator:
    """A platform carried by legs in parallel, in a task space.

    Attributes:
        name: identifier used for files and prefixes of generated names.
        title: one line for people.
        space: task space.
        gravity: gravitational acceleration in the base frame, m/s^2.
        platform: inertia of the platform in the platform frame.
        legs: in the order that fixes q, tau, the columns of H, and lambda.
        home: a pose that closes the loops; fixes the assembly branch.
        fixed_centre: centre of rotation in the base frame (spherical only), m.
        symbols: how the report writes quantities of the derivation: (name, symbol) pairs,
            sorted by name.
        payload: a second body fixed in the platform, in the platform frame; None: absent.
        moving_base: the motion of the base is an input; gravity is in world axes.
        coupling: by row, how a motor turns with the displacements of all actuated joints, before
            its gear; None: each with its own.
    """

    name: str
    title: str
    space: Space
    gravity: Vector3
    platform: Body
    legs: tuple[Leg, ...]
    home: Home
    fixed_centre: Vector3 | None = None
    symbols: tuple[tuple[str, str], ...] = ()
    payload: Body | None = None
    moving_base: bool = False
    coupling: tuple[tuple[float, ...], ...] | None = None

    def fault(self, where: str, problem: str, expected: str) -> SpecError:
        """The error for what cannot be used of it: see `SpecError`."""
        return SpecError(self.name, where, problem, expected)

    @property
    def joints(self) -> list[Joint]:
        """The joints of all legs, in the order of q."""
        return [joint for leg in self.legs for joint in leg.joints]
