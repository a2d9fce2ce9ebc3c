"""Public functions about actuators, motors and power, as steps."""

from __future__ import annotations

from pne_sym.lowering.public_writer import Writer
from pne_sym.program.algorithm import Algorithm
from pne_sym.program.public import PublicFunction, Value


def actuator_functions(w: Writer) -> list[PublicFunction]:
    """Where actuators stand, what they do, what friction takes."""
    found = [_dissipation(w), _momentum(w), *_limits(w)]
    if not w.n["NU"]:
        return found
    found += [_of_joints(w, *row) for row in _ROWS] + [_power(w)]
    return found + (_motors(w) if "motors" in w.program.functions else [])


_ROWS = (
    ("actuator_positions", "Displacements", "X", "inverse_kinematics", "q", "m or rad"),
    ("actuator_rates", "Rates", "X V", "joint_rates", "qd", "m/s or rad/s"),
    (
        "actuator_accelerations",
        "Accelerations",
        "X V A",
        "joint_accelerations",
        "qdd",
        "m/s^2 or rad/s^2",
    ),
)


def _of_joints(
    w: Writer, name: str, what: str, inputs: str, function: str, array: str, unit: str
) -> PublicFunction:
    a = Algorithm()
    (joints,) = a.run(function, w.program, array)
    own = a.apply("take", joints, numbers=[w.c.joints.index(j) for j in w.c.actuators])
    meaning = f"{what} of the actuated joints, in the order of tau."
    out = w.made(own, array, f"{what.lower()} of the actuated joints [{unit}]", "NU")
    return w.function(name, meaning, inputs, a, out, group="actuators", counted=function)


def _power(w: Writer) -> PublicFunction:
    a = Algorithm()
    (H,) = a.run("H", w.program, "H")
    force = a.apply("times", H, w.given("tau").value)
    power = a.apply("dot", force, w.given("V").value)
    out = w.made(power, "power", "power of the actuators [W]")
    meaning = "Power that actuators give to the mechanism: tau times their rates."
    return w.function("power", meaning, "X V tau", a, out, group="actuators")


def _dissipation(w: Writer) -> PublicFunction:
    a = Algorithm()
    if "dissipation" in w.program.functions:
        (power,) = a.run("dissipation", w.program, "dissipation")
    else:
        V = w.given("V").value
        power = a.apply("subtract", V, V)  # nothing, of any motion
    out = w.made(
        a.apply("entry", power, numbers=[0]), "dissipation", "power that friction takes [W]"
    )
    meaning = "Power that friction takes, not negative; the rate of energy is power less this."
    return w.function("dissipation", meaning, "X V", a, out, group="actuators")


def _limits(w: Writer) -> list[PublicFunction]:
    """Margins of the joints, and whether all of them are kept; what has no limits is infinite."""
    limited = "joint_margins" in w.program.functions
    function, array = ("joint_margins", "margins") if limited else ("inverse_kinematics", "q")
    margins, within = Algorithm(), Algorithm()
    free = [k for k, j in enumerate(w.c.joints) if j not in w.c.limited]
    (distances,) = margins.run(function, w.program, array)
    made = margins.apply("unlimited", distances, numbers=free) if free else distances
    (distances,) = within.run(function, w.program, array)
    if not limited:
        distances = within.apply("subtract", distances, distances)
    holds = within.apply("not_negative", distances)
    counted = {"group": "kinematics", "counted": function}
    return [
        w.function(
            "joint_margins",
            "How far the joints are from the nearer limit of displacement, negative beyond it; "
            "infinite where there is none.",
            "X",
            margins,
            w.made(made, "margins", "distances, in the order of q [m or rad]", "NJ"),
            unbounded=bool(free),
            **counted,
        ),
        w.function(
            "within_limits",
            "Whether all joints are within their limits of displacement.",
            "X",
            within,
            w.made(holds, "within", "1 where no margin is negative, else 0; NaN is neither"),
            **counted,
        ),
    ]


def _momentum(w: Writer) -> PublicFunction:
    a = Algorithm()
    (M,) = a.run("M", w.program, "M")
    out = w.made(
        a.apply("times", M, w.given("V").value), "momentum", "M V [kg m/s, kg m^2/s]", "NV"
    )
    meaning = "Generalised momentum M V."
    return w.function("momentum", meaning, "X V", a, out, counted="M")


def _motors(w: Writer) -> list[PublicFunction]:
    rates, torques = Algorithm(), Algorithm()
    coupled = "coupling" in w.program.shapes
    if coupled:
        turning = _related(w, rates, "motor_rates")
        torque = _related(w, torques, "motor_torques")
    else:
        (turning,) = rates.run("motors", w.program, "motor_rates")
        (per_turn,) = torques.run("motors", w.program, "per_turn")
        torque = torques.apply("multiply", per_turn, w.given("tau").value)
    along = "the coupling times rates of the joints" if coupled else "rate"
    given = "the inverse of the coupling, transposed, times tau" if coupled else "tau"
    return [
        w.function(
            "motor_rates",
            f"Rates of the motors: gear ratio times {along}, in the order of tau.",
            "X V",
            rates,
            w.made(turning, "motor_rates", "of the motors [rad/s]", "NU"),
            group="actuators",
        ),
        w.function(
            "motor_torques",
            f"Torques of the motors that give tau: {given} over the gear ratio, rotors included.",
            "X V A tau",
            torques,
            w.made(torque, "motor_torques", "of the motors [N m]", "NU"),
            group="actuators",
        ),
    ]


def _related(w: Writer, a: Algorithm, id_: str) -> Value:
    """What a relation between arrays of coupled motors defines."""
    values = {"tau": w.given("tau").value, **a.run_all("motors", w.program)}
    return a.relate(w.program, id_, values)
