"""The closed forms of the paper's four worked examples, written anew from the page.

Sections 4.1, 4.2, 5.2 and 5.4: leg matrices Q, leg vectors U, and the assembled M, Z, H (Hs,
Hk).  `U` takes the errata that are to be left in as printed; with none of them it is the
corrected formula.  Symbols are the paper's.

A leg's force on the platform is F = (what its actuators give) - Q a_p - U.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ERRATA = ("E1", "E2", "E3", "E4")
CORRECTED: frozenset[str] = frozenset()
PRINTED: frozenset[str] = frozenset(ERRATA)


def perp(a: Array) -> Array:
    """A vector of the plane turned by +90 degrees."""
    return np.array([-a[1], a[0]])


def plane_cross(a: Array, b: Array) -> float:
    """a x b in the plane."""
    return float(a[0] * b[1] - a[1] * b[0])


def skew(a: Array) -> Array:
    """The matrix of the cross product."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def planar_turn(angle: float) -> Array:
    """Rotation matrix of the plane."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


# ---- section 4.1: five-bar, prismatic actuators -------------------------------------------------


@dataclass(frozen=True)
class PrismaticLeg:
    """A leg RPR of the five-bar of section 4.1, at a state.

    Attributes:
        S, S_dot: leg vector and its rate.
        r_d: base point to the centre of mass of the lower link.
        rho_u: tip to the centre of mass of the upper link, global axes.
        m_d, I_d, m_u, I_u: masses and centroidal inertias.
        g: acceleration of gravity.
    """

    S: Array
    S_dot: Array
    r_d: Array
    rho_u: Array
    m_d: float
    I_d: float
    m_u: float
    I_u: float
    g: Array

    @cached_property
    def L(self) -> float:
        """Length."""
        return float(np.linalg.norm(self.S))

    @cached_property
    def s(self) -> Array:
        """Unit vector along the leg."""
        return self.S / self.L

    @cached_property
    def r_u(self) -> Array:
        """Base point to the centre of mass of the upper link."""
        return self.S + self.rho_u

    @cached_property
    def a_1(self) -> float:
        """The inertia of the leg about its base point."""
        return float(
            self.m_u * self.r_u @ self.r_u + self.m_d * self.r_d @ self.r_d + self.I_u + self.I_d
        )

    def Q(self) -> Array:
        """The coefficient of the acceleration."""
        s, s_p, L = self.s, perp(self.s), self.L
        across = self.m_u * float(self.r_u @ s_p) / L
        return (
            self.m_u * np.outer(s, s)
            - across * (np.outer(s, s_p) + np.outer(s_p, s))
            + self.a_1 / L**2 * np.outer(s_p, s_p)
        )

    def U(self) -> Array:
        """The remainder."""
        s, L, g, m_u, r_u = self.s, self.L, self.g, self.m_u, self.r_u
        s_p = perp(s)
        L_dot, W = float(s @ self.S_dot), float(s_p @ self.S_dot) / L
        along, across = float(s @ r_u), float(s_p @ r_u)
        first = m_u * s @ g + m_u * W**2 * along - m_u * W**2 * L - 2 * m_u * W * L_dot * across / L
        second = (
            m_u * plane_cross(r_u, g)
            + self.m_d * plane_cross(self.r_d, g)
            + 2 * self.a_1 * W * L_dot / L
            + m_u * W**2 * L * across
            - 2 * m_u * W * L_dot * along
        )
        return -first * s - second / L * s_p

    def h(self) -> list[Array]:
        """What a unit of each actuator gives."""
        return [self.s]


# ---- section 4.2: five-bar, revolute actuators --------------------------------------------------


@dataclass(frozen=True)
class RevoluteLeg:
    """A leg RRR of the five-bar of section 4.2, at a state.

    Attributes:
        S, S_dot: base point to the output point, and its rate.
        branch: the sign of sin(phi - theta).
        low, u: lengths of the lower link (the paper's low) and of the upper link.
        com_d, com_u: centres of mass in link axes, from the base and from the elbow.
        m_d, I_d, m_u, I_u: masses and centroidal inertias.
        g: acceleration of gravity.
    """

    S: Array
    S_dot: Array
    branch: float
    low: float
    u: float
    com_d: Array
    com_u: Array
    m_d: float
    I_d: float
    m_u: float
    I_u: float
    g: Array

    @cached_property
    def theta(self) -> float:
        """Angle of the lower link."""
        L = float(np.linalg.norm(self.S))
        psi = np.arctan2(self.S[1], self.S[0])
        beta = np.arccos((self.low**2 + L**2 - self.u**2) / (2 * self.low * L))
        return float(psi - self.branch * beta)

    @cached_property
    def c(self) -> Array:
        """Unit vector along the lower link."""
        return np.array([np.cos(self.theta), np.sin(self.theta)])

    @cached_property
    def d(self) -> Array:
        """Unit vector along the upper link."""
        return np.asarray((self.S - self.low * self.c) / self.u)

    @cached_property
    def phi(self) -> float:
        """Angle of the upper link."""
        return float(np.arctan2(self.d[1], self.d[0]))

    @cached_property
    def sin(self) -> float:
        """sin(phi - theta), which vanishes where the leg is stretched or folded."""
        return float(np.sin(self.phi - self.theta))

    @cached_property
    def rates(self) -> tuple[float, float]:
        """Rates of theta and phi, by the inverse written out."""
        scaled = self.S_dot / self.sin
        return float(self.d @ scaled) / self.low, -float(self.c @ scaled) / self.u

    @cached_property
    def r_d(self) -> Array:
        """Base point to the centre of mass of the lower link."""
        return np.asarray(planar_turn(self.theta) @ self.com_d)

    @cached_property
    def r_u(self) -> Array:
        """Elbow to the centre of mass of the upper link."""
        return np.asarray(planar_turn(self.phi) @ self.com_u)

    def Q(self) -> Array:
        """The coefficient of the acceleration."""
        low, u, c, d, r_d, r_u = self.low, self.u, self.c, self.d, self.r_d, self.r_u
        e = float(perp(r_u) @ perp(c))
        bracket = (
            self.m_u * low * (u * np.outer(d, d) - e * np.outer(c, d) - e * np.outer(d, c))
            + low / u * (self.m_u * r_u @ r_u + self.I_u) * np.outer(c, c)
            + u / low * (self.m_d * r_d @ r_d + self.I_d) * np.outer(d, d)
        )
        return np.asarray(bracket / (low * u * self.sin**2))

    def U(self) -> Array:
        """The remainder."""
        low, u, c, d, r_d, r_u = self.low, self.u, self.c, self.d, self.r_d, self.r_u
        sin, (theta_dot, phi_dot) = self.sin, self.rates
        V_0 = low * theta_dot**2 * c + u * phi_dot**2 * d
        V_d = perp(r_d) * (d @ V_0) / (low * sin) - theta_dot**2 * r_d
        V_u = (
            perp(c) * (d @ V_0) / sin
            - perp(r_u) * (c @ V_0) / (u * sin)
            - low * theta_dot**2 * c
            - phi_dot**2 * r_u
        )
        upper = self.m_u * low * (u * np.outer(d, perp(c)) - np.outer(c, perp(r_u)))
        lower = self.m_d * u * np.outer(d, perp(r_d))
        G = upper + lower
        V = (
            upper @ V_u
            + lower @ V_d
            + self.I_d * u / (low * sin) * d * (d @ V_0)
            + self.I_u * low / (u * sin) * c * (c @ V_0)
        )
        return np.asarray(-(G @ self.g - V) / (low * u * sin))

    def h(self) -> list[Array]:
        """What a unit of each actuator gives."""
        return [self.d / (self.low * self.sin)]


# ---- sections 5.2 and 5.4: 3-PRPS and 3-RPS --------------------------------------------------


@dataclass(frozen=True)
class SpatialLeg:
    """A leg PRPS (section 5.2) or RPS (section 5.4), at a state.

    Attributes:
        slides: whether the base slide is there (PRPS).
        x, S_dot: base point to the connection point, and its rate.
        q, omega: platform origin to the connection point; angular velocity.
        k: axis of the pivot, and of the slide.
        com_low, com_u: centres of mass in the axes (s, n, k): of the lower turning link (m of
            PRPS, d of RPS) from the pivot, of the upper link from the spherical joint.
        m_slide: mass of the sliding link d of PRPS, else 0.
        m_low, I_low, m_u, I_u: masses; centroidal tensors in the axes (s, n, k).
        g: acceleration of gravity.
    """

    slides: bool
    x: Array
    S_dot: Array
    q: Array
    omega: Array
    k: Array
    com_low: Array
    com_u: Array
    m_slide: float
    m_low: float
    I_low: Array
    m_u: float
    I_u: Array
    g: Array

    @cached_property
    def S(self) -> Array:
        """Leg vector, from the moving pivot."""
        return self.x - (self.x @ self.k) * self.k if self.slides else self.x

    @cached_property
    def L(self) -> float:
        """Length."""
        return float(np.linalg.norm(self.S))

    @cached_property
    def s(self) -> Array:
        """Unit vector along the leg."""
        return self.S / self.L

    @cached_property
    def n(self) -> Array:
        """Third direction, k x s."""
        return np.cross(self.k, self.s)

    @cached_property
    def T(self) -> Array:
        """Axes of the turning links as columns."""
        return np.column_stack([self.s, self.n, self.k])

    @cached_property
    def W(self) -> Array:
        """Angular velocity of the leg."""
        return float(self.n @ self.S_dot) / self.L * self.k

    @cached_property
    def r_u(self) -> Array:
        """Pivot to the centre of mass of the upper link."""
        return self.S + self.T @ self.com_u

    @cached_property
    def r_low(self) -> Array:
        """Pivot to the centre of mass of the lower turning link."""
        return self.T @ self.com_low

    @cached_property
    def tensors(self) -> Array:
        """The sum of both inertia tensors in global axes."""
        return self.T @ (self.I_u + self.I_low) @ self.T.T

    @cached_property
    def e(self) -> float:
        """The recurring s . (k x r_u)."""
        return float(self.s @ np.cross(self.k, self.r_u))

    @cached_property
    def a_1(self) -> float:
        """The inertia of the leg about its pivot."""
        low, up = np.cross(self.k, self.r_low), np.cross(self.k, self.r_u)
        return float(self.m_low * low @ low + self.m_u * up @ up + self.k @ self.tensors @ self.k)

    @cached_property
    def total(self) -> float:
        """What slides along k: all links of a PRPS leg."""
        return self.m_u + self.m_low + self.m_slide if self.slides else 0.0

    def Q(self) -> Array:
        """The coefficient of the acceleration."""
        s, n, k, L = self.s, self.n, self.k, self.L
        return (
            self.m_u * np.outer(s, s)
            + self.m_u / L * self.e * (np.outer(s, n) + np.outer(n, s))
            + self.total * np.outer(k, k)
            + self.a_1 / L**2 * np.outer(n, n)
        )

    def U(self, printed: frozenset[str] = CORRECTED) -> Array:
        """The remainder, with the errata named left in as printed."""
        s, n, k, L, W, r_u, g = self.s, self.n, self.k, self.L, self.W, self.r_u, self.g
        m_u, e, w, L_dot = self.m_u, self.e, float(k @ W), float(s @ self.S_dot)
        u_1 = np.cross(self.omega, np.cross(self.omega, self.q))
        u_2 = float(k @ u_1)
        u_3 = float(s @ u_1) + L * float(W @ W)
        turning = float(np.linalg.norm(W)) if "E4" in printed else w
        u_4 = float(n @ u_1) / L - 2 * turning * L_dot / L
        first = (
            -m_u * s @ g
            + m_u * s @ np.cross(W, np.cross(W, r_u))
            + m_u * u_3
            + m_u * e * u_4 / (L if "E1" in printed else 1.0)
        )
        second = (
            -m_u * k @ np.cross(r_u, g)
            - self.m_low * k @ np.cross(self.r_low, g)
            + m_u * e * u_3
            + self.a_1 * u_4
        )
        if "E2" not in printed:
            second += 2 * m_u * L_dot * w * float(r_u @ s)
        carried = m_u + self.m_low if "E3" in printed else self.total
        third = carried * u_2 - self.total * float(k @ g) if self.slides else 0.0
        return first * s + third * k + second / L * n

    def vacuous(self) -> float:
        """The largest of the terms that are printed though they vanish identically (E7)."""
        k, s, W = self.k, self.s, self.W
        terms = [k @ np.cross(W, np.cross(W, r)) for r in (self.r_u, self.r_low)]
        terms += [k @ np.cross(W, s), k @ s, k @ np.cross(W, self.tensors @ W)]
        return float(np.max(np.abs(terms)))

    def h(self) -> list[Array]:
        """What a unit of each actuator gives."""
        return [self.k, self.s] if self.slides else [self.s]


# ---- assembly --------------------------------------------------------------------------------


def assemble_point(
    legs: Sequence[PrismaticLeg | RevoluteLeg], payload: float, g: Array
) -> tuple[Array, Array, Array]:
    """Eqs. 15 and 22: M, Z, H; with a payload at the output point, which the paper has not."""
    M = sum((leg.Q() for leg in legs), payload * np.eye(2))
    Z = sum((leg.U() for leg in legs), -payload * g)
    return M, Z, np.column_stack([h for leg in legs for h in leg.h()])


@dataclass(frozen=True)
class PlatformBody:
    """The platform at a state, in global axes.

    Attributes:
        mass: M_p.
        R: platform origin to the centre of mass.
        inertia: I_p about the centre of mass.
        omega: angular velocity.
        g: acceleration of gravity.
    """

    mass: float
    R: Array
    inertia: Array
    omega: Array
    g: Array


def assemble_spatial(
    platform: PlatformBody, legs: Sequence[SpatialLeg], printed: frozenset[str] = CORRECTED
) -> tuple[Array, Array]:
    """Eqs. 32 to 34: M and Z."""
    p, R, w = platform, platform.R, platform.omega
    M = np.zeros((6, 6))
    M[:3, :3] = p.mass * np.eye(3)
    M[:3, 3:] = -p.mass * skew(R)
    M[3:, :3] = p.mass * skew(R)
    M[3:, 3:] = p.inertia + p.mass * (R @ R * np.eye(3) - np.outer(R, R))
    Z = np.concatenate(
        (
            p.mass * (np.cross(w, np.cross(w, R)) - p.g),
            np.cross(w, p.inertia @ w) + p.mass * np.cross(R, (w @ R) * w - p.g),
        )
    )
    for leg in legs:
        Q, U, arm = leg.Q(), leg.U(printed), skew(leg.q)
        M += np.block([[Q, -Q @ arm], [arm @ Q, -arm @ Q @ arm]])
        Z += np.concatenate((U, arm @ U))
    return M, Z


def columns(legs: Sequence[SpatialLeg], directions: Sequence[Sequence[Array]]) -> Array:
    """Columns (direction; q x direction): H and Hs of the actuators, Hk of the k.

    Leg by leg; the paper's H of section 5.2 has the columns of all k first.
    """
    found = [
        np.concatenate((direction, np.cross(leg.q, direction)))
        for leg, of_leg in zip(legs, directions, strict=True)
        for direction in of_leg
    ]
    return np.column_stack(found)
