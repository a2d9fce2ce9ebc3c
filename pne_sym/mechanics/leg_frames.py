"""Canonical frames of a leg type.

Links that only slide against each other turn together: they form a *group*,
named by the revolute or helical joint that opens it (0: fixed to the base).
Every group g has a canonical frame: z along its joint's axis, x along the first
direction of interest in the group (a slide, the next joint's axis, the next
offset) that is not parallel to z.  A turn by the joint's angle leads from the
*turn* frame, fixed in the preceding group, to the canonical frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import sympy as sp

from pne_sym.derivation import Book, Frame
from pne_sym.mechanics.directions import AXES, is_exact, pattern_of, unit
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.leg_parameters import LegParameters
from pne_sym.mechanics.platform_directions import PlatformDirections
from pne_sym.mechanics.structure import TOLERANCE, LegType
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.model.kinematics import Array
from pne_sym.vector import Cross, Dot, ZeroVector, norm

_TERMS = glossary(r"""
e_#           | \mathbf e_{#}   | given
    axis of joint #
z_#           | \hat{\mathbf z}_{#} | given @own
    axis of group #
l_#           | \hat{\mathbf d}_{#} | given @own
    direction of interest in group #
n%_#_part     | \hat{\mathbf n}'_{#} | GEOMETRY constant
    part of the direction perpendicular to axis #
n%_#          | \hat{\mathbf n}_{#} | GEOMETRY constant
    canonical x axis of group #
z0_#          | \mathbf e_{#}   | given
    axis of joint #, fixed in link %
k%_#          | \hat{\mathbf k}_{%#} | given @before
    axis % of group &
aside_#       | \hat{\mathbf a}'_{#} | GEOMETRY constant @before
    direction across axis #
reference_#   | \hat{\mathbf a}_{#} | GEOMETRY constant @before
    reference direction of the angle of joint #
l0_#          | \hat{\mathbf d}^0_{#} | given
    direction of interest of group # at zero displacement
c0_#          | \cos\xi^0_{#} | GEOMETRY constant
    cosine of the angle at zero displacement of joint #
s0_#          | \sin\xi^0_{#} | GEOMETRY constant
    sine of the angle at zero displacement of joint #
""")


def build_geometry(book: Book, leg_type: LegType, planar: bool) -> LegGeometry:
    """Introduce the geometric parameters, constant vectors and frames of a leg type."""
    geometry = LegGeometry(leg_type)
    given = LegParameters(book, geometry, planar=planar)
    given.points()
    given.axes()
    given.offsets()
    _Frames(book, geometry, given.spec).frames()
    end = PlatformDirections(book, geometry, given)
    end.write()
    return replace(
        geometry,
        base_point=given.base_point,
        platform_point=given.platform_point,
        end_pattern=end.pattern,
    )


class _Frames:
    """Writes the frames.

    Attributes:
        spec: components of axes in spec axes, by joint.
        choice: spec components of the direction behind x, by group.
    """

    def __init__(self, book: Book, geometry: LegGeometry, spec: dict[int, Any]) -> None:
        self.book, self.g, self.spec = book, geometry, spec
        self.type, self.c = geometry.leg_type, geometry.canonical
        self.choice: dict[int, Any] = {}
        self.eq = Writer(book, geometry, _TERMS)

    def _axes_of(self, j: int) -> Array:
        """Axis of joint j in numbers (legs, 3)."""
        return self.type.over_legs(lambda leg: leg.joints[j - 1].axis)

    def frames(self) -> None:
        turning = [j for j in range(1, self.g.count + 1) if self.g.turns(j)]
        self._base_group(turning)
        for j in turning:
            self._turn_frame(j, self.g.group[j - 1])
        for j in range(1, self.g.count + 1):
            self._give_axis(j)
        self._note_straight_ends()

    def _candidates(self, group: int, z: Any) -> list[tuple[Any, Array]]:
        """Directions fixed in the group worth an axis: (spec components, numeric per leg).

        Of a next axis across z, the direction across both: along it lie the links beyond, if they
        swing about that axis.
        """
        found: list[tuple[Any, Array]] = []
        members = [j for j in self.g.group if self.g.group[j] == group]
        slides = [j for j in members if j and not self.g.turns(j)]
        following = [
            j
            for j in range(1, self.g.count + 1)
            if self.g.turns(j) and self.g.group[j - 1] == group and j != group
        ]
        found += [(self.spec[j], self._axes_of(j)) for j in slides]
        found += [self._across(j, z) for j in following]
        axes = []
        for j in [j + 1 for j in members]:
            along = [i for i, v in enumerate(self.type.model.offsets[j - 1]) if v != 0.0]
            axes += [AXES[along[0]]] if len(along) == 1 else []
        tiles = self.type.count, 1
        return found + [(unit(axis), np.tile(axis, tiles)) for axis in (*axes, *AXES)]

    def _across(self, j: int, z: Any) -> tuple[Any, Array]:
        """The direction across z and axis j if that turns alone, both coordinate ones; else it."""
        axis, tiles = self.spec[j], (self.type.count, 1)
        if (
            self.g.slides(j)
            or not all(c.is_Integer for c in (*axis, *z))
            or not any(sp.Matrix(axis).cross(sp.Matrix(z)))
        ):
            return axis, self._axes_of(j)
        both = np.cross(np.array(axis, dtype=float), np.array(z, dtype=float))
        return unit(both), np.tile(both, tiles)

    def _canonical(self, group: int, z: Any, z_values: Array) -> tuple[Any, Array, bool]:
        """Canonical x axis: (spec components or None, numeric per leg, is exact)."""
        for components, values in self._candidates(group, z):
            along = np.sum(values * z_values, axis=1)
            if np.any(np.abs(np.abs(along) - 1) < 1e-6):
                continue
            x = values - along[:, None] * z_values
            x /= np.linalg.norm(x, axis=1)[:, None]
            exact = all(c.is_Integer for c in (*components, *z)) and bool(np.all(along == 0))
            return components, x, exact
        raise AssertionError("no direction is free of the joint's axis")

    def _base_group(self, turning: Sequence[int]) -> None:
        self.c[0], vectors = np.tile(AXES, (self.type.count, 1, 1)), None
        if turning:
            self.c[0], vectors = self._frame_of(0, turning[0])
        name, spec = self.g.frame("axes", 0), self.g.frame("spec", 0)
        self.book.frames.append(Frame(name, spec, pattern_of(self.c[0]), axes=vectors))

    def _frame_of(self, group: int, j: int) -> tuple[Array, Any]:
        """Canonical axes, z along axis j: columns in spec axes, and vectors where not exact."""
        z, z_values = self.spec[j], self._axes_of(j)
        components, x_values, exact = self._canonical(group, z, z_values)
        self.choice[group] = components
        y_values = np.cross(z_values, x_values)
        matrix = np.stack([x_values, y_values, z_values], axis=2)
        if exact:
            self.g.exact_frames.add(group)
            return matrix, None
        z_vector = self.eq.give("z_#", z, group)
        direction = self.eq.give("l_#", components, group)
        x_vector = self._perpendicular_unit(group, direction, z_vector)
        return matrix, (x_vector, Cross(z_vector, x_vector), z_vector)

    def _perpendicular_unit(
        self, group: int, direction: Any, z: Any, zero: str = "", frame: str = ""
    ) -> Any:
        """Equation for the unit vector along the direction's part perpendicular to z.

        `frame` is where direction and z are given, by default in the group itself.
        """
        frame, along = frame or self.g.frame("spec", group), direction - Dot(z, direction) * z
        part = self.eq("n%_#_part", along, group, zero, body=frame)
        return self.eq("n%_#", part / norm(part), group, zero)

    def _turn_frame(self, j: int, previous: int) -> None:
        """Frames of the group that joint j opens: turn frame, canonical frame, spec frame."""
        z_values, c_previous = self._axes_of(j), self.c[previous]
        matrix, vectors = self._frame_of(j, j)
        self.c[j] = matrix
        local = np.einsum("lji,lj->li", c_previous, z_values)  # axis j in the previous frame
        reference, tilt = _reference(local)
        zero = np.einsum("lji,lj->li", c_previous, matrix[:, :, 0])
        if vectors is None and is_exact(zero) and is_exact(local):
            reference = zero  # so that the angle is the joint's own
        turn = np.stack([reference, np.cross(local, reference), local], axis=2)
        spec_reference = np.einsum("lij,lj->li", c_previous, reference)
        cosine = np.sum(spec_reference * matrix[:, :, 0], axis=1)
        sine = np.sum(z_values * np.cross(spec_reference, matrix[:, :, 0]), axis=1)
        self.g.zero_angle[j] = np.stack([cosine, sine], axis=1)
        exact = vectors is None and is_exact(turn) and is_exact(np.stack([cosine, sine]))
        frames = self.book.frames
        turn_name, axes_name = self.g.frame("turn", j), self.g.frame("axes", j)
        parent = self.g.frame("axes", previous)
        if exact:
            self.g.turn_axes[j] = pattern_of(turn)
            frames.append(Frame(turn_name, parent, self.g.turn_axes[j]))
            self.g.zero_turn[j] = (sp.Integer(round(cosine[0])), sp.Integer(round(sine[0])))
        else:
            self._general_turn(j, previous, turn, tilt)
        names = self.g.name(f"c_{j}"), self.g.name(f"s_{j}")
        frames.append(Frame(axes_name, turn_name, angle=sp.symbols(names, real=True)))
        spec_in_axes = pattern_of(np.transpose(matrix, (0, 2, 1)))
        frames.append(Frame(self.g.frame("spec", j), axes_name, spec_in_axes, rows=vectors))

    def _general_turn(self, j: int, previous: int, turn: Array, tilt: int) -> None:
        """Turn frame and zero angle from live axes."""
        g, frame = self.g, self.g.frame("spec", previous)
        axis = self.eq.give("z0_#", self.spec[j], j, j - 1, frame=frame)
        k = self.eq.give("k%_#", unit(AXES[tilt]), j, tilt, previous)
        across = self.eq("aside_#", Cross(k, axis), j)
        reference = self.eq("reference_#", across / norm(across), j)
        axes = reference, Cross(axis, reference), axis
        self.book.frames.append(
            Frame(g.frame("turn", j), g.frame("axes", previous), pattern_of(turn), axes=axes)
        )
        direction = self.eq.give("l0_#", self.choice[j], j, frame=frame)
        x_zero = self._perpendicular_unit(j, direction, axis, zero="0", frame=frame)
        g.zero_turn[j] = (
            self.eq("c0_#", Dot(reference, x_zero), j),
            self.eq("s0_#", Dot(axis, Cross(reference, x_zero)), j),
        )

    def _note_straight_ends(self) -> None:
        """Helical and revolute joints whose turning does or does not move the connection point."""
        g = self.g
        for j in reversed(range(1, g.count + 1)):
            if not g.turns(j):
                continue
            straight = all(
                g.offset[i] == ZeroVector
                or (g.group[i - 1] == j and g.offset_is_zero(j, i)[:2] == (True, True))
                for i in range(j + 1, g.count + 2)
            )
            slides = all(
                (not g.turns(i) and g.parallel(j, i)) or i in g.unseen
                for i in range(j + 1, g.count + 1)
            )
            if g.slides(j) and not (straight and slides):
                g.bent_helices.add(j)
            if not g.slides(j) and straight and slides and not g.is_extra(j):
                g.unseen.add(j)

    def _give_axis(self, j: int) -> None:
        """The axis vector e_j, in the frame where it is simplest."""
        group = self.g.group[j]
        pattern = pattern_of(np.einsum("lji,lj->li", self.c[group], self._axes_of(j)))
        if None in pattern:
            frame, components = self.g.frame("spec", group), self.spec[j]
        else:
            frame, components = self.g.frame("axes", group), pattern
        self.g.e[j] = self.eq.give("e_#", components, j, frame=frame)


def _reference(local: Array) -> tuple[Array, int]:
    """Reference direction across axis j in the previous canonical frame.

    Along a coordinate axis: the next coordinate direction.  Otherwise y x axis,
    a pure tilt about y where the axis lies in the xz plane.  Also returns the
    number of the coordinate direction that was crossed with the axis.
    """
    if is_exact(local) and np.all(np.abs(local - local[0]) < TOLERANCE):
        other = (int(np.argmax(np.abs(local[0]))) + 2) % 3
        return np.cross(AXES[other], np.rint(local)), other
    tilt = 1 if np.max(np.abs(local[:, 1])) < 0.9 else 0
    reference = np.cross(AXES[tilt], local)
    reference /= np.linalg.norm(reference, axis=1)[:, None]
    return reference, tilt
