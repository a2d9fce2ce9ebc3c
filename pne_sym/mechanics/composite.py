"""Inertia of a leg in the accelerations of its joints, from composite bodies.

All links beyond a joint, frozen together, are one composite body.  Accelerating the joint
takes the force and the moment of that body, whose components along the degrees of freedom of the
joint itself and of those before it are the entries of the leg's inertia matrix.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from pne_sym.derivation import Book, Law
from pne_sym.mechanics.leg_chain import LegChain
from pne_sym.mechanics.links import LinkBody
from pne_sym.vector import (
    Cross,
    Dot,
    Identity,
    Outer,
    TensorSymbol,
    VectorSymbol,
    ZeroTensor,
    ZeroVector,
    tensor_sum,
    vector_sum,
)


@dataclass(frozen=True)
class _Body:
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
        self.book, self.g, self.chain = book, chain.g, chain
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
                entry = self._along(j, force, moment)
                if entry == 0:
                    continue
                symbol = self.book.define(
                    g.name(f"D_{j}_{k}"),
                    entry,
                    rf"\mathcal M_{{{j}{k}}}",
                    f"inertia of joint {k} along joint {j}" if j < k else f"inertia of joint {k}",
                    Law.FREEDOM,
                    reference="Sec. 2.2, joint table",
                )
                found[j, k] = found[k, j] = symbol
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
        if own is not None:
            body = (
                _Body(sp.S.Zero, ZeroVector, own.inertia)
                if own.at_tip
                else _Body(own.mass, own.first_moment, own.inertia)
            )
            parts.append(body if own.at_tip else self._moved(body, self.chain.reach(k)))
        turns = k == group
        return _Body(
            sp.Add(*(p.mass for p in parts)),
            self._moment(k, vector_sum(p.first_moment for p in parts)),
            self._tensor(k, tensor_sum(p.inertia for p in parts))
            if turns
            else tensor_sum(p.inertia for p in parts),
        )

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

    def _moment(self, k: int, value: Any) -> Any:
        if value == ZeroVector or isinstance(value, VectorSymbol):
            return value
        return self.book.define(
            self.g.name(f"hc_{k}"),
            value,
            rf"\mathbf h^c_{{{k}}}",
            f"first moment of the links from {k} outwards",
            Law.DEFINITION,
            body=self.g.frame("axes", self.g.group[k]),
        )

    def _tensor(self, k: int, value: Any) -> Any:
        if value == ZeroTensor or isinstance(value, TensorSymbol):
            return value
        return self.book.define(
            self.g.name(f"Jc_{k}"),
            value,
            rf"\mathbf J^c_{{{k}}}",
            f"inertia tensor of the links from {k} outwards about joint {k}{self._but_the_last()}",
            Law.DEFINITION,
            body=self.g.frame("axes", k),
            symmetric=True,
        )

    def _but_the_last(self) -> str:
        """The last link where its mass is counted with the platform."""
        carried = any(body.at_tip for body in self.bodies.values())
        return ", that of the last link about the connection point" if carried else ""

    def _effort(self, k: int, body: _Body) -> tuple[Any, Any]:
        """Force, and moment about the group's origin, per unit acceleration of joint k."""
        g, spin, slide = self.g, self.g.spin(k), self.g.slide(k)
        force = Cross(spin, body.first_moment) + body.mass * slide
        moment = body.inertia @ spin + Cross(body.first_moment, slide)
        frame = g.frame("axes", g.group[k])
        force = self._named(
            f"P_c_{k}",
            force,
            rf"\boldsymbol\Pi_{{{k}}}",
            f"force that accelerates joint {k}, per unit",
            Law.NEWTON,
            frame,
        )
        if not g.group[k]:
            return force, ZeroVector
        return force, self._named(
            f"L_c_{k}",
            moment,
            rf"\boldsymbol\Lambda_{{{k}}}",
            f"moment about joint {g.group[k]} that accelerates joint {k}, per unit",
            Law.EULER,
            frame,
        )

    def _carried(self, k: int, group: int, force: Any, moment: Any) -> Any:
        """The same moment about the origin of a group further in."""
        if not group:
            return ZeroVector
        total = vector_sum((moment, Cross(self.chain.spans[group], force)))
        return self._named(
            f"L_c_{k}_{group}",
            total,
            rf"\boldsymbol\Lambda_{{{k},{group}}}",
            f"moment about joint {group} that accelerates joint {k}, per unit",
            Law.EULER,
            self.g.frame("axes", group),
        )

    def _named(self, stem: str, value: Any, latex: str, title: str, law: Law, frame: str) -> Any:
        if value == ZeroVector or isinstance(value, VectorSymbol):
            return value
        return self.book.define(self.g.name(stem), value, latex, title, law, body=frame)

    def _along(self, j: int, force: Any, moment: Any) -> Any:
        return Dot(self.g.spin(j), moment) + Dot(self.g.slide(j), force)
