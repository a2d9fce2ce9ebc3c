"""Velocities of a leg.

Reference: sections 2.2, 2.3 and 2.5, step 1.1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pne_sym.derivation import Book, Role
from pne_sym.mechanics.leg_chain import LegChain
from pne_sym.mechanics.leg_displacements import InverseKinematics
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.leg_screws import LegScrews, ScrewWriter
from pne_sym.mechanics.platform_motion import PlatformMotion
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.model.kinematics import TaskSpace
from pne_sym.vector import (
    Compose,
    Cross,
    Dot,
    Skew,
    Vector,
    VectorSymbol,
    ZeroTensor,
    ZeroVector,
    vector_sum,
)

_TERMS = glossary(r"""
S_dot      | \dot{\mathbf S}          | RATE POINT_VELOCITY @base | Sec. 2.5, step 1.1
    velocity of the connection point
r_#        | \mathbf r_{#}            | GEOMETRY @link
    from joint # to the connection point, along the links
yd_#       | \dot y_{#}               | given RATE | U/s
    rate of extra joint #
S_dot_rest | \dot{\mathbf S}'         | RATE
    velocity of the connection point left to the joints that are not extra
eta_#      | \eta_{#}                 | RATE
    rate at which the joints turn along moment direction #
qd_#       | \dot q_{#}               | RECIPROCITY RATE
    rate of joint #
omega_#    | \boldsymbol\omega_{#}    | RATE @link
    angular velocity of link #
W_#        | \mathbf C_{#}            | DEFINITION symmetric @link
    centripetal tensor of link #
""")
_TEXT = (
    r"Each joint j moves the connection point along its velocity vector $`\mathbf v_j`$: "
    r"$`\dot{\mathbf S}=\sum_j\mathbf v_j\,\dot q_j`$. The reciprocal vectors $`\mathbf w_j`$, "
    r"with $`\mathbf w_j\cdot\mathbf v_k=1`$ for $`j=k`$ and 0 otherwise, solve this for the joint "
    r"rates. The centripetal tensor saves work: "
    r"$`\mathbf C_j\,\mathbf r=\boldsymbol\omega_j\times(\boldsymbol\omega_j\times\mathbf r)`$ for "
    r"every vector $`\mathbf r`$."
)


@dataclass(frozen=True)
class LegRates(LegScrews):
    """Velocities of a leg, by joint number or group.

    Attributes:
        S_dot: velocity of the connection point.
        qd: joint rates.
        omega: angular velocity, by group.
        spin: centripetal tensor omega~ omega~, by group.
        slide: velocity with which the slides of a group move its far end, by group.
        end_turning: angular velocity of the platform relative to the last link.
    """

    S_dot: Any
    qd: dict[int, Any]
    omega: dict[int, Vector]
    spin: dict[int, Any]
    slide: dict[int, Vector]
    end_turning: Vector


class RateWriter:
    """Writes the velocities of a leg."""

    def __init__(
        self,
        book: Book,
        g: LegGeometry,
        platform: PlatformMotion,
        space: TaskSpace,
        inverse: InverseKinematics,
    ) -> None:
        self.book, self.g, self.p, self.space, self.inverse = book, g, platform, space, inverse
        self.chain = LegChain(g, inverse.q)
        self.eq = Writer(book, g, _TERMS)

    def write(self) -> LegRates:
        """The chapter: connection point, velocity and reciprocal vectors, rates of the joints."""
        g, p, chain = self.g, self.p, self.chain
        self.eq.chapter("V", "Rates of &", _TEXT)
        S_dot = self.eq("S_dot", p.t_dot + Cross(p.omega, g.platform_point))
        rods: dict[int, Vector] = {}
        following: Vector = ZeroVector
        for j in reversed(chain.turning):
            following = rods[j] = self._rod(j, following)
        reached = vector_sum((chain.spans[0], following))
        screws = ScrewWriter(self.book, chain, planar=self.space.planar)
        # Three joints with a closed form leave no residual but that of right angles.
        closes = self.inverse.is_closed and g.pairs and self._dofs == 3
        found = screws.write(rods, ZeroVector if closes else self.inverse.S - reached)
        return self._angular_velocities(found, S_dot, self._rates(found, S_dot))

    @property
    def _dofs(self) -> int:
        """Joints that are not extra."""
        return self.g.count - len(self.chain.extras)

    def _rod(self, j: int, following: Vector) -> Vector:
        """From the origin of turning joint j to the connection point."""
        vector = vector_sum((self.chain.spans[j], following))
        named: Vector = self.eq.named("r_#", vector, j, forms=self._closed_loop(j))
        return named

    def _closed_loop(self, j: int) -> tuple[Vector, ...]:
        """The same vector, seen from the base; resolved vectors give way to what they resolve.

        Where the leg restricts the platform the loop may be open: there the links count alone.
        """
        if self._dofs < (2 if self.space.planar else 3) + len(self.g.pairs):
            return ()
        x = self.inverse.x.get(j)
        while isinstance(x, VectorSymbol):
            quantity = self.book.notation[x.name]
            if quantity.role is not Role.RESOLVED:
                return (x,)
            x = self.inverse.x[quantity.joint]
        return ()

    def _rates(self, screws: LegScrews, S_dot: Vector) -> dict[int, Any]:
        """Joint rates."""
        qd: dict[int, Any] = {}
        target, turning = S_dot, self.p.omega
        for j in self.chain.extras:
            qd[j] = self.eq.note("yd_#", j)
            target = target - qd[j] * screws.v[j]
            turning = turning - qd[j] * self.g.spin(j)
        if qd:
            target = self.eq("S_dot_rest", target)
        turns = [self.eq("eta_#", Dot(n, turning), k) for k, n in enumerate(screws.n, 1)]
        for j, dual in screws.w.items():
            qd[j] = self.eq("qd_#", Dot(dual, target) + screws.resolved(j, turns), j)
        return qd

    def _angular_velocities(self, screws: LegScrews, S_dot: Vector, qd: dict[int, Any]) -> LegRates:
        g, omega, spin = self.g, {0: ZeroVector}, {0: ZeroTensor}
        for j in self.chain.turning:
            omega[j] = self.eq("omega_#", omega[g.group[j - 1]] + qd[j] * g.spin(j), j)
            spin[j] = self.eq("W_#", Compose(Skew(omega[j]), Skew(omega[j])), j)
        return LegRates(
            **vars(screws),
            S_dot=S_dot,
            qd=qd,
            omega=omega,
            spin=spin,
            slide={
                group: vector_sum(qd[j] * g.slide(j) for j in self.chain.slides(group))
                for group in self.chain.spans
            },
            end_turning=self.p.omega - omega[self.chain.last],
        )
