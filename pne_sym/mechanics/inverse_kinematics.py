"""Inverse kinematics of a leg, joint by joint, from invariants of the distal sub-chain.

Joint j is found from an equation that the joints beyond it cannot change (`invariants`), or, where
nothing follows, directly.

Nothing here knows leg architectures; a joint without such an equation has no
closed form by this route, and the reason is told.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from pne_sym.derivation import Book, Condition, FailureStatus, Law
from pne_sym.mechanics.directions import AXES, unit
from pne_sym.mechanics.invariants import Invariants
from pne_sym.mechanics.leg_displacements import Branch, InverseKinematics, Resolved
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.vector import Cross, Dot, Vector, ZeroVector, norm


def invert(
    book: Book,
    g: LegGeometry,
    x: Vector,
    normal: Vector | None = None,
    *,
    constrained: bool = False,
) -> InverseKinematics:
    """Write the inverse kinematics of a leg.

    Args:
        book: the derivation being written; a chapter is open.
        g: geometry of the leg type.
        x: vector from the first joint's origin to the connection point.
        normal: axis along which the leg's degrees of freedom cannot move the connection point.
        constrained: the leg has fewer degrees of freedom than the connection point: off the
            manifold the nearest closure is taken.
    """
    solver = _Solver(book, g, normal, constrained=constrained)
    for j in range(1, g.count + 1):
        if g.is_extra(j):  # known before all others, which may lie before it in the chain
            solver._given(j)
    for j in range(1, g.count + 1):
        x = solver.joint(j, x)
    return InverseKinematics(
        solver.q,
        solver.methods,
        solver.reasons,
        solver.branches,
        solver.x,
        swings=bool(solver.swings) and all(solver.swings),
    )


def given_displacements(book: Book, g: LegGeometry, reasons: dict[int, str]) -> InverseKinematics:
    """Displacements that the generated code finds by iteration on the loop closure.

    Used for legs with a joint that has no closed form; `reasons` say why.
    """
    solver = _Solver(book, g, None, constrained=False)
    for j in range(1, g.count + 1):
        if g.is_extra(j):
            solver._given(j)
        else:
            solver._iterated(j)
            solver._angle_of_displacement(j)
    return InverseKinematics(solver.q, solver.methods, reasons, [], {})


_TURN_AXES, _LINK_AXES = ("ref_#", "across_#"), ("link_x_#", "link_y_#")
"""Axes x and y before a joint's turn, fixed in the link before it; those that its link carries."""
_TERMS = glossary(r"""
x_#              | \mathbf S_{#}         | GEOMETRY @before
    from the origin of joint # to the connection point
y_#_extra        | y_{#}                 | given DISPLACEMENT | U
    extra coordinate: displacement of joint #
q_#:iterated     | q_{#}                 | given DISPLACEMENT | U
    displacement of joint #, by iteration on the loop closure
q_#              | q_{#}                 | LOOP_CLOSURE DISPLACEMENT
    displacement of joint #
c_#              | \cos\xi_{#}     | LOOP_CLOSURE
    cosine of the angle of joint # from its reference direction
s_#              | \sin\xi_{#}     | LOOP_CLOSURE
    sine of the angle of joint # from its reference direction
branch_#         | \sigma_{#}            | given constant
    assembly branch of joint #: +1 or -1, as at home
ref_#            | \hat{\mathbf x}^0_{#} | given @turn
    reference direction of the angle of joint #, fixed in link %
across_#         | \hat{\mathbf y}^0_{#} | given @turn
    across the reference direction of joint #, fixed in link %
link_x_#         | \hat{\mathbf x}_{#}   | given @link
    direction across axis #, fixed in link #
link_y_#         | \hat{\mathbf y}_{#}   | given @link
    direction across axis #, fixed in link #
un_#             | l^x_{#}               | LUMPING
    component along the x axis of link # of the direction fixed in it
um_#             | l^y_{#}               | LUMPING
    component along the y axis of link # of the direction fixed in it
uu_#             | l_{#}^2               | LUMPING
    squared length, across the axis, of the direction fixed in link #
px_#             | S^x_{#}               | LOOP_CLOSURE
    component along the reference direction
py_#             | S^y_{#}               | LOOP_CLOSURE
    component across the reference direction
Kd_#             | K^d_{#}               | LOOP_CLOSURE
    projection on the centre's direction, from the distance fixed by the joints beyond joint #
Kc_#             | K^c_{#}               | LOOP_CLOSURE
    factor of the cosine in the equation of joint #
Ks_#             | K^s_{#}               | LOOP_CLOSURE
    factor of the sine in the equation of joint #
Kr_#             | K^r_{#}               | LOOP_CLOSURE
    right-hand side of the equation of joint #
rho2_#           | K_{#}^2               | LOOP_CLOSURE
    squared amplitude
disc_#           | \Delta_{#}            | LOOP_CLOSURE
    discriminant
root_#           | \delta_{#}            | LOOP_CLOSURE
    root, with the sign of the branch
root_#:amplitude | K_{#}                 | LOOP_CLOSURE
    amplitude, the length across axis #, with the sign of the branch
root_#:nearest   | K_{#}                 | LOOP_CLOSURE
    amplitude: off the manifold the nearest angle is taken
xi_#             | \mathbf S^r_{#}       | LOOP_CLOSURE RESOLVED @link
    the vector from joint # to the connection point, resolved along link #
from_centre_#    | \mathbf S'_{#}        | GEOMETRY
    from the centre at zero displacement to the connection point
px_#:slide       | S^e_{#}               | LOOP_CLOSURE
    component along axis #
disc_#:slide     | \Delta_{#}            | LOOP_CLOSURE
    discriminant of the distance equation
""")
_NOTHING_LEFT = "no direction or distance is left unchanged by the joints beyond it"


class _Solver:
    def __init__(
        self, book: Book, g: LegGeometry, normal: Vector | None, *, constrained: bool
    ) -> None:
        self.g = g
        self.normal = normal
        self.constrained = constrained
        self.eq = Writer(book, g, _TERMS)
        extras = (j for j in range(1, g.count + 1) if g.is_extra(j))
        self.q: dict[int, Any] = {j: sp.Symbol(g.name(f"y_{j}_extra"), real=True) for j in extras}
        self.invariants = Invariants(g, self.q)
        self.methods: dict[int, str] = {}
        self.reasons: dict[int, str] = {}
        self.branches: list[Branch] = []
        self.x: dict[int, Vector] = {}
        self.resolved: Resolved | None = None
        self.swings: list[bool] = []
        self.axes: dict[tuple[str, int], tuple[Vector, Vector]] = {}

    def joint(self, j: int, x: Vector) -> Vector:
        """Find joint j; returns the vector from joint j+1's origin to the connection point."""
        g = self.g
        self.x[j] = x
        if g.is_extra(j) or j in self.q:
            pass
        elif g.is_unseen(j):
            self._orient(j)
        elif g.acts_as_slide(j) or (g.slides(j) and not self.invariants.later(j)):
            self._slide(j, x)
            self._angle_of_displacement(j)
        else:
            x = self._turn(j, x)
        before, x = x, x - self.q[j] * g.slide(j) - g.offset[j + 1]
        if x != before or g.is_extra(j) or g.is_unseen(j):
            self.resolved = None
        if j < g.count:
            x = self.eq.named("x_#", x, j + 1)
        return x

    def _turn(self, j: int, x: Vector) -> Vector:
        later = self.invariants.later(j)
        found = self.invariants.of_joint(j)
        if found is None and not later and not self.g.slides(j):
            return self._direct(j, x)
        if found is None or self.g.slides(j) or (found[0] == "sphere" and found[1] == ZeroVector):
            self._numeric(j)
            return x
        method, u, value = found
        self.methods[j] = method
        if method == "sphere":
            squared = (Dot(x, x) + Dot(u, u) - Dot(value, value)) / 2
            value = self.eq.named("Kd_#", squared, j)
        return self._projection(j, x, u, value, method)

    def _axes(self, stems: tuple[str, str], j: int) -> tuple[Vector, Vector]:
        """Axes x and y at joint j, by their names in the table."""
        if (stems[0], j) not in self.axes:
            x, y = map(unit, AXES[:2])
            given = self.eq.give(stems[0], x, j, j - 1), self.eq.give(stems[1], y, j, j - 1)
            self.axes[stems[0], j] = given
        return self.axes[stems[0], j]

    def _projection(self, j: int, x: Vector, u: Vector, value: Any, method: str) -> Vector:
        """Solve u . x = value for the angle of joint j, u turning with link j."""
        e = self.g.e[j]
        u_n, u_m, along_axis = self.invariants.pattern(j, method, u)
        fixed = value == 0 and along_axis == 0 and {abs(u_n or 0), abs(u_m or 0)} == {0, 1}
        self.swings.append(fixed and method == "linear")
        A, B, axial = self._in_turning_plane(j, x, named=not fixed)
        if u_n is None:
            u_n = self._constant_of_link("un_#", j, Dot(u, self._axes(_LINK_AXES, j)[0]))
        if u_m is None:
            u_m = self._constant_of_link("um_#", j, Dot(u, self._axes(_LINK_AXES, j)[1]))
        K, N = u_n * A + u_m * B, u_n * B - u_m * A
        if not fixed:
            K, N = self.eq.named("Kc_#", K, j), self.eq.named("Ks_#", N, j)
        along = sp.S.Zero if along_axis == 0 else Dot(u, e) * axial
        C = self.eq.named("Kr_#", value - along, j)
        # The axis across x is one of the links beyond, unless extra coordinates turn these.
        across = fixed and Dot(e, x) == axial and not self._extras_from(j)
        lengths = (norm(Cross(e, x)),) if across else ()
        reaches = fixed and u_m == 1 and self.invariants.reaches(j)
        root = self._turned(j, K, N, C, method, reaches=reaches, lengths=lengths)
        x_n, x_m = u_n * C + u_m * root, u_m * C - u_n * root
        length2 = self._constant_of_link("uu_#", j, u_n**2 + u_m**2)
        parts = x_n / length2, x_m / length2, axial
        self.resolved = Resolved(j, parts)
        if self.invariants.goes_on(j):
            return x
        n, m = self._axes(_LINK_AXES, j)
        resolved: Vector = self.eq("xi_#", parts[0] * n + parts[1] * m + axial * e, j)
        return resolved

    def _in_turning_plane(self, j: int, x: Vector, *, named: bool) -> tuple[Any, Any, Any]:
        """Components of x along and across the direction from which joint j's angle counts.

        And along the joint's axis.
        """
        g, known = self.g, self.resolved
        if known is not None and known.group == g.group[j - 1] and j in g.turn_axes:
            A, B, axial = (known.along(g.turn_axes[j][k::3]) for k in range(3))
        else:
            reference, across = self._axes(_TURN_AXES, j)
            A, B, axial = Dot(reference, x), Dot(across, x), Dot(g.e[j], x)
        if named:
            A, B = self.eq.named("px_#", A, j), self.eq.named("py_#", B, j)
        return A, B, axial

    def _turned(
        self,
        j: int,
        K: Any,
        N: Any,
        C: Any,
        method: str,
        *,
        reaches: bool,
        lengths: tuple[Any, ...],
    ) -> Any:
        """Angle of joint j from K cos + N sin = C; returns the root, signed by the branch.

        Where the right-hand side is zero that is the length across the axis; if the leg
        `reaches` its end along it, the displacement of the next joint.
        """
        g = self.g
        power = {"linear": 1, "sphere": 2, "orientation": 0}[method]
        regular = Condition(FailureStatus.SINGULAR, K * K + N * N, g.size ** (2 * power), 2)
        sigma = self.eq.note("branch_#", j)
        c, s = sp.Symbol(g.name(f"c_{j}"), real=True), sp.Symbol(g.name(f"s_{j}"), real=True)
        self.branches.append(Branch(sigma, j, K * s - N * c, power))
        if C == 0:
            value, facts = sigma * sp.sqrt(K * K + N * N), {"conditions": (regular,)}
            if reaches:
                self.methods[j + 1] = "direct"
                root = self.q[j + 1] = self.eq("q_#", value, j + 1, **facts)
            else:
                forms = tuple(sigma * length for length in lengths)
                root = self.eq.named("root_#:amplitude", value, j, forms=forms, **facts)
            self._cosine_sine(j, -N / root, K / root)
            return root
        rho2 = self.eq.named("rho2_#", K * K + N * N, j, conditions=(regular,))
        real = Condition(FailureStatus.UNREACHABLE, rho2 - C**2)
        discriminant = self.eq.named("disc_#", rho2 - C**2, j, conditions=(real,))
        root = self.eq.named("root_#", sigma * sp.sqrt(discriminant), j)
        self._cosine_sine(j, (C * K - root * N) / rho2, (C * N + root * K) / rho2)
        return root

    def _constant_of_link(self, stem: str, j: int, rhs: Any) -> Any:
        """A scalar made of parameters, and of extra coordinates where joints beyond have them."""
        if rhs.is_number:
            return rhs
        return self.eq.named(stem, rhs, j, parameter=not self._extras_from(j + 1))

    def _extras_from(self, j: int) -> bool:
        """Whether joint j or one beyond it is extra."""
        return any(map(self.g.is_extra, range(j, self.g.count + 1)))

    def _cosine_sine(self, j: int, cosine: Any, sine: Any) -> None:
        c, s = self.eq("c_#", cosine, j), self.eq("s_#", sine, j)
        c0, s0 = self.g.zero_turn[j]
        self.q[j] = self.eq("q_#", sp.atan2(s * c0 - c * s0, c * c0 + s * s0), j)

    def _direct(self, j: int, x: Vector) -> Vector:
        """Nothing follows: the tip's offset must turn into x."""
        g = self.g
        reference, across = self._axes(_TURN_AXES, j)
        n, m = self._axes(_LINK_AXES, j)
        tip = self.invariants.beyond(j)
        if tip == ZeroVector:
            self._numeric(j, "the connection point lies on the joint's axis")
            return x
        A, B = Dot(reference, x), Dot(across, x)
        along, aside = Dot(tip, n), Dot(tip, m)
        length2 = self._constant_of_link("uu_#", j, along**2 + aside**2)
        self.methods[j] = "direct"
        self.swings.append(False)
        amplitude = length2
        if self.constrained:
            squared = self.eq.named("rho2_#", (A**2 + B**2) * length2, j)
            regular = Condition(FailureStatus.SINGULAR, squared, g.size**4, 2)
            amplitude = self.eq.named("root_#:nearest", sp.sqrt(squared), j, conditions=(regular,))
        cosine, sine = along * A + aside * B, along * B - aside * A
        self._cosine_sine(j, cosine / amplitude, sine / amplitude)
        return tip

    def _orient(self, j: int) -> None:
        """A joint that only the platform's orientation shows: from the right angle it must keep."""
        g = self.g
        later = [k for k in range(j + 1, g.count + 1) if g.turns(k)]
        if len(g.pairs) != 1 or later:
            self._numeric(j, "its turning does not move the connection point")
            return
        link, platform = g.pairs[0]
        self.methods[j] = "orientation"
        self.resolved = None
        self._projection(j, platform, link, sp.S.Zero, "orientation")

    def _given(self, j: int) -> None:
        """The displacement is a coordinate of its own."""
        self.methods[j] = "given"
        self.eq.note("y_#_extra", j)
        self._angle_of_displacement(j)

    def _angle_of_displacement(self, j: int) -> None:
        """Cosine and sine of a joint whose displacement is known, if it turns."""
        if not self.g.turns(j):
            return
        q, (c0, s0) = self.g.turn(j) * self.q[j], self.g.zero_turn[j]
        self.eq("c_#", sp.cos(q) * c0 - sp.sin(q) * s0, j, law=Law.GEOMETRY)
        self.eq("s_#", sp.sin(q) * c0 + sp.cos(q) * s0, j, law=Law.GEOMETRY)

    def _slide(self, j: int, x: Vector) -> None:
        g, e = self.g, self.g.e[j]
        found = self.invariants.of_slide(j)
        if found is None:
            self._numeric(j)
            return
        method, u, value = found
        self.methods[j] = method
        advance = g.advance(j)
        if method != "sphere":
            across = Dot(u, e) if u != e else sp.S.One
            self.q[j] = self.eq("q_#", (Dot(u, x) - value) / (across * advance), j)
            return
        centre, tip = u, value
        y = self.eq.named("from_centre_#", x - centre, j)
        along = self.eq.named("px_#:slide", Dot(e, y), j)
        squared = along**2 - Dot(y, y) + Dot(tip, tip)
        if self.normal is not None:  # only what lies across the constraint force can close
            squared = squared + Dot(self.normal, y) ** 2 - Dot(self.normal, tip) ** 2
        real = Condition(FailureStatus.UNREACHABLE, squared)
        discriminant = self.eq.named("disc_#:slide", squared, j, conditions=(real,))
        sigma = self.eq.note("branch_#", j)
        q = sp.Symbol(g.name(f"q_{j}"), real=True)
        self.branches.append(Branch(sigma, j, q * advance - along, 1))
        self.q[j] = self.eq("q_#", (along + sigma * sp.sqrt(discriminant)) / advance, j)

    def _numeric(self, j: int, reason: str = _NOTHING_LEFT) -> None:
        self._iterated(j)
        self.reasons[j] = reason

    def _iterated(self, j: int) -> None:
        """The displacement is found by iteration on the loop closure."""
        self.methods[j] = "numeric"
        self.q[j] = self.eq.note("q_#:iterated", j)
