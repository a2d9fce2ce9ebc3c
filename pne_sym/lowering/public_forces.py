"""Forces that a required one asks for: of actuators, and of constraints."""

from __future__ import annotations

from collections.abc import Callable

from pne_sym.lowering.public_writer import Writer
from pne_sym.program.algorithm import Algorithm
from pne_sym.program.public import Argument, Value


def needed_force(w: Writer, a: Algorithm) -> tuple[Value, list[Value]]:
    """The force that the acceleration A takes beside the wrench; H and, if there is one, Hk."""
    required, *actuators = a.run("required", w.program, "required", "H", "Hk")
    return a.apply("subtract", required, w.external(a)), actuators


def force_of_motion(w: Writer, a: Algorithm, A: Value) -> tuple[Value, Value, list[Value]]:
    """M; M A + Z less the wrench; H and, if there is one, Hk."""
    M, Z, *actuators = a.run("dynamics", w.program, "M", "Z", "H", "Hk")
    needed = a.apply("add", a.apply("times", M, A), Z)
    return M, a.apply("subtract", needed, w.external(a)), actuators


def required_forces(
    w: Writer,
    a: Algorithm,
    required: Value,
    actuators: list[Value],
    *,
    weighted: bool = False,
    choose: Callable[[Value, Value], Value] | None = None,
) -> tuple[Value, ...]:
    """tau, and lambda where there are constraints, with H tau + Hk lambda = required.

    Where actuators are redundant, tau is of least norm, or what `choose` makes of that and the
    matrix that takes all tau with the same effect to the same vector.
    """
    facts = w.c.actuation
    if not facts.is_determined:
        sizes = ("NU", "NC") if w.constrained else ("NU",)
        return tuple(a.apply("impossible", required, numbers=[w.n[k]]) for k in sizes)
    H, Hk, f = _solved(w, a, required, actuators)
    if _is_square(w, H):
        return _unique(w, a, H, Hk, f)
    left = across = None
    if Hk is not None:
        left, across = resolved(w, a, H, Hk)
    tau, matrix = _least(w, a, H, f, across, weighted=weighted)
    tau = choose(tau, matrix) if choose else tau
    if Hk is None or left is None:
        return (tau,)
    rest = a.apply("subtract", f, a.apply("times", H, tau))
    system = a.apply("product", left, Hk)
    how = "least_norm" if w.c.overconstrained else "solve"
    return tau, a.apply(how, system, a.apply("times", left, rest))


def shared_forces(
    w: Writer, a: Algorithm, required: Value, actuators: list[Value]
) -> tuple[Value, Value]:
    """tau of least norm, and the matrix that takes all tau with its effect to one vector."""
    H, Hk, f = _solved(w, a, required, actuators)
    if _is_square(w, H):
        return _unique(w, a, H, Hk, f)[0], H
    across = resolved(w, a, H, Hk)[1] if Hk else None
    return _least(w, a, H, f, across, weighted=False)


def resolved(w: Writer, a: Algorithm, H: Value, Hk: Value) -> tuple[Value, ...]:
    """Combinations of equations that resolve constraint forces, and that know none of them."""
    both = a.apply("beside", H, Hk) if w.n["NU"] else Hk
    return a.apply_all("resolve", Hk, both, numbers=[w.independent])


def _solved(
    w: Writer, a: Algorithm, f: Value, actuators: list[Value]
) -> tuple[Value, Value | None, Value]:
    """H, Hk and the required force in the rows from which forces are found."""
    facts = w.c.actuation
    H, Hk = actuators[0], actuators[1] if w.constrained else None
    if facts.surplus:
        return _attainable(w, a, H, Hk, f)
    if facts.solved != w.every:
        H, f = (a.apply("take", v, numbers=facts.solved) for v in (H, f))
        Hk = a.apply("take", Hk, numbers=facts.solved) if Hk else None
    return H, Hk, f


def _is_square(w: Writer, H: Value) -> bool:
    """Whether forces are unique."""
    return w.n["NU"] + w.n["NC"] == H.shape[0] and not w.c.overconstrained


def _unique(w: Writer, a: Algorithm, H: Value, Hk: Value | None, f: Value) -> tuple[Value, ...]:
    if Hk is None:
        return (a.apply("solve", H, f),)
    both = a.apply("solve", a.apply("beside", H, Hk), f)
    return a.apply_all("split", both, numbers=[w.n["NU"]])


def _least(
    w: Writer, a: Algorithm, H: Value, f: Value, across: Value | None, *, weighted: bool
) -> tuple[Value, Value]:
    """tau of least (weighted) norm, on rows that constraints do not act on; its matrix."""
    scale = a.apply("inverse_root", w.given("weights").value) if weighted else None
    matrix = a.apply("scale_columns", H, scale) if scale else H
    if across:
        matrix, f = a.apply("product", across, matrix), a.apply("times", across, f)
    least = a.apply("least_norm", matrix, f)
    return a.apply("multiply", scale, least) if scale else least, matrix


def _attainable(
    w: Writer, a: Algorithm, H: Value, Hk: Value | None, f: Value
) -> tuple[Value, Value | None, Value]:
    """Combinations of rows that resolve the actuators, and the force nearest to their range."""
    facts = w.c.actuation
    actuators = a.apply("beside", H, Hk) if Hk else H
    rows, idle = a.apply_all("resolve", actuators, actuators, numbers=[facts.rank])
    residual = a.apply("negative", a.apply("times", idle, f))
    effect = a.apply("take_columns", idle, numbers=facts.passive)
    change = a.apply("least_norm", effect, residual)
    f = a.apply("add_at", f, change, numbers=facts.passive)
    Hk = a.apply("product", rows, Hk) if Hk else None
    return a.apply("product", rows, H), Hk, a.apply("times", rows, f)


def force_outputs(w: Writer, tau: Value, *rest: Value) -> list[Argument]:
    """The outputs tau and lambda."""
    found = [w.made(tau, "tau", "actuator forces [N or N m]", "NU")]
    return found + [multipliers(w, v) for v in rest]


def multipliers(w: Writer, value: Value) -> Argument:
    """The output lambda."""
    meaning = "constraint forces [N or N m]"
    if w.c.overconstrained:
        meaning += f", of least norm: {w.c.overconstrained} of the constraints follow from others"
    return w.made(value, "lambda", meaning, "NC")
