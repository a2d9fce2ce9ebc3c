"""Live parameters of a leg type's geometry, and the constant vectors made of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Unpack

import numpy as np
import sympy as sp

from pne_sym.derivation import Book, Frame, Rule
from pne_sym.mechanics.axis_relations import axis_relations
from pne_sym.mechanics.directions import unit
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.live import END, LEG, Demands, Place, note, of_legs
from pne_sym.mechanics.structure import is_coordinate
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.model.kinematics import Array, chain_pose
from pne_sym.vector import ZeroVector

_TERMS = glossary(r"""
b             | \mathbf b       | given @base
    base point of the leg
q             | \mathbf p       | given @platform
    platform origin to connection point, fixed in the platform
d_#           | \mathbf d_{#}   | given
    offset of &, fixed in link %
""")
_OFFSET_END = END._replace(word="platform joint")


class LegParameters:
    """Writes the parameters of a leg type, in the order points, axes, offsets.

    Attributes:
        spec: components of axes in spec axes, by joint.
        base_point, platform_point: vectors.
    """

    def __init__(self, book: Book, geometry: LegGeometry, *, planar: bool) -> None:
        self.book, self.g, self.planar = book, geometry, planar
        self.type = geometry.leg_type
        self.spec: dict[int, Any] = {}
        self.base_point: Any = None
        self.platform_point: Any = None
        self.eq = Writer(book, geometry, _TERMS)

    def field(self, name: str, at: Place = LEG, **demands: Unpack[Demands]) -> tuple[sp.Expr, ...]:
        """A live parameter over the legs of the type."""
        return of_legs(self.book, self.type, at, name, **demands)

    def points(self) -> None:
        """Base point, platform point, leg axes."""
        flat = (2,) if self.planar else ()
        b = self.field("base_point", zeros=flat)
        rule = Rule.PLANAR_ROTATION if self.planar else Rule.ROTATION
        frame = self.field("base_frame", rule=rule)
        p = self.field("platform_point", zeros=flat)
        if self.planar:  # legs of the plane keep z along the plane's normal
            frame = (*frame[:2], 0, *frame[3:5], 0, 0, 0, 1)
        self.base_point = self.eq.give("b", b)
        self.platform_point = self.eq.give("q", p)
        self.book.frames.append(Frame(self.g.frame("spec", 0), "base", frame))

    def axes(self) -> None:
        """Axes and pitches of the joints, and the groups of links that turn together."""
        g, group = self.g, 0
        g.group[0] = 0
        for j, joint in enumerate(self.type.model.joints, 1):
            if is_coordinate(joint.axis):
                self.spec[j] = unit(joint.axis)
            else:
                zeros = (2,) if self.planar else ()
                self.spec[j] = self.field("axis", Place.joint(self.type, j), zeros=zeros)
            if joint.kind.pitched:
                (pitch,) = self.field("pitch", Place.joint(self.type, j))
                what = f"pitch of joint {j}: advance per angle"
                g.pitch[j] = note(self.book, pitch, rf"\kappa_{{{j}}}", what)
            group = j if g.turns(j) else group
            g.group[j] = group
        g.axes_at.extend(self._axes_at())
        self.book.parameters.relations.extend(axis_relations(self.type))

    def _axes_at(self) -> Iterator[Array]:
        """Axis directions (legs, joints, 3) with the extra joints turned, all else at zero."""
        turned = [self.g.is_extra(j) and self.g.turns(j) for j in range(1, self.g.count + 1)]
        for k in range(3 if any(turned) else 1):
            q = [(0.7 + 0.9 * k + 0.3 * j) * turns for j, turns in enumerate(turned, 1)]
            yield np.array([chain_pose(leg, q).axes for leg in self.type.legs])

    def offsets(self) -> None:
        """From joint to joint, and to the connection point."""
        for j in range(1, self.g.count + 2):
            zeros = tuple(i for i, v in enumerate(self.type.model.offsets[j - 1]) if v == 0.0)
            if len(zeros) == 3:
                self.g.offset[j] = ZeroVector
                continue
            at = _OFFSET_END if j > self.g.count else Place.joint(self.type, j)
            components = self.field("offset", at, zeros=zeros)
            frame, what = self.g.frame("spec", self.g.group[j - 1]), at.word
            self.g.offset[j] = self.eq.give("d_#", components, j, j - 1, what, frame=frame)
