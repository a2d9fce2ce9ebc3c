"""Public functions about poses: rotation matrices, roll, pitch and yaw, rates of X, differences."""

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


# ---- differences of poses ----------------------------------------------------------------------


def displacement_functions(c: Coordinates) -> list[PublicFunction]:
    """Poses moved by small or large displacements, and the displacements between them."""
    at, n = _Layout.of(c), c.sizes
    return [_retract(at, n), _difference(at, n), _interpolate(at, n)]


def _pose_argument(name: str, n: dict[str, int], meaning: str = "pose") -> Argument:
    return Argument(Value(name, (n["NQ"],)), ("NQ",), f"{meaning}, and extra coordinates")


def _retract(at: _Layout, n: dict[str, int]) -> PublicFunction:
    a, X = Algorithm(), _pose_argument("X", n)
    step = Argument(
        Value("step", (n["NV"],)),
        ("NV",),
        "displacement: of the origin, rotation vector in base axes, of extra coordinates",
    )
    moved = _moved(a, at, X.value, step.value)
    out = Argument(moved, ("NQ",), "the pose moved", label="X_moved")
    meaning = "X moved by a displacement: (t + d, exp([phi]) R, y + dy) of step = (d, phi, dy)."
    return _helper("retract", meaning, (X, step), a, out)


def _moved(a: Algorithm, at: _Layout, X: Value, step: Value) -> Value:
    if at.orientation != 4:
        return a.apply("add", X, step)
    t, q, y = _parts(a, X, at.position, 4)
    d, phi, dy = _parts(a, step, at.position, 3)
    turned = a.apply("turn_quaternion", q, phi)
    return _joined(a, (_together(a, "add", t, d), turned, _together(a, "add", y, dy)))


def _difference(at: _Layout, n: dict[str, int]) -> PublicFunction:
    a, X0, X1 = Algorithm(), _pose_argument("X0", n, "from"), _pose_argument("X1", n, "to")
    out = Argument(
        _between(a, at, X0.value, X1.value),
        ("NV",),
        "of the origin, rotation vector in base axes, of extra coordinates",
        label="step",
    )
    meaning = "The displacement from X0 to X1, the inverse of `retract`; rotations the shorter way."
    return _helper("difference", meaning, (X0, X1), a, out)


def _between(a: Algorithm, at: _Layout, X0: Value, X1: Value) -> Value:
    if at.orientation != 4:
        change = a.apply("subtract", X1, X0)
        return a.apply("wrap_turns", change, numbers=[at.position]) if at.orientation else change
    (t0, q0, y0), (t1, q1, y1) = (_parts(a, X, at.position, 4) for X in (X0, X1))
    turn = a.apply("turn_between", q0, q1)
    return _joined(a, (_together(a, "subtract", t1, t0), turn, _together(a, "subtract", y1, y0)))


def _interpolate(at: _Layout, n: dict[str, int]) -> PublicFunction:
    a, X0, X1 = Algorithm(), _pose_argument("X0", n, "from"), _pose_argument("X1", n, "to")
    s = Argument(Value("s", ()), (), "part of the way, 0 at X0, 1 at X1")
    step = a.apply("scale", _between(a, at, X0.value, X1.value), s.value)
    out = Argument(_moved(a, at, X0.value, step), ("NQ",), "pose", label="X")
    meaning = "X0 moved by s times the displacement to X1: straight on, turning about one axis."
    return _helper("interpolate", meaning, (X0, X1, s), a, out)


def _parts(
    a: Algorithm, vector: Value, position: int, orientation: int
) -> tuple[Value | None, Value, Value | None]:
    """Position, orientation and extra coordinates; None where there are none."""
    ends = position, position + orientation, vector.size
    first = a.apply("take", vector, numbers=range(ends[0])) if position else None
    turn = a.apply("take", vector, numbers=range(*ends[:2]))
    rest = a.apply("take", vector, numbers=range(*ends[1:])) if ends[2] > ends[1] else None
    return first, turn, rest


def _together(a: Algorithm, operation: str, one: Value | None, other: Value | None) -> Value | None:
    return a.apply(operation, one, other) if one and other else None


def _joined(a: Algorithm, parts: tuple[Value | None, ...]) -> Value:
    first, *others = (part for part in parts if part)
    for part in others:
        first = a.apply("join", first, part)
    return first
