"""Links of a leg: their parameters, and their inertia about reference points.

A link's reference point is its joint; that of the last link may be the connection point, whose
acceleration the platform gives.
"""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

from pne_sym.derivation import Book, Rule
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.live import Place, of_legs
from pne_sym.mechanics.platform_motion import symmetric_entries
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.vector import Dot, Identity, Outer, Vector, ZeroVector

_TERMS = glossary(r"""
rho_#     | \boldsymbol\rho_{#}  | given @own
    origin of link # to its centre of mass, fixed in the link
I_#       | \mathbf I_{#}        | given @own
    inertia tensor of link # about its centre of mass
rho_tip_# | \boldsymbol\rho'_{#} | LUMPING constant @own
    connection point to the centre of mass of link #
h_#       | \mathbf h_{#}        | LUMPING constant @own
    first moment of link # about %
J_#       | \mathbf J_{#}        | LUMPING constant symmetric @own
    inertia tensor of link # about %
""")


class LinkBody(NamedTuple):
    """A link with inertia.

    Attributes:
        joint: number of the joint that moves it.
        group: the group that it turns with.
        at_tip: its reference point is the connection point, else its joint.
        mass: scalar.
        first_moment: m r about the reference point, fixed in the link.
        inertia: tensor about the reference point.
    """

    joint: int
    group: int
    at_tip: bool
    mass: Any
    first_moment: Vector
    inertia: Any


def introduce_bodies(book: Book, g: LegGeometry, planar: bool) -> list[LinkBody]:
    """Parameters of the links, and their lumped inertia about their reference points."""
    free = sum(not joint.extra for joint in g.leg_type.model.joints)
    # Only a leg that lets the connection point move freely carries its acceleration over to the
    # last link; else that link moves as its own joints let it.
    unconstrained = free == (2 if planar else 3) + len(g.pairs)
    last_moving = g.count if unconstrained else 0
    writer = _Writer(book, g, planar=planar)
    return [
        writer.body(j, at_tip=j == last_moving)
        for j, joint in enumerate(g.leg_type.model.joints, 1)
        if not joint.link.is_massless
    ]


class _Writer:
    def __init__(self, book: Book, g: LegGeometry, *, planar: bool) -> None:
        self.book, self.g, self.planar = book, g, planar
        self.eq = Writer(book, g, _TERMS)

    def body(self, j: int, *, at_tip: bool) -> LinkBody:
        """Lumped inertia of link j about its reference point."""
        g = self.g
        mass, arm, inertia = self._parameters(j)
        beyond = g.offset[g.count + 1]
        if at_tip and beyond != ZeroVector:
            arm = self.eq("rho_tip_#", arm - beyond, j)
        point = "the connection point" if at_tip else f"the origin of link {j}"
        moment = self.eq("h_#", mass * arm, j, point)
        about_point = inertia + mass * (Dot(arm, arm) * Identity - Outer(arm, arm))
        tensor = self.eq("J_#", about_point, j, point)
        return LinkBody(j, g.group[j], at_tip, mass, moment, tensor)

    def _parameters(self, j: int) -> tuple[Any, Any, Any]:
        """Mass, centre of mass and inertia tensor of link j, as its specification has them."""
        given = partial(of_legs, self.book, self.g.leg_type, Place.link(self.g.leg_type, j))
        (mass,) = given("mass")
        centre = given("centre_of_mass", zeros=(2,) if self.planar else ())
        rule = Rule.PLANAR_INERTIA if self.planar else Rule.INERTIA
        entries = symmetric_entries(given("inertia", rule=rule), self.planar)
        return mass, self.eq.give("rho_#", centre, j), self.eq.give("I_#", entries, j)
