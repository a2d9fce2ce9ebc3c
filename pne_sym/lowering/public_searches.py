"""Poses that are searched for."""

from __future__ import annotations

from pne_sym.lowering.public_writer import Writer
from pne_sym.program.algorithm import Algorithm
from pne_sym.program.public import PublicFunction, Search, Value


def searching_functions(w: Writer) -> list[PublicFunction]:
    """Poses that are searched for."""
    found = [_pose_residual(w), _slope(w), _forward_kinematics(w)]
    return [*found, *_projection(w)] if w.constrained else found


def _pose_residual(w: Writer) -> PublicFunction:
    """Residuals of actuated joints and of constraints."""
    a, joints = Algorithm(), [w.c.joints.index(j) for j in w.c.actuators]
    (q,) = a.run("inverse_kinematics", w.program, "q")
    own = a.apply("take", q, numbers=joints)
    residual = a.apply("subtract", w.given("q_actuated").value, own)
    turning = [k for k, j in enumerate(joints) if w.c.turning[j]]
    if turning:
        residual = a.apply("wrap_turns", residual, numbers=turning)
    if w.constrained:
        (unkept,) = a.run("constraints", w.program, "constraints")
        residual = a.apply("join", residual, a.apply("negative", unkept))
    out = w.made(
        residual, "residual", "of actuated joints, then of constraints", str(residual.size)
    )
    return w.function(
        "pose_residual", "Residual of the pose.", "X q_actuated", a, out, is_exported=False,
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
    a.steps.append(Search("pose_residual", "slope", (w.given("X0").value,), (X,), halving=True))
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
    (unkept,) = residual.run("constraints", w.program, "constraints")
    opposite = residual.apply("negative", unkept)
    slope = Algorithm()
    (Hk,) = slope.run("Hk", w.program, "Hk")
    a, X = Algorithm(), Value("X_found", (w.n["NQ"],))
    a.steps.append(
        Search(
            "constraint_residual", "constraint_slope", (w.given("X").value,), (X,), halving=False
        )
    )
    return [
        w.function(
            "constraint_residual", "Residual of the constraints, negative.", "X", residual,
            w.made(opposite, "residual", "of the constraints", "NC"), is_exported=False,
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
