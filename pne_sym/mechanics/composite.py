"""Inertia of a leg in the accelerations of its joints, from composite bodies.

All links beyond a joint, frozen together, are one composite body.  Accelerating the joint
takes the force and the moment of that body, whose components along the degrees of freedom of the
joint itself and of those before it are the entries of the leg's inertia matrix.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import sympy as sp

from pne_sym.derivation import Book
from pne_sym.mechanics.leg_chain import LegChain
from pne_sym.mechanics.links import LinkBody
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.vector import (
    Cross,
    Dot,
    Identity,
    Outer,
    ZeroTensor,
    ZeroVector,
    tensor_sum,
    vector_sum,
)

_TERMS = glossary(r"""
D_#_%     | \mathcal M_{#%}          | FREEDOM | Sec. 2.2, joint table
    inertia of joint % along joint #
D_#_%:own | \mathcal M_{#%}          | FREEDOM | Sec. 2.2, joint table
    inertia of joint #
hc_#      | \mathbf h^c_{#}          | DEFINITION @link
    first moment of the links from # outwards
Jc_#      | \mathbf J^c_{#}          | DEFINITION symmetric @link
    inertia tensor of the links from # outwards about joint #%
P_c_#     | \boldsymbol\Pi_{#}       | NEWTON @link
    force that accelerates joint #, per unit
L_c_#     | \boldsymbol\Lambda_{#}   | EULER @link
    moment about joint % that accelerates joint #, per unit
L_c_#_%   | \boldsymbol\Lambda_{#,%} | EULER
    moment about joint % that accelerates joint #, per unit
""")


class _Body(NamedTuple):
    """Mass, first moment and inertia tensor about the origin of a group."""

    mass: Any
    first_moment: Any
    inertia: Any


class CompositeWriter:
    """Writes the composite bodies of a leg and what accelerating each joint takes.

    The mass at the connection point and the last link's first moment about it are left out:
    they move with the platform and are accounted for there.
    """

    def __init__(self, book: Book, chain: LegChain, bodies: Sequence[LinkBody]) -> None:
        self.g, self.chain, self.eq = chain.g, chain, Writer(book, chain.g, _TERMS)
        self.bodies = {body.joint: body for body in bodies}

    def inertia(self) -> dict[tuple[int, int], Any]:
        """Entries of the leg's inertia matrix by joints (j, k), both orders; zeros left out."""
        g = self.g
        found: dict[tuple[int, int], Any] = {}
        beyond = _Body(sp.S.Zero, ZeroVector, ZeroTensor)
        for k in range(g.count, 0, -1):
            beyond = self._composite(k, beyond)
            force, moment = self._effort(k, beyond)
            for j in range(k, 0, -1):
                if j < k and g.group[j] != g.group[j + 1]:
                    moment = self._carried(k, g.group[j], force, moment)
                entry = Dot(g.spin(j), moment) + Dot(g.slide(j), force)
                if entry == 0:
                    continue
                stem = "D_#_%" if j < k else "D_#_%:own"
                found[j, k] = found[k, j] = self.eq(stem, entry, j, k)
        return found

    def _composite(self, k: int, beyond: _Body) -> _Body:
        """The links from k outwards, about the origin of link k's group."""
        g = self.g
        group = g.group[k]
        parts = []
        if k < g.count:
            opens = g.group[k + 1] != group
            parts.append(self._moved(beyond, self.chain.spans[group]) if opens else beyond)
        own = self.bodies.get(k)
        if own is not None and own.at_tip:
            parts.append(_Body(sp.S.Zero, ZeroVector, own.inertia))
        elif own is not None:
            body = _Body(own.mass, own.first_moment, own.inertia)
            parts.append(self._moved(body, self.chain.reach(k)))
        mass = sp.Add(*(p.mass for p in parts))
        moment = self.eq.named("hc_#", vector_sum(p.first_moment for p in parts), k)
        tensor = tensor_sum(p.inertia for p in parts)
        if k == group:
            # The last link may be counted with the platform.
            carried = any(body.at_tip for body in self.bodies.values())
            last = ", that of the last link about the connection point" * carried
            tensor = self.eq.named("Jc_#", tensor, k, last)
        return _Body(mass, moment, tensor)

    def _moved(self, body: _Body, arm: Any) -> _Body:
        """The same body about a point from which its own reference point is at `arm`."""
        if arm == ZeroVector or (body.mass == 0 and body.first_moment == ZeroVector):
            return body
        middle = body.first_moment + (body.mass / 2) * arm
        return _Body(
            body.mass,
            body.first_moment + body.mass * arm,
            body.inertia
            + 2 * Dot(arm, middle) * Identity
            - Outer(arm, middle)
            - Outer(middle, arm),
        )

    def _effort(self, k: int, body: _Body) -> tuple[Any, Any]:
        """Force, and moment about the group's origin, per unit acceleration of joint k."""
        g, spin, slide = self.g, self.g.spin(k), self.g.slide(k)
        force = Cross(spin, body.first_moment) + body.mass * slide
        moment = body.inertia @ spin + Cross(body.first_moment, slide)
        force = self.eq.named("P_c_#", force, k)
        if not g.group[k]:
            return force, ZeroVector
        return force, self.eq.named("L_c_#", moment, k, g.group[k])

    def _carried(self, k: int, group: int, force: Any, moment: Any) -> Any:
        """The same moment about the origin of a group further in."""
        if not group:
            return ZeroVector
        total = vector_sum((moment, Cross(self.chain.spans[group], force)))
        return self.eq.named("L_c_#_%", total, k, group, body=self.g.frame("axes", group))
