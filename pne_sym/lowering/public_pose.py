"""Public functions about poses: rotation matrices, roll, pitch and yaw, rates of X."""

from __future__ import annotations

from dataclasses import dataclass

from pne_sym.derivation import Coordinates
from pne_sym.program.algorithm import Algorithm
from pne_sym.program.public import Argument, PublicFunction, Value


@dataclass(frozen=True)
class _Layout:
    """Where position, orientation and extra coordinates stand in X and V."""

    position: int
    orientation: int
    turning: int
    extra: int

    @staticmethod
    def of(c: Coordinates) -> _Layout:
        turning = sum(k >= 3 for k in c.components)
        return _Layout(c.position, len(c.pose) - c.position, turning, len(c.extras))

    @property
    def sides(self) -> int:
        """Rows of a rotation matrix."""
        return 3 if self.orientation == 4 else 2


def pose_functions(c: Coordinates) -> list[PublicFunction]:
    """Helpers for poses, where the platform's orientation is a coordinate."""
    if not any(k >= 3 for k in c.components):
        return []
    at, n = _Layout.of(c), c.sizes
    X = Argument(Value("X", (n["NQ"],)), ("NQ",), "pose, and extra coordinates")
    V = Argument(Value("V", (n["NV"],)), ("NV",), "velocity")
    found = [_rotation(at, X), _pose(at, n), _rate(at, X, V)]
    return [*found, _of_rpy(at, n)] if at.orientation == 4 else found


def _orientation(a: Algorithm, at: _Layout, X: Value) -> Value:
    return a.apply("take", X, numbers=range(at.position, at.position + at.orientation))


def _matrix(value: Value, at: _Layout, name: str) -> Argument:
    return Argument(value, (str(at.sides),) * 2, "rotation matrix base_R_platform", label=name)


def _rotation(at: _Layout, X: Argument) -> PublicFunction:
    a = Algorithm()
    of = "rotation_of_quaternion" if at.orientation == 4 else "rotation_of_angle"
    R = a.apply(of, _orientation(a, at, X.value))
    meaning = "base_R_platform at X; a quaternion need not be normalised."
    return _helper("rotation", meaning, (X,), a, _matrix(R, at, "R"))


def _position(at: _Layout) -> Argument:
    value = Value("t", (at.position,))
    return Argument(value, (str(at.position),), "position of the platform origin [m]")


def _assembled(a: Algorithm, at: _Layout, orientation: Value, size: int) -> Argument:
    """X of a position and an orientation; extra coordinates zero."""
    X = a.apply("join", _position(at).value, orientation)
    return Argument(a.apply("extend", X, numbers=[size]), ("NQ",), "pose", label="X")


def _pose(at: _Layout, n: dict[str, int]) -> PublicFunction:
    a, R = Algorithm(), Value("R", (at.sides, at.sides))
    of = "quaternion_of_rotation" if at.orientation == 4 else "angle_of_rotation"
    X = _assembled(a, at, a.apply(of, R), n["NQ"])
    given = Argument(R, (str(at.sides),) * 2, "rotation matrix base_R_platform")
    meaning = "X of the platform at origin t with rotation matrix R; extra coordinates zero."
    return _helper("pose", meaning, (_position(at), given), a, X)


def _of_rpy(at: _Layout, n: dict[str, int]) -> PublicFunction:
    a, rpy = Algorithm(), Value("rpy", (3,))
    X = _assembled(a, at, a.apply("quaternion_of_rpy", rpy), n["NQ"])
    given = Argument(rpy, ("3",), "roll, pitch, yaw about the fixed axes x, y, z [rad]")
    meaning = "X from roll, pitch, yaw about the fixed axes x, y, z, in that order."
    return _helper("pose_from_rpy", meaning, (_position(at), given), a, X)


def _rate(at: _Layout, X: Argument, V: Argument) -> PublicFunction:
    a = Algorithm()
    rate = V.value
    if at.orientation == 4:
        start, end = at.position, at.position + at.turning
        turning = a.apply("take", V.value, numbers=range(start, end))
        rate = a.apply("quaternion_rate", _orientation(a, at, X.value), turning)
        if at.position:
            rate = a.apply("join", a.apply("take", V.value, numbers=range(start)), rate)
        if at.extra:
            extra = a.apply("take", V.value, numbers=range(end, end + at.extra))
            rate = a.apply("join", rate, extra)
    else:
        rate = a.apply("same", rate)
    out = Argument(rate, ("NQ",), "rate of X", label="X_dot")
    return _helper("X_dot", "Rate of X at the velocity V.", (X, V), a, out)


def _helper(
    name: str, meaning: str, inputs: tuple[Argument, ...], a: Algorithm, output: Argument
) -> PublicFunction:
    steps = tuple(a.steps)
    return PublicFunction(name, meaning, inputs, (output,), steps, "pose", needs_model=False)
