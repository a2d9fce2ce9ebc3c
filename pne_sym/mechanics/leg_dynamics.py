"""Newton-Euler of a leg, from the most distal link to the base, along the degrees of freedom only.

The inertia force f_u of the last link and the leg's force F on the platform act
at the same point, so the equilibrium of the distal links along the degree of freedom of
joint j reads v_j . (F + f_u) = tau_j - Gamma_j, where Gamma_j collects the
moments (revolute), forces (prismatic) or both (helical) of everything but f_u.
Joint reactions never appear.

Reference: sections 2.2, 2.3 and 2.5, Eqs. 1 to 4.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import sympy as sp

from pne_sym.mechanics.joint_forces import JointForces
from pne_sym.mechanics.leg_balance import BalanceWriter
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.leg_motion import LegMotion
from pne_sym.mechanics.linear_writer import LinearWriter
from pne_sym.mechanics.link_forces import LinkWriter
from pne_sym.mechanics.links import LinkBody
from pne_sym.mechanics.terms import glossary
from pne_sym.vector import Dot, LinearForm, ZeroTensor, ZeroVector, vector_sum

_TERMS = glossary(r"""
G      | \mathbf G ; \boldsymbol{\mathcal G} | RECIPROCITY @tip | Sec. 2.3
    force at the connection point that balances the leg's inertia and weight along
    all degrees of freedom
G_m#   | G_{m#} ; \boldsymbol{\mathcal G}_{m#} | RECIPROCITY | Sec. 2.2, joint table
    moment along moment direction # that balances the leg's inertia and weight along
    all degrees of freedom
G_m    | \mathbf G_m ; \boldsymbol{\mathcal G}_m | RECIPROCITY @tip | Sec. 2.2, joint table
    moment at the connection point that balances the leg's inertia and weight along
    all degrees of freedom
c      | \mathbf c ; \boldsymbol{\mathcal C} | REDUCTION @tip | Eq. 3
    leg force on the platform without actuation and without the mass at the connection point
c_m    | \mathbf c_m ; \boldsymbol{\mathcal C}_m | REDUCTION @tip | Eq. 3
    moment of the leg on the platform without actuation
Q      | \mathbf Q   | RULES LEG_INERTIA symmetric @tip | Eq. 4
    inertia of the leg at the connection point, without the mass gathered there
U      | \mathbf U   | RULES LEG_BIAS @tip | Eq. 4
    velocity and gravity terms of the leg force
c_true | \mathbf c^* | NEWTON @tip | Eq. 3
    leg force on the platform without actuation, the last link's mass included
P_#    | P_{#} ; \mathbf M_{yt,#} | FREEDOM | Eqs. 6, 7
    inertia and weight of the leg along the extra degree of freedom of joint #
""")

_NEWTON_EULER = (
    r"From the last link to the base; of the equilibrium of the links beyond a joint only the "
    r"component along the joint's axis is taken, so that joint reactions never appear. "
)
_CARRIED = (
    r"The inertia force $`\mathbf f`$ of the last link (its weight taken off) acts at the "
    r"connection point like the force $`\mathbf F`$ on the platform; $`\Gamma_j`$ is what "
    r"everything else needs along joint j. So "
    r"$`\mathbf v_j\cdot(\mathbf F+\mathbf f)=\tau_j-\Gamma_j`$ for every joint, and the "
    r"reciprocal vectors solve this: "
    r"$`\mathbf F=\sum_j\mathbf w_j\,(\tau_j-\Gamma_j)-\mathbf f`$."
)
_KEPT = (
    r"$`\Gamma_j`$ is what the links beyond joint j need along it, so that the force $`\mathbf F`$ "
    r"on the platform obeys $`\mathbf v_j\cdot\mathbf F=\tau_j-\Gamma_j`$ for every joint; the "
    r"reciprocal vectors solve this: $`\mathbf F=\sum_j\mathbf w_j\,(\tau_j-\Gamma_j)`$."
)
_RESTRICTED = (
    r" Besides, the leg exerts a constraint wrench on the platform; its coefficient is the "
    r"multiplier $`\lambda`$, a reaction that only the platform's equations determine."
)
_COMPOSITE = (
    r" The links of this leg turn differently, so their inertia is collected in the accelerations "
    r"of the joints first: all links from k outwards, frozen together, are one composite body with "
    r"first moment $`\mathbf h^c_k`$ and inertia tensor $`\mathbf J^c_k`$; a unit acceleration of "
    r"joint k takes the force $`\boldsymbol\Pi_k`$ and the moment $`\boldsymbol\Lambda_k`$, "
    r"whose component along joint j is $`\mathcal M_{jk}`$. With $`\ddot q_k`$ in closed form, "
    r"$`\Gamma_j`$ then holds the platform's acceleration through "
    r"$`\sum_k \mathcal M_{jk}\,\ddot q_k`$."
)
_MOMENTS = (
    r" The platform joint of this leg transmits moments along $`\mathbf n_{m1}`$ and on, which do "
    r"work along the turning joints too: the equilibrium along joint j holds the parts of these "
    r"moments times $`\mathbf e_j\cdot\mathbf n_{mi}`$ besides, and the reciprocal wrenches with "
    r"force parts $`\mathbf w_j`$ and moment parts $`\mathbf o_j`$ solve for force and moment "
    r"together."
)


class LegDynamics(NamedTuple):
    """What the platform needs of a leg.

    Attributes:
        bodies: links with inertia.
        tip_mass: mass gathered at the connection point.
        forces: friction, springs and rotors of its joints.
        force: c, the reduced leg force without actuation (Eq. 3).
        true_force: Eq. 3 with the tip mass.
        Q, U: reduced closed form F = h tau - Q a_p - U (Eq. 4).
        form: linear form of the reduced force.
        moment, moment_form: the moment that the leg transmits, likewise.
        extra_rows: extra joint -> (row force, its linear form).
    """

    bodies: Sequence[LinkBody]
    tip_mass: Any
    forces: JointForces
    force: Any
    true_force: Any
    Q: Any
    U: Any
    form: LinearForm
    moment: Any
    moment_form: LinearForm
    extra_rows: dict[int, tuple[Any, LinearForm]]


class DynamicsWriter:
    """Writes Newton-Euler of a leg."""

    def __init__(self, links: LinkWriter, forces: JointForces) -> None:
        self.links, self.forces = links, forces
        self.g: LegGeometry = links.g
        self.motion: LegMotion = links.motion
        self.eq = LinearWriter(links.book, self.g, _TERMS, self.motion.collection)

    def run(self) -> LegDynamics:
        """Write Newton-Euler from the last link to the base and solve for the leg's force."""
        self.eq.chapter("N", "Newton-Euler of &", self._text())
        found = self.links.forces()
        gamma = BalanceWriter(self.links, found, self.forces).write()
        G, G_m = self._force_balance(gamma), self._moment_balance(gamma)
        force = self._named("c", -(G + found.turning))
        form = self.motion.known.get(force, LinearForm({}, ZeroVector))
        Q, a_p = ZeroTensor, self.motion.a_p
        if a_p in form.coefficients:
            Q = self.eq("Q", -form.coefficients[a_p])
        moment = self._named("c_m", -(G_m + self.forces.end))
        U = ZeroVector
        if form.remainder != ZeroVector:
            U = self.eq("U", -form.remainder)
        true_force = force
        if found.tip_force != ZeroVector:  # the mass at the tip moves with the platform
            true_force = self.eq("c_true", force - found.tip_force)
        return LegDynamics(
            bodies=self.links.bodies,
            tip_mass=found.tip_mass,
            forces=self.forces,
            force=force,
            true_force=true_force,
            Q=Q,
            U=U,
            form=form,
            moment=moment,
            moment_form=self.motion.known.get(moment, LinearForm({}, moment)),
            extra_rows={j: self._extra_row(j, gamma, G, G_m) for j in self.motion.ydd},
        )

    def _text(self) -> str:
        """What the chapter begins with: of what there is."""
        carried = any(body.at_tip for body in self.links.bodies)
        text = _NEWTON_EULER + (_CARRIED if carried else _KEPT)
        text += _RESTRICTED * bool(self.motion.constraints) + _COMPOSITE * self.g.composite
        return text + _MOMENTS * bool(self.g.pairs)

    def _named(self, stem: str, value: Any) -> Any:
        """A vector at the connection point, where there is any."""
        if value == ZeroVector:
            return ZeroVector
        return self.eq.collected(stem, value)

    def _force_balance(self, gamma: dict[int, Any]) -> Any:
        """Force at the connection point, from the coefficients along the degrees of freedom."""
        w = self.motion.w
        return self._named("G", vector_sum(gamma[j] * w[j] for j in w if gamma[j] != 0))

    def _moment_balance(self, gamma: dict[int, Any]) -> Any:
        """Moment of the leg, from its coefficients along the moment directions."""
        motion, moments = self.motion, []
        for k, n in enumerate(motion.n, 1):
            coefficient = sp.Add(*(gamma[j] * m[k - 1] for j, m in motion.m.items()))
            if coefficient != 0:
                moments.append(n * self.eq.collected("G_m#", coefficient, k))
        return self._named("G_m", vector_sum(moments))

    def _extra_row(self, j: int, gamma: dict[int, Any], G: Any, G_m: Any) -> tuple[Any, LinearForm]:
        """Equilibrium along an extra joint: a row of its own (Eqs. 6, 7)."""
        row = gamma[j] - Dot(self.motion.v[j], G) - Dot(self.g.spin(j), G_m)
        symbol = self.eq.collected("P_#", row, j)
        return symbol, self.motion.known[symbol]
