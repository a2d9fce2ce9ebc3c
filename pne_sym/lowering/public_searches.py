"""Poses that are searched for."""

from __future__ import annotations

from pne_sym.lowering.public_writer import Writer
from pne_sym.program.algorithm import Algorithm
from pne_sym.program.public import PublicFunction, Search, Value


def searching_functions(w: Writer) -> list[PublicFunction]:
    """Poses that are searched for."""
    found = [_mismatch(w), _slope(w), _forward_kinematics(w)]
    return [*found, *_projection(w)] if w.constrained else found


def _mismatch(w: Writer) -> PublicFunction:
    """Residuals of actuated joints and of constraints."""
    a, joints = Algorithm(), [w.c.joints.index(j) for j in w.c.actuators]
    (q,) = a.run("inverse_kinematics", w.program, "q")
    own = a.apply("take", q, numbers=joints)
    gap = a.apply("subtract", w.given("q_actuated").value, own)
    turning = [k for k, j in enumerate(joints) if w.c.turning[j]]
    if turning:
        gap = a.apply("wrap_turns", gap, numbers=turning)
    if w.constrained:
        (residual,) = a.run("constraints", w.program, "constraints")
        gap = a.apply("join", gap, a.apply("negative", residual))
    out = w.made(gap, "gap", "of actuated joints, then of constraints", str(gap.size))
    return w.function(
        "mismatch", "Residual of the pose.", "X q_actuated", a, out, is_exported=False,
        group="kinematics",
    )  # fmt: skip


def _slope(w: Writer) -> PublicFunction:
    """Transpose of the derivative of what is measured, by a displacement of the pose."""
    a = Algorithm()
    (H,) = a.run("H", w.program, "H")
    if w.constrained:
        (Hk,) = a.run("Hk", w.program, "Hk")
        H = a.apply("beside", H, Hk)
    out = w.made(H, "slope", "columns: what is measured", "NV", str(H.shape[1]))
    return w.function(
        "slope", "Derivative of the residual, negative.", "X", a, out, is_exported=False,
        group="kinematics",
    )  # fmt: skip


def _forward_kinematics(w: Writer) -> PublicFunction:
    a, X = Algorithm(), Value("X_found", (w.n["NQ"],))
    a.steps.append(Search("mismatch", "slope", w.given("X0").value, X, halving=True))
    return w.function(
        "forward_kinematics",
        "X at which the actuated joints stand at q_actuated, by Gauss-Newton from X0.",
        "q_actuated X0",
        a,
        w.made(X, "X", "pose", "NQ"),
        group="kinematics",
    )


def _projection(w: Writer) -> list[PublicFunction]:
    residual = Algorithm()
    (gap,) = residual.run("constraints", w.program, "constraints")
    gap = residual.apply("negative", gap)
    slope = Algorithm()
    (Hk,) = slope.run("Hk", w.program, "Hk")
    a, X = Algorithm(), Value("X_found", (w.n["NQ"],))
    a.steps.append(
        Search("constraint_gap", "constraint_slope", w.given("X").value, X, halving=False)
    )
    return [
        w.function(
            "constraint_gap", "Residual of the constraints, negative.", "X", residual,
            w.made(gap, "gap", "of the constraints", "NC"), is_exported=False,
            group="constraints",
        ),
        w.function(
            "constraint_slope", "Directions of the constraints.", "X", slope,
            w.made(Hk, "slope", "columns", "NV", "NC"), is_exported=False,
            group="constraints",
        ),
        w.function(
            "project", "The nearest pose on which the constraints hold.", "X", a,
            w.made(X, "projected", "pose", "NQ"), group="constraints",
        ),
    ]  # fmt: skip
