"""Motors of the actuated joints: rates and ratios, and how they are coupled to several joints.

Coupled motors turn with C times the displacements q of the actuated joints, before their gears, so
that tau = C^T (n motor torque) by power.  Their rotors are felt by the platform through the
columns of H C^T: H C^T J C H^T is added to M, with J the inertias n^2 I.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from pne_sym.derivation import Book, Law, Output, Rule
from pne_sym.mechanics.joint_forces import Motor
from pne_sym.mechanics.legs import Leg
from pne_sym.mechanics.live import note, of_all
from pne_sym.mechanics.placing import Placer, actuated
from pne_sym.model.manipulator import Manipulator
from pne_sym.vector.arrays import (
    Applied,
    Relation,
    product,
    scale_columns,
    scale_rows,
    solution,
    times,
    transposed,
)

_DIRECT = Motor()


def write_motors(book: Book, manipulator: Manipulator, legs: list[Leg]) -> None:
    """What functions need of motors, where there are motors or couplings.

    An actuated joint without data of its motor is driven directly.
    """
    has_motors = any(leg.dynamics.forces.motors for leg in legs)
    coupling = manipulator.coupling
    if coupling is not None:
        _matrix(book, coupling)
        book.relations += _relations(has_motors=has_motors)
    if not has_motors and coupling is None:
        return
    for leg, j, rows in Placer.numbered(legs, actuated):
        arrays = _coupled(leg, j) if coupling is not None else _alone(leg, j)
        if not has_motors:
            arrays = {name: arrays[name] for name in ("actuated_rates", "ratios", "per_turn")}
        book.outputs += [
            Output(array, value, ((0, 0),), (), leg.name, rows)
            for array, value in arrays.items()
            if value != 0
        ]


def _alone(leg: Leg, j: int) -> dict[str, Any]:
    """Of the motor of joint j alone."""
    motor = leg.dynamics.forces.motors.get(j, _DIRECT)
    rate = leg.motion.qd[j] if motor.rate is None else motor.rate
    return {"motor_rates": rate, "per_turn": motor.per_turn}


def _coupled(leg: Leg, j: int) -> dict[str, Any]:
    """Of actuated joint j, with which several motors turn, and of the motor in its place.

    A rotor's inertia is given by its root: with it M comes out symmetric.
    """
    motor, motion = leg.dynamics.forces.motors.get(j, _DIRECT), leg.motion
    form = motion.collection.form(motion.qdd[j])
    return {
        "actuated_rates": motion.qd[j],
        "actuated_accelerations": motion.qdd[j],
        "actuated_bias": form.remainder,
        "rotor_roots": sp.sqrt(motor.felt),
        "ratios": motor.ratio,
        "per_turn": motor.per_turn,
    }


def _relations(*, has_motors: bool) -> list[Relation]:
    """What coupled motors do, as relations between arrays of all legs."""

    def load(motion: str) -> Applied:
        """Torques of the rotors over the roots of their inertias."""
        return scale_rows("rotor_roots", times("coupling", motion))

    columns, of_joints = "rotor_columns", transposed("coupling")
    turning = scale_rows("ratios", times("coupling", "actuated_rates"))
    torques = scale_rows("per_turn", solution(of_joints, "tau"))
    rows = [
        ("motor_rates", "gear ratios times the coupling times rates of the joints", turning),
        ("motor_torques", "torques of the motors that give the actuator forces", torques),
    ]
    if has_motors:
        taken = times(of_joints, scale_rows("rotor_roots", load("actuated_accelerations")))
        scaled = scale_columns(product("H", of_joints), "rotor_roots")
        felt = "coupled rotors in the required force"
        rows += [
            (columns, "what the motors do to the platform, by roots of felt inertias", scaled),
            (
                "M_rotors",
                "coupled rotors in the mass matrix",
                product(columns, transposed(columns)),
            ),
            ("Z_rotors", f"{felt} at zero acceleration", times(columns, load("actuated_bias"))),
            ("required_rotors", felt, times(columns, load("actuated_accelerations"))),
            ("tau_rotors", "what coupled rotors take of the actuator forces", taken),
        ]
    return [Relation(*row, Law.COUPLING) for row in rows]


def _matrix(book: Book, coupling: Any) -> None:
    """The matrix as a live parameter."""
    count = len(coupling)
    meaning = "angle of each motor, before its gear, per displacement of every actuated joint"
    symbols = of_all(book, "coupling", "coupling", coupling, "-", meaning, rule=Rule.INVERTIBLE)
    for k, symbol in enumerate(symbols):
        row, column = divmod(k, count)
        note(book, symbol, rf"\mathcal K_{{{row + 1},{column + 1}}}", meaning)
        book.outputs.append(Output("coupling", symbol, ((0, row),), ((0, column),)))
