"""What else users must know of public functions: it depends on actuators, constraints, legs."""

from __future__ import annotations

from dataclasses import replace

from pne_sym.derivation import Coordinates
from pne_sym.program.public import PublicFunction


def with_notes(function: PublicFunction, c: Coordinates, *, guessed: bool) -> PublicFunction:
    """The function with its notes."""
    notes = {
        "inverse_kinematics": [_branch(guessed=guessed)],
        "inverse_dynamics": _inverse_dynamics(c),
        "complete_acceleration": [_completion(c)],
        "leg_reactions": ["The actuators give the forces of `inverse_dynamics`."],
        "null_space": ["It is empty: the actuators are not redundant."]
        * (not function.outputs[0].value.size),
        "forward_kinematics": [
            "Extra coordinates that actuators do not determine stay.",
            "Impossible where no pose is found.",
        ],
        "project": ["By Gauss-Newton; impossible where none is found."],
        "rotation": ["Impossible where the quaternion is zero or its squared length overflows."]
        * c.has_quaternion,
        "manipulability": [
            "Of N^T H, N an orthonormal basis of the motions that constraints leave."
        ]
        * (c.sizes["NC"] > 0),
        "reachable_wrench": _REACHABLE,
        "reachable_acceleration": _REACHABLE,
        "force_distribution": _DISTRIBUTION,
    }
    return replace(function, notes=tuple(notes.get(function.name, ())))


_REACHABLE = (
    (
        "All s from least to largest, which is infinite where nothing limits it: forces are those "
        "of `inverse_dynamics`, redundant actuators sharing them as is best; actuators without "
        "limits of effort give any."
    ),
    "Impossible (UNREACHABLE) where there is no such s.",
)
_DISTRIBUTION = (
    "By the dual active-set method of Goldfarb and Idnani; continuous along a motion.",
    (
        "Impossible (UNREACHABLE) where no forces within the bounds give the acceleration. Cables "
        "pull with negative forces: tau_max = -t keeps tensions of t at least."
    ),
)


def _branch(*, guessed: bool) -> str:
    if not guessed:
        return "They are those of the assembly branch of home."
    return (
        "Where there is no closed form they are iterated from q0: impossible where Newton does not "
        "converge, or to a closure that is not on the assembly branch of home, as the sign of the "
        "closure's determinant tells; from the last q of a path in small steps they stay on it."
    )


def _inverse_dynamics(c: Coordinates) -> list[str]:
    facts, n = c.actuation, c.sizes
    if not facts.is_determined:
        told = "Impossible: with fewer actuators than degrees of freedom"
        return [f"{told} no forces give any acceleration."]
    found = []
    if n["NU"] + n["NC"] == facts.rank:
        found.append("The weights are not used, as the actuators are not redundant.")
    if facts.idle and facts.completes:
        rest = ", else in least squares" if facts.surplus else ""
        found.append(
            f"Rows of passive extra coordinates hold where `complete_acceleration` was used{rest}."
        )
    return found


def _completion(c: Coordinates) -> str:
    facts, constrained = c.actuation, c.sizes["NC"] > 0
    if not facts.passive:
        return "It is A: there are no passive extra coordinates, whose accelerations would follow."
    if not facts.is_determined:
        return (
            "Impossible: with fewer actuators than degrees of freedom no accelerations of passive "
            "extra coordinates will do."
        )
    holding = "actuators and constraints" if constrained else "actuators"
    if facts.idle == 0:
        return f"It is A: {holding} hold passive extra coordinates too, whatever they do."
    if not facts.completes:
        return "It is A: no accelerations of passive extra coordinates bring other forces about."
    if not facts.is_coupled:
        nothing = "neither actuators nor constraints" if constrained else "no actuators"
        return f"The entries are taken from their own rows (Eq. 7), on which {nothing} act."
    found = (
        f"{'[H Hk]' if constrained else 'H'} has rank {facts.rank} of {c.sizes['NV']}, so that not "
        "every A has forces.  The entries change so that M A + Z - wrench comes into its range"
    )
    if facts.idle < len(facts.passive):
        found += ", by the least change in the metric of M"
    if constrained:
        found += ".  Constraints may ask for other entries; what forward dynamics gives obeys both"
    return f"{found}."
