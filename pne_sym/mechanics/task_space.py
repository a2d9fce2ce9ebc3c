"""Task spaces: which components of twist and wrench are coordinates."""

from __future__ import annotations

from dataclasses import dataclass

from pne_sym.model.manipulator import Space


@dataclass(frozen=True)
class TaskSpace:
    """What a task space consists of.

    Attributes:
        components: indices into the six components (linear, then angular) of
            twist and wrench that are coordinates.
        pose_names: names of the platform coordinates in X.
        rate_names: names of the entries of V.
        wrench_names: names of the entries of a wrench.
        planar: everything happens in the plane z = 0.
    """

    components: tuple[int, ...]
    pose_names: tuple[str, ...]
    rate_names: tuple[str, ...]
    wrench_names: tuple[str, ...]
    planar: bool

    @property
    def rotates(self) -> bool:
        """Whether the platform's orientation is a coordinate."""
        return any(c >= 3 for c in self.components)

    @property
    def translates(self) -> bool:
        """Whether the platform's position is a coordinate."""
        return any(c < 3 for c in self.components)

    @property
    def has_quaternion(self) -> bool:
        """Whether orientation is given by a quaternion."""
        return "qw" in self.pose_names


_QUATERNION = ("qx", "qy", "qz", "qw")
_V = ("vx", "vy", "vz", "wx", "wy", "wz")
_W = ("fx", "fy", "fz", "mx", "my", "mz")


def _space(components: tuple[int, ...], pose: tuple[str, ...], planar: bool) -> TaskSpace:
    return TaskSpace(
        components,
        pose,
        tuple(_V[c] for c in components),
        tuple(_W[c] for c in components),
        planar,
    )


TASK_SPACES: dict[Space, TaskSpace] = {
    Space.POINT: _space((0, 1), ("x", "y"), True),
    Space.PLANAR: _space((0, 1, 5), ("x", "y", "phi"), True),
    Space.SPATIAL: _space((0, 1, 2, 3, 4, 5), ("x", "y", "z", *_QUATERNION), False),
    Space.TRANSLATIONAL: _space((0, 1, 2), ("x", "y", "z"), False),
    Space.SPHERICAL: _space((3, 4, 5), _QUATERNION, False),
}
