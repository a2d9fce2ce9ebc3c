"""Equilibrium of the links beyond each joint along its degree of freedom, from the tip to the base.

Reference: sections 2.2 and 2.5, step 1.3.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

from pne_sym.mechanics.composite import CompositeWriter
from pne_sym.mechanics.joint_forces import JointForces
from pne_sym.mechanics.linear_writer import LinearWriter
from pne_sym.mechanics.link_forces import LinkForces, LinkWriter
from pne_sym.mechanics.terms import glossary
from pne_sym.vector import Cross, Dot, VectorSymbol, ZeroVector, vector_sum

_TERMS = glossary(r"""
N_#     | \mathbf N_{#} ; \boldsymbol\Xi_{#}                | EULER @link | Sec. 2.5, step 1.3
    moment about joint # of the links from # outwards, the force at the connection point left out
T_#     | \mathbf f^{\Sigma}_{#} ; \boldsymbol{\mathcal F}_{#} | NEWTON @link
    inertia force of the links from # outwards, the last link left out
Gamma_# | \Gamma_{#} ; \boldsymbol\gamma_{#}                | FREEDOM | Sec. 2.2, joint table
    % axis # of the distal links' inertia and weight&
""")


class BalanceWriter:
    """Writes what inertia, weight and joint forces need along every degree of freedom."""

    def __init__(self, links: LinkWriter, found: LinkForces, forces: JointForces) -> None:
        self.book, self.motion, self.chain = links.book, links.motion, links.motion.chain
        self.g = self.chain.g
        self.links, self.found, self.forces = links, found, forces
        self.eq = LinearWriter(self.book, self.g, _TERMS, self.motion.collection)

    def write(self) -> dict[int, Any]:
        """Gamma_j of every joint."""
        g, inertia = self.g, {}
        if g.composite:  # inertia of joint k along joint j
            inertia = CompositeWriter(self.book, self.chain, self.links.bodies).inertia()
        groups = sorted({0, *g.group.values()}, reverse=True)
        force: Any = ZeroVector  # inertia force of all groups beyond
        moment: Any = ZeroVector  # their moment about the next group's origin
        gamma: dict[int, Any] = {}
        for group in groups:
            members = [j for j in range(1, g.count + 1) if g.group[j] == group]
            moment = self._moment(group, members, force, moment)
            for j in reversed(members):
                force = self._force(j, force)
                if j != group:
                    gamma[j] = self._along(j, Dot(g.slide(j), force), inertia)
            if group:
                component = Dot(g.spin(group), moment) + Dot(g.slide(group), force)
                gamma[group] = self._along(group, component, inertia)
        return gamma

    def _moment(self, group: int, members: Sequence[int], force: Any, moment: Any) -> Any:
        """Moment about the group's origin of everything from the group outwards."""
        if group == 0:
            return ZeroVector
        own = self.found.force
        total = vector_sum(
            (
                self.links.group_moment(group, self.found.acceleration),
                moment,
                Cross(self.chain.spans[group], force),
                *(Cross(self.chain.reach(j), own[j]) for j in members if j in own),
            )
        )
        return self._named("N_#", total, group)

    def _force(self, j: int, outer: Any) -> Any:
        """Inertia force of the links from j outwards."""
        own = self.found.force.get(j, ZeroVector)
        return self._named("T_#", vector_sum((own, outer)), j)

    def _named(self, stem: str, total: Any, j: int) -> Any:
        if isinstance(total, VectorSymbol) or total == ZeroVector:
            return total
        collected = not self.g.composite
        return self.eq.collected(stem, total, j, collected=collected)

    def _along(self, j: int, component: Any, inertia: dict[tuple[int, int], Any]) -> Any:
        """Gamma_j, from the component of inertia and weight along the degree of freedom."""
        other = self.forces.along(j)
        if component == 0 and other == 0:
            return sp.S.Zero
        more = ", and of what acts in the joint" * (other != 0)
        accelerated = self._accelerated(j, inertia) if self.g.composite else None
        effort = self.g.kind(j).effort
        total = component + other
        return self.eq.collected("Gamma_#", total, j, effort, more, accelerated=accelerated)

    def _accelerated(self, j: int, inertia: dict[tuple[int, int], Any]) -> Any:
        """What of Gamma_j depends on the accelerations of the joints and of the tip."""
        total = sp.Add(*(inertia.get((j, k), 0) * qdd for k, qdd in self.motion.qdd.items()))
        total = total + self.forces.accelerating(j)
        return total + Dot(self.g.spin(j), self.found.tip_moment)
