"""Geometry of a leg type: its parameters, constant vectors and canonical frames.

Links that only slide against each other turn together: they form a *group*,
named by the revolute or helical joint that opens it (0: fixed to the base).
Every group g has a canonical frame: z along its joint's axis, x along the first
direction of interest in the group (a slide, the next joint's axis, the next
offset) that is not parallel to z.  A turn by the joint's angle leads from the
*turn* frame, fixed in the preceding group, to the canonical frame.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from pne_sym.derivation import Book, Frame, ParameterField, Quantity, Rule
from pne_sym.mechanics.axis_relations import axis_relations
from pne_sym.mechanics.structure import TOLERANCE, LegType, is_coordinate
from pne_sym.mechanics.terms import Writer, filled, glossary
from pne_sym.model.joint_kinds import JointKind
from pne_sym.model.kinematics import rotation_about
from pne_sym.model.manipulator import Leg, Vector3
from pne_sym.model.platform_kinds.interface import Direction
from pne_sym.vector import Cross, Dot, Vector, VectorSymbol, ZeroVector, norm
from pne_sym.vector.nodes import scale

Array = NDArray[np.float64]
_E = np.eye(3)
_NUMBER = re.compile(r"(?<=_)\d+(?=_|$)")


_TERMS = glossary(r"""
b             | \mathbf b       | given
    base point of the leg
q             | \mathbf p       | given
    platform origin to connection point, fixed in the platform
e_#           | \mathbf e_{#}   | given
    axis of joint #
d_#           | \mathbf d_{#}   | given
    offset of &, fixed in link %
z_#           | \hat{\mathbf z}_{#} | given
    axis of group #
l_#           | \hat{\mathbf d}_{#} | given
    direction of interest in group #
n%_#_part     | \hat{\mathbf n}'_{#} | GEOMETRY constant
    part of the direction perpendicular to axis #
n%_#          | \hat{\mathbf n}_{#} | GEOMETRY constant
    canonical x axis of group #
z0_#          | \mathbf e_{#}   | given
    axis of joint #, fixed in link %
k%_#          | \hat{\mathbf k}_{%#} | given
    axis % of group &
aside_#       | \hat{\mathbf a}'_{#} | GEOMETRY constant
    direction across axis #
reference_#   | \hat{\mathbf a}_{#} | GEOMETRY constant
    reference direction of the angle of joint #
l0_#          | \hat{\mathbf d}^0_{#} | given
    direction of interest of group # at zero displacement
c0_#          | \cos\xi^0_{#} | GEOMETRY constant
    cosine of the angle at zero displacement of joint #
s0_#          | \sin\xi^0_{#} | GEOMETRY constant
    sine of the angle at zero displacement of joint #
end_axis      | \hat{\mathbf l} | given
    axis of the platform joint in the last link
end_across    | \hat{\mathbf i}_{#} | given
    direction # of the last link, well across that axis
end_l#        | \hat{\mathbf l}_{#} | given
    direction of the platform joint, fixed in the last link
end_l#:across | \hat{\mathbf l}_{#} | LUMPING constant
    direction # across the platform joint's axis, fixed in the last link
end_p#        | \hat{\mathbf p}_{#} | given
    direction of the platform joint, fixed in the platform
""")
_FIELDS = {
    "base_point": ("base_point", (3,), "m", "base point, base frame"),
    "base_frame": ("base_frame", (3, 3), "-", "rotation from leg axes to base axes"),
    "platform_point": ("platform_point", (3,), "m", "platform joint, platform frame"),
    "joint#_axis": ("joints[%].axis", (3,), "-", "axis of joint #, preceding link's frame"),
    "joint#_pitch": ("joints[%].pitch", (), "m/rad", "pitch of joint #"),
    "joint#_offset": ("joints[%].offset", (3,), "m", "offset of joint #, preceding link's frame"),
    "platform_joint_#": ("platform_joint.#", (3,), "-", "# of the platform joint"),
    "platform_joint_offset": (
        "platform_joint.offset",
        (3,),
        "m",
        "offset of platform joint, preceding link's frame",
    ),
    "platform_joint_rotation": (
        "platform_joint.rotation",
        (3, 3),
        "-",
        "platform axes in the last link's frame",
    ),
}
"""Live parameters of a leg: path in the leg, shape, unit, meaning."""


@dataclass(frozen=True)
class LegGeometry:
    """Symbols and frames of a leg type.

    Attributes:
        leg_type: the leg type.
        e: axis vectors by joint number 1..m.
        offset: offset vectors a_1..a_{m+1} by joint number (m+1: the tip).
        group: group of link j by joint number (link 0: the base).
        x_axis: canonical x axis by group.
        zero_turn: (cos, sin) of the angle from turn frame to canonical frame at
            zero displacement, by joint number.
        turn_axes: axes of the turn frame as columns in the canonical axes before it, 0, 1, -1
            by rows; by joint number, where the structure fixes them.
        base_point, platform_point: b and q.
        pitch: pitch symbols of helical joints, by joint number.
        pairs: where the leg transmits moments, directions (fixed in the last link,
            fixed in the platform) that the platform joint keeps perpendicular.
        end_pattern: canonical components of the platform joint's axis in the last link:
            0, 1, -1 by structure, else None.
        size: length of the leg's lever arms (scalar parameter), see `scales`.
        arm: the same at home, in numbers.
        axes_at: axis directions (legs, joints, 3) in leg axes with all joints at
            zero, and with extra joints at arbitrary displacements.
        canonical: canonical axes as columns in spec axes (legs, 3, 3), by group.
        zero_angle: (legs, 2) numeric (cos, sin) of zero_turn, by joint.
        bent_helices: helical joints that turn the connection point about their axes.
        unseen: revolute joints whose axes pass through the connection point.
        pure_moment: the wrench that the leg leaves out is a pure moment at home.
        completion: basis completion of a leg that lacks degrees of freedom, in space.
        composite: the leg's inertia is written in the accelerations of its joints.
        exact_frames: groups whose canonical axes are coordinate directions.
    """

    leg_type: LegType
    e: dict[int, VectorSymbol] = field(default_factory=dict)
    offset: dict[int, Vector] = field(default_factory=dict)
    group: dict[int, int] = field(default_factory=dict)
    x_axis: dict[int, VectorSymbol] = field(default_factory=dict)
    zero_turn: dict[int, tuple[Any, Any]] = field(default_factory=dict)
    turn_axes: dict[int, tuple[Any, ...]] = field(default_factory=dict)
    pitch: dict[int, Any] = field(default_factory=dict)
    base_point: Any = None
    platform_point: Any = None
    size: Any = None
    arm: float = 1.0
    pairs: list[tuple[VectorSymbol, VectorSymbol]] = field(default_factory=list)
    end_pattern: tuple[Any, ...] = ()
    axes_at: list[Array] = field(default_factory=list)
    canonical: dict[int, Array] = field(default_factory=dict)
    exact_frames: set[int] = field(default_factory=set)
    zero_angle: dict[int, Array] = field(default_factory=dict)
    bent_helices: set[int] = field(default_factory=set)
    unseen: set[int] = field(default_factory=set)
    pure_moment: bool = False
    completion: tuple[Any, ...] = ()
    composite: bool = False

    @property
    def count(self) -> int:
        """Number of joints."""
        return len(self.leg_type.model.joints)

    def name(self, stem: str) -> str:
        """The stem under the leg type's name, whatever other types there are.

        A number after an underscore is that of a joint: the joint's own name stands in its
        place where it has one.
        """
        named = _NUMBER.sub(lambda number: self.leg_type.label(int(number[0])), stem)
        return f"{self.leg_type.name}_{named}"

    def kind(self, j: int) -> JointKind:
        """Kind of joint j."""
        return self.leg_type.model.joints[j - 1].kind

    def turns(self, j: int) -> bool:
        """Whether joint j turns its link (opens a group)."""
        return self.kind(j).turns

    def slides(self, j: int) -> bool:
        """Whether joint j moves its link along the axis."""
        return self.kind(j).slides

    def turn(self, j: int) -> Any:
        """Angle of joint j per unit of its displacement."""
        return sp.sympify(self.kind(j).turn(self.pitch.get(j)))

    def advance(self, j: int) -> Any:
        """Motion along axis j per unit of its displacement."""
        return sp.sympify(self.kind(j).advance(self.pitch.get(j)))

    def spin(self, j: int) -> Vector:
        """Angular velocity of link j against the link before it, per unit rate."""
        return scale(self.turn(j), self.e[j])

    def slide(self, j: int) -> Vector:
        """Velocity of link j along its axis, per unit rate."""
        return scale(self.advance(j), self.e[j])

    def is_unseen(self, j: int) -> bool:
        """Whether turning joint j leaves the connection point where it is."""
        return j in self.unseen

    def acts_as_slide(self, j: int) -> bool:
        """Whether joint j moves the connection point along its axis only.

        So does a slide, and a helical joint beyond which all offsets lie along its axis.
        """
        return self.slides(j) and j not in self.bent_helices

    def is_extra(self, j: int) -> bool:
        """Whether joint j's displacement is a coordinate of its own."""
        return self.leg_type.model.joints[j - 1].extra

    def frame(self, kind: str, group: int) -> str:
        """Frame name: kind is "spec", "turn" or "axes"."""
        return f"{self.leg_type.name}.{self.leg_type.part(kind, group)}"

    def parallel(self, j: int, k: int) -> int:
        """+1 or -1 when axes j and k are parallel by structure, else 0."""
        dots = np.concatenate([np.sum(a[:, j - 1] * a[:, k - 1], axis=1) for a in self.axes_at])
        if np.all(dots > 1 - TOLERANCE):
            return 1
        return -1 if np.all(dots < -1 + TOLERANCE) else 0

    def same_freedom(self, extra: int) -> tuple[int, int]:
        """The joint next to an extra one that moves all beyond both as it does, and +1 or -1.

        Two slides along one direction, or two revolute joints about one line; (0, 0) if none.
        """
        for k in (extra - 1, extra + 1):
            if not 1 <= k <= self.count or self.is_extra(k) or self.pitch.keys() & {k, extra}:
                continue
            sign = self.parallel(extra, k)
            on_line = not self.turns(k) or self.offset[max(k, extra)] == ZeroVector
            if sign and on_line and self.turns(k) == self.turns(extra):
                return k, sign
        return 0, 0

    def same_axes(self) -> Iterator[tuple[str, str]]:
        """Names of the axes of joints that point the same way by structure, in pairs."""
        for j, k in itertools.combinations(self.e, 2):
            between = (i for i in range(j + 1, k) if self.turns(i))
            if self.parallel(j, k) == 1 and all(self.parallel(j, i) for i in between):
                yield self.e[j].name, self.e[k].name

    def axis_pattern(self, group: int, j: int) -> tuple[Any, ...]:
        """Axis j in the canonical axes of a group: 0, 1, -1 by structure, else None."""
        values = np.einsum("lji,lj->li", self.canonical[group], self.axes_at[0][:, j - 1])
        return _pattern(values)

    def offset_is_zero(self, group: int, j: int) -> tuple[bool, bool, bool]:
        """Which canonical components of offset j vanish by structure."""
        if group not in self.exact_frames:
            return (False, False, False)
        leg = self.leg_type.model
        value = (*(x.offset for x in leg.joints), leg.platform_joint.offset)[j - 1]
        local = self.canonical[group][0].T @ np.array(value)
        return tuple(bool(v == 0.0) for v in local)  # type: ignore[return-value]

    def perpendicular(self, j: int, k: int) -> bool:
        """Whether axes j and k are perpendicular by structure."""
        dots = [np.sum(a[:, j - 1] * a[:, k - 1], axis=1) for a in self.axes_at]
        return bool(np.max(np.abs(dots)) < TOLERANCE)


def build_geometry(book: Book, leg_type: LegType, planar: bool) -> LegGeometry:
    """Introduce the geometric parameters, constant vectors and frames of a leg type."""
    geometry = LegGeometry(leg_type)
    builder = _Builder(book, geometry, planar)
    builder.points()
    builder.axes()
    builder.offsets()
    builder.frames()
    builder.platform_joint()
    return replace(
        geometry,
        base_point=builder.base_point,
        platform_point=builder.platform_point,
        end_pattern=builder.end_pattern,
    )


class _Builder:
    def __init__(self, book: Book, geometry: LegGeometry, planar: bool) -> None:
        self.book = book
        self.g = geometry
        self.planar = planar
        self.type = geometry.leg_type
        self.spec: dict[int, Any] = {}  # axis components in spec axes, by joint
        self.choice: dict[int, Any] = {}  # spec components of the direction behind x, by group
        self.c = geometry.canonical
        self.base_point: Any = None
        self.platform_point: Any = None
        self.end_pattern: tuple[Any, ...] = ()
        self.eq = Writer(book, geometry, _TERMS)

    def field(self, stem: str, *numbers: Any, **facts: Any) -> tuple[sp.Expr, ...]:
        """A live parameter over the legs of the type; facts: its zeros and its rule."""
        path, shape, unit, meaning = _FIELDS[stem]
        path, meaning = (filled(text, numbers) for text in (path, meaning))
        name = filled(self._labelled(stem, numbers), numbers)
        own, paths = self.type.name, tuple(f"legs[{i}].{path}" for i in self.type.indices)
        values = self.type.over_legs(lambda leg: value_at(leg, path))
        return self.book.parameters.add(
            ParameterField(f"{own}_{name}", own, shape, unit, meaning, paths, values, **facts)
        )

    def _labelled(self, stem: str, numbers: tuple[Any, ...]) -> str:
        """A stem with the label of its joint."""
        if "joint#" not in stem:
            return stem
        return stem.replace("joint#", self.type.part("joint", numbers[0]))

    def _turned(self) -> Rule:
        """What a frame must be."""
        return Rule.PLANAR_ROTATION if self.planar else Rule.ROTATION

    def points(self) -> None:
        flat = (2,) if self.planar else ()
        b = self.field("base_point", zeros=flat)
        frame = self.field("base_frame", rule=self._turned())
        p = self.field("platform_point", zeros=flat)
        if self.planar:  # legs of the plane keep z along the plane's normal
            frame = (*frame[:2], 0, *frame[3:5], 0, 0, 0, 1)
        self.base_point = self.eq.give("b", "base", b)
        self.platform_point = self.eq.give("q", "platform", p)
        self.book.frames.append(Frame(self.g.frame("spec", 0), "base", frame))

    def axes(self) -> None:
        g, group = self.g, 0
        g.group[0] = 0
        for j, joint in enumerate(self.type.model.joints, 1):
            if is_coordinate(joint.axis):
                self.spec[j] = _unit(joint.axis)
            else:
                zeros = (2,) if self.planar else ()
                rule = Rule.UNIT
                self.spec[j] = self.field("joint#_axis", j, j - 1, zeros=zeros, rule=rule)
            if joint.kind.pitched:
                (pitch,) = self.field("joint#_pitch", j, j - 1)
                what = f"pitch of joint {j}: advance per angle"
                latex = rf"\kappa_{{{j}}}"
                self.book.note_quantity(Quantity(pitch.name, latex, what, "m/rad", parameter=True))
                g.pitch[j] = pitch
            group = j if g.turns(j) else group
            g.group[j] = group
        g.axes_at.extend(self._axes_with(extra) for extra in self._extra_draws())
        self.book.parameters.relations.extend(axis_relations(self.type))

    def _extra_draws(self) -> list[dict[int, float]]:
        extras = [j for j in range(1, self.g.count + 1) if self.g.is_extra(j) and self.g.turns(j)]
        if not extras:
            return [{}]
        return [{j: 0.7 + 0.9 * k + 0.3 * j for j in extras} for k in range(3)]

    def _axes_with(self, turned: dict[int, float]) -> Array:
        """Axis directions (legs, joints, 3) with the extra joints turned, all else at zero."""
        result = np.zeros((self.type.count, self.g.count, 3))
        for row, leg in enumerate(self.type.legs):
            rotation = _E
            for j, joint in enumerate(leg.joints, 1):
                axis = np.array(joint.axis)
                result[row, j - 1] = rotation @ axis
                if j in turned:
                    rotation = rotation @ rotation_about(axis, joint.turn * turned[j])
        return result

    def offsets(self) -> None:
        for j in range(1, self.g.count + 2):
            zeros = tuple(i for i, v in enumerate(self._offset(j)) if v == 0.0)
            if len(zeros) == 3:
                self.g.offset[j] = ZeroVector
                continue
            last = j == self.g.count + 1
            stem = "platform_joint_offset" if last else "joint#_offset"
            components = self.field(stem, j, j - 1, zeros=zeros)
            frame, what = self.g.frame("spec", self.g.group[j - 1]), f"joint {j}"
            what = "platform joint" if last else what
            self.g.offset[j] = self.eq.give("d_#", frame, components, j, j - 1, what)

    def _offset(self, j: int) -> Vector3:
        """Of joint j; beyond the last one, of the platform joint."""
        model = self.type.model
        return (*(joint.offset for joint in model.joints), model.platform_joint.offset)[j - 1]

    def _axes_of(self, j: int) -> Array:
        """Axis of joint j in numbers (legs, 3)."""
        return self.type.over_legs(lambda leg: leg.joints[j - 1].axis)

    def frames(self) -> None:
        turning = [j for j in range(1, self.g.count + 1) if self.g.turns(j)]
        first = turning[0] if turning else None
        self._base_group(first)
        for j in turning:
            previous = self.g.group[j - 1]
            self._turn_frame(j, previous)
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
            along = [i for i, v in enumerate(self._offset(j)) if v != 0.0]
            axes += [_E[along[0]]] if len(along) == 1 else []
        tiles = self.type.count, 1
        return found + [(_unit(axis), np.tile(axis, tiles)) for axis in (*axes, *_E)]

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
        return _unit(both), np.tile(both, tiles)

    def _canonical(self, group: int, z: Any, z_values: Array) -> tuple[Any, Array, bool]:
        """Canonical x axis: (spec components or None, numeric per leg, is exact)."""
        for components, values in self._candidates(group, z):
            along = np.sum(values * z_values, axis=1)
            if np.any(np.abs(np.abs(along) - 1) < 1e-6):
                continue
            x = values - along[:, None] * z_values
            x /= np.linalg.norm(x, axis=1)[:, None]
            exact = all(c.is_Integer for c in components) and all(c.is_Integer for c in z)
            if exact and np.all(along == 0):
                return components, x, True
            return components, x, False
        raise AssertionError("no direction is free of the joint's axis")

    def _base_group(self, first: int | None) -> None:
        if first is None:
            spec = self.g.frame("spec", 0)
            self.book.frames.append(Frame(self.g.frame("axes", 0), spec, _unit(_E.ravel())))
            self.c[0] = np.tile(_E, (self.type.count, 1, 1))
            return
        z = self.spec[first]
        z_values = self._axes_of(first)
        matrix, vectors = self._frame_of(0, z, z_values)
        self.c[0] = matrix
        pattern = _pattern(matrix)
        self.book.frames.append(
            Frame(self.g.frame("axes", 0), self.g.frame("spec", 0), pattern, axes=vectors)
        )

    def _frame_of(self, group: int, z: Any, z_values: Array) -> tuple[Array, Any]:
        """Canonical axes as columns in spec axes, and as vectors where not exact."""
        components, x_values, exact = self._canonical(group, z, z_values)
        self.choice[group] = components
        y_values = np.cross(z_values, x_values)
        matrix = np.stack([x_values, y_values, z_values], axis=2)
        if exact:
            self.g.exact_frames.add(group)
            return matrix, None
        frame = self.g.frame("spec", group)
        z_vector = self.eq.give("z_#", frame, z, group)
        direction = self.eq.give("l_#", frame, components, group)
        x_vector = self._perpendicular_unit(group, direction, z_vector)
        self.g.x_axis[group] = x_vector
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
        z, z_values = self.spec[j], self._axes_of(j)
        c_previous = self.c[previous]
        matrix, vectors = self._frame_of(j, z, z_values)
        self.c[j] = matrix
        local = np.einsum("lji,lj->li", c_previous, z_values)  # axis j in the previous frame
        reference, tilt = _reference(local)
        zero = np.einsum("lji,lj->li", c_previous, matrix[:, :, 0])
        if vectors is None and _is_exact(zero) and _is_exact(local):
            reference = zero  # so that the angle is the joint's own
        turn = np.stack([reference, np.cross(local, reference), local], axis=2)
        spec_reference = np.einsum("lij,lj->li", c_previous, reference)
        cosine = np.sum(spec_reference * matrix[:, :, 0], axis=1)
        sine = np.sum(z_values * np.cross(spec_reference, matrix[:, :, 0]), axis=1)
        self.g.zero_angle[j] = np.stack([cosine, sine], axis=1)
        exact = vectors is None and _is_exact(turn) and _is_exact(np.stack([cosine, sine]))
        frames = self.book.frames
        turn_name, axes_name = self.g.frame("turn", j), self.g.frame("axes", j)
        parent = self.g.frame("axes", previous)
        if exact:
            self.g.turn_axes[j] = _pattern(turn)
            frames.append(Frame(turn_name, parent, self.g.turn_axes[j]))
            self.g.zero_turn[j] = (sp.Integer(round(cosine[0])), sp.Integer(round(sine[0])))
        else:
            self._general_turn(j, previous, turn, tilt)
        angle = (
            sp.Symbol(self.g.name(f"c_{j}"), real=True),
            sp.Symbol(self.g.name(f"s_{j}"), real=True),
        )
        frames.append(Frame(axes_name, turn_name, angle=angle))
        frames.append(
            Frame(
                self.g.frame("spec", j),
                axes_name,
                _pattern(np.transpose(matrix, (0, 2, 1))),
                rows=vectors,
            )
        )

    def _general_turn(self, j: int, previous: int, turn: Array, tilt: int) -> None:
        """Turn frame and zero angle from live axes."""
        g, frame = self.g, self.g.frame("spec", previous)
        axis = self.eq.give("z0_#", frame, self.spec[j], j, j - 1)
        before = g.frame("axes", previous)
        k = self.eq.give("k%_#", before, _unit(_E[tilt]), j, tilt, previous)
        across = self.eq("aside_#", Cross(k, axis), j, body=before)
        reference = self.eq("reference_#", across / norm(across), j, body=before)
        axes = reference, Cross(axis, reference), axis
        self.book.frames.append(Frame(g.frame("turn", j), before, _pattern(turn), axes=axes))
        direction = self.eq.give("l0_#", frame, self.choice[j], j)
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
        pattern = _pattern(np.einsum("lji,lj->li", self.c[group], self._axes_of(j)))
        if None in pattern:
            frame, components = self.g.frame("spec", group), self.spec[j]
        else:
            frame, components = self.g.frame("axes", group), pattern
        self.g.e[j] = self.eq.give("e_#", frame, components, j)

    def platform_joint(self) -> None:
        """Pairs of directions that the platform joint keeps perpendicular (7.4)."""
        end = self.type.model.platform_joint
        if self.planar or not end.right_angles:
            return
        stated = {name: self._stated(name) for name in end.kind.fields}
        live_axis = end.axis_link is not None and not is_coordinate(end.axis_link)
        if live_axis and any(link.across for link, _ in end.right_angles):
            self._two_across(stated["axis_link"], stated["axis_platform"])
            return
        for k, (link, platform) in enumerate(end.right_angles):
            self._pair(k, _components(link, stated), _components(platform, stated))

    def _two_across(self, axis: Any, platform: Any) -> None:
        """Two orthogonal directions across an axis that is not along a coordinate direction."""
        last = self.g.frame("spec", self.g.group[self.g.count])
        a = self.eq.give("end_axis", last, axis)
        k = across(self.type)
        d = self.eq.give("end_across", last, _unit(_E[k]), "xyz"[k])
        w = self._platform_direction(0, platform)
        side = Cross(a, d)
        first = self.eq("end_l#:across", side / norm(side), 1, body=last)
        self.g.pairs.append((first, w))
        self.g.pairs.append((self.eq("end_l#:across", Cross(a, first), 2, body=last), w))

    def _stated(self, name: str) -> Any:
        """Components of what the specification states of the platform joint: live or fixed."""
        value = getattr(self.type.model.platform_joint, name)
        if name == "rotation":
            return self.field("platform_joint_rotation", rule=Rule.ROTATION)
        if is_coordinate(value):
            return _unit(value)
        return self.field("platform_joint_#", name, rule=Rule.UNIT)

    def _pair(self, k: int, link: Any, platform: Any) -> None:
        last = self.g.frame("spec", self.g.group[self.g.count])
        u = self.eq.give("end_l#", last, link, k + 1)
        self.g.pairs.append((u, self._platform_direction(k, platform)))
        values = self.type.over_legs(lambda leg: leg.platform_joint.axis_link or _E[k])
        self.end_pattern = _pattern(
            np.einsum("lji,lj->li", self.c[self.g.group[self.g.count]], values)
        )

    def _platform_direction(self, k: int, components: Any) -> Any:
        return self.eq.give("end_p#", "platform", components, k + 1)


def value_at(leg: Leg, path: str) -> Any:
    """A value of a leg by its path, such as `joints[2].axis`."""
    value: Any = leg
    for part in path.split("."):
        name, _, index = part.partition("[")
        value = getattr(value, name)
        value = value[int(index[:-1])] if index else value
    return value


def _unit(values: Iterable[float]) -> tuple[sp.Integer, ...]:
    """Components of a coordinate direction."""
    return tuple(sp.Integer(int(v)) for v in values)


def _components(direction: Direction, stated: dict[str, Any]) -> tuple[Any, ...]:
    """Components of a direction of the platform joint in the frame of its body."""
    if not direction.field:
        return _unit(_E[direction.row])
    values = stated[direction.field]
    if direction.row is not None:
        return tuple(values[3 * direction.row : 3 * direction.row + 3])
    if direction.across:
        main = next(i for i, v in enumerate(values) if v != 0)
        return _unit(_E[(main + direction.across) % 3])
    return tuple(values)


def across(leg_type: LegType) -> int:
    """The coordinate direction of the last link that is most across the platform joint's axis."""
    axes = leg_type.over_legs(lambda leg: leg.platform_joint.axis_link)
    return int(np.argmin(np.abs(axes).max(axis=0)))


def _pattern(values: Array) -> tuple[Any, ...]:
    """0, 1, -1 where every leg has it to the structural tolerance, else None."""
    flat = values.reshape(len(values), -1)
    pattern: list[Any] = []
    for column in flat.T:
        rounded = round(float(column[0]))
        same = np.all(np.abs(column - rounded) < TOLERANCE) and abs(rounded) <= 1
        pattern.append(sp.Integer(rounded) if same else None)
    return tuple(pattern)


def _is_exact(values: Array) -> bool:
    return bool(np.all(np.abs(values - np.rint(values)) < TOLERANCE))


def _reference(local: Array) -> tuple[Array, int]:
    """Reference direction across axis j in the previous canonical frame.

    Along a coordinate axis: the next coordinate direction.  Otherwise y x axis,
    a pure tilt about y where the axis lies in the xz plane.  Also returns the
    number of the coordinate direction that was crossed with the axis.
    """
    if _is_exact(local) and np.all(np.abs(local - local[0]) < TOLERANCE):
        other = (int(np.argmax(np.abs(local[0]))) + 2) % 3
        return np.cross(_E[other], np.rint(local)), other
    tilt = 1 if np.max(np.abs(local[:, 1])) < 0.9 else 0
    reference = np.cross(_E[tilt], local)
    reference /= np.linalg.norm(reference, axis=1)[:, None]
    return reference, tilt
