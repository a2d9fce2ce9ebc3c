"""Public functions that tell how far a pose is from singularities."""

from __future__ import annotations

from pne_sym.derivation import Coordinates, Derivation, Role
from pne_sym.program.algorithm import Algorithm
from pne_sym.program.public import Value

CONDITION = (
    "How far a pose is from singularities: singular values of H, rows of moments divided by a "
    "length; for every leg the least tested pivot as a fraction of its scale."
)
CONDITION_CONSTRAINED = (
    "The same with the singular values of [H Hk], which inverse dynamics solves."
)


def moment_rows(derivation: Derivation, c: Coordinates) -> tuple[int, ...]:
    """Rows of H and Hk that are moments: of rotations, and of extra joints that turn."""
    angles = {
        (q.leg_type, q.joint)
        for q in derivation.leg_state()
        if q.role is Role.DISPLACEMENT and q.unit == "rad"
    }
    type_of = {leg: t.name for t in derivation.leg_types for leg in t.indices}
    turning = [k for k, component in enumerate(c.components) if component >= 3]
    extras = enumerate(c.extras, len(c.rates))
    return (*turning, *(k for k, (leg, j) in extras if (type_of[leg], j + 1) in angles))


def scaled_values(
    a: Algorithm, matrices: list[Value], lengths: Value, length: Value, rows: tuple[int, ...]
) -> Value:
    """Singular values of matrices side by side, rows of moments divided by the length."""
    matrix = matrices[0] if len(matrices) == 1 else a.apply("beside", *matrices)
    if rows:
        matrix = a.apply(
            "divide_rows", matrix, a.apply("choose_length", lengths, length), numbers=rows
        )
    return a.apply("singular_values", matrix)
