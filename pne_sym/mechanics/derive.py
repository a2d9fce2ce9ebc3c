"""The derivation of a manipulator, chapter by chapter."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import sympy as sp

from pne_sym.derivation import (
    Book,
    Coordinates,
    Derivation,
    Law,
    LegTypeInfo,
    NameTakenError,
    Output,
    Quantity,
    Role,
)
from pne_sym.derivation.frames import BodyFrame, turned_about
from pne_sym.mechanics.actuation import actuation, check_dependence
from pne_sym.mechanics.branches import branch_signs
from pne_sym.mechanics.completion import completion_of
from pne_sym.mechanics.conditioning import write_lengths
from pne_sym.mechanics.constraints import axis_across, force_vanishes
from pne_sym.mechanics.inverse_kinematics import InverseKinematics, given_displacements, invert
from pne_sym.mechanics.joint_forces import write_joint_forces
from pne_sym.mechanics.joint_limits import write_efforts, write_margins
from pne_sym.mechanics.leg_chain import LegChain
from pne_sym.mechanics.leg_dynamics import DynamicsWriter
from pne_sym.mechanics.leg_geometry import LegGeometry, build_geometry
from pne_sym.mechanics.leg_motion import write_motion
from pne_sym.mechanics.legs import Leg
from pne_sym.mechanics.link_forces import LinkWriter
from pne_sym.mechanics.links import introduce_bodies
from pne_sym.mechanics.lumping import PlatformInertia, write_inertia
from pne_sym.mechanics.mobility import check_solvable, mobility
from pne_sym.mechanics.motors import write_motors
from pne_sym.mechanics.moving_base import introduce_base
from pne_sym.mechanics.notation import with_symbols
from pne_sym.mechanics.orientation import orientation_rows, orientation_signs
from pne_sym.mechanics.platform_dynamics import PlatformWriter
from pne_sym.mechanics.platform_motion import PlatformMotion, introduce_platform
from pne_sym.mechanics.scales import home_lengths, with_size
from pne_sym.mechanics.scope import check_scope
from pne_sym.mechanics.structure import LegType, leg_types
from pne_sym.model.errors import SpecError
from pne_sym.model.kinematics import TASK_SPACES, TaskSpace
from pne_sym.model.manipulator import Manipulator
from pne_sym.vector import Dot, Vector, VectorSymbol, ZeroVector, sum_over_legs, vector_sum


def derive(manipulator: Manipulator) -> Derivation:
    """Derive the task-space dynamics of a manipulator.

    Raises:
        SpecError: the method does not cover it, or it has no determined dynamics; with the
            mechanical reason; names of leg types and joints make one name of two quantities.

    Reference: section 2 of the paper; legs are derived once per leg type.
    """
    try:
        return _derive(Book(), manipulator)
    except NameTakenError as error:
        problem = f"two quantities would be called '{error.name}'"
        expected = "another name for a leg type, a leg or a joint"
        raise SpecError(manipulator.name, "legs", problem, expected) from error


def _derive(book: Book, manipulator: Manipulator) -> Derivation:
    space = TASK_SPACES[manipulator.space]
    platform = introduce_platform(book, manipulator, space)
    if manipulator.moving_base:
        base = introduce_base(book, platform.gravity, planar=space.planar)
        platform = replace(platform, base=base, gravity=base.felt)
    types = leg_types(manipulator)
    legs = []
    for leg_type in types:
        check_scope(manipulator, leg_type, space)
    check_solvable(manipulator)
    check_dependence(manipulator)
    for leg_type in types:
        legs.append(_derive_leg(book, manipulator, space, platform, leg_type))
    inertia = write_inertia(book, platform, legs)
    writer = PlatformWriter(book, space, platform, inertia, legs)
    writer.equilibrium()
    writer.blocks()
    _potential(book, platform, inertia, legs)
    _dissipation(book, legs)
    write_motors(book, manipulator, legs)
    for leg in legs:
        write_margins(book, leg.g, leg.motion.chain.q, _starts(manipulator))
        write_efforts(book, leg.g, _actuators(manipulator))
    write_lengths(book, [leg.g for leg in legs])
    book.coordinates = _coordinates(manipulator, space, legs)
    equal = (pair for leg in legs for pair in leg.g.same_axes())
    return with_symbols(book.close(), manipulator, equal)


def _coordinates(manipulator: Manipulator, space: TaskSpace, legs: list[Leg]) -> Coordinates:
    """Names and order of what goes in and comes out."""
    joints = [
        (i, j, joint)
        for i, leg in enumerate(manipulator.legs)
        for j, joint in enumerate(leg.joints)
    ]
    constraints = sorted(
        (index, k, "N m" if wrench.of_moment else "N")
        for leg in legs
        for index in leg.g.leg_type.indices
        for k, wrench in enumerate(leg.motion.constraints)
    )
    return Coordinates(
        space=manipulator.space.value,
        pose=space.pose_names,
        rates=space.rate_names,
        wrench=space.wrench_names,
        components=space.components,
        planar=space.planar,
        joints=tuple((i, j) for i, j, _ in joints),
        actuators=tuple((i, j) for i, j, joint in joints if joint.actuated),
        extras=tuple((i, j) for i, j, joint in joints if joint.extra),
        constraints=tuple(index for index, *_ in constraints),
        limited=tuple((i, j) for i, j, joint in joints if joint.has_stroke),
        bounded=tuple((i, j) for i, j, joint in joints if joint.has_effort),
        turning=tuple(joint.kind.is_hinge for *_, joint in joints),
        home=(tuple(manipulator.home.X), tuple(manipulator.home.q)),
        actuation=actuation(manipulator),
        overconstrained=mobility(manipulator).overconstrained,
        transmits_moments=any(leg.motion.n or leg.dynamics.moment != ZeroVector for leg in legs),
        constraint_units=tuple(unit for *_, unit in constraints),
        names=tuple(
            f"{manipulator.legs[i].name or f'leg{i + 1}'}_{joint.name or f'joint{j + 1}'}"
            for i, j, joint in joints
        ),
    )


def _derive_leg(
    book: Book,
    manipulator: Manipulator,
    space: TaskSpace,
    platform: PlatformMotion,
    leg_type: LegType,
) -> Leg:
    prefix, title = leg_type.name, leg_type.architecture
    book.chapter(f"{prefix}-G", f"Geometry and inertia of a {title} leg", "", prefix)
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
    book.chapter(f"{prefix}-K", f"Inverse kinematics of a {title} leg", _INVERSE, prefix)
    inverse = _inverse_kinematics(book, manipulator, space, platform, g)
    _tell_rotations(book, g, inverse)
    book.leg_types.append(_info(leg_type, inverse, len(g.pairs)))
    motion = write_motion(book, g, platform, space, inverse)
    text = (
        _NEWTON_EULER
        + (_CARRIED if carried else _KEPT)
        + (_RESTRICTED if motion.constraints else "")
        + (_COMPOSITE if g.composite else "")
        + (_MOMENTS if g.pairs else "")
    )
    coupled = manipulator.coupling is not None
    forces = write_joint_forces(book, g, motion, coupled=coupled)
    book.chapter(f"{prefix}-N", f"Newton-Euler of a {title} leg", text, prefix)
    links = LinkWriter(book, platform.gravity, motion, bodies)
    dynamics = DynamicsWriter(links, forces).run()
    leg = Leg(g, motion, dynamics)
    _joint_outputs(book, manipulator, leg, inverse)
    if not inverse.is_closed:
        _closure_outputs(book, leg, motion.chain.tip_frame, space)
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
    sign = Quantity(
        g.name("sigma_closure"),
        r"\sigma_{g}",
        "sign of the determinant of the loop closure's derivative by the iterated displacements",
        parameter=True,
    )
    book.note_quantity(sign)
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
    inverse = replace(inverse, S=S)
    signs = branch_signs(manipulator, g, inverse, book)
    for branch, of_legs in zip(inverse.branches, signs, strict=True):
        book.parameters.add_branch(branch.symbol.name, g.leg_type.name, of_legs)
    return inverse


def _connection(book: Book, platform: PlatformMotion, g: LegGeometry) -> tuple[Vector, Vector]:
    """The connection point from the base point, and from the origin of joint 1."""
    S = book.define(
        g.name("S"),
        vector_sum((platform.t, g.platform_point, -g.base_point)),
        r"\mathbf S",
        "from the base point to the connection point",
        Law.GEOMETRY,
        body="base",
        reference="Sec. 2.5, step 1.1",
        role=Role.POINT,
    )
    x = S - g.offset[1]
    if not isinstance(x, VectorSymbol):
        x = book.define(
            g.name("x_1"),
            x,
            r"\mathbf S_{1}",
            "from the origin of joint 1 to the connection point",
            Law.GEOMETRY,
            body=g.frame("axes", 0),
        )
    return S, x


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


def _joint_outputs(
    book: Book, manipulator: Manipulator, leg: Leg, inverse: InverseKinematics
) -> None:
    """Displacements, rates and accelerations of the joints; the leg's force."""
    starts, indices = _starts(manipulator), leg.g.leg_type.indices
    for j in range(1, leg.g.count + 1):
        rows = tuple(starts[i] + j - 1 for i in indices)
        for array, value in (
            ("q", inverse.q.get(j)),
            ("qd", leg.motion.qd[j]),
            ("qdd", leg.motion.qdd[j]),
        ):
            if value is not None:
                book.outputs.append(Output(array, value, ((0, 0),), (), leg.name, rows))
    book.outputs.append(
        Output(
            "leg_force",
            leg.dynamics.true_force,
            ((0, 0),),
            tuple((c, c) for c in range(3)),
            leg.name,
            tuple(indices),
        )
    )
    if leg.dynamics.moment != ZeroVector:
        book.outputs.append(
            Output(
                "leg_force",
                leg.dynamics.moment,
                ((0, 0),),
                tuple((c, c + 3) for c in range(3)),
                leg.name,
                tuple(indices),
            )
        )


def _starts(manipulator: Manipulator) -> list[int]:
    """Where the joints of each leg begin in q."""
    return [sum(len(m.joints) for m in manipulator.legs[:i]) for i in range(len(manipulator.legs))]


def _closure_outputs(book: Book, leg: Leg, frame: str, space: TaskSpace) -> None:
    """Misfit of the loop closure and its derivative by the joint displacements."""
    g, motion, name = leg.g, leg.motion, leg.name
    gap = book.define(
        g.name("gap"),
        motion.gap,
        r"\mathbf S_r",
        "from the connection point as the links reach it to the platform's",
        Law.LOOP_CLOSURE,
        body=frame,
    )
    joints = [j for j in range(1, g.count + 1) if not g.is_extra(j)]
    axes = range(2 if space.planar else 3)
    rows = tuple(range(g.leg_type.count))
    width = len(joints)

    def put(array: str, value: Any, columns: tuple[tuple[int, int], ...]) -> None:
        book.outputs.append(Output(array, value, ((0, 0),), columns, name, rows, frame=frame))

    put(f"gap_{name}", gap, tuple((c, c) for c in axes))
    for k, j in enumerate(joints):
        put(f"jacobian_{name}", motion.v[j], tuple((c, c * width + k) for c in axes))
    for i, ((link, platform), n) in enumerate(zip(g.pairs, motion.n, strict=True), len(axes)):
        put(f"gap_{name}", -Dot(link, platform), ((0, i),))
        for k, j in enumerate(joints):
            if g.turns(j):
                put(f"jacobian_{name}", Dot(g.spin(j), n), ((0, i * width + k),))


def _actuators(manipulator: Manipulator) -> list[tuple[int, int]]:
    """(leg, joint) of every entry of tau, counted from 0."""
    legs = enumerate(manipulator.legs)
    return [(i, j) for i, leg in legs for j, joint in enumerate(leg.joints) if joint.actuated]


def _dissipation(book: Book, legs: list[Leg]) -> None:
    """Power that friction takes, where there is any."""
    taken = [(leg.name, leg.dynamics.forces.dissipation) for leg in legs]
    total = sp.Add(*(sum_over_legs(power, name) for name, power in taken))
    if total == 0:
        return
    book.chapter("D", "Dissipation", "Friction times rate, of all joints; never negative.")
    power = book.define(
        "dissipation", total, r"\mathcal D", "power that friction takes", Law.FRICTION
    )
    book.outputs.append(Output("dissipation", power, ((0, 0),)))


def _potential(
    book: Book,
    platform: PlatformMotion,
    inertia: PlatformInertia,
    legs: list[Leg],
) -> None:
    """Potential energy, zero at the base origin."""
    sprung = any(leg.dynamics.forces.potential != 0 for leg in legs)
    text = "Weight times height, zero at the base origin" + ", and the energy of springs" * sprung
    book.chapter("V", "Potential energy", f"{text}.")
    total: Any = -Dot(platform.weight, inertia.mass * platform.t + inertia.moment)
    for leg in legs:
        g = leg.g
        terms: list[Any] = []
        for body in leg.dynamics.bodies:
            if not body.at_tip:  # its mass is counted with the platform
                terms.append(
                    body.mass * vector_sum((g.base_point, *_path(leg.motion.chain, body.joint)))
                )
            terms.append(body.first_moment)
        moment = vector_sum(terms)
        if moment != ZeroVector:
            total = total + sum_over_legs(-Dot(platform.weight, moment), leg.name)
        total = total + sum_over_legs(leg.dynamics.forces.potential, leg.name)
    energy = book.define("potential", total, r"\mathcal E", "potential energy", Law.ENERGY)
    book.outputs.append(Output("potential", energy, ((0, 0),)))


def _path(chain: LegChain, joint: int) -> list[Any]:
    """Vectors from the base point to the origin of a link."""
    group, path = chain.g.group[joint], [chain.reach(joint)]
    while group:
        group = chain.g.group[group - 1]
        path.append(chain.spans[group])
    return path


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
_COMPOSITE = (
    r" The links of this leg turn differently, so their inertia is collected in the accelerations "
    r"of the joints first: all links from k outwards, frozen together, are one composite body with "
    r"first moment $`\mathbf h^c_k`$ and inertia tensor $`\mathbf J^c_k`$; a unit acceleration of "
    r"joint k takes the force $`\boldsymbol\Pi_k`$ and the moment $`\boldsymbol\Lambda_k`$, "
    r"whose component along joint j is $`\mathcal M_{jk}`$. With $`\ddot q_k`$ in closed form, "
    r"$`\Gamma_j`$ then holds the platform's acceleration through "
    r"$`\sum_k \mathcal M_{jk}\,\ddot q_k`$."
)
_MOMENTS = (
    r" The platform joint of this leg transmits moments along $`\mathbf n_{m1}`$ and on, which do "
    r"work along the turning joints too: the equilibrium along joint j holds the parts of these "
    r"moments times $`\mathbf e_j\cdot\mathbf n_{mi}`$ besides, and the reciprocal wrenches with "
    r"force parts $`\mathbf w_j`$ and moment parts $`\mathbf o_j`$ solve for force and moment "
    r"together."
)
_NEWTON_EULER = (
    r"From the last link to the base; of the equilibrium of the links beyond a joint only the "
    r"component along the joint's axis is taken, so that joint reactions never appear. "
)
_CARRIED = (
    r"The inertia force $`\mathbf f`$ of the last link (its weight taken off) acts at the "
    r"connection point like the force $`\mathbf F`$ on the platform; $`\Gamma_j`$ is what "
    r"everything else needs along joint j. So "
    r"$`\mathbf v_j\cdot(\mathbf F+\mathbf f)=\tau_j-\Gamma_j`$ for every joint, and the "
    r"reciprocal vectors solve this: "
    r"$`\mathbf F=\sum_j\mathbf w_j\,(\tau_j-\Gamma_j)-\mathbf f`$."
)
_KEPT = (
    r"$`\Gamma_j`$ is what the links beyond joint j need along it, so that the force $`\mathbf F`$ "
    r"on the platform obeys $`\mathbf v_j\cdot\mathbf F=\tau_j-\Gamma_j`$ for every joint; the "
    r"reciprocal vectors solve this: $`\mathbf F=\sum_j\mathbf w_j\,(\tau_j-\Gamma_j)`$."
)
_RESTRICTED = (
    r" Besides, the leg exerts a constraint wrench on the platform; its coefficient is the "
    r"multiplier $`\lambda`$, a reaction that only the platform's equations determine."
)
