"""What functions give of a leg: displacements, rates, forces, its loop closure."""

from __future__ import annotations

from typing import Any

from pne_sym.derivation import Book, Output
from pne_sym.mechanics.leg_displacements import InverseKinematics
from pne_sym.mechanics.legs import Leg
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.model.kinematics import TaskSpace, slices_of
from pne_sym.model.manipulator import Manipulator
from pne_sym.vector import Dot, ZeroVector

_TERMS = glossary(r"""
residual | \mathbf S_r | LOOP_CLOSURE @tip
    from the connection point as the links reach it to the platform's
""")


def joint_outputs(
    book: Book, manipulator: Manipulator, leg: Leg, inverse: InverseKinematics
) -> None:
    """Displacements, rates and accelerations of the joints; the leg's force."""
    slices, indices = slices_of(manipulator.legs), leg.g.leg_type.indices
    for j in range(1, leg.g.count + 1):
        rows = tuple(slices[i].start + j - 1 for i in indices)
        values = {"q": inverse.q.get(j), "qd": leg.motion.qd[j], "qdd": leg.motion.qdd[j]}
        for array, value in values.items():
            if value is not None:
                book.outputs.append(Output(array, value, ((0, 0),), (), leg.name, rows))
    for first_row, vector in ((0, leg.dynamics.true_force), (3, leg.dynamics.moment)):
        if not first_row or vector != ZeroVector:
            columns = tuple((c, c + first_row) for c in range(3))
            book.outputs.append(
                Output("leg_force", vector, ((0, 0),), columns, leg.name, tuple(indices))
            )


def closure_outputs(book: Book, leg: Leg, frame: str, space: TaskSpace) -> None:
    """Misfit of the loop closure and its derivative by the joint displacements."""
    g, motion, name = leg.g, leg.motion, leg.name
    residual = Writer(book, g, _TERMS)("residual", motion.residual)
    joints = [j for j in range(1, g.count + 1) if not g.is_extra(j)]
    axes = range(2 if space.planar else 3)
    rows = tuple(range(g.leg_type.count))
    width = len(joints)

    def put(array: str, value: Any, columns: tuple[tuple[int, int], ...]) -> None:
        book.outputs.append(Output(array, value, ((0, 0),), columns, name, rows, frame=frame))

    put(f"residual_{name}", residual, tuple((c, c) for c in axes))
    for k, j in enumerate(joints):
        put(f"jacobian_{name}", motion.v[j], tuple((c, c * width + k) for c in axes))
    for i, ((link, platform), n) in enumerate(zip(g.pairs, motion.n, strict=True), len(axes)):
        put(f"residual_{name}", -Dot(link, platform), ((0, i),))
        for k, j in enumerate(joints):
            if g.turns(j):
                put(f"jacobian_{name}", Dot(g.spin(j), n), ((0, i * width + k),))
