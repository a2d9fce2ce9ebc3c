"""Public functions that tell how far a pose is from singularities."""

from __future__ import annotations

from pne_sym.derivation import Coordinates, Derivation, Role
from pne_sym.lowering.public_writer import Writer
from pne_sym.program.algorithm import Algorithm
from pne_sym.program.public import PublicFunction, Value

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
    a: Algorithm,
    matrices: list[Value],
    lengths: Value,
    length: Value | None,
    rows: tuple[int, ...],
) -> Value:
    """Singular values of matrices side by side, rows of moments divided by the length."""
    matrix = matrices[0] if len(matrices) == 1 else a.apply("beside", *matrices)
    return a.apply("singular_values", _scaled(a, matrix, lengths, length, rows))


def _scaled(
    a: Algorithm, matrix: Value, lengths: Value, length: Value | None, rows: tuple[int, ...]
) -> Value:
    """Rows of moments divided by the length, the model's own where none is given."""
    if not rows:
        return matrix
    if length is None:
        first = a.apply("entry", lengths, numbers=[0])
        length = a.apply("subtract", first, first)
    chosen = a.apply("choose_length", lengths, length)
    return a.apply("divide_rows", matrix, chosen, numbers=rows)


def conditioning_functions(w: Writer, rows: tuple[int, ...]) -> list[PublicFunction]:
    """How far a pose is from singularities, and numbers of what that tells."""
    found = [_condition(w, "condition", CONDITION, ["H"], rows)]
    if w.constrained:
        both = ["H", "Hk"]
        found.append(_condition(w, "condition_constrained", CONDITION_CONSTRAINED, both, rows))
    effective = w.c.actuation.force_rank
    if w.constrained:
        effective = w.c.actuation.rank - w.independent
    if effective and w.n["NU"]:  # else actuators move nothing
        found.append(_manipulability(w, rows, effective))
    return [*found, _singularity_distance(w, rows)]


def _manipulability(w: Writer, rows: tuple[int, ...], effective: int) -> PublicFunction:
    a = Algorithm()
    lengths, H, *constraints = a.run("condition", w.program, "lengths", "H", "Hk")
    H = _scaled(a, H, lengths, None, rows)
    if constraints:  # on the motions that are left
        held = a.apply("transposed", _scaled(a, constraints[0], lengths, None, rows))
        basis = a.apply("null_basis", held, numbers=[w.independent])
        H = a.apply("product", a.apply("transposed", basis), H)
    sigma = a.apply("singular_values", H)
    volume, isotropy = a.apply_all("spread", sigma, numbers=[min(effective, *H.shape)])
    return w.function(
        "manipulability",
        "Manipulability of forces: the product of the singular values that `condition` has by "
        "default, and the least over the largest of them.",
        "X",
        a,
        w.made(volume, "measure", "product of the singular values"),
        w.made(isotropy, "isotropy", "least over largest value, 1 where H is isotropic"),
        counted="condition",
        also="the singular values",
    )


def _singularity_distance(w: Writer, rows: tuple[int, ...]) -> PublicFunction:
    a = Algorithm()
    lengths, legs, *found = a.run("condition", w.program, "lengths", "pivots", "H", "Hk")
    sigma = scaled_values(a, found, lengths, None, rows)
    rank = min(w.c.actuation.rank if w.constrained else w.c.actuation.force_rank, sigma.size)
    _, distance = a.apply_all("spread", sigma, numbers=[rank])
    return w.function(
        "singularity_distance",
        "How near actuators and legs are to being singular: relative distances, 0 where they are.",
        "X",
        a,
        w.made(
            distance,
            "actuators",
            f"of {'[H Hk]' if w.constrained else 'H'} from matrices of lower rank, over its norm",
        ),
        w.made(a.apply("least_entry", legs), "legs", "least pivot of all legs"),
        counted="condition",
        also="the singular values",
    )


def _condition(
    w: Writer, name: str, meaning: str, matrices: list[str], rows: tuple[int, ...]
) -> PublicFunction:
    a = Algorithm()
    lengths, legs, *found = a.run("condition", w.program, "lengths", "pivots", *matrices)
    sigma = scaled_values(a, found, lengths, w.given("length").value, rows)
    size = str(sigma.shape[0])
    return w.function(
        name,
        meaning,
        "X length",
        a,
        w.made(sigma, "sigma", "singular values, in descending order", size),
        w.made(legs, "legs", "least pivots; a leg is refused at 1.5e-8", str(legs.size)),
        counted="condition",
        also="the singular values",
        gives_status=True,
    )
