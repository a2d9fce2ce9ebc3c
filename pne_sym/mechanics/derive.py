"""The derivation of a manipulator, chapter by chapter."""

from __future__ import annotations

from pne_sym.derivation import Book, Coordinates, Derivation, NameTakenError
from pne_sym.mechanics.actuation import actuation, check_dependence
from pne_sym.mechanics.conditioning import write_lengths
from pne_sym.mechanics.energy import write_dissipation, write_potential
from pne_sym.mechanics.joint_limits import write_efforts, write_margins
from pne_sym.mechanics.leg_derivation import derive_leg
from pne_sym.mechanics.legs import Leg
from pne_sym.mechanics.lumping import write_inertia
from pne_sym.mechanics.mobility import check_solvable, mobility
from pne_sym.mechanics.motors import write_motors
from pne_sym.mechanics.moving_base import introduce_base
from pne_sym.mechanics.notation import with_symbols
from pne_sym.mechanics.platform_dynamics import PlatformWriter
from pne_sym.mechanics.platform_motion import introduce_platform
from pne_sym.mechanics.scope import check_scope
from pne_sym.mechanics.structure import leg_types
from pne_sym.model.kinematics import TASK_SPACES, TaskSpace, slices_of
from pne_sym.model.manipulator import Manipulator
from pne_sym.vector import ZeroVector


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
        raise manipulator.fault("legs", problem, expected) from error


def _derive(book: Book, manipulator: Manipulator) -> Derivation:
    space = TASK_SPACES[manipulator.space]
    platform = introduce_platform(book, manipulator, space)
    if manipulator.moving_base:
        base = introduce_base(book, platform.gravity, planar=space.planar)
        platform = platform._replace(base=base, gravity=base.felt)
    types = leg_types(manipulator)
    legs = []
    for leg_type in types:
        check_scope(manipulator, leg_type, space)
    check_solvable(manipulator)
    check_dependence(manipulator)
    for leg_type in types:
        legs.append(derive_leg(book, manipulator, space, platform, leg_type))
    inertia = write_inertia(book, platform, legs)
    writer = PlatformWriter(book, space, platform, inertia, legs)
    writer.equilibrium()
    writer.blocks()
    write_potential(book, platform, inertia, legs)
    write_dissipation(book, legs)
    write_motors(book, manipulator, legs)
    for leg in legs:
        write_margins(book, leg.g, leg.motion.chain.q, slices_of(manipulator.legs))
        write_efforts(book, leg.g, _actuators(manipulator))
    write_lengths(book, [leg.g for leg in legs])
    book.coordinates = _coordinates(manipulator, space, legs)
    equal = (pair for leg in legs for pair in leg.g.same_axes())
    return with_symbols(book.close(), manipulator, equal)


def _coordinates(manipulator: Manipulator, space: TaskSpace, legs: list[Leg]) -> Coordinates:
    """Names and order of what goes in and comes out."""
    found = mobility(manipulator)
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
        overconstrained=found.overconstrained,
        cases=found.cases,
        transmits_moments=any(leg.motion.n or leg.dynamics.moment != ZeroVector for leg in legs),
        constraint_units=tuple(unit for *_, unit in constraints),
        names=tuple(
            f"{manipulator.legs[i].name or f'leg{i + 1}'}_{joint.name or f'joint{j + 1}'}"
            for i, j, joint in joints
        ),
    )


def _actuators(manipulator: Manipulator) -> list[tuple[int, int]]:
    """(leg, joint) of every entry of tau, counted from 0."""
    legs = enumerate(manipulator.legs)
    return [(i, j) for i, leg in legs for j, joint in enumerate(leg.joints) if joint.actuated]
