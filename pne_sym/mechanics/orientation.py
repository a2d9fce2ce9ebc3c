"""On which side of its singular states a leg is whose displacements are iterated.

The Jacobian of its loop closure by these displacements is square, or rows of it are chosen that
make it so.  Its determinant keeps its sign as long as the leg meets no singular state: two
closures of one pose that have different signs are different assembly branches.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from pne_sym.mechanics.completion import Kind, best_conditioned, leg_states
from pne_sym.mechanics.leg_geometry import LegGeometry
from pne_sym.model.kinematics import Array
from pne_sym.model.manipulator import Manipulator

_SAME = 1e-6  # directions nearer than this to a space are in it


def orientation_rows(
    manipulator: Manipulator, g: LegGeometry, *, planar: bool, completed: bool
) -> tuple[int, ...]:
    """Rows of the closure's Jacobian whose determinant tells home's branch.

    All, where there are as many as displacements.  Where there are more, those that the auxiliary
    directions of the completion leave: there the model itself is singular where the determinant
    vanishes.  Without such, the best conditioned ones, if the leg's degrees of freedom span the
    same directions of its last link at every pose; else none: its singular states do not separate.

    Args:
        manipulator: the manipulator.
        g: the leg type.
        planar: conditions are taken in the plane.
        completed: auxiliary directions complete the leg's degrees of freedom.
    """
    joints = sum(not g.is_extra(j) for j in range(1, g.count + 1))
    rows = tuple(range((2 if planar else 3) + len(g.pairs)))
    if joints == len(rows):
        return rows
    if completed and all(a.kind is not Kind.TURN for a in g.completion):
        taken = {a.number if a.kind is Kind.SLIDE else 3 + a.number for a in g.completion}
        return tuple(k for k in rows if k not in taken)
    legs = [[s.dofs for s in leg_states(manipulator, g, k)] for k in range(g.leg_type.count)]
    if not all(_is_same_span(found) for found in legs):
        return ()
    return best_conditioned(
        combinations(rows, joints), lambda choice: (found[0][list(choice)] for found in legs)
    )


def orientation_signs(
    manipulator: Manipulator, g: LegGeometry, rows: tuple[int, ...]
) -> tuple[int, ...]:
    """Sign of the determinant of these rows at home, for every leg of the type."""
    homes = (next(leg_states(manipulator, g, k)).dofs for k in range(g.leg_type.count))
    return tuple(1 if np.linalg.det(home[list(rows)]) > 0.0 else -1 for home in homes)


def _is_same_span(states: list[Array]) -> bool:
    """Whether the columns span the same space at all states."""
    basis = np.linalg.qr(states[0])[0]
    return all(np.abs(s - basis @ (basis.T @ s)).max(initial=0.0) < _SAME for s in states)
