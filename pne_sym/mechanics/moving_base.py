"""A base that moves: what its turning and its acceleration add, in base axes.

Pose, velocity and acceleration of the platform stay those relative to the base; so do all joints.
Accelerations in Newton's and Euler's equations are absolute ones.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import sympy as sp

from pne_sym.derivation import Book
from pne_sym.mechanics.joint_accelerations import JointAccelerations
from pne_sym.mechanics.platform_motion import BaseMotion, PlatformMotion
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.vector import (
    Compose,
    Cross,
    Skew,
    Transpose,
    Vector,
    ZeroTensor,
    ZeroVector,
    linear_form,
    vector_sum,
)

_TERMS = glossary(r"""
omega_b    | \boldsymbol\omega_b      | given BASE_ANGULAR_VELOCITY     | rad/s
alpha_b    | \boldsymbol\alpha_b      | given BASE_ANGULAR_ACCELERATION | rad/s^2
a_b        | \mathbf a_b              | given BASE_ACCELERATION         | m/s^2
R_b        | \mathbf R_b              | given BASE_ROTATION @base | -
B_b        | \mathbf B_b              | MOVING_FRAME @base | beyond the paper
    acceleration tensor of the base
g_b        | \mathbf g_b              | MOVING_FRAME @base | beyond the paper
    acceleration of gravity, base axes
g_f        | \mathbf g_f              | MOVING_FRAME @base | beyond the paper
    gravity less the acceleration of the base origin
a_m        | \mathbf a_m              | MOVING_FRAME @base | beyond the paper
    acceleration of the platform origin from the turning of the base
f_b        | \mathbf f_b              | MOVING_FRAME @base | beyond the paper
    inertia force of the platform from the motion of the base
mu_b       | \boldsymbol\mu_b         | MOVING_FRAME @platform | beyond the paper
    inertia moment of the platform from the motion of the base
S_ddot_b   | \ddot{\mathbf S}_b       | MOVING_FRAME @base | beyond the paper
    acceleration of the connection point in space, less that of the base origin
a_b0       | \mathbf a_{b0}           | MOVING_FRAME @base | beyond the paper
    acceleration of the base point, less that of the base origin
omega_b_#  | \boldsymbol\omega_{b#}   | MOVING_FRAME @link | beyond the paper
    angular velocity of link # in space
W_b_#      | \mathbf W_{b#}           | DEFINITION symmetric @link
    centripetal tensor of link # in space
zeta_b_#   | \boldsymbol\zeta_{b#}    | MOVING_FRAME @link | beyond the paper
    angular acceleration of link # from the turning of its axis in space
""")
_TEXT = (
    r"The base turns and accelerates; $`\mathbf R_b`$ turns its axes into those of the world, in "
    r"which gravity is given. What is relative to the base stays as it is; a point at "
    r"$`\mathbf r`$ has the acceleration $`\mathbf a_b+\mathbf B_b\,\mathbf r+2\,"
    r"\boldsymbol\omega_b\times\dot{\mathbf r}`$ besides, of which $`\mathbf a_b`$ acts as gravity "
    r"does."
)
_OF_LEG = (
    r"Velocities and accelerations in space, in axes that turn with the base: those relative to "
    r"the base, and those of a point or body that is carried along. That of the base origin counts "
    r"with gravity, $`\mathbf g_f`$."
)


def introduce_base(book: Book, gravity: Vector, *, planar: bool) -> BaseMotion:
    """The chapter on the motion of the base, which is given.

    Args:
        book: of the derivation.
        gravity: in world axes.
        planar: the base stays in the plane.
    """
    eq = Writer(book, None, _TERMS)
    rotation = _rotation(eq, planar=planar)
    turns, moves = ("z", "xy") if planar else ("xyz", "xyz")
    omega, alpha = eq.given("omega_b", turns), eq.given("alpha_b", turns)
    a = eq.given("a_b", moves)
    book.chapter("B", "Motion of the base", _TEXT)
    tensor = eq("B_b", Skew(alpha) + Compose(Skew(omega), Skew(omega)))
    weight = eq("g_b", Transpose(rotation) @ gravity)
    return BaseMotion(omega, alpha, tensor, weight, eq("g_f", weight - a))


def _rotation(eq: Writer, *, planar: bool) -> Any:
    names = [[sp.Symbol(f"R_b_{a}{b}", real=True) for b in "xyz"] for a in "xyz"]
    entries = [entry for row in names for entry in row]
    if planar:
        (xx, xy, _), (yx, yy, _), _ = names
        zero, one = sp.S.Zero, sp.S.One
        entries = [xx, xy, zero, yx, yy, zero, zero, zero, one]
    return eq.give("R_b", entries, symmetric=False)


def carried_platform(
    book: Book, p: PlatformMotion, mass: Any, h: Vector, J: Any
) -> tuple[Vector, Vector]:
    """Inertia force, and moment about its origin, of the platform from the motion of its base.

    Args:
        book: of the derivation.
        p: motion of the platform.
        mass: of the platform.
        h: its first moment.
        J: its inertia tensor about its origin.
    """
    base = p.base
    if base is None:
        return ZeroVector, ZeroVector
    w, alpha, eq = base.omega, base.alpha, Writer(book, None, _TERMS)
    coriolis = Cross(w, p.t_dot) * 2
    moved = eq(
        "a_m",
        vector_sum((Cross(alpha, p.t), Cross(w, Cross(w, p.t)), coriolis)),
        forms=(vector_sum((base.tensor @ p.t, coriolis)),),
    )
    coriolis = Cross(w, Cross(p.omega, h)) * 2
    force = eq(
        "f_b",
        vector_sum((mass * moved, Cross(alpha, h), Cross(w, Cross(w, h)), coriolis)),
        forms=(vector_sum((mass * moved, base.tensor @ h, coriolis)),),
    )
    turned = J @ (alpha + Cross(w, p.omega)) + Cross(w, J @ (w + p.omega)) + Cross(p.omega, J @ w)
    return force, eq("mu_b", Cross(h, moved) + turned)


def carried_leg(
    book: Book, p: PlatformMotion, base: BaseMotion, motion: JointAccelerations
) -> tuple[JointAccelerations, Vector]:
    """The motion of a leg in space, and the acceleration of its base point.

    Args:
        book: of the derivation.
        p: motion of the platform.
        base: motion of the base.
        motion: of the leg, relative to the base.
    """
    g, w = motion.chain.g, base.omega
    eq = Writer(book, g, _TERMS)
    eq.chapter("B", "Motion of & with its base", _OF_LEG)
    r, coriolis = p.t + g.platform_point, Cross(w, motion.S_dot) * 2
    total = motion.S_ddot + Cross(base.alpha, r) + Cross(w, Cross(w, r)) + coriolis
    forms = (motion.S_ddot + base.tensor @ r + coriolis,)
    S_ddot = eq("S_ddot_b", total, forms=forms)
    motion.known[S_ddot] = linear_form(total, [motion.a_p], motion.known)
    turning = Cross(base.alpha, g.base_point) + Cross(w, Cross(w, g.base_point))
    origin = eq("a_b0", turning, forms=(base.tensor @ g.base_point,))
    omega, spin, turned = {0: w}, {0: ZeroTensor}, {0: ZeroVector}
    for j in motion.chain.turning:
        previous = omega[g.group[j - 1]]
        omega[j] = eq("omega_b_#", previous + motion.qd[j] * g.spin(j), j)
        spin[j] = eq("W_b_#", Compose(Skew(omega[j]), Skew(omega[j])), j)
        turned[j] = eq.named("zeta_b_#", motion.qd[j] * Cross(previous, g.spin(j)), j)
    return replace(motion, omega=omega, spin=spin, S_ddot=S_ddot, coriolis=turned), origin
