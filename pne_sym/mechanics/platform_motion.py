"""Pose, twist and acceleration of the platform, gravity, and its inertia."""

from __future__ import annotations

from typing import Any, NamedTuple, Unpack

import numpy as np
import sympy as sp

from pne_sym.derivation import PLATFORM, Book, Frame, Given, Quantity, Rule
from pne_sym.derivation.frames import BodyFrame, of_quaternion, turned_about
from pne_sym.mechanics.live import Demands, note, of_all
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.model.kinematics import TaskSpace
from pne_sym.model.manipulator import Body, Manipulator
from pne_sym.vector import Compose, Dot, Skew, Vector, VectorSymbol, ZeroTensor

_TERMS = glossary(r"""
phi       | \phi                | given | rad
    angle of the platform
z_plane   | \hat{\mathbf z}     | given
    normal of the plane
eps       | \boldsymbol\epsilon | given
    vector part of the quaternion
eps_w     | \epsilon_w          | given
    scalar part of the quaternion
t         | \mathbf t           | given POSITION             | m
t:fixed   | \mathbf t           | given POSITION @base
    fixed centre of rotation
t_dot     | \dot{\mathbf t}     | given VELOCITY             | m/s
t_ddot    | \ddot{\mathbf t}    | given ACCELERATION         | m/s^2
omega     | \boldsymbol\omega   | given ANGULAR_VELOCITY     | rad/s
alpha     | \boldsymbol\alpha   | given ANGULAR_ACCELERATION | rad/s^2
g         | \mathbf g           | given GRAVITY @base
W_p       | \mathbf C_p         | DEFINITION symmetric @base
    centripetal tensor of the platform
B_p       | \mathbf B_p         | DEFINITION @base
    acceleration tensor of the platform
R         | \boldsymbol\rho_p   | given @platform
    platform origin to centre of mass
R_payload | \boldsymbol\rho_l   | given @platform
    platform origin to centre of mass of the payload
I_p       | \mathbf I_p         | given @platform
    inertia tensor of the platform about its centre of mass
I_payload | \mathbf I_l         | given @platform
    inertia tensor of the payload about its centre of mass
""")


class BaseMotion(NamedTuple):
    """Motion of a base that moves, in its axes.

    Attributes:
        omega: angular velocity.
        alpha: angular acceleration.
        tensor: alpha~ + omega~ omega~, the acceleration tensor.
        weight: acceleration of gravity.
        felt: that less the acceleration of the base origin.
    """

    omega: Vector
    alpha: Vector
    tensor: Any
    weight: Vector
    felt: Vector


class PlatformMotion(NamedTuple):
    """Symbols of the platform's motion and of gravity.

    Attributes:
        t, t_dot, t_ddot: position, velocity, acceleration of the origin.
        omega, alpha: angular velocity and acceleration.
        gravity: acceleration of gravity, less that of a moving base.
        spin: omega~ omega~, the tensor of centripetal acceleration.
        tensor: alpha~ + omega~ omega~, the acceleration tensor.
        mass: platform mass (scalar).
        centre: platform origin to centre of mass.
        inertia: tensor about the centre of mass.
        payload: the same three of a second body, or None.
        base: motion of the base, or None where it is at rest.
    """

    t: Vector
    t_dot: Vector
    t_ddot: Vector
    omega: Vector
    alpha: Vector
    gravity: Vector
    spin: Any
    tensor: Any
    mass: Any
    centre: Vector
    inertia: Any
    payload: tuple[Any, Vector, Any] | None = None
    base: BaseMotion | None = None

    @property
    def weight(self) -> Vector:
        """Acceleration of gravity."""
        return self.base.weight if self.base else self.gravity


def introduce_platform(book: Book, manipulator: Manipulator, space: TaskSpace) -> PlatformMotion:
    """Introduce what is given of the platform, and the tensor of its spin."""
    book.frames.append(Frame("base", None))
    book.frames.append(Frame(PLATFORM, "base", _rotation(space)))
    eq = Writer(book, None, _TERMS)
    given = _motion(eq, manipulator, space)
    _tell_rotation(eq, space)
    spin: Any = ZeroTensor
    tensor: Any = ZeroTensor
    book.chapter("P", "Platform motion", _TEXT)
    if space.rotates:
        omega, alpha = given["omega"], given["alpha"]
        spin = eq("W_p", Compose(Skew(omega), Skew(omega)))
        tensor = eq("B_p", Skew(alpha) + spin)
    mass, centre, inertia = _inertia(eq, manipulator.platform, space, _PLATFORM)
    payload = manipulator.payload
    return PlatformMotion(
        **given,
        spin=spin,
        tensor=tensor,
        mass=mass,
        centre=centre,
        inertia=inertia,
        payload=_inertia(eq, payload, space, _PAYLOAD) if payload else None,
    )


_TEXT = (
    r"The pose of the platform gives its origin and its rotation matrix; velocity and acceleration "
    r"are those of the origin. Two tensors save work: for a vector $`\mathbf r`$ fixed in the "
    r"platform $`\mathbf C_p\,\mathbf r=\boldsymbol\omega\times(\boldsymbol\omega\times\mathbf r)`$"
    r" and $`\mathbf B_p\,\mathbf r=\boldsymbol\alpha\times\mathbf r+\mathbf C_p\,\mathbf r`$."
)


def _rotation(space: TaskSpace) -> tuple[Any, ...]:
    if not space.rotates:
        return tuple(sp.Integer(int(v)) for v in np.eye(3).ravel())
    names = [[sp.Symbol(f"R_{a}{b}", real=True) for b in "xyz"] for a in "xyz"]
    if space.planar:
        c, s = names[0][0], names[1][0]
        return (c, -s, 0, s, c, 0, 0, 0, 1)
    return tuple(entry for row in names for entry in row)


def _tell_rotation(eq: Writer, space: TaskSpace) -> None:
    """For readers: how the axes of the platform are turned by its pose."""
    book = eq.book
    book.fix_axes(BodyFrame("base", "base"))
    platform = BodyFrame(PLATFORM, "platform")
    if not space.rotates:
        book.fix_axes(platform)
        return
    if space.planar:
        phi = _of_pose(eq, "phi", sp.Symbol("phi", real=True))
        z = _of_pose(eq, "z_plane", sp.S.Zero, sp.S.Zero, sp.S.One)
        rotation = turned_about(z, phi)
    else:
        parts = (sp.Symbol(f"eps_{a}", real=True) for a in "xyz")
        vector, scalar = (
            _of_pose(eq, "eps", *parts),
            _of_pose(eq, "eps_w", sp.Symbol("eps_w", real=True)),
        )
        rotation = of_quaternion(vector, scalar, scalar**2 + Dot(vector, vector))
    what = "rotation of the platform: turns components in its axes into base axes"
    quantity = Quantity("T_p", r"\mathbf T_p", what, body="base")
    book.fix_axes(platform, quantity, rotation)


def _of_pose(eq: Writer, name: str, *components: Any) -> Any:
    """A scalar or a vector of the pose."""
    scalar = eq.note(name)
    symbol = scalar if len(components) == 1 else VectorSymbol(name)
    eq.book.pose.append(Given(symbol, "base", components))
    return symbol


def _motion(eq: Writer, manipulator: Manipulator, space: TaskSpace) -> dict[str, Vector]:
    """Vectors of the motion and of gravity, by fields of `PlatformMotion`."""
    moves = "".join("xyz"[i] for i in range(3) if i in space.components)
    turns = "".join("xyz"[i] for i in range(3) if i + 3 in space.components)
    if moves:
        t = eq.given("t", moves)
    else:
        what, values = "fixed centre of rotation, base frame", manipulator.fixed_centre
        centre = of_all(eq.book, "fixed_centre", "fixed_centre", values, "m", what)
        t = eq.give("t:fixed", centre)
    t_dot, t_ddot = eq.given("t_dot", moves), eq.given("t_ddot", moves)
    omega, alpha = eq.given("omega", turns), eq.given("alpha", turns)
    what, flat = "acceleration of gravity, base frame", (2,) if space.planar else ()
    gravity = of_all(eq.book, "gravity", "gravity", manipulator.gravity, "m/s^2", what, zeros=flat)
    g = eq.give("g", gravity)
    return {"t": t, "t_dot": t_dot, "t_ddot": t_ddot, "omega": omega, "alpha": alpha, "gravity": g}


_PLATFORM = "platform", "platform", "", "p", "R", "I_p"
_PAYLOAD = "payload", "platform.payload", " of the payload", "l", "R_payload", "I_payload"
"""A body fixed in the platform: prefix of its parameters, path of its table in the full form, whose
they are, index in formulas, names of its centre of mass and of its inertia."""


def _inertia(
    eq: Writer, body: Body, space: TaskSpace, names: tuple[str, ...]
) -> tuple[Any, Vector, Any]:
    """Mass, centre of mass and inertia of a body fixed in the platform."""
    prefix, path, of, mark, point, tensor = names

    def given(name: str, unit: str, meaning: str, **demands: Unpack[Demands]) -> tuple[Any, ...]:
        values = getattr(body, name)
        place = f"{path}.{name}"
        return of_all(eq.book, f"{prefix}_{name}", place, values, unit, meaning, **demands)

    what, flat = f"mass of the {prefix}", (2,) if space.planar else ()
    (mass,) = given("mass", "kg", what, rule=Rule.MASS)
    centre = given("centre_of_mass", "m", f"centre of mass{of}, platform frame", zeros=flat)
    note(eq.book, mass, f"m_{mark}", what)
    R = eq.give(point, centre)
    its, rule = "its" if of else "the", Rule.PLANAR_INERTIA if space.planar else Rule.INERTIA
    what = f"inertia tensor{of} about {its} centre of mass, platform axes"
    entries = given("inertia", "kg m^2", what, rule=rule)
    return mass, R, eq.give(tensor, symmetric_entries(entries, space.planar))


def symmetric_entries(entries: tuple[Any, ...], planar: bool) -> tuple[Any, ...]:
    """The nine entries of a symmetric tensor by its upper triangle; in the plane only izz."""
    xx, xy, xz, _, yy, yz, _, _, zz = entries
    if planar:
        zero = sp.S.Zero
        return (zero, zero, zero, zero, zero, zero, zero, zero, zz)
    return (xx, xy, xz, xy, yy, yz, xz, yz, zz)
