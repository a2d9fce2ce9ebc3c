"""Pose, twist and acceleration of the platform, gravity, and its inertia."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from pne_sym.derivation import (
    PLATFORM,
    Book,
    Frame,
    Given,
    Law,
    ParameterField,
    Quantity,
    Role,
    Rule,
)
from pne_sym.derivation.frames import BodyFrame, of_quaternion, turned_about
from pne_sym.model.kinematics import TaskSpace
from pne_sym.model.manipulator import Body, Manipulator
from pne_sym.vector import (
    Compose,
    Dot,
    Skew,
    TensorSymbol,
    Vector,
    VectorSymbol,
    ZeroTensor,
    ZeroVector,
)


@dataclass(frozen=True)
class BaseMotion:
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


@dataclass(frozen=True)
class PlatformMotion:
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
    rotation = _rotation(space)
    book.frames.append(Frame(PLATFORM, "base", rotation))
    vectors = _motion(book, manipulator, space)
    _tell_rotation(book, space)
    spin: Any = ZeroTensor
    tensor: Any = ZeroTensor
    book.chapter("P", "Platform motion", _TEXT)
    if space.rotates:
        spin = book.define(
            "W_p",
            Compose(Skew(vectors["omega"]), Skew(vectors["omega"])),
            r"\mathbf C_p",
            "centripetal tensor of the platform",
            Law.DEFINITION,
            body="base",
            symmetric=True,
        )
        tensor = book.define(
            "B_p",
            Skew(vectors["alpha"]) + spin,
            r"\mathbf B_p",
            "acceleration tensor of the platform",
            Law.DEFINITION,
            body="base",
        )
    mass, centre, inertia = _inertia(book, manipulator.platform, space, _PLATFORM)
    payload = manipulator.payload
    return PlatformMotion(
        vectors["t"],
        vectors["t_dot"],
        vectors["t_ddot"],
        vectors["omega"],
        vectors["alpha"],
        vectors["g"],
        spin,
        tensor,
        mass,
        centre,
        inertia,
        _inertia(book, payload, space, _PAYLOAD) if payload else None,
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


def _tell_rotation(book: Book, space: TaskSpace) -> None:
    """For readers: how the axes of the platform are turned by its pose."""
    book.fix_axes(BodyFrame("base", "base"))
    platform = BodyFrame(PLATFORM, "platform")
    if not space.rotates:
        book.fix_axes(platform)
        return
    if space.planar:
        phi = _of_pose(book, "phi", r"\phi", "angle of the platform", "rad", 1)
        z = _of_pose(book, "z_plane", r"\hat{\mathbf z}", "normal of the plane", "-", 0)
        rotation = turned_about(z, phi)
    else:
        vector = _of_pose(
            book, "eps", r"\boldsymbol\epsilon", "vector part of the quaternion", "-", 3
        )
        scalar = _of_pose(book, "eps_w", r"\epsilon_w", "scalar part of the quaternion", "-", 1)
        rotation = of_quaternion(vector, scalar, scalar**2 + Dot(vector, vector))
    what = "rotation of the platform: turns components in its axes into base axes"
    quantity = Quantity("T_p", r"\mathbf T_p", what, body="base")
    book.fix_axes(platform, quantity, rotation)


def _of_pose(book: Book, name: str, latex: str, meaning: str, unit: str, size: int) -> Any:
    """A scalar or a vector of the pose; of size 0 the normal of the plane."""
    book.note_quantity(Quantity(name, latex, meaning, unit))
    if size == 1:
        symbol: Any = sp.Symbol(name, real=True)
        components: tuple[Any, ...] = (symbol,)
    else:
        symbol = VectorSymbol(name)
        along_z = (sp.S.Zero, sp.S.Zero, sp.S.One)
        components = tuple(sp.Symbol(f"{name}_{a}", real=True) for a in "xyz") if size else along_z
    book.pose.append(Given(symbol, "base", components))
    return symbol


def _motion(book: Book, manipulator: Manipulator, space: TaskSpace) -> dict[str, Vector]:
    axes = "xyz"
    given: dict[str, Vector] = {}

    def give(stem: str, latex: str, role: Role, unit: str, active: bool, first: int) -> None:
        if not active:
            given[stem] = ZeroVector
            return
        components = [
            sp.Symbol(f"{stem}_{axes[i]}", real=True)
            if first + i in space.components
            else sp.S.Zero
            for i in range(3)
        ]
        symbol = VectorSymbol(stem)
        given[stem] = book.give(
            symbol, "base", components, Quantity(stem, latex, role.value, unit, "base", role=role)
        )

    linear, angular = space.translates, space.rotates
    if linear:
        give("t", r"\mathbf t", Role.POSITION, "m", True, 0)
    else:
        centre = book.parameters.add(
            ParameterField(
                "fixed_centre",
                None,
                (3,),
                "m",
                "fixed centre of rotation, base frame",
                ("fixed_centre",),
                np.array(manipulator.fixed_centre, dtype=float),
            )
        )
        given["t"] = book.give(
            VectorSymbol("t"),
            "base",
            centre,
            Quantity(
                "t",
                r"\mathbf t",
                "fixed centre of rotation",
                body="base",
                parameter=True,
                role=Role.POSITION,
            ),
        )
    give("t_dot", r"\dot{\mathbf t}", Role.VELOCITY, "m/s", linear, 0)
    give("t_ddot", r"\ddot{\mathbf t}", Role.ACCELERATION, "m/s^2", linear, 0)
    give("omega", r"\boldsymbol\omega", Role.ANGULAR_VELOCITY, "rad/s", angular, 3)
    give("alpha", r"\boldsymbol\alpha", Role.ANGULAR_ACCELERATION, "rad/s^2", angular, 3)
    gravity = book.parameters.add(
        ParameterField(
            "gravity",
            None,
            (3,),
            "m/s^2",
            "acceleration of gravity, base frame",
            ("gravity",),
            np.array(manipulator.gravity, dtype=float),
            (2,) if space.planar else (),
        )
    )
    given["g"] = book.give(
        VectorSymbol("g"),
        "base",
        gravity,
        Quantity(
            "g",
            r"\mathbf g",
            Role.GRAVITY.value,
            body="base",
            parameter=True,
            role=Role.GRAVITY,
        ),
    )
    return given


@dataclass(frozen=True)
class _Carried:
    """How a body fixed in the platform is called.

    Attributes:
        prefix: of its parameters; before "." in the full form.
        path: of its table in the full form.
        word: in sentences.
        point, tensor: names of its centre of mass and its inertia.
        mark: index in formulas.
        centre, inertia: meanings of these parameters.
        latex: of the centre of mass.
    """

    prefix: str
    path: str
    word: str
    point: str
    tensor: str
    mark: str
    centre: str
    inertia: str
    latex: str


_PLATFORM = _Carried(
    "platform",
    "platform",
    "the platform",
    "R",
    "I_p",
    "p",
    "centre of mass, platform frame",
    "inertia tensor about the centre of mass, platform axes",
    r"\boldsymbol\rho_p",
)
_PAYLOAD = _Carried(
    "payload",
    "platform.payload",
    "the payload",
    "R_payload",
    "I_payload",
    "l",
    "centre of mass of the payload, platform frame",
    "inertia tensor of the payload about its centre of mass, platform axes",
    r"\boldsymbol\rho_l",
)


def _inertia(book: Book, body: Body, space: TaskSpace, names: _Carried) -> tuple[Any, Vector, Any]:
    """Mass, centre of mass and inertia of a body fixed in the platform."""
    table, prefix, path = book.parameters, names.prefix, names.path
    (mass,) = table.add(
        ParameterField(
            f"{prefix}_mass",
            None,
            (),
            "kg",
            f"mass of {names.word}",
            (f"{path}.mass",),
            np.array(body.mass),
            rule=Rule.MASS,
        )
    )
    centre = table.add(
        ParameterField(
            f"{prefix}_centre_of_mass",
            None,
            (3,),
            "m",
            names.centre,
            (f"{path}.centre_of_mass",),
            np.array(body.centre_of_mass, dtype=float),
            (2,) if space.planar else (),
        )
    )
    book.note_quantity(
        Quantity(f"{prefix}_mass", f"m_{names.mark}", f"mass of {names.word}", parameter=True)
    )
    whose = "" if names is _PLATFORM else f" of {names.word}"
    R = book.give(
        VectorSymbol(names.point),
        "platform",
        centre,
        Quantity(
            names.point,
            names.latex,
            f"platform origin to centre of mass{whose}",
            body="platform",
            parameter=True,
        ),
    )
    entries = table.add(
        ParameterField(
            f"{prefix}_inertia",
            None,
            (3, 3),
            "kg m^2",
            names.inertia,
            (f"{path}.inertia",),
            np.array(body.inertia, dtype=float),
            rule=Rule.PLANAR_INERTIA if space.planar else Rule.INERTIA,
        )
    )
    inertia = book.give(
        TensorSymbol(names.tensor, True),
        "platform",
        symmetric_entries(entries, space.planar),
        Quantity(
            names.tensor,
            rf"\mathbf I_{names.mark}",
            f"inertia tensor of {names.word} about its centre of mass",
            body="platform",
            parameter=True,
        ),
    )
    return mass, R, inertia


def symmetric_entries(entries: tuple[Any, ...], planar: bool) -> tuple[Any, ...]:
    """The nine entries of a symmetric tensor by its upper triangle; in the plane only izz."""
    xx, xy, xz, _, yy, yz, _, _, zz = entries
    if planar:
        zero = sp.S.Zero
        return (zero, zero, zero, zero, zero, zero, zero, zero, zz)
    return (xx, xy, xz, xy, yy, yz, xz, yz, zz)
