"""The closed loops of a mechanism: displacements, and if need be a pose, that close them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pne_sym.model.closure import Flags, least_norm, leg_closed, leg_residual, solve, unreachable
from pne_sym.model.kinematics import TASK_SPACES, Array, displaced, pose_at, slices_of
from pne_sym.model.manipulator import Joint, Leg, Manipulator, Space, Vector3


@dataclass(frozen=True)
class LoopResidual:
    """The largest loop-closure residual of a mechanism.

    Attributes:
        leg: its leg, counted from 0.
        size: how wide, with its unit.
        condition: which condition fails, in words; empty where the points do not coincide.
        name: of the leg, if it has one.
    """

    leg: int
    size: str
    condition: str = ""
    name: str = ""

    def __str__(self) -> str:
        named = f" ({self.name})" if self.name else ""
        where = f"legs[{self.leg}]{named} has a loop-closure residual of {self.size}"
        return f"{where}: {self.condition}" if self.condition else where


@dataclass(frozen=True)
class Loops:
    """The legs between base and platform, and which displacements the pose states.

    Attributes:
        space: the task space.
        legs: of the mechanism.
        centre: fixed centre of rotation, m (spherical only).
    """

    space: Space
    legs: tuple[Leg, ...]
    centre: Vector3 | None

    @staticmethod
    def of(m: Manipulator) -> Loops:
        """Those of a manipulator."""
        return Loops(m.space, m.legs, m.fixed_centre)

    @property
    def size(self) -> int:
        """How many platform coordinates there are."""
        return len(TASK_SPACES[self.space].pose_names)

    @property
    def joints(self) -> list[Joint]:
        """All joints, in the order of q."""
        return [joint for leg in self.legs for joint in leg.joints]

    @property
    def extra(self) -> Flags:
        """Which displacements are coordinates of their own."""
        return np.array([joint.extra for joint in self.joints], dtype=bool)

    def slices(self) -> list[slice]:
        """Where each leg's displacements stand in q."""
        return slices_of(self.legs)

    def closures(self, X: Array, q: Array) -> list[tuple[Array, Array, Array]]:
        """Each leg's residual, and its Jacobians by its displacements and by the free twist."""
        pose = pose_at(self.space, X.tolist(), self.centre)
        twist, pairs = (
            TASK_SPACES[self.space].components,
            zip(self.legs, self.slices(), strict=True),
        )
        found = (leg_residual(leg, q[s], pose) for leg, s in pairs)
        return [(residual, by_q, by_twist[:, twist]) for residual, by_q, by_twist in found]

    def residuals(self, X: Array, q: Array) -> list[float]:
        """The largest residual of each leg."""
        return [float(np.abs(residual).max()) for residual, _, _ in self.closures(X, q)]

    def widest(self, X: Array, q: Array) -> LoopResidual:
        """The largest residual: a length, or an angle between axes."""
        leg = int(np.argmax(self.residuals(X, q)))
        name, residual = self.legs[leg].name, np.abs(self.closures(X, q)[leg][0])
        points, axes = residual[:3], residual[3:]
        if not axes.max(initial=0.0) > points.max():
            return LoopResidual(leg, f"{points.max():.3g} m", name=name)
        kind = self.legs[leg].platform_joint.kind
        return LoopResidual(
            leg, f"{kind.angle(float(np.linalg.norm(axes))):.3g} rad", kind.open, name
        )


def legs_closed(loops: Loops, X: Array, q: Array) -> Array:
    """Each leg closed by itself at the given pose, as far as it can."""
    pose = pose_at(loops.space, X.tolist(), loops.centre)
    pairs = zip(loops.legs, loops.slices(), strict=True)
    return np.concatenate([leg_closed(leg, q[s], pose, ~loops.extra[s]) for leg, s in pairs])


def all_closed(loops: Loops, X: Array, q: Array) -> tuple[Array, Array]:
    """All legs closed together, moving the pose by what the legs cannot reach."""
    size, free = loops.size, [~loops.extra[s] for s in loops.slices()]
    twist = len(TASK_SPACES[loops.space].components)

    def residual(x: Array) -> Array:
        return np.concatenate([r for r, _, _ in loops.closures(x[:size], x[size:])])

    def step(x: Array) -> Array:
        found = zip(loops.closures(x[:size], x[size:]), free, strict=True)
        legs = [(r, by_q * own, by_twist) for (r, by_q, by_twist), own in found]
        out = [unreachable(by_q) for _, by_q, _ in legs]
        platform = least_norm(
            np.vstack([n @ by_twist for n, (_, _, by_twist) in zip(out, legs, strict=True)]),
            -np.concatenate([n @ r for n, (r, _, _) in zip(out, legs, strict=True)]),
        )
        joints = [
            least_norm(by_q, -residual - by_twist @ platform) for residual, by_q, by_twist in legs
        ]
        return np.concatenate([platform, *joints])

    def move(x: Array, step: Array) -> Array:
        pose = displaced(loops.space, x[:size], step[:twist])
        return np.concatenate([pose, x[size:] + step[twist:]])

    x = solve(residual, step, move, np.concatenate([X[:size], q]))
    return np.concatenate([x[:size], X[size:]]), x[size:]
