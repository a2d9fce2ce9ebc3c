"""What friction, springs, motors and the rest add to inverse dynamics: operations, time of the C.

Operations are those of the program.  Time is that of the C with and without friction (viscous and
Coulomb) and motors at all actuated joints: processes take turns, the median of the ratios of
neighbours counts.
"""

from __future__ import annotations

from dataclasses import replace
from statistics import median
from typing import Any

from bench.c_programs import our_program
from bench.cases import Case
from pne_sym.backends.bundle import Bundle
from pne_sym.model.effects import Actuator, Friction, Limits, Spring
from pne_sym.model.manipulator import Body, Joint, Manipulator
from pne_sym.model.reader import checked
from pne_sym.pipeline import compile_bundle
from pne_sym.program.count import count_function

RUNS = 15
LAW = Friction(200.0, 40.0, 1e-3)
ASKED = {"friction": LAW, "actuator": Actuator(1e-4, 1257.0)}
AT_ACTUATORS: dict[str, dict[str, Any]] = {
    "viscous friction": {"friction": Friction(200.0)},
    "Coulomb friction": {"friction": Friction(None, 40.0, 1e-3)},
    "spring": {"spring": Spring(2e3, 1.0)},
    "rotor inertia": {"actuator": Actuator(1e-4, 1257.0)},
    "limits of displacement, rate, effort": {"limits": Limits((-20.0, 20.0), 9.0, 1e4)},
    "viscous and Coulomb friction, rotor inertia": ASKED,
}
PAYLOAD = Body(4.0, (0.1, -0.05, 0.2), ((0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1)))


def with_all(plain: Manipulator, changes: dict[str, Any]) -> Manipulator:
    """The manipulator with changes at all actuated joints."""

    def changed(joint: Joint) -> Joint:
        return replace(joint, **changes) if joint.actuated else joint

    legs = (replace(leg, joints=tuple(map(changed, leg.joints))) for leg in plain.legs)
    return checked(replace(plain, legs=tuple(legs)))


def variants(plain: Manipulator) -> dict[str, Manipulator]:
    """What is added -> the manipulator with it."""
    found = {what: with_all(plain, changes) for what, changes in AT_ACTUATORS.items()}
    count = sum(joint.actuated for leg in plain.legs for joint in leg.joints)
    rows = tuple(tuple(float(i == j) for j in range(count)) for i in range(count))
    motors = with_all(plain, {"actuator": ASKED["actuator"]})
    found["rotor inertia, motors coupled"] = checked(replace(motors, coupling=rows))
    ends = (replace(e, platform_joint=replace(e.platform_joint, friction=LAW)) for e in plain.legs)
    found["friction in the platform joints"] = checked(replace(plain, legs=tuple(ends)))
    found["payload"] = checked(replace(plain, payload=PAYLOAD))
    found["moving base"] = checked(replace(plain, moving_base=True))
    return found


def operations(bundle: Bundle) -> int:
    """Of inverse dynamics, without the solution of the linear equations."""
    n = count_function(bundle.program.functions["required"], bundle.leg_counts)
    return n.mul + n.add + n.div + n.sqrt + n.trig


def counts(plain: Manipulator) -> dict[str, list[float]]:
    """Operations of inverse dynamics that each adds, and per cent."""
    before = operations(compile_bundle(plain))
    found = {}
    for what, spec in variants(plain).items():
        more = operations(compile_bundle(spec)) - before
        found[what] = [more, round(100.0 * more / before, 1)]
    return found


def time_ratios(plain: Manipulator) -> dict[str, list[float]]:
    """Time of inverse dynamics with friction and rotors over that without: median, least, most."""
    both = (plain, replace(with_all(plain, ASKED), name=f"{plain.name}_loaded"))
    cases = [Case(each.name, each) for each in both]
    for case in cases:
        case.generate()
    pair = [our_program(case) for case in cases]
    runs = [[each.run(check=False) for each in pair] for _ in range(RUNS)]
    found = {}
    for key, what in (("inverse_dynamics", "one state"), ("inverse_dynamics_batch", "batches")):
        ratios = [after[f"ours {key}"] / before[f"ours {key}"] for before, after in runs]
        found[what] = [round(r, 3) for r in (median(ratios), min(ratios), max(ratios))]
    return found
