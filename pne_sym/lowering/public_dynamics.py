"""What solves the equations of motion, and what is made of the solution.

Reference: inverse dynamics Eq. 3, equations of motion Eqs. 5 to 7, constraints Eqs. 36, 37.
"""

from __future__ import annotations

from pne_sym.lowering.public_forces import (
    force_of_motion,
    force_outputs,
    multipliers,
    needed_force,
    required_forces,
    resolved,
)
from pne_sym.lowering.public_writer import Writer
from pne_sym.program.algorithm import Algorithm
from pne_sym.program.public import PublicFunction, Value


def dynamics_functions(w: Writer) -> list[PublicFunction]:
    """What solves the equations of motion, and what is made of the solution."""
    found = [
        _inverse_dynamics(w),
        _forward_dynamics(w),
        _complete_acceleration(w),
        _leg_reactions(w),
        _energy(w),
    ]
    return [*found, _null_space(w)] if w.n["NU"] else found


def _inverse_dynamics(w: Writer) -> PublicFunction:
    a = Algorithm()
    needed, actuators = needed_force(w, a)
    outputs = force_outputs(w, *required_forces(w, a, needed, actuators, weighted=True))
    return w.function(
        "inverse_dynamics",
        "Actuator forces tau for the acceleration A, by Eq. 3.",
        "X V A wrench weights",
        a,
        *outputs,
        counted="required",
        also="the solution of the linear equations",
    )


def _forward_dynamics(w: Writer) -> PublicFunction:
    a = Algorithm()
    names = ("M", "Z", "H", "Hk", "constraint_bias")
    M, Z, H, *constraint = a.run("dynamics", w.program, *names)
    force = a.apply("times", H, w.given("tau").value)
    force = a.apply("subtract", a.apply("add", force, w.external(a)), Z)
    if constraint and w.c.overconstrained:
        A, lam = _least_held(w, a, M, force, H, constraint)
        outputs = [multipliers(w, lam)]
    elif constraint:
        Hk, bias = constraint
        right = a.apply("join", force, a.apply("negative", bias))
        both = a.apply("solve", a.apply("saddle", M, Hk), right)
        A, lam = a.apply_all("split", both, numbers=[w.n["NV"]])
        outputs = [multipliers(w, lam)]
    else:
        A, outputs = a.apply("solve", M, force), []
    return w.function(
        "forward_dynamics",
        "Acceleration A under the actuator forces tau and the wrench.",
        "X V tau wrench",
        a,
        w.made(A, "A", "acceleration", "NV"),
        *outputs,
        counted="dynamics",
        also="the solution of the linear equations",
    )


def _least_held(
    w: Writer, a: Algorithm, M: Value, force: Value, H: Value, constraint: list[Value]
) -> tuple[Value, Value]:
    """Acceleration under constraints of which some follow from others, and the least lambda."""
    Hk, bias = constraint
    rows = a.apply("transposed", Hk)
    some, _ = a.apply_all("resolve", rows, rows, numbers=[w.independent])
    own = a.apply("transposed", a.apply("product", some, rows))
    right = a.apply("join", force, a.apply("negative", a.apply("times", some, bias)))
    both = a.apply("solve", a.apply("saddle", M, own), right)
    A, amounts = a.apply_all("split", both, numbers=[w.n["NV"]])
    left, _ = resolved(w, a, H, Hk)
    wanted = a.apply("times", left, a.apply("times", own, amounts))
    return A, a.apply("least_norm", a.apply("product", left, Hk), wanted)


def _complete_acceleration(w: Writer) -> PublicFunction:
    facts, a = w.c.actuation, Algorithm()
    A = w.given("A").value
    if not facts.is_determined and facts.passive:
        done = a.apply("impossible", A, numbers=[w.n["NV"]])
    elif facts.idle == 0 or not (facts.completes and facts.is_determined):
        done = a.apply("same", A)
    else:
        done = _completed(w, a, A)
    return w.function(
        "complete_acceleration",
        "A with the entries of passive extra coordinates that the others allow.",
        "X V A wrench",
        a,
        w.made(done, "completed", "acceleration", "NV"),
    )


def _completed(w: Writer, a: Algorithm, A: Value) -> Value:
    facts = w.c.actuation
    unique = facts.idle == len(facts.passive)
    known = a.apply("clear_at", A, numbers=facts.passive) if unique else A
    M, needed, actuators = force_of_motion(w, a, known)
    columns = a.apply("take_columns", M, numbers=facts.passive)
    own = a.apply("take", columns, numbers=facts.passive)
    if facts.is_coupled:
        system = a.apply("beside", *actuators) if w.constrained else actuators[0]
        _, idle = a.apply_all("resolve", system, system, numbers=[facts.rank])
        effect, residual = a.apply("product", idle, columns), a.apply("times", idle, needed)
    else:
        effect, residual = own, a.apply("take", needed, numbers=facts.passive)
    if unique:
        change = a.apply("solve", effect, a.apply("negative", residual))
    else:  # least change in the metric of M
        zero = a.apply("extend", a.apply("take", A, numbers=[]), numbers=[len(facts.passive)])
        system = a.apply("saddle", own, a.apply("transposed", effect))
        both = a.apply("solve", system, a.apply("join", zero, a.apply("negative", residual)))
        change, _ = a.apply_all("split", both, numbers=[len(facts.passive)])
    return a.apply("add_at", known, change, numbers=facts.passive)


def _leg_reactions(w: Writer) -> PublicFunction:
    a = Algorithm()
    values = a.run_all("required", w.program)
    actuators = [values[name] for name in ("H", "Hk") if name in values]
    needed = a.apply("subtract", values["required"], w.external(a))
    tau, *lam = required_forces(w, a, needed, actuators)
    efforts = [a.without_rotors(w.program, tau, values), *lam]
    found = a.run_all("legs", w.program)
    forces = found["leg_force"]
    legs = {
        "actuator": [leg for leg, _ in w.c.actuators],
        "constraint_direction": w.c.constraints,
    }
    for effort, (array, owners) in zip(efforts, legs.items(), strict=False):
        forces = a.apply("add_forces", forces, effort, found[array], numbers=owners)
    kind = "Force and moment" if w.c.transmits_moments else "Force"
    return w.function(
        "leg_reactions",
        f"{kind} of each leg on the platform at its platform joint, base axes.",
        "X V A wrench",
        a,
        w.made(forces, "forces", "leg on platform [N, N m]", *map(str, forces.shape)),
        counted="legs",
        also="inverse dynamics",
    )


def _energy(w: Writer) -> PublicFunction:
    a = Algorithm()
    (M,) = a.run("M", w.program, "M")
    (potential,) = a.run("potential", w.program, "potential")
    kinetic = a.apply("half_form", w.given("V").value, M)
    return w.function(
        "energy",
        "Kinetic and potential energy [J]; the latter is zero at the base origin.",
        "X V",
        a,
        w.made(kinetic, "kinetic", "kinetic energy [J]"),
        w.made(a.apply("entry", potential, numbers=[0]), "potential", "potential energy [J]"),
    )


def _null_space(w: Writer) -> PublicFunction:
    a = Algorithm()
    (H,) = a.run("H", w.program, "H")
    basis = a.apply("null_basis", H, numbers=[w.c.actuation.force_rank])
    return w.function(
        "null_space",
        "Orthonormal basis of the tau with H tau = 0.",
        "X",
        a,
        w.made(basis, "basis", "columns", "NU", str(basis.shape[1])),
    )
