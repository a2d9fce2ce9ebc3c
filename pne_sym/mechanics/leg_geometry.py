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
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from pne_sym.derivation import Book, Frame, Law, ParameterField, Quantity, Rule
from pne_sym.mechanics.axis_relations import axis_relations
from pne_sym.mechanics.structure import TOLERANCE, LegType, is_coordinate
from pne_sym.model.joint_kinds import JointKind
from pne_sym.model.kinematics import rotation_about
from pne_sym.model.platform_kinds.interface import Direction
from pne_sym.vector import Cross, Dot, Vector, VectorSymbol, ZeroVector, norm
from pne_sym.vector.nodes import scale

Array = NDArray[np.float64]
_E = np.eye(3)


@dataclass
class LegGeometry:
    """Symbols and frames of a leg type.

    Attributes:
        leg_type: the leg type.
        suffix: appended to names where several leg types need telling apart.
        e: axis vectors by joint number 1..m.
        offset: offset vectors a_1..a_{m+1} by joint number (m+1: the tip).
        group: group of link j by joint number (link 0: the base).
        x_axis: canonical x axis by group.
        zero_turn: (cos, sin) of the angle from turn frame to canonical frame at
            zero displacement, by joint number.
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
        completion: directions that complete the freedoms of a leg that lacks some, in space.
        composite: the leg's inertia is written in the accelerations of its joints.
        exact_frames: groups whose canonical axes are coordinate directions.
    """

    leg_type: LegType
    suffix: str
    e: dict[int, VectorSymbol] = field(default_factory=dict)
    offset: dict[int, Vector] = field(default_factory=dict)
    group: dict[int, int] = field(default_factory=dict)
    x_axis: dict[int, VectorSymbol] = field(default_factory=dict)
    zero_turn: dict[int, tuple[Any, Any]] = field(default_factory=dict)
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
        """The stem, told apart from the same stem of other leg types."""
        return stem + self.suffix

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
        return f"{self.leg_type.name}.{kind}{group}"

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


def build_geometry(book: Book, leg_type: LegType, suffix: str, planar: bool) -> LegGeometry:
    """Introduce the geometric parameters, constant vectors and frames of a leg type."""
    geometry = LegGeometry(leg_type, suffix)
    builder = _Builder(book, geometry, planar)
    builder.points()
    builder.axes()
    builder.offsets()
    builder.frames()
    builder.platform_joint()
    return geometry


class _Builder:
    def __init__(self, book: Book, geometry: LegGeometry, planar: bool) -> None:
        self.book = book
        self.g = geometry
        self.planar = planar
        self.type = geometry.leg_type
        self.spec: dict[int, Any] = {}  # axis components in spec axes, by joint
        self.choice: dict[int, Any] = {}  # spec components of the direction behind x, by group
        self.c = geometry.canonical

    def field(
        self,
        stem: str,
        shape: tuple[int, ...],
        unit: str,
        meaning: str,
        path: str,
        pick: Any,
        **facts: Any,
    ) -> tuple[sp.Expr, ...]:
        """A live parameter over the legs of the type; facts: its zeros and its rule."""
        paths = tuple(f"legs[{i}].{path}" for i in self.type.indices)
        return self.book.parameters.add(
            ParameterField(
                f"{self.type.name}_{stem}",
                self.type.name,
                shape,
                unit,
                meaning,
                paths,
                self.type.over_legs(pick),
                **facts,
            )
        )

    def give(
        self, stem: str, frame: str, components: Any, latex: str, meaning: str, unit: str = "m"
    ) -> Any:
        symbol = VectorSymbol(self.g.name(stem))
        quantity = Quantity(symbol.name, latex, meaning, unit, frame, parameter=True)
        return self.book.give(symbol, frame, components, quantity)

    def _turned(self) -> Rule:
        """What a frame must be."""
        return Rule.PLANAR_ROTATION if self.planar else Rule.ROTATION

    def points(self) -> None:
        flat = (2,) if self.planar else ()
        b = self.field(
            "base_point",
            (3,),
            "m",
            "base point, base frame",
            "base_point",
            lambda leg: leg.base_point,
            zeros=flat,
        )
        frame = self.field(
            "base_frame",
            (3, 3),
            "-",
            "rotation from leg axes to base axes",
            "base_frame",
            lambda leg: leg.base_frame,
            rule=self._turned(),
        )
        p = self.field(
            "platform_point",
            (3,),
            "m",
            "platform joint, platform frame",
            "platform_point",
            lambda leg: leg.platform_point,
            zeros=flat,
        )
        if self.planar:  # legs of the plane keep z along the plane's normal
            frame = (*frame[:2], 0, *frame[3:5], 0, 0, 0, 1)
        self.g.base_point = self.give("b", "base", b, r"\mathbf b", "base point of the leg")
        self.g.platform_point = self.give(
            "q",
            "platform",
            p,
            r"\mathbf q",
            "platform origin to connection point, fixed in the platform",
        )
        self.book.frames.append(Frame(self.g.frame("spec", 0), "base", frame))

    def axes(self) -> None:
        g, group = self.g, 0
        g.group[0] = 0
        for j, joint in enumerate(self.type.model.joints, 1):
            if is_coordinate(joint.axis):
                self.spec[j] = tuple(sp.Integer(int(a)) for a in joint.axis)
            else:
                self.spec[j] = self.field(
                    f"joint{j}_axis",
                    (3,),
                    "-",
                    f"axis of joint {j}, preceding link's frame",
                    f"joints[{j - 1}].axis",
                    lambda leg, j=j: leg.joints[j - 1].axis,
                    zeros=(2,) if self.planar else (),
                    rule=Rule.UNIT,
                )
            if joint.kind.pitched:
                (g.pitch[j],) = self.field(
                    f"joint{j}_pitch",
                    (),
                    "m/rad",
                    f"pitch of joint {j}",
                    f"joints[{j - 1}].pitch",
                    lambda leg, j=j: leg.joints[j - 1].pitch,
                )
            group = j if g.turns(j) else group
            g.group[j] = group
        g.axes_at = [self._axes_with(extra) for extra in self._extra_draws()]
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
        joints = self.type.model.joints
        for j in range(1, self.g.count + 2):
            last = j == self.g.count + 1
            value = self.type.model.platform_joint.offset if last else joints[j - 1].offset
            zeros = tuple(i for i in range(3) if value[i] == 0.0)
            if len(zeros) == 3:
                self.g.offset[j] = ZeroVector
                continue
            stem = "platform_joint_offset" if last else f"joint{j}_offset"
            path = "platform_joint.offset" if last else f"joints[{j - 1}].offset"
            what = "platform joint" if last else f"joint {j}"
            components = self.field(
                stem,
                (3,),
                "m",
                f"offset of {what}, preceding link's frame",
                path,
                lambda leg, j=j: (*(x.offset for x in leg.joints), leg.platform_joint.offset)[
                    j - 1
                ],
                zeros=zeros,
            )
            self.g.offset[j] = self.give(
                f"d_{j}",
                self.g.frame("spec", self.g.group[j - 1]),
                components,
                rf"\mathbf d_{{{j}}}",
                f"offset of {what}, fixed in link {j - 1}",
            )

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

    def _candidates(self, group: int) -> list[tuple[Any, Array]]:
        """Directions fixed in the group worth an axis: (spec components, numeric per leg)."""
        found: list[tuple[Any, Array]] = []
        members = [j for j in self.g.group if self.g.group[j] == group]
        slides = [j for j in members if j and not self.g.turns(j)]
        following = [
            j
            for j in range(1, self.g.count + 1)
            if self.g.turns(j) and self.g.group[j - 1] == group and j != group
        ]
        for j in slides + following:
            found.append(
                (self.spec[j], self.type.over_legs(lambda leg, j=j: leg.joints[j - 1].axis))
            )
        for j in [j + 1 for j in members]:
            joints = self.type.model.joints
            value = (
                joints[j - 1].offset if j <= self.g.count else self.type.model.platform_joint.offset
            )
            nonzero = [i for i in range(3) if value[i] != 0.0]
            if len(nonzero) == 1:
                axis = _E[nonzero[0]]
                found.append(
                    (tuple(sp.Integer(int(a)) for a in axis), np.tile(axis, (self.type.count, 1)))
                )
        found.extend(
            (tuple(sp.Integer(int(a)) for a in axis), np.tile(axis, (self.type.count, 1)))
            for axis in _E
        )
        return found

    def _canonical(self, group: int, z: Any, z_values: Array) -> tuple[Any, Array, bool]:
        """Canonical x axis: (spec components or None, numeric per leg, is exact)."""
        for components, values in self._candidates(group):
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
            self.book.frames.append(
                Frame(self.g.frame("axes", 0), spec, tuple(sp.Integer(int(v)) for v in _E.ravel()))
            )
            self.c[0] = np.tile(_E, (self.type.count, 1, 1))
            return
        z = self.spec[first]
        z_values = self.type.over_legs(lambda leg: leg.joints[first - 1].axis)
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
        z_vector = self.give(
            f"z_{group}", frame, z, rf"\mathbf z_{{{group}}}", f"axis of group {group}", "-"
        )
        direction = self.give(
            f"l_{group}",
            frame,
            components,
            rf"\mathbf l_{{{group}}}",
            f"direction of interest in group {group}",
            "-",
        )
        x_vector = self._perpendicular_unit(group, direction, z_vector)
        self.g.x_axis[group] = x_vector
        return matrix, (x_vector, Cross(z_vector, x_vector), z_vector)

    def _perpendicular_unit(
        self, group: int, direction: Any, z: Any, zero: str = "", frame: str = ""
    ) -> Any:
        """Equation for the unit vector along the direction's part perpendicular to z.

        `frame` is where direction and z are given, by default in the group itself.
        """
        name = self.g.name(f"n{zero}_{group}")
        part = self.book.define(
            f"{name}_part",
            direction - Dot(z, direction) * z,
            rf"\mathbf n'_{{{group}}}",
            f"part of the direction perpendicular to axis {group}",
            Law.GEOMETRY,
            parameter=True,
            body=frame or self.g.frame("spec", group),
        )
        return self.book.define(
            name,
            part / norm(part),
            rf"\mathbf n_{{{group}}}",
            f"canonical x axis of group {group}",
            Law.GEOMETRY,
            parameter=True,
        )

    def _turn_frame(self, j: int, previous: int) -> None:
        """Frames of the group that joint j opens: turn frame, canonical frame, spec frame."""
        z, z_values = self.spec[j], self.type.over_legs(lambda leg: leg.joints[j - 1].axis)
        c_previous = self.c[previous]
        matrix, vectors = self._frame_of(j, z, z_values)
        self.c[j] = matrix
        local = np.einsum("lji,lj->li", c_previous, z_values)  # axis j in the previous frame
        reference, tilt = _reference(local)
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
            frames.append(Frame(turn_name, parent, _pattern(turn)))
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
        axis = self.give(
            f"z0_{j}",
            frame,
            self.spec[j],
            rf"\mathbf e_{{{j}}}",
            f"axis of joint {j}, fixed in link {j - 1}",
            "-",
        )
        frame_axes = g.frame("axes", previous)
        directions = [
            self.give(
                f"k{i}_{j}",
                frame_axes,
                tuple(sp.Integer(int(v)) for v in _E[i]),
                rf"\mathbf k_{{{i}{j}}}",
                f"axis {i} of group {previous}",
                "-",
            )
            for i in (tilt,)
        ]
        across = self.book.define(
            g.name(f"aside_{j}"),
            Cross(directions[0], axis),
            rf"\mathbf a'_{{{j}}}",
            f"direction across axis {j}",
            Law.GEOMETRY,
            parameter=True,
            body=frame_axes,
        )
        reference = self.book.define(
            g.name(f"reference_{j}"),
            across / norm(across),
            rf"\mathbf a^0_{{{j}}}",
            f"reference direction of the angle of joint {j}",
            Law.GEOMETRY,
            parameter=True,
            body=frame_axes,
        )
        self.book.frames.append(
            Frame(
                g.frame("turn", j),
                frame_axes,
                _pattern(turn),
                axes=(reference, Cross(axis, reference), axis),
            )
        )
        components = self.choice[j]
        direction = self.give(
            f"l0_{j}",
            frame,
            components,
            rf"\mathbf l^0_{{{j}}}",
            f"direction of interest of group {j} at zero displacement",
            "-",
        )
        x_zero = self._perpendicular_unit(j, direction, axis, zero="0", frame=frame)
        g.zero_turn[j] = (
            self.book.define(
                g.name(f"c0_{j}"),
                Dot(reference, x_zero),
                f"c^0_{{{j}}}",
                f"cosine of the angle at zero displacement of joint {j}",
                Law.GEOMETRY,
                parameter=True,
            ),
            self.book.define(
                g.name(f"s0_{j}"),
                Dot(axis, Cross(reference, x_zero)),
                f"s^0_{{{j}}}",
                f"sine of the angle at zero displacement of joint {j}",
                Law.GEOMETRY,
                parameter=True,
            ),
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
        values = np.einsum(
            "lji,lj->li", self.c[group], self.type.over_legs(lambda leg: leg.joints[j - 1].axis)
        )
        pattern = _pattern(values)
        meaning = f"axis of joint {j}"
        if None in pattern:
            frame, components = self.g.frame("spec", group), self.spec[j]
        else:
            frame, components = self.g.frame("axes", group), pattern
        self.g.e[j] = self.give(f"e_{j}", frame, components, rf"\mathbf e_{{{j}}}", meaning, "-")

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
        a = self.give(
            "end_axis",
            last,
            axis,
            r"\mathbf a_l",
            "axis of the platform joint in the last link",
            "-",
        )
        k = across(self.type)
        d = self.give(
            "end_across",
            last,
            tuple(sp.Integer(int(v)) for v in _E[k]),
            rf"\mathbf i_{{{'xyz'[k]}}}",
            f"direction {'xyz'[k]} of the last link, well across that axis",
            "-",
        )
        w = self._platform_direction(0, platform)
        first = Cross(a, d)
        for i, vector in enumerate((first / norm(first), None)):
            direction = self.book.define(
                self.g.name(f"end_l{i + 1}"),
                Cross(a, self.g.pairs[0][0]) if vector is None else vector,
                rf"\mathbf a_{{l{i + 1}}}",
                f"direction {i + 1} across the platform joint's axis, fixed in the last link",
                Law.LUMPING,
                body=last,
                parameter=True,
            )
            self.g.pairs.append((direction, w))

    def _stated(self, name: str) -> Any:
        """Components of what the specification states of the platform joint: live or fixed."""
        value = getattr(self.type.model.platform_joint, name)
        is_axis = name != "rotation"
        if is_axis and is_coordinate(value):
            return tuple(sp.Integer(int(a)) for a in value)
        return self.field(
            f"platform_joint_{name}",
            (3,) if is_axis else (3, 3),
            "-",
            f"{name} of the platform joint"
            if is_axis
            else "platform axes in the last link's frame",
            f"platform_joint.{name}",
            lambda leg: getattr(leg.platform_joint, name),
            rule=Rule.UNIT if is_axis else Rule.ROTATION,
        )

    def _pair(self, k: int, link: Any, platform: Any) -> None:
        last = self.g.frame("spec", self.g.group[self.g.count])
        u = self.give(
            f"end_l{k + 1}",
            last,
            link,
            rf"\mathbf a_{{l{k + 1}}}",
            "direction of the platform joint, fixed in the last link",
            "-",
        )
        self.g.pairs.append((u, self._platform_direction(k, platform)))
        values = self.type.over_legs(lambda leg: leg.platform_joint.axis_link or _E[k])
        self.g.end_pattern = _pattern(
            np.einsum("lji,lj->li", self.c[self.g.group[self.g.count]], values)
        )

    def _platform_direction(self, k: int, components: Any) -> Any:
        return self.give(
            f"end_p{k + 1}",
            "platform",
            components,
            rf"\mathbf a_{{p{k + 1}}}",
            "direction of the platform joint, fixed in the platform",
            "-",
        )


def _components(direction: Direction, stated: dict[str, Any]) -> tuple[Any, ...]:
    """Components of a direction of the platform joint in the frame of its body."""
    if not direction.field:
        return tuple(sp.Integer(int(v)) for v in _E[direction.row])
    values = stated[direction.field]
    if direction.row is not None:
        return tuple(values[3 * direction.row : 3 * direction.row + 3])
    if direction.across:
        main = next(i for i, v in enumerate(values) if v != 0)
        return tuple(sp.Integer(int(v)) for v in _E[(main + direction.across) % 3])
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
