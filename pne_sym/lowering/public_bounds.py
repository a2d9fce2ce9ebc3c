"""Public functions about forces within bounds: what is reachable, and how redundant ones share."""

from __future__ import annotations

from pne_sym.lowering.public_forces import (
    force_of_motion,
    force_outputs,
    needed_force,
    required_forces,
    shared_forces,
)
from pne_sym.lowering.public_writer import Writer
from pne_sym.program.algorithm import Algorithm
from pne_sym.program.public import PublicFunction, Value


def bounded_functions(w: Writer) -> list[PublicFunction]:
    """Where actuators have limits, what they reach; where they are redundant, forces in bounds."""
    found = []
    if w.c.actuation.is_determined and w.c.bounded:
        found += [_reachable_wrench(w), _reachable_acceleration(w)]
    return [*found, _force_distribution(w)] if w.redundancy else found


def _reachable_wrench(w: Writer) -> PublicFunction:
    a = Algorithm()
    needed, actuators = needed_force(w, a)
    way = a.apply("extend", w.given("wrench_direction").value, numbers=[w.n["NV"]])
    more = a.apply("negative", way)
    return _reachable(w, a, "wrench", (needed, more, actuators))


def _reachable_acceleration(w: Writer) -> PublicFunction:
    a = Algorithm()
    M, needed, actuators = force_of_motion(w, a, w.given("A").value)
    more = a.apply("times", M, w.given("direction").value)
    return _reachable(w, a, "acceleration", (needed, more, actuators))


def _reachable(
    w: Writer, a: Algorithm, what: str, equation: tuple[Value, Value, list[Value]]
) -> PublicFunction:
    """The factors s at which H tau = needed + s more has forces within the limits."""
    needed, more, actuators = equation
    own = [k for k, joint in enumerate(w.c.actuators) if joint in w.c.bounded]

    def limited(value: Value) -> Value:
        return a.apply("take", value, numbers=own) if len(own) < w.n["NU"] else value

    (start, _), (way, matrix) = (shared_forces(w, a, f, actuators) for f in (needed, more))
    (limits,) = a.run("effort_limits", w.program, "effort_limits")
    operands = [limited(start), limited(way)]
    if w.redundancy:
        basis = a.apply("null_basis", matrix, numbers=[matrix.shape[0]])
        rows = limited(basis)
        operands.append(a.apply("product", rows, a.apply("transposed", rows)))
    name = "factors_of_some" if w.redundancy else "factors_within"
    least, largest = a.apply_all(name, *operands, limited(limits))
    direction = "wrench_direction" if what == "wrench" else "direction"
    kinds = {"wrench": "wrenches wrench", "acceleration": "accelerations A"}
    return w.function(
        f"reachable_{what}",
        f"Which {kinds[what]} + s {direction}, s >= 0, actuators reach within limits of effort.",
        f"X V A {direction} wrench",
        a,
        w.made(least, "least", "the least s"),
        w.made(largest, "largest", "the largest s"),
        unbounded=True,
    )


def _force_distribution(w: Writer) -> PublicFunction:
    """Forces within bounds, nearest to a reference."""
    a = Algorithm()
    needed, actuators = needed_force(w, a)

    def chosen(least: Value, matrix: Value) -> Value:
        basis = a.apply("null_basis", matrix, numbers=[matrix.shape[0]])
        free = a.apply("product", basis, a.apply("transposed", basis))
        nearest = a.apply("add", least, a.apply("times", free, w.given("reference").value))
        bounds = (w.given(name).value for name in ("tau_min", "tau_max"))
        return a.apply("nearest_within", nearest, free, *bounds)

    forces = required_forces(w, a, needed, actuators, choose=chosen)
    return w.function(
        "force_distribution",
        "Actuator forces from tau_min to tau_max for the acceleration A: the nearest to reference.",
        "X V A tau_min tau_max wrench reference",
        a,
        *force_outputs(w, *forces),
        counted="required",
        also="the search",
    )
