"""Inertia and weight of a leg's links, by Newton's and Euler's equations.

Reference: section 2.5, steps 1.2 and 1.3, Eqs. 1 and 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import sympy as sp

from pne_sym.derivation import Book
from pne_sym.mechanics.leg_motion import LegMotion
from pne_sym.mechanics.linear_writer import LinearWriter
from pne_sym.mechanics.links import LinkBody
from pne_sym.mechanics.terms import glossary
from pne_sym.vector import (
    Axial,
    Compose,
    Cross,
    Identity,
    Trace,
    Vector,
    VectorSymbol,
    ZeroVector,
    tensor_sum,
    vector_sum,
)

_TERMS = glossary(r"""
phi_#     | \mathbf f^{\omega}_{#} ; \boldsymbol\Phi_{#}   | NEWTON @link | Eq. 1
    inertia force of link # from its turning about its reference point
acc_#     | \mathbf a_{#} ; \boldsymbol\Theta_{#}          | RATE @link | Eqs. 10, 11, 17, 18
    acceleration of the reference point of link #, less gravity
f_#       | \mathbf f_{#} ; \boldsymbol\Upsilon_{#}        | NEWTON @link | Eq. 1
    inertia force of link # less its weight
mu_#      | \boldsymbol\mu_{#} ; \boldsymbol\Psi_{#}       | EULER @link | Eq. 2
    inertia moment of the links that turn with link #, about their reference points
J_group_# | \mathbf J^\Sigma_{#}  | LUMPING constant symmetric @link
    inertia of the links that turn with link #, each about its reference point
Sigma_#   | \boldsymbol\Sigma_{#} | LUMPING constant symmetric @link
    second moment of mass of the links that turn with link #
h_group_# | \mathbf h^\Sigma_{#}  | LUMPING constant @link
    first moments of the links that turn with link #
""")


class LinkForces(NamedTuple):
    """What accelerating and holding up the links takes, by joint number.

    Attributes:
        acceleration: of the links' reference points, less gravity.
        force: on each link but one whose reference point is the connection point.
        at_tip: that link.
        turning: force on it from its turning about the connection point.
    """

    acceleration: dict[int, Any]
    force: dict[int, Any]
    at_tip: LinkBody | None
    turning: Any

    @property
    def tip_mass(self) -> Any:
        """Mass gathered at the connection point."""
        return self.at_tip.mass if self.at_tip else sp.S.Zero

    @property
    def tip_force(self) -> Any:
        """Inertia less weight of that mass."""
        tip = self.at_tip
        return tip.mass * self.acceleration[tip.joint] if tip else ZeroVector

    @property
    def tip_moment(self) -> Any:
        """Its moment about the connection point."""
        tip = self.at_tip
        return Cross(tip.first_moment, self.acceleration[tip.joint]) if tip else ZeroVector


class LinkWriter:
    """Writes the forces and moments of a leg's links."""

    def __init__(
        self,
        book: Book,
        gravity: Vector,
        motion: LegMotion,
        bodies: Sequence[LinkBody],
    ) -> None:
        self.book, self.gravity, self.motion, self.bodies = book, gravity, motion, bodies
        self.chain, self.g = motion.chain, motion.chain.g
        self.eq = LinearWriter(book, self.g, _TERMS, motion.collection)

    def forces(self) -> LinkForces:
        """Inertia force of every link less its weight."""
        force: dict[int, Any] = {}
        acceleration: dict[int, Any] = {}
        at_tip, turning_at_tip = None, ZeroVector
        for body in self.bodies:
            j = body.joint
            acceleration[j] = self._acceleration(body)
            turning = self._turning(body)
            if body.at_tip:
                at_tip, turning_at_tip = body, turning
                continue
            total, collected = body.mass * acceleration[j] + turning, not self.g.composite
            force[j] = self.eq.collected("f_#", total, j, collected=collected)
        return LinkForces(acceleration, force, at_tip, turning_at_tip)

    def _turning(self, body: LinkBody) -> Any:
        """The part of a link's inertia force that comes from its turning."""
        h, turns = body.first_moment, self.motion.groups[body.group]
        omega, alpha, (tensor, at_rest) = turns.omega, turns.alpha, turns.tensor
        if omega == ZeroVector:
            return ZeroVector
        return self.eq.collected(
            "phi_#",
            Cross(alpha, h) + Cross(omega, Cross(omega, h)),
            body.joint,
            forms=(tensor @ h,),
            rest_forms=(at_rest @ h,),
            collected=body.at_tip or not self.g.composite,
        )

    def _acceleration(self, body: LinkBody) -> Any:
        """Acceleration of the reference point less gravity."""
        g, j, forms = self.g, body.joint, {}
        if body.at_tip:
            value = self.motion.S_ddot
        else:
            reach, slides = self.chain.reach(j), self.chain.slides(body.group, j)
            value, form, rest = self.motion.of_point(body.group, reach, slides)
            forms = {"forms": (form - self.gravity,), "rest_forms": (rest - self.gravity,)}
        collected = body.at_tip or not g.composite
        return self.eq.collected("acc_#", value - self.gravity, j, collected=collected, **forms)

    # ---- moments ---------------------------------------------------------------------

    def group_moment(self, group: int, acceleration: dict[int, Any]) -> Any:
        """Moment of inertia of a group's links about their own reference points (Euler)."""
        members = [b for b in self.bodies if b.group == group]
        if not members or group == 0:
            return ZeroVector
        J = self.eq.named("J_group_#", tensor_sum(b.inertia for b in members), group)
        second = self.eq("Sigma_#", Trace(J) / 2 * Identity - J, group)
        turns = self.motion.groups[group]
        omega, alpha = turns.omega, turns.alpha
        rest = self.motion.collection.rest
        both = [(acceleration[b.joint], rest(acceleration[b.joint])) for b in members]
        moments, at_rest = (
            [Cross(b.first_moment, a[k]) for b, a in zip(members, both, strict=True)]
            for k in (0, 1)
        )
        ways = [(moments, at_rest), *self._gathered_moments(members, acceleration)]
        turning, turning_rest = (Axial(Compose(tensor, second)) for tensor in turns.tensor)
        return self.eq.collected(
            "mu_#",
            vector_sum((J @ alpha, Cross(omega, J @ omega), *moments)),
            group,
            forms=tuple(vector_sum((turning, *terms)) for terms, _ in ways),
            rest_forms=tuple(vector_sum((turning_rest, *terms)) for _, terms in ways),
            collected=not self.g.composite,
        )

    def _gathered_moments(
        self, members: Sequence[LinkBody], acceleration: dict[int, Any]
    ) -> list[tuple[list[Any], list[Any]]]:
        """The moments h x (a - g) with gravity taken out once: (terms, terms at rest), or none."""
        if len(members) < 2:
            return []
        without: dict[int, tuple[Any, Any]] = {}
        for b in members:
            found = self._without_gravity(acceleration[b.joint])
            if found is None:
                return []
            without[b.joint] = found
        group = members[0].group
        total = self.eq("h_group_#", vector_sum(b.first_moment for b in members), group)
        weight = -Cross(total, self.gravity)
        terms, at_rest = (
            [weight, *(Cross(b.first_moment, without[b.joint][k]) for b in members)] for k in (0, 1)
        )
        return [(terms, at_rest)]

    def _without_gravity(self, relative: Any) -> tuple[Any, Any] | None:
        """Acceleration and its remainder, where the relative one is a named difference."""
        if relative == -self.gravity:
            return ZeroVector, ZeroVector
        equation = next((e for e in self.book.all_equations() if e.lhs == relative), None)
        if equation is None:
            return None
        if equation.rhs == -self.gravity:
            return ZeroVector, ZeroVector
        terms = [t for t in getattr(equation.rhs, "args", ()) if t != -self.gravity]
        plain = vector_sum(terms) if len(terms) == 1 else None
        rest = self.motion.collection.rest
        return (plain, rest(plain)) if isinstance(plain, VectorSymbol) else None
