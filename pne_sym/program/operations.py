"""The operations of public functions: one definition each, on arrays over states.

Operands are arrays (states, *shape).  An operation that can fail gives NaN where it fails and says
there which status that is; every other status and all that follows is settled in one place, where
a public function ends: what is not finite is NaN as a whole.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pne_sym.program import distribution, linear
from pne_sym.program.evaluate import Status

Array = NDArray[np.float64]
Shape = tuple[int, ...]


@dataclass(frozen=True)
class Operation:
    """An operation on arrays.

    Attributes:
        name: in steps.
        compute: results, in order, of operands over states; its docstring says what it means.
        status: of a state in which a result is not finite although all operands are; OK where that
            is meant.
        unbounded: results may be infinite: what is not finite is NaN.
    """

    name: str
    compute: Callable[..., tuple[Array, ...]]
    status: Status = Status.INVALID
    unbounded: bool = False

    def __call__(self, operands: Sequence[Array], numbers: tuple[int, ...]) -> tuple[Array, ...]:
        """Results at operands over states."""
        takes = "numbers" in inspect.signature(self.compute).parameters
        with np.errstate(all="ignore"):
            return self.compute(*operands, **({"numbers": numbers} if takes else {}))

    def shapes(self, operands: Sequence[Shape], numbers: tuple[int, ...]) -> list[Shape]:
        """Shapes of what it gives for operands of these shapes."""
        found = self([np.ones((1, *shape)) for shape in operands], numbers)
        return [array.shape[1:] for array in found]


ORTHONORMAL = 1e-6
"""By how much the products of a rotation matrix's rows may differ from those of unit vectors."""
TINY = 1e-9
"""A distance of points from their centroid below this fraction of the legs' size is none."""
OPERATIONS: dict[str, Operation] = {}
_Compute = Callable[..., tuple[Array, ...]]


def _operation(
    status: Status = Status.INVALID, *, unbounded: bool = False
) -> Callable[[_Compute], _Compute]:
    """Enter a function into the table under its own name."""

    def enter(compute: _Compute) -> _Compute:
        OPERATIONS[compute.__name__] = Operation(compute.__name__, compute, status, unbounded)
        return compute

    return enter


# ---- sums, products, parts ---------------------------------------------------------------------


@_operation()
def add(a: Array, b: Array) -> tuple[Array, ...]:
    """a + b."""
    return (a + b,)


@_operation()
def subtract(a: Array, b: Array) -> tuple[Array, ...]:
    """a - b."""
    return (a - b,)


@_operation()
def same(a: Array) -> tuple[Array, ...]:
    """a itself."""
    return (np.array(a),)


@_operation(Status.SINGULAR)
def impossible(a: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """n values that no forces give: SINGULAR."""
    return (np.full((len(a), *numbers), np.nan),)


@_operation()
def entry(a: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """Entry n of a."""
    return (a[:, numbers[0]],)


@_operation()
def negative(a: Array) -> tuple[Array, ...]:
    """-a."""
    return (-a,)


@_operation()
def times(a: Array, b: Array) -> tuple[Array, ...]:
    """a (m x n) times the vector b."""
    return ((a @ b[..., None])[..., 0],)


@_operation()
def product(a: Array, b: Array) -> tuple[Array, ...]:
    """The matrix product a b."""
    return (a @ b,)


@_operation()
def transposed(a: Array) -> tuple[Array, ...]:
    """The transpose of a."""
    return (np.swapaxes(a, -1, -2),)


@_operation()
def half_form(a: Array, b: Array) -> tuple[Array, ...]:
    """Half of a^T b a."""
    return (0.5 * np.einsum("si,sij,sj->s", a, b, a),)


@_operation()
def dot(a: Array, b: Array) -> tuple[Array, ...]:
    """The sum of the products of entries of a and b."""
    return (np.sum(a * b, axis=1),)


@_operation()
def scale(a: Array, b: Array) -> tuple[Array, ...]:
    """The vector a times the number b."""
    return (a * b[:, None],)


@_operation()
def scale_columns(a: Array, b: Array) -> tuple[Array, ...]:
    """Columns of a times the entries of b."""
    return (a * b[:, None, :],)


@_operation()
def divide_rows(a: Array, b: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """a, the numbered rows divided by the number b."""
    result = np.array(a)
    result[:, list(numbers)] /= b[:, None, None]
    return (result,)


@_operation()
def choose_length(a: Array, b: Array) -> tuple[Array, ...]:
    """b where it is positive; else the first entry of a, or the second if it is `TINY` of that."""
    own = np.where(a[:, 0] > TINY * a[:, 1], a[:, 0], a[:, 1])
    return (np.where(b > 0.0, b, own),)


@_operation()
def multiply(a: Array, b: Array) -> tuple[Array, ...]:
    """Entry by entry a b."""
    return (a * b,)


@_operation()
def inverse_root(a: Array) -> tuple[Array, ...]:
    """Entry by entry 1 / root of a; INVALID unless a is positive."""
    with np.errstate(all="ignore"):
        found: Array = 1.0 / np.sqrt(a)
    return (np.where((a > 0.0) & (found > 0.0), found, np.nan),)


@_operation()
def extend(a: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """a with as many zeros behind that there are n entries."""
    return (np.pad(a, ((0, 0), (0, numbers[0] - a.shape[1]))),)


@_operation()
def take(a: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """The numbered rows (entries) of a."""
    return (a[:, list(numbers)],)


@_operation()
def take_columns(a: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """The numbered columns of a."""
    return (a[:, :, list(numbers)],)


@_operation()
def add_at(a: Array, b: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """a with b added to the numbered entries."""
    result = np.array(a)
    result[:, list(numbers)] += b
    return (result,)


@_operation()
def clear_at(a: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """a with zeros at the numbered entries."""
    result = np.array(a)
    result[:, list(numbers)] = 0.0
    return (result,)


@_operation()
def beside(a: Array, b: Array) -> tuple[Array, ...]:
    """The columns of a, then those of b."""
    return (np.concatenate((a, b), axis=2),)


@_operation()
def join(a: Array, b: Array) -> tuple[Array, ...]:
    """The entries of a, then those of b."""
    return (np.concatenate((a, b), axis=1),)


@_operation()
def split(a: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """The first n entries of a, and the rest."""
    return a[:, : numbers[0]], a[:, numbers[0] :]


@_operation()
def add_forces(a: Array, b: Array, c: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """a, and the row of forces b_k c_k added to its row n_k, for every k."""
    result = np.array(a)
    for k, leg in enumerate(numbers):
        result[:, leg] += b[:, k, None] * c[:, k]
    return (result,)


@_operation()
def wrap_turns(a: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """a, the numbered entries turned into (-pi, pi]."""
    result, places = np.array(a), list(numbers)
    with np.errstate(all="ignore"):
        result[:, places] = np.pi - np.remainder(np.pi - a[:, places], 2.0 * np.pi)
    return (result,)


@_operation(Status.OK, unbounded=True)
def unlimited(a: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """a, infinite at the numbered entries."""
    result = np.array(a)
    result[:, list(numbers)] += np.inf
    return (result,)


@_operation()
def least_entry(a: Array) -> tuple[Array, ...]:
    """The least entry of a."""
    return (np.min(a, axis=1),)


@_operation()
def spread(a: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """Of the first n entries of a the product, and the last over the first, 0 where that is 0."""
    some = a[:, : numbers[0]]
    return np.prod(some, axis=1), np.where(some[:, 0] == 0.0, 0.0, some[:, -1] / some[:, 0])


@_operation()
def not_negative(a: Array) -> tuple[Array, ...]:
    """1 where no entry of a is negative, else 0."""
    return (np.where(finite(a), (a >= 0.0).all(axis=1), np.nan),)


# ---- linear equations ----------------------------------------------------------------------------


@_operation(Status.SINGULAR)
def solve(a: Array, b: Array) -> tuple[Array, ...]:
    """x with a x = b: rows scaled, the largest pivot; SINGULAR where a pivot is below PIVOT."""
    return (linear.solve(a, b),)


@_operation()
def saddle(a: Array, b: Array) -> tuple[Array, ...]:
    """The matrix [[a, -b], [b^T, 0]]."""
    states, n, m = b.shape
    result = np.zeros((states, n + m, n + m))
    result[:, :n, :n], result[:, :n, n:] = a, -b
    result[:, n:, :n] = np.swapaxes(b, -1, -2)
    return (result,)


@_operation(Status.SINGULAR)
def least_norm(a: Array, b: Array) -> tuple[Array, ...]:
    """The least x with a x = b, rows of a independent.

    SINGULAR where the least singular value of a, rows scaled to one, is below PIVOT of the largest.
    """
    bad = ~(finite(a) & finite(b))
    a = _blanked(a, bad)
    size = _row_sizes(a)
    u, s, vt = np.linalg.svd(a / size, full_matrices=False)
    with np.errstate(all="ignore"):
        y = (np.swapaxes(u, -1, -2) @ (b / size[..., 0])[..., None]) / s[..., None]
        x = (np.swapaxes(vt, -1, -2) @ y)[..., 0]
    x[bad | ~(s[:, -1] > linear.PIVOT * s[:, 0])] = np.nan
    return (x,)


@_operation(Status.SINGULAR)
def resolve(a: Array, b: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """Combinations of rows of a: n that resolve it, and the others, which vanish on it.

    The rows of b, of which a is a part, are scaled to one, and those of a with them: a row of
    equations keeps its weight where few of its entries are in a.  SINGULAR where the rank of a is
    then less than n.  A row of nothing but rounding, beside the largest, counts as zero: scaled to
    one it would be a direction.
    """
    rank = numbers[0]
    bad = ~(finite(a) & finite(b))
    a, b = _blanked(a, bad), _blanked(b, bad)
    size = np.max(np.abs(b), axis=-1, keepdims=True, initial=0.0)
    most = np.max(size, axis=-2, keepdims=True)
    size = np.where(size > linear.PIVOT * most, size, np.where(most > 0.0, most, 1.0))
    u, s, _ = np.linalg.svd(a / size)
    rows = np.swapaxes(u / size, -1, -2)
    rows[bad | ~(s[:, rank - 1] > linear.PIVOT * s[:, 0])] = np.nan
    return rows[:, :rank], rows[:, rank:]


@_operation()
def singular_values(a: Array) -> tuple[Array, ...]:
    """The singular values of a, in descending order."""
    bad = ~finite(a)
    values = np.linalg.svd(_blanked(a, bad), compute_uv=False)
    return (np.where(bad[:, None], np.float64(np.nan), values),)


@_operation()
def null_basis(a: Array, *, numbers: tuple[int, ...]) -> tuple[Array, ...]:
    """Orthonormal columns x with a x = 0, for a of rank n."""
    bad = ~finite(a)
    _, _, vt = np.linalg.svd(_blanked(a, bad))
    basis = np.array(np.swapaxes(vt[:, numbers[0] :], -1, -2))
    basis[bad] = np.nan
    return (basis,)


# ---- bounds ------------------------------------------------------------------------------------


@_operation(Status.UNREACHABLE)
def nearest_within(a: Array, b: Array, c: Array, d: Array) -> tuple[Array, ...]:
    """Of the a + b y, y any, with entries from c to d the one nearest to a; UNREACHABLE if none.

    What is nearest is told by b, the products of the normals of the bounds.
    """
    found = np.full_like(a, np.nan)
    for k in np.flatnonzero(finite(a) & finite(b) & finite(c) & finite(d)):
        start = np.column_stack((a[k], np.zeros(a.shape[1])))
        nearest = distribution.nearest(start, b[k], c[k], d[k])
        found[k] = np.nan if nearest is None else nearest[:, 0]
    return (found,)


@_operation(Status.UNREACHABLE, unbounded=True)
def factors_within(a: Array, b: Array, c: Array) -> tuple[Array, ...]:
    """The least and the largest s >= 0 with |a + s b| <= c entry by entry; UNREACHABLE if none."""
    ends = np.stack(((-c - a) / b, (c - a) / b))
    never = np.where(np.abs(a) <= c, -np.inf, np.inf)
    least = np.max(np.where(b == 0.0, never, np.min(ends, axis=0)), axis=1, initial=0.0)
    largest = np.min(np.where(b == 0.0, np.inf, np.max(ends, axis=0)), axis=1)
    some = finite(a) & finite(b) & finite(c) & (least <= largest) & (least < np.inf)
    return np.where(some, least, np.nan), np.where(some, largest, np.nan)


@_operation(Status.UNREACHABLE, unbounded=True)
def factors_of_some(a: Array, b: Array, c: Array, d: Array) -> tuple[Array, ...]:
    """The least and the largest s >= 0 with |a + s b + c y| <= d, y any; UNREACHABLE if none."""
    found = np.full((len(a), 2), np.nan)
    for k in np.flatnonzero(finite(a) & finite(b) & finite(c) & finite(d)):
        between = distribution.factors(a[k], b[k], c[k], d[k])
        found[k] = np.nan if between is None else between
    return found[:, 0], found[:, 1]


def finite(a: Array) -> NDArray[np.bool_]:
    """States in which every entry is finite."""
    return np.asarray(np.isfinite(a).all(axis=tuple(range(1, a.ndim))), dtype=np.bool_)


def _blanked(a: Array, bad: NDArray[np.bool_]) -> Array:
    """Matrices with zeros in bad states: LAPACK refuses what is not finite."""
    return np.where(bad[:, None, None], np.float64(0.0), a)


def _row_sizes(a: Array) -> Array:
    size = np.max(np.abs(a), axis=-1, keepdims=True, initial=0.0)
    return np.where(size > 0.0, size, 1.0)


# ---- poses --------------------------------------------------------------------------------


@_operation()
def rotation_of_quaternion(a: Array) -> tuple[Array, ...]:
    """The rotation matrix of the quaternion a (x, y, z, w) of any length; INVALID if it is zero."""
    x, y, z, w = _scaled(a).T
    n = x * x + y * y + z * z + w * w
    rows = (
        (x * x + w * w - (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), y * y + w * w - (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), z * z + w * w - (x * x + y * y)),
    )
    return (np.moveaxis(np.array(rows) / n, -1, 0),)


def _scaled(q: Array) -> Array:
    """Quaternions with largest entry 1, so that squares of tiny ones keep their digits.

    NaN where the squared length overflows: such a state is INVALID everywhere.
    """
    size = np.max(np.abs(q), axis=1, keepdims=True)
    squared = np.sum(q * q, axis=1, keepdims=True)
    return q / np.where(np.isfinite(squared), size, np.float64(np.nan))


def _unit(q: Array) -> Array:
    q = _scaled(q)
    unit: Array = q / np.linalg.norm(q, axis=1, keepdims=True)
    return unit


@_operation()
def quaternion_of_rotation(a: Array) -> tuple[Array, ...]:
    """The quaternion of the rotation matrix a; INVALID if that is none, to `ORTHONORMAL`."""
    x, y, z = a[:, 0, 0], a[:, 1, 1], a[:, 2, 2]
    s = a[:, 2, 1] + a[:, 1, 2], a[:, 0, 2] + a[:, 2, 0], a[:, 1, 0] + a[:, 0, 1]
    d = a[:, 2, 1] - a[:, 1, 2], a[:, 0, 2] - a[:, 2, 0], a[:, 1, 0] - a[:, 0, 1]
    candidates = np.array(  # each is four times the quaternion times one of its entries
        [
            (1 + x - y - z, s[2], s[1], d[0]),
            (s[2], 1 - x + y - z, s[0], d[1]),
            (s[1], s[0], 1 - x - y + z, d[2]),
            (d[0], d[1], d[2], 1 + x + y + z),
        ]
    )
    best = np.argmax(np.linalg.norm(candidates, axis=1), axis=0)
    q = candidates[best, :, np.arange(len(a))]
    return (np.where(_are_rotations(a)[:, None], _unit(q), np.float64(np.nan)),)


@_operation()
def angle_of_rotation(a: Array) -> tuple[Array, ...]:
    """The angle of the rotation a of the plane; INVALID if that is none, to `ORTHONORMAL`."""
    angle = np.arctan2(a[:, 1, 0], a[:, 0, 0])
    return (np.where(_are_rotations(a), angle, np.float64(np.nan))[:, None],)


def _are_rotations(a: Array) -> NDArray[np.bool_]:
    blank = _blanked(a, ~finite(a))
    error = np.abs(blank @ np.swapaxes(blank, -1, -2) - np.eye(a.shape[-1])).max(axis=(1, 2))
    return np.asarray((error <= ORTHONORMAL) & (np.linalg.det(blank) > 0.0), dtype=np.bool_)


@_operation()
def rotation_of_angle(a: Array) -> tuple[Array, ...]:
    """The rotation matrix of the angle a in the plane."""
    with np.errstate(all="ignore"):
        c, s = np.cos(a[:, 0]), np.sin(a[:, 0])
    return (np.moveaxis(np.array(((c, -s), (s, c))), -1, 0),)


@_operation()
def quaternion_of_rpy(a: Array) -> tuple[Array, ...]:
    """The quaternion of roll, pitch, yaw about the fixed axes x, y, z."""
    with np.errstate(all="ignore"):
        (cx, cy, cz), (sx, sy, sz) = np.cos(0.5 * a).T, np.sin(0.5 * a).T
    rows = (
        sx * cy * cz - cx * sy * sz,
        cx * sy * cz + sx * cy * sz,
        cx * cy * sz - sx * sy * cz,
        cx * cy * cz + sx * sy * sz,
    )
    return (np.array(rows).T,)


@_operation()
def quaternion_rate(a: Array, b: Array) -> tuple[Array, ...]:
    """The rate of the quaternion a at the angular velocity b."""
    with np.errstate(all="ignore"):
        vector = 0.5 * (a[:, 3:] * b + np.cross(b, a[:, :3]))
        scalar = -0.5 * np.sum(a[:, :3] * b, axis=1, keepdims=True)
    return (np.concatenate((vector, scalar), axis=1),)


@_operation()
def turn_quaternion(a: Array, b: Array) -> tuple[Array, ...]:
    """Exp([b]) turned onto the quaternion a: by the rotation vector b."""
    with np.errstate(all="ignore"):
        angle = np.linalg.norm(b, axis=1, keepdims=True)
        v, c = b * (0.5 * np.sinc(angle / (2.0 * np.pi))), np.cos(0.5 * angle)
        q = _unit(a)
        vector = c * q[:, :3] + q[:, 3:] * v + np.cross(v, q[:, :3])
        scalar = c * q[:, 3:] - np.sum(v * q[:, :3], axis=1, keepdims=True)
    return (np.concatenate((vector, scalar), axis=1),)


@_operation()
def turn_between(a: Array, b: Array) -> tuple[Array, ...]:
    """The shortest rotation vector that turns the quaternion a to b; of half turns one of two."""
    with np.errstate(all="ignore"):
        p, q = _unit(a), _unit(b)
        vector = p[:, 3:] * q[:, :3] - q[:, 3:] * p[:, :3] - np.cross(q[:, :3], p[:, :3])
        scalar = np.sum(p * q, axis=1, keepdims=True)
        size = np.linalg.norm(vector, axis=1, keepdims=True)
        half = np.arctan2(size, np.abs(scalar))
        # Half an angle over its sine: 1 where that is 0.
        factor = 2.0 * np.where(size > 0.0, half / np.where(size > 0.0, size, 1.0), 1.0)
    return (vector * np.where(scalar < 0.0, -factor, factor),)
