"""The derivation of a leg type."""

from __future__ import annotations

from dataclasses import replace

from pne_sym.derivation import Book, LegTypeInfo, Quantity
from pne_sym.derivation.frames import BodyFrame, turned_about
from pne_sym.mechanics.branches import branch_signs
from pne_sym.mechanics.completion import completion_of
from pne_sym.mechanics.constraints import axis_across, force_vanishes
from pne_sym.mechanics.inverse_kinematics import given_displacements, invert
from pne_sym.mechanics.joint_forces import write_joint_forces
from pne_sym.mechanics.leg_displacements import InverseKinematics
from pne_sym.mechanics.leg_dynamics import DynamicsWriter
from pne_sym.mechanics.leg_frames import build_geometry
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.mechanics.leg_motion import write_motion
from pne_sym.mechanics.leg_outputs import closure_outputs, joint_outputs
from pne_sym.mechanics.legs import Leg
from pne_sym.mechanics.link_forces import LinkWriter
from pne_sym.mechanics.links import introduce_bodies
from pne_sym.mechanics.orientation import orientation_rows, orientation_signs
from pne_sym.mechanics.platform_motion import PlatformMotion
from pne_sym.mechanics.scales import home_lengths, with_size
from pne_sym.mechanics.structure import LegType
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.model.kinematics import TaskSpace
from pne_sym.model.leg_types import a_leg
from pne_sym.model.manipulator import Manipulator
from pne_sym.vector import Vector, vector_sum

_TERMS = glossary(r"""
S             | \mathbf S     | GEOMETRY POINT @base | Sec. 2.5, step 1.1
    from the base point to the connection point
x_#           | \mathbf S_{#} | GEOMETRY @before
    from the origin of joint # to the connection point
sigma_closure | \sigma_{g}    | given constant
    sign of the determinant of the loop closure's derivative by the iterated displacements
""")

_GEOMETRY = (
    "Constant vectors of the leg, each fixed in a link, and the first moments and inertia tensors "
    "of the links about {points}. All of this is computed once, when the parameters are set."
)
_AT_TIP = "their reference points: the connection point for the last link, the joint for the others"
_INVERSE = (
    "The joints are found one after another from the base, each from a quantity that the joints "
    r"beyond it cannot change: the scalar product with a direction fixed in link j. For a joint "
    r"that turns this is one equation $`K^c_j\,\cos\xi_j+K^s_j\,\sin\xi_j=K^r_j`$ "
    r"for cosine and sine of its angle from the reference direction $`\hat{\mathbf x}^0_j`$; "
    r"$`K_j`$ is its amplitude, and $`\sigma_j`$, the sign of the root, is that of the home "
    r"position. What is zero by structure is left out."
)
_SWINGING = (
    "The joints are found one after another from the base. For a joint that turns, a direction "
    "fixed in its link stays across the vector to the connection point: across the joint's axis "
    r"this vector has the length $`K_j`$, and its components over the length are cosine and sine "
    r"of the angle from the reference direction; $`\sigma_j`$, the sign of the length, is that of "
    r"the home position."
)
_ITERATED = (
    r"Not every joint of this leg has a closed form, so its displacements are found together, by "
    r"Newton's iteration on the loop closure from a first guess: the closure reached from it is "
    r"taken, unless a sign tells that it is not on the assembly branch of home. All that follows "
    r"is closed in pose and displacements."
)


def derive_leg(
    book: Book,
    manipulator: Manipulator,
    space: TaskSpace,
    platform: PlatformMotion,
    leg_type: LegType,
) -> Leg:
    """The chapters of a leg type."""
    title = f"Geometry and inertia of {a_leg(leg_type.architecture)}"
    book.chapter(f"{leg_type.name}-G", title, "", leg_type.name)
    g = build_geometry(book, leg_type, space.planar)
    g = with_size(book, g, home_lengths(manipulator, leg_type))
    bodies = introduce_bodies(book, g, space.planar)
    carried = any(body.at_tip for body in bodies)
    book.retext(_GEOMETRY.format(points=_AT_TIP if carried else "their joints"))
    # Links that all turn together are one body; else composite bodies cost less.
    composite = len({body.group for body in bodies}) > 1
    completion = completion_of(manipulator, g, planar=space.planar)
    pure = force_vanishes(manipulator, g)
    g = replace(g, composite=composite, completion=completion, pure_moment=pure)
    Writer(book, g, _TERMS).chapter("K", "Inverse kinematics of &", _INVERSE)
    inverse = _inverse_kinematics(book, manipulator, space, platform, g)
    _tell_rotations(book, g, inverse)
    book.leg_types.append(_info(leg_type, inverse, len(g.pairs)))
    motion = write_motion(book, g, platform, space, inverse)
    coupled = manipulator.coupling is not None
    forces = write_joint_forces(book, g, motion, coupled=coupled)
    links = LinkWriter(book, platform.gravity, motion, bodies)
    dynamics = DynamicsWriter(links, forces).run()
    leg = Leg(g, motion, dynamics)
    joint_outputs(book, manipulator, leg, inverse)
    if not inverse.is_closed:
        closure_outputs(book, leg, motion.chain.tip_frame, space)
        _orientation(book, manipulator, leg, space)
    return leg


def _tell_rotations(book: Book, g: LegGeometry, inverse: InverseKinematics) -> None:
    """For readers: how the axes of the links are turned by the angles found."""
    before, turned = "", None
    for j in range(g.count + 1):
        if j and not g.turns(j):
            continue
        members = [k for k in range(j, g.count + 1) if g.group[k] == j]
        body = f"link{'s' * (len(members) > 1)} {', '.join(map(str, members))}"
        what = f"rotation of link {j}: turns components in its axes into base axes"
        name, latex = g.name(f"rotation_{j}"), rf"\mathbf T_{{{j}}}"
        quantity = Quantity(name, latex, what, body="base", joint=j)
        rhs = turned_about(g.e[j], g.turn(j) * inverse.q[j]) @ turned if j else None
        frame = BodyFrame(
            g.frame("spec", j),
            body,
            leg_type=g.leg_type.name,
            axis=g.e[j] if j else None,
            before=before,
        )
        before, turned = frame.frame, book.fix_axes(frame, quantity, rhs)


def _orientation(book: Book, manipulator: Manipulator, leg: Leg, space: TaskSpace) -> None:
    """The sign by which closures on home's branch are told from others."""
    g = leg.g
    completed = any(
        basis.id == leg.name and len(basis.duals) < len(basis.vectors) for basis in book.bases
    )
    rows = orientation_rows(manipulator, g, planar=space.planar, completed=completed)
    if not rows:
        return
    sign = Writer(book, g, _TERMS).note("sigma_closure")
    book.parameters.add_branch(sign.name, leg.name, orientation_signs(manipulator, g, rows))
    book.leg_types[-1] = replace(book.leg_types[-1], orientation=rows, orientation_sign=sign.name)


def _inverse_kinematics(
    book: Book,
    manipulator: Manipulator,
    space: TaskSpace,
    platform: PlatformMotion,
    g: LegGeometry,
) -> InverseKinematics:
    """Displacements in closed form, or else given; settles how the basis is completed."""
    S, x = _connection(book, platform, g)
    dofs = [j for j in range(1, g.count + 1) if not g.is_extra(j)]
    constrained = (2 if space.planar else 3) + len(g.pairs) > len(dofs)
    flat = constrained and not space.planar and not g.pairs
    normal = axis_across(g, dofs) if flat else None
    before = book.mark()
    inverse = invert(book, g, x, normal, constrained=constrained)
    if not inverse.is_closed:
        book.reset(before)
        book.retext(_ITERATED)
        inverse = given_displacements(book, g, inverse.reasons)
    elif inverse.swings:
        book.retext(_SWINGING)
    inverse = inverse._replace(S=S)
    signs = branch_signs(manipulator, g, inverse, book)
    for branch, of_legs in zip(inverse.branches, signs, strict=True):
        book.parameters.add_branch(branch.symbol.name, g.leg_type.name, of_legs)
    return inverse


def _connection(book: Book, platform: PlatformMotion, g: LegGeometry) -> tuple[Vector, Vector]:
    """The connection point from the base point, and from the origin of joint 1."""
    eq = Writer(book, g, _TERMS)
    S = eq("S", vector_sum((platform.t, g.platform_point, -g.base_point)))
    return S, eq.named("x_#", S - g.offset[1], 1)


def _info(leg_type: LegType, inverse: InverseKinematics, transmitted: int) -> LegTypeInfo:
    count = len(leg_type.model.joints)
    return LegTypeInfo(
        leg_type.name,
        leg_type.architecture,
        leg_type.indices,
        count,
        tuple(inverse.methods[j] for j in range(1, count + 1)),
        tuple(sorted(inverse.reasons.items())),
        transmitted,
        number=leg_type.number,
    )
