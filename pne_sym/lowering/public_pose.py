"""Public functions about poses: rotation matrices, roll, pitch and yaw, rates of X, differences."""

from __future__ import annotations

from pne_sym.derivation import Coordinates
from pne_sym.program.algorithm import Algorithm
from pne_sym.program.public import Argument, PublicFunction, Value

_ROTATION = "rotation matrix base_R_platform"
_FIXED = "about the fixed axes x, y, z"
_STEP = "of the origin, rotation vector in base axes, of extra coordinates"


def pose_functions(c: Coordinates) -> list[PublicFunction]:
    """Helpers for poses, where the platform's orientation is a coordinate."""
    w = _Poses(c)
    if not w.turning:
        return []
    found = [w.rotation(), w.pose(), w.rate()]
    return [*found, w.of_rpy()] if w.in_space else found


def displacement_functions(c: Coordinates) -> list[PublicFunction]:
    """Poses moved by small or large displacements, and the displacements between them."""
    w = _Poses(c)
    return [w.retract(), w.difference(), w.interpolate()]


class _Poses:
    """Where position, orientation and extra coordinates stand in X and V, and what follows."""

    def __init__(self, c: Coordinates) -> None:
        self.n, self.position, self.extra = c.sizes, c.position, len(c.extras)
        self.orientation = len(c.pose) - c.position
        self.turning = sum(k >= 3 for k in c.components)
        self.in_space = self.orientation == 4
        sides = str(3 if self.in_space else 2)
        self.R = self._given("R", _ROTATION, sides, sides)
        self.t = self._given("t", "position of the platform origin [m]", str(self.position))

    def _given(self, name: str, meaning: str, *sizes: str) -> Argument:
        shape = tuple(self.n.get(size) or int(size) for size in sizes)
        return Argument(Value(name, shape), sizes, meaning)

    def _X(self, name: str, meaning: str = "pose") -> Argument:
        return self._given(name, f"{meaning}, and extra coordinates", "NQ")

    def rotation(self) -> PublicFunction:
        """The rotation matrix of a pose."""
        a, X = Algorithm(), self._X("X")
        of = "rotation_of_quaternion" if self.in_space else "rotation_of_angle"
        R = a.apply(of, self._turn(a, X.value))
        out = Argument(R, self.R.dimensions, _ROTATION, label="R")
        meaning = "base_R_platform at X; a quaternion need not be normalised."
        return _helper("rotation", meaning, (X,), a, out)

    def pose(self) -> PublicFunction:
        """A pose of a position and a rotation matrix."""
        a = Algorithm()
        of = "quaternion_of_rotation" if self.in_space else "angle_of_rotation"
        X = self._assembled(a, a.apply(of, self.R.value))
        meaning = "X of the platform at origin t with rotation matrix R; extra coordinates zero."
        return _helper("pose", meaning, (self.t, self.R), a, X)

    def of_rpy(self) -> PublicFunction:
        """A pose of a position and three angles."""
        a, rpy = Algorithm(), self._given("rpy", f"roll, pitch, yaw {_FIXED} [rad]", "3")
        X = self._assembled(a, a.apply("quaternion_of_rpy", rpy.value))
        meaning = f"X from roll, pitch, yaw {_FIXED}, in that order."
        return _helper("pose_from_rpy", meaning, (self.t, rpy), a, X)

    def _assembled(self, a: Algorithm, orientation: Value) -> Argument:
        """X of a position and an orientation; extra coordinates zero."""
        X = a.apply("join", self.t.value, orientation)
        return Argument(a.apply("extend", X, numbers=[self.n["NQ"]]), ("NQ",), "pose", label="X")

    def _turn(self, a: Algorithm, X: Value) -> Value:
        at = self.position
        return a.apply("take", X, numbers=range(at, at + self.orientation))

    def rate(self) -> PublicFunction:
        """The rate of a pose."""
        a, X, V = Algorithm(), self._X("X"), self._given("V", "velocity", "NV")
        rate = V.value
        if self.in_space:
            start, end = self.position, self.position + self.turning
            turning = a.apply("take", V.value, numbers=range(start, end))
            rate = a.apply("quaternion_rate", self._turn(a, X.value), turning)
            if start:
                rate = a.apply("join", a.apply("take", V.value, numbers=range(start)), rate)
            if self.extra:
                extra = a.apply("take", V.value, numbers=range(end, end + self.extra))
                rate = a.apply("join", rate, extra)
        else:
            rate = a.apply("same", rate)
        out = Argument(rate, ("NQ",), "rate of X", label="X_dot")
        return _helper("X_dot", "Rate of X at the velocity V.", (X, V), a, out)

    # ---- differences of poses ------------------------------------------------------------------

    def retract(self) -> PublicFunction:
        """A pose moved."""
        a, X, step = Algorithm(), self._X("X"), self._given("step", f"displacement: {_STEP}", "NV")
        moved = self._moved(a, X.value, step.value)
        out = Argument(moved, ("NQ",), "the pose moved", label="X_moved")
        meaning = "X moved by a displacement: (t + d, exp([phi]) R, y + dy) of step = (d, phi, dy)."
        return _helper("retract", meaning, (X, step), a, out)

    def difference(self) -> PublicFunction:
        """What moves a pose to another."""
        a, X0, X1 = Algorithm(), self._X("X0", "from"), self._X("X1", "to")
        out = Argument(self._between(a, X0.value, X1.value), ("NV",), _STEP, label="step")
        meaning = (
            "The displacement from X0 to X1, the inverse of `retract`; rotations the shorter way."
        )
        return _helper("difference", meaning, (X0, X1), a, out)

    def interpolate(self) -> PublicFunction:
        """A pose between two."""
        a, X0, X1 = Algorithm(), self._X("X0", "from"), self._X("X1", "to")
        s = self._given("s", "part of the way, 0 at X0, 1 at X1")
        step = a.apply("scale", self._between(a, X0.value, X1.value), s.value)
        out = Argument(self._moved(a, X0.value, step), ("NQ",), "pose", label="X")
        meaning = "X0 moved by s times the displacement to X1: straight on, turning about one axis."
        return _helper("interpolate", meaning, (X0, X1, s), a, out)

    def _moved(self, a: Algorithm, X: Value, step: Value) -> Value:
        if not self.in_space:
            return a.apply("add", X, step)
        t, q, y = self._parts(a, X, 4)
        d, phi, dy = self._parts(a, step, 3)
        turned = a.apply("turn_quaternion", q, phi)
        return _joined(a, (_together(a, "add", t, d), turned, _together(a, "add", y, dy)))

    def _between(self, a: Algorithm, X0: Value, X1: Value) -> Value:
        if not self.in_space:
            change = a.apply("subtract", X1, X0)
            turns = [self.position] * self.orientation
            return a.apply("wrap_turns", change, numbers=turns) if turns else change
        (t0, q0, y0), (t1, q1, y1) = (self._parts(a, X, 4) for X in (X0, X1))
        turn = a.apply("turn_between", q0, q1)
        way, more = (_together(a, "subtract", *pair) for pair in ((t1, t0), (y1, y0)))
        return _joined(a, (way, turn, more))

    def _parts(
        self, a: Algorithm, vector: Value, orientation: int
    ) -> tuple[Value | None, Value, Value | None]:
        """Position, orientation and extra coordinates; None where there are none."""
        ends = self.position, self.position + orientation, vector.size
        first = a.apply("take", vector, numbers=range(ends[0])) if ends[0] else None
        turn = a.apply("take", vector, numbers=range(*ends[:2]))
        rest = a.apply("take", vector, numbers=range(*ends[1:])) if ends[2] > ends[1] else None
        return first, turn, rest


def _helper(
    name: str, meaning: str, inputs: tuple[Argument, ...], a: Algorithm, output: Argument
) -> PublicFunction:
    steps = tuple(a.steps)
    return PublicFunction(name, meaning, inputs, (output,), steps, "pose", needs_model=False)


def _together(a: Algorithm, operation: str, one: Value | None, other: Value | None) -> Value | None:
    return a.apply(operation, one, other) if one and other else None


def _joined(a: Algorithm, parts: tuple[Value | None, ...]) -> Value:
    first, *others = (part for part in parts if part)
    for part in others:
        first = a.apply("join", first, part)
    return first
