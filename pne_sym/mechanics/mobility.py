"""Mobility at home by screw rank: degrees of freedom, actuators, constraints, the paper's case.

All legs' closure conditions are linear in the rates of platform and joints.  The rates that
satisfy them all are its degrees of freedom; no count of joints (Gruebler) is trusted.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from pne_sym.model.errors import SpecWarning
from pne_sym.model.kinematics import TASK_SPACES, Array
from pne_sym.model.loops import Loops
from pne_sym.model.manipulator import Manipulator

DEPENDENT = 1e-8
"""Singular values below it, of the largest, are zeros: home is closed to 1e-12."""

CASES: dict[str, str] = {
    "3.1": "ordinary",
    "3.2": "hybrid: a leg with several actuators",
    "3.3": "static redundancy: more legs than degrees of freedom",
    "3.4": "redundant actuation: more actuators than degrees of freedom",
    "3.5": "kinematic redundancy: actuated joints beyond those the platform needs",
    "3.6": "passive degrees of freedom: joints that neither actuators nor platform determine",
    "3.7": "constrained: legs that restrict the platform",
}
"""The cases of section 3 of the paper, by number."""


class Mobility(NamedTuple):
    """What moves, and what moves it, at home.

    Attributes:
        dofs: degrees of freedom, by rank.
        actuators: actuated joints.
        constraints: conditions that the legs put on the platform, multipliers in the equations.
        overconstrained: how many of the constraints follow from the others.
        extra: coordinates beside those of the platform.
        passive: those of them that are not actuated.
        unheld: degrees of freedom that remain when all actuators are held.
        singular_legs: legs whose own degrees of freedom are dependent.
        cases: numbers of the sections of the paper that apply, such as "3.1".
    """

    dofs: int
    actuators: int
    constraints: int
    overconstrained: int
    extra: int
    passive: int
    unheld: int
    singular_legs: tuple[int, ...]
    cases: tuple[str, ...]

    def __str__(self) -> str:
        """One line for people."""
        parts = [
            _count(self.dofs, "degree of freedom at home", "degrees of freedom at home"),
            _count(self.actuators, "actuator"),
            _count(self.constraints, "constraint"),
            _count(self.extra, "extra coordinate"),
        ]
        if self.passive:
            parts[-1] += f" ({self.passive} passive)"
        if self.overconstrained:
            parts[2] += f" ({self.overconstrained} dependent)"
        cases = ", ".join(f"{CASES[case]} ({case})" for case in self.cases)
        return f"{', '.join(parts)}; section 3 of the paper: {cases}"


def mobility(manipulator: Manipulator) -> Mobility:
    """Mobility of a manipulator at its home.

    >>> from pne_sym import manipulators
    >>> found = mobility(manipulators.load("tripod_3rps"))
    >>> found.dofs, found.actuators, found.constraints
    (3, 3, 3)
    >>> print(mobility(manipulators.load("stewart")))
    6 degrees of freedom at home, 6 actuators, 0 constraints, 0 extra coordinates; \
section 3 of the paper: ordinary (3.1)
    """
    joints = manipulator.joints
    closure, by_leg, singular = _closure(manipulator)
    constraints = sum(by_leg)
    twist = len(TASK_SPACES[manipulator.space].components)
    rates = null_space(closure)
    dofs = rates.shape[1]
    actuated = np.array([joint.actuated for joint in joints], dtype=bool)
    held = rank_of(rates[twist:][actuated])
    extra = sum(joint.extra for joint in joints)
    passive = sum(joint.extra and not joint.actuated for joint in joints)
    return Mobility(
        dofs=dofs,
        actuators=int(actuated.sum()),
        constraints=constraints,
        overconstrained=max(0, constraints + dofs - twist - extra) if not singular else 0,
        extra=extra,
        passive=passive,
        unheld=dofs - held,
        singular_legs=singular,
        cases=_cases(manipulator, dofs, passive if held < dofs else 0, by_leg),
    )


def check_mobility(manipulator: Manipulator) -> Mobility:
    """Mobility, with a warning where actuators leave degrees of freedom not marked passive.

    Warns with `SpecWarning`, also where constraints follow from others; passive extra coordinates
    are meant to move by themselves.
    """
    found = mobility(manipulator)
    meant = found.dofs - found.passive
    problem = ""
    if found.actuators < meant:
        problem = (
            f"fewer actuators than degrees of freedom: {found.actuators} for {found.dofs}"
            + (f", of which {found.passive} are passive extra coordinates" if found.passive else "")
            + "; mark more joints actuated = true, or let it move freely"
        )
    elif found.unheld > found.passive:
        free = _count(found.unheld - found.passive, "degree of freedom", "degrees of freedom")
        problem = f"all actuators held, the mechanism can move at home ({free}): "
        problem += "H is singular there"
    dependent = (
        f"overconstrained: of the {found.constraints} constraints that the legs put on the "
        f"platform, {found.overconstrained} follow from the others; motion and actuator forces "
        "are determined, lambda and the reactions are those of least norm"
    )
    for what in (dependent * bool(found.overconstrained), problem):
        if what:
            warnings.warn(f"{manipulator.name}: legs: {what}", SpecWarning, stacklevel=2)
    return found


def check_solvable(manipulator: Manipulator) -> None:
    """Refuse what has no determined dynamics, with the mechanical reason.

    Raises:
        SpecError: no joint is actuated; nothing moves; an extra coordinate cannot.
    """
    _check_extra(manipulator)
    found = mobility(manipulator)
    if not found.actuators:
        raise manipulator.fault("legs", "no joint is actuated", "actuated = true for some joint")
    if not found.dofs:
        raise manipulator.fault(
            "legs",
            "the legs hold the platform: nothing moves at home",
            "at least one degree of freedom",
        )


def _check_extra(manipulator: Manipulator) -> None:
    """Refuse extra coordinates of a leg that the leg itself holds, however the platform moves.

    A platform that is kept from turning, or from moving its centre, holds them with what does no
    work on it.
    """
    for index, (_, own, extra, by_twist) in enumerate(_legs(manipulator)):
        others = np.hstack([own, by_twist])
        held = rank_of(np.hstack([others, extra])) - rank_of(others)
        if held:
            marked = [
                f"joints[{j}]" for j, joint in enumerate(manipulator.legs[index].joints)
                if joint.extra
            ]  # fmt: skip
            raise manipulator.fault(
                f"legs[{index}]",
                f"of the joints marked extra, {held} cannot move: how the platform is guided holds "
                "them",
                f"extra = true for joints that are free to move ({', '.join(marked)} are marked)",
            )


def actuation_quality(manipulator: Manipulator) -> float:
    """How well the actuators hold the mechanism at home: 0 not at all, 1 at best.

    The smallest singular value of the actuators' rates over all motions of unit size.
    """
    rates = motions_at_home(manipulator)
    wanted = np.array([joint.actuated or joint.extra for joint in manipulator.joints], dtype=bool)
    rows = rates[len(TASK_SPACES[manipulator.space].components) :][wanted]
    if rows.shape[0] < rows.shape[1] or not rows.size:
        return 0.0
    return float(np.linalg.svd(rows, compute_uv=False)[-1])


def motions_at_home(manipulator: Manipulator) -> Array:
    """Rates of the platform (its free twist components) and of all joints that keep loops closed.

    Orthonormal columns, one for every degree of freedom at home.
    """
    return null_space(_closure(manipulator)[0])


def null_space(matrix: Array) -> Array:
    """Orthonormal columns that a matrix maps to zero."""
    _, values, vt = np.linalg.svd(matrix)
    rank = int(np.sum(values > DEPENDENT * max(1.0, float(values.max(initial=0.0)))))
    basis: Array = vt[rank:].T
    return basis


def _closure(manipulator: Manipulator) -> tuple[Array, tuple[int, ...], tuple[int, ...]]:
    """Closure conditions by the rates of platform and joints; constraints by leg; singular legs."""
    joints = len(manipulator.joints)
    rows, constraints, singular, start = [], [], [], 0
    for index, (by_q, own, _, by_twist) in enumerate(_legs(manipulator)):
        rank = rank_of(own)
        constraints.append(rank_of(np.hstack([own, by_twist])) - rank)
        if rank < own.shape[1]:
            singular.append(index)
        twist, end = by_twist.shape[1], start + by_q.shape[1]
        row = np.zeros((by_q.shape[0], twist + joints))
        row[:, :twist] = by_twist
        row[:, twist + start : twist + end] = by_q
        rows.append(row)
        start = end
    return np.vstack(rows), tuple(constraints), tuple(singular)


def _legs(manipulator: Manipulator) -> Iterator[tuple[Array, Array, Array, Array]]:
    """A leg's closure by rates of all its joints, of those not extra, of the extra ones, of X."""
    loops, home = Loops.of(manipulator), manipulator.home
    found = loops.closures(np.array(home.X), np.array(home.q))
    for (_, by_q, by_twist), s in zip(found, loops.slices(), strict=True):
        extra = loops.extra[s]
        yield by_q, by_q[:, ~extra], by_q[:, extra], by_twist


def _cases(
    manipulator: Manipulator, dofs: int, passive: int, constraints: tuple[int, ...]
) -> tuple[str, ...]:
    """Numbers of the cases; passive extra coordinates that actuators determine are none of them."""
    actuators = [sum(joint.actuated for joint in leg.joints) for leg in manipulator.legs]
    kinematic = sum(joint.extra for joint in manipulator.joints) > passive
    actuated = dofs - passive  # that the actuators are to determine
    found = []
    # A leg without actuators that restricts the platform guides it: it is none too many.
    bearing = sum(actuators[k] > 0 or not restricts for k, restricts in enumerate(constraints))
    if bearing > actuated:
        found.append("3.3")
    if max(actuators) > 1:
        if sum(actuators) > actuated:
            found.append("3.4")
        elif not kinematic:
            found.append("3.2")
    if kinematic:
        found.append("3.5")
    if passive:
        found.append("3.6")
    if any(constraints):
        found.append("3.7")
    return tuple(found) or ("3.1",)


def rank_of(matrix: Array) -> int:
    """Rank, with what is below `DEPENDENT` for zero; 0 of an empty matrix."""
    if not matrix.size:
        return 0
    values = np.linalg.svd(matrix, compute_uv=False)
    return int(np.sum(values > DEPENDENT * max(1.0, float(values[0]))))


def _count(number: int, one: str, many: str = "") -> str:
    return f"{number} {one if number == 1 else many or one + 's'}"
