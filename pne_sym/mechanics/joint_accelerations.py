"""Accelerations of a leg's joints, and their linear forms in the platform's acceleration.

Reference: sections 2.2, 2.3 and 2.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from pne_sym.derivation import Book
from pne_sym.mechanics.leg_rates import LegRates
from pne_sym.mechanics.linear_writer import Collection, LinearWriter
from pne_sym.mechanics.platform_motion import PlatformMotion
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.vector import (
    Cross,
    Dot,
    LinearForm,
    Skew,
    Vector,
    ZeroTensor,
    ZeroVector,
    linear_form,
    vector_sum,
)

_TERMS = glossary(r"""
u_1        | \mathbf u_1              | RATE @base | Eq. 23
    centripetal acceleration of the connection point
a_p        | \mathbf a_p              | RATE COLLECTED_ACCELERATION @base | Eq. 23
    acceleration of the connection point without its centripetal part
S_ddot     | \ddot{\mathbf S}         | RATE POINT_ACCELERATION @base | Eq. 23
    acceleration of the connection point
zeta_#     | \boldsymbol\zeta_{#}     | RATE @link
    angular acceleration of link # from the turning of axis #
beta_#     | \boldsymbol\beta_{#}     | RATE @link
    angular acceleration of link # at zero joint accelerations
bias       | \mathfrak b              | RATE BIAS @tip | Sec. 2.2
    acceleration of the connection point at zero joint accelerations
ydd_#      | \ddot y_{#}              | given JOINT_ACCELERATION | U/s^2
    acceleration of extra joint #
rel        | \ddot{\mathbf S}' ; \mathbf E | RATE @tip
    acceleration of the connection point left to the joint accelerations
nd_m#      | \dot{\mathbf n}_{m#}     | RATE @tip
    rate of moment direction #
nu_#       | \nu_{#}                  | RATE | Sec. 2.2, joint table
    bias of the angular acceleration along moment direction #
etad_#     | \dot\eta_{#} ; \boldsymbol\eta_{#} | RATE
    acceleration with which the joints turn along moment direction #
qdd_#      | \ddot q_{#} ; \mathbf w_{#} | RECIPROCITY JOINT_ACCELERATION | Eqs. 8, 9, 16
    acceleration of joint #
""")


@dataclass(frozen=True)
class JointAccelerations(LegRates):
    """Accelerations of a leg's joints.

    Attributes:
        collection: what is known to depend on the acceleration.
        S_ddot: acceleration of the connection point.
        qdd: joint accelerations.
        ydd: those of the extra coordinates, by joint.
        nu: biases of the angular acceleration along the moment directions.
        relative: acceleration of the connection point less the bias.
        coriolis: angular acceleration from the turning of a group's axis, by group.
    """

    collection: Collection
    S_ddot: Any
    qdd: dict[int, Any]
    ydd: dict[int, Any]
    nu: list[Any]
    relative: Any
    coriolis: dict[int, Vector]

    @property
    def a_p(self) -> Any:
        """Acceleration of the connection point without its centripetal part."""
        return self.collection.a_p

    @property
    def known(self) -> dict[Any, LinearForm]:
        """Linear forms of everything that depends on the acceleration."""
        return self.collection.known


class _Bias(NamedTuple):
    """Accelerations at zero joint accelerations.

    Attributes:
        point: of the connection point.
        coriolis: angular, from the turning of the group's axis, by group.
        beta: angular, by group.
    """

    point: Vector
    coriolis: dict[int, Vector]
    beta: dict[int, Vector]


def write_joint_accelerations(
    book: Book, platform: PlatformMotion, rates: LegRates, *, rotates: bool
) -> JointAccelerations:
    """Acceleration of the connection point, the bias, and what is left to the joints."""
    g, p = rates.chain.g, platform
    eq = Writer(book, g, _TERMS)
    u_1: Vector = ZeroVector
    forms: tuple[Vector, ...] = ()
    if rotates:
        q = g.platform_point
        u_1 = eq("u_1", Cross(p.omega, Cross(p.omega, q)), forms=(p.spin @ q,))
        forms = (p.t_ddot + p.tensor @ q,)
    a_p = eq("a_p", p.t_ddot + Cross(p.alpha, g.platform_point))
    collection = Collection(a_p, [a_p], {}, rates.named)
    S_ddot = eq("S_ddot", a_p + u_1, forms=forms)
    collection.known[S_ddot] = linear_form(a_p + u_1, [a_p], {})
    return _Writer(book, platform, rates, collection).write(S_ddot)


class _Writer:
    def __init__(
        self, book: Book, platform: PlatformMotion, rates: LegRates, collection: Collection
    ) -> None:
        self.p, self.rates, self.collection = platform, rates, collection
        self.chain, self.g = rates.chain, rates.chain.g
        self.eq = LinearWriter(book, self.g, _TERMS, collection)

    def write(self, S_ddot: Vector) -> JointAccelerations:
        """Accelerations of the joints from that of the connection point."""
        g, rates, unknowns = self.g, self.rates, self.collection.unknowns
        bias = self._bias()
        target: Vector = S_ddot - bias.point
        turning: Vector = self.p.alpha
        if rates.n and self.p.alpha != ZeroVector:
            unknowns.append(self.p.alpha)
        ydd: dict[int, Any] = {}
        for j in self.chain.extras:
            ydd[j] = self.eq.note("ydd_#", j)
            unknowns.append(ydd[j])
            target = target - ydd[j] * rates.v[j]
            turning = turning - ydd[j] * g.spin(j)
        if target != S_ddot:
            target = self.eq.collected("rel", target)
        nu = self._orientation_bias(bias.beta)
        return JointAccelerations(
            **vars(rates),
            collection=self.collection,
            S_ddot=S_ddot,
            qdd=ydd | self._resolved(target, turning, nu),
            ydd=ydd,
            nu=nu,
            relative=target,
            coriolis=bias.coriolis,
        )

    def _resolved(self, target: Vector, turning: Vector, nu: list[Any]) -> dict[int, Any]:
        """Joint accelerations by the reciprocal wrenches."""
        rates = self.rates
        turns = [
            self.eq.collected("etad_#", Dot(n, turning) + own, k)
            for k, (n, own) in enumerate(zip(rates.n, nu, strict=True), 1)
        ]
        return {
            j: self.eq.collected("qdd_#", Dot(dual, target) + rates.resolved(j, turns), j)
            for j, dual in rates.w.items()
        }

    def _bias(self) -> _Bias:
        """Accelerations at zero joint accelerations."""
        g, rates = self.g, self.rates
        coriolis: dict[int, Vector] = {0: ZeroVector}
        beta: dict[int, Vector] = {0: ZeroVector}
        terms: list[Vector] = []
        forms: list[Vector] = []
        for j, span in self.chain.spans.items():
            if j:
                previous = g.group[j - 1]
                turned = rates.qd[j] * Cross(rates.omega[previous], g.spin(j))
                coriolis[j] = self.eq.named("zeta_#", turned, j)
                beta[j] = self.eq.named("beta_#", beta[previous] + coriolis[j], j)
            omega = rates.omega[j]
            sliding = Cross(omega, rates.slide[j]) * 2
            terms.extend((Cross(beta[j], span) + Cross(omega, Cross(omega, span)), sliding))
            tensor = Skew(beta[j]) + rates.spin[j]
            forms.extend((tensor @ span if tensor != ZeroTensor else ZeroVector, sliding))
        total, seen = vector_sum(terms), (vector_sum(forms),)
        point: Vector = ZeroVector
        if total != ZeroVector:
            point = self.eq("bias", total, forms=seen)
        return _Bias(point, coriolis, beta)

    def _orientation_bias(self, beta: dict[int, Vector]) -> list[Any]:
        """Per moment direction, what its turning adds to the angular acceleration along it."""
        p, last = self.p, self.chain.last
        omega, found = self.rates.omega[last], []
        for k, ((link, platform), n) in enumerate(zip(self.g.pairs, self.rates.n, strict=True), 1):
            turning = Cross(Cross(omega, link), platform) + Cross(link, Cross(p.omega, platform))
            rate = self.eq.named("nd_m#", turning, k)
            found.append(self.eq("nu_#", Dot(rate, p.omega - omega) - Dot(n, beta[last]), k))
        return found
