"""The public functions of a derivation, as steps over the functions of its program."""

from __future__ import annotations

from pne_sym.derivation import Derivation
from pne_sym.lowering.public_actuators import actuator_functions
from pne_sym.lowering.public_bounds import bounded_functions
from pne_sym.lowering.public_condition import conditioning_functions, moment_rows
from pne_sym.lowering.public_dynamics import dynamics_functions
from pne_sym.lowering.public_notes import with_notes
from pne_sym.lowering.public_pose import displacement_functions, pose_functions
from pne_sym.lowering.public_searches import searching_functions
from pne_sym.lowering.public_writer import Writer
from pne_sym.program.algorithm import Algorithm
from pne_sym.program.ir import Program
from pne_sym.program.public import PublicFunction, verify_steps, with_readable_names


def public_functions(derivation: Derivation, program: Program) -> tuple[PublicFunction, ...]:
    """All functions that users call, each after those that it uses.

    Raises:
        StepError: a function that does not hold together.
    """
    coordinates = derivation.coordinates
    assert coordinates is not None
    guessed = any(not t.is_closed for t in derivation.leg_types)
    writer = Writer(coordinates, program, guessed=guessed)
    rows = moment_rows(derivation, coordinates)
    found = (
        *program_functions(writer),
        *dynamics_functions(writer),
        *conditioning_functions(writer, rows),
        *bounded_functions(writer),
        *searching_functions(writer),
        *actuator_functions(writer),
        *pose_functions(coordinates),
        *displacement_functions(coordinates),
    )
    arrays = {f.name: f.arrays for f in program.functions.values()}
    found = tuple(with_readable_names(f, arrays) for f in found)
    for function in found:
        verify_steps(function)
    return tuple(with_notes(function, coordinates, guessed=guessed) for function in found)


def program_functions(w: Writer) -> list[PublicFunction]:
    """What the program computes as it is."""
    rows = (
        ("M", "Inertia matrix M.", "X", "M", ("NV", "NV"), "dynamics"),
        ("Z", "Velocity and gravity terms Z.", "X V", "Z", ("NV",), "dynamics"),
        ("H", "Force transformation H: actuators to task space.", "X", "H", ("NV", "NU"),
         "dynamics"),
        ("Hk", "Directions Hk of the constraint forces lambda (Eq. 36).", "X", "Hk",
         ("NV", "NC"), "constraints"),
        ("constraints",
         "Residuals of the constraints [m, or 1 for angles]; zero on closed loops (Eq. 37).",
         "X", "constraints", ("NC",), "constraints"),
        ("constraint_bias", "The vector bias in Hk^T A + bias = 0.", "X V",
         "constraint_bias", ("NC",), "constraints"),
        ("inverse_kinematics", "Displacements q of all joints.", "X", "q", ("NJ",),
         "kinematics"),
        ("joint_rates", "Rates of all joints.", "X V", "qd", ("NJ",), "kinematics"),
        ("joint_accelerations", "Accelerations of all joints.", "X V A", "qdd", ("NJ",),
         "kinematics"),
    )  # fmt: skip
    found = []
    for name, meaning, inputs, array, dimensions, group in rows:
        if name in w.program.functions:
            a = Algorithm()
            (value,) = a.run(name, w.program, array)
            words = meaning[0].lower() + meaning[1:].rstrip(".")
            out = w.made(value, array, words, *dimensions)
            found.append(w.function(name, meaning, inputs, a, out, group=group, counted=name))
    a = Algorithm()
    M, Z, H = a.run("dynamics", w.program, "M", "Z", "H")
    outputs = (
        w.made(M, "M", "inertia matrix", "NV", "NV"),
        w.made(Z, "Z", "velocity and gravity terms", "NV"),
        w.made(H, "H", "force transformation", "NV", "NU"),
    )
    meaning = "M, Z and H together, sharing the work."
    found.append(w.function("dynamics", meaning, "X V", a, *outputs, counted="dynamics"))
    return found
